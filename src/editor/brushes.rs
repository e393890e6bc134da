//! The options of all brushes, and the unit of their sizes.
//!
//! Converts radii in that unit to those of commands: pixels for brushes that work in the picture, units of the smallest
//! edge for those that deform. Its owner sets the size of a pixel; it knows no pictures.

use super::sizes::{FIRST_GAUGE, SizeUnit};
use crate::tools::brush::BrushId;
use crate::tools::brush::footprint::MAX_FOOTPRINT;
use crate::tools::brush::kernel::grab::{MAX_RADIUS, MIN_RADIUS};
use crate::tools::brush::keys::RADIUS;
use crate::tools::brush::options::BrushOptions;

/// The options of every brush, and the unit of their sizes.
#[derive(Clone, PartialEq, Debug)]
pub struct Brushes {
    options: [BrushOptions; BrushId::ALL.len()],
    /// The unit of the sizes of all brushes.
    pub unit: SizeUnit,
    /// Size of a pixel where they work, in units of the smallest edge.
    gauge: f32,
}

impl Default for Brushes {
    fn default() -> Self {
        let options = std::array::from_fn(|i| BrushOptions::first(BrushId::ALL[i]));
        Brushes { options, unit: SizeUnit::default(), gauge: FIRST_GAUGE }
    }
}

impl Brushes {
    pub fn of(&self, brush: BrushId) -> &BrushOptions {
        &self.options[brush as usize]
    }

    pub fn of_mut(&mut self, brush: BrushId) -> &mut BrushOptions {
        &mut self.options[brush as usize]
    }

    pub fn radius(&self, brush: BrushId) -> f32 {
        self.of(brush).get(RADIUS)
    }

    /// Changes the radii of all brushes.
    fn change_radii(&mut self, change: impl Fn(f32) -> f32) {
        self.options
            .iter_mut()
            .for_each(|options| options.set(RADIUS, change(options.get(RADIUS))));
    }

    /// Returns the options of a deforming brush at its place of work: the radius is in units of the smallest edge.
    pub fn ball_options(&self, brush: BrushId) -> BrushOptions {
        self.of(brush).with(RADIUS, self.ball_radius(brush))
    }

    /// Sets the size of a pixel where the tool works, in units of the smallest edge.
    pub fn set_gauge(&mut self, gauge: f32) {
        if gauge.is_finite() && gauge > 0.0 {
            self.gauge = gauge;
        }
    }

    /// Returns a radius in pixels for a pixel size of `gauge`, or of the place of work.
    pub fn radius_px(&self, radius: f32, gauge: Option<f32>) -> f32 {
        let pixels = match self.unit {
            SizeUnit::Screen => radius,
            SizeUnit::Sculpture => radius / gauge.unwrap_or(self.gauge),
        };
        pixels.clamp(1.0, MAX_FOOTPRINT)
    }

    /// Returns the radius of the ball of a brush that deforms clay, in units of the smallest edge.
    pub fn ball_radius(&self, brush: BrushId) -> f32 {
        let radius = self.radius(brush);
        let units = match self.unit {
            SizeUnit::Screen => radius * self.gauge,
            SizeUnit::Sculpture => radius,
        };
        units.clamp(MIN_RADIUS, MAX_RADIUS)
    }

    /// Returns a default radius, given on the screen, in the present unit.
    pub fn usual_radius(&self, radius_px: f32) -> f32 {
        let (least, most) = self.unit.radii().into_inner();
        match self.unit {
            SizeUnit::Screen => radius_px,
            SizeUnit::Sculpture => (radius_px * self.gauge).clamp(least, most),
        }
    }

    /// Changes the unit of the sizes of all brushes, which keep their size where they work.
    pub fn set_unit(&mut self, unit: SizeUnit) {
        if unit == self.unit {
            return;
        }
        let factor = match unit {
            SizeUnit::Screen => self.gauge.recip(),
            SizeUnit::Sculpture => self.gauge,
        };
        let (least, most) = unit.radii().into_inner();
        self.change_radii(|radius| (radius * factor).clamp(least, most));
        self.unit = unit;
    }

    /// Scales a brush.
    pub fn scale(&mut self, brush: BrushId, factor: f32) {
        let (least, most) = self.unit.radii().into_inner();
        if factor.is_finite() && factor > 0.0 {
            let options = self.of_mut(brush);
            options.set(RADIUS, (options.get(RADIUS) * factor).clamp(least, most));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_brush_has_options_of_its_own() {
        let mut brushes = Brushes::default();
        assert!(BrushId::ALL.iter().all(|brush| brushes.of(*brush).brush() == *brush));
        brushes.of_mut(BrushId::Clay).set(RADIUS, 33.0);
        assert_eq!((brushes.radius(BrushId::Clay), brushes.radius(BrushId::Smooth)), (33.0, 20.0));
        brushes.change_radii(|radius| 2.0 * radius);
        assert_eq!((brushes.radius(BrushId::Clay), brushes.radius(BrushId::Grab)), (66.0, 120.0));
    }

    #[test]
    fn brushes_keep_their_sizes_when_the_unit_changes_and_stay_so_in_that_unit() {
        let mut brushes = Brushes::default();
        brushes.set_gauge(0.5);
        brushes.of_mut(BrushId::Clay).set(RADIUS, 40.0);
        brushes.of_mut(BrushId::Draw).set(RADIUS, 60.0);
        let pixels = |brushes: &Brushes| brushes.radius_px(brushes.radius(BrushId::Clay), None);
        assert_eq!((pixels(&brushes), brushes.ball_radius(BrushId::Draw)), (40.0, 30.0));
        brushes.set_unit(SizeUnit::Sculpture);
        assert_eq!(brushes.radius(BrushId::Clay), 20.0);
        assert_eq!((pixels(&brushes), brushes.ball_radius(BrushId::Draw)), (40.0, 30.0));
        // Twice as near: a size in voxels is twice as large in the picture.
        brushes.set_gauge(0.25);
        assert_eq!((pixels(&brushes), brushes.ball_radius(BrushId::Draw)), (80.0, 30.0));
        brushes.set_unit(SizeUnit::Screen);
        assert_eq!((pixels(&brushes), brushes.ball_radius(BrushId::Draw)), (80.0, 30.0));
        brushes.set_gauge(0.5);
        assert_eq!((pixels(&brushes), brushes.ball_radius(BrushId::Draw)), (80.0, 60.0));
        for nonsense in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            brushes.set_gauge(nonsense);
            assert_eq!(brushes.ball_radius(BrushId::Draw), 60.0);
        }
    }

    #[test]
    fn sizes_stay_in_their_ranges() {
        let mut brushes = Brushes::default();
        let clay = |brushes: &Brushes| brushes.radius(BrushId::Clay);
        for unit in SizeUnit::ALL {
            brushes.set_unit(unit);
            let (least, most) = unit.radii().into_inner();
            for (factor, expected) in [(1e9, most), (1e-9, least), (f32::NAN, least)] {
                brushes.scale(BrushId::Clay, factor);
                assert_eq!(clay(&brushes), expected, "{unit:?} {factor}");
            }
        }
        assert!(brushes.radius(BrushId::Smooth) > 1.0, "each has its own");
    }
}
