//! Draws the interface: egui's triangles, through egui-ash-renderer.
//!
//! Takes the output of an egui pass; records into a target that is being rendered to. The
//! library uploads textures by submissions of its own that it waits for, so [`Gui::upload`] comes
//! before the frame's commands.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use ash::vk;
use egui::epaint::Primitive;
use egui::epaint::{ImageData, ImageDelta};
use egui::{ClippedPrimitive, ColorImage, TextureId, TextureOptions, TexturesDelta};
use egui_ash_renderer::allocator::GpuAllocator;
use egui_ash_renderer::{DynamicRendering, Options, RenderMode, Renderer, RendererError};

use crate::gpu::{Device, FRAMES_IN_FLIGHT, GpuError, Pool, Recorder, Result, Serial};

/// The interface's renderer.
pub struct Gui {
    // Dropped in this order, once the device is idle.
    renderer: Renderer<GpuAllocator>,
    pool: Pool,
    /// What each texture holds. The library's partial updates forget the rest of the image (they
    /// begin with an undefined layout), so every update is made whole here.
    images: HashMap<TextureId, ColorImage>,
    /// Textures that are on the device.
    there: HashSet<TextureId>,
    /// Those for which there was no memory, to be tried again.
    lacking: HashMap<TextureId, TextureOptions>,
    /// What there was no memory for, to be said.
    lack: Option<GpuError>,
    /// Textures that egui needs no more, and the submission that may still use them.
    condemned: Vec<(TextureId, Serial)>,
    device: Arc<Device>,
}

impl Gui {
    /// For targets of `format`; `encodes_srgb` if the format converts to sRGB itself.
    pub fn new(device: &Arc<Device>, format: vk::Format, encodes_srgb: bool) -> Result<Gui> {
        let mode = RenderMode::DynamicRendering(DynamicRendering {
            color_attachment_format: format,
            depth_attachment_format: None,
            stencil_attachment_format: None,
        });
        let options = Options {
            in_flight_frames: FRAMES_IN_FLIGHT,
            srgb_framebuffer: encodes_srgb,
            ..Options::default()
        };
        let allocator = device.allocator()?;
        let raw = device.raw().clone();
        let renderer = Renderer::with_gpu_allocator(allocator, raw, mode, options)
            .map_err(|error| gpu_error("make the interface's renderer", error))?;
        Ok(Gui {
            renderer,
            pool: Pool::new(device, "textures of the interface")?,
            images: HashMap::new(),
            there: HashSet::new(),
            lacking: HashMap::new(),
            lack: None,
            condemned: Vec::new(),
            device: device.clone(),
        })
    }

    /// Brings new textures to the device and frees those that no frame uses any more. One for
    /// which there is no memory is left out, and tried again the next time ([`Gui::take_lack`]).
    pub fn upload(&mut self, delta: &mut TexturesDelta) -> Result<()> {
        let before = std::mem::take(&mut self.lacking);
        let mut due = before.clone();
        for (id, changes) in delta.set.drain() {
            for change in &changes {
                self.remember(id, change);
            }
            due.extend(changes.last().map(|last| (id, last.options)));
        }
        for (id, options) in due {
            let Some(image) = self.images.get(&id) else { continue };
            if self.there.contains(&id) {
                // The texture that is replaced may be in use by a frame in flight.
                self.device.wait_idle()?;
            }
            let whole = ImageDelta::full(image.clone(), options);
            let (renderer, pool) = (&mut self.renderer, self.pool.handle());
            let set = self
                .device
                .with_queue(|queue| renderer.set_texture(queue, pool, id, &whole))
                .map_err(|error| gpu_error("bring a texture of the interface over", error));
            match set {
                Ok(()) => {
                    self.there.insert(id);
                }
                Err(error @ GpuError::OutOfMemory(_)) => {
                    self.lacking.insert(id, options);
                    if !before.contains_key(&id) {
                        self.lack = Some(error);
                    }
                }
                Err(error) => return Err(error),
            }
        }
        let mut kept = Vec::new();
        for (id, serial) in self.condemned.drain(..) {
            if self.device.is_done(serial)? {
                self.renderer
                    .free_texture(id)
                    .map_err(|error| gpu_error("free a texture of the interface", error))?;
            } else {
                kept.push((id, serial));
            }
        }
        self.condemned = kept;
        Ok(())
    }

    /// What there was no memory for since the last call: something of the interface is not shown.
    pub fn take_lack(&mut self) -> Option<GpuError> {
        self.lack.take()
    }

    /// Frees textures once the submission that may use them is done.
    pub fn free_after(&mut self, delta: &mut TexturesDelta, serial: Serial) {
        for id in delta.free.drain() {
            self.images.remove(&id);
            self.there.remove(&id);
            self.condemned.push((id, serial));
        }
    }

    /// Records the interface into a target of `size` pixels. Once a frame.
    pub fn draw(
        &mut self,
        recorder: &Recorder,
        size: [u32; 2],
        pixels_per_point: f32,
        primitives: &[ClippedPrimitive],
    ) -> Result<()> {
        let extent = vk::Extent2D { width: size[0], height: size[1] };
        let shown: Vec<ClippedPrimitive>;
        let primitives = match self.lacking.is_empty() {
            true => primitives,
            false => {
                let is_there = |primitive: &&ClippedPrimitive| match &primitive.primitive {
                    Primitive::Mesh(mesh) => self.there.contains(&mesh.texture_id),
                    Primitive::Callback(_) => true,
                };
                shown = primitives.iter().filter(is_there).cloned().collect();
                &shown[..]
            }
        };
        self.renderer
            .cmd_draw(recorder.raw(), extent, pixels_per_point, primitives)
            .map_err(|error| gpu_error("draw the interface", error))
    }

    /// Applies a change to the copy of a texture.
    fn remember(&mut self, id: TextureId, change: &ImageDelta) {
        let ImageData::Color(patch) = &change.image;
        let Some([left, top]) = change.pos else {
            self.images.insert(id, (**patch).clone());
            return;
        };
        let Some(image) = self.images.get_mut(&id) else { return };
        let [width, height] = patch.size;
        for row in 0..height {
            let from = &patch.pixels[row * width..(row + 1) * width];
            let start = (top + row) * image.size[0] + left;
            if let Some(to) = image.pixels.get_mut(start..start + width) {
                to.copy_from_slice(from);
            }
        }
    }
}

impl Drop for Gui {
    fn drop(&mut self) {
        // The library destroys at once what it owns.
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
