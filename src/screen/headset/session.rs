//! A session with a headset as the program sees it, from connecting to closing: requests to the session's thread, and
//! the recording of copies into the headset's swapchains.
//!
//! It has a Vulkan device of its own, created by the runtime, so that a lost runtime takes nothing else with it.
//! Nothing here waits for the runtime longer than [`RESPONSE_TIMEOUT`].

use std::sync::Arc;
use std::sync::mpsc::{Sender, channel, sync_channel};
use std::time::{Duration, Instant};

use ash::vk::Handle as _;
use glam::UVec2;
use openxr as xr;

use super::actions::Actions;
use super::error::{Doing, HeadsetError, Result};
use super::lifecycle::Lifecycle;
use super::room_space::{RoomOrigin, create_room_space};
use super::runtime::{BlendMode, Connector};
use super::runtime_thread::RuntimeThread;
use super::session_head::{HeadShare, SessionHead};
use super::session_thread::{EndFrame, FrameLayers, FrameTargets, Request, SessionThread, XrEvent};
use super::swapchain::{Swapchain, SwapchainImages, copy_image};
use super::vulkan_host::XrVulkanHost;
use crate::gpu::{
    Device, DeviceOptions, EyeImage, Frames, ImagePart, Recorder, ResourceUse, Serial,
};
use crate::input::hands::HandSide;

/// Longest wait for the runtime within a frame: a working runtime answers at once.
const RESPONSE_TIMEOUT: Duration = Duration::from_millis(250);

/// The options of a session.
#[derive(Clone, PartialEq, Debug)]
pub struct XrSessionOptions {
    pub blend: BlendMode,
    pub origin: RoomOrigin,
    /// Factor on the runtime's recommended width and height of an eye's picture.
    pub resolution: f32,
    /// Size of the board's picture, in pixels.
    pub board_px: UVec2,
    pub device: DeviceOptions,
}

/// A session with a headset. Fields are dropped in this order, after its thread has ended.
pub struct XrSession {
    /// `None` after [`XrSession::start`].
    not_started: Option<SessionThread>,
    requests: Option<Sender<Request>>,
    thread: Option<RuntimeThread>,
    _head_share: Option<HeadShare>,
    frames: Frames,
    targets: TargetImages,
    blending: Blending,
    /// The names of runtime and headset.
    name: String,
    responses: ResponseTimer,
    device: Arc<Device>,
}

/// The swapchain images to which pictures are copied.
struct TargetImages {
    colour: SwapchainImages,
    depth: Option<SwapchainImages>,
    board: SwapchainImages,
}

impl XrSession {
    /// Connects to the runtime's headset, which may take long. `head`: receives the poses of its
    /// head.
    pub fn connect(
        connector: &mut Connector,
        options: &XrSessionOptions,
        head: Option<&SessionHead>,
    ) -> Result<XrSession> {
        let runtime = connector.connect(options.blend)?;
        let mut host = XrVulkanHost { xr: &runtime.instance, system: runtime.system };
        let device = Device::new(&mut host, &options.device)?;
        let info = xr::vulkan::SessionCreateInfo {
            instance: device.instance().raw().handle().as_raw() as *const _,
            physical_device: device.physical().as_raw() as *const _,
            device: device.raw().handle().as_raw() as *const _,
            queue_family_index: device.queue_family(),
            queue_index: 0,
        };
        // The session keeps the device alive until it is destroyed itself.
        let guard = Box::new(device.clone());
        // SAFETY: the handles are of the instance and device that the runtime has created; the
        // guard keeps them alive, and runtime and program never use their queue at the same time.
        let (session, waiter, stream) = unsafe {
            runtime.instance.create_session_with_guard::<xr::Vulkan>(runtime.system, &info, guard)
        }
        .doing("create a session")?;
        let size = (runtime.eye_size.as_vec2() * options.resolution).round().as_uvec2();
        let size = size.clamp(UVec2::splat(16), runtime.eye_limit.max(UVec2::splat(16)));
        let no_format = || HeadsetError::Unsuitable {
            runtime: runtime.name.clone(),
            problem: "shows no pictures of the format R8G8B8A8_SRGB; update it".to_string(),
        };
        let colour = Swapchain::new(&session, size, 2, false)?.ok_or_else(no_format)?;
        let depth = match runtime.has_depth_layers {
            true => Swapchain::new(&session, size, 2, true)?,
            false => None,
        };
        let board = Swapchain::new(&session, options.board_px, 1, false)?.ok_or_else(no_format)?;
        let blending =
            Blending { option: options.blend, offered: runtime.modes, mode: runtime.blend };
        tracing::info!(
            "headset: {}, {}x{} pixels an eye, {}{}",
            runtime.name,
            size.x,
            size.y,
            blending.describe(),
            if depth.is_some() { ", with depth" } else { "" }
        );
        let share = |head: &SessionHead| head.share(&session, &runtime.name, runtime.converts_time);
        Ok(XrSession {
            requests: None,
            thread: None,
            _head_share: head.map(share).transpose()?,
            frames: Frames::new(&device)?,
            targets: TargetImages {
                colour: colour.images(),
                depth: depth.as_ref().map(Swapchain::images),
                board: board.images(),
            },
            blending,
            name: runtime.name,
            responses: ResponseTimer::new(),
            not_started: Some(SessionThread {
                stream,
                waiter,
                colour,
                depth,
                board,
                board_written: false,
                actions: Actions::new(&session, runtime.has_hand_interaction)?,
                room: create_room_space(&session, options.origin)?,
                lifecycle: Lifecycle::default(),
                session,
                instance: runtime.instance,
            }),
            device,
        })
    }

    /// Starts the session's thread, which calls `send` with its events until that returns false.
    pub fn start(&mut self, send: impl Fn(XrEvent) -> bool + Send + 'static) -> Result<()> {
        let Some(session) = self.not_started.take() else { return Ok(()) };
        let (requests, received) = channel();
        let work = move || session.run(&received, &send);
        self.thread = Some(RuntimeThread::start("headset", work).map_err(HeadsetError::Thread)?);
        self.requests = Some(requests);
        Ok(())
    }

    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Returns the names of runtime and headset.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the size of each eye's picture, in pixels.
    pub fn eye_size(&self) -> UVec2 {
        self.targets.colour.size
    }

    /// Returns whether transparent parts of pictures show the surroundings.
    pub fn is_see_through(&self) -> bool {
        self.blending.mode != xr::EnvironmentBlendMode::OPAQUE
    }

    /// Returns the available blend modes.
    pub fn blends(&self) -> Vec<BlendMode> {
        self.blending.offered.iter().filter_map(|mode| BlendMode::of(*mode)).collect()
    }

    /// Requests a blend mode from the next frame on; the nearest available one is used.
    pub fn set_blend(&mut self, option: BlendMode) {
        self.blending.request(option);
    }

    /// Records an answer of the runtime.
    pub fn note_response(&mut self) {
        self.responses.note();
    }

    /// Returns the time since the runtime last answered.
    pub fn unresponsive_for(&self) -> Duration {
        self.responses.last.elapsed()
    }

    /// Vibrates a controller with a strength of 0 to 1.
    pub fn vibrate(&self, side: HandSide, strength: f32) {
        self.send(Request::Vibrate(side, strength));
    }

    /// Locates the eyes once more and acquires the images to copy to, with `board` also one for the board's picture.
    /// Returns `None` while the head is not tracked, and if the runtime does not answer.
    pub fn acquire_targets(&mut self, board: bool) -> Option<FrameTargets> {
        let (reply, answer) = sync_channel(1);
        self.send(Request::AcquireTargets { board, reply });
        let requested = Instant::now();
        let targets = answer.recv_timeout(RESPONSE_TIMEOUT).ok();
        self.responses.timed_out |= targets.is_none() && requested.elapsed() >= RESPONSE_TIMEOUT;
        targets
    }

    /// Starts recording the frame's commands; also returns the frame slot.
    pub fn begin_recording(&mut self) -> Result<(Recorder, usize)> {
        let recorder = self.frames.begin()?;
        Ok((recorder, self.frames.slot()))
    }

    /// Records the copy of the renderer's pictures to the headset.
    pub fn copy_eyes(
        &self,
        recorder: &mut Recorder,
        targets: &FrameTargets,
        colour: &EyeImage,
        depth: &mut EyeImage,
    ) -> Result<()> {
        let images = &self.targets;
        let size = images.colour.size;
        let from = colour.image().whole();
        let copy = |recorder: &mut Recorder, to| copy_image(recorder, from, to, size);
        images.colour.write(recorder, targets.colour, copy)?;
        if let (Some(image), Some(index)) = (&images.depth, targets.depth) {
            for eye in 0..depth.eyes() {
                depth.transition(recorder, eye, ResourceUse::COPY_SOURCE);
            }
            let from = depth.image().whole();
            let copy = |recorder: &mut Recorder, to| copy_image(recorder, from, to, size);
            image.write(recorder, index, copy)?;
        }
        Ok(())
    }

    /// Records the copy of the board's picture, with the size of [`XrSessionOptions::board_px`] and in the layout of
    /// [`ResourceUse::COPY_SOURCE`], if there is an image for it.
    pub fn copy_board(
        &self,
        recorder: &mut Recorder,
        targets: &FrameTargets,
        from: ImagePart,
    ) -> Result<()> {
        let Some(index) = targets.board else { return Ok(()) };
        let size = self.targets.board.size;
        let copy = |recorder: &mut Recorder, to| copy_image(recorder, from, to, size);
        self.targets.board.write(recorder, index, copy)
    }

    /// Submits the recording. [`XrSession::end_frame`] must follow.
    pub fn submit(&mut self, recorder: Recorder) -> Result<Serial> {
        Ok(self.frames.submit(recorder, &[], &[])?)
    }

    /// Ends the frame with these layers. `board_written`: whether the submission contained
    /// [`XrSession::copy_board`].
    pub fn end_frame(&mut self, layers: FrameLayers, board_written: bool) {
        let blend = self.blending.mode;
        self.send(Request::EndFrame(EndFrame { blend, layers, board_written }));
        self.responses.note_end_of_work();
    }

    /// Ends the frame without pictures.
    pub fn end_empty_frame(&mut self) {
        self.end_frame(FrameLayers::default(), false);
    }

    /// Ends the session. Drop renderers on its device after this: until then the runtime may use the queue.
    pub fn close(&mut self) {
        self.requests = None;
        if let Some(mut thread) = self.thread.take() {
            // It owns the session, and keeps it while the runtime blocks it.
            thread.join_or_detach();
        }
    }

    fn send(&self, request: Request) {
        if let Some(requests) = &self.requests
            && requests.send(request).is_err()
        {
            tracing::debug!("the headset's thread has ended");
        }
    }
}

impl Drop for XrSession {
    fn drop(&mut self) {
        self.close();
    }
}

/// The blend modes of a session.
struct Blending {
    /// The requested one.
    option: BlendMode,
    /// The modes of the headset.
    offered: Vec<xr::EnvironmentBlendMode>,
    /// The mode in use.
    mode: xr::EnvironmentBlendMode,
}

impl Blending {
    /// Changes to the offered mode closest to `option`.
    fn request(&mut self, option: BlendMode) {
        if std::mem::replace(&mut self.option, option) != option
            && let Some(mode) = option.choose(&self.offered)
            && std::mem::replace(&mut self.mode, mode) != mode
        {
            tracing::info!("headset: now {}", self.describe());
        }
    }

    fn describe(&self) -> &'static str {
        match self.mode {
            xr::EnvironmentBlendMode::OPAQUE => "opaque",
            xr::EnvironmentBlendMode::ADDITIVE => "additive",
            _ => "over the surroundings",
        }
    }
}

/// Measures the time since the runtime last answered.
struct ResponseTimer {
    /// Time of the runtime's last answer, or of the end of the program's work on an event.
    last: Instant,
    /// A request has timed out since.
    timed_out: bool,
}

impl ResponseTimer {
    fn new() -> ResponseTimer {
        ResponseTimer { last: Instant::now(), timed_out: false }
    }

    /// Records an answer of the runtime.
    fn note(&mut self) {
        *self = ResponseTimer::new();
    }

    /// Records the end of the program's work on an event, which is no delay of the runtime.
    fn note_end_of_work(&mut self) {
        if !self.timed_out {
            self.last = Instant::now();
        }
    }
}
