//! Executes commands: calls the module that edits the target, and turns the changes into undo steps. Long commands run
//! in parts: they are checked here, computed elsewhere, and completed here.
//!
//! Takes a command; returns its effect. A refused command changes nothing.

use std::sync::Arc;

use glam::IVec3;

use super::edit_target::EditTarget;
use super::timeline::Direction;
use super::{
    Applied, CommandError, Document, areas, brush, canvas, clipboard, make_contents, mask, orient,
    plan_repair, repair, solids, strokes,
};
use crate::command::{Command, SelectOp};
use crate::resample::resampled;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::history::{Contents, StepChange, SurfaceKind};
use crate::sculpture::orientation::Orientation;
use crate::tools::brush::BrushUse;
use crate::tools::repair::{Repair, RepairPlan};

/// Counters of changes. A refused command and a trial restore them: copies elsewhere then stay current, and a replay of
/// the executed commands counts the same states.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChangeCounters {
    revision: u64,
    states: u64,
}

impl Document {
    /// Executes a command, whose coordinates are signed ones. On an error nothing has changed.
    pub fn apply(&mut self, command: &Command) -> Result<Applied, CommandError> {
        let growth = canvas::grow_for(self, command);
        let in_grid = command.translated(-self.target.origin());
        let done = self.apply_in_grid(&in_grid);
        if let Some(growth) = growth {
            canvas::settle_growth(self, growth, &done);
        }
        if done.is_ok() && command.is_tool_use() {
            self.strokes.note_use(command);
        }
        done
    }

    /// Executes a command in grid coordinates.
    fn apply_in_grid(&mut self, command: &Command) -> Result<Applied, CommandError> {
        match command {
            Command::New(new) => {
                self.require_no_stroke("new")?;
                let contents = make_contents(new, self.limits())?;
                self.replace(contents, "new").map(|()| Applied::default())
            }
            Command::Open { .. } | Command::Save { .. } | Command::Embed { .. } => {
                Err(CommandError::NotHere(command.verb()))
            }
            Command::Begin { label } => self.begin_stroke(label),
            Command::End => self.end_stroke(),
            Command::Cancel => self.cancel_stroke(),
            Command::Construct { op, primitive, to_vx } => self.use_tool(command, |document| {
                solids::construct(&mut document.target, *op, primitive, *to_vx)
            }),
            Command::DrawnSolid { op, drawn } => {
                self.use_tool(command, |document| solids::draw(&mut document.target, *op, drawn))
            }
            Command::Texture { primitive, picture } => self.use_tool(command, |document| {
                solids::texture(&mut document.target, primitive, &document.pictures, picture)
            }),
            Command::Brush(used) => self.use_tool(command, |document| document.brush(used)),
            Command::Paste { at, orientation } => {
                self.use_tool(command, |document| document.paste(*at, *orientation))
            }
            Command::Array { count, step } => self.array(*count, *step, command),
            Command::Fill { area, colour } => {
                self.edit(command, |target| areas::edit(target, *area, EditOp::Add(*colour)))
            }
            Command::Clear { area } => {
                self.edit(command, |target| areas::edit(target, *area, EditOp::Subtract))
            }
            Command::Dye { area, colour } => {
                self.edit(command, |target| areas::edit(target, *area, EditOp::Recolour(*colour)))
            }
            Command::Tint { area, tint } => {
                self.edit(command, |target| areas::tint(target, *area, tint))
            }
            Command::Flood { at, colour, tolerance } => {
                self.edit(command, |target| areas::flood(target, *at, *colour, *tolerance))
            }
            Command::Mask(change) => self.edit(command, |target| mask::change_mask(target, change)),
            Command::Copy => {
                self.clip = Some(Arc::new(clipboard::copied(&self.target)?));
                Ok(Applied::default())
            }
            Command::Cut => self.cut(command),
            Command::Move { by, orientation } => self.move_marked(*by, *orientation, command),
            Command::Mark(marker) => set(self.target.selection.set_marker(*marker)),
            Command::Select(op) => set(self.select(*op)),
            Command::Limit(on) => {
                self.target.selection.set_limits(*on);
                Ok(Applied::default())
            }
            Command::Irreversible(on) => {
                self.timeline.irreversible = *on;
                Ok(Applied::default())
            }
            Command::Symmetry(symmetry) => {
                set(symmetry.check().map(|()| self.target.symmetry = *symmetry))
            }
            Command::Place(placement) => {
                set(placement.check().map(|()| self.placement = *placement))
            }
            Command::Orient(orientation) => self.orient(*orientation, command),
            Command::Repair(repair) => {
                let plan = plan_repair(&self.target.contents, repair, self.limits(), &())?;
                self.put_repaired(&plan, repair, command)
            }
            Command::Canvas(change) => canvas::change_canvas(self, change, command),
            Command::Resample(to) => {
                self.require_can_resample()?;
                let contents = resampled(&self.target.contents, *to, self.limits(), &())?;
                self.put_resampled(contents, command)
            }
            Command::Surface(kind) => self.show_surface(*kind, command),
            Command::Undo { steps } => self.travel(Direction::Undo, *steps, None),
            Command::Redo { steps } => self.travel(Direction::Redo, *steps, None),
        }
    }

    /// Replaces the sculpture with a loaded one, as one undo step.
    pub fn replace(&mut self, contents: Contents, label: &str) -> Result<(), CommandError> {
        self.require_no_stroke("open")?;
        self.require_room_for_whole(label)?;
        let old = Box::new(self.target.swap_contents(contents));
        self.strokes.forget_last_uses();
        self.timeline.push_replacement(label.to_string(), old);
        Ok(())
    }

    /// Returns an error if a stroke is open. `verb`: of the refused command.
    pub fn require_no_stroke(&self, verb: &'static str) -> Result<(), CommandError> {
        if self.stroke_open() { Err(CommandError::StrokeOpen(verb)) } else { Ok(()) }
    }

    /// Returns an error if the history has no room for the whole sculpture and irreversible steps are not allowed.
    pub fn require_room_for_whole(&self, label: &str) -> Result<(), CommandError> {
        self.timeline.require_room(label, self.target.contents.kept_bytes())
    }

    fn begin_stroke(&mut self, label: &str) -> Result<Applied, CommandError> {
        self.require_no_stroke("begin")?;
        self.strokes.open(label.to_string());
        Ok(Applied::default())
    }

    fn end_stroke(&mut self) -> Result<Applied, CommandError> {
        let label = self.strokes.label().ok_or(CommandError::NoStroke("end"))?;
        self.timeline.require_room(label, self.target.recorded_bytes())?;
        let label = self.strokes.end();
        self.timeline.push_edits(label, self.target.finish_record());
        Ok(Applied::default())
    }

    fn cancel_stroke(&mut self) -> Result<Applied, CommandError> {
        if !self.stroke_open() {
            return Err(CommandError::NoStroke("cancel"));
        }
        self.strokes.cancel();
        self.take_back();
        Ok(Applied::default())
    }

    /// Reverts the recorded edits.
    pub(super) fn take_back(&mut self) {
        self.target.take_back();
        self.timeline.return_to_settled();
    }

    pub(super) fn counts(&self) -> ChangeCounters {
        ChangeCounters { revision: self.target.revision, states: self.timeline.states }
    }

    /// Restores the counters, as if the reverted edits had not been tried.
    pub(super) fn return_to(&mut self, counts: ChangeCounters) {
        let ChangeCounters { revision, states } = counts;
        (self.target.revision, self.timeline.states) = (revision, states);
    }

    /// Edits the target as a command specifies.
    fn edit(
        &mut self,
        command: &Command,
        work: impl FnOnce(&mut EditTarget) -> Result<EditStats, CommandError>,
    ) -> Result<Applied, CommandError> {
        let stats = work(&mut self.target)?;
        self.applied(stats, command)
    }

    /// Finishes edits: unless a stroke is open, they become a step. Reverts them if the history cannot keep that step.
    fn applied(&mut self, stats: EditStats, command: &Command) -> Result<Applied, CommandError> {
        let applied = Applied { stats, steps: 0 };
        if stats.bricks_changed == 0 {
            return Ok(applied);
        }
        let counts = self.counts();
        self.target.revision += 1;
        self.timeline.enter_new_state();
        if !self.stroke_open() {
            let label = command.label();
            if let Err(error) = self.timeline.require_room(&label, self.target.recorded_bytes()) {
                self.take_back();
                self.return_to(counts);
                return Err(error);
            }
            self.timeline.push_edits(label, self.target.finish_record());
        }
        Ok(applied)
    }

    /// Uses a tool once.
    fn use_tool(
        &mut self,
        command: &Command,
        work: impl FnOnce(&mut Document) -> Result<EditStats, CommandError>,
    ) -> Result<Applied, CommandError> {
        let stats = work(self)?;
        self.applied(stats, command)
    }

    fn brush(&mut self, used: &BrushUse) -> Result<EditStats, CommandError> {
        let Document { target, strokes, pictures, .. } = self;
        let stats = brush::use_brush(target, strokes, pictures, used)?;
        if used.replaces_stroke() {
            self.timeline.return_to_settled();
        }
        Ok(stats)
    }

    fn paste(&mut self, at: IVec3, orientation: Orientation) -> Result<EditStats, CommandError> {
        let clip = self.clip.as_deref().ok_or(CommandError::NothingToPaste)?;
        clipboard::paste(&mut self.target, clip, at, orientation)
    }

    /// Repeats the last operation, each time further on. All copies together become the last operation.
    fn array(
        &mut self,
        count: u32,
        step: IVec3,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.require_no_stroke("array")?;
        let uses = self.strokes.take_last_uses(count)?;
        let counts = self.counts();
        self.strokes.open(command.label());
        let mut stats = EditStats::default();
        let done = strokes::copies(&uses, count, step)
            .try_for_each(|copy| self.apply(&copy?).map(|applied| stats += applied.stats))
            .and_then(|()| self.apply(&Command::End));
        match done {
            Ok(_) => {
                self.strokes.join_last_uses(uses);
                Ok(Applied { stats, steps: 0 })
            }
            Err(error) => {
                self.apply(&Command::Cancel)?;
                self.return_to(counts);
                self.strokes.set_last_uses(uses);
                Err(error)
            }
        }
    }

    /// Cuts the marker's contents to the clipboard.
    fn cut(&mut self, command: &Command) -> Result<Applied, CommandError> {
        let (stats, clip) = clipboard::cut(&mut self.target)?;
        let applied = self.applied(stats, command)?;
        self.clip = Some(Arc::new(clip));
        Ok(applied)
    }

    /// Rotates the marker's contents about their centre and moves them, with the marker.
    fn move_marked(
        &mut self,
        by: IVec3,
        orientation: Orientation,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        let (before, origin) = (self.target.selection.marker(), self.target.origin());
        let stats = clipboard::move_marked(&mut self.target, by, orientation)?;
        let applied = self.applied(stats, command);
        if applied.is_err() {
            // A growth of the box for this move has been taken back.
            let before = before.shifted(origin - self.target.origin());
            self.target.selection.set_marker(before)?;
        }
        applied
    }

    fn select(&mut self, op: SelectOp) -> Result<(), CommandError> {
        let selection = &mut self.target.selection;
        match op {
            SelectOp::Add | SelectOp::Subtract => {
                let room = selection.push(op == SelectOp::Add);
                if room { Ok(()) } else { Err(CommandError::StackFull) }
            }
            SelectOp::Drop if !selection.drop_last() => Err(CommandError::NothingSelected),
            SelectOp::Drop => Ok(()),
            SelectOp::Clear => {
                selection.clear();
                Ok(())
            }
        }
    }

    /// Reorients the sculpture as one undo step. The identity is no step.
    fn orient(
        &mut self,
        orientation: Orientation,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.require_can_orient(orientation)?;
        if orientation != Orientation::UPRIGHT {
            self.lay(orientation, None, command)?;
        }
        Ok(Applied::default())
    }

    /// Returns an error if the sculpture cannot be reoriented: within a stroke, or if the history cannot keep the
    /// reverse step and irreversible steps are not allowed.
    pub fn require_can_orient(&self, orientation: Orientation) -> Result<(), CommandError> {
        self.require_no_stroke("orient")?;
        let bytes = orient::bytes_to_undo(&self.target.contents, orientation);
        self.timeline.require_room("orient", bytes)
    }

    /// Replaces the contents with their reoriented copy.
    pub fn put_oriented(
        &mut self,
        contents: Contents,
        orientation: Orientation,
        command: &Command,
    ) -> Result<(), CommandError> {
        self.require_can_orient(orientation)?;
        self.lay(orientation, Some(contents), command)
    }

    fn lay(
        &mut self,
        orientation: Orientation,
        computed: Option<Contents>,
        command: &Command,
    ) -> Result<(), CommandError> {
        let change = orient::lay(&mut self.target, orientation, computed)?;
        self.strokes.forget_last_uses();
        self.timeline.push_change(command.label(), change);
        Ok(())
    }

    /// Removes and adds the voxels of a plan made from the present contents. Thickened walls take the colours around
    /// them, filled cavities the base colour.
    pub fn put_repaired(
        &mut self,
        plan: &RepairPlan,
        repair: &Repair,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.edit(command, |target| repair::carry_out(target, plan, repair))
    }

    /// Returns an error if the sculpture cannot be resampled: within a stroke, or if the history cannot keep the former
    /// one and irreversible steps are not allowed.
    pub fn require_can_resample(&self) -> Result<(), CommandError> {
        self.require_no_stroke("resample")?;
        self.require_room_for_whole("resample")
    }

    /// Replaces the contents by the same ones in another resolution, as one undo step. The marker is reset.
    pub fn put_resampled(
        &mut self,
        contents: Contents,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.require_can_resample()?;
        let before = Box::new(self.target.swap_contents(contents));
        self.strokes.forget_last_uses();
        self.timeline.push_change(command.label(), StepChange::Whole(before));
        Ok(Applied::default())
    }

    /// Selects the kind of surface, as one undo step.
    fn show_surface(
        &mut self,
        kind: SurfaceKind,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.require_no_stroke(command.verb())?;
        if kind != self.target.contents.surface {
            let label = command.label();
            self.timeline.require_room(&label, 0)?;
            let change = StepChange::Surface(self.target.swap_surface(kind));
            self.timeline.push_change(label, change);
        }
        Ok(Applied::default())
    }

    /// Returns the part of an undo or redo that is executed in one go. It ends before a step for which the history
    /// keeps no values, so that the sculpture must be reoriented; such a step is a part of its own. Other commands are
    /// returned whole.
    pub fn first_step(&self, command: &Command) -> Command {
        self.timeline.first_step(command)
    }

    /// Returns the orientation that the next step of an undo or redo applies, if its contents must be computed. Returns
    /// an error where the command would.
    pub fn next_orientation(&self, command: &Command) -> Result<Option<Orientation>, CommandError> {
        let Some((0, step, orientation)) = self.timeline.next_computed(command) else {
            return Ok(None);
        };
        let verb = command.verb();
        self.require_no_stroke(verb)?;
        let bytes = orient::bytes_to_undo(&self.target.contents, orientation);
        self.timeline.require_room(&format!("{verb} {}", step.label), bytes)?;
        Ok(Some(orientation))
    }

    /// Executes the next step of an undo or redo with the contents computed for it.
    pub fn travel_oriented(
        &mut self,
        command: &Command,
        contents: Contents,
    ) -> Result<Applied, CommandError> {
        let direction = match command {
            Command::Redo { .. } => Direction::Redo,
            _ => Direction::Undo,
        };
        self.travel(direction, Some(1), Some(contents))
    }

    /// Moves along the history. `oriented`: the contents after the first step, if they were computed before.
    fn travel(
        &mut self,
        direction: Direction,
        steps: Option<u32>,
        mut oriented: Option<Contents>,
    ) -> Result<Applied, CommandError> {
        self.require_no_stroke(direction.verb())?;
        let mut done = 0;
        while steps.is_none_or(|limit| done < limit) {
            match self.timeline.go(direction, &mut self.target, oriented.take()) {
                Ok(true) => done += 1,
                Ok(false) => break,
                Err(error) if done == 0 => return Err(error),
                // Steps done so far stay done; the caller learns their number.
                Err(_) => break,
            }
        }
        self.strokes.forget_last_uses();
        Ok(Applied { stats: EditStats::default(), steps: done })
    }
}

/// Returns the effect of a command that sets how and where tools work, the placement, or what the history allows.
fn set<E: Into<CommandError>>(done: Result<(), E>) -> Result<Applied, CommandError> {
    done.map(|()| Applied::default()).map_err(Into::into)
}
