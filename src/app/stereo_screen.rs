//! The resources of a window that shows two eyes: an image for the interface, and the pass that composites pictures and
//! interface.
//!
//! Created when stereo is first switched on. Knows no workspace.

use std::sync::Arc;

use ash::vk;
use glam::{IVec2, UVec2};

use crate::gpu::{Attachment, Device, EyeImage, Load, Recorder, ResourceUse, Result};
use crate::render::{Stereo, StereoSources};
use crate::screen::window::WindowTarget;
use crate::view::StereoLayout;

/// The pictures of two eyes, and their place in a window.
pub struct StereoPair<'a> {
    /// Two layers: left, right.
    pub pictures: &'a mut EyeImage,
    /// Their upper left corner, in pixels.
    pub corner: IVec2,
    pub layout: StereoLayout,
}

/// The interface of a window in an image of its own, and the stereo pass.
pub struct StereoScreen {
    pass: Stereo,
    interface: EyeImage,
    format: vk::Format,
    device: Arc<Device>,
}

impl StereoScreen {
    /// Creates the resources for a window of `size` pixels (at least 1 x 1) whose images have `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format, size: UVec2) -> Result<StereoScreen> {
        Ok(StereoScreen {
            pass: Stereo::new(device, format)?,
            interface: image(device, format, size)?,
            format,
            device: device.clone(),
        })
    }

    /// Begins drawing the interface over a transparent image; [`Recorder::end_rendering`] ends it.
    pub fn begin_interface(&mut self, recorder: &mut Recorder, size: UVec2) -> Result<()> {
        if self.interface.size() != size {
            self.interface = image(&self.device, self.format, size)?;
        }
        self.interface.begin_overwrite(recorder, 0, ResourceUse::COLOUR_TARGET);
        let view = self.interface.image().layer_view(0);
        let attachment = Attachment { view, load: Load::Colour([0.0; 4]), store: true };
        recorder.begin_rendering(size.to_array(), Some(attachment), None);
        Ok(())
    }

    /// Composites pictures and interface into the window's image, ready to present.
    pub fn compose(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        target: &WindowTarget,
        pair: StereoPair,
    ) -> Result<()> {
        let StereoPair { pictures, corner, layout } = pair;
        self.interface.transition(recorder, 0, ResourceUse::SHADER_READ);
        for eye in 0..pictures.eyes() {
            pictures.transition(recorder, eye, ResourceUse::SHADER_READ);
        }
        let sources = StereoSources { pictures, corner, interface: &self.interface };
        self.pass.begin(slot, &sources);
        recorder.image_barrier(target.part(), WindowTarget::FIRST, ResourceUse::COLOUR_TARGET);
        for layer in 0..target.layers() {
            let view = target.view(layer as usize);
            let attachment = Attachment { view, load: Load::Forget, store: true };
            recorder.begin_rendering(target.size, Some(attachment), None);
            self.pass.draw(recorder, layout, layer, &sources)?;
            recorder.end_rendering();
        }
        recorder.image_barrier(target.part(), ResourceUse::COLOUR_TARGET, ResourceUse::PRESENT);
        Ok(())
    }
}

fn image(device: &Arc<Device>, format: vk::Format, size: UVec2) -> Result<EyeImage> {
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
    EyeImage::new(device, "interface", size, 1, format, usage)
}
