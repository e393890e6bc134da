//! The pixels of tools and lines in a picture, which must be redrawn when these move.
//!
//! Pure geometry, a conservative twin of the overlay's shaders. Knows no device.

use std::iter;

use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};

use super::overlay_scene::{OverlayLine, ToolPreview, grid_from_tool};
use crate::surface::{PixelRect, PixelRects};

/// Margin around the bounding box of a shape's corners, for rounding.
const MARGIN_PX: f32 = 1.0;

/// Pixels on either side of a line covered by its soft edge (overlay_line.vert.wgsl).
const SOFT_EDGE_PX: f32 = 1.0;

/// The projection of the grid to a picture of `size` pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct PictureOfGrid {
    pub clip_from_grid: Mat4,
    pub size: UVec2,
}

impl PictureOfGrid {
    /// Adds to `rects` the pixels of tools and lines that differ between `before` and `now`,
    /// compared by their positions in the lists.
    pub fn add_changes(
        &self,
        before: (&[ToolPreview], &[OverlayLine]),
        now: (&[ToolPreview], &[OverlayLine]),
        rects: &mut PixelRects,
    ) {
        for preview in differing(before.0, now.0) {
            rects.add(self.pixels_of_ghost(preview));
        }
        for line in differing(before.1, now.1) {
            rects.add(self.pixels_of_line(line));
        }
    }

    fn pixels_of_ghost(&self, preview: &ToolPreview) -> PixelRect {
        if preview.opacity.iter().all(|&opacity| opacity <= 0.0) {
            return PixelRect::EMPTY;
        }
        let grid_from_tool = grid_from_tool(&preview.primitive, preview.voxel_size);
        let corners: [Vec3; 8] = std::array::from_fn(|corner| {
            let side = |bit: usize| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
            grid_from_tool.transform_point3(Vec3::new(side(0), side(1), side(2)))
        });
        self.pixels_about(&corners, MARGIN_PX)
    }

    fn pixels_of_line(&self, line: &OverlayLine) -> PixelRect {
        if line.opacity.iter().all(|&opacity| opacity <= 0.0) {
            return PixelRect::EMPTY;
        }
        let reach = 0.5 * line.width_px + SOFT_EDGE_PX + MARGIN_PX;
        self.pixels_about(&[line.from, line.to], reach)
    }

    /// Returns the bounding rectangle of points in the grid, grown by `reach_px`.
    fn pixels_about(&self, points: &[Vec3], reach_px: f32) -> PixelRect {
        let clip = |point: &Vec3| self.clip_from_grid * point.extend(1.0);
        // Clip z is the near distance everywhere: reversed depth without a far plane.
        let is_seen = |clip: Vec4| clip.w >= clip.z && clip.w > 0.0;
        let seen = points.iter().filter(|point| is_seen(clip(point))).count();
        let picture = PixelRect::of_picture(self.size);
        match seen {
            0 => return PixelRect::EMPTY,
            some if some < points.len() => return picture,
            _ => {}
        }
        let half = 0.5 * self.size.as_vec2();
        let pixels = points.iter().map(|point| {
            let clip = clip(point);
            (Vec2::new(clip.x, clip.y) / clip.w + 1.0) * half
        });
        let (low, high) = pixels
            .fold((Vec2::MAX, Vec2::MIN), |(low, high), pixel| (low.min(pixel), high.max(pixel)));
        if !(low.is_finite() && high.is_finite()) {
            return picture;
        }
        // Casts saturate.
        let min = (low - reach_px).floor().as_uvec2();
        let max = (high + reach_px).ceil().as_uvec2();
        PixelRect { min, max }.intersect(picture)
    }
}

/// Returns the elements of two lists that differ at the same position.
fn differing<'a, T: PartialEq>(
    before: &'a [T],
    now: &'a [T],
) -> impl Iterator<Item = &'a T> + use<'a, T> {
    let longest = before.len().max(now.len());
    (0..longest)
        .map(|i| (before.get(i), now.get(i)))
        .filter(|(before, now)| before != now)
        .flat_map(|(before, now)| iter::chain(before, now))
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Quat};

    use super::*;
    use crate::sculpture::Rgb;
    use crate::tools::solid::{Primitive, Solid};
    use crate::view::Camera;

    const SIZE: UVec2 = UVec2::new(800, 400);

    fn picture() -> PictureOfGrid {
        let camera = Camera { eye: Vec3::Z * 100.0, ..Camera::default() };
        let clip_from_grid = camera.eye(SIZE).clip_from_grid(&Affine3A::IDENTITY);
        PictureOfGrid { clip_from_grid, size: SIZE }
    }

    fn line(from: Vec3, to: Vec3) -> OverlayLine {
        let colour = Rgb::new(1, 2, 3);
        OverlayLine { from, to, colour, width_px: 4.0, opacity: [1.0, 0.0] }
    }

    fn preview(centre_vx: Vec3) -> ToolPreview {
        let primitive = Primitive {
            solid: Solid::Cuboid,
            centre_vx,
            half: Vec3::splat(3.0),
            rotation: Quat::from_rotation_z(0.3),
        };
        let colour = Rgb::new(9, 9, 9);
        ToolPreview { primitive, voxel_size: Vec3::ONE, colour, opacity: [0.4, 0.1] }
    }

    fn changes(
        before: (&[ToolPreview], &[OverlayLine]),
        now: (&[ToolPreview], &[OverlayLine]),
    ) -> PixelRects {
        let mut rects = PixelRects::NONE;
        picture().add_changes(before, now, &mut rects);
        rects
    }

    #[test]
    fn a_resting_tool_changes_no_pixels_and_a_moving_one_both_places() {
        let (here, there) = (preview(Vec3::ZERO), preview(Vec3::new(30.0, 0.0, 0.0)));
        let frame = line(Vec3::splat(-30.0), Vec3::splat(30.0));
        assert!(changes((&[here], &[frame]), (&[here], &[frame])).is_empty());
        let moved = changes((&[here], &[frame]), (&[there], &[frame]));
        assert_eq!(moved.as_slice().len(), 2);
        assert!(moved.pixel_count() < 2 * 60 * 60, "{moved:?}");
        assert_eq!(changes((&[], &[]), (&[here], &[])).as_slice()[0], moved.as_slice()[0]);
        // The centre of the picture is the centre of the first.
        let PixelRect { min, max } = moved.as_slice()[0];
        assert_eq!(min + max, SIZE);
        let hidden = ToolPreview { opacity: [0.0; 2], ..there };
        assert_eq!(changes((&[here], &[]), (&[hidden], &[])).as_slice().len(), 1);
    }

    #[test]
    fn a_line_is_as_wide_as_it_is_drawn() {
        let flat = line(Vec3::new(-10.0, 0.0, 0.0), Vec3::new(10.0, 0.0, 0.0));
        let rects = changes((&[], &[]), (&[], &[flat]));
        let PixelRect { min, max } = rects.bounds();
        assert!(max.y - min.y >= 6 && max.y - min.y <= 10, "{rects:?}");
    }

    #[test]
    fn a_line_that_reaches_behind_the_eye_may_be_anywhere() {
        let behind = Vec3::Z * 200.0;
        let through = line(Vec3::ZERO, behind);
        let whole = PixelRect::of_picture(SIZE);
        assert_eq!(changes((&[], &[]), (&[], &[through])).as_slice(), [whole]);
        let unseen = line(behind, behind + Vec3::X);
        assert!(changes((&[], &[]), (&[], &[unseen])).is_empty());
    }
}
