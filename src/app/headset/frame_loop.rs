//! The frames of an XR session: controllers to commands, haptics, the board, and what the eyes see.
//!
//! Takes an [`XrFrame`] and the workspace; gives pictures to the session. The placement of the sculpture, the board,
//! the haptics and the health of the session each have a type of their own.

use std::sync::Arc;
use std::time::Duration;

use ash::vk;
use glam::Vec3;

use super::board_panel::{BoardPanel, ray_to_board};
use super::eye_screenshots::EyeScreenshots;
use super::haptics::HapticFeedback;
use super::health::SessionHealth;
use super::overlay::overlay;
use super::placement::{Extent, Reset, RoomPlacement};
use crate::app::painter::background;
use crate::app::workspace::Workspace;
use crate::gpu::{Recorder, ValidationLog};
use crate::input::hands::{HandEvent, HandMapper, HandsState};
use crate::render::SmoothSurface;
use crate::render::renderer::FrameDesc;
use crate::render::{Background, Renderer, WarmUp};
use crate::screen::headset::{
    BlendMode, Connector, FrameLayers, HeadsetError, HeadsetOptions, SessionHead, XrEvent, XrFrame,
    XrSession, XrSessionOptions,
};
use crate::sculpture::ColourDepth;
use crate::ui::ViewState;
use crate::view::{Room, RoomPose, RoomView};

type Result<T> = std::result::Result<T, HeadsetError>;

/// Pictures are copied to the headset without conversion.
const FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// Longest time that the normals of an opened sculpture may delay a picture.
const PATIENCE: Duration = Duration::from_millis(2);

/// The eyes of a person, and the placement of the world in the room around.
struct EyesInRoom {
    room: Room,
    views: [RoomView; 2],
}

/// An XR session and its renderers. The session ends first, then fields are dropped in this order: renderers before
/// their device.
pub struct XrFrameLoop {
    renderer: Renderer,
    board: BoardPanel,
    session: XrSession,
    mapper: HandMapper,
    haptics: HapticFeedback,
    placement: RoomPlacement,
    health: SessionHealth,
}

impl XrFrameLoop {
    /// Connects, which may take long. `placed`: an earlier session has placed the sculpture in a room. `head`: receives
    /// the poses of the head.
    pub fn connect(
        connector: &mut Connector,
        settings: &HeadsetOptions,
        options: &XrSessionOptions,
        placed: bool,
        head: Option<&SessionHead>,
    ) -> Result<XrFrameLoop> {
        let session = XrSession::connect(connector, options, head)?;
        let device = session.device().clone();
        let mut renderer = Renderer::new(&device, FORMAT)?;
        renderer.set_patience(Some(PATIENCE));
        Ok(XrFrameLoop {
            renderer,
            board: BoardPanel::new(&device, options.board_px, settings)?,
            session,
            mapper: HandMapper::new(settings.hands()),
            haptics: HapticFeedback::new(settings),
            placement: RoomPlacement::new(settings, placed),
            health: SessionHealth::default(),
        })
    }

    /// Creates everything that the first picture of `view` needs, which may take long. Called before
    /// [`XrFrameLoop::start`], while nothing else uses the device.
    pub fn warm_up(&mut self, mut view: ViewState, depth: ColourDepth) -> Result<()> {
        view.suit_device(self.is_software());
        let (mode, smooth_edges) = (view.mode, view.smooth_edges);
        let of = WarmUp { mode, lighting: view.lighting(), smooth_edges, depth };
        Ok(of.run(&mut self.renderer)?)
    }

    /// Returns the names of runtime and headset.
    pub fn name(&self) -> &str {
        self.session.name()
    }

    /// Returns whether its device is a software renderer.
    pub fn is_software(&self) -> bool {
        self.session.device().is_software()
    }

    /// Returns the available blend modes.
    pub fn blends(&self) -> Vec<BlendMode> {
        self.session.blends()
    }

    /// Returns whether pictures are visible in the headset.
    pub fn is_showing(&self) -> bool {
        self.health.is_showing()
    }

    pub fn validation_log(&self) -> Arc<ValidationLog> {
        self.session.device().validation_log().clone()
    }

    /// Starts the thread of the session ([`XrSession::start`]).
    pub fn start(&mut self, send: impl Fn(XrEvent) -> bool + Send + 'static) -> Result<()> {
        self.session.start(send)
    }

    /// Checks whether the runtime still answers. Returns true once each time it has stopped.
    pub fn becomes_unresponsive(&mut self, workspace: &mut Workspace) -> bool {
        let hangs = self.health.check(self.session.unresponsive_for());
        if hangs {
            self.release_hands(workspace);
        }
        hangs
    }

    /// Places the sculpture before the head again in the next frame.
    pub fn recentre(&mut self) {
        self.placement.recentre();
    }

    /// Returns whether the sculpture has been placed in the room.
    pub fn is_placed(&self) -> bool {
        self.placement.is_placed()
    }

    /// Ends what the hands are doing: strokes, carrying, presses on the board.
    pub fn release_hands(&mut self, workspace: &mut Workspace) {
        let mut events = Vec::new();
        self.mapper.release_all(&mut events);
        self.dispatch(workspace, &events);
        workspace.editor.hand.put_down();
    }

    /// Processes and ends a frame.
    pub fn frame(
        &mut self,
        workspace: &mut Workspace,
        frame: &XrFrame,
        screenshots: &mut Option<EyeScreenshots>,
        now_s: f64,
    ) -> Result<()> {
        self.session.note_response();
        if self.health.note_frame(frame.visible) {
            tracing::info!("the headset answers again");
        }
        if !self.process(workspace, frame, screenshots, now_s)? {
            self.session.end_empty_frame();
        }
        Ok(())
    }

    /// Handles the controllers, gives haptic feedback, updates the board, and last locates the eyes and renders for
    /// them. Returns false if there is nothing to show; the frame is not ended then.
    fn process(
        &mut self,
        workspace: &mut Workspace,
        frame: &XrFrame,
        screenshots: &mut Option<EyeScreenshots>,
        now_s: f64,
    ) -> Result<bool> {
        if !frame.visible {
            self.release_hands(workspace);
            return Ok(false);
        }
        self.session.set_blend(workspace.ui.headset.blend);
        let Some(views) = frame.views else { return Ok(false) };
        self.place_sculpture(workspace, &head_between(&views));
        self.set_main_hand(workspace);
        let hands = frame.hands.as_ref();
        match hands {
            Some(hands) => self.handle_controllers(workspace, hands),
            None => self.release_hands(workspace),
        }
        workspace.dwell_in_hand(now_s);
        self.give_feedback(workspace, frame);
        let main = self.mapper.settings().main;
        let board = self.board.quad(hands, main, workspace.ui.dialogs.is_modal());
        let ray = ray_to_board(hands, main, board.as_ref());
        // Messages appear at the board's place, without the board and its pointer.
        let says_only = board.is_none() && workspace.ui.toasts.texts().next().is_some();
        let board = if says_only { self.board.quad(hands, main, true) } else { board };
        let due = board.is_some() && self.board.pane.is_due(now_s);

        // As late as possible: the eyes have moved meanwhile.
        let Some(targets) = self.session.acquire_targets(due) else { return Ok(false) };
        let (views, Some(room)) = (targets.views, self.placement.room()) else { return Ok(false) };
        let mut pass = due.then(|| self.board.pane.pass(workspace, now_s, says_only));
        let (mut recorder, slot) = self.session.begin_recording()?;
        let eyes = EyesInRoom { room, views };
        self.draw(workspace, &mut recorder, slot, &eyes, ray)?;
        if let Some(pictures) = self.renderer.pictures() {
            let (colour, depth) = (&pictures.colour, &mut pictures.depth);
            self.session.copy_eyes(&mut recorder, &targets, colour, depth)?;
        }
        if let Some(pass) = &mut pass {
            let picture = self.board.pane.draw(&mut recorder, slot, pass)?;
            if let Some(lack) = self.board.pane.take_lack() {
                workspace.ui.toasts.error(lack.to_string());
            }
            self.session.copy_board(&mut recorder, &targets, picture)?;
        }
        self.session.submit(recorder)?;
        if let Some(pass) = &mut pass {
            self.board.pane.submitted(pass);
        }
        if let Some(screenshots) = screenshots.as_mut().filter(|s| s.is_due(now_s)) {
            // Before the frame ends, after which the runtime may use the queue.
            self.write_screenshot(screenshots, now_s, &eyes, board.is_some())?;
        }
        self.session.end_frame(FrameLayers { views: Some(views), board }, pass.is_some());
        tracing::trace!("frame shown");
        Ok(true)
    }

    /// Places the sculpture before the head when that is due.
    fn place_sculpture(&mut self, workspace: &mut Workspace, head: &RoomPose) {
        let grid = workspace.session().document().grid();
        let extent = Extent { dims: grid.dims(), voxel_size: grid.voxel_size() };
        match self.placement.update(extent, head) {
            Some(Reset::Upright) => workspace.stand_upright(),
            Some(Reset::Position) => workspace.bring_back(),
            None => {}
        }
    }

    fn handle_controllers(&mut self, workspace: &mut Workspace, hands: &HandsState) {
        let main = self.mapper.settings().main;
        let board = self.board.quad(Some(hands), main, workspace.ui.dialogs.is_modal());
        let events = self.mapper.update(hands, board.as_ref());
        self.dispatch(workspace, &events);
    }

    /// Gives the tool to the hand chosen in the panels.
    fn set_main_hand(&mut self, workspace: &mut Workspace) {
        let mut events = Vec::new();
        self.mapper.set_main(workspace.ui.headset.hand_side, &mut events);
        self.dispatch(workspace, &events);
    }

    /// Gives controller events to the board, the placement and the workspace.
    fn dispatch(&mut self, workspace: &mut Workspace, events: &[HandEvent]) {
        for event in events {
            if *event == HandEvent::Recentre {
                self.recentre();
            }
            self.board.handle(event);
            if let Some(room) = self.placement.room() {
                workspace.answer_hand(event, &room);
            }
        }
    }

    /// Vibrates the main hand according to the voxels that its tool has changed.
    fn give_feedback(&mut self, workspace: &mut Workspace, frame: &XrFrame) {
        let total_voxels = workspace.editor.voxels_changed();
        let working = workspace.editor.hand.is_working();
        let strength = self.haptics.step(frame.display_time_s(), total_voxels, working);
        if let Some(strength) = strength {
            self.session.vibrate(self.mapper.settings().main, strength);
        }
    }

    fn draw(
        &mut self,
        workspace: &mut Workspace,
        recorder: &mut Recorder,
        slot: usize,
        seen: &EyesInRoom,
        ray: Option<[Vec3; 2]>,
    ) -> Result<()> {
        let EyesInRoom { room, views } = seen;
        let size = self.session.eye_size();
        let eyes = views.map(|view| room.eye(&view, size));
        let see_through = self.session.is_see_through();
        let (preview, lines) = overlay(workspace, room, ray, !see_through);
        let desc = FrameDesc {
            eyes: &eyes,
            world_from_grid: workspace.world_from_grid(),
            mode: workspace.ui.view.mode,
            smooth_surface: SmoothSurface::on_screen(workspace.ui.view.smooth_surface),
            sample: 0,
            lighting: workspace.ui.view.lighting(),
            show_mask: workspace.ui.view.mask,
            background: match see_through {
                true => Background::Keep,
                false => background(workspace.ui.appearance.theme),
            },
            ground: None,
            smooth_edges: workspace.ui.view.smooth_edges,
            video: None,
            previews: preview.as_slice(),
            lines: &lines,
        };
        let document = workspace.session_mut().document_mut();
        let report =
            self.renderer.paint_with_fallback(recorder, slot, document, &desc, |_| true)?;
        workspace.take_fallbacks(&report.fallbacks);
        Ok(())
    }

    fn write_screenshot(
        &mut self,
        screenshots: &mut EyeScreenshots,
        now_s: f64,
        EyesInRoom { room, views }: &EyesInRoom,
        board: bool,
    ) -> Result<()> {
        let eyes = self.renderer.read_back()?;
        let board = if board { Some(self.board.pane.read_back()?) } else { None };
        if let Err(error) = screenshots.write(now_s, &eyes, board.as_ref(), views, room) {
            tracing::warn!("a screenshot of the eyes cannot be written: {error}");
        }
        Ok(())
    }
}

impl Drop for XrFrameLoop {
    fn drop(&mut self) {
        self.session.close();
    }
}

/// Returns the pose of the head: halfway between the eyes, with their mean orientation.
fn head_between(views: &[RoomView; 2]) -> RoomPose {
    let [left, right] = views.map(|view| view.pose);
    RoomPose {
        position: (left.position + right.position) * 0.5,
        rotation: left.rotation.slerp(right.rotation, 0.5),
    }
}
