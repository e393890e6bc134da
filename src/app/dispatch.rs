//! The dispatcher: every request (an action, an action event, or a request of a panel, gamepad or hand) goes from here
//! to the editor, the viewpoint, the controls or the interface. The outcomes of an edit come back here.
//!
//! The parts do not know one another: each returns values, and only this file applies them.

use std::path::{Path, PathBuf};

use arboard::Clipboard;
use glam::{Quat, Vec2, Vec3};

use super::workspace::Workspace;
use super::{paste, references};
use crate::command::Command;
use crate::controls::pads::STEP_S;
use crate::editor::job::Then;
use crate::editor::questions::{InUse, Next};
use crate::editor::tool::ToolEdit;
use crate::editor::{Outcome, PointerUse};
use crate::input::hands::HandEvent;
use crate::input::pad::{Glide, PadEvent, PadMode};
use crate::input::pen::PenTouch;
use crate::input::{Action, ActionEvent, Side};
use crate::notice::Notice;
use crate::render::RenderMode;
use crate::sculpture::Placement;
use crate::ui::dialogs::FileTask;
use crate::ui::dialogs::files::folder_of;
use crate::ui::tasks::PasteAs;
use crate::ui::{ScreenshotTo, UiRequest};
use crate::view::{Room, StereoLayout};

/// Notches of the wheel for one press of a key that zooms.
const ZOOM_NOTCHES: f32 = 2.0;

impl Workspace {
    /// Executes the requests of panels in order. Reverts a stroke that is no longer wanted.
    pub(super) fn answer_requests(&mut self, requests: Vec<UiRequest>) {
        for request in requests {
            self.answer_request(request);
        }
        if self.ui.dialogs.unkept.is_none() {
            self.editor.drop_stroke_in_question();
            self.settle();
        }
    }

    fn answer_request(&mut self, request: UiRequest) {
        let editor = &mut self.editor;
        match request {
            UiRequest::Do(action) => self.act(action),
            UiRequest::Run(command) => editor.run_unless_work_is_lost(command),
            UiRequest::AddReference(path) => self.add_reference(path),
            UiRequest::Turn(angle) => {
                let (placement, up) = (*editor.document().placement(), self.ui.view.up);
                editor.place(self.viewpoint.turntable.turned_by(&placement, angle, up));
            }
            UiRequest::Tool(edit) => editor.edit_tool(edit),
            UiRequest::Keys(change) => {
                let notice = self.controls.change_keys(change);
                self.show_notices(notice);
            }
            UiRequest::UsePreset(preset) => {
                let notice = self.controls.use_preset(preset);
                self.show_notices(notice);
            }
            UiRequest::Calibrate(step) => {
                let notice = self.viewpoint.head.calibrate(step);
                self.show_notices(notice);
            }
            UiRequest::FinalPicture(wanted) => self.start_final_picture(&wanted),
            UiRequest::Film(wanted) => self.start_film(&wanted),
            UiRequest::Study(path, import) => self.start_study(path, import),
            UiRequest::PrintCheck(options) => self.start_print_check(options),
            UiRequest::StopWork => editor.cancel_job(),
            // If something is being written, leaving waits for its success.
            UiRequest::Go(Next::Leave) if editor.is_busy() => editor.leave_after_job(),
            UiRequest::Go(Next::Leave) => self.leaving = true,
            UiRequest::Go(Next::Run(command)) => editor.run(command),
            UiRequest::Go(Next::Recover(number)) => self.start_recovery(number),
            UiRequest::Recover(number) if editor.session().modified() => {
                self.ui.dialogs.unsaved = Some(Next::Recover(number));
            }
            UiRequest::Recover(number) => self.start_recovery(number),
            UiRequest::DiscardLeft(number) => self.discard_left(number),
            UiRequest::ListLeft => self.list_left(),
            UiRequest::SaveFirst(next) => editor.save(Some(next)),
            UiRequest::SaveThen(command, next) => editor.run_then(command, Then::Go(next)),
            UiRequest::Overwrite(file) => editor.overwrite(file),
            UiRequest::KeepReadOnly => editor.session_mut().keep_read_only(),
            UiRequest::BecomeCopy => editor.session_mut().become_copy(),
            UiRequest::Irreversibly(command) => editor.run_irreversibly(command),
        }
        self.settle();
    }

    /// Executes an action that is triggered once.
    pub fn act(&mut self, action: Action) {
        let path = self.editor.session().path();
        match action {
            Action::New => self.ui.dialogs.new.open = true,
            Action::Open => self.ui.dialogs.files.open(FileTask::Open, path),
            Action::Save => self.editor.save(None),
            Action::SaveAs => self.ui.dialogs.files.open(FileTask::SaveAs(None), path),
            Action::Export => self.ui.dialogs.files.open(FileTask::Export, path),
            Action::Quit => self.quit(),
            Action::Cancel if self.editor.is_busy() => self.editor.cancel_job(),
            Action::Cancel if self.editor.is_stroking() => self.editor.cancel_stroke(),
            Action::Cancel if self.editor.cancel_drawing() => {}
            Action::Cancel => {
                self.ui.dialogs.close_top();
            }
            // Without copied voxels, it is a picture from another program.
            Action::Paste if self.editor.document().clip().is_none() => {
                self.ui.window_tasks.paste = Some(PasteAs::Reference);
            }
            Action::Palette => self.ui.dialogs.palette.open(),
            Action::Help => self.ui.dialogs.keys.open = !self.ui.dialogs.keys.open,
            Action::Guide => self.ui.dialogs.guide.open = !self.ui.dialogs.guide.open,
            Action::References => self.ui.dialogs.references.open ^= true,
            Action::Lights => self.ui.dialogs.light.open = !self.ui.dialogs.light.open,
            Action::ToggleTheme => self.ui.appearance.theme = self.ui.appearance.theme.other(),
            Action::Fullscreen => self.ui.window_tasks.switch_fullscreen = true,
            Action::TogglePanels => self.toggle_panels(),
            Action::Screenshot => self.ui.window_tasks.screenshot = Some(ScreenshotTo::File),
            Action::CopyScreenshot => {
                self.ui.window_tasks.screenshot = Some(ScreenshotTo::Clipboard);
            }
            Action::FinalPicture => self.ui.dialogs.final_picture.open = true,
            Action::Film => self.ui.dialogs.film.open = true,
            Action::PrintCheck => self.toggle_print_check(),
            Action::Tints => self.ui.dialogs.tints.open ^= true,
            Action::Masks => self.ui.dialogs.masks.open ^= true,
            Action::Canvas => self.ui.dialogs.canvas.open ^= true,
            Action::Detach(panel) => self.ui.layout.toggle_detached(panel),
            Action::ScaleUp => self.ui.appearance.scale.change_by(1.0),
            Action::ScaleDown => self.ui.appearance.scale.change_by(-1.0),
            Action::ScaleReset => self.ui.appearance.scale.reset(),
            Action::ToggleRumble => {
                let on = self.controls.pads.toggle_rumble();
                self.ui.toasts.note(if on { "Rumble on" } else { "Rumble off" });
            }
            Action::NextPadMode => self.controls.pads.next_mode(),
            Action::ToggleBounds => self.ui.view.bounds ^= true,
            Action::ToggleMask => self.ui.view.mask ^= true,
            Action::ToggleOrthographic => self.ui.view.orthographic ^= true,
            Action::ToggleGizmo => self.ui.view.gizmo ^= true,
            Action::ToggleGround => self.ui.view.ground ^= true,
            Action::ToggleFloor => self.ui.view.floor ^= true,
            Action::ToggleVideo => self.ui.view.video.on ^= true,
            Action::SwapEyes => self.ui.view.stereo.swap_eyes ^= true,
            Action::NextRenderMode => self.ui.view.choose_mode(next_mode(self.ui.view.mode)),
            Action::NextStereo => self.next_stereo(),
            Action::ToggleHead if self.viewpoint.head.is_on() => self.viewpoint.head.stop(),
            Action::ToggleHead => self.start_head(),
            Action::CalibrateHead => {
                let notices = self.viewpoint.head.begin_calibration();
                self.show_notices(notices);
            }
            Action::ToggleAr if self.viewpoint.ar.is_on() => self.viewpoint.ar.stop(),
            Action::ToggleAr => self.start_ar(),
            // On a table, the sculpture stands upright.
            Action::ResetView if self.viewpoint.ar.is_on() => self.look_from(Side::Front),
            Action::ResetView => self.look_from(Side::Corner),
            Action::LookFrom(side) => self.look_from(side),
            Action::ZoomIn => self.zoom(ZOOM_NOTCHES, self.viewpoint.turntable.middle()),
            Action::ZoomOut => self.zoom(-ZOOM_NOTCHES, self.viewpoint.turntable.middle()),
            _ => {
                if matches!(action, Action::TurnUpright(_)) {
                    // After this turn, y points up.
                    self.ui.view.up = Vec3::Y;
                }
                let picker = self.picker();
                self.editor.act(action, &picker);
            }
        }
        self.settle();
    }

    /// Handles an event of a device.
    pub(super) fn answer_event(&mut self, event: &ActionEvent) {
        if self.editor.lead_by(event) {
            return self.settle();
        }
        match *event {
            ActionEvent::Tap(action) => return self.act(action),
            ActionEvent::Begin { action, at } => {
                self.editor.set_pointer(at.or(self.editor.pointer()));
                let picker = self.picker();
                self.editor.begin(action, at, &picker);
            }
            ActionEvent::Drag { action, at, by } => {
                self.editor.set_pointer(Some(at));
                self.drag(action, at, by);
            }
            ActionEvent::End(action) => self.editor.end(action),
            ActionEvent::Hover(at) => {
                self.editor.set_pointer(Some(at));
                let picker = self.picker();
                self.editor.hover(at, self.controls.tool_follows_pointer(), &picker);
            }
            ActionEvent::Wheel { action: Action::Zoom, notches, at } => self.zoom(notches, at),
            ActionEvent::Wheel { action: Action::ResizeTool, notches, .. } => {
                self.editor.resize_by_wheel(notches);
            }
            ActionEvent::Wheel { .. } => {}
            ActionEvent::Left => self.editor.set_pointer(None),
            ActionEvent::Touch(touch) => self.touched(touch),
        }
        self.settle();
    }

    /// Executes the requests that events have made so far.
    pub(super) fn catch_up(&mut self) {
        self.editor.catch_up();
        self.settle();
    }

    fn drag(&mut self, action: Action, at: Vec2, by: Vec2) {
        let action = self.editor.meant(action);
        let placement = *self.editor.document().placement();
        if action == Action::TurnTool {
            self.editor.turn_tool(self.viewpoint.turntable.turn_of(by));
        } else if let Some(to) = self.viewpoint.dragged(action, &placement, by, self.ui.view.up) {
            self.editor.place(to);
            if self.viewpoint.is_inside(self.editor.document()) {
                self.ui
                    .toasts
                    .note("The view is inside the sculpture: use the wheel to move out of it");
            }
        } else {
            let picker = self.picker();
            self.editor.drag(action, at, by, &picker);
        }
    }

    fn zoom(&mut self, notches: f32, at: Vec2) {
        if let Some(to) = self.viewpoint.zoomed(self.editor.document(), notches, at) {
            self.editor.place(to);
        }
    }

    /// Hides the panels of the main window and says how to bring them back, or shows them again.
    fn toggle_panels(&mut self) {
        self.ui.layout.hidden ^= true;
        if self.ui.layout.hidden {
            let table = self.controls.bindings();
            let keys = table.and_then(|table| table.shortcut(Action::TogglePanels));
            let keys = keys.map_or(String::new(), |keys| format!("{keys}, or "));
            self.ui.toasts.note(format!(
                "Panels are hidden; {keys}the pointer at the top of the window, brings them back"
            ));
        }
    }

    /// Leaves the program once long work has ended and unsaved changes are dealt with.
    fn quit(&mut self) {
        if self.editor.is_busy() {
            self.editor.leave_after_job();
        } else if self.editor.session().modified() {
            self.ui.dialogs.unsaved = Some(Next::Leave);
        } else {
            self.leaving = true;
        }
    }

    /// Shows all of the sculpture from a side.
    pub(super) fn look_from(&mut self, side: Side) {
        let to = self.viewpoint.look_from(side, self.ui.view.up, self.editor.document());
        self.editor.place(to);
    }

    /// Lets the view follow the head from now on, as the settings say.
    pub fn start_head(&mut self) {
        let notices = self.viewpoint.head.start();
        self.show_notices(notices);
    }

    /// Puts the sculpture on the printed marker from now on, upright.
    pub(super) fn start_ar(&mut self) {
        match self.viewpoint.ar.start() {
            Ok(()) => self.look_from(Side::Front),
            Err(error) => self.ui.toasts.error(format!(
                "The printed marker cannot be tracked: no thread can be started ({error})"
            )),
        }
    }

    /// Switches to the next stereo layout that this window supports.
    fn next_stereo(&mut self) {
        let layout = &mut self.ui.view.stereo.layout;
        let at = StereoLayout::ALL.iter().position(|l| l == layout).unwrap_or(0);
        let mut following = (1..).map(|i| StereoLayout::ALL[(at + i) % StereoLayout::ALL.len()]);
        let has = |l: &StereoLayout| *l != StereoLayout::Layers || self.display.quad_buffered;
        *layout = following.find(has).unwrap_or_default();
    }

    /// Polls trackers and the marker at `now_s` on the tracker's clock, and handles their buttons.
    pub fn track_at(&mut self, now_s: f64) {
        for event in self.viewpoint.head.update(now_s) {
            // They cannot answer a dialog.
            let busy = self.ui.dialogs.is_modal() || self.viewpoint.head.is_calibrating();
            if !busy || matches!(event, ActionEvent::End(_)) {
                self.answer_event(&event);
            }
        }
        self.catch_up();
        self.viewpoint.ar.update(now_s);
        if self.viewpoint.has_leapt(now_s) {
            self.editor.lift();
        }
        self.settle();
        for event in self.viewpoint.head.wheels(self.viewpoint.turntable.middle()) {
            if !self.ui.dialogs.is_modal() {
                self.answer_event(&event);
            }
        }
    }

    /// Handles the gamepads' events up to `now_s`. Returns the pointer events that they cause.
    pub fn play_pad(&mut self, now_s: f64, ctx: &egui::Context) -> Vec<egui::Event> {
        let mut pointer = Vec::new();
        let catching = self.ui.dialogs.keys.is_catching();
        let start = self.picture().center();
        for event in self.controls.take_pad_events(now_s) {
            // While a trigger is being assigned, a pressed button has no other effect.
            if catching && !matches!(event, PadEvent::Action(ActionEvent::End(_))) {
                continue;
            }
            match event {
                PadEvent::Glide(glide) if glide.mode == PadMode::OnlyMouse => {
                    pointer.push(self.controls.pads.move_pointer(&glide, ctx, start));
                }
                PadEvent::Glide(glide) if !self.ui.dialogs.is_modal() => {
                    glide.parts(STEP_S).for_each(|part| self.glide(&part));
                }
                PadEvent::Glide(_) => {}
                PadEvent::Action(event) => {
                    // A dialog is closed or answered with the pointer.
                    let meant =
                        matches!(event, ActionEvent::Tap(Action::Cancel) | ActionEvent::End(_));
                    if meant || !self.ui.dialogs.is_modal() {
                        self.answer_event(&event);
                    }
                }
                PadEvent::Press(down) => {
                    self.controls.pads.click(&[down], ctx, start, &mut pointer);
                }
                PadEvent::DoubleClick => {
                    self.controls.pads.click(&[true, false, true, false], ctx, start, &mut pointer);
                }
            }
        }
        pointer
    }

    /// Moves and rotates the tool or the sculpture by the sticks.
    fn glide(&mut self, glide: &Glide) {
        let settings = self.controls.pads.settings();
        let height = self.viewpoint.turntable.eye().size.y as f32;
        let pixels = glide.shift * settings.move_speed * height;
        // About axes of the screen, which are those of the world.
        let turn = glide.turn * settings.turn_speed_deg.to_radians();
        if glide.mode == PadMode::UseTool {
            let picker = self.picker();
            if turn != Vec3::ZERO {
                self.editor.turn_tool(Quat::from_scaled_axis(turn));
            }
            if pixels.truncate() != Vec2::ZERO {
                self.editor.drag_tool(Vec2::new(pixels.x, -pixels.y), false, &picker);
            }
            if pixels.z != 0.0 {
                self.editor.drag_tool(Vec2::new(0.0, pixels.z), true, &picker);
            }
        } else {
            let document = self.editor.document();
            let across = Vec2::new(pixels.x, -pixels.y);
            let mut to = self.viewpoint.turntable.shifted(document.placement(), across);
            to = self.viewpoint.brought_nearer(document, &to, pixels.z);
            to =
                self.viewpoint.turntable.turned_by(&to, Vec2::new(turn.y, turn.x), self.ui.view.up);
            let rotation = (Quat::from_rotation_z(turn.z) * to.rotation).normalize();
            self.editor.place(Placement { rotation, ..to });
        }
        self.settle();
    }

    /// Sets the pressure and tilt of a pen or a finger from here on.
    fn touched(&mut self, touch: Option<PenTouch>) {
        self.ui.pen.is_used |= touch.is_some();
        self.ui.pen.touch = touch;
        let curve = self.ui.pen.curve;
        let counted = |touch: PenTouch| PenTouch { pressure: curve.of(touch.pressure), ..touch };
        self.editor.set_touch(touch.map(counted));
    }

    /// Adds a reference picture on the side facing the viewer.
    pub(super) fn add_reference(&mut self, path: PathBuf) {
        let axes = self.picker().sight().axes_in_picture();
        references::add(&mut self.ui, path, self.editor.document().grid(), &axes);
    }

    /// Pastes the picture on the clipboard, if requested. Opens the clipboard if needed.
    pub fn paste_picture(&mut self, clipboard: &mut Option<Clipboard>) {
        if let Some(paste) = self.ui.window_tasks.paste.take() {
            self.use_pasted(paste::picture_file(clipboard), paste);
        }
    }

    /// Adds a pasted picture as a reference, or gives it to the tool. `file`: the picture's file, or why there is none.
    pub(super) fn use_pasted(&mut self, file: Result<PathBuf, String>, paste: PasteAs) {
        match (file, paste) {
            (Ok(path), PasteAs::Reference) => self.add_reference(path),
            (Ok(path), PasteAs::ToolPicture) => {
                self.editor.tool.edit(ToolEdit::Picture(Some(path)));
            }
            (Err(text), _) => self.ui.toasts.error(text),
        }
    }

    /// Records that a command has opened or saved a file.
    fn note_file(&mut self, command: &Command) {
        if let Command::Open { path, .. } | Command::Save { path, .. } = command {
            self.ui.known_files.recent.note(command);
            if let Some(folder) = folder_of(std::path::absolute(path).ok().as_deref()) {
                self.ui.dialogs.files.set_folder(folder);
            }
            self.remember();
        }
    }

    /// Handles an event of a hand in a headset.
    pub fn answer_hand(&mut self, event: &HandEvent, room: &Room) {
        let picker = self.picker();
        self.editor.hand_event(event, room, &picker);
        self.settle();
    }

    /// Puts the sculpture upright in the middle of the world.
    pub(super) fn stand_upright(&mut self) {
        let front = Side::Front;
        let turntable = &self.viewpoint.turntable;
        let to = turntable.looking_from(front, self.ui.view.up, &Placement::default());
        self.run_now(&Command::Place(to));
    }

    /// Brings the sculpture back to the middle of the world at its own size, keeping its rotation.
    pub(super) fn bring_back(&mut self) {
        let rotation = self.editor.document().placement().rotation;
        self.run_now(&Command::Place(Placement { rotation, ..Placement::default() }));
    }

    /// Executes a command that takes no time. Returns true if it was done.
    pub(super) fn run_now(&mut self, command: &Command) -> bool {
        let done = self.editor.execute(command);
        self.settle();
        done
    }

    /// Applies a changed tool anchor at once.
    pub(super) fn keep_anchor(&mut self) {
        let pointer_use = PointerUse {
            leads_tool: self.controls.tool_follows_pointer(),
            dragging: self.controls.is_dragging(),
        };
        let picker = self.picker();
        self.editor.keep_anchor(pointer_use, &picker);
        self.settle();
    }

    /// Handles the outcomes of edits until nothing is left to do.
    pub(super) fn settle(&mut self) {
        loop {
            let outcomes = self.editor.take_outcomes();
            if outcomes.is_empty() {
                break;
            }
            outcomes.into_iter().for_each(|outcome| self.react(outcome));
        }
        // A journal that could not be written is retried.
        self.session_mut().attend_journal();
        self.ask_about_holder();
        self.viewpoint.turntable.set_orthographic(self.ui.view.orthographic);
        self.ui.dialogs.busy = self.editor.busy();
        self.ui.dialogs.preview.take_if(|_| !self.editor.is_busy());
        self.ui.dialogs.calibration.open = self.viewpoint.head.is_calibrating();
    }

    /// Asks how to go on with the sculpture's file if another program has it open.
    fn ask_about_holder(&mut self) {
        let session = self.session_mut();
        let Some(holder) = session.take_foreign_holder() else { return };
        let Some(path) = session.path().map(Path::to_path_buf) else { return };
        tracing::warn!("{}: {holder} has it open", path.display());
        if !session.is_read_only() {
            self.ui.dialogs.in_use = Some(InUse { path, holder });
        }
    }

    fn react(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Replaced => {
                self.viewpoint.forget_pick_map();
                self.look_from(Side::Corner);
            }
            Outcome::Notice(notice) => self.show_notices([notice]),
            Outcome::Limited => {
                let table = self.controls.bindings();
                let keys = table.and_then(|table| table.shortcut(Action::ToggleLimit));
                let keys = keys.map_or(String::new(), |keys| format!(" ({keys})"));
                self.ui
                    .toasts
                    .note(format!("Nothing changed: tools are limited to the selection{keys}"));
            }
            Outcome::Unsaved(next) => self.ui.dialogs.unsaved = Some(next),
            Outcome::Unkept(unkept) => self.ui.dialogs.unkept = Some(unkept),
            Outcome::ChangedOnDisk(file) => self.ui.dialogs.changed_on_disk = Some(file),
            Outcome::NameNeeded(next) => {
                let path = self.editor.session().path();
                self.ui.dialogs.files.open(FileTask::SaveAs(next), path);
            }
            Outcome::FileUsed(command) => self.note_file(&command),
            Outcome::Leave => self.quit(),
            Outcome::Recover(number) => self.start_recovery(number),
        }
    }

    pub(super) fn show_notices(&mut self, notices: impl IntoIterator<Item = Notice>) {
        for notice in notices {
            match notice {
                Notice::Note(text) => self.ui.toasts.note(text),
                Notice::Error(text) => self.ui.toasts.error(text),
            }
        }
    }
}

fn next_mode(mode: RenderMode) -> RenderMode {
    let at = RenderMode::ALL.iter().position(|m| *m == mode).unwrap_or(0);
    RenderMode::ALL[(at + 1) % RenderMode::ALL.len()]
}
