//! Owns being in a headset: the session with all that draws to it, where the sculpture stands in
//! the room, what the hands hold.

use std::sync::Arc;
use std::time::Duration;

use ash::vk;
use glam::{UVec3, Vec3};

use super::overlay::overlay;
use super::pane::BoardPane;
use super::shots::Shots;
use crate::app::painter::background;
use crate::app::workspace::Workspace;
use crate::gpu::ValidationLog;
use crate::input::hands::{Board, HandEvent, HandMapper, HandsState};
use crate::input::pad::rumble::Rumble;
use crate::render::renderer::FrameDesc;
use crate::render::{Background, Renderer, WarmUp};
use crate::screen::headset::{
    Blend, Connector, Frame, HeadsetError, HeadsetOptions, Layers, Link, LinkNews, LinkOptions,
    WornHead,
};
use crate::sculpture::ColourDepth;
use crate::ui::ViewState;
use crate::view::{Pose, Room, RoomView};

type Result<T> = std::result::Result<T, HeadsetError>;

/// Pictures are copied to the headset as they are.
const FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;
/// A runtime that says nothing for so long while it shows pictures hangs.
const SILENCE: Duration = Duration::from_secs(1);

/// A session in a headset. It ends first, then fields are dropped in this order: what draws before
/// its device.
pub struct Presence {
    renderer: Renderer,
    pane: BoardPane,
    link: Link,
    settings: HeadsetOptions,
    mapper: HandMapper,
    rumble: Rumble,
    /// When the hand was last let feel something, in seconds of the headset's clock.
    felt_s: Option<f64>,
    /// Voxels that tools had changed in all by then.
    felt_voxels: u64,
    board_open: bool,
    /// Where the world lies in the room, and for which size of a sculpture.
    room: Option<(Room, Extent)>,
    /// Everything is to come before the head again.
    recentring: bool,
    /// The sculpture stands as the person has left it, for an earlier session.
    stood: bool,
    showing: bool,
    /// The runtime has ceased to answer.
    silent: bool,
}

/// Voxels and edge lengths of a sculpture.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Extent {
    dims: UVec3,
    voxel_size: Vec3,
}

impl Extent {
    fn of(workspace: &Workspace) -> Extent {
        let grid = workspace.session().document().grid();
        Extent { dims: grid.dims(), voxel_size: grid.voxel_size() }
    }

    /// The longest side in world units.
    fn longest(&self) -> f32 {
        (self.dims.as_vec3() * self.voxel_size).max_element()
    }
}

impl Presence {
    /// Connects, which may take long. `stood`: the sculpture has stood in a headset before.
    /// `worn`: who is to hear of the head.
    pub fn new(
        connector: &mut Connector,
        settings: &HeadsetOptions,
        options: &LinkOptions,
        stood: bool,
        worn: Option<&WornHead>,
    ) -> Result<Presence> {
        let link = Link::connect(connector, options, worn)?;
        let device = link.device().clone();
        let points = settings.board_pixels_per_point();
        Ok(Presence {
            renderer: Renderer::new(&device, FORMAT)?,
            pane: BoardPane::new(&device, options.board_px, points)?,
            link,
            settings: settings.clone(),
            mapper: HandMapper::new(settings.hands()),
            rumble: Rumble::default(),
            felt_s: None,
            felt_voxels: 0,
            board_open: false,
            room: None,
            recentring: false,
            stood,
            showing: false,
            silent: false,
        })
    }

    /// Has all that the first picture of `view` needs created, which may take long; before
    /// [`Presence::start`], while nobody else uses the device.
    pub fn warm_up(&mut self, mut view: ViewState, depth: ColourDepth) -> Result<()> {
        view.suit_device(self.is_software());
        let of = WarmUp { mode: view.mode, lighting: view.lighting(), depth };
        Ok(self.renderer.warm_up(&of)?)
    }

    pub fn name(&self) -> &str {
        self.link.name()
    }

    /// Whether its device is a software renderer.
    pub fn is_software(&self) -> bool {
        self.link.device().is_software()
    }

    /// Ways in which pictures can go together with the surroundings.
    pub fn blends(&self) -> Vec<Blend> {
        self.link.blends()
    }

    pub fn is_showing(&self) -> bool {
        self.showing
    }

    pub fn validation_log(&self) -> Arc<ValidationLog> {
        self.link.device().validation_log().clone()
    }

    /// Begins to hear the runtime ([`Link::start`]).
    pub fn start(&mut self, tell: impl Fn(LinkNews) -> bool + Send + 'static) -> Result<()> {
        self.link.start(tell)
    }

    /// Notes if the runtime has ceased to answer: true once each time.
    pub fn falls_silent(&mut self, workspace: &mut Workspace) -> bool {
        let silent = self.showing && self.link.silence() >= SILENCE;
        if silent {
            self.showing = false;
            self.silent = true;
            self.let_go(workspace);
        }
        silent
    }

    /// The room is another: the sculpture comes before the head again.
    pub fn recentre(&mut self) {
        self.recentring = true;
    }

    /// Whether the sculpture stands in the room.
    pub fn has_stood(&self) -> bool {
        self.stood
    }

    /// What hands hold is let go.
    pub fn let_go(&mut self, workspace: &mut Workspace) {
        let mut events = Vec::new();
        self.mapper.let_go(&mut events);
        self.obey(workspace, &events);
        workspace.editor.hand.put_down();
    }

    /// One frame: hear the hands and do what they ask for, let them feel it, bring the board up to
    /// date, and at last look where the eyes are and draw what they see.
    pub fn frame(
        &mut self,
        workspace: &mut Workspace,
        frame: &Frame,
        shots: &mut Option<Shots>,
        now_s: f64,
    ) -> Result<()> {
        self.link.hear();
        if std::mem::take(&mut self.silent) {
            tracing::info!("the headset answers again");
        }
        self.showing = frame.shown;
        if !self.make(workspace, frame, shots, now_s)? {
            self.link.end_empty();
        }
        Ok(())
    }

    /// False if there is nothing to be seen.
    fn make(
        &mut self,
        workspace: &mut Workspace,
        frame: &Frame,
        shots: &mut Option<Shots>,
        now_s: f64,
    ) -> Result<bool> {
        if !frame.shown {
            self.let_go(workspace);
            return Ok(false);
        }
        self.link.set_blend(workspace.ui.headset.blend);
        let Some(views) = frame.views else { return Ok(false) };
        self.stand(workspace, &head(&views));
        self.swap_hands(workspace);
        let hands = frame.hands.as_ref();
        match hands {
            Some(hands) => self.hear(workspace, hands),
            None => self.let_go(workspace),
        }
        self.feel(workspace, frame);
        let board = self.board(workspace, hands);
        let due = board.is_some() && self.pane.is_due(now_s);
        let ray = self.ray(hands, board.as_ref());

        // As late as can be: the eyes have moved meanwhile.
        let Some(aimed) = self.link.aim(due) else { return Ok(false) };
        let (views, Some((room, _))) = (aimed.views, self.room) else { return Ok(false) };
        let mut pass = due.then(|| self.pane.pass(workspace, now_s));
        let (mut recorder, slot) = self.link.record()?;
        self.draw(workspace, &mut recorder, slot, &room, &views, ray)?;
        if let Some(pictures) = self.renderer.pictures() {
            self.link.show(&mut recorder, &aimed, &pictures.colour, &mut pictures.depth)?;
        }
        if let Some(pass) = &mut pass {
            let picture = self.pane.draw(&mut recorder, slot, pass)?;
            if let Some(lack) = self.pane.take_lack() {
                workspace.ui.toasts.error(lack.to_string());
            }
            self.link.show_board(&mut recorder, &aimed, picture)?;
        }
        self.link.submit(recorder)?;
        if let Some(pass) = &mut pass {
            self.pane.submitted(pass);
        }
        if let Some(shots) = shots.as_mut().filter(|shots| shots.is_due(now_s)) {
            // Before the frame ends: the queue is the runtime's, too, from then on.
            self.shoot(shots, now_s, &views, &room, board.is_some())?;
        }
        self.link.end(Layers { views: Some(views), board }, pass.is_some());
        tracing::trace!("frame shown");
        Ok(true)
    }

    /// Puts the sculpture before the head, if it does not stand in the room yet, is another, or is
    /// called for.
    fn stand(&mut self, workspace: &mut Workspace, head: &Pose) {
        let extent = Extent::of(workspace);
        let another = self.room.is_some_and(|(_, former)| former != extent);
        if self.room.is_some() && !another && !self.recentring {
            return;
        }
        let HeadsetOptions { size_m, distance_m, drop_m, .. } = self.settings;
        let room = Room::before(head, distance_m, drop_m, size_m / extent.longest());
        self.room = Some((room, extent));
        if another || !std::mem::replace(&mut self.stood, true) {
            workspace.stand_upright();
        } else if self.recentring {
            workspace.bring_back();
        }
        self.recentring = false;
    }

    fn hear(&mut self, workspace: &mut Workspace, hands: &HandsState) {
        let board = self.board(workspace, Some(hands));
        let events = self.mapper.hear(hands, board.as_ref());
        self.obey(workspace, &events);
    }

    /// The tool goes to the hand that the person has chosen.
    fn swap_hands(&mut self, workspace: &mut Workspace) {
        let mut events = Vec::new();
        self.mapper.set_main(workspace.ui.headset.hand_side, &mut events);
        self.obey(workspace, &events);
    }

    fn obey(&mut self, workspace: &mut Workspace, events: &[HandEvent]) {
        for event in events {
            match event {
                HandEvent::ToggleBoard => {
                    self.board_open = !self.board_open;
                    tracing::debug!("board {}", if self.board_open { "open" } else { "closed" });
                }
                HandEvent::Recentre => self.recentre(),
                _ => {}
            }
            self.pane.hear(event);
            if let Some((room, _)) = &self.room {
                workspace.answer_hand(event, room);
            }
        }
    }

    /// Lets the main hand feel what the tool has bitten off.
    fn feel(&mut self, workspace: &mut Workspace, frame: &Frame) {
        let now_s = frame.seconds();
        let dt_s = self.felt_s.replace(now_s).map_or(0.0, |felt| (now_s - felt).clamp(0.0, 1.0));
        let total = workspace.editor.voxels_changed();
        let changed = total.saturating_sub(std::mem::replace(&mut self.felt_voxels, total));
        let felt = self.settings.haptics && workspace.editor.hand.is_working();
        let before = self.rumble.is_shaking();
        let curve = self.settings.haptics_curve();
        let strength = self.rumble.step(felt.then_some(changed), dt_s as f32, &curve);
        if before || strength > 0.0 {
            self.link.feel(self.mapper.settings().main, strength);
        }
    }

    /// The board on the off hand, while it is open; what asks for an answer opens it.
    fn board(&self, workspace: &Workspace, hands: Option<&HandsState>) -> Option<Board> {
        let hand = hands?.hand(self.mapper.settings().main.other());
        let grip = hand.grip.filter(|_| self.board_open || workspace.ui.dialogs.is_modal())?;
        // Grips are tilted differently on every controller; rays are not.
        let rotation = hand.aim.map_or(grip.rotation, |aim| aim.rotation);
        let pose = Pose { rotation, ..grip };
        Some(Board::on_hand(&pose, self.settings.board_size_m()))
    }

    /// From the main hand to where it points at the board.
    fn ray(&self, hands: Option<&HandsState>, board: Option<&Board>) -> Option<[Vec3; 2]> {
        let aim = hands?.hand(self.mapper.settings().main).aim?;
        let hit = board?.hit(&aim)?;
        Some([aim.position, hit.point])
    }

    fn draw(
        &mut self,
        workspace: &mut Workspace,
        recorder: &mut crate::gpu::Recorder,
        slot: usize,
        room: &Room,
        views: &[RoomView; 2],
        ray: Option<[Vec3; 2]>,
    ) -> Result<()> {
        let size = self.link.eye_size();
        let eyes = views.map(|view| room.eye(&view, size));
        let through = self.link.sees_through();
        let (preview, lines) = overlay(workspace, room, ray, !through);
        let desc = FrameDesc {
            eyes: &eyes,
            world_from_grid: workspace.world_from_grid(),
            mode: workspace.ui.view.mode,
            lighting: workspace.ui.view.lighting(),
            background: if through {
                Background::Keep
            } else {
                background(workspace.ui.appearance.theme)
            },
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

    fn shoot(
        &mut self,
        shots: &mut Shots,
        now_s: f64,
        views: &[RoomView; 2],
        room: &Room,
        board: bool,
    ) -> Result<()> {
        let eyes = self.renderer.read_back()?;
        let board = if board { Some(self.pane.read_back()?) } else { None };
        if let Err(error) = shots.write(now_s, &eyes, board.as_ref(), views, room) {
            tracing::warn!("what the eyes see cannot be written: {error}");
        }
        Ok(())
    }
}

impl Drop for Presence {
    fn drop(&mut self) {
        self.link.part();
    }
}

/// The head is between the eyes and looks as they do on the average.
fn head(views: &[RoomView; 2]) -> Pose {
    let [left, right] = views.map(|view| view.pose);
    Pose {
        position: (left.position + right.position) * 0.5,
        rotation: left.rotation.slerp(right.rotation, 0.5),
    }
}
