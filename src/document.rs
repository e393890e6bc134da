//! Owns a sculpture as a person edits it: its contents, its placement, its history and the
//! set of bricks that the renderer has not seen yet. [`Document::apply`] is the only door
//! through which any of them changes.
//!
//! Knows no files (`session` does), no Vulkan, no window, no clock.

use glam::Affine3A;
use thiserror::Error;

use crate::command::{Command, NewSculpture, SpraySurface};
pub use crate::sculpture::Limits;
use crate::sculpture::brick_set::BrickSet;
use crate::sculpture::edit::{self, EditOp, EditStats};
use crate::sculpture::history::{Change, Contents, History, Step};
use crate::sculpture::record::BrickRecord;
use crate::sculpture::region::{Everywhere, Region};
use crate::sculpture::stroke::StrokeRecorder;
use crate::sculpture::{Brick, ColourDepth, Grid, GridError, Material, Placement};
use crate::tools::spray::{Effect, Spray};

/// Why a command was refused. The sculpture is as it was before.
#[derive(Debug, Error)]
pub enum CommandError {
    #[error(transparent)]
    Grid(#[from] GridError),
    #[error("this sculpture has no colours; make or open one with 8, 16 or 24 bits of colour")]
    NoColour,
    #[error(
        "painting here may need {needed_mib} MiB for colours, more than the {budget_mib} MiB \
         allowed; raise memory.colour_mib in the configuration"
    )]
    ColourMemory { needed_mib: u64, budget_mib: u64 },
    #[error("a stroke is open; end or cancel it before `{0}`")]
    StrokeOpen(&'static str),
    #[error("`{0}` without an open stroke; `begin` one first")]
    NoStroke(&'static str),
    #[error("`{0}` concerns files and is not done by the document")]
    NotHere(&'static str),
    #[error("{0} of the placement must be finite and the scale above zero")]
    Placement(&'static str),
    #[error("{0} of the spray tool cannot be used")]
    Spray(&'static str),
    #[error("{0} of the solid must be finite and its half extent above zero")]
    Primitive(&'static str),
}

/// What a command did.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Applied {
    pub stats: EditStats,
    /// Steps undone or redone.
    pub steps: u32,
}

/// A sculpture with its history.
#[derive(Debug)]
pub struct Document {
    contents: Contents,
    placement: Placement,
    history: History,
    /// Label of the open stroke.
    stroke: Option<String>,
    /// The grid before the open stroke's first spray that asked for it.
    stroke_surface: Option<Box<Grid>>,
    recorder: StrokeRecorder,
    dirty: BrickSet,
    /// The dirty bricks as [`Document::take_dirty`] hands them out.
    dirty_list: Vec<u32>,
    /// The whole sculpture was replaced since the renderer last asked.
    all_dirty: bool,
    /// Rises with every change of voxels; a cheap "is my copy current?".
    revision: u64,
    limits: Limits,
}

impl Document {
    /// A document with a new sculpture and an empty history.
    pub fn new(new: &NewSculpture, limits: Limits) -> Result<Document, CommandError> {
        Ok(Document::from_contents(make_contents(new, &limits)?, limits))
    }

    /// A document around contents that a loader has made.
    pub fn from_contents(contents: Contents, limits: Limits) -> Document {
        Document {
            recorder: StrokeRecorder::new(&contents.grid),
            dirty: BrickSet::new(contents.grid.bricks().len()),
            dirty_list: Vec::new(),
            contents,
            placement: Placement::default(),
            history: History::new(limits.history_bytes),
            stroke: None,
            stroke_surface: None,
            all_dirty: true,
            revision: 0,
            limits,
        }
    }

    pub fn grid(&self) -> &Grid {
        &self.contents.grid
    }

    pub fn material(&self) -> &Material {
        &self.contents.material
    }

    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    pub fn history(&self) -> &History {
        &self.history
    }

    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    pub fn stroke_open(&self) -> bool {
        self.stroke.is_some()
    }

    /// Rises with every change of voxels or colours.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    pub fn world_from_grid(&self) -> Affine3A {
        self.placement.world_from_grid(self.grid().dims(), self.grid().voxel_size())
    }

    /// Hands the bricks that changed since the last call to `f`, as rising linear indices: `None`
    /// means all of them (the sculpture, and with it perhaps the size of the grid, is another).
    pub fn take_dirty<T>(&mut self, f: impl FnOnce(&Contents, Option<&[u32]>) -> T) -> T {
        self.dirty_list.clear();
        self.dirty.collect_into(&mut self.dirty_list);
        self.dirty.clear();
        let all_dirty = std::mem::take(&mut self.all_dirty);
        f(&self.contents, (!all_dirty).then_some(&self.dirty_list))
    }

    /// Puts a loaded sculpture in place of the present one, as one undo step.
    pub fn replace(&mut self, contents: Contents, label: &str) -> Result<(), CommandError> {
        self.require_no_stroke("open")?;
        let old = self.swap_contents(Box::new(contents));
        self.history.push(Step { label: label.to_string(), change: Change::Whole(old) });
        Ok(())
    }

    /// Carries out a command. On an error nothing has changed.
    pub fn apply(&mut self, command: &Command) -> Result<Applied, CommandError> {
        match command {
            Command::New(new) => {
                self.require_no_stroke("new")?;
                let contents = make_contents(new, &self.limits)?;
                self.replace(contents, "new").map(|()| Applied::default())
            }
            Command::Open { .. } | Command::Save { .. } => {
                Err(CommandError::NotHere(command.verb()))
            }
            Command::Begin { label } => {
                self.require_no_stroke("begin")?;
                self.stroke = Some(label.clone());
                Ok(Applied::default())
            }
            Command::End => {
                let label = self.stroke.take().ok_or(CommandError::NoStroke("end"))?;
                self.stroke_surface = None;
                self.finish_stroke(label);
                Ok(Applied::default())
            }
            Command::Cancel => {
                self.stroke.take().ok_or(CommandError::NoStroke("cancel"))?;
                self.stroke_surface = None;
                let record = self.recorder.finish();
                self.swap_bricks(record);
                Ok(Applied::default())
            }
            Command::Construct { op, primitive } => {
                primitive.check().map_err(CommandError::Primitive)?;
                if matches!(op, EditOp::Recolour(_)) && !self.has_colour() {
                    return Err(CommandError::NoColour);
                }
                let region = primitive.in_grid(self.grid().voxel_size());
                self.edit(&region, *op, command)
            }
            Command::Spray { spray, surface } => self.spray(spray, *surface, command),
            Command::Fill { colour } => {
                let colour = colour.unwrap_or(self.material().base());
                self.edit(&Everywhere, EditOp::Add(colour), command)
            }
            Command::Clear => self.edit(&Everywhere, EditOp::Subtract, command),
            Command::Undo { steps } => self.travel(*steps, "undo", Self::undo_step),
            Command::Redo { steps } => self.travel(*steps, "redo", Self::redo_step),
            Command::Place(placement) => {
                if !placement.rotation.is_finite() || !placement.rotation.is_normalized() {
                    return Err(CommandError::Placement("rotation"));
                }
                if !placement.translation.is_finite() {
                    return Err(CommandError::Placement("translation"));
                }
                if !placement.scale.is_finite() || placement.scale <= 0.0 {
                    return Err(CommandError::Placement("scale"));
                }
                self.placement = *placement;
                Ok(Applied::default())
            }
        }
    }

    /// Works out what a spray changes and does it: removing first, then adding, then painting.
    fn spray(
        &mut self,
        spray: &Spray,
        surface: SpraySurface,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        spray.check().map_err(CommandError::Spray)?;
        if matches!(spray.effect, Effect::Paintbrush { .. }) && !self.has_colour() {
            return Err(CommandError::NoColour);
        }
        if self.stroke_open() && surface == SpraySurface::Stroke && self.stroke_surface.is_none() {
            self.stroke_surface = Some(Box::new(self.grid().clone()));
        }
        let surface = match surface {
            SpraySurface::Stroke => self.stroke_surface.as_deref(),
            SpraySurface::Now => None,
        };
        let stamp = spray.stamp(self.grid(), surface.unwrap_or(self.grid()));
        let colour = spray.colour().unwrap_or(self.material().base());
        self.check_colour_memory(&stamp.add, EditOp::Add(colour))?;
        self.check_colour_memory(&stamp.paint, EditOp::Recolour(colour))?;
        let mut stats = EditStats::default();
        for (region, op) in [
            (&stamp.remove, EditOp::Subtract),
            (&stamp.add, EditOp::Add(colour)),
            (&stamp.paint, EditOp::Recolour(colour)),
        ] {
            let (contents, recorder) = (&mut self.contents, &mut self.recorder);
            stats += edit::edit(contents, region, op, recorder, &mut self.dirty);
        }
        self.revision += u64::from(stats.bricks_changed > 0);
        if self.stroke.is_none() && stats.bricks_changed > 0 {
            self.finish_stroke(command.label());
        }
        Ok(Applied { stats, steps: 0 })
    }

    fn has_colour(&self) -> bool {
        self.material().depth() != ColourDepth::None
    }

    /// Edits within the open stroke, or as a step of its own.
    fn edit(
        &mut self,
        region: &impl Region,
        op: EditOp,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.check_colour_memory(region, op)?;
        let (contents, recorder) = (&mut self.contents, &mut self.recorder);
        let stats = edit::edit(contents, region, op, recorder, &mut self.dirty);
        self.revision += u64::from(stats.bricks_changed > 0);
        if self.stroke.is_none() && stats.bricks_changed > 0 {
            self.finish_stroke(command.label());
        }
        Ok(Applied { stats, steps: 0 })
    }

    /// Refuses a painting edit that would take more memory for colours than is allowed.
    fn check_colour_memory(&self, region: &impl Region, op: EditOp) -> Result<(), CommandError> {
        let material = self.material();
        let needed = |pages| material.bytes_with(pages);
        let budget = self.limits.colour_bytes;
        let Some(at_most) = edit::max_new_pages(&self.contents, region, op) else { return Ok(()) };
        if needed(at_most) <= budget {
            return Ok(());
        }
        // The bounds of the region are too much: count.
        let needed = needed(edit::count_new_pages(&self.contents, region, op));
        if needed <= budget {
            return Ok(());
        }
        Err(CommandError::ColourMemory {
            needed_mib: needed.div_ceil(1 << 20),
            budget_mib: budget >> 20,
        })
    }

    /// Makes an undo step of what has been recorded, unless that is nothing.
    fn finish_stroke(&mut self, label: String) {
        let record = self.recorder.finish();
        if !record.is_empty() {
            self.history.push(Step { label, change: Change::Bricks(record) });
        }
    }

    fn travel(
        &mut self,
        steps: Option<u32>,
        verb: &'static str,
        step: impl Fn(&mut Self) -> bool,
    ) -> Result<Applied, CommandError> {
        self.require_no_stroke(verb)?;
        let mut done = 0;
        while steps.is_none_or(|limit| done < limit) && step(self) {
            done += 1;
        }
        Ok(Applied { stats: EditStats::default(), steps: done })
    }

    fn undo_step(&mut self) -> bool {
        let Some(step) = self.history.take_undo() else { return false };
        let reverse = self.reverse(step);
        self.history.undone(reverse);
        true
    }

    fn redo_step(&mut self) -> bool {
        let Some(step) = self.history.take_redo() else { return false };
        let reverse = self.reverse(step);
        self.history.redone(reverse);
        true
    }

    /// Swaps a step's values with the sculpture's.
    fn reverse(&mut self, step: Step) -> Step {
        let change = match step.change {
            Change::Bricks(record) => Change::Bricks(self.swap_bricks(record)),
            Change::Whole(contents) => Change::Whole(self.swap_contents(contents)),
        };
        Step { label: step.label, change }
    }

    fn swap_bricks(&mut self, record: BrickRecord) -> BrickRecord {
        self.revision += u64::from(!record.is_empty());
        record.swap(&mut self.contents, &mut self.dirty)
    }

    fn swap_contents(&mut self, mut contents: Box<Contents>) -> Box<Contents> {
        std::mem::swap(&mut self.contents, &mut *contents);
        self.recorder = StrokeRecorder::new(&self.contents.grid);
        self.dirty = BrickSet::new(self.contents.grid.bricks().len());
        self.all_dirty = true;
        self.revision += 1;
        contents
    }

    fn require_no_stroke(&self, verb: &'static str) -> Result<(), CommandError> {
        if self.stroke_open() { Err(CommandError::StrokeOpen(verb)) } else { Ok(()) }
    }
}

fn make_contents(new: &NewSculpture, limits: &Limits) -> Result<Contents, CommandError> {
    let mut grid = Grid::new(new.dims, new.voxel_size, limits.grid_bytes)?;
    if new.solid {
        grid.fill_bricks(|_| Brick::FULL);
    }
    let material = Material::new(new.colour_depth, new.base, grid.bricks().len());
    Ok(Contents { grid, material })
}
