//! Projects cubes of voxels to the picture: the pixels in which they may be visible.
//!
//! Takes the rays of a picture and aligned cubes, returns conservative rectangles of pixels.

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::{DMat3, DVec2, DVec3, UVec2, Vec3};

use crate::surface::index_map::PixelRect;
use crate::view::PixelRays;

/// The logarithm of the edge of the largest cube, in voxels: that around the cells of the longest grid.
pub(super) const MAX_LEVEL: usize = 14;

/// A rectangle of pixels of a tile, both ends inclusive.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct TileRect {
    pub x0: u32,
    pub x1: u32,
    pub y0: u32,
    pub y1: u32,
}

/// The position of a tile in the picture, in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileFrame {
    pub left: f32,
    pub top: f32,
    pub width: f32,
    pub height: f32,
}

/// The eight corners of a cube whose lower corner is the origin: `x s`, `y s` and `s`, where x and y are pixels and s
/// is the distance in lengths of the direction.
#[derive(Clone, Copy, Default, Debug)]
struct Corners {
    xs: [f32; 8],
    ys: [f32; 8],
    s: [f32; 8],
    /// Below this, the division by s would be too inexact (or s is not positive).
    least_s: f32,
}

/// Projects cubes of voxels to pixels.
#[derive(Clone, Debug)]
pub(in crate::surface) struct Projection {
    /// Rows that map a point relative to the eye to `x s`, `y s` and `s`.
    rows: [DVec3; 3],
    eye: DVec3,
    corners: [Corners; MAX_LEVEL + 1],
    /// Pixels by which rectangles are widened, for rounding here and in the rays.
    margin_px: [f32; 2],
}

impl Projection {
    /// Returns the projection; `None` if the rays do not span a picture.
    pub fn new(rays: &PixelRays) -> Option<Projection> {
        let axes = [rays.step_x, rays.step_y, rays.corner].map(Vec3::as_dvec3);
        let inverse = DMat3::from_cols(axes[0], axes[1], axes[2]).inverse();
        if !inverse.is_finite() || !rays.origin.is_finite() {
            return None;
        }
        let rows = [inverse.row(0), inverse.row(1), inverse.row(2)];
        let size = rays.size.as_dvec2();
        // A rounding of the direction, of a crossing or of the projection moves a ray by a fraction of its largest
        // component.
        let reach = axes[0].abs() * size.x + axes[1].abs() * size.y + axes[2].abs();
        let rounding = f64::from(f32::EPSILON) * 16.0;
        let margin_px = [0, 1].map(|i| (0.0625 + rounding * rows[i].abs().dot(reach)) as f32);
        let sums = rows.map(|row| row.abs().element_sum());
        let corners = std::array::from_fn(|level| {
            let edge = f64::from(1 << level);
            let of = |row: DVec3| {
                std::array::from_fn(|i| {
                    let corner = DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
                    (row.dot(corner) * edge) as f32
                })
            };
            // Keeps the error of the quotients well below the margin.
            let spread = sums[0].max(sums[1]) + size.max_element() * sums[2];
            let least_s = (rounding * 64.0 * edge * spread) as f32;
            Corners { xs: of(rows[0]), ys: of(rows[1]), s: of(rows[2]), least_s }
        });
        Some(Projection { rows, eye: rays.origin.as_dvec3(), corners, margin_px })
    }

    /// Returns the pixels of a picture of `size` whose rays may meet the box from `low` to `high`, in grid coordinates.
    pub(crate) fn pixels_of_box(&self, low: Vec3, high: Vec3, size: UVec2) -> PixelRect {
        let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (mut nearest, mut farthest) = (f64::INFINITY, f64::NEG_INFINITY);
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            let from_eye = DVec3::new(pick(0).into(), pick(1).into(), pick(2).into()) - self.eye;
            let [xs, ys, s] = self.rows.map(|row| row.dot(from_eye));
            (nearest, farthest) = (nearest.min(s), farthest.max(s));
            let at = DVec2::new(xs, ys) / s;
            (min, max) = (min.min(at), max.max(at));
        }
        if farthest <= 0.0 {
            return PixelRect::EMPTY;
        }
        // The nearest distance that the smallest cubes allow; anything nearer may be anywhere.
        if nearest < f64::from(self.corners[0].least_s) {
            return PixelRect::of_picture(size);
        }
        let margin = DVec2::from(self.margin_px.map(f64::from));
        let top = size.as_dvec2();
        // The centres of pixels are at half-integers.
        let low = (min - 0.5 - margin).ceil().clamp(DVec2::ZERO, top);
        let high = ((max - 0.5 + margin).floor() + 1.0).clamp(DVec2::ZERO, top);
        PixelRect { min: low.as_uvec2(), max: high.as_uvec2() }
    }

    /// Returns the rectangles of the eight children of a cube, in the order of their corners (bit 0 is x); `level` is
    /// that of a child. The mask has the children that may be visible in the tile at all.
    #[inline(always)]
    pub(super) fn children<S: Simd>(
        &self,
        simd: S,
        low: [i32; 3],
        level: usize,
        tile: &TileFrame,
    ) -> (u32, [TileRect; 8]) {
        let from_eye = DVec3::from(low.map(f64::from)) - self.eye;
        let corners = &self.corners[level];
        let splat = |v: f32| f32x8::splat(simd, v);
        let base = |row: usize, offsets: &[f32; 8]| {
            splat(self.rows[row].dot(from_eye) as f32) + f32x8::load_array_ref(simd, offsets)
        };
        let (xs, ys, s) = (base(0, &corners.xs), base(1, &corners.ys), base(2, &corners.s));
        let (mut x0, mut x1) = (splat(f32::INFINITY), splat(f32::NEG_INFINITY));
        let (mut y0, mut y1) = (x0, x1);
        let (mut s0, mut s1) = (x0, x1);
        for corner in 0..8 {
            let s = s + corners.s[corner];
            let per_s = splat(1.0) / s;
            let x = (xs + corners.xs[corner]) * per_s;
            let y = (ys + corners.ys[corner]) * per_s;
            (x0, x1) = (x0.min(x), x1.max(x));
            (y0, y1) = (y0.min(y), y1.max(y));
            (s0, s1) = (s0.min(s), s1.max(s));
        }
        let near: mask32x8<S> = s0.simd_lt(corners.least_s);
        let seen = s1.simd_gt(0.0);
        // The centres of pixels are at half-integers.
        let [margin_x, margin_y] = self.margin_px;
        let low_x = (x0 - (tile.left + 0.5 + margin_x)).ceil().max(0.0);
        let high_x = (x1 - (tile.left + 0.5 - margin_x)).floor().min(tile.width - 1.0);
        let low_y = (y0 - (tile.top + 0.5 + margin_y)).ceil().max(0.0);
        let high_y = (y1 - (tile.top + 0.5 - margin_y)).floor().min(tile.height - 1.0);
        let within = low_x.simd_le(high_x) & low_y.simd_le(high_y);
        let visible = seen & (near | within);
        let whole = |mask: mask32x8<S>, v: f32x8<S>, all: f32| -> [i32; 8] {
            mask.select(splat(all), v).to_int::<fearless_simd::i32x8<S>>().to_array()
        };
        let x0 = whole(near, low_x, 0.0);
        let x1 = whole(near, high_x, tile.width - 1.0);
        let y0 = whole(near, low_y, 0.0);
        let y1 = whole(near, high_y, tile.height - 1.0);
        let rects = std::array::from_fn(|i| TileRect {
            x0: x0[i] as u32,
            x1: x1[i] as u32,
            y0: y0[i] as u32,
            y1: y1[i] as u32,
        });
        (visible.to_bitmask() as u32, rects)
    }
}
