//! Owns where index maps are drawn to: an image of voxel indices and a depth buffer, one layer
//! an eye.

use std::sync::Arc;

use ash::vk;
use glam::UVec2;

use crate::gpu::{Attachment, Device, Image, ImageInfo, Load, Recorder, Result, Use};
use crate::sculpture::NO_VOXEL;

/// Index maps on the device.
pub struct IndexTarget {
    index: Image,
    depth: Image,
    size: UVec2,
}

impl IndexTarget {
    /// For pictures of `size` pixels and `eyes` layers.
    pub fn new(device: &Arc<Device>, size: UVec2, eyes: u32) -> Result<IndexTarget> {
        use vk::ImageUsageFlags as Usage;
        let image = |name, format, usage| {
            let plane = ImageInfo::plane(name, size.to_array(), format, usage);
            Image::new(device, &ImageInfo { layers: eyes, ..plane })
        };
        let usage =
            Usage::COLOR_ATTACHMENT | Usage::SAMPLED | Usage::TRANSFER_SRC | Usage::TRANSFER_DST;
        Ok(IndexTarget {
            index: image("index map", vk::Format::R32_UINT, usage)?,
            depth: image(
                "index map depth",
                vk::Format::D32_SFLOAT,
                Usage::DEPTH_STENCIL_ATTACHMENT,
            )?,
            size,
        })
    }

    /// Pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The voxel indices, left in the layout of [`Use::COLOUR_TARGET`] by a drawing pass.
    pub fn index(&self) -> &Image {
        &self.index
    }

    /// Starts drawing the index map of `eye`: nothing seen yet.
    pub fn begin(&self, recorder: &mut Recorder, eye: u32) {
        let (index, depth) = (self.index.layer(eye), self.depth.layer(eye));
        // Whatever read the last map must be done before this one is drawn.
        let read =
            Use { stage: Use::SHADER_READ.stage | Use::COPY_SOURCE.stage, ..Use::SHADER_READ };
        recorder.image_barrier(index, read.discarded(), Use::COLOUR_TARGET);
        recorder.image_barrier(depth, Use::DEPTH_TARGET.discarded(), Use::DEPTH_TARGET);
        recorder.begin_rendering(
            self.size.to_array(),
            Some(Attachment {
                view: self.index.layer_view(eye),
                load: Load::Integers([NO_VOXEL; 4]),
                store: true,
            }),
            Some(Attachment {
                view: self.depth.layer_view(eye),
                load: Load::Depth(0.0),
                store: false,
            }),
        );
    }

    /// Ends drawing.
    pub fn end(&self, recorder: &mut Recorder) {
        recorder.end_rendering();
    }
}
