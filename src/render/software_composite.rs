//! Composition on a software device: colours and depths are computed by [`Composition`] and copied to the pictures. A
//! software device would take several times as long to draw them, and would also need copies of the maps and shaded
//! pictures.
//!
//! Takes the samples and the shading of the CPU; leaves the pictures as drawing would. Everything over the sculpture is
//! drawn as usual.

use std::sync::Arc;

use ash::vk;

use super::composite_eye::is_srgb;
use super::pictures::FinishedPictures;
use crate::gpu::{Device, Recorder, ResourceUse, Result, Staging};
use crate::shade::composed::Composition;
use crate::surface::PixelRect;

/// See the module text.
pub(super) struct SoftwareComposite {
    staging: Staging,
}

/// Returns the storage of pixels of a format: whether blue comes first, and whether the device encodes them; `None` for
/// formats without a byte per channel.
pub(super) fn layout_of(format: vk::Format) -> Option<(bool, bool)> {
    let is_bgra = match format {
        vk::Format::R8G8B8A8_UNORM
        | vk::Format::R8G8B8A8_SRGB
        | vk::Format::A8B8G8R8_SRGB_PACK32
        | vk::Format::A8B8G8R8_UNORM_PACK32 => false,
        vk::Format::B8G8R8A8_UNORM | vk::Format::B8G8R8A8_SRGB => true,
        _ => return None,
    };
    Some((is_bgra, is_srgb(format)))
}

impl SoftwareComposite {
    pub fn new(device: &Arc<Device>) -> Result<SoftwareComposite> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        Ok(SoftwareComposite {
            staging: Staging::new(device, "composed pictures", usage, 1 << 20)?,
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.staging.begin(slot);
    }

    /// Composes `rect` of the picture of `eye`. Outside of rendering.
    pub fn compose(
        &mut self,
        recorder: &mut Recorder,
        pictures: &mut FinishedPictures,
        eye: u32,
        composition: &Composition,
        rect: PixelRect,
    ) -> Result<()> {
        let (place, [width, height]) = (rect.corner_and_size(), rect.corner_and_size().1);
        let plane = 4 * width as usize * height as usize;
        if plane == 0 {
            return Ok(());
        }
        let both = self.staging.fill(2 * plane as u64, 16, |bytes| {
            let (colours, depths) = bytes.split_at_mut(plane);
            composition.compose(
                rect,
                bytemuck::cast_slice_mut(colours),
                bytemuck::cast_slice_mut(depths),
            );
        })?;
        let [colours, depths] = both.halves();
        pictures.colour.update_area(recorder, eye, colours, place);
        pictures.depth.update_area(recorder, eye, depths, place);
        pictures.depth.transition(recorder, eye, ResourceUse::DEPTH_TARGET);
        Ok(())
    }
}
