//! Draws reference pictures: translucent rectangles in the scene, with mutual occlusion between them and the sculpture.
//!
//! Takes pictures with their placement as values, and keeps them on the device as long as they are given. Knows no
//! files.

use std::sync::Arc;

use ash::vk;
use glam::{Affine3A, Mat4};

use super::composite_eye::is_srgb;
use super::overlay_scene::OverlayDrawing;
use super::pictures::DEPTH_FORMAT;
use crate::gpu::{
    Blend, Depth, DescriptorSets, Device, EyeImage, FRAMES_IN_FLIGHT, Graphics, Pipeline,
    PipelineLayout, Recorder, Result, SetLayout, Staging, shaders,
};
use crate::shade::Pixels;

/// Most pictures shown at once; others are skipped.
pub const MAX_REFERENCES: usize = 8;

/// A picture and its place in the scene.
#[derive(Clone, Debug)]
pub struct ReferencePicture {
    /// The picture, at most 4096 pixels a side. Equal `Arc`s are uploaded once.
    pub pixels: Arc<Pixels>,
    /// To grid coordinates, from the picture's upper left corner at (0, 0) and its lower right one at (1, 1).
    pub grid_from_picture: Affine3A,
    /// 0 to 1. At 0 it stays on the device without being drawn.
    pub opacity: f32,
}

impl PartialEq for ReferencePicture {
    fn eq(&self, other: &ReferencePicture) -> bool {
        Arc::ptr_eq(&self.pixels, &other.pixels)
            && self.grid_from_picture == other.grid_from_picture
            && self.opacity == other.opacity
    }
}

/// Push constants of the `reference` stages.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct ReferenceConstants {
    clip_from_picture: [f32; 16],
    size: [f32; 2],
    opacity: f32,
    pad: f32,
}

/// The pass and the pictures on the device.
pub(super) struct References {
    pipeline: Pipeline,
    sets: DescriptorSets,
    /// The image that each set names.
    named: [u64; MAX_REFERENCES * FRAMES_IN_FLIGHT],
    pub shown: Vec<ReferencePicture>,
    images: Vec<(Arc<Pixels>, EyeImage)>,
    staging: Staging,
    slot: usize,
    /// The target stores linear values, encoded by the device.
    linear: bool,
    device: Arc<Device>,
}

impl References {
    /// Creates one for targets of `format` with a depth buffer.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<References> {
        let name = "reference pictures";
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let set_layout =
            SetLayout::new(device, name, &[(0, vk::DescriptorType::SAMPLED_IMAGE, fragment)])?;
        let push = Some((vk::ShaderStageFlags::VERTEX | fragment, size_of::<ReferenceConstants>()));
        let layout = PipelineLayout::new(device, name, Some(&set_layout), push)?;
        let depth = Depth { format: DEPTH_FORMAT, ..Depth::TEST_ONLY };
        let screen = Graphics::screen(name, shaders::REFERENCE_FRAG, &layout, format, Some(depth));
        let graphics = Graphics {
            vertex: shaders::REFERENCE_VERT,
            colour: Some((format, Blend::Alpha)),
            ..screen
        };
        let count = MAX_REFERENCES * FRAMES_IN_FLIGHT;
        Ok(References {
            pipeline: Pipeline::graphics(device, &graphics)?,
            sets: DescriptorSets::new(device, name, &set_layout, count)?,
            named: [0; MAX_REFERENCES * FRAMES_IN_FLIGHT],
            shown: Vec::new(),
            images: Vec::new(),
            staging: Staging::new(device, name, vk::BufferUsageFlags::TRANSFER_SRC, 1 << 20)?,
            slot: 0,
            linear: is_srgb(format),
            device: device.clone(),
        })
    }

    /// Uploads the new ones of `pictures`, and frees all others. Call before rendering begins.
    pub fn bring(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        pictures: &[ReferencePicture],
    ) -> Result<()> {
        self.staging.begin(slot);
        let is_in =
            |pixels: &Arc<Pixels>, picture: &ReferencePicture| Arc::ptr_eq(pixels, &picture.pixels);
        self.images.retain(|(pixels, _)| pictures.iter().any(|picture| is_in(pixels, picture)));
        self.shown.clear();
        for picture in pictures {
            let pixels = &picture.pixels;
            if !self.images.iter().any(|(known, _)| is_in(known, picture)) {
                // This format decodes for a target that encodes its input.
                let format = match self.linear {
                    true => vk::Format::R8G8B8A8_SRGB,
                    false => vk::Format::R8G8B8A8_UNORM,
                };
                let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
                let name = "reference picture";
                let mut image = EyeImage::new(&self.device, name, pixels.size, 1, format, usage)?;
                let piece = self.staging.push(pixels.bytes(), 4)?;
                image.upload_rows(recorder, 0, piece, 0..pixels.size.y);
                self.images.push((pixels.clone(), image));
            }
            self.shown.push(picture.clone());
        }
        Ok(())
    }

    /// Starts a frame that uses `slot` ([`crate::gpu::Frames::slot`]).
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
    }

    /// Records the pictures into a target with the depth of the sculpture, farthest first.
    pub fn draw(&mut self, recorder: &mut Recorder, scene: &OverlayDrawing) {
        let clip_from_grid = scene.projection * Mat4::from(scene.eye_from_grid);
        let mut order: Vec<(f32, &ReferencePicture)> = self
            .shown
            .iter()
            .filter(|picture| picture.opacity > 0.0)
            .map(|picture| {
                let middle = picture.grid_from_picture.transform_point3(glam::vec3(0.5, 0.5, 0.0));
                (scene.eye_from_grid.transform_point3(middle).z, picture)
            })
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        recorder.bind_pipeline(&self.pipeline);
        for (_, picture) in order {
            let known =
                |(pixels, _): &(Arc<Pixels>, EyeImage)| Arc::ptr_eq(pixels, &picture.pixels);
            let Some(at) = self.images.iter().position(known) else { continue };
            let image = self.images[at].1.image();
            let set = self.slot * MAX_REFERENCES + at;
            if self.named[set] != image.id() {
                self.named[set] = image.id();
                self.sets.write_sampled(set, 0, image.view());
            }
            let clip_from_picture = clip_from_grid * Mat4::from(picture.grid_from_picture);
            let constants = ReferenceConstants {
                clip_from_picture: clip_from_picture.to_cols_array(),
                size: picture.pixels.size.as_vec2().to_array(),
                opacity: picture.opacity,
                pad: 0.0,
            };
            recorder.bind_set(&self.pipeline, self.sets.set(set));
            recorder.push(self.pipeline.layout(), &constants);
            recorder.draw(6, 1);
        }
    }
}
