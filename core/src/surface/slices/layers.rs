//! The layers of a grid in front-to-back order for an eye, and their areas in view.

use glam::{Vec2, Vec3};

use super::areas::{SlabAreas, SliceArea, slab_size};
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::view::PixelRays;
use glam::UVec3;

/// A layer whose nearer side is closer to the eye than this, in voxels, covers the picture.
const TOUCHING_VX: f32 = 1e-2;

/// Returns the axis along which the eye looks at the grid most directly: that of the nearest side for an eye outside,
/// that of the view for an eye inside.
pub fn facing_axis(rays: &PixelRays, dims: UVec3) -> usize {
    let dims = dims.as_vec3();
    let inside = rays.origin.cmpge(Vec3::ZERO).all() && rays.origin.cmple(dims).all();
    let look = if inside {
        rays.direction_at(0.5 * rays.size.x as f32, 0.5 * rays.size.y as f32)
    } else {
        rays.origin - 0.5 * dims
    };
    let along = look.abs();
    if along.x > along.y && along.x > along.z {
        0
    } else if along.y > along.z {
        1
    } else {
        2
    }
}

/// Voxels between two planes across the axis, `first..end`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SliceLayer {
    /// First voxel along the axis.
    pub first: u32,
    /// One past the last voxel along the axis.
    pub end: u32,
    /// The layer is nearer to the eye than all layers with a higher rank on its side of the eye.
    pub rank: u32,
}

/// The part of a layer to draw: a rectangle of voxels in it, or (`None`) all of the picture, because the eye is in the
/// layer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LayerRect {
    /// The layer.
    pub layer: SliceLayer,
    /// The rectangle to draw, in voxels across the axis.
    pub rect: Option<SliceArea>,
}

/// The layers across an axis, in the order from an eye.
#[derive(Clone, Copy, Debug)]
pub struct SliceLayers {
    axis: usize,
    thickness: u32,
    slab: u32,
    dims: UVec3,
    frustum: FrustumPlanes,
    eye: f32,
}

impl SliceLayers {
    /// Returns layers of `thickness` voxels, a whole number of which make a slab of `slab` voxels.
    pub fn new(
        rays: &PixelRays,
        dims: UVec3,
        axis: usize,
        thickness: u32,
        slab: u32,
    ) -> SliceLayers {
        let frustum = FrustumPlanes::new(rays);
        SliceLayers { axis, thickness, slab, dims, frustum, eye: rays.origin[axis] }
    }

    /// Calls `draw` with everything that may be visible, front to back: of two layers on a ray, the one that the ray
    /// enters first has the lower rank and is drawn first. `slabs` are the areas along the axis.
    pub fn for_each(&self, slabs: &[SlabAreas], mut draw: impl FnMut(LayerRect)) {
        let count = self.dims[self.axis].div_ceil(self.thickness);
        // The layers before `below` lie below the eye, those from `above` on above it.
        let at = |limit: f32| (limit / self.thickness as f32).clamp(0.0, count as f32);
        let below = at(self.eye - TOUCHING_VX).floor() as u32;
        let above = at(self.eye + TOUCHING_VX).ceil() as u32;
        for index in below..above {
            let layer = self.layer(index, index - below);
            draw(LayerRect { layer, rect: None });
        }
        let rank = above.saturating_sub(below);
        for index in (0..below).rev() {
            self.draw_areas(slabs, self.layer(index, rank + below - 1 - index), &mut draw);
        }
        for index in above..count {
            self.draw_areas(slabs, self.layer(index, rank + index - above), &mut draw);
        }
    }

    fn layer(&self, index: u32, rank: u32) -> SliceLayer {
        let first = index * self.thickness;
        SliceLayer { first, end: (first + self.thickness).min(self.dims[self.axis]), rank }
    }

    fn draw_areas(&self, slabs: &[SlabAreas], layer: SliceLayer, draw: &mut impl FnMut(LayerRect)) {
        let size = slab_size(self.axis, self.dims);
        for area in &slabs[(layer.first / self.slab) as usize] {
            let min = area.min * BRICK_EDGE_VX;
            let rect = SliceArea { min, max: (area.max * BRICK_EDGE_VX).min(size) };
            let (low, high) = self.corners(&layer, &rect);
            if self.frustum.touches(low, high) {
                draw(LayerRect { layer, rect: Some(rect) });
            }
        }
    }

    fn corners(&self, layer: &SliceLayer, rect: &SliceArea) -> (Vec3, Vec3) {
        let place = |d: u32, uv: Vec2| {
            let mut p = Vec3::ZERO;
            p[self.axis] = d as f32;
            p[(self.axis + 1) % 3] = uv.x;
            p[(self.axis + 2) % 3] = uv.y;
            p
        };
        (place(layer.first, rect.min.as_vec2()), place(layer.end, rect.max.as_vec2()))
    }
}

/// The planes of a view: through the eye and the picture's four sides, and across the view. The inside is where `normal
/// . (p - origin) >= 0`.
#[derive(Clone, Copy, Debug)]
struct FrustumPlanes {
    origin: Vec3,
    normals: [Vec3; 5],
}

impl FrustumPlanes {
    fn new(rays: &PixelRays) -> FrustumPlanes {
        let size = rays.size.as_vec2();
        let middle = rays.direction_at(0.5 * size.x, 0.5 * size.y);
        let corner = |x: f32, y: f32| rays.direction_at(x * size.x, y * size.y);
        let ring = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        let facing = |normal: Vec3| if normal.dot(middle) < 0.0 { -normal } else { normal };
        let side = |i: usize| facing(ring[i].cross(ring[(i + 1) % 4]));
        // The steps along rows and columns span the plane across the view.
        let across = facing(rays.step_x.cross(rays.step_y));
        FrustumPlanes { origin: rays.origin, normals: [side(0), side(1), side(2), side(3), across] }
    }

    /// Returns whether a box may touch the view. Returns false only if the box lies outside one plane.
    fn touches(&self, low: Vec3, high: Vec3) -> bool {
        let (low, high) = (low - self.origin, high - self.origin);
        self.normals.iter().all(|&n| {
            let farthest = Vec3::select(n.cmpge(Vec3::ZERO), high, low);
            n.dot(farthest) >= 0.0
        })
    }
}
