//! The pointer on the surface, guiding a stroke.
//!
//! Takes pixels of the picture; gives points of the surface as it was seen at the start, so that additions and cuts of
//! the stroke do not deflect it. Knows no tool and changes nothing.

use std::sync::Arc;

use glam::{IVec3, Vec2, Vec3};

use crate::picking::Picker;
use crate::picking::geometry::{lasting, shifted_surface_point};
use crate::sculpture::Grid;
use crate::surface::IndexMap;

/// Pixels between two samples of the surface along a drag.
const LOOK_EVERY_PX: f32 = 3.0;
/// Most samples of the surface along a drag.
const MOST_LOOKS: f32 = 1024.0;
/// A longer step on the surface, in tool sizes, is a jump over an edge.
pub(super) const LEAP: f32 = 2.0;
/// Most steps along a radius that samples the surface for its normal.
const STEPS: f32 = 10.0;

/// The pointer on the surface.
pub(super) struct SurfaceGuide {
    seen: Option<Arc<IndexMap>>,
    /// How far the grid's coordinates have moved since then, in voxels.
    shift_vx: IVec3,
    /// Its position, in pixels.
    at: Vec2,
    /// Depth of the last point, used where the pointer is beside the sculpture.
    depth: f32,
}

impl SurfaceGuide {
    /// Starts with the pointer at `at` (pixels) on `point` of the surface.
    pub fn new(at: Vec2, point: Vec3, grid: &Grid, picker: &Picker) -> SurfaceGuide {
        let seen = picker.map().map(|map| lasting(map, grid));
        SurfaceGuide { seen, shift_vx: IVec3::ZERO, at, depth: picker.sight().depth(point) }
    }

    /// Moves along with the coordinates of the grid.
    pub fn shift(&mut self, by_vx: Vec3) {
        self.shift_vx += by_vx.as_ivec3();
    }

    /// Returns whether the view is still that of the recorded surface.
    pub fn is_of(&self, picker: &Picker) -> bool {
        self.seen.as_ref().map(|seen| seen.rays) == picker.map().map(|map| map.rays)
    }

    /// Goes straight to `to` (pixels), pulled by a rope of `rope_px`, and gives the points under its path.
    pub fn go_to(
        &mut self,
        to: Vec2,
        rope_px: f32,
        grid: &Grid,
        picker: &Picker,
        mut point: impl FnMut(Vec3),
    ) {
        if !to.is_finite() {
            return;
        }
        let from = self.at;
        let to = on_rope(from, to, rope_px);
        let looks = (to.distance(from) / LOOK_EVERY_PX).ceil().clamp(1.0, MOST_LOOKS) as u32;
        for i in 1..=looks {
            point(self.point_at(from.lerp(to, i as f32 / looks as f32), grid, picker));
        }
        self.at = to;
    }

    /// Returns the point under `look` (pixels).
    fn point_at(&mut self, look: Vec2, grid: &Grid, picker: &Picker) -> Vec3 {
        let sight = picker.sight();
        let found = self
            .seen
            .as_ref()
            .and_then(|map| shifted_surface_point(map, grid, look, self.shift_vx));
        let point = found.map_or_else(|| sight.at_depth(look, self.depth), |seen| seen.point);
        self.depth = sight.depth(point);
        point
    }
}

/// Returns the position of a pointer at `from` when its rope is pulled to `to`. It stays while the rope is slack, so
/// that a trembling hand draws an even line.
fn on_rope(from: Vec2, to: Vec2, length_px: f32) -> Vec2 {
    let left = (to.distance(from) - length_px).max(0.0);
    from.move_towards(to, left)
}

/// Returns the direction out of the clay in a ball: away from the clay's centre. Returns `None` if the ball is empty or
/// full.
pub(super) fn normal_around(grid: &Grid, centre: Vec3, radius: f32) -> Option<Vec3> {
    let edges = grid.voxel_size() / grid.voxel_size().min_element();
    let reach = radius.max(2.0);
    let step = (reach / STEPS).max(1.0);
    let steps = (reach / step) as i32;
    let mut sum = Vec3::ZERO;
    for z in -steps..=steps {
        for y in -steps..=steps {
            for x in -steps..=steps {
                let offset = IVec3::new(x, y, z).as_vec3() * step;
                let v = (centre + offset / edges).floor().as_ivec3();
                if offset.length() <= reach && grid.get(v) {
                    sum -= offset;
                }
            }
        }
    }
    (sum.length() > 0.05 * reach).then_some(sum)
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    #[test]
    fn a_brush_follows_at_the_end_of_its_rope_and_evens_out_what_trembles() {
        assert_eq!(on_rope(Vec2::ZERO, Vec2::new(30.0, 40.0), 0.0), Vec2::new(30.0, 40.0));
        assert_eq!(on_rope(Vec2::ZERO, Vec2::new(3.0, 4.0), 5.0), Vec2::ZERO);
        assert_eq!(on_rope(Vec2::ZERO, Vec2::new(6.0, 8.0), 5.0), Vec2::new(3.0, 4.0));
        // A line with a zigzag of 4 pixels to each side.
        let widest = |length_px: f32| {
            let mut at = Vec2::ZERO;
            let mut widest = 0.0f32;
            for i in 1..200 {
                let side = if i % 2 == 0 { 4.0 } else { -4.0 };
                at = on_rope(at, Vec2::new(i as f32 * 2.0, side), length_px);
                widest = widest.max(if i > 100 { at.y.abs() } else { 0.0 });
            }
            widest
        };
        assert_eq!(widest(0.0), 4.0);
        assert!(widest(40.0) < 1.0, "{}", widest(40.0));
    }

    #[test]
    fn the_plane_of_a_surface_is_found_and_there_is_none_within_or_outside_clay() {
        let mut grid = Grid::new(UVec3::splat(48), Vec3::ONE, 1 << 30).unwrap();
        let way = Vec3::new(2.0, 3.0, -1.0).normalize();
        for i in 0..48 * 48 * 48 {
            let v = grid.voxel_coords(i);
            grid.set(v.as_ivec3(), (v.as_vec3() - 23.5).dot(way) < 0.0);
        }
        for radius in [3.0, 9.0, 20.0] {
            let normal = normal_around(&grid, Vec3::splat(24.0), radius).unwrap().normalize();
            assert!(normal.dot(way) > 0.97, "{radius}: {normal}");
        }
        assert_eq!(normal_around(&grid, Vec3::splat(24.0) + way * 12.0, 6.0), None);
        let within = normal_around(&grid, Vec3::splat(24.0) - way * 12.0, 6.0);
        assert!(within.is_none_or(|n| n.length() < 30.0), "{within:?}");
    }
}
