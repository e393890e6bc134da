//! Draws egui's triangles, through egui-ash-renderer.
//!
//! Takes the output of an egui pass; records into a target that is being rendered to. Textures are
//! managed here: the library would upload them by blocking submissions, which wait for everything
//! in flight. [`Gui::upload`] records the uploads into the frame, before rendering begins.

use std::collections::HashMap;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use ash::vk;
use egui::epaint::{ImageData, ImageDelta, Primitive};
use egui::{ClippedPrimitive, TextureId, TexturesDelta};
use egui_ash_renderer::allocator::GpuAllocator;
use egui_ash_renderer::{DynamicRendering, Options, RenderMode, Renderer, RendererError};

use super::composite_eye::is_srgb;
use crate::gpu::{
    DescriptorSets, Device, FRAMES_IN_FLIGHT, GpuError, Image, ImageInfo, Recorder, ResourceUse,
    Result, SetLayout, Staging, TextureSampler,
};

/// The library's colours are sRGB.
const TEXTURE_FORMAT: vk::Format = vk::Format::R8G8B8A8_SRGB;
const TEXEL_BYTES: u64 = 4;

/// The interface's renderer.
pub struct Gui {
    // Dropped first, once the device is idle.
    renderer: Renderer<GpuAllocator>,
    textures: HashMap<TextureId, Texture>,
    /// Memory was lacking for the last shapes.
    lacks_shapes: bool,
    /// Textures for which memory was lacking, to be tried again.
    lacking: HashMap<TextureId, Vec<ImageDelta>>,
    /// The error to report when memory was lacking.
    lack: Option<GpuError>,
    staging: Staging,
    layout: Arc<SetLayout>,
    sampler: TextureSampler,
    device: Arc<Device>,
}

/// A texture on the device.
struct Texture {
    /// Its id in the library's renderer.
    id: TextureId,
    image: Image,
    /// A set of one descriptor that refers to the image.
    _set: DescriptorSets,
    /// The last use of the image.
    used: ResourceUse,
}

/// Changes of textures that wait for the next picture. Those that still wait when a window closes are dropped with it;
/// egui wants this to be explicit.
#[derive(Default)]
pub struct TextureChanges(TexturesDelta);

impl From<TexturesDelta> for TextureChanges {
    fn from(delta: TexturesDelta) -> TextureChanges {
        TextureChanges(delta)
    }
}

impl Deref for TextureChanges {
    type Target = TexturesDelta;

    fn deref(&self) -> &TexturesDelta {
        &self.0
    }
}

impl DerefMut for TextureChanges {
    fn deref_mut(&mut self) -> &mut TexturesDelta {
        &mut self.0
    }
}

impl Drop for TextureChanges {
    fn drop(&mut self) {
        self.0.clear();
    }
}

impl Gui {
    /// Creates one for targets of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Gui> {
        let mode = RenderMode::DynamicRendering(DynamicRendering {
            color_attachment_format: format,
            depth_attachment_format: None,
            stencil_attachment_format: None,
        });
        let options = Options {
            in_flight_frames: FRAMES_IN_FLIGHT,
            srgb_framebuffer: is_srgb(format),
            ..Options::default()
        };
        let allocator = device.allocator()?;
        let raw = device.raw().clone();
        let renderer = Renderer::with_gpu_allocator(allocator, raw, mode, options)
            .map_err(|error| gpu_error("make the interface's renderer", error))?;
        let name = "textures of the interface";
        // The same layout as the library's own, which its pipeline expects.
        let binding =
            (0, vk::DescriptorType::COMBINED_IMAGE_SAMPLER, vk::ShaderStageFlags::FRAGMENT);
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        Ok(Gui {
            renderer,
            textures: HashMap::new(),
            lacks_shapes: false,
            lacking: HashMap::new(),
            lack: None,
            staging: Staging::new(device, name, usage, 1 << 16)?,
            layout: SetLayout::new(device, name, &[binding])?,
            sampler: TextureSampler::linear(device, name)?,
            device: device.clone(),
        })
    }

    /// Records the upload of new textures. `slot`: [`crate::gpu::Frames::slot`]. Skips a texture for which memory is
    /// lacking, and tries it again the next time ([`Gui::take_lack`]).
    pub fn upload(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        delta: &mut TexturesDelta,
    ) -> Result<()> {
        self.staging.begin(slot);
        let mut due = std::mem::take(&mut self.lacking);
        let known: Vec<TextureId> = due.keys().copied().collect();
        for (id, changes) in delta.set.drain() {
            let list = due.entry(id).or_default();
            for change in changes {
                if change.is_whole() {
                    list.clear();
                }
                list.push(change);
            }
        }
        for (id, changes) in due {
            match changes.iter().try_for_each(|change| self.write(recorder, id, change)) {
                Ok(()) => {}
                Err(error @ GpuError::OutOfMemory(_)) => {
                    if changes.first().is_some_and(ImageDelta::is_whole) {
                        self.forget(id);
                    }
                    if !known.contains(&id) {
                        self.lack = Some(error);
                    }
                    self.lacking.insert(id, changes);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Returns the error since the last call, if memory was lacking: a part of the interface is not shown.
    pub fn take_lack(&mut self) -> Option<GpuError> {
        self.lack.take()
    }

    /// Frees the textures that egui no longer needs. Call after the frame that may use them; they stay on the device
    /// until the frames in flight have finished.
    pub fn free(&mut self, delta: &mut TexturesDelta) {
        for id in delta.free.drain() {
            self.lacking.remove(&id);
            self.forget(id);
        }
    }

    fn forget(&mut self, id: TextureId) {
        if let Some(texture) = self.textures.remove(&id) {
            self.renderer.remove_user_texture(texture.id);
        }
    }

    /// Records an update of a texture.
    fn write(&mut self, recorder: &mut Recorder, id: TextureId, change: &ImageDelta) -> Result<()> {
        let ImageData::Color(patch) = &change.image;
        let size = patch.size.map(|side| side as u32);
        let [x, y] = change.pos.unwrap_or_default().map(|place| place as u32);
        if change.pos.is_none() {
            self.make(id, size)?;
        }
        let Some(texture) = self.textures.get_mut(&id) else {
            let text = "the interface changes a texture that it has not made";
            return Err(GpuError::Host(text.to_string()));
        };
        let [width, height, _] = texture.image.size();
        if x + size[0] > width || y + size[1] > height {
            let text = "the interface changes more of a texture than there is";
            return Err(GpuError::Host(text.to_string()));
        }
        let bytes = TEXEL_BYTES * patch.pixels.len() as u64;
        let piece = self.staging.fill(bytes, TEXEL_BYTES, |target| {
            for (texel, colour) in std::iter::zip(target.as_chunks_mut().0, &patch.pixels) {
                *texel = colour.to_array();
            }
        })?;
        let copy = vk::BufferImageCopy::default()
            .buffer_offset(piece.offset)
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                layer_count: 1,
                ..Default::default()
            })
            .image_offset(vk::Offset3D { x: x as i32, y: y as i32, z: 0 })
            .image_extent(vk::Extent3D { width: size[0], height: size[1], depth: 1 });
        let part = texture.image.whole();
        recorder.image_barrier(part, texture.used, ResourceUse::COPY_TARGET);
        recorder.copy_to_image(piece.buffer, part, &[copy]);
        recorder.image_barrier(part, ResourceUse::COPY_TARGET, ResourceUse::SHADER_READ);
        texture.used = ResourceUse::SHADER_READ;
        Ok(())
    }

    /// Creates a texture of a size, unless it exists.
    fn make(&mut self, id: TextureId, size: [u32; 2]) -> Result<()> {
        let fits = |texture: &Texture| texture.image.size()[..2] == size;
        if self.textures.get(&id).is_some_and(fits) {
            return Ok(());
        }
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        let info = ImageInfo::plane("texture of the interface", size, TEXTURE_FORMAT, usage);
        let image = Image::new(&self.device, &info)?;
        let set = DescriptorSets::new(&self.device, "texture of the interface", &self.layout, 1)?;
        set.write_texture(0, 0, image.view(), &self.sampler);
        let known = self.renderer.add_user_texture(set.set(0));
        let made = Texture { id: known, image, _set: set, used: ResourceUse::NOTHING };
        if let Some(former) = self.textures.insert(id, made) {
            self.renderer.remove_user_texture(former.id);
        }
        Ok(())
    }

    /// Records the interface into a target of `size` pixels. Once per frame. If memory is lacking for its shapes, shows
    /// nothing of it ([`Gui::take_lack`]).
    pub fn draw(
        &mut self,
        recorder: &Recorder,
        size: [u32; 2],
        pixels_per_point: f32,
        mut primitives: Vec<ClippedPrimitive>,
    ) -> Result<()> {
        primitives.retain_mut(|primitive| match &mut primitive.primitive {
            Primitive::Mesh(mesh) => match self.textures.get(&mesh.texture_id) {
                Some(texture) => {
                    mesh.texture_id = texture.id;
                    true
                }
                None => !self.lacking.contains_key(&mesh.texture_id),
            },
            Primitive::Callback(_) => true,
        });
        let extent = vk::Extent2D { width: size[0], height: size[1] };
        let drawn = self
            .renderer
            .cmd_draw(recorder.raw(), extent, pixels_per_point, &primitives)
            .map_err(|error| gpu_error("draw the interface", error));
        let lacked = std::mem::replace(&mut self.lacks_shapes, false);
        match drawn {
            Err(error @ GpuError::OutOfMemory(_)) => {
                self.lacks_shapes = true;
                if !lacked {
                    self.lack = Some(error);
                }
                Ok(())
            }
            drawn => drawn,
        }
    }
}

impl Drop for Gui {
    fn drop(&mut self) {
        // The library destroys its objects at once.
        if let Err(error) = self.device.wait_idle() {
            tracing::warn!("the device did not come to rest: {error}");
        }
    }
}

fn gpu_error(doing: &'static str, error: RendererError) -> GpuError {
    match error {
        RendererError::Vulkan(result) => GpuError::vulkan(doing, result),
        RendererError::GpuAllocator(gpu_allocator::AllocationError::OutOfMemory) => {
            GpuError::OutOfMemory(doing)
        }
        error => GpuError::Host(format!("could not {doing}: {error}")),
    }
}
