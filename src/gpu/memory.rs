//! Buffers and images with their memory. Dropping one retires it: it is destroyed when the device
//! no longer uses it.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError};

use ash::vk;
use bytemuck::Pod;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};

pub use gpu_allocator::MemoryLocation;

use super::device::Device;
use super::error::{During, GpuError, Result};
use super::retire::Retired;

/// A buffer with its memory.
pub struct Buffer {
    handle: vk::Buffer,
    /// Taken out on drop.
    memory: Option<Allocation>,
    bytes: u64,
    device: Arc<Device>,
}

/// A range of a buffer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BufferRange {
    pub buffer: vk::Buffer,
    pub offset: u64,
    pub bytes: u64,
}

impl BufferRange {
    /// Returns both halves of the range.
    pub fn halves(self) -> [BufferRange; 2] {
        let bytes = self.bytes / 2;
        [BufferRange { bytes, ..self }, BufferRange { offset: self.offset + bytes, bytes, ..self }]
    }
}

impl Buffer {
    /// Creates a buffer. `location`: `GpuOnly`, `CpuToGpu` (written by the CPU) or `GpuToCpu` (read by it); the latter
    /// two are persistently mapped and coherent.
    pub fn new(
        device: &Arc<Device>,
        name: &str,
        bytes: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<Buffer> {
        let info = vk::BufferCreateInfo::default().size(bytes.max(1)).usage(usage);
        // SAFETY: the info is complete.
        let handle =
            unsafe { device.raw().create_buffer(&info, None) }.during("create a buffer")?;
        // SAFETY: just made.
        let requirements = unsafe { device.raw().get_buffer_memory_requirements(handle) };
        let alone = AllocationScheme::DedicatedBuffer(handle);
        let memory = allocate(device, name, requirements, location, alone).inspect_err(|_| {
            // SAFETY: not used by anything.
            unsafe { device.raw().destroy_buffer(handle, None) }
        })?;
        let buffer = Buffer { handle, memory: Some(memory), bytes, device: device.clone() };
        if let Some(memory) = &buffer.memory {
            // SAFETY: the memory meets the buffer's requirements and is bound once.
            unsafe { device.raw().bind_buffer_memory(handle, memory.memory(), memory.offset()) }
                .during("bind a buffer's memory")?;
        }
        device.name(handle, name);
        Ok(buffer)
    }

    pub fn handle(&self) -> vk::Buffer {
        self.handle
    }

    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns all of it.
    pub fn whole(&self) -> BufferRange {
        BufferRange { buffer: self.handle, offset: 0, bytes: self.bytes }
    }

    /// Returns the mapped bytes; empty for a buffer that the CPU cannot access.
    pub fn mapped(&self) -> &[u8] {
        let bytes = self.memory.as_ref().and_then(Allocation::mapped_slice);
        bytes.map_or(&[], |bytes| &bytes[..self.bytes as usize])
    }

    /// Returns the mapped bytes; empty for a buffer that the CPU cannot access.
    pub fn mapped_mut(&mut self) -> &mut [u8] {
        let bytes = self.memory.as_mut().and_then(Allocation::mapped_slice_mut);
        match bytes {
            Some(bytes) => &mut bytes[..self.bytes as usize],
            None => &mut [],
        }
    }

    /// Copies `data` to `offset`, in bytes.
    pub fn write<T: Pod>(&mut self, offset: u64, data: &[T]) -> Result<()> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let start = offset as usize;
        match self.mapped_mut().get_mut(start..start + bytes.len()) {
            Some(target) => target.copy_from_slice(bytes),
            None => return Err(GpuError::Host("write beyond a mapped buffer".to_string())),
        }
        Ok(())
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        if let Some(memory) = self.memory.take() {
            self.device.retire(Retired::Buffer(self.handle, memory));
        }
    }
}

/// The parameters of a new [`Image`].
#[derive(Clone, Copy, Debug)]
pub struct ImageInfo<'a> {
    pub name: &'a str,
    /// Width, height, depth in texels; depth above 1 or `volume` makes a 3D image.
    pub size: [u32; 3],
    pub volume: bool,
    pub layers: u32,
    pub format: vk::Format,
    pub usage: vk::ImageUsageFlags,
}

impl<'a> ImageInfo<'a> {
    /// Returns a 2D image of one layer.
    pub fn plane(
        name: &'a str,
        size: [u32; 2],
        format: vk::Format,
        usage: vk::ImageUsageFlags,
    ) -> ImageInfo<'a> {
        let size = [size[0], size[1], 1];
        ImageInfo { name, size, volume: false, layers: 1, format, usage }
    }
}

/// An image in device memory, with its views.
pub struct Image {
    handle: vk::Image,
    /// Taken out on drop.
    memory: Option<Allocation>,
    /// The view of the whole image, then one per layer if there are several.
    views: Vec<vk::ImageView>,
    size: [u32; 3],
    layers: u32,
    format: vk::Format,
    id: u64,
    device: Arc<Device>,
}

impl Image {
    pub fn new(device: &Arc<Device>, info: &ImageInfo<'_>) -> Result<Image> {
        check_size(device, info)?;
        let create = vk::ImageCreateInfo::default()
            .image_type(if info.volume { vk::ImageType::TYPE_3D } else { vk::ImageType::TYPE_2D })
            .format(info.format)
            .extent(vk::Extent3D { width: info.size[0], height: info.size[1], depth: info.size[2] })
            .mip_levels(1)
            .array_layers(info.layers)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(info.usage);
        // SAFETY: the info is complete.
        let handle =
            unsafe { device.raw().create_image(&create, None) }.during("create an image")?;
        // SAFETY: just made.
        let requirements = unsafe { device.raw().get_image_memory_requirements(handle) };
        let alone = AllocationScheme::DedicatedImage(handle);
        let memory = allocate(device, info.name, requirements, MemoryLocation::GpuOnly, alone)
            .inspect_err(|_| {
                // SAFETY: not used by anything.
                unsafe { device.raw().destroy_image(handle, None) }
            })?;
        let (place, offset) = (memory_of(&memory), memory.offset());
        let mut image = Image {
            handle,
            memory: Some(memory),
            views: Vec::new(),
            size: info.size,
            layers: info.layers,
            format: info.format,
            id: next_id(),
            device: device.clone(),
        };
        // SAFETY: the memory meets the image's requirements and is bound once.
        unsafe { device.raw().bind_image_memory(handle, place, offset) }
            .during("bind an image's memory")?;
        device.name(handle, info.name);
        let whole = match (info.volume, info.layers) {
            (true, _) => vk::ImageViewType::TYPE_3D,
            (false, 1) => vk::ImageViewType::TYPE_2D,
            (false, _) => vk::ImageViewType::TYPE_2D_ARRAY,
        };
        image.add_view(whole, 0, info.layers)?;
        for layer in 0..if info.layers > 1 { info.layers } else { 0 } {
            image.add_view(vk::ImageViewType::TYPE_2D, layer, 1)?;
        }
        Ok(image)
    }

    fn add_view(&mut self, kind: vk::ImageViewType, layer: u32, layers: u32) -> Result<()> {
        let create = vk::ImageViewCreateInfo::default()
            .image(self.handle)
            .view_type(kind)
            .format(self.format)
            .subresource_range(ImagePart { layer, layers, ..self.whole() }.range());
        // SAFETY: the image is bound and of this device.
        let view = unsafe { self.device.raw().create_image_view(&create, None) }
            .during("create an image view")?;
        self.views.push(view);
        Ok(())
    }

    pub fn handle(&self) -> vk::Image {
        self.handle
    }

    /// Returns a number that no other image has had. It detects a descriptor of a former image: Vulkan reuses handles.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// Returns the view of all layers.
    pub fn view(&self) -> vk::ImageView {
        self.views[0]
    }

    /// Returns the 2D view of one layer; `layer` must be below [`Image::layers`].
    pub fn layer_view(&self, layer: u32) -> vk::ImageView {
        if self.layers > 1 { self.views[1 + layer as usize] } else { self.views[0] }
    }

    pub fn layers(&self) -> u32 {
        self.layers
    }

    /// Returns width, height and depth in texels.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    pub fn format(&self) -> vk::Format {
        self.format
    }

    /// Returns all of it, for barriers and copies.
    pub fn whole(&self) -> ImagePart {
        ImagePart {
            image: self.handle,
            aspect: aspect_of(self.format),
            layer: 0,
            layers: self.layers,
        }
    }

    /// Returns one layer, for barriers and copies.
    pub fn layer(&self, layer: u32) -> ImagePart {
        ImagePart { layer, layers: 1, ..self.whole() }
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        if let Some(memory) = self.memory.take() {
            let views = std::mem::take(&mut self.views);
            self.device.retire(Retired::Image(self.handle, memory, views));
        }
    }
}

/// Layers of an image, which may belong to a swapchain or a headset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ImagePart {
    pub image: vk::Image,
    pub aspect: vk::ImageAspectFlags,
    pub layer: u32,
    pub layers: u32,
}

impl ImagePart {
    /// Returns one colour layer of an image from outside this module.
    pub fn colour(image: vk::Image, layer: u32) -> ImagePart {
        ImagePart { image, aspect: vk::ImageAspectFlags::COLOR, layer, layers: 1 }
    }

    pub(super) fn range(&self) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange {
            aspect_mask: self.aspect,
            base_mip_level: 0,
            level_count: 1,
            base_array_layer: self.layer,
            layer_count: self.layers,
        }
    }

    pub(super) fn copy_layers(&self) -> vk::ImageSubresourceLayers {
        vk::ImageSubresourceLayers {
            aspect_mask: self.aspect,
            mip_level: 0,
            base_array_layer: self.layer,
            layer_count: self.layers,
        }
    }
}

fn next_id() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

fn aspect_of(format: vk::Format) -> vk::ImageAspectFlags {
    match format {
        vk::Format::D32_SFLOAT | vk::Format::D16_UNORM => vk::ImageAspectFlags::DEPTH,
        _ => vk::ImageAspectFlags::COLOR,
    }
}

fn check_size(device: &Device, info: &ImageInfo<'_>) -> Result<()> {
    let limits = device.limits();
    let (allowed, limit) = if info.volume {
        (limits.max_image_dimension3_d, "maxImageDimension3D")
    } else {
        (limits.max_image_dimension2_d, "maxImageDimension2D")
    };
    let needed = info.size.into_iter().max().unwrap_or(0);
    if needed > allowed {
        return Err(GpuError::Limit {
            what: format!("{} of {:?} texels", info.name, info.size),
            needed: u64::from(needed),
            limit,
            allowed: u64::from(allowed),
        });
    }
    Ok(())
}

fn memory_of(memory: &Allocation) -> vk::DeviceMemory {
    // SAFETY: used only to bind the resource that the allocation is for.
    unsafe { memory.memory() }
}

/// Returns an allocation in a shared block, or, if no further block is available, a dedicated one made by `alone`.
fn allocate(
    device: &Device,
    name: &str,
    requirements: vk::MemoryRequirements,
    location: MemoryLocation,
    alone: AllocationScheme,
) -> Result<Allocation> {
    let allocator = device.allocator()?;
    let mut allocator = allocator.lock().unwrap_or_else(PoisonError::into_inner);
    let linear = matches!(alone, AllocationScheme::DedicatedBuffer(_));
    let mut place = |allocation_scheme| {
        let desc = AllocationCreateDesc { name, requirements, location, linear, allocation_scheme };
        allocator.allocate(&desc)
    };
    place(AllocationScheme::GpuAllocatorManaged)
        .or_else(|error| match error {
            gpu_allocator::AllocationError::OutOfMemory => place(alone),
            error => Err(error),
        })
        .map_err(|e| match e {
            gpu_allocator::AllocationError::OutOfMemory => {
                GpuError::OutOfMemory("place a buffer or an image")
            }
            e => GpuError::Allocation { name: name.to_string(), reason: e.to_string() },
        })
}
