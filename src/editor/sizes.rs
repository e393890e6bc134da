//! The unit in which the sizes of all brushes are given, chosen once: pixels of the screen, so that a brush stays as large in
//! the picture however near the sculpture is, or the sculpture's own voxels, so that it stays as large there.
//!
//! Turns radii in that unit into what commands take: pixels for brushes that work on what is seen, voxels for those that
//! deform. How large a pixel is depends on where the brush works, which is asked of the view of the last picture.

use std::ops::RangeInclusive;

use glam::{Vec2, Vec3};

use super::tool::ToolState;
use crate::picking::Picker;
use crate::sculpture::Grid;
use crate::tools::brush::BrushId;
use crate::tools::brush::footprint::MAX_FOOTPRINT;
use crate::tools::brush::kernel::grab::{MAX_RADIUS, MIN_RADIUS};
use crate::tools::brush::keys::RADIUS;
use crate::tools::brush::options::BrushOptions;

/// The unit of the sizes of brushes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum SizeUnit {
    /// Pixels of the picture; in a headset what a pixel is an arm's length away.
    #[default]
    Screen,
    /// The smallest edge of a voxel.
    Sculpture,
}

impl SizeUnit {
    pub const ALL: [SizeUnit; 2] = [SizeUnit::Screen, SizeUnit::Sculpture];

    /// Its name in what is remembered.
    pub const fn name(self) -> &'static str {
        match self {
            SizeUnit::Screen => "screen",
            SizeUnit::Sculpture => "sculpture",
        }
    }

    /// The sign that stands behind a size.
    pub const fn suffix(self) -> &'static str {
        match self {
            SizeUnit::Screen => " px",
            SizeUnit::Sculpture => " vx",
        }
    }

    /// The radii that a brush may have.
    pub const fn radii(self) -> RangeInclusive<f32> {
        match self {
            SizeUnit::Screen => 1.0..=MAX_FOOTPRINT,
            SizeUnit::Sculpture => MIN_RADIUS..=MAX_RADIUS,
        }
    }
}

/// How large a pixel is before anything tells, in units of the smallest edge.
pub(super) const FIRST_GAUGE: f32 = 0.25;

/// How large a pixel is at a place, in units of the smallest edge.
pub(super) fn gauge_at(grid: &Grid, point: Vec3, picker: &Picker) -> f32 {
    let (sight, size) = (picker.sight(), grid.voxel_size());
    let depth = sight.depth(point);
    let across = sight.at_depth(Vec2::X, depth) - sight.at_depth(Vec2::ZERO, depth);
    (across * size / size.min_element()).length()
}

impl ToolState {
    /// The options of a brush that deforms, where the tool is: the radius in units of the smallest edge.
    pub(super) fn ball_options(&self, brush: BrushId) -> BrushOptions {
        self.brushes.of(brush).with(RADIUS, self.ball_radius(brush))
    }

    /// Takes how large a pixel is where the tool works, in units of the smallest edge.
    pub fn set_gauge(&mut self, gauge: f32) {
        if gauge.is_finite() && gauge > 0.0 {
            self.gauge = gauge;
        }
    }

    /// A radius in pixels, where a pixel is as large as `gauge`, or as where the tool is.
    pub fn radius_px(&self, radius: f32, gauge: Option<f32>) -> f32 {
        let pixels = match self.size_unit {
            SizeUnit::Screen => radius,
            SizeUnit::Sculpture => radius / gauge.unwrap_or(self.gauge),
        };
        pixels.clamp(1.0, MAX_FOOTPRINT)
    }

    /// The radius of the ball of a brush that deforms clay, in units of the smallest edge.
    pub fn ball_radius(&self, brush: BrushId) -> f32 {
        let radius = self.brushes.radius(brush);
        let units = match self.size_unit {
            SizeUnit::Screen => radius * self.gauge,
            SizeUnit::Sculpture => radius,
        };
        units.clamp(MIN_RADIUS, MAX_RADIUS)
    }

    /// A usual radius, which is one on the screen, in the unit in use.
    pub fn usual_radius(&self, radius_px: f32) -> f32 {
        let (least, most) = self.size_unit.radii().into_inner();
        match self.size_unit {
            SizeUnit::Screen => radius_px,
            SizeUnit::Sculpture => (radius_px * self.gauge).clamp(least, most),
        }
    }

    /// Gives the sizes of all brushes in another unit: they stay as large as they are where the tool is.
    pub fn set_size_unit(&mut self, unit: SizeUnit) {
        if unit == self.size_unit {
            return;
        }
        let factor = match unit {
            SizeUnit::Screen => self.gauge.recip(),
            SizeUnit::Sculpture => self.gauge,
        };
        let (least, most) = unit.radii().into_inner();
        self.brushes.change_radii(|radius| (radius * factor).clamp(least, most));
        self.size_unit = unit;
    }

    /// Makes a brush larger or smaller.
    pub(super) fn scale_brush(&mut self, brush: BrushId, factor: f32) {
        let (least, most) = self.size_unit.radii().into_inner();
        if factor.is_finite() && factor > 0.0 {
            let options = self.brushes.of_mut(brush);
            options.set(RADIUS, (options.get(RADIUS) * factor).clamp(least, most));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    #[test]
    fn brushes_keep_their_sizes_when_the_unit_changes_and_stay_so_in_that_unit() {
        let mut tool = ToolState::new(UVec3::splat(64));
        tool.set_gauge(0.5);
        tool.brushes.of_mut(BrushId::Clay).set(RADIUS, 40.0);
        tool.brushes.of_mut(BrushId::Draw).set(RADIUS, 60.0);
        let pixels = |tool: &ToolState| tool.radius_px(tool.brushes.radius(BrushId::Clay), None);
        assert_eq!((pixels(&tool), tool.ball_radius(BrushId::Draw)), (40.0, 30.0));
        tool.set_size_unit(SizeUnit::Sculpture);
        assert_eq!(tool.brushes.radius(BrushId::Clay), 20.0);
        assert_eq!((pixels(&tool), tool.ball_radius(BrushId::Draw)), (40.0, 30.0));
        // Twice as near: a size in voxels is twice as large in the picture.
        tool.set_gauge(0.25);
        assert_eq!((pixels(&tool), tool.ball_radius(BrushId::Draw)), (80.0, 30.0));
        tool.set_size_unit(SizeUnit::Screen);
        assert_eq!((pixels(&tool), tool.ball_radius(BrushId::Draw)), (80.0, 30.0));
        tool.set_gauge(0.5);
        assert_eq!((pixels(&tool), tool.ball_radius(BrushId::Draw)), (80.0, 60.0));
        for nonsense in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            tool.set_gauge(nonsense);
            assert_eq!(tool.ball_radius(BrushId::Draw), 60.0);
        }
    }

    #[test]
    fn sizes_stay_in_their_ranges() {
        let mut tool = ToolState::new(UVec3::splat(64));
        let clay = |tool: &ToolState| tool.brushes.radius(BrushId::Clay);
        for unit in SizeUnit::ALL {
            tool.set_size_unit(unit);
            let (least, most) = unit.radii().into_inner();
            for (factor, expected) in [(1e9, most), (1e-9, least), (f32::NAN, least)] {
                tool.scale_brush(BrushId::Clay, factor);
                assert_eq!(clay(&tool), expected, "{unit:?} {factor}");
            }
        }
        assert!(tool.brushes.radius(BrushId::Smooth) > 1.0, "each has its own");
    }
}
