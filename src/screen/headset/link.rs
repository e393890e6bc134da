//! A session with a headset as the program sees it, from connecting to closing: orders to the
//! session's thread, and the recording of pictures into the headset's images.
//!
//! It has a Vulkan device of its own, made by the runtime, so that nothing else is lost with the
//! runtime. Nothing here waits for the runtime longer than [`PATIENCE`].

use std::sync::Arc;
use std::sync::mpsc::{Sender, channel, sync_channel};
use std::time::{Duration, Instant};

use ash::vk::Handle as _;
use glam::UVec2;
use openxr as xr;

use super::actions::Actions;
use super::chain::{Chain, Images, copy};
use super::error::{Doing, HeadsetError, Result};
use super::host::HeadsetHost;
use super::lifecycle::Lifecycle;
use super::parting::Helper;
use super::runtime::{Blend, Connector};
use super::session::{Aimed, End, Layers, LinkNews, Order, Session};
use super::worn::{Lending, WornHead};
use crate::gpu::{Device, DeviceOptions, EyeImage, Frames, ImagePart, Recorder, Serial, Use};
use crate::input::hands::HandSide;

/// Longest wait for the runtime within a frame: it answers at once, or hangs.
const PATIENCE: Duration = Duration::from_millis(250);

/// The origin of the room's space.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RoomOrigin {
    /// On the floor, in the centre of the play area, if the runtime knows it.
    #[default]
    Stage,
    /// The head's position when the session began.
    Local,
}

/// The options of a session.
#[derive(Clone, PartialEq, Debug)]
pub struct LinkOptions {
    pub blend: Blend,
    pub origin: RoomOrigin,
    /// Factor on the runtime's recommended width and height of an eye's picture.
    pub resolution: f32,
    /// Size of the board's picture, in pixels.
    pub board_px: UVec2,
    pub device: DeviceOptions,
}

/// A session with a headset. Fields are dropped in this order, after its thread has ended.
pub struct Link {
    /// Until it is started.
    session: Option<Session>,
    orders: Option<Sender<Order>>,
    thread: Option<Helper>,
    _lending: Option<Lending>,
    frames: Frames,
    colour: Images,
    depth: Option<Images>,
    board: Images,
    /// The requested blend mode, the available ones, and the present one.
    wish: Blend,
    modes: Vec<xr::EnvironmentBlendMode>,
    blend: xr::EnvironmentBlendMode,
    /// The names of runtime and headset.
    name: String,
    /// When the runtime last answered, or the program last finished working on its news.
    heard: Instant,
    /// It has not answered in time since.
    stalled: bool,
    device: Arc<Device>,
}

impl Link {
    /// Connects to the runtime's headset, which may take long. `worn`: gets the poses of its head.
    pub fn connect(
        connector: &mut Connector,
        options: &LinkOptions,
        worn: Option<&WornHead>,
    ) -> Result<Link> {
        let runtime = connector.connect(options.blend)?;
        let mut host = HeadsetHost { xr: &runtime.instance, system: runtime.system };
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
        // SAFETY: the handles are of instance and device that the runtime has made; the guard
        // keeps them alive, and session and program use their queue in turns.
        let (session, waiter, stream) = unsafe {
            runtime.instance.create_session_with_guard::<xr::Vulkan>(runtime.system, &info, guard)
        }
        .doing("begin a session with the headset")?;
        let size = (runtime.eye_size.as_vec2() * options.resolution).round().as_uvec2();
        let size = size.clamp(UVec2::splat(16), runtime.eye_limit.max(UVec2::splat(16)));
        let lacks = || HeadsetError::Unsuitable {
            runtime: runtime.name.clone(),
            lack: "shows no pictures of the format R8G8B8A8_SRGB; update it".to_string(),
        };
        let colour = Chain::new(&session, size, 2, false)?.ok_or_else(lacks)?;
        let depth = match runtime.takes_depth {
            true => Chain::new(&session, size, 2, true)?,
            false => None,
        };
        let board = Chain::new(&session, options.board_px, 1, false)?.ok_or_else(lacks)?;
        tracing::info!(
            "headset: {}, {}x{} pixels an eye, {}{}",
            runtime.name,
            size.x,
            size.y,
            blending(runtime.blend),
            if depth.is_some() { ", with depth" } else { "" }
        );
        let lend = |worn: &WornHead| worn.lend(&session, &runtime.name, runtime.tells_time);
        Ok(Link {
            orders: None,
            thread: None,
            _lending: worn.map(lend).transpose()?,
            frames: Frames::new(&device)?,
            colour: colour.images(),
            depth: depth.as_ref().map(Chain::images),
            board: board.images(),
            wish: options.blend,
            modes: runtime.modes,
            blend: runtime.blend,
            name: runtime.name,
            heard: Instant::now(),
            stalled: false,
            session: Some(Session {
                stream,
                waiter,
                colour,
                depth,
                board,
                board_filled: false,
                actions: Actions::new(&session, runtime.hears_hands)?,
                room: make_room(&session, options.origin)?,
                lifecycle: Lifecycle::default(),
                session,
                instance: runtime.instance,
            }),
            device,
        })
    }

    /// Starts the session's thread, which calls `tell` with its news until that returns false.
    pub fn start(&mut self, tell: impl Fn(LinkNews) -> bool + Send + 'static) -> Result<()> {
        let Some(session) = self.session.take() else { return Ok(()) };
        let (orders, heard) = channel();
        let work = move || session.run(&heard, &tell);
        self.thread = Some(Helper::start("headset", work).map_err(HeadsetError::Thread)?);
        self.orders = Some(orders);
        Ok(())
    }

    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// The names of runtime and headset.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Size of each eye's picture, in pixels.
    pub fn eye_size(&self) -> UVec2 {
        self.colour.size
    }

    /// Whether the surroundings are visible where the pictures are transparent.
    pub fn sees_through(&self) -> bool {
        self.blend != xr::EnvironmentBlendMode::OPAQUE
    }

    /// The available blend modes.
    pub fn blends(&self) -> Vec<Blend> {
        self.modes.iter().filter_map(|mode| Blend::of(*mode)).collect()
    }

    /// Requests a blend mode, as far as the headset has it, from the next frame on.
    pub fn set_blend(&mut self, wish: Blend) {
        if std::mem::replace(&mut self.wish, wish) != wish
            && let Some(mode) = wish.choose(&self.modes)
            && std::mem::replace(&mut self.blend, mode) != mode
        {
            tracing::info!("headset: now {}", blending(mode));
        }
    }

    /// The runtime has answered.
    pub fn hear(&mut self) {
        self.heard = Instant::now();
        self.stalled = false;
    }

    /// How long the runtime has not answered.
    pub fn silence(&self) -> Duration {
        self.heard.elapsed()
    }

    /// Vibrates a hand with a strength of 0 to 1.
    pub fn feel(&self, side: HandSide, strength: f32) {
        self.order(Order::Feel(side, strength));
    }

    /// The present poses of the eyes, and acquired images to fill: with `board` one for its
    /// picture, too. None while the head is not tracked, and if the runtime does not answer.
    pub fn aim(&mut self, board: bool) -> Option<Aimed> {
        let (reply, answer) = sync_channel(1);
        self.order(Order::Aim { board, reply });
        let asked = Instant::now();
        let aimed = answer.recv_timeout(PATIENCE).ok();
        self.stalled |= aimed.is_none() && asked.elapsed() >= PATIENCE;
        aimed
    }

    /// Starts recording the frame's commands; also returns the frame slot.
    pub fn record(&mut self) -> Result<(Recorder, usize)> {
        let recorder = self.frames.begin()?;
        Ok((recorder, self.frames.slot()))
    }

    /// Records the copy of the renderer's pictures to the headset.
    pub fn show(
        &self,
        recorder: &mut Recorder,
        aimed: &Aimed,
        colour: &EyeImage,
        depth: &mut EyeImage,
    ) -> Result<()> {
        let size = self.colour.size;
        let from = colour.image().whole();
        self.colour.fill(recorder, aimed.colour, |recorder, to| copy(recorder, from, to, size))?;
        if let (Some(target), Some(index)) = (&self.depth, aimed.depth) {
            for eye in 0..depth.eyes() {
                depth.transition(recorder, eye, Use::COPY_SOURCE);
            }
            let from = depth.image().whole();
            target.fill(recorder, index, |recorder, to| copy(recorder, from, to, size))?;
        }
        Ok(())
    }

    /// Records the copy of the board's picture, of the size of [`LinkOptions::board_px`] and in the
    /// layout of [`Use::COPY_SOURCE`], if there is an image for it.
    pub fn show_board(
        &self,
        recorder: &mut Recorder,
        aimed: &Aimed,
        from: ImagePart,
    ) -> Result<()> {
        let Some(index) = aimed.board else { return Ok(()) };
        let size = self.board.size;
        self.board.fill(recorder, index, |recorder, to| copy(recorder, from, to, size))
    }

    /// Submits the recording. [`Link::end`] must follow.
    pub fn submit(&mut self, recorder: Recorder) -> Result<Serial> {
        Ok(self.frames.submit(recorder, &[], &[])?)
    }

    /// Ends the frame with these layers. `board_filled`: whether it contained [`Link::show_board`].
    pub fn end(&mut self, layers: Layers, board_filled: bool) {
        self.order(Order::End(End { blend: self.blend, layers, board_filled }));
        if !self.stalled {
            self.heard = Instant::now();
        }
    }

    /// Ends the frame without pictures.
    pub fn end_empty(&mut self) {
        self.end(Layers::default(), false);
    }

    /// Ends the session. Renderers on its device are dropped after this: until then the runtime may
    /// use the queue.
    pub fn part(&mut self) {
        self.orders = None;
        if let Some(mut thread) = self.thread.take() {
            // It owns the session, and may keep it for as long as the runtime blocks.
            thread.part();
        }
    }

    fn order(&self, order: Order) {
        if let Some(orders) = &self.orders
            && orders.send(order).is_err()
        {
            tracing::debug!("the headset's thread has ended");
        }
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.part();
    }
}

fn blending(mode: xr::EnvironmentBlendMode) -> &'static str {
    match mode {
        xr::EnvironmentBlendMode::OPAQUE => "opaque",
        xr::EnvironmentBlendMode::ADDITIVE => "additive",
        _ => "over the surroundings",
    }
}

/// The room's space: the requested one, or the one that every runtime has.
pub(super) fn make_room<G: xr::Graphics>(
    session: &xr::Session<G>,
    origin: RoomOrigin,
) -> Result<xr::Space> {
    const DOING: &str = "find the room";
    let offered = session.enumerate_reference_spaces().doing(DOING)?;
    let stage = xr::ReferenceSpaceType::STAGE;
    let kind = match origin {
        RoomOrigin::Stage if offered.contains(&stage) => stage,
        _ => xr::ReferenceSpaceType::LOCAL,
    };
    session.create_reference_space(kind, xr::Posef::IDENTITY).doing(DOING)
}
