//! Descriptor set layouts, descriptor sets and samplers.

use std::sync::Arc;

use ash::vk;

use super::device::Device;
use super::error::{During, Result};
use super::memory::BufferRange;
use super::retire::Retired;

/// One binding of set 0: number, kind, and the stages that access it.
pub type Binding = (u32, vk::DescriptorType, vk::ShaderStageFlags);

/// A descriptor set layout.
pub struct SetLayout {
    handle: vk::DescriptorSetLayout,
    bindings: Vec<Binding>,
    device: Arc<Device>,
}

impl SetLayout {
    pub fn new(device: &Arc<Device>, name: &str, bindings: &[Binding]) -> Result<Arc<SetLayout>> {
        let entries: Vec<_> = bindings
            .iter()
            .map(|&(binding, kind, stages)| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(binding)
                    .descriptor_type(kind)
                    .descriptor_count(1)
                    .stage_flags(stages)
            })
            .collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&entries);
        // SAFETY: the info is complete.
        let handle = unsafe { device.raw().create_descriptor_set_layout(&info, None) }
            .during("create a descriptor set layout")?;
        device.name(handle, name);
        let bindings = bindings.to_vec();
        Ok(Arc::new(SetLayout { handle, bindings, device: device.clone() }))
    }

    pub fn handle(&self) -> vk::DescriptorSetLayout {
        self.handle
    }
}

impl Drop for SetLayout {
    fn drop(&mut self) {
        self.device.retire(Retired::SetLayout(self.handle));
    }
}

/// A sampler with linear filtering, clamped to the edge.
pub struct TextureSampler {
    handle: vk::Sampler,
    device: Arc<Device>,
}

impl TextureSampler {
    pub fn linear(device: &Arc<Device>, name: &str) -> Result<TextureSampler> {
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(vk::Filter::LINEAR)
            .min_filter(vk::Filter::LINEAR)
            .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_w(vk::SamplerAddressMode::CLAMP_TO_EDGE);
        // SAFETY: the info is complete.
        let handle =
            unsafe { device.raw().create_sampler(&info, None) }.during("create a sampler")?;
        device.name(handle, name);
        Ok(TextureSampler { handle, device: device.clone() })
    }
}

impl Drop for TextureSampler {
    fn drop(&mut self) {
        let handle = self.handle;
        // SAFETY: called once the device has finished all work that may use it.
        self.device.retire_with(move |device| unsafe { device.destroy_sampler(handle, None) });
    }
}

/// Sets of one layout. A set may only be written while no submission in flight uses it: keep one
/// per frame slot, or make new ones.
pub struct DescriptorSets {
    pool: vk::DescriptorPool,
    sets: Vec<vk::DescriptorSet>,
    /// Keeps the layout alive, which writing a set needs.
    _layout: Arc<SetLayout>,
    device: Arc<Device>,
}

impl DescriptorSets {
    pub fn new(
        device: &Arc<Device>,
        name: &str,
        layout: &Arc<SetLayout>,
        count: usize,
    ) -> Result<DescriptorSets> {
        let sizes: Vec<_> = layout
            .bindings
            .iter()
            .map(|&(_, kind, _)| {
                vk::DescriptorPoolSize::default().ty(kind).descriptor_count(count as u32)
            })
            .collect();
        let info =
            vk::DescriptorPoolCreateInfo::default().max_sets(count as u32).pool_sizes(&sizes);
        // SAFETY: the info is complete.
        let pool = unsafe { device.raw().create_descriptor_pool(&info, None) }
            .during("create a descriptor pool")?;
        let mut made = DescriptorSets {
            pool,
            sets: Vec::new(),
            _layout: layout.clone(),
            device: device.clone(),
        };
        let layouts = vec![layout.handle(); count];
        let info =
            vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: pool and layouts live; the pool has room for exactly these.
        made.sets = unsafe { device.raw().allocate_descriptor_sets(&info) }
            .during("create descriptor sets")?;
        for &set in &made.sets {
            device.name(set, name);
        }
        Ok(made)
    }

    /// Returns the `index`-th set.
    pub fn set(&self, index: usize) -> vk::DescriptorSet {
        self.sets[index]
    }

    /// Binds a sampled image without a sampler, in the layout of [`crate::gpu::ResourceUse::SHADER_READ`].
    pub fn write_sampled(&self, index: usize, binding: u32, view: vk::ImageView) {
        let layout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
        self.write_image(index, binding, vk::DescriptorType::SAMPLED_IMAGE, view, layout);
    }

    /// Binds a sampled image with its sampler, in the layout of [`crate::gpu::ResourceUse::SHADER_READ`].
    /// Image and sampler must live as long as the set.
    pub fn write_texture(
        &self,
        index: usize,
        binding: u32,
        view: vk::ImageView,
        sampler: &TextureSampler,
    ) {
        let images = [vk::DescriptorImageInfo::default()
            .sampler(sampler.handle)
            .image_view(view)
            .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(self.sets[index])
            .dst_binding(binding)
            .descriptor_type(vk::DescriptorType::COMBINED_IMAGE_SAMPLER)
            .image_info(&images);
        // SAFETY: set, view and sampler are of this device.
        unsafe { self.device.raw().update_descriptor_sets(&[write], &[]) };
    }

    /// Binds a storage image that compute shaders write, in the layout of
    /// [`crate::gpu::ResourceUse::SHADER_WRITE`].
    pub fn write_storage(&self, index: usize, binding: u32, view: vk::ImageView) {
        let layout = vk::ImageLayout::GENERAL;
        self.write_image(index, binding, vk::DescriptorType::STORAGE_IMAGE, view, layout);
    }

    fn write_image(
        &self,
        index: usize,
        binding: u32,
        kind: vk::DescriptorType,
        view: vk::ImageView,
        layout: vk::ImageLayout,
    ) {
        let images = [vk::DescriptorImageInfo::default().image_view(view).image_layout(layout)];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(self.sets[index])
            .dst_binding(binding)
            .descriptor_type(kind)
            .image_info(&images);
        // SAFETY: set and view are of this device.
        unsafe { self.device.raw().update_descriptor_sets(&[write], &[]) };
    }

    /// Binds a range of a buffer.
    pub fn write_buffer(
        &self,
        index: usize,
        binding: u32,
        kind: vk::DescriptorType,
        range: BufferRange,
    ) {
        let BufferRange { buffer, offset, bytes } = range;
        let buffers =
            [vk::DescriptorBufferInfo::default().buffer(buffer).offset(offset).range(bytes)];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(self.sets[index])
            .dst_binding(binding)
            .descriptor_type(kind)
            .buffer_info(&buffers);
        // SAFETY: set and buffer are of this device.
        unsafe { self.device.raw().update_descriptor_sets(&[write], &[]) };
    }
}

impl Drop for DescriptorSets {
    fn drop(&mut self) {
        self.device.retire(Retired::DescriptorPool(self.pool));
    }
}
