//! Images with one layer per eye. They track the last use of each layer, so that a change of use is one call.

use std::ops::Range;
use std::sync::Arc;

use ash::vk;
use glam::UVec2;

use super::{BufferRange, Device, Image, ImageInfo, Recorder, ResourceUse, Result};

/// Upper left corner and size of a rectangle, in pixels.
pub type CornerAndSize = ([u32; 2], [u32; 2]);

/// An image with one layer per eye.
pub struct EyeImage {
    image: Image,
    uses: Vec<ResourceUse>,
}

impl EyeImage {
    pub fn new(
        device: &Arc<Device>,
        name: &str,
        size: UVec2,
        eyes: u32,
        format: vk::Format,
        usage: vk::ImageUsageFlags,
    ) -> Result<EyeImage> {
        let plane = ImageInfo::plane(name, size.to_array(), format, usage);
        let image = Image::new(device, &ImageInfo { layers: eyes, ..plane })?;
        Ok(EyeImage { image, uses: vec![ResourceUse::NOTHING; eyes as usize] })
    }

    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Returns the size in pixels.
    pub fn size(&self) -> UVec2 {
        let [x, y, _] = self.image.size();
        UVec2::new(x, y)
    }

    pub fn eyes(&self) -> u32 {
        self.image.layers()
    }

    /// Transitions the layer of `eye` to another use. It keeps its contents.
    pub fn transition(&mut self, recorder: &mut Recorder, eye: u32, to: ResourceUse) {
        let from = std::mem::replace(&mut self.uses[eye as usize], to);
        if from != to {
            recorder.image_barrier(self.image.layer(eye), from, to);
        }
    }

    /// Transitions the layer of `eye` to a use that overwrites it. Its contents are discarded.
    pub fn begin_overwrite(&mut self, recorder: &mut Recorder, eye: u32, to: ResourceUse) {
        let from = std::mem::replace(&mut self.uses[eye as usize], to);
        recorder.image_barrier(self.image.layer(eye), from.discarded(), to);
    }

    /// Transitions the layer of `eye` to a use that overwrites `area`. The other pixels keep their contents.
    pub fn begin_overwrite_area(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        area: CornerAndSize,
        to: ResourceUse,
    ) {
        let [width, height, _] = self.image.size();
        if area == ([0, 0], [width, height]) {
            return self.begin_overwrite(recorder, eye, to);
        }
        // A barrier even where the use stays the same: earlier writes must be visible.
        let from = std::mem::replace(&mut self.uses[eye as usize], to);
        recorder.image_barrier(self.image.layer(eye), from, to);
    }

    /// Copies `piece` to `rows` of the layer of `eye`, for shaders to read. The other rows are
    /// discarded.
    pub fn upload_rows(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        piece: BufferRange,
        rows: Range<u32>,
    ) {
        self.begin_overwrite(recorder, eye, ResourceUse::COPY_TARGET);
        self.copy_rows(recorder, eye, piece, rows);
    }

    /// Copies rows likewise, but keeps the other rows.
    pub fn update_rows(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        piece: BufferRange,
        rows: Range<u32>,
    ) {
        let [width, ..] = self.image.size();
        let area = ([0, rows.start], [width, rows.len() as u32]);
        self.begin_overwrite_area(recorder, eye, area, ResourceUse::COPY_TARGET);
        self.copy_rows(recorder, eye, piece, rows);
    }

    /// Copies `piece` to `area` of the layer of `eye`, row by row without gaps. The other pixels keep their contents.
    pub fn update_area(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        piece: BufferRange,
        area: CornerAndSize,
    ) {
        self.begin_overwrite_area(recorder, eye, area, ResourceUse::COPY_TARGET);
        let ([x, y], [width, height]) = area;
        let part = self.image.layer(eye);
        let copy = vk::BufferImageCopy::default()
            .buffer_offset(piece.offset)
            .image_subresource(part.copy_layers())
            .image_offset(vk::Offset3D { x: x as i32, y: y as i32, z: 0 })
            .image_extent(vk::Extent3D { width, height, depth: 1 });
        if width * height > 0 {
            recorder.copy_to_image(piece.buffer, part, &[copy]);
        }
    }

    fn copy_rows(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        piece: BufferRange,
        rows: Range<u32>,
    ) {
        let [width, ..] = self.image.size();
        let copy = vk::BufferImageCopy::default()
            .buffer_offset(piece.offset)
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: 0,
                base_array_layer: eye,
                layer_count: 1,
            })
            .image_offset(vk::Offset3D { x: 0, y: rows.start as i32, z: 0 })
            .image_extent(vk::Extent3D { width, height: rows.len() as u32, depth: 1 });
        if !rows.is_empty() {
            recorder.copy_to_image(piece.buffer, self.image.layer(eye), &[copy]);
        }
        self.transition(recorder, eye, ResourceUse::SHADER_READ);
    }
}
