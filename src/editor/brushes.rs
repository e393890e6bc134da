//! The options of all brushes, and the commands of those that work under an outline in the picture.

use crate::command::{Command, SpraySurface};
use crate::sculpture::Rgb;
use crate::tools::brush::BrushId;
use crate::tools::brush::footprint::Footprint;
use crate::tools::brush::kernel::level::Level;
use crate::tools::brush::keys::{BITE, ONCE_PER_STROKE, RADIUS, REACH, STRENGTH, THRESHOLD};
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spray::{Effect, Smoothing, Spray};

/// Multiples of the golden section lie evenly between whole numbers.
const GOLDEN: f32 = 0.618_034;

/// The options of all brushes, each its own.
#[derive(Clone, PartialEq, Debug)]
pub struct Brushes([BrushOptions; BrushId::ALL.len()]);

impl Default for Brushes {
    fn default() -> Self {
        Brushes(std::array::from_fn(|i| BrushOptions::first(BrushId::ALL[i])))
    }
}

impl Brushes {
    pub fn of(&self, brush: BrushId) -> &BrushOptions {
        &self.0[brush as usize]
    }

    pub fn of_mut(&mut self, brush: BrushId) -> &mut BrushOptions {
        &mut self.0[brush as usize]
    }

    pub fn radius(&self, brush: BrushId) -> f32 {
        self.of(brush).get(RADIUS)
    }

    /// Changes the radii of all brushes.
    pub fn change_radii(&mut self, change: impl Fn(f32) -> f32) {
        self.0.iter_mut().for_each(|options| options.set(RADIUS, change(options.get(RADIUS))));
    }
}

/// The use of a brush under a footprint. `colour`: the one in hand; `uses`: of the stroke before it. None if the brush does
/// not work under one.
pub fn footprint_command(
    options: &BrushOptions,
    colour: Rgb,
    footprint: Footprint,
    uses: u32,
) -> Option<Command> {
    let (strength, threshold) = (options.get(STRENGTH), options.get(THRESHOLD));
    let mut reach_vx = options.get(REACH);
    let effect = match options.brush() {
        BrushId::Paint => Effect::Paintbrush { colour, cover: strength },
        BrushId::Devour => Effect::Devourer { outline: options.get(BITE) },
        BrushId::Erode => Effect::Erosion { threshold },
        BrushId::Dilate => Effect::Dilation { threshold, colour: None },
        BrushId::Grow => Effect::Growth { threshold, colour: None },
        BrushId::Smooth => {
            // As far from the surface as it smooths.
            reach_vx = 0.0;
            let rounding = (Level::NEAREST + uses as f32 * GOLDEN).fract();
            Effect::Smooth(Smoothing::Level(Level { strength, rounding }))
        }
        BrushId::Clay => Effect::Clay { colour },
        BrushId::Mask => Effect::Mask { adds: true },
        BrushId::Unmask => Effect::Mask { adds: false },
        _ => return None,
    };
    let surface = match options.get(ONCE_PER_STROKE) {
        true => SpraySurface::Stroke,
        false => SpraySurface::Now,
    };
    Some(Command::Spray { spray: Spray { effect, footprint, reach_vx }, surface })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::brush::footprint::{Coverage, Outline};
    use glam::Vec3;

    #[test]
    fn every_brush_is_usable_with_its_first_options_and_has_its_own() {
        let mut brushes = Brushes::default();
        let footprint = Footprint {
            eye_vx: Vec3::ZERO,
            aim: Vec3::Z,
            across: Vec3::X,
            down: Vec3::Y,
            radius: 20.0,
            outline: Outline::Round,
            coverage: Coverage::Visible,
        };
        for &brush in BrushId::ALL {
            assert_eq!(brushes.of(brush).brush(), brush);
            for uses in [0, 1, 7, 1000] {
                let command = footprint_command(brushes.of(brush), Rgb::STONE, footprint, uses);
                assert_eq!(command.is_some(), brush.spec().is_in_picture(), "{brush:?}");
                let Some(Command::Spray { spray, .. }) = command else { continue };
                assert_eq!(spray.effect.kind().brush(), brush);
                assert!(spray.check().is_ok(), "{brush:?}");
            }
        }
        brushes.of_mut(BrushId::Clay).set(RADIUS, 33.0);
        assert_eq!((brushes.radius(BrushId::Clay), brushes.radius(BrushId::Smooth)), (33.0, 20.0));
        brushes.change_radii(|radius| 2.0 * radius);
        assert_eq!((brushes.radius(BrushId::Clay), brushes.radius(BrushId::Grab)), (66.0, 120.0));
    }
}
