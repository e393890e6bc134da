//! A document: a sculpture being edited, with its contents, placement, selection, clipboard, history
//! and the changed bricks that subscribers have not drained yet. All of it changes only through
//! [`Document::apply`].
//!
//! Knows no files (`session` does), no Vulkan, no window, no clock.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use glam::{Affine3A, IVec3};

use crate::command::{Command, NewSculpture};
use crate::refusal::{MemoryBudget, OverBudget};
pub use crate::sculpture::Limits;
use crate::sculpture::bits_growth::bits_growth;
use crate::sculpture::canvas_frame::CanvasFrame;
use crate::sculpture::clip::Clip;
use crate::sculpture::edit::EditStats;
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::history::{Contents, History, HistorySnapshot, State, StepStore};
use crate::sculpture::region::VoxelBox;
use crate::sculpture::selection::Selection;
use crate::sculpture::{Grid, Material, Placement};
use crate::tools::symmetry::{Symmetry, SymmetryTransform};
use crate::tools::texture::Texture;

mod apply;
mod areas;
mod brush;
mod canvas;
mod changes;
mod clipboard;
mod edit_target;
mod error;
mod lookup;
mod mask;
mod orient;
mod pictures;
mod repair;
mod snapshot;
mod solids;
mod strokes;
mod timeline;
mod trial;

pub use changes::ChangeSubscriber;
use changes::SubscribedChanges;
use edit_target::EditTarget;
pub use error::CommandError;
pub use orient::orient_contents;
use pictures::LoadedPictures;
pub use repair::plan_repair;
pub use snapshot::DocumentSnapshot;
pub use strokes::MAX_ARRAY;
use strokes::Strokes;
use timeline::Timeline;
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
    target: EditTarget,
    timeline: Timeline,
    strokes: Strokes,
    placement: Placement,
    /// The clipboard. It outlives the sculpture it was copied from.
    clip: Option<Arc<Clip>>,
    pictures: LoadedPictures,
    changes: SubscribedChanges,
    /// The subscriber of [`Document::drain_changes`].
    unnamed: ChangeSubscriber,
}

impl Document {
    /// Creates a document with a new sculpture and an empty history.
    pub fn new(new: &NewSculpture, limits: Limits) -> Result<Document, CommandError> {
        Ok(Document::from_contents(make_contents(new, &limits)?, limits))
    }

    /// Creates a document with existing contents and an empty history.
    pub fn from_contents(contents: Contents, limits: Limits) -> Document {
        Document {
            target: EditTarget::new(contents, limits),
            timeline: Timeline::new(limits.history_bytes),
            strokes: Strokes::default(),
            placement: Placement::default(),
            clip: None,
            pictures: LoadedPictures::default(),
            changes: SubscribedChanges::default(),
            unnamed: ChangeSubscriber::default(),
        }
    }

    /// Creates a document that continues from a snapshot, and gives `store` the steps for which memory has no room.
    ///
    /// # Errors
    /// If a setting is refused, which can happen to settings of another document.
    pub fn restored(
        snapshot: DocumentSnapshot,
        limits: Limits,
        store: Option<Arc<dyn StepStore>>,
    ) -> Result<Document, CommandError> {
        snapshot.into_document(limits, store)
    }

    /// Returns a snapshot; `None` while a stroke is open.
    pub fn snapshot(&self) -> Option<DocumentSnapshot> {
        (!self.stroke_open()).then(|| DocumentSnapshot::of(self))
    }

    /// Returns the existence bits.
    pub fn grid(&self) -> &Grid {
        self.target.grid()
    }

    /// Returns the colours.
    pub fn material(&self) -> &Material {
        self.target.material()
    }

    /// Returns bits and colours.
    pub fn contents(&self) -> &Contents {
        &self.target.contents
    }

    /// Returns a snapshot of the contents, for work on another thread.
    pub fn share_contents(&self) -> Arc<Contents> {
        self.target.contents.clone()
    }

    /// Returns where the sculpture stands in the world.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Returns the steps that can be undone and redone.
    pub fn history(&self) -> &History {
        self.timeline.history()
    }

    /// Moves steps for which memory has no room to a store from now on, instead of dropping them.
    pub fn use_step_store(&mut self, store: Arc<dyn StepStore>) {
        self.timeline.use_store(store);
    }

    /// Raises the budget of the undo and redo steps to what `limits` allow, if that is more than now.
    pub fn raise_history_budget(&mut self, limits: &Limits) {
        let own = &mut self.target.limits;
        own.history_bytes = own.history_bytes.max(limits.history_bytes);
        own.history_disk_bytes = own.history_disk_bytes.max(limits.history_disk_bytes);
        self.timeline.raise_budget(limits.history_bytes);
    }

    /// Returns the memory limits of the document.
    pub fn limits(&self) -> &Limits {
        &self.target.limits
    }

    /// Returns the marker and the selected boxes, in grid coordinates.
    pub fn selection(&self) -> &Selection {
        &self.target.selection
    }

    /// Returns the mirror planes in use, in signed coordinates.
    pub fn symmetry(&self) -> Symmetry {
        self.target.symmetry
    }

    /// Returns the positions of the mirror planes of the axes, in grid coordinates.
    pub fn mirror_planes(&self) -> [Option<f32>; 3] {
        self.target.symmetry.planes_in(&self.contents().frame)
    }

    /// Returns the distance from grid coordinates to signed ones, which commands have.
    pub fn origin(&self) -> IVec3 {
        self.target.origin()
    }

    /// Returns the images of tools under the present symmetry, the identity first.
    pub fn images(&self) -> Vec<SymmetryTransform> {
        self.target.images()
    }

    /// Returns the protected voxels, if there are any.
    pub fn mask(&self) -> Option<&Grid> {
        self.target.mask()
    }

    /// Returns the clipboard.
    pub fn clip(&self) -> Option<&Clip> {
        self.clip.as_deref()
    }

    /// Returns whether `array` has an operation to repeat.
    pub fn can_repeat(&self) -> bool {
        !self.strokes.last_uses().is_empty()
    }

    /// Returns the images that `array` needs.
    pub fn pictures_to_repeat(&self) -> impl Iterator<Item = &Path> {
        self.strokes.last_uses().iter().filter_map(Command::picture)
    }

    /// Returns whether an image of this name is loaded.
    pub fn has_picture(&self, name: &Path) -> bool {
        self.pictures.has(name)
    }

    /// Drops all images, so that they are read again when they are next used.
    pub fn forget_pictures(&mut self) {
        self.pictures.forget_all();
    }

    /// Adds an image under the name that commands use for it.
    pub fn learn_picture(&mut self, name: &Path, picture: Texture) {
        self.pictures.learn(name, picture);
    }

    /// Returns whether a stroke is open.
    pub fn stroke_open(&self) -> bool {
        self.strokes.is_open()
    }

    /// Returns the surface that uses of a brush with
    /// [`BrushSurface::Stroke`](crate::tools::brush::BrushSurface::Stroke) work on: the surface at the beginning of the
    /// stroke.
    pub fn stroke_surface(&self) -> &Grid {
        self.strokes.surface().unwrap_or(self.grid())
    }

    /// Returns a number that rises with every change of voxels or colours.
    pub fn revision(&self) -> u64 {
        self.target.revision
    }

    /// Returns the identifier of the current state. Undo and redo restore it, too.
    pub fn state(&self) -> State {
        self.timeline.state()
    }

    /// Returns the map from grid coordinates (voxels) to world units.
    pub fn world_from_grid(&self) -> Affine3A {
        self.placement.world_from_framed(&self.contents().frame, self.grid().voxel_size())
    }

    /// Calls `f` with the contents and the bricks changed since the last call, as rising linear indices. `None` means
    /// all bricks: the sculpture was replaced, perhaps by one of another size.
    pub fn drain_changes<T>(&mut self, f: impl FnOnce(&Contents, Option<&[u32]>) -> T) -> T {
        let unnamed = self.unnamed.clone();
        self.drain_changes_for(&unnamed, f)
    }

    /// As [`Document::drain_changes`], for one of several subscribers. Each has its own last call.
    pub fn drain_changes_for<T>(
        &mut self,
        subscriber: &ChangeSubscriber,
        f: impl FnOnce(&Contents, Option<&[u32]>) -> T,
    ) -> T {
        let bricks = self.grid().brick_count();
        self.target.publish(&mut self.changes);
        f(&self.target.contents, self.changes.drain(subscriber, bricks))
    }

    /// Puts the steps that another document had around the same contents, in the state `was`, on top of the steps of
    /// this document, which must have none to redo. All states of the other document become states of this one. Returns
    /// the new number of each sculpture.
    pub fn adopt_history(&mut self, kept: HistorySnapshot, was: State) -> HashMap<u64, u64> {
        self.timeline.adopt(kept, was)
    }
}

/// Creates the contents that [`Command::New`] describes, for [`Document::replace`].
pub fn make_contents(new: &NewSculpture, limits: &Limits) -> Result<Contents, CommandError> {
    Grid::check_size(new.dims, new.voxel_size)?;
    let room = new.room_vx.min(MAX_AXIS_VX);
    let mut grid = Grid::of_size(new.dims + 2 * room, new.voxel_size)?;
    if new.solid {
        let block = VoxelBox { min: IVec3::splat(room as i32), max: (new.dims + room).as_ivec3() };
        let growth = bits_growth(&grid, &block, true, true);
        OverBudget::check("this may need", growth, MemoryBudget::Grids, limits.grid_bytes)?;
        grid.fill_box(block);
    }
    let material = Material::for_grid(&grid, new.colour_depth, new.base);
    let origin = IVec3::splat(-(room as i32));
    let frame = CanvasFrame { origin, home: new.dims, grows: new.grows };
    Ok(Contents { frame, ..Contents::new(grid, material) })
}
