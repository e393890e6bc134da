//! Owns what each action and request leads to: commands for the session, another view, another
//! tool, a window that opens.

use glam::{UVec3, Vec2, Vec3};

use super::aim::{lasting, voxel_at};
use super::job::Then;
use super::stroke::Guide;
use super::workspace::Workspace;
use crate::command::{Area, Command};
use crate::input::{Action, Side};
use crate::render::RenderMode;
use crate::sculpture::Placement;
use crate::tools::spray::SprayKind;
use crate::tools::symmetry::Parity;
use crate::ui::files::FileTask;
use crate::ui::state::{Next, Repeat};
use crate::ui::{Tool, UiRequest, sprays};
use crate::view::StereoLayout;

/// Factor on the tool's size for one press of a key.
const GROWTH: f32 = 1.15;
/// Factor on the tool's size for one notch of the wheel.
pub(super) const GROWTH_PER_NOTCH: f32 = 1.1;

/// Notches of the wheel for one press of a key that zooms.
const ZOOM_NOTCHES: f32 = 2.0;

impl Workspace {
    pub(super) fn carry_out(&mut self, request: UiRequest) {
        match request {
            UiRequest::Do(action) => self.act(action),
            UiRequest::Run(command) => self.run_unless_work_is_lost(command),
            UiRequest::Keys(change) => self.change_keys(change),
            UiRequest::Calibrate(step) => self.calibrate(step),
            UiRequest::StopWork => self.cancel_job(),
            // If something is being written, leaving waits for its success.
            UiRequest::Go(Next::Leave) if self.job.is_some() => self.leave_after_job(),
            UiRequest::Go(Next::Leave) => self.leave(),
            UiRequest::Go(Next::Run(command)) => self.run(command),
            UiRequest::SaveFirst(next) => self.save(Some(next)),
            UiRequest::SaveThen(command, next) => self.run_then(command, Then::Go(next)),
            UiRequest::Irreversibly(command) => self.run_irreversibly(command),
        }
    }

    /// Carries out an action that asks once.
    pub(super) fn act(&mut self, action: Action) {
        let dims = self.session.document().grid().dims();
        match action {
            Action::New => self.ui.new_dialog.open = true,
            Action::Open => self.ui.files.open(FileTask::Open, self.session.path()),
            Action::Save => self.save(None),
            Action::SaveAs => self.ui.files.open(FileTask::SaveAs(None), self.session.path()),
            Action::Export => self.ui.files.open(FileTask::Export, self.session.path()),
            Action::Quit if self.job.is_some() => self.leave_after_job(),
            Action::Quit if self.session.modified() => self.ui.unsaved = Some(Next::Leave),
            Action::Quit => self.leave(),
            Action::Palette => self.ui.palette.open(),
            Action::Help => self.ui.help_open = !self.ui.help_open,
            Action::Guide => self.ui.guide.open = !self.ui.guide.open,
            Action::Undo => self.run(Command::Undo { steps: Some(1) }),
            Action::Redo => self.run(Command::Redo { steps: Some(1) }),
            Action::Fill => self.run(Command::Fill { area: Area::Grid, colour: None }),
            Action::Clear => self.run(Command::Clear { area: Area::Grid }),
            Action::Cancel if self.job.is_some() => self.cancel_job(),
            Action::Cancel if self.stroke.is_some() => self.cancel_stroke(),
            Action::Cancel => {
                self.ui.close_top();
            }
            Action::Solid(solid) => {
                self.ui.hand.solid = solid;
                self.ui.hand.tool = Tool::Solid;
            }
            Action::Spray(kind) => self.ui.hand.tool = Tool::Spray(kind),
            Action::Mode(mode) => {
                self.ui.hand.mode = mode;
                self.ui.hand.tool = Tool::Solid;
            }
            Action::Grow => self.resize(1.0, GROWTH),
            Action::Shrink => self.resize(-1.0, GROWTH),
            Action::ResetTool if self.ui.hand.tool == Tool::Marker => self.reset_marker(),
            Action::ResetTool => {
                self.ui.hand.reset_pose(dims);
                self.leave_ground();
            }
            Action::AlignTool => self.ui.hand.set_turn_deg(Vec3::ZERO),
            Action::Nudge(step) => {
                let by = self.grid_step(step);
                self.move_tool(by);
            }
            Action::Stretch(step) => {
                let side = self.grid_step(step);
                match self.ui.hand.tool {
                    Tool::Marker => self.stretch_marker(side),
                    Tool::Solid => {
                        self.ui.hand.stretch(side, 1.0);
                        self.leave_ground();
                    }
                    Tool::Spray(_) => {}
                }
            }
            Action::ToggleFollow => self.ui.hand.follow = !self.ui.hand.follow,
            Action::ToggleSnap => self.ui.hand.snap = !self.ui.hand.snap,
            Action::PickHere => self.pick_colour(),
            Action::Mirror(axis) => {
                let mut symmetry = self.session.document().symmetry();
                let parity = &mut symmetry.axes[axis.index()];
                *parity = if parity.is_some() { None } else { Some(Parity::Even) };
                self.execute(&Command::Symmetry(symmetry));
            }
            Action::Repeat => {
                let Repeat { count, step } = self.ui.repeat;
                self.run(Command::Array { count, step });
            }
            Action::Marker
            | Action::SelectMarker
            | Action::DeselectMarker
            | Action::DropBox
            | Action::ClearSelection
            | Action::ToggleLimit
            | Action::FillMarker
            | Action::ClearMarker
            | Action::DyeMarker
            | Action::Copy
            | Action::Cut
            | Action::Paste
            | Action::TurnClip(_)
            | Action::MirrorClip(_)
            | Action::MoveContents(_) => self.act_on_area(action),
            // On a table it stands upright.
            Action::ResetView if self.ar.is_on() => self.look_from(Side::Front),
            Action::ResetView => self.look_from(Side::Corner),
            Action::LookFrom(side) => self.look_from(side),
            Action::ZoomIn | Action::ZoomOut => {
                let notches = if action == Action::ZoomIn { ZOOM_NOTCHES } else { -ZOOM_NOTCHES };
                self.wheel(Action::Zoom, notches, self.turntable.middle());
            }
            Action::ToggleBounds => self.ui.view.bounds ^= true,
            Action::NextToolMode => self.ui.hand.mode = self.ui.hand.mode.next(),
            Action::NextPadMode => self.next_pad_mode(),
            Action::ToggleRumble => self.toggle_rumble(),
            Action::ToggleHead => self.toggle_head(),
            Action::CalibrateHead => self.begin_calibration(),
            Action::ToggleAr => self.toggle_ar(),
            Action::NextRenderMode => self.ui.view.choose_mode(next_mode(self.ui.view.mode)),
            Action::NextStereo => self.next_stereo(),
            Action::ToggleVideo => self.ui.view.video.on ^= true,
            Action::SwapEyes => self.ui.view.stereo.swap_eyes ^= true,
            Action::Lights => self.ui.light_open = !self.ui.light_open,
            Action::ToggleTheme => self.ui.theme = self.ui.theme.other(),
            Action::Fullscreen => self.ui.switch_fullscreen = true,
            Action::Screenshot => self.ui.screenshot = true,
            Action::Detach(panel) => self.ui.toggle_detached(panel),
            Action::ScaleUp => self.ui.scale.change_by(1.0),
            Action::ScaleDown => self.ui.scale.change_by(-1.0),
            Action::ScaleReset => self.ui.scale.reset(),
            // These are held or dragged and come by `begin`.
            Action::Apply
            | Action::Sculpt
            | Action::SculptInverse
            | Action::SculptSmooth
            | Action::PickColour
            | Action::TurnSculpture
            | Action::PanSculpture
            | Action::MoveTool
            | Action::MoveToolDeep
            | Action::TurnTool
            | Action::Zoom
            | Action::ResizeTool => {}
        }
    }

    /// A drag or a hold begins.
    pub(super) fn begin(&mut self, action: Action, at: Option<Vec2>) {
        let inverse = action == Action::SculptInverse;
        match (action, at) {
            (Action::Apply | Action::Sculpt, _) if std::mem::take(&mut self.ui.hand.eyedropper) => {
                self.pick_colour();
            }
            (Action::Apply, _) => self.apply_tool(),
            (Action::PickColour, _) => self.pick_colour(),
            (Action::Sculpt | Action::SculptInverse, Some(at))
                if self.ui.hand.tool == Tool::Marker =>
            {
                self.turns_instead = !self.begin_marker(at, inverse);
            }
            (Action::Sculpt | Action::SculptInverse | Action::SculptSmooth, Some(at)) => {
                let target = self.target(at);
                self.turns_instead = target.is_none();
                let Some(point) = target else { return };
                let hand = &self.ui.hand;
                if let Some(kind) = spray_for(action, hand.tool) {
                    let mut options = *hand.sprays.of(kind);
                    if let Some(held) = hand.spray() {
                        // It works where the tool in hand shows its outline.
                        options.radius_px = hand.sprays.of(held).radius_px;
                        options.outline = hand.sprays.of(held).outline;
                    }
                    self.begin_spray(kind, options, at);
                    return;
                }
                let mode = if inverse { hand.mode.inverted() } else { hand.mode };
                if hand.follow {
                    let depth = self.sight().depth(point);
                    self.lead_tool_to(at, point);
                    let grid = self.session.document().grid();
                    let seen = self.seen.as_ref().map(|map| lasting(map, grid));
                    let lift = self.ui.hand.centre_vx - point;
                    let lift = if self.ui.hand.stand { lift } else { Vec3::ZERO };
                    self.begin_stroke(mode, Guide::Surface { seen, at, depth, lift });
                } else {
                    self.begin_stroke(mode, Guide::Tool);
                }
            }
            _ => {}
        }
    }

    /// Uses the tool where it is, by key, button or pad.
    fn apply_tool(&mut self) {
        match self.ui.hand.tool {
            Tool::Solid => self.begin_stroke(self.ui.hand.mode, Guide::Tool),
            Tool::Marker => self.act(Action::SelectMarker),
            Tool::Spray(kind) => {
                let tool = || self.sight().pixel_of(self.ui.hand.centre_vx);
                if let Some(at) = self.pointer.or_else(tool) {
                    self.begin_spray(kind, *self.ui.hand.sprays.of(kind), at);
                }
            }
        }
    }

    /// A drag goes on.
    pub(super) fn drag(&mut self, action: Action, at: Vec2, by: Vec2) {
        let placement = *self.session.document().placement();
        match action {
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth
                if self.view_watch.is_lifted() => {}
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth if self.turns_instead => {
                self.place(self.turntable.turned(&placement, by, self.ui.view.up));
            }
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth => match &self.stroke {
                _ if self.marker_drag.is_some() => self.drag_marker(at),
                Some(stroke) if stroke.is_spray() => self.lead_spray(at),
                Some(stroke) if stroke.follows_surface() => self.lead_stroke(at),
                _ => self.drag_tool(by, false),
            },
            Action::PickColour => self.pick_colour(),
            Action::TurnSculpture => {
                self.place(self.turntable.turned(&placement, by, self.ui.view.up));
            }
            Action::PanSculpture => self.place(self.turntable.shifted(&placement, by)),
            Action::MoveTool | Action::MoveToolDeep if self.ui.hand.spray().is_some() => {
                self.lead_spray(at);
            }
            Action::MoveTool => self.drag_tool(by, false),
            Action::MoveToolDeep => self.drag_tool(by, true),
            Action::TurnTool => {
                let world_turn = self.turntable.turn_of(by);
                let grid_turn = placement.rotation.inverse() * world_turn * placement.rotation;
                self.ui.hand.turn_by(grid_turn);
            }
            _ => {}
        }
    }

    /// A drag or a hold is over.
    pub(super) fn end(&mut self, action: Action) {
        match action {
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth | Action::Apply => {
                self.turns_instead = false;
                self.view_watch.release();
                self.marker_drag = None;
                self.end_stroke();
            }
            _ => {}
        }
    }

    /// Takes the colour of the voxel that the pointer points at.
    fn pick_colour(&mut self) {
        if let Some(voxel) = self.pointed() {
            self.take_colour_of(voxel);
        }
    }

    pub(super) fn take_colour_of(&mut self, voxel: UVec3) {
        let colour = self.session.document().contents().rgb(voxel);
        if std::mem::replace(&mut self.ui.hand.colour, colour) != colour {
            tracing::debug!("colour {colour} taken");
        }
    }

    /// The voxel that the pointer points at.
    pub(super) fn pointed(&self) -> Option<UVec3> {
        let grid = self.session.document().grid();
        let (at, map) = self.pointer.zip(self.seen.as_ref())?;
        Some(grid.voxel_coords(voxel_at(map, grid, at)?))
    }

    /// Makes the tool larger (`notches` above 0) or smaller, by `factor` a notch.
    pub(super) fn resize(&mut self, notches: f32, factor: f32) {
        let factor = factor.powf(notches.clamp(-20.0, 20.0));
        match self.ui.hand.tool {
            Tool::Solid => self.ui.hand.scale_by(factor),
            Tool::Spray(kind) => self.ui.hand.sprays.of_mut(kind).scale_radius(factor),
            Tool::Marker => self.scale_marker(notches),
        }
    }

    pub(super) fn wheel(&mut self, action: Action, notches: f32, at: Vec2) {
        match action {
            Action::Zoom if self.ar.is_on() => self.ar.zoom(notches),
            Action::Zoom => {
                let placement = *self.session.document().placement();
                let placement = self.turntable.zoomed(&placement, notches, at);
                self.place(placement);
            }
            Action::ResizeTool => self.resize(notches, GROWTH_PER_NOTCH),
            _ => {}
        }
    }

    /// Shows all of the grid from a side.
    pub(super) fn look_from(&mut self, side: Side) {
        let document = self.session.document();
        let placement = self.turntable.looking_from(side, self.ui.view.up, document.placement());
        self.turntable.show_all(document.grid(), &placement);
        self.place(placement);
    }

    fn move_tool(&mut self, by: Vec3) {
        if self.ui.hand.tool == Tool::Marker {
            self.shift_marker(by);
            return;
        }
        let to = self.ui.hand.centre_vx + by;
        self.ui.hand.centre_vx = to;
        self.leave_ground();
        self.tool_moved();
    }

    /// Moves the tool along the axes of the grid that lie across the screen and up it, or across
    /// and into it.
    pub(super) fn drag_tool(&mut self, by: Vec2, deep: bool) {
        let sight = self.sight();
        let axes = sight.screen_axes();
        let at = match self.ui.hand.tool {
            Tool::Marker => {
                let marker = self.session.document().selection().marker();
                (marker.min.as_vec3() + marker.max.as_vec3()) * 0.5
            }
            Tool::Solid | Tool::Spray(_) => self.ui.hand.centre_vx,
        };
        let second = if deep { -axes.near } else { axes.up };
        let across = axes.right * sight.along(axes.right, by.x, at);
        self.move_tool(across + second * sight.along(second, -by.y, at));
    }

    pub(super) fn place(&mut self, placement: Placement) {
        self.execute(&Command::Place(placement));
    }

    /// Another sculpture is there: tool and view begin anew.
    pub(super) fn sculpture_replaced(&mut self) {
        self.seen = None;
        self.ui.hand.reset_pose(self.session.document().grid().dims());
        self.leave_ground();
        self.look_from(Side::Corner);
    }
}

/// The spray that an action uses with a tool in hand, if it uses one.
fn spray_for(action: Action, tool: Tool) -> Option<SprayKind> {
    match (action, tool) {
        (Action::SculptSmooth, _) => Some(SprayKind::Smooth),
        (Action::SculptInverse, Tool::Spray(kind)) => Some(sprays::opposite(kind)),
        (_, Tool::Spray(kind)) => Some(kind),
        _ => None,
    }
}

impl Workspace {
    /// The next way to show two eyes that this window has.
    fn next_stereo(&mut self) {
        let layout = &mut self.ui.view.stereo.layout;
        let at = StereoLayout::ALL.iter().position(|l| l == layout).unwrap_or(0);
        let mut following = (1..).map(|i| StereoLayout::ALL[(at + i) % StereoLayout::ALL.len()]);
        let has = |l: &StereoLayout| *l != StereoLayout::Layers || self.quad_buffered;
        *layout = following.find(has).unwrap_or_default();
    }
}

fn next_mode(mode: RenderMode) -> RenderMode {
    let at = RenderMode::ALL.iter().position(|m| *m == mode).unwrap_or(0);
    RenderMode::ALL[(at + 1) % RenderMode::ALL.len()]
}
