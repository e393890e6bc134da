//! Vulkan objects and their lifetimes: device, memory, commands, pipelines, upload and readback.
//!
//! Knows Vulkan 1.3 and nothing of sculptures. It has no policy: `render` decides what to draw,
//! `screen` where it is shown.
//!
//! # How to use it
//!
//! ```no_run
//! use virtual_sculpture::gpu::{Device, DeviceOptions, Frames, Headless};
//!
//! # fn main() -> virtual_sculpture::gpu::Result<()> {
//! let device = Device::new(&mut Headless, &DeviceOptions::default().with_environment())?;
//! let mut frames = Frames::new(&device)?;
//! let recorder = frames.begin()?; // waits until this slot's last frame is done
//! // recorder.image_barrier(..), begin_rendering(..), bind_pipeline(..), draw(..)
//! let serial = frames.submit(recorder, &[], &[])?;
//! device.wait(serial)?;
//! # Ok(())
//! # }
//! ```
//!
//! For a window, `WindowHost::new(Arc<Window>)` is the host; after `Device::new(&mut host, ..)` the
//! surface is `host.into_surface()`. `screen` makes a swapchain from the surface and `Device::raw`;
//! its semaphores go to [`Frames::submit`], and it presents in [`Device::with_queue`]. A headset
//! implements [`Host`], whose hooks let its runtime make instance and device.
//!
//! Rules:
//! - Owners ([`Buffer`], [`Image`], [`Pipeline`], ...) keep the device alive and may be dropped
//!   at any time: resources that the device may still use wait in the retire queue. Anything else
//!   can be put there with [`Device::retire_with`].
//! - Resources that the CPU writes each frame have one copy for each frame slot ([`Frames::slot`]):
//!   [`Staging`] for data, [`DescriptorSets`] with [`FRAMES_IN_FLIGHT`] sets.
//! - Depth is reversed: clear to 0, nearer is greater ([`Depth::NEARER`]).
//! - Every failure is a [`GpuError`]; [`GpuError::DeviceLost`] asks for a new device.
//! - Tests ask for [`Validation::IfAvailable`] and assert that
//!   [`Device::validation_messages`] is empty.

mod choice;
mod commands;
mod descriptors;
mod device;
mod error;
mod eye_image;
mod host;
mod instance;
pub mod layout;
mod memory;
mod options;
mod pipeline;
mod pipeline_cache;
mod readback;
mod retire;
pub mod shaders;
mod timing;
mod upload;
mod validation;

pub use choice::{DeviceChoice, survey};
pub use commands::{
    Attachment, FRAMES_IN_FLIGHT, Frames, Load, Pool, Recorder, ResourceUse, run_once,
};
pub use descriptors::{Binding, DescriptorSets, SetLayout, TextureSampler};
pub use device::{Device, DeviceOptions, MAX_SEMAPHORES, Serial};
pub use error::{During, GpuError, Result};
pub use eye_image::{CornerAndSize, EyeImage};
pub use host::{Headless, WindowHost, WindowSurface};
pub use instance::{Host, Instance, Validation};
pub use memory::{Buffer, BufferRange, Image, ImageInfo, ImagePart, MemoryLocation};
pub use options::GpuOptions;
pub use pipeline::{
    Attribute, Blend, Depth, Graphics, MAX_PUSH_BYTES, Pipeline, PipelineLayout, Vertices,
};
pub use readback::{Readback, TexelRows, read_image_once};
pub use timing::Timer;
pub use upload::Staging;
pub use validation::ValidationLog;
