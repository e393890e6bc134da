//! The Vulkan device, its one queue, its memory allocator, and the order in which objects made from
//! it are destroyed.
//!
//! There is one constructor for headless work, a window and a headset; they differ in their
//! [`Host`]. Every owner made from a device keeps an `Arc` of it, so it outlives them all.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use ash::{ext, vk};
use gpu_allocator::AllocationSizes;
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};

use super::choice::{DeviceCandidate, DeviceChoice, candidates, first_that_works};
use super::error::{During, GpuError, Result};
use super::host::WindowSurface;
use super::instance::{Host, Instance, Validation};
use super::pipeline_cache::PipelineCache;
use super::retire::{RetireQueue, Retired};
use super::validation::ValidationLog;

/// Time after which a device that does not respond is reported as hanging.
const PATIENCE: Duration = Duration::from_secs(30);

/// Most semaphores that one submission waits for or signals, besides the timeline.
pub const MAX_SEMAPHORES: usize = 3;

/// The parameters of a device.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct DeviceOptions {
    pub choice: DeviceChoice,
    pub validation: Validation,
    /// The folder for compiled pipelines, which speed up the next start; `None`: they are not kept.
    pub pipeline_cache: Option<PathBuf>,
}

impl DeviceOptions {
    /// Returns these options with the environment's: `VS_VALIDATION=1` requires validation, and
    /// `VS_VALIDATION=if-available` enables it if the layer is installed. With validation there is no pipeline cache.
    pub fn with_environment(mut self) -> DeviceOptions {
        match std::env::var("VS_VALIDATION").as_deref() {
            Ok("1") => self.validation = Validation::Required,
            Ok("if-available") => self.validation = Validation::IfAvailable,
            _ => {}
        }
        if self.validation != Validation::Off {
            self.pipeline_cache = None;
        }
        self
    }
}

/// A point in the order of submissions.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub struct Serial(u64);

struct DeviceQueue {
    raw: vk::Queue,
    /// Serial of the last submission.
    submitted: u64,
}

/// A Vulkan 1.3 device.
pub struct Device {
    // Dropped manually in `Drop`, before the device itself.
    allocator: Option<Arc<Mutex<Allocator>>>,
    retired: Mutex<RetireQueue>,
    queue: Mutex<DeviceQueue>,
    timeline: vk::Semaphore,
    /// Taken out on drop.
    pipelines: Option<PipelineCache>,
    pipelines_created: AtomicUsize,
    names: Option<ext::debug_utils::Device>,
    candidate: DeviceCandidate,
    raw: ash::Device,
    instance: Arc<Instance>,
}

impl Device {
    /// Creates instance and device for `host`: the best working device.
    pub fn new(host: &mut dyn Host, options: &DeviceOptions) -> Result<Arc<Device>> {
        let instance = Instance::new(host, options.validation)?;
        host.attach(&instance)?;
        let (usable, refused) = candidates(&instance, host, &options.choice)?;
        let device = first_that_works(usable, refused, DeviceCandidate::name, |candidate| {
            Device::of(&instance, host, options, candidate)
        })?;
        tracing::info!("drawing with {}", device.device_name());
        Ok(Arc::new(device))
    }

    /// Creates one device.
    fn of(
        instance: &Arc<Instance>,
        host: &mut dyn Host,
        options: &DeviceOptions,
        candidate: DeviceCandidate,
    ) -> Result<Device> {
        let extensions: Vec<_> = candidate.extensions.iter().map(|e| e.as_ptr()).collect();
        let queues = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(candidate.queue_family)
            .queue_priorities(&[1.0])];
        // Not as part of Vulkan12Features: the runtime of a headset may add its own feature structures, which may not
        // occur beside that one.
        let mut timeline =
            vk::PhysicalDeviceTimelineSemaphoreFeatures::default().timeline_semaphore(true);
        let mut v13 = vk::PhysicalDeviceVulkan13Features::default()
            .dynamic_rendering(true)
            .synchronization2(true);
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions)
            .push_next(&mut timeline)
            .push_next(&mut v13);
        let raw = host.create_device(instance, candidate.physical, &info)?;
        // SAFETY: the family was asked for with one queue.
        let queue = unsafe { raw.get_device_queue(candidate.queue_family, 0) };
        let names = (instance.validated() && instance.debug_names())
            .then(|| ext::debug_utils::Device::new(instance.raw(), &raw));
        let mut device = Device {
            allocator: None,
            retired: Mutex::default(),
            queue: Mutex::new(DeviceQueue { raw: queue, submitted: 0 }),
            timeline: vk::Semaphore::null(),
            pipelines: None,
            pipelines_created: AtomicUsize::new(0),
            names,
            candidate,
            raw,
            instance: instance.clone(),
        };
        let mut kind =
            vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
        let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
        // SAFETY: timeline semaphores were enabled.
        device.timeline = unsafe { device.raw.create_semaphore(&info, None) }
            .during("create the queue's timeline")?;
        device.allocator = Some(Arc::new(Mutex::new(device.make_allocator()?)));
        let folder = options.pipeline_cache.as_deref();
        let (raw, properties) = (&device.raw, &device.candidate.properties);
        device.pipelines = Some(PipelineCache::new(raw, properties, folder)?);
        device.name(device.timeline, "submissions");
        Ok(device)
    }

    fn make_allocator(&self) -> Result<Allocator> {
        const MIB: u64 = 1 << 20;
        Allocator::new(&AllocatorCreateDesc {
            instance: self.instance.raw().clone(),
            device: self.raw.clone(),
            physical_device: self.candidate.physical,
            debug_settings: Default::default(),
            buffer_device_address: false,
            // Small blocks at first: a frame buffer and a grid of 16 MiB do not need one of 256.
            allocation_sizes: AllocationSizes::new(16 * MIB, 16 * MIB)
                .with_max_device_memblock_size(256 * MIB)
                .with_max_host_memblock_size(64 * MIB),
        })
        .map_err(|e| GpuError::Allocation {
            name: "the allocator".to_string(),
            reason: e.to_string(),
        })
    }

    /// Returns the surface of a further window; that of the first one was created with the device.
    pub fn surface<W>(&self, window: Arc<W>) -> Result<WindowSurface>
    where
        W: HasDisplayHandle + HasWindowHandle + 'static,
    {
        let surface = WindowSurface::of_window(&self.instance, window)?;
        if !surface.can_show(self.physical(), self.queue_family())? {
            return Err(GpuError::Host("the device cannot draw to a further window".to_string()));
        }
        Ok(surface)
    }

    pub fn raw(&self) -> &ash::Device {
        &self.raw
    }

    pub fn instance(&self) -> &Arc<Instance> {
        &self.instance
    }

    pub fn physical(&self) -> vk::PhysicalDevice {
        self.candidate.physical
    }

    pub fn queue_family(&self) -> u32 {
        self.candidate.queue_family
    }

    /// Returns the number of valid bits of the queue's time stamps; 0 if it has none.
    pub fn time_stamp_bits(&self) -> u32 {
        self.candidate.time_stamp_bits
    }

    pub fn limits(&self) -> &vk::PhysicalDeviceLimits {
        &self.candidate.properties.limits
    }

    pub fn device_name(&self) -> String {
        self.candidate.name()
    }

    /// Returns whether this is a software renderer, whose copies cross no bus.
    pub fn is_software(&self) -> bool {
        self.candidate.properties.device_type == vk::PhysicalDeviceType::CPU
    }

    /// Returns the pipeline cache for new pipelines.
    pub(super) fn pipeline_cache(&self) -> vk::PipelineCache {
        self.pipelines.as_ref().map_or(vk::PipelineCache::null(), PipelineCache::handle)
    }

    /// Returns the number of pipelines created so far, without those of libraries.
    pub fn pipelines_created(&self) -> usize {
        self.pipelines_created.load(Ordering::Relaxed)
    }

    /// Counts a pipeline whose creation took `taken`.
    pub(super) fn pipeline_created(&self, name: &str, taken: Duration) {
        self.pipelines_created.fetch_add(1, Ordering::Relaxed);
        tracing::debug!("created pipeline \"{name}\" in {:.1} ms", taken.as_secs_f64() * 1e3);
    }

    /// Returns the allocator, for libraries that allocate themselves. The `Arc` must be dropped before the device.
    pub fn allocator(&self) -> Result<Arc<Mutex<Allocator>>> {
        self.allocator
            .clone()
            .ok_or_else(|| GpuError::Host("the device is being taken down".to_string()))
    }

    /// Returns the warnings and errors of the validation layers so far, oldest first.
    pub fn validation_messages(&self) -> Vec<String> {
        self.instance.validation_log().messages()
    }

    /// Returns the log itself, which outlives the device.
    pub fn validation_log(&self) -> &Arc<ValidationLog> {
        self.instance.validation_log()
    }

    /// Names an object for debuggers and the validation layers.
    pub fn name<H: vk::Handle>(&self, handle: H, name: &str) {
        let Some(names) = &self.names else { return };
        let Ok(name) = std::ffi::CString::new(name) else { return };
        let info =
            vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
        // SAFETY: the handle is of this device.
        if let Err(error) = unsafe { names.set_debug_utils_object_name(&info) } {
            tracing::debug!("could not name an object: {error}");
        }
    }

    /// Runs `f` with the queue locked: for presenting, and for libraries that submit themselves.
    pub fn with_queue<T>(&self, f: impl FnOnce(vk::Queue) -> T) -> T {
        f(self.lock_queue().raw)
    }

    /// Submits command buffers. At most [`MAX_SEMAPHORES`] of each kind.
    pub fn submit(
        &self,
        buffers: &[vk::CommandBuffer],
        wait: &[vk::SemaphoreSubmitInfo<'_>],
        signal: &[vk::SemaphoreSubmitInfo<'_>],
    ) -> Result<Serial> {
        if buffers.len() > MAX_SEMAPHORES || signal.len() > MAX_SEMAPHORES {
            return Err(GpuError::Host(format!(
                "a submission takes at most {MAX_SEMAPHORES} command buffers and semaphores"
            )));
        }
        let mut queue = self.lock_queue();
        let serial = queue.submitted + 1;
        let mut commands = [vk::CommandBufferSubmitInfo::default(); MAX_SEMAPHORES];
        for (info, &buffer) in commands.iter_mut().zip(buffers) {
            *info = info.command_buffer(buffer);
        }
        let mut signals = [vk::SemaphoreSubmitInfo::default(); MAX_SEMAPHORES + 1];
        signals[0] = signals[0]
            .semaphore(self.timeline)
            .value(serial)
            .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS);
        signals[1..=signal.len()].copy_from_slice(signal);
        let info = vk::SubmitInfo2::default()
            .command_buffer_infos(&commands[..buffers.len()])
            .wait_semaphore_infos(wait)
            .signal_semaphore_infos(&signals[..=signal.len()]);
        // SAFETY: the queue is locked, the handles are of this device.
        unsafe { self.raw.queue_submit2(queue.raw, &[info], vk::Fence::null()) }
            .during("submit work")?;
        queue.submitted = serial;
        Ok(Serial(serial))
    }

    /// Waits until a submission has finished.
    pub fn wait(&self, serial: Serial) -> Result<()> {
        let semaphores = [self.timeline];
        let values = [serial.0];
        let info = vk::SemaphoreWaitInfo::default().semaphores(&semaphores).values(&values);
        // SAFETY: the semaphore is of this device and lives.
        match unsafe { self.raw.wait_semaphores(&info, PATIENCE.as_nanos() as u64) } {
            Err(vk::Result::TIMEOUT) => Err(GpuError::Timeout(PATIENCE.as_secs())),
            result => result.during("wait for the device"),
        }
    }

    /// Returns whether a submission has finished.
    pub fn is_done(&self, serial: Serial) -> Result<bool> {
        Ok(self.reached()? >= serial.0)
    }

    fn reached(&self) -> Result<u64> {
        // SAFETY: the semaphore is of this device and lives.
        unsafe { self.raw.get_semaphore_counter_value(self.timeline) }
            .during("ask how far the device is")
    }

    /// Waits until nothing is in flight, and destroys retired objects.
    pub fn wait_idle(&self) -> Result<()> {
        {
            let _queue = self.lock_queue();
            // SAFETY: the queue is locked.
            unsafe { self.raw.device_wait_idle() }.during("wait for the device")?;
        }
        self.collect()
    }

    /// Destroys retired objects that are no longer in use. Called at the beginning of each frame.
    pub fn collect(&self) -> Result<()> {
        let reached = self.reached()?;
        let mut retired = self.lock_retired();
        if retired.len() == 0 {
            return Ok(());
        }
        let Some(allocator) = &self.allocator else { return Ok(()) };
        let mut allocator = allocator.lock().unwrap_or_else(PoisonError::into_inner);
        while let Some(object) = retired.take(reached) {
            object.destroy(&self.raw, &mut allocator);
        }
        Ok(())
    }

    /// Calls `destroy` once all work that is submitted or being recorded now has finished.
    pub fn retire_with(&self, destroy: impl FnOnce(&ash::Device) + Send + 'static) {
        self.retire(Retired::Call(Box::new(destroy)));
    }

    pub(super) fn retire(&self, object: Retired) {
        let submitted = self.lock_queue().submitted;
        self.lock_retired().push(submitted, object);
    }

    pub(super) fn recording_begun(&self) {
        self.lock_retired().recording_begun();
    }

    pub(super) fn recording_ended(&self) {
        let submitted = self.lock_queue().submitted;
        self.lock_retired().recording_ended(submitted);
    }

    fn lock_queue(&self) -> MutexGuard<'_, DeviceQueue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn lock_retired(&self) -> MutexGuard<'_, RetireQueue> {
        self.retired.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // A lost device returns an error here and may be destroyed all the same.
        // SAFETY: nobody else has the device any more.
        if let Err(error) = unsafe { self.raw.device_wait_idle() } {
            tracing::warn!("the device did not come to rest: {error}");
        }
        if let Some(allocator) = self.allocator.take() {
            let mut guard = allocator.lock().unwrap_or_else(PoisonError::into_inner);
            while let Some(object) = self.lock_retired().take_any() {
                object.destroy(&self.raw, &mut guard);
            }
        }
        if let Some(pipelines) = self.pipelines.take() {
            pipelines.end(&self.raw);
        }
        // SAFETY: idle, and every owner made from the device is gone.
        unsafe {
            self.raw.destroy_semaphore(self.timeline, None);
            self.raw.destroy_device(None);
        }
    }
}
