//! The OpenXR side of a session, on a thread of its own: events, frames, hands, views, images,
//! layers. A runtime that blocks in a call blocks this thread, and no window.
//!
//! Sends [`LinkNews`], receives [`Order`]s. A frame is waited for, begun, reported, and ended when
//! that is ordered; only then the next one is waited for, so that frames do not queue up and late
//! ones are skipped. Between a frame's report and its end the program owns the queue of the device.

use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::Duration;

use glam::Vec2;
use openxr as xr;

use super::actions::{Actions, from_xr, to_xr};
use super::chain::Chain;
use super::error::{Doing, HeadsetError, Result};
use super::lifecycle::{Answer, Lifecycle};
use super::runtime::VIEWS;
use crate::input::hands::{Board, HandSide, HandsState};
use crate::view::RoomView;
use crate::view::eye::Frustum;
use crate::view::room::NEAR_M;

/// How often the runtime is polled for events while it shows no frames.
const POLL: Duration = Duration::from_millis(50);

/// What happens in a session.
#[derive(Debug)]
pub enum LinkNews {
    /// A frame has begun, and must be ended.
    Frame(Box<Frame>),
    /// The room's origin was moved, by the person or by the runtime.
    Recentred,
    /// It has ended; `again`: another attempt is allowed.
    Over { again: bool },
    /// It has failed.
    Failed(HeadsetError),
    /// The search for a headset has finished.
    Tried,
}

/// A frame that has begun.
#[derive(Clone, Debug)]
pub struct Frame {
    /// When it will be shown, on the runtime's clock.
    display: xr::Time,
    /// Whether it will be visible.
    pub shown: bool,
    /// The views of the eyes, as predicted when the frame began. None while the head is not
    /// tracked.
    pub views: Option<[RoomView; 2]>,
    /// Both hands, while the program has the input focus.
    pub hands: Option<HandsState>,
}

impl Frame {
    /// When it will be shown, in seconds of a monotonic clock.
    pub fn seconds(&self) -> f64 {
        self.display.as_nanos() as f64 * 1e-9
    }
}

/// The layers of a frame.
#[derive(Clone, Debug, Default)]
pub struct Layers {
    /// The views that the pictures were rendered for; none shows no pictures.
    pub views: Option<[RoomView; 2]>,
    /// Where the board is, while it is open.
    pub board: Option<Board>,
}

/// An order to the session's thread.
pub(super) enum Order {
    /// Locate the eyes again, and acquire images.
    Aim { board: bool, reply: SyncSender<Aimed> },
    /// End the frame.
    End(End),
    /// Vibrate a hand with a strength of 0 to 1.
    Feel(HandSide, f32),
}

/// The answer to [`Order::Aim`]: indices of images in their chains.
#[derive(Clone, Debug)]
pub struct Aimed {
    pub views: [RoomView; 2],
    pub(super) colour: usize,
    pub(super) depth: Option<usize>,
    pub(super) board: Option<usize>,
}

/// How a frame ends. Everything that fills its images has been submitted.
pub(super) struct End {
    pub blend: xr::EnvironmentBlendMode,
    pub layers: Layers,
    /// The board's image was filled.
    pub board_filled: bool,
}

/// Fields are dropped in this order.
pub(super) struct Session {
    pub stream: xr::FrameStream<xr::Vulkan>,
    pub waiter: xr::FrameWaiter,
    pub colour: Chain,
    pub depth: Option<Chain>,
    pub board: Chain,
    /// The board's images have been filled once.
    pub board_filled: bool,
    pub actions: Actions,
    pub room: xr::Space,
    pub lifecycle: Lifecycle,
    pub session: xr::Session<xr::Vulkan>,
    pub instance: xr::Instance,
}

impl Session {
    /// Runs until the runtime ends the session, it fails, or nobody gives orders any more.
    pub fn run(mut self, orders: &Receiver<Order>, tell: &dyn Fn(LinkNews) -> bool) {
        if let Err(error) = self.live(orders, tell) {
            tell(LinkNews::Failed(error));
        }
    }

    fn live(&mut self, orders: &Receiver<Order>, tell: &dyn Fn(LinkNews) -> bool) -> Result<()> {
        let mut events = xr::EventDataBuffer::new();
        loop {
            // No frame is in progress: a session never ends within one.
            if let Some(news) = self.hear_runtime(&mut events)? {
                let over = matches!(news, LinkNews::Over { .. });
                if !tell(news) || over {
                    return Ok(());
                }
            }
            if !self.lifecycle.is_running() {
                match orders.recv_timeout(POLL) {
                    Ok(order) => {
                        self.obey(order, None)?;
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => return Ok(()),
                }
                continue;
            }
            let frame = self.begin_frame()?;
            if !tell(LinkNews::Frame(Box::new(frame.clone()))) {
                return Ok(());
            }
            loop {
                let Ok(order) = orders.recv() else { return Ok(()) };
                if self.obey(order, Some(&frame))? {
                    break;
                }
            }
        }
    }

    /// Handles the events of the runtime.
    fn hear_runtime(&mut self, events: &mut xr::EventDataBuffer) -> Result<Option<LinkNews>> {
        let mut news = None;
        while let Some(event) = self.instance.poll_event(events).doing("hear the runtime")? {
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
                        Answer::Leave { again } => return Ok(Some(LinkNews::Over { again })),
                        Answer::Nothing => {}
                    }
                }
                xr::Event::InstanceLossPending(_) => {
                    return Ok(Some(LinkNews::Over { again: true }));
                }
                xr::Event::ReferenceSpaceChangePending(_) => news = Some(LinkNews::Recentred),
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
        Ok(news)
    }

    fn begin_frame(&mut self) -> Result<Frame> {
        let state = self.waiter.wait().doing("wait for the next frame")?;
        self.stream.begin().doing("begin a frame")?;
        let (display, shown) = (state.predicted_display_time, state.should_render);
        Ok(Frame {
            display,
            shown,
            views: if shown { self.views(display)? } else { None },
            hands: match shown && self.lifecycle.is_focused() {
                true => Some(self.actions.read(&self.room, display)?),
                false => None,
            },
        })
    }

    /// True if the frame has ended.
    fn obey(&mut self, order: Order, frame: Option<&Frame>) -> Result<bool> {
        match (order, frame) {
            (Order::Feel(side, strength), _) => self.actions.feel(side, strength)?,
            (Order::Aim { board, reply }, Some(frame)) => {
                if let Some(views) = self.views(frame.display)? {
                    let aimed = Aimed {
                        views,
                        colour: self.colour.acquire()?,
                        depth: self.depth.as_mut().map(Chain::acquire).transpose()?,
                        board: if board { Some(self.board.acquire()?) } else { None },
                    };
                    // A caller that has given up ends the frame without pictures; the images are
                    // kept.
                    let _ = reply.send(aimed);
                }
            }
            (Order::End(end), Some(frame)) => {
                self.end_frame(frame, &end)?;
                return Ok(true);
            }
            (Order::Aim { .. } | Order::End(_), None) => {}
        }
        Ok(false)
    }

    /// The views of the eyes at a time. None while the head is not tracked.
    fn views(&self, display: xr::Time) -> Result<Option<[RoomView; 2]>> {
        let (flags, views) = self
            .session
            .locate_views(VIEWS, display, &self.room)
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

    fn end_frame(&mut self, frame: &Frame, end: &End) -> Result<()> {
        if end.layers.views.is_some() {
            self.colour.release()?;
            if let Some(depth) = &mut self.depth {
                depth.release()?;
            }
        }
        if end.board_filled {
            self.board.release()?;
            self.board_filled = true;
        }
        let views = end.layers.views.as_ref().map_or(&[][..], |views| views);
        // Depth is reversed, with its far plane at infinity.
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
        let board = end.layers.board.as_ref().filter(|_| self.board_filled).map(|board| {
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
        self.stream.end(frame.display, end.blend, &shown).doing("end a frame")
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
