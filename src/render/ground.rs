//! Draws the ground below the sculpture: [`crate::shade::ground`] on the device.
//!
//! The light that reaches the ground is computed on the CPU, which has the voxels in every render mode, when voxels or
//! the sun have changed, and is kept on the device as an image. The shader shades the pixels. Drawn after the
//! sculpture, where nothing is in front; writes no depth.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::FrameDesc;
use super::composite_eye::is_srgb;
use crate::document::Document;
use crate::gpu::layout::GroundView;
use crate::gpu::{
    Blend, Depth, DescriptorSets, Device, EyeImage, FRAMES_IN_FLIGHT, Graphics, Pipeline,
    PipelineLayout, Recorder, Result, SetLayout, Staging, shaders,
};
use crate::shade::ground::{LightMap, MAP_EDGE, Openness, line_spacing_vx};
use crate::shade::shadow::ShadowSun;
use crate::shade::{Ground, GroundLight, GroundPicture, GroundPlane};
use crate::view::{Eye, PixelRays};

/// The values on which the light on the ground depends.
#[derive(Clone, Copy, PartialEq)]
struct Voxels {
    revision: u64,
    up: Vec3,
}

/// The pass, and the light that reaches the ground.
pub struct GroundPass {
    pipeline: Pipeline,
    sets: DescriptorSets,
    image: EyeImage,
    staging: Staging,
    /// The voxels for which the openness and the plane were computed.
    voxels: Option<Voxels>,
    plane: Option<GroundPlane>,
    openness: Openness,
    /// The sun of the map, besides the voxels.
    sun: Option<Option<ShadowSun>>,
    map: LightMap,
    slot: usize,
}

impl GroundPass {
    /// Creates one for targets of `format` with a depth buffer.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<GroundPass> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let bindings = [(0, vk::DescriptorType::SAMPLED_IMAGE, fragment)];
        let set_layout = SetLayout::new(device, "ground", &bindings)?;
        let push = Some((fragment, size_of::<GroundView>()));
        let layout = PipelineLayout::new(device, "ground", Some(&set_layout), push)?;
        let shader =
            if is_srgb(format) { shaders::GROUND_LINEAR_FRAG } else { shaders::GROUND_FRAG };
        // At infinite distance, like the background.
        let pass = Graphics::screen("ground", shader, &layout, format, Some(Depth::TEST_ONLY));
        let pipeline =
            Pipeline::graphics(device, &Graphics { colour: Some((format, Blend::Alpha)), ..pass })?;
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        let size = glam::UVec2::splat(MAP_EDGE as u32);
        let image =
            EyeImage::new(device, "light on the ground", size, 1, vk::Format::R8G8_UNORM, usage)?;
        let sets = DescriptorSets::new(device, "ground", &set_layout, FRAMES_IN_FLIGHT)?;
        (0..FRAMES_IN_FLIGHT).for_each(|set| sets.write_sampled(set, 0, image.image().view()));
        let bytes = (MAP_EDGE * MAP_EDGE * 2) as u64;
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        Ok(GroundPass {
            pipeline,
            sets,
            image,
            staging: Staging::new(device, "light on the ground", usage, bytes)?,
            voxels: None,
            plane: None,
            openness: Openness::default(),
            sun: None,
            map: LightMap::default(),
            slot: 0,
        })
    }

    /// Forgets the light on the ground.
    pub fn forget(&mut self) {
        (self.voxels, self.plane, self.sun) = (None, None, None);
    }

    /// Computes and uploads the light on the ground of `document`, unless it is known. Call before rendering begins,
    /// once per frame, in `slot`. The sun may be that of any of the eyes.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        desc: &FrameDesc,
    ) -> Result<()> {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.staging.begin(slot);
        let (Some(ground), Some(eye)) = (&desc.ground, desc.eyes.first()) else { return Ok(()) };
        let voxels = Some(Voxels { revision: document.revision(), up: ground.up });
        if self.voxels != voxels {
            self.plane = GroundPlane::below(document.grid(), ground.up);
            if let Some(plane) = &self.plane {
                self.openness = Openness::new(document.grid(), plane);
            }
            (self.voxels, self.sun) = (voxels, None);
        }
        let Some(plane) = &self.plane else { return Ok(()) };
        let sun = light(ground, plane, desc, eye).sun;
        if self.sun != Some(sun) {
            self.map.update(document.grid(), plane, &self.openness, sun.as_ref());
            let piece = self.staging.push(&self.map.texels, 4)?;
            self.image.upload_rows(recorder, 0, piece, 0..MAP_EDGE as u32);
            self.sun = Some(sun);
        }
        Ok(())
    }

    /// Draws the ground of `desc` for `eye`, whose pixels have `rays`, within rendering.
    pub fn draw(
        &self,
        recorder: &mut Recorder,
        document: &Document,
        desc: &FrameDesc,
        eye: &Eye,
        rays: &PixelRays,
    ) {
        let (Some(ground), Some(plane)) = (&desc.ground, &self.plane) else { return };
        let light = light(ground, plane, desc, eye);
        let spacing_vx = line_spacing_vx(document.grid().dims());
        let Some(picture) = GroundPicture::new(ground, plane, &light, rays, spacing_vx) else {
            return;
        };
        let GroundPicture { rows, light, tone, lines } = picture;
        recorder.bind_pipeline(&self.pipeline);
        recorder.bind_set(&self.pipeline, self.sets.set(self.slot));
        recorder.push(self.pipeline.layout(), &GroundView { rows, light, tone, lines });
        recorder.draw(3, 1);
    }
}

fn light(ground: &Ground, plane: &GroundPlane, desc: &FrameDesc, eye: &Eye) -> GroundLight {
    GroundLight::new(ground, plane, &desc.lighting, &eye.eye_from_world, &desc.world_from_grid)
}
