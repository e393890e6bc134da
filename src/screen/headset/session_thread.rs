//! The OpenXR calls of a session, on a thread of its own: events, frames, controllers, views, swapchains, layers. A
//! runtime that blocks in a call blocks only this thread, and no window.
//!
//! Sends [`XrEvent`]s, receives [`Request`]s. Each frame is waited for, begun, reported, and ended on request; only
//! then the next one is waited for, so that frames do not queue up and late ones are skipped. Between a frame's report
//! and its end the program owns the queue of the device.

use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::Duration;

use glam::Vec2;
use openxr as xr;

use super::actions::{Actions, from_xr, to_xr};
use super::error::{Doing, HeadsetError, Result};
use super::lifecycle::{Lifecycle, Transition};
use super::runtime::VIEWS;
use super::swapchain::Swapchain;
use crate::input::hands::{Board, HandSide, HandsState};
use crate::view::RoomView;
use crate::view::eye::Frustum;
use crate::view::room::NEAR_M;

/// Interval of polling the runtime for events while it shows no frames.
const POLL: Duration = Duration::from_millis(50);

/// An event of a session, or of an attempt to connect.
#[derive(Debug)]
pub enum XrEvent {
    /// A frame has begun, and must be ended.
    Frame(Box<XrFrame>),
    /// The room's origin was moved, by the person or by the runtime.
    Recentred,
    /// The session has ended; `retry`: the program may connect again.
    Ended { retry: bool },
    /// The session has failed.
    Failed(HeadsetError),
    /// An attempt to connect has finished.
    ConnectFinished,
}

/// A frame that has begun.
#[derive(Clone, Debug)]
pub struct XrFrame {
    /// Time of its display, on the runtime's clock.
    display: xr::Time,
    /// Whether it will be visible.
    pub visible: bool,
    /// The views of the eyes, as predicted when the frame began; `None` while the head is not tracked.
    pub views: Option<[RoomView; 2]>,
    /// State of both controllers, while the program has the input focus.
    pub hands: Option<HandsState>,
}

impl XrFrame {
    /// Returns the time of its display, in seconds of a monotonic clock.
    pub fn display_time_s(&self) -> f64 {
        self.display.as_nanos() as f64 * 1e-9
    }
}

/// The layers of a frame.
#[derive(Clone, Debug, Default)]
pub struct FrameLayers {
    /// The views with which the pictures were rendered; `None` shows no pictures.
    pub views: Option<[RoomView; 2]>,
    /// The board, while it is open.
    pub board: Option<Board>,
}

/// A request to the session's thread.
pub(super) enum Request {
    /// Locate the eyes again, and acquire images.
    AcquireTargets {
        board: bool,
        reply: SyncSender<FrameTargets>,
    },
    EndFrame(EndFrame),
    /// Vibrate a controller with a strength of 0 to 1.
    Vibrate(HandSide, f32),
}

/// The targets of a frame: the views of the eyes, and the indices of the acquired images in their swapchains.
#[derive(Clone, Debug)]
pub struct FrameTargets {
    pub views: [RoomView; 2],
    pub(super) colour: usize,
    pub(super) depth: Option<usize>,
    pub(super) board: Option<usize>,
}

/// The end of a frame. Everything that writes its images has been submitted.
pub(super) struct EndFrame {
    pub blend: xr::EnvironmentBlendMode,
    pub layers: FrameLayers,
    /// The board's image was written.
    pub board_written: bool,
}

/// The resources that the thread owns. Fields are dropped in this order.
pub(super) struct SessionThread {
    pub stream: xr::FrameStream<xr::Vulkan>,
    pub waiter: xr::FrameWaiter,
    pub colour: Swapchain,
    pub depth: Option<Swapchain>,
    pub board: Swapchain,
    /// The board's images have been written once.
    pub board_written: bool,
    pub actions: Actions,
    pub room: xr::Space,
    pub lifecycle: Lifecycle,
    pub session: xr::Session<xr::Vulkan>,
    pub instance: xr::Instance,
}

impl SessionThread {
    /// Runs until the runtime ends the session, it fails, or the sender of requests is dropped.
    pub fn run(mut self, requests: &Receiver<Request>, send: &dyn Fn(XrEvent) -> bool) {
        if let Err(error) = self.run_frames(requests, send) {
            send(XrEvent::Failed(error));
        }
    }

    fn run_frames(
        &mut self,
        requests: &Receiver<Request>,
        send: &dyn Fn(XrEvent) -> bool,
    ) -> Result<()> {
        let mut events = xr::EventDataBuffer::new();
        loop {
            // No frame is in progress here, so a session never ends within one.
            if let Some(event) = self.poll_events(&mut events)? {
                let ended = matches!(event, XrEvent::Ended { .. });
                if !send(event) || ended {
                    return Ok(());
                }
            }
            if !self.lifecycle.is_running() {
                match requests.recv_timeout(POLL) {
                    Ok(request) => {
                        self.handle(request, None)?;
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => return Ok(()),
                }
                continue;
            }
            let frame = self.begin_frame()?;
            if !send(XrEvent::Frame(Box::new(frame.clone()))) {
                return Ok(());
            }
            loop {
                let Ok(request) = requests.recv() else { return Ok(()) };
                if self.handle(request, Some(&frame))? {
                    break;
                }
            }
        }
    }

    /// Handles the events of the runtime. Returns the event for the program, if there is one.
    fn poll_events(&mut self, events: &mut xr::EventDataBuffer) -> Result<Option<XrEvent>> {
        let mut reported = None;
        while let Some(event) = self.instance.poll_event(events).doing("poll events")? {
            match event {
                xr::Event::SessionStateChanged(event) => {
                    let state = event.state();
                    tracing::debug!("headset session: {state:?}");
                    match self.lifecycle.enter(state) {
                        Transition::Begin => {
                            self.session.begin(VIEWS).doing("begin the session")?;
                        }
                        Transition::End => {
                            self.session.end().doing("end the session")?;
                        }
                        Transition::Destroy { retry } => return Ok(Some(XrEvent::Ended { retry })),
                        Transition::None => {}
                    }
                }
                xr::Event::InstanceLossPending(_) => {
                    return Ok(Some(XrEvent::Ended { retry: true }));
                }
                xr::Event::ReferenceSpaceChangePending(_) => {
                    reported = Some(XrEvent::Recentred);
                }
                xr::Event::InteractionProfileChanged(_) => {
                    for side in HandSide::ALL {
                        let profile = self.actions.profile(side);
                        let profile = profile.as_deref().unwrap_or("no controller");
                        tracing::info!("{side:?} hand: {profile}");
                    }
                }
                xr::Event::EventsLost(event) => {
                    tracing::warn!("{} events of the headset were lost", event.lost_event_count());
                }
                _ => {}
            }
        }
        Ok(reported)
    }

    fn begin_frame(&mut self) -> Result<XrFrame> {
        let state = self.waiter.wait().doing("wait for the next frame")?;
        self.stream.begin().doing("begin a frame")?;
        let (display, visible) = (state.predicted_display_time, state.should_render);
        Ok(XrFrame {
            display,
            visible,
            views: if visible { self.views(display)? } else { None },
            hands: match visible && self.lifecycle.is_focused() {
                true => Some(self.actions.read(&self.room, display)?),
                false => None,
            },
        })
    }

    /// Handles a request. Returns true if the frame has ended.
    fn handle(&mut self, request: Request, frame: Option<&XrFrame>) -> Result<bool> {
        match (request, frame) {
            (Request::Vibrate(side, strength), _) => self.actions.vibrate(side, strength)?,
            (Request::AcquireTargets { board, reply }, Some(frame)) => {
                if let Some(views) = self.views(frame.display)? {
                    let targets = FrameTargets {
                        views,
                        colour: self.colour.acquire()?,
                        depth: self.depth.as_mut().map(Swapchain::acquire).transpose()?,
                        board: if board { Some(self.board.acquire()?) } else { None },
                    };
                    // A caller that has given up ends the frame without pictures; the images stay acquired.
                    let _ = reply.send(targets);
                }
            }
            (Request::EndFrame(end), Some(frame)) => {
                self.end_frame(frame, &end)?;
                return Ok(true);
            }
            (Request::AcquireTargets { .. } | Request::EndFrame(_), None) => {}
        }
        Ok(false)
    }

    /// Returns the views of the eyes at a time; `None` while the head is not tracked.
    fn views(&self, display: xr::Time) -> Result<Option<[RoomView; 2]>> {
        let (flags, views) =
            self.session.locate_views(VIEWS, display, &self.room).doing("locate the eyes")?;
        use xr::ViewStateFlags as Flags;
        let [left, right] = views[..] else { return Ok(None) };
        let tracked = flags.contains(Flags::ORIENTATION_VALID | Flags::POSITION_VALID);
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
        Ok((tracked && views.iter().all(usable)).then_some(views))
    }

    fn end_frame(&mut self, frame: &XrFrame, end: &EndFrame) -> Result<()> {
        if end.layers.views.is_some() {
            self.colour.release()?;
            if let Some(depth) = &mut self.depth {
                depth.release()?;
            }
        }
        if end.board_written {
            self.board.release()?;
            self.board_written = true;
        }
        let views = end.layers.views.as_ref().map_or(&[][..], |views| views);
        // Depth is reversed, with its far plane at infinity.
        let depth_info = [0, 1].map(|eye| {
            self.depth.as_ref().map(|depth| xr::sys::CompositionLayerDepthInfoKHR {
                ty: xr::sys::CompositionLayerDepthInfoKHR::TYPE,
                next: std::ptr::null(),
                sub_image: *depth.sub_image(eye).as_raw(),
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
                .sub_image(self.colour.sub_image(eye));
            let mut raw = projected.into_raw();
            if let Some(depth) = depth {
                raw.next = std::ptr::from_ref(depth).cast();
            }
            // SAFETY: `depth_info` outlives the call that ends the frame.
            unsafe { xr::CompositionLayerProjectionView::from_raw(raw) }
        });
        let projected: Vec<_> = projected.collect();
        let flags = match end.blend {
            xr::EnvironmentBlendMode::ALPHA_BLEND => {
                xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA
            }
            _ => xr::CompositionLayerFlags::EMPTY,
        };
        let scene = xr::CompositionLayerProjection::new()
            .layer_flags(flags)
            .space(&self.room)
            .views(&projected);
        let board = end.layers.board.as_ref().filter(|_| self.board_written).map(|board| {
            let Vec2 { x: width, y: height } = board.size_m;
            xr::CompositionLayerQuad::new()
                .layer_flags(xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA)
                .space(&self.room)
                .eye_visibility(xr::EyeVisibility::BOTH)
                .sub_image(self.board.sub_image(0))
                .pose(to_xr(&board.pose))
                .size(xr::Extent2Df { width, height })
        });
        let mut layers: Vec<&xr::CompositionLayerBase<'_, xr::Vulkan>> = Vec::new();
        if !views.is_empty() {
            layers.push(&scene);
        }
        if let Some(board) = &board {
            layers.push(board);
        }
        self.stream.end(frame.display, end.blend, &layers).doing("end a frame")
    }
}

fn fov(frustum: &Frustum) -> xr::Fovf {
    xr::Fovf {
        angle_left: frustum.left.atan(),
        angle_right: frustum.right.atan(),
        angle_up: frustum.up.atan(),
        angle_down: frustum.down.atan(),
    }
}
