//! The options of the spray tools, each tool its own.

use crate::command::{Command, SpraySurface};
use crate::sculpture::Rgb;
use crate::tools::brush::footprint::{Footprint, Outline};
use crate::tools::brush::kernel::level::Level;
use crate::tools::brush::spray::{Effect, Smoothing, Spray, SprayKind};

/// Multiples of the golden section lie evenly between whole numbers.
const GOLDEN: f32 = 0.618_034;

/// The options of one spray tool. What it has no use for is ignored.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SprayOptions {
    /// Of the footprint, in the unit of the sizes of brushes.
    pub radius: f32,
    pub outline: Outline,
    /// How far around a point under the footprint voxels may change.
    pub reach_vx: f32,
    /// What the devourer bites.
    pub bite: Outline,
    /// Of 26 neighbours.
    pub threshold: u32,
    /// Share of the colour that a pass of the paintbrush mixes in, or of the way to the smoothed surface, 0 to 1.
    pub strength: f32,
    /// Rays meet the surface as it was when the stroke began.
    pub surface: SpraySurface,
}

/// The options of all spray tools.
#[derive(Clone, PartialEq, Debug)]
pub struct Sprays([SprayOptions; SprayKind::ALL.len()]);

impl Default for Sprays {
    fn default() -> Self {
        Sprays(SprayKind::ALL.map(SprayOptions::of))
    }
}

impl SprayOptions {
    /// What a tool begins with.
    pub fn of(kind: SprayKind) -> SprayOptions {
        let options = SprayOptions {
            radius: 20.0,
            outline: Outline::Round,
            reach_vx: 3.0,
            bite: Outline::Round,
            threshold: 14,
            strength: 1.0,
            surface: SpraySurface::Stroke,
        };
        match kind {
            SprayKind::Paintbrush => SprayOptions { surface: SpraySurface::Now, ..options },
            SprayKind::Devourer => options,
            SprayKind::Mask | SprayKind::Unmask => SprayOptions { reach_vx: 4.0, ..options },
            SprayKind::Clay => SprayOptions { reach_vx: 4.0, ..options },
            // Filters work on what the last pass has left, deeper with each.
            SprayKind::Erosion => SprayOptions { surface: SpraySurface::Now, ..options },
            SprayKind::Dilation => {
                SprayOptions { threshold: 9, surface: SpraySurface::Now, ..options }
            }
            SprayKind::Growth => {
                SprayOptions { threshold: 12, surface: SpraySurface::Now, ..options }
            }
            SprayKind::Smooth => {
                SprayOptions { strength: 0.5, surface: SpraySurface::Now, ..options }
            }
        }
    }

    /// The use of the tool under a footprint. `uses`: of the stroke before it.
    pub fn command(
        &self,
        kind: SprayKind,
        colour: Rgb,
        footprint: Footprint,
        uses: u32,
    ) -> Command {
        let threshold = self.threshold;
        let (mut reach_vx, mut surface) = (self.reach_vx, self.surface);
        let effect = match kind {
            SprayKind::Paintbrush => Effect::Paintbrush { colour, cover: self.strength },
            SprayKind::Devourer => Effect::Devourer { outline: self.bite },
            SprayKind::Erosion => Effect::Erosion { threshold },
            SprayKind::Dilation => Effect::Dilation { threshold, colour: None },
            SprayKind::Growth => Effect::Growth { threshold, colour: None },
            SprayKind::Smooth => {
                // It goes on for as long as it is held, as far from the surface as it smooths.
                (reach_vx, surface) = (0.0, SpraySurface::Now);
                let rounding = (Level::NEAREST + uses as f32 * GOLDEN).fract();
                Effect::Smooth(Smoothing::Level(Level { strength: self.strength, rounding }))
            }
            SprayKind::Clay => Effect::Clay { colour },
            SprayKind::Mask => Effect::Mask { adds: true },
            SprayKind::Unmask => Effect::Mask { adds: false },
        };
        Command::Spray { spray: Spray { effect, footprint, reach_vx }, surface }
    }
}

impl Sprays {
    pub fn of(&self, kind: SprayKind) -> &SprayOptions {
        &self.0[place(kind)]
    }

    pub fn of_mut(&mut self, kind: SprayKind) -> &mut SprayOptions {
        &mut self.0[place(kind)]
    }
}

fn place(kind: SprayKind) -> usize {
    SprayKind::ALL.iter().position(|k| *k == kind).unwrap_or(0)
}

/// What the modifier that inverts the tool turns it into.
pub fn opposite(kind: SprayKind) -> SprayKind {
    match kind {
        SprayKind::Paintbrush | SprayKind::Smooth => kind,
        SprayKind::Devourer => SprayKind::Clay,
        SprayKind::Clay => SprayKind::Devourer,
        SprayKind::Erosion => SprayKind::Dilation,
        SprayKind::Dilation | SprayKind::Growth => SprayKind::Erosion,
        SprayKind::Mask => SprayKind::Unmask,
        SprayKind::Unmask => SprayKind::Mask,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::brush::footprint::Coverage;
    use glam::Vec3;

    #[test]
    fn every_tool_is_usable_with_its_first_options_and_has_its_own() {
        let mut sprays = Sprays::default();
        let footprint = Footprint {
            eye_vx: Vec3::ZERO,
            aim: Vec3::Z,
            across: Vec3::X,
            down: Vec3::Y,
            radius: 20.0,
            outline: Outline::Round,
            coverage: Coverage::Visible,
        };
        for kind in SprayKind::ALL {
            for uses in [0, 1, 7, 1000] {
                let command = sprays.of(kind).command(kind, Rgb::STONE, footprint, uses);
                let Command::Spray { spray, .. } = command else { panic!() };
                assert_eq!(spray.effect.kind(), kind);
                assert!(spray.check().is_ok(), "{kind:?}");
            }
        }
        sprays.of_mut(SprayKind::Clay).radius = 33.0;
        assert_ne!(sprays.of(SprayKind::Smooth).radius, 33.0);
    }
}
