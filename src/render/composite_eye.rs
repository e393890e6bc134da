//! The drawing of an eye's picture in a target: its background, its pixels, and the push constants of the passes.
//!
//! Values alone; knows no pass and no device.

use ash::vk;
use glam::{Mat4, U64Vec2, UVec2, UVec3, Vec3};

use super::beam::TILE_LOG2;
use crate::gpu::layout::CompositeView;
use crate::surface::PixelRect;
use crate::view::PixelRays;

/// The background of the sculpture. Colours are sRGB, 0 to 1.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Background {
    /// Keeps the contents of the target.
    Keep,
    /// A gradient from the upper to the lower edge.
    Gradient { top: Vec3, bottom: Vec3 },
}

/// The drawing of an eye's picture in a target.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct CompositeEye {
    /// Its number among the eyes of the picture.
    pub eye: u32,
    /// The rays of the index map.
    pub rays: PixelRays,
    /// The projection of the target's depth.
    pub projection: Mat4,
    /// Size of the grid in voxels; zero if the index map on the device has entry times in place of linear indices.
    pub dims: UVec3,
    /// The eye's viewport in the target, in pixels: corner and size.
    pub corner: UVec2,
    pub size: UVec2,
    pub background: Background,
    /// The pixels of the map to draw; the target keeps its contents elsewhere.
    pub scissor: PixelRect,
    /// The visible rect: nothing is visible outside of it.
    pub visible: PixelRect,
}

impl CompositeEye {
    /// Returns the pixels of the target that correspond to pixels of the map: x, y, width, height.
    pub(super) fn pixels_of(&self, rect: PixelRect) -> [u32; 4] {
        let (size, map) = (self.size.as_u64vec2(), self.rays.size.as_u64vec2().max(U64Vec2::ONE));
        let (min, max) = (rect.min.as_u64vec2(), rect.max.as_u64vec2());
        let low = (min * size / map).as_uvec2();
        let high = ((max * size + map - 1) / map).as_uvec2().min(self.size);
        let [x, y] = (self.corner + low).to_array();
        let [width, height] = high.saturating_sub(low).to_array();
        [x, y, width, height]
    }

    /// Returns the scissor of the sculpture: x, y, width, height.
    pub(super) fn scissor(&self) -> [u32; 4] {
        self.pixels_of(self.visible.intersect(self.scissor))
    }
}

/// Returns the push constants of a pass that draws `view` over its background. `linear`: the target encodes its input.
pub(super) fn constants(view: &CompositeEye, linear: bool) -> CompositeView {
    let rays = &view.rays;
    let scale = rays.size.as_vec2() / view.size.as_vec2();
    let encode = |c: Vec3| if linear { c.powf(2.2) } else { c };
    let (top, bottom) = match view.background {
        Background::Keep => (Vec3::ZERO, Vec3::ZERO),
        Background::Gradient { top, bottom } => (encode(top), encode(bottom)),
    };
    // Clip z of a point is `z_axis.z * z + w_axis.z`, its z in eye space is -t.
    let projection = &view.projection;
    CompositeView {
        origin: rays.origin.to_array(),
        depth_slope: -projection.z_axis.z,
        corner: rays.corner.to_array(),
        depth_at_0: projection.w_axis.z,
        step_x: rays.step_x.to_array(),
        scale_x: scale.x,
        step_y: rays.step_y.to_array(),
        scale_y: scale.y,
        dims: view.dims.to_array(),
        tile_log2: TILE_LOG2,
        top: top.to_array(),
        left: view.corner.x as f32,
        bottom: bottom.to_array(),
        upper: view.corner.y as f32,
        size: rays.size.to_array(),
        linear: linear.into(),
        pad_0: 0,
    }
}

/// Returns whether the device encodes linear input for `format`.
pub fn is_srgb(format: vk::Format) -> bool {
    matches!(
        format,
        vk::Format::R8G8B8A8_SRGB | vk::Format::B8G8R8A8_SRGB | vk::Format::A8B8G8R8_SRGB_PACK32
    )
}
