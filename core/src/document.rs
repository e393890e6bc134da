//! A document: a sculpture being edited, with its contents, placement, selection, clipboard, history
//! and the changed bricks that subscribers have not drained yet. All of it changes only through
//! [`Document::apply`].
//!
//! Knows no files (`session` does), no Vulkan, no window, no clock.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Affine3A;

use crate::command::{Command, NewSculpture, SelectOp};
pub use crate::sculpture::Limits;
use crate::sculpture::brick_set::BrickSet;
use crate::sculpture::clip::Clip;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::history::{Change, Contents, History, State, Step, StepStore};
use crate::sculpture::record::BrickRecord;
use crate::sculpture::selection::Selection;
use crate::sculpture::stroke::StrokeRecorder;
use crate::sculpture::{Brick, ColourDepth, Grid, Material, Placement};
use crate::tools::symmetry::Symmetry;
use crate::tools::texture::Texture;

mod areas;
mod brush;
mod changes;
mod error;
mod mask;
mod orient;
mod own;
mod repair;
mod snapshot;
mod steps;
mod surface;
mod tools;
mod trial;

pub use changes::ChangeSubscriber;
use changes::Changes;
pub use error::CommandError;
pub use orient::orient_contents;
pub use repair::plan_repair;
pub use snapshot::DocumentSnapshot;
pub use tools::MAX_ARRAY;
pub use trial::Heeds;

/// The effect of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Applied {
    /// Voxels and bricks changed.
    pub stats: EditStats,
    /// Steps undone or redone.
    pub steps: u32,
}

/// A sculpture with its history.
#[derive(Debug)]
pub struct Document {
    /// Shared with a save in progress; an edit meanwhile is made on a copy ([`Document::own_contents`]).
    contents: Arc<Contents>,
    placement: Placement,
    history: History,
    /// Label of the open stroke.
    stroke: Option<String>,
    /// The grid before the open stroke's first spray that asked for it.
    stroke_surface: Option<Box<Grid>>,
    recorder: StrokeRecorder,
    selection: Selection,
    symmetry: Symmetry,
    /// The clipboard; it outlives the sculpture it was copied from.
    clip: Option<Arc<Clip>>,
    /// Pictures for solids, by the name that commands give them.
    pictures: HashMap<PathBuf, Arc<Texture>>,
    /// Uses of tools in the open stroke, and those of the last operation.
    uses: Vec<Command>,
    last_uses: Vec<Command>,
    dirty: BrickSet,
    changes: Changes,
    /// The subscriber of [`Document::drain_changes`].
    unnamed: ChangeSubscriber,
    /// Whether the whole sculpture has been replaced since changes were last published.
    all_dirty: bool,
    /// Rises with every change of voxels; a cheap "is my copy current?".
    revision: u64,
    /// The current state, and the one after the last step: within a stroke they differ.
    state: State,
    settled: State,
    /// Number of states identified so far.
    states: u64,
    /// Whether steps that the history cannot keep are allowed.
    irreversible: bool,
    limits: Limits,
}

impl Document {
    /// A document with a new sculpture and an empty history.
    pub fn new(new: &NewSculpture, limits: Limits) -> Result<Document, CommandError> {
        Ok(Document::from_contents(make_contents(new, &limits)?, limits))
    }

    /// A document with existing contents and an empty history.
    pub fn from_contents(contents: Contents, limits: Limits) -> Document {
        Document {
            recorder: StrokeRecorder::new(&contents.grid),
            dirty: BrickSet::new(contents.grid.brick_count()),
            changes: Changes::default(),
            unnamed: ChangeSubscriber::default(),
            selection: Selection::new(contents.grid.dims()),
            symmetry: Symmetry::default(),
            clip: None,
            pictures: HashMap::new(),
            uses: Vec::new(),
            last_uses: Vec::new(),
            contents: Arc::new(contents),
            placement: Placement::default(),
            history: History::new(limits.history_bytes),
            stroke: None,
            stroke_surface: None,
            all_dirty: true,
            revision: 0,
            state: State::default(),
            settled: State::default(),
            states: 0,
            irreversible: false,
            limits,
        }
    }

    /// The existence bits.
    pub fn grid(&self) -> &Grid {
        &self.contents.grid
    }

    /// The colours.
    pub fn material(&self) -> &Material {
        &self.contents.material
    }

    /// Bits and colours.
    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    /// A snapshot of the contents, for work on another thread.
    pub fn share_contents(&self) -> Arc<Contents> {
        self.contents.clone()
    }

    /// Where the sculpture stands in the world.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// The steps that can be undone and redone.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// Gives steps that memory has no room for to a store from now on, rather than drop them.
    pub fn use_step_store(&mut self, store: Arc<dyn StepStore>) {
        self.history.use_store(store);
    }

    /// Lets the undo and redo steps take up to what `limits` allow, if that is more than they may take now.
    pub fn raise_history_budget(&mut self, limits: &Limits) {
        let own = &mut self.limits;
        own.history_bytes = own.history_bytes.max(limits.history_bytes);
        own.history_disk_bytes = own.history_disk_bytes.max(limits.history_disk_bytes);
        self.history.raise_budget(limits.history_bytes);
    }

    /// The memory limits of the document.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Marker and selected boxes.
    pub fn selection(&self) -> &Selection {
        &self.selection
    }

    /// The mirror planes in use.
    pub fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    /// The clipboard.
    pub fn clip(&self) -> Option<&Clip> {
        self.clip.as_deref()
    }

    /// Whether `array` has an operation to repeat.
    pub fn can_repeat(&self) -> bool {
        !self.last_uses.is_empty()
    }

    /// The images that `array` needs.
    pub fn pictures_to_repeat(&self) -> impl Iterator<Item = &Path> {
        self.last_uses.iter().filter_map(Command::picture)
    }

    /// Whether an image of this name is loaded.
    pub fn has_picture(&self, name: &Path) -> bool {
        self.pictures.contains_key(name)
    }

    /// Drops all images, so that they are read again when they are next used.
    pub fn forget_pictures(&mut self) {
        self.pictures.clear();
    }

    /// Adds an image under the name that commands use for it.
    pub fn learn_picture(&mut self, name: &Path, picture: Texture) {
        self.pictures.insert(name.to_path_buf(), Arc::new(picture));
    }

    /// Whether a stroke has begun and not ended.
    pub fn stroke_open(&self) -> bool {
        self.stroke.is_some()
    }

    /// Rises with every change of voxels or colours.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Identifies the current state; undo and redo restore the identifier, too.
    pub fn state(&self) -> State {
        self.state
    }

    /// The map from grid coordinates (voxels) to world units.
    pub fn world_from_grid(&self) -> Affine3A {
        self.placement.world_from_grid(self.grid().dims(), self.grid().voxel_size())
    }

    /// Calls `f` with the contents and the bricks that changed since the last call, as rising linear
    /// indices. `None` means all bricks: the sculpture was replaced, perhaps by one of another size.
    pub fn drain_changes<T>(&mut self, f: impl FnOnce(&Contents, Option<&[u32]>) -> T) -> T {
        let unnamed = self.unnamed.clone();
        self.drain_changes_for(&unnamed, f)
    }

    /// [`Document::drain_changes`] for one of several subscribers, each with its own last call.
    pub fn drain_changes_for<T>(
        &mut self,
        subscriber: &ChangeSubscriber,
        f: impl FnOnce(&Contents, Option<&[u32]>) -> T,
    ) -> T {
        let bricks = self.contents.grid.brick_count();
        self.changes.publish(&mut self.dirty, std::mem::take(&mut self.all_dirty), bricks);
        f(&self.contents, self.changes.drain(subscriber, bricks))
    }

    /// Replaces the sculpture by a loaded one, as one undo step.
    pub fn replace(&mut self, contents: Contents, label: &str) -> Result<(), CommandError> {
        self.require_no_stroke("open")?;
        self.require_room_for_whole(label)?;
        self.own_contents()?;
        let old = Box::new(self.swap_contents(contents));
        let number = self.new_state();
        let state = std::mem::replace(&mut self.state, State { sculpture: number, number });
        self.settled = self.state;
        self.history.push(Step { label: label.to_string(), change: Change::Whole(old), state });
        Ok(())
    }

    /// Executes a command. On an error nothing has changed.
    pub fn apply(&mut self, command: &Command) -> Result<Applied, CommandError> {
        if command.class().edits_in_place() {
            self.own_contents()?;
        }
        match command {
            Command::New(new) => {
                self.require_no_stroke("new")?;
                let contents = make_contents(new, &self.limits)?;
                self.replace(contents, "new").map(|()| Applied::default())
            }
            Command::Open { .. } | Command::Save { .. } | Command::Embed { .. } => {
                Err(CommandError::NotHere(command.verb()))
            }
            Command::Begin { label } => self.begin_stroke(label),
            Command::End => self.end_stroke(),
            Command::Cancel => self.cancel_stroke(),
            Command::Construct { .. }
            | Command::DrawnSolid { .. }
            | Command::Texture { .. }
            | Command::Brush(_)
            | Command::Paste { .. } => self.use_tool(command),
            Command::Array { count, step } => self.array(*count, *step, command),
            Command::Fill { area, colour } => self.edit_area(*area, EditOp::Add(*colour), command),
            Command::Clear { area } => self.edit_area(*area, EditOp::Subtract, command),
            Command::Dye { area, colour } => {
                self.edit_area(*area, EditOp::Recolour(*colour), command)
            }
            Command::Tint { area, tint } => self.tint(*area, tint, command),
            Command::Flood { at, colour, tolerance } => {
                self.flood(*at, *colour, *tolerance, command)
            }
            Command::Mask(change) => self.change_mask(change, command),
            Command::Copy => self.copy().map(|()| Applied::default()),
            Command::Cut => self.cut(command),
            Command::Move { by, orientation } => self.move_marked(*by, *orientation, command),
            Command::Mark(marker) => {
                self.selection.set_marker(*marker)?;
                Ok(Applied::default())
            }
            Command::Select(op) => self.select(*op),
            Command::Limit(on) => {
                self.selection.set_limits(*on);
                Ok(Applied::default())
            }
            Command::Irreversible(on) => {
                self.irreversible = *on;
                Ok(Applied::default())
            }
            Command::Symmetry(symmetry) => {
                symmetry.check()?;
                self.symmetry = *symmetry;
                Ok(Applied::default())
            }
            Command::Orient(orientation) => self.orient(*orientation, command),
            Command::Repair(repair) => self.repair(repair, command),
            Command::Surface(kind) => self.show_surface(*kind, command),
            Command::Undo { steps } => {
                self.travel(*steps, "undo", |document| document.undo_step(None))
            }
            Command::Redo { steps } => {
                self.travel(*steps, "redo", |document| document.redo_step(None))
            }
            Command::Place(placement) => self.place(placement),
        }
    }

    fn begin_stroke(&mut self, label: &str) -> Result<Applied, CommandError> {
        self.require_no_stroke("begin")?;
        self.stroke = Some(label.to_string());
        Ok(Applied::default())
    }

    fn end_stroke(&mut self) -> Result<Applied, CommandError> {
        let label = self.stroke.as_ref().ok_or(CommandError::NoStroke("end"))?;
        self.require_room(label, self.recorder.bytes())?;
        let label = self.stroke.take().unwrap_or_default();
        self.stroke_surface = None;
        self.finish_stroke(label);
        self.remember_stroke();
        Ok(Applied::default())
    }

    fn cancel_stroke(&mut self) -> Result<Applied, CommandError> {
        if self.stroke.is_none() {
            return Err(CommandError::NoStroke("cancel"));
        }
        self.own_contents()?;
        self.stroke = None;
        self.stroke_surface = None;
        self.uses.clear();
        self.take_back();
        Ok(Applied::default())
    }

    fn place(&mut self, placement: &Placement) -> Result<Applied, CommandError> {
        placement.check()?;
        self.placement = *placement;
        Ok(Applied::default())
    }

    fn select(&mut self, op: SelectOp) -> Result<Applied, CommandError> {
        let done = match op {
            SelectOp::Add | SelectOp::Subtract => {
                let room = self.selection.push(op == SelectOp::Add);
                if room { Ok(()) } else { Err(CommandError::StackFull) }
            }
            SelectOp::Drop if !self.selection.drop_last() => Err(CommandError::NothingSelected),
            SelectOp::Drop => Ok(()),
            SelectOp::Clear => {
                self.selection.clear();
                Ok(())
            }
        };
        done.map(|()| Applied::default())
    }

    fn has_colour(&self) -> bool {
        self.material().depth() != ColourDepth::None
    }

    /// Finishes edits: unless a stroke is open, they become a step. They are reverted if the history
    /// cannot keep it.
    fn applied(&mut self, stats: EditStats, command: &Command) -> Result<Applied, CommandError> {
        let (revision, states) = (self.revision, self.states);
        if stats.bricks_changed > 0 {
            self.revision += 1;
            self.state.number = self.new_state();
        }
        if self.stroke.is_none() && stats.bricks_changed > 0 {
            let label = command.label();
            if let Err(error) = self.require_room(&label, self.recorder.bytes()) {
                self.take_back();
                // As if it had not been tried: a replay of the commands that were done counts the same states.
                (self.revision, self.states) = (revision, states);
                return Err(error);
            }
            self.finish_stroke(label);
        }
        Ok(Applied { stats, steps: 0 })
    }

    fn swap_bricks(&mut self, record: BrickRecord) -> BrickRecord {
        if record.is_empty() {
            return record;
        }
        self.revision += u64::from(!record.is_empty());
        record.swap(Arc::make_mut(&mut self.contents), &mut self.dirty)
    }

    /// Puts another sculpture in place of the present one, which must be the document's own; the marker begins anew with another
    /// size.
    fn swap_contents(&mut self, contents: Contents) -> Contents {
        let old = self.put_contents(contents);
        if self.contents.grid.dims() != old.grid.dims() {
            self.selection = Selection::new(self.grid().dims());
        }
        Arc::unwrap_or_clone(old)
    }

    /// Exchanges all contents and returns the old ones.
    fn put_contents(&mut self, contents: Contents) -> Arc<Contents> {
        let old = std::mem::replace(&mut self.contents, Arc::new(contents));
        self.last_uses.clear();
        self.recorder = StrokeRecorder::new(&self.contents.grid);
        self.dirty = BrickSet::new(self.contents.grid.brick_count());
        self.all_dirty = true;
        self.revision += 1;
        old
    }

    /// An error if a stroke is open. `verb` is the refused command's.
    pub fn require_no_stroke(&self, verb: &'static str) -> Result<(), CommandError> {
        if self.stroke_open() { Err(CommandError::StrokeOpen(verb)) } else { Ok(()) }
    }
}

/// The contents that [`Command::New`] asks for, for [`Document::replace`].
pub fn make_contents(new: &NewSculpture, limits: &Limits) -> Result<Contents, CommandError> {
    let mut grid = Grid::new(new.dims, new.voxel_size, limits.grid_bytes)?;
    if new.solid {
        grid.fill_bricks(|_| Brick::FULL);
    }
    let material = Material::for_grid(&grid, new.colour_depth, new.base);
    Ok(Contents::new(grid, material))
}
