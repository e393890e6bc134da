//! The parts of a history: contents, the change of a step, steps, and all steps at one moment.

use std::sync::Arc;

use glam::{IVec3, UVec3};

use super::store::Stored;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_index};
use crate::sculpture::colour::{ColourDepth, Rgb};
use crate::sculpture::grid::Grid;
use crate::sculpture::material::Material;
use crate::sculpture::memory::NoMemory;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::record::BrickRecord;

/// The form in which near voxels are shown, and proposed for their mesh.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum SurfaceKind {
    /// The smooth surface between them: clay and scans.
    #[default]
    Smooth,
    /// Their cubes: models of voxel editors.
    Cubes,
}

impl SurfaceKind {
    /// All kinds with their names in the text form.
    pub const NAMED: [(SurfaceKind, &'static str); 2] =
        [(SurfaceKind::Smooth, "smooth"), (SurfaceKind::Cubes, "cubes")];

    /// Its name in the text form.
    pub fn name(self) -> &'static str {
        match self {
            SurfaceKind::Smooth => "smooth",
            SurfaceKind::Cubes => "cubes",
        }
    }
}

/// All that undo restores: existence bits, colours, the mask and the kind of surface.
#[derive(Clone, PartialEq, Debug)]
pub struct Contents {
    /// Which voxels exist.
    pub grid: Grid,
    /// Their colours.
    pub material: Material,
    /// Which voxels, existing or not, are protected from all tools: a grid of the same size. None if there are none.
    pub mask: Option<Box<Grid>>,
    /// The form in which near voxels are shown.
    pub surface: SurfaceKind,
}

impl Contents {
    /// Bits and colours with nothing protected.
    pub fn new(grid: Grid, material: Material) -> Contents {
        Contents { grid, material, mask: None, surface: SurfaceKind::default() }
    }

    /// A grid as contents without colours or a mask of its own.
    pub(crate) fn of_bits(grid: Grid) -> Contents {
        let material = Material::for_grid(&grid, ColourDepth::None, Rgb::default());
        Contents::new(grid, material)
    }

    /// Whether the voxel at `v` is protected.
    pub fn is_masked(&self, v: IVec3) -> bool {
        self.mask.as_ref().is_some_and(|mask| mask.get(v))
    }

    /// Drops a mask that protects nothing.
    pub(crate) fn drop_empty_mask(&mut self) {
        self.mask.take_if(|mask| mask.opaque_count() == 0);
    }

    /// Colour of the voxel at `v`, which must lie inside the grid, whether it exists or not.
    pub fn rgb(&self, v: UVec3) -> Rgb {
        let [x, y, z] = (v % BRICK_EDGE_VX).to_array();
        self.material.rgb(self.grid.brick_index(v / BRICK_EDGE_VX), local_index(x, y, z))
    }

    /// Colour of the voxel at `v`; none where none exists.
    pub fn colour(&self, v: IVec3) -> Option<Rgb> {
        self.grid.get(v).then(|| self.rgb(v.as_uvec3()))
    }
}

/// Bytes that a step takes of the budget while a store keeps its values.
pub(super) const STUB_BYTES: usize = 256;

/// The change made by one step.
#[derive(Clone, PartialEq, Debug)]
pub enum Change {
    /// Some bricks of the sculpture.
    Bricks(BrickRecord),
    /// The whole sculpture, replaced by a new or opened one.
    Whole(Box<Contents>),
    /// The whole sculpture was laid another way, and `back` leads back. `before` is kept only where
    /// that would not restore every byte.
    Oriented {
        /// The inverse of the orientation that was done.
        back: Orientation,
        /// The sculpture as it was.
        before: Option<Box<Contents>>,
    },
    /// The kind of surface, which was this one.
    Surface(SurfaceKind),
    /// One of the above, which a [`super::StepStore`] keeps.
    Stored(Stored),
}

impl Contents {
    /// A copy, unless the system lacks the memory for it.
    pub fn copied(&self) -> Result<Contents, NoMemory> {
        let no_memory = NoMemory { bytes: self.kept_bytes() as u64 };
        let grid = self.grid.copied().map_err(|_| no_memory)?;
        let material = self.material.copied().map_err(|_| no_memory)?;
        let mask = self.mask.as_ref().map(|mask| mask.copied().map(Box::new)).transpose();
        let mask = mask.map_err(|_| no_memory)?;
        Ok(Contents { grid, material, mask, surface: self.surface })
    }

    /// Bytes of a step that keeps all of it.
    pub fn kept_bytes(&self) -> usize {
        let mask = self.mask.as_ref().map_or(0, |mask| mask.heap_bytes());
        size_of::<Contents>()
            + (self.grid.heap_bytes() + self.material.heap_bytes() + mask) as usize
    }
}

impl Change {
    fn heap_bytes(&self) -> usize {
        match self {
            Change::Bricks(record) => record.heap_bytes(),
            Change::Whole(old) => old.kept_bytes(),
            Change::Oriented { before, .. } => before.as_ref().map_or(0, |old| old.kept_bytes()),
            Change::Surface(_) => 0,
            Change::Stored(_) => STUB_BYTES,
        }
    }
}

/// Identifies a state of a document. Undo and redo restore the identifier with the state, so that anything that belongs
/// to a state, such as its file, can be looked up by it.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct State {
    /// Differs for each sculpture that was created or opened.
    pub sculpture: u64,
    /// Differs after each change.
    pub number: u64,
}

/// A named, reversible change.
#[derive(Clone, PartialEq, Debug)]
pub struct Step {
    /// Name of the change, as the history list shows it.
    pub label: String,
    /// The values to swap with the sculpture's.
    pub change: Change,
    /// The state that reversing it leads to.
    pub state: State,
}

impl Step {
    /// A copy, unless the system lacks the memory for it.
    pub fn copied(&self) -> Result<Step, NoMemory> {
        let whole = |contents: &Contents| contents.copied().map(Box::new);
        let change = match &self.change {
            Change::Bricks(record) => {
                let no_memory = |_| NoMemory { bytes: record.heap_bytes() as u64 };
                Change::Bricks(record.copied().map_err(no_memory)?)
            }
            Change::Whole(contents) => Change::Whole(whole(contents)?),
            Change::Oriented { back, before } => {
                let before = before.as_ref().map(|before| whole(before)).transpose()?;
                Change::Oriented { back: *back, before }
            }
            Change::Surface(kind) => Change::Surface(*kind),
            Change::Stored(stored) => Change::Stored(stored.clone()),
        };
        Ok(Step { label: self.label.clone(), change, state: self.state })
    }

    /// Bytes that the step takes of the history's budget.
    pub fn heap_bytes(&self) -> usize {
        size_of::<Step>() + self.label.len() + self.change.heap_bytes()
    }

    /// Bytes that the step takes with all its values in memory.
    pub fn whole_bytes(&self) -> usize {
        match &self.change {
            Change::Stored(stored) => stored.0.whole_bytes(),
            _ => self.heap_bytes(),
        }
    }
}

/// The steps that can be undone and redone, as they were at one moment. Steps are shared, so taking one
/// copies no values; a step that is undone while it is shared is copied then.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct HistorySnapshot {
    /// Oldest first.
    pub undo: Vec<Arc<Step>>,
    /// Last to be redone first.
    pub redo: Vec<Arc<Step>>,
}

impl HistorySnapshot {
    /// Drops the steps furthest from the current state until the rest takes at most `bytes`. Returns how
    /// many steps were dropped of each list.
    pub fn shorten(&mut self, bytes: usize) -> [usize; 2] {
        let mut left = bytes;
        [&mut self.undo, &mut self.redo].map(|steps| {
            let fits = |step: &&Arc<Step>| {
                let rest = left.checked_sub(step.whole_bytes());
                left = rest.unwrap_or(0);
                rest.is_some()
            };
            let kept = steps.iter().rev().take_while(fits).count();
            let dropped = steps.len() - kept;
            steps.drain(..dropped);
            dropped
        })
    }
}
