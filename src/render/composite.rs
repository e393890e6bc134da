//! Owns the composite pass: the shaded picture of a sculpture goes over the background, with the
//! depth of its surface, so that tools drawn later stand before or behind it.
//!
//! Takes index maps (drawn by the device or made by the CPU), the pictures shaded from them,
//! and a colour target of any format with a D32 depth buffer. Owns the pictures on the device.

use std::ops::Range;
use std::sync::Arc;

use ash::vk;
use glam::{Mat4, U64Vec2, UVec2, UVec3, Vec3};

use super::background::{Background, BackgroundPass};
use super::beam::TILE_LOG2;
use super::target::IndexTarget;
use crate::gpu::layout::CompositeView;
use crate::gpu::{
    Depth, DescriptorSets, Device, EyeImage, FRAMES_IN_FLIGHT, Graphics, Pipeline, PipelineLayout,
    Recorder, Result, SetLayout, Staging, shaders,
};
use crate::shade::Pixels;
use crate::surface::PixelRect;
use crate::view::PixelRays;

/// The format of shaded pictures on the device.
pub(super) const PICTURE_FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// Where and how an eye's picture goes to the target.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct CompositeEye {
    /// The rays that the index map was made with.
    pub rays: PixelRays,
    /// The projection of the target's depth.
    pub projection: Mat4,
    /// Size of the grid in voxels.
    pub dims: UVec3,
    /// The eye's part of the target in pixels: corner and size.
    pub corner: UVec2,
    pub size: UVec2,
    pub background: Background,
    /// The pixels of the map to draw; what the target holds elsewhere stays.
    pub area: PixelRect,
    /// Outside of these pixels of the map nothing is seen.
    pub part: PixelRect,
}

impl CompositeEye {
    /// What pixels of the map cover of the target: x, y, width, height.
    pub(super) fn pixels_of(&self, part: PixelRect) -> [u32; 4] {
        let (size, map) = (self.size.as_u64vec2(), self.rays.size.as_u64vec2().max(U64Vec2::ONE));
        let (min, max) = (part.min.as_u64vec2(), part.max.as_u64vec2());
        let low = (min * size / map).as_uvec2();
        let high = ((max * size + map - 1) / map).as_uvec2().min(self.size);
        let [x, y] = (self.corner + low).to_array();
        let [width, height] = high.saturating_sub(low).to_array();
        [x, y, width, height]
    }

    /// Where the sculpture is to be drawn: x, y, width, height.
    pub(super) fn scissor(&self) -> [u32; 4] {
        self.pixels_of(self.part.intersect(self.area))
    }
}

/// Draws sculptures to a screen.
pub struct Composite {
    pipeline: Pipeline,
    background: BackgroundPass,
    sets: DescriptorSets,
    /// The index image and the picture that each set names.
    named: Vec<(u64, u64)>,
    pictures: Option<EyeImage>,
    /// The rows that the picture uploaded last for each eye has on the device.
    uploaded: Vec<Range<u32>>,
    staging: Staging,
    slot: usize,
    eyes: u32,
    /// The target stores linear values, encoded by the device.
    linear: bool,
    device: Arc<Device>,
}

impl Composite {
    /// For targets of `format` and up to `eyes` eyes.
    pub fn new(device: &Arc<Device>, format: vk::Format, eyes: u32) -> Result<Composite> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let image = vk::DescriptorType::SAMPLED_IMAGE;
        let bindings = [(0, image, fragment), (1, image, fragment)];
        let set_layout = SetLayout::new(device, "composite", &bindings)?;
        let push = Some((fragment, size_of::<CompositeView>()));
        let layout = PipelineLayout::new(device, "composite", Some(&set_layout), push)?;
        let fragment = match is_srgb(format) {
            true => shaders::COMPOSITE_LINEAR_FRAG,
            false => shaders::COMPOSITE_FRAG,
        };
        let depth = Some(Depth::OVERWRITE);
        let pass = Graphics::screen("composite", fragment, &layout, format, depth);
        let pipeline = Pipeline::graphics(device, &pass)?;
        let count = FRAMES_IN_FLIGHT * eyes as usize;
        Ok(Composite {
            pipeline,
            background: BackgroundPass::new(device, format)?,
            sets: DescriptorSets::new(device, "composite", &set_layout, count)?,
            named: vec![(0, 0); count],
            pictures: None,
            uploaded: vec![0..0; eyes as usize],
            staging: Staging::new(
                device,
                "shaded pictures",
                vk::BufferUsageFlags::TRANSFER_SRC,
                1 << 20,
            )?,
            slot: 0,
            eyes,
            linear: is_srgb(format),
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.staging.begin(slot);
    }

    /// The pictures of all eyes, `size` pixels each, for a pass that shades on the device. Before
    /// rendering begins; to be left in the layout of [`crate::gpu::Use::SHADER_READ`].
    pub fn pictures(&mut self, size: UVec2) -> Result<&mut EyeImage> {
        if self.pictures.as_ref().is_some_and(|pictures| pictures.size() != size) {
            self.pictures = None;
        }
        Ok(match &mut self.pictures {
            Some(pictures) => pictures,
            none => none.insert(EyeImage::new(
                &self.device,
                "shaded picture",
                size,
                self.eyes,
                PICTURE_FORMAT,
                vk::ImageUsageFlags::SAMPLED
                    | vk::ImageUsageFlags::STORAGE
                    | vk::ImageUsageFlags::COLOR_ATTACHMENT
                    | vk::ImageUsageFlags::TRANSFER_DST,
            )?),
        })
    }

    /// Uploads the picture of `eye`, the rows of `part` of it; only those of `changed`, if that is
    /// all that differs from the picture uploaded last. Before rendering begins; all eyes' pictures
    /// have the same size.
    pub fn upload(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        pixels: &Pixels,
        part: PixelRect,
        changed: Option<PixelRect>,
    ) -> Result<()> {
        let former = std::mem::replace(&mut self.uploaded[eye as usize], part.rows());
        let changed = changed.filter(|_| former == part.rows());
        let rect = changed.map_or(part, |changed| changed.intersect(part));
        let piece = self.staging.push(rect.rows_of(&pixels.rgba, pixels.size.x), 4)?;
        let image = self.pictures(pixels.size)?;
        match changed {
            Some(_) => image.update_rows(recorder, eye, piece, rect.rows()),
            None => image.upload_rows(recorder, eye, piece, rect.rows()),
        }
        Ok(())
    }

    /// Draws the background and the picture uploaded or shaded last for `eye`, within rendering. The map of `eye` in `maps`
    /// must be the one it was shaded from, and ready for shaders
    /// ([`IndexTarget::make_readable`]).
    pub fn draw(
        &mut self,
        recorder: &mut Recorder,
        maps: &IndexTarget,
        eye: u32,
        view: &CompositeEye,
    ) {
        self.background.draw(recorder, view);
        let Some(pictures) = &self.pictures else { return };
        let (index, picture) = (maps.index().image(), pictures.image());
        let set = self.slot * self.eyes as usize + eye as usize;
        if self.named[set] != (index.id(), picture.id()) {
            self.named[set] = (index.id(), picture.id());
            self.sets.write_sampled(set, 0, index.layer_view(eye));
            self.sets.write_sampled(set, 1, picture.layer_view(eye));
        }
        recorder.bind_pipeline(&self.pipeline);
        recorder.bind_set(&self.pipeline, self.sets.set(set));
        recorder.push(self.pipeline.layout(), &constants(view, self.linear));
        recorder.set_scissor(view.scissor());
        recorder.draw(3, 1);
    }
}

/// The constants of a pass that draws `view` over its background; `linear` where the target encodes
/// what it is given.
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

/// Whether the device encodes what is written to `format`.
pub fn is_srgb(format: vk::Format) -> bool {
    matches!(
        format,
        vk::Format::R8G8B8A8_SRGB | vk::Format::B8G8R8A8_SRGB | vk::Format::A8B8G8R8_SRGB_PACK32
    )
}
