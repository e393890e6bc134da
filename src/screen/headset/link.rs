//! Owns a session with a headset from connecting to parting: events, frames, views, layers.
//!
//! A link has a Vulkan device of its own, made by the runtime: should that go away, nothing but
//! the link goes with it. One thread uses it; only the wait for the next frame happens elsewhere.

use std::sync::Arc;

use ash::vk::Handle as _;
use glam::{UVec2, Vec2};
use openxr as xr;

use super::actions::{Actions, from_xr, to_xr};
use super::chain::{Chain, copy};
use super::error::{Doing, HeadsetError, Result};
use super::host::HeadsetHost;
use super::lifecycle::{Answer, Lifecycle};
use super::runtime::{Blend, Runtime, VIEWS};
use super::waiter::{FrameNews, FrameTime, Waiter};
use super::worn::{Lending, WornHead};
use crate::gpu::{Device, DeviceOptions, Frames, ImagePart, Recorder, Use};
use crate::input::hands::{Board, HandSide, HandsState};
use crate::render::renderer::Pictures;
use crate::view::RoomView;
use crate::view::eye::Frustum;
use crate::view::room::NEAR_M;

/// Where the room's origin lies.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RoomOrigin {
    /// On the floor, in the middle of the space to walk in, where the runtime knows it.
    #[default]
    Stage,
    /// Where the head was when the session began.
    Local,
}

/// What a person chooses about a headset.
#[derive(Clone, PartialEq, Debug)]
pub struct LinkOptions {
    pub blend: Blend,
    pub origin: RoomOrigin,
    /// Factor on the runtime's recommended width and height of pictures.
    pub resolution: f32,
    /// Of the board's picture, in pixels.
    pub board_px: UVec2,
    pub device: DeviceOptions,
}

/// What became of the session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Standing {
    /// It goes on.
    Going,
    /// The room's origin has been moved, by the person or by the runtime.
    Recentred,
    /// It is over; `again` says whether another may be tried for.
    Over { again: bool },
}

/// What is shown in a frame.
pub struct Layers<'a> {
    /// The views that the pictures were made for; none shows no pictures.
    pub views: Option<[RoomView; 2]>,
    /// Where the board is, while it is open.
    pub board: Option<&'a Board>,
}

/// A session with a headset. Fields are dropped in this order.
pub struct Link {
    waiter: Waiter,
    _lending: Option<Lending>,
    stream: xr::FrameStream<xr::Vulkan>,
    frames: Frames,
    colour: Chain,
    depth: Option<Chain>,
    board: Chain,
    /// The board's images have held a picture.
    board_filled: bool,
    /// What is wished for as to the surroundings.
    wish: Blend,
    actions: Actions,
    room: xr::Space,
    lifecycle: Lifecycle,
    events: xr::EventDataBuffer,
    session: xr::Session<xr::Vulkan>,
    device: Arc<Device>,
    runtime: Runtime,
}

impl Link {
    /// Connects to the runtime's headset. `worn`: who is to hear of its head. `tell` is called on
    /// another thread with each frame that may be made; it says whether anybody still listens.
    pub fn connect(
        options: &LinkOptions,
        worn: Option<&WornHead>,
        tell: impl Fn(FrameNews) -> bool + Send + 'static,
    ) -> Result<Link> {
        let runtime = Runtime::connect(options.blend)?;
        let mut host = HeadsetHost { xr: &runtime.instance, system: runtime.system };
        let device = Device::new(&mut host, &options.device)?;
        let info = xr::vulkan::SessionCreateInfo {
            instance: device.instance().raw().handle().as_raw() as *const _,
            physical_device: device.physical().as_raw() as *const _,
            device: device.raw().handle().as_raw() as *const _,
            queue_family_index: device.queue_family(),
            queue_index: 0,
        };
        // The session keeps the device alive until it is gone itself.
        let guard = Box::new(device.clone());
        // SAFETY: the handles are of instance and device that the runtime has made; the guard
        // keeps them alive, and one thread uses their queue.
        let (session, waiter, stream) = unsafe {
            runtime.instance.create_session_with_guard::<xr::Vulkan>(runtime.system, &info, guard)
        }
        .doing("begin a session with the headset")?;
        let room = make_room(&session, options.origin)?;
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
            waiter: Waiter::new(waiter, tell)?,
            _lending: worn.map(lend).transpose()?,
            stream,
            frames: Frames::new(&device)?,
            colour,
            depth,
            board,
            board_filled: false,
            wish: options.blend,
            actions: Actions::new(&session, runtime.hears_hands)?,
            room,
            lifecycle: Lifecycle::default(),
            events: xr::EventDataBuffer::new(),
            session,
            device,
            runtime,
        })
    }

    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// The runtime's name and the headset's.
    pub fn name(&self) -> &str {
        &self.runtime.name
    }

    /// Of each eye's picture, in pixels.
    pub fn eye_size(&self) -> UVec2 {
        self.colour.size()
    }

    /// Whether the surroundings are seen where the pictures show nothing.
    pub fn sees_through(&self) -> bool {
        self.runtime.blend != xr::EnvironmentBlendMode::OPAQUE
    }

    /// Ways in which pictures can go together with the surroundings.
    pub fn blends(&self) -> Vec<Blend> {
        self.runtime.modes.iter().filter_map(|mode| Blend::of(*mode)).collect()
    }

    /// Goes over to what the person wishes, as far as the headset can; from the next frame on.
    pub fn set_blend(&mut self, wish: Blend) {
        if std::mem::replace(&mut self.wish, wish) != wish
            && let Some(mode) = wish.choose(&self.runtime.modes)
            && std::mem::replace(&mut self.runtime.blend, mode) != mode
        {
            tracing::info!("headset: now {}", blending(mode));
        }
    }

    /// Whether the hands are meant for this program.
    pub fn is_focused(&self) -> bool {
        self.lifecycle.is_focused()
    }

    /// Does what the runtime's events ask for, and asks for the next frame where one is due.
    pub fn poll(&mut self) -> Result<Standing> {
        let mut standing = Standing::Going;
        loop {
            let event = self.runtime.instance.poll_event(&mut self.events);
            let Some(event) = event.doing("hear the runtime")? else { break };
            match event {
                xr::Event::SessionStateChanged(event) => {
                    let state = event.state();
                    tracing::debug!("headset session: {state:?}");
                    match self.lifecycle.enter(state) {
                        Answer::Begin => {
                            self.session.begin(VIEWS).doing("begin to show pictures")?;
                        }
                        Answer::End => {
                            self.session.end().doing("end showing pictures")?;
                        }
                        Answer::Leave { again } => return Ok(Standing::Over { again }),
                        Answer::Nothing => {}
                    }
                }
                xr::Event::InstanceLossPending(_) => return Ok(Standing::Over { again: true }),
                xr::Event::ReferenceSpaceChangePending(_) => standing = Standing::Recentred,
                xr::Event::InteractionProfileChanged(_) => {
                    for side in HandSide::ALL {
                        let profile = self.actions.profile(side);
                        let profile = profile.as_deref().unwrap_or("nothing");
                        tracing::info!("{side:?} hand: {profile}");
                    }
                }
                xr::Event::EventsLost(event) => {
                    tracing::warn!("{} events of the headset were lost", event.lost_event_count());
                }
                _ => {}
            }
        }
        if self.lifecycle.is_running() {
            self.waiter.ask();
        }
        Ok(standing)
    }

    /// Begins the frame that was told of. False if it came too late: the session has ended.
    pub fn begin(&mut self) -> Result<bool> {
        self.waiter.used();
        if !self.lifecycle.is_running() {
            return Ok(false);
        }
        self.stream.begin().doing("begin a frame")?;
        Ok(true)
    }

    /// Both hands as they will be when the frame is seen.
    pub fn hands(&self, frame: &FrameTime) -> Result<HandsState> {
        self.actions.read(&self.room, frame.display)
    }

    /// Lets a hand feel a strength of 0 to 1.
    pub fn feel(&mut self, side: HandSide, strength: f32) -> Result<()> {
        self.actions.feel(side, strength)
    }

    /// What the eyes see when the frame is seen, as far as is known now: the later it is asked for,
    /// the better. None while the head is not tracked.
    pub fn views(&self, frame: &FrameTime) -> Result<Option<[RoomView; 2]>> {
        let (flags, views) = self
            .session
            .locate_views(VIEWS, frame.display, &self.room)
            .doing("find where the eyes are")?;
        use xr::ViewStateFlags as Flags;
        let [left, right] = views[..] else { return Ok(None) };
        let known = flags.contains(Flags::ORIENTATION_VALID | Flags::POSITION_VALID);
        let views = [left, right].map(|view| RoomView {
            pose: from_xr(&view.pose),
            frustum: Frustum {
                left: view.fov.angle_left.tan(),
                right: view.fov.angle_right.tan(),
                down: view.fov.angle_down.tan(),
                up: view.fov.angle_up.tan(),
            },
        });
        let usable = |view: &RoomView| {
            let Frustum { left, right, down, up } = view.frustum;
            view.pose.is_plausible() && right > left && up > down
        };
        Ok((known && views.iter().all(usable)).then_some(views))
    }

    /// Starts recording the frame's commands; gives the slot of what is written each frame, too.
    pub fn record(&mut self) -> Result<(Recorder, usize)> {
        let recorder = self.frames.begin()?;
        Ok((recorder, self.frames.slot()))
    }

    /// Records the copy of the renderer's pictures to the headset.
    pub fn show(&mut self, recorder: &mut Recorder, pictures: &mut Pictures) -> Result<()> {
        let size = self.colour.size();
        let from = pictures.colour.image().whole();
        self.colour.fill(recorder, |recorder, to| copy(recorder, from, to, size))?;
        if let Some(depth) = &mut self.depth {
            for eye in 0..pictures.depth.eyes() {
                pictures.depth.make(recorder, eye, Use::COPY_SOURCE);
            }
            let from = pictures.depth.image().whole();
            depth.fill(recorder, |recorder, to| copy(recorder, from, to, size))?;
        }
        Ok(())
    }

    /// Records the copy of the board's picture, of the size of [`LinkOptions::board_px`] and in the
    /// layout of [`Use::COPY_SOURCE`].
    pub fn show_board(&mut self, recorder: &mut Recorder, from: ImagePart) -> Result<()> {
        let size = self.board.size();
        self.board.fill(recorder, |recorder, to| copy(recorder, from, to, size))?;
        self.board_filled = true;
        Ok(())
    }

    /// Ends a frame without pictures.
    pub fn end_empty(&mut self, frame: &FrameTime) -> Result<()> {
        self.stream.end(frame.display, self.runtime.blend, &[]).doing("end a frame")
    }

    /// Submits what was recorded and ends the frame with what is to be seen. `board_shown`:
    /// whether [`Link::show_board`] was part of it.
    pub fn end(
        &mut self,
        frame: &FrameTime,
        recorder: Recorder,
        board_shown: bool,
        layers: &Layers,
    ) -> Result<crate::gpu::Serial> {
        let serial = self.frames.submit(recorder, &[], &[])?;
        if layers.views.is_some() {
            self.colour.release()?;
            if let Some(depth) = &mut self.depth {
                depth.release()?;
            }
        }
        if board_shown {
            self.board.release()?;
        }
        self.end_with(frame, layers)?;
        Ok(serial)
    }

    fn end_with(&mut self, frame: &FrameTime, layers: &Layers) -> Result<()> {
        let views = layers.views.as_ref().map_or(&[][..], |views| views);
        // Depth is reversed, and its far end is infinitely far.
        let depth_info = [0, 1].map(|eye| {
            self.depth.as_ref().map(|depth| xr::sys::CompositionLayerDepthInfoKHR {
                ty: xr::sys::CompositionLayerDepthInfoKHR::TYPE,
                next: std::ptr::null(),
                sub_image: *depth.view(eye).as_raw(),
                min_depth: 0.0,
                max_depth: 1.0,
                near_z: f32::INFINITY,
                far_z: NEAR_M,
            })
        });
        let projected = (0..).zip(views).zip(&depth_info).map(|((eye, view), depth)| {
            let projected = xr::CompositionLayerProjectionView::new()
                .pose(to_xr(&view.pose))
                .fov(fov(&view.frustum))
                .sub_image(self.colour.view(eye));
            let mut raw = projected.into_raw();
            if let Some(depth) = depth {
                raw.next = std::ptr::from_ref(depth).cast();
            }
            // SAFETY: what it points to outlives the call that ends the frame.
            unsafe { xr::CompositionLayerProjectionView::from_raw(raw) }
        });
        let projected: Vec<_> = projected.collect();
        let flags = match self.runtime.blend {
            xr::EnvironmentBlendMode::ALPHA_BLEND => {
                xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA
            }
            _ => xr::CompositionLayerFlags::EMPTY,
        };
        let scene = xr::CompositionLayerProjection::new()
            .layer_flags(flags)
            .space(&self.room)
            .views(&projected);
        let board = layers.board.filter(|_| self.board_filled).map(|board| {
            let Vec2 { x: width, y: height } = board.size_m;
            xr::CompositionLayerQuad::new()
                .layer_flags(xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA)
                .space(&self.room)
                .eye_visibility(xr::EyeVisibility::BOTH)
                .sub_image(self.board.view(0))
                .pose(to_xr(&board.pose))
                .size(xr::Extent2Df { width, height })
        });
        let mut shown: Vec<&xr::CompositionLayerBase<'_, xr::Vulkan>> = Vec::new();
        if !views.is_empty() {
            shown.push(&scene);
        }
        if let Some(board) = &board {
            shown.push(board);
        }
        self.stream.end(frame.display, self.runtime.blend, &shown).doing("end a frame")
    }

    /// Whether a frame is being waited for.
    pub fn is_waiting(&self) -> bool {
        self.waiter.is_waiting()
    }
}

fn blending(mode: xr::EnvironmentBlendMode) -> &'static str {
    match mode {
        xr::EnvironmentBlendMode::OPAQUE => "opaque",
        xr::EnvironmentBlendMode::ADDITIVE => "additive",
        _ => "over the surroundings",
    }
}

/// The room's space: the one asked for, or the one that every runtime has.
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

fn fov(frustum: &Frustum) -> xr::Fovf {
    xr::Fovf {
        angle_left: frustum.left.atan(),
        angle_right: frustum.right.atan(),
        angle_up: frustum.up.atan(),
        angle_down: frustum.down.atan(),
    }
}
