//! The existence bits of one sculpture, in bricks of 8^3 voxels.
//!
//! Bricks lie under a tree of nodes of 8^3 children each (`node.rs`). Uniform cubes take no memory, whatever their size,
//! and a copy of a grid shares all nodes until one of the two changes. How bricks are stored is private to
//! [`crate::sculpture`]. All other code asks for a brick by its coordinates or index, visits the non-empty ones, copies
//! rows of bricks along x, or looks up words of 4^3 voxels (`read.rs`, `word_reader.rs`); what walks a whole grid walks
//! the nodes, an octree of cubes, or spans of like bricks (`parts.rs`, `octree.rs`, `spans.rs`). Writers replace whole bricks, or edit leaves of 8^3
//! bricks (`lend.rs`, `leaf_edit.rs`).
//!
//! Invariants: bits beyond `dims` are 0; voxel counts and kinds always match the bits. Knows no colour, no history, no
//! tool.

use std::sync::Arc;

use glam::{IVec3, UVec3, Vec3};
use thiserror::Error;

use self::lend::{close, open, slot_in};
pub(in crate::sculpture) use self::node::LEAF_BYTES;
use self::node::TreeNode;
use super::brick::{BRICK_EDGE_VX, Brick};
pub(in crate::sculpture) use super::brick_set::LeafKey;
use super::region::{BoxCoverage, BrickBox, Region as _, VoxelBox};
use crate::refusal::{InvalidValue, MemoryBudget, OverBudget};

mod build;
mod extent;
mod layers;
mod leaf_edit;
mod lend;
mod node;
mod octree;
mod parts;
mod read;
mod reframe;
mod spans;
mod visit;
mod walls;
mod word_reader;

pub(crate) use build::BrickRun;
pub(in crate::sculpture) use extent::Extent;
pub(crate) use layers::{GridLayers, LeafRow};
pub(in crate::sculpture) use leaf_edit::LeafEdit;
use leaf_edit::row_of;
pub(in crate::sculpture) use lend::{
    ChangedLeaf, Cube, CubeEdit, LeafPlace, Lent, LentLeaf, OldLeaf,
};
pub(in crate::sculpture) use node::{NODE_EDGE_LOG2, Slot};
pub(crate) use octree::{BRICK_LEVEL, OctreeBrick, OctreeCube};
pub(crate) use parts::{
    GridPart, NodeView, box_mask, bricks_beside_empty, for_each_part, indices, surface_leaves,
    uniform_in,
};
pub(in crate::sculpture) use reframe::{reframed, source_of};
pub(crate) use spans::BrickSpans;

pub use walls::voxels_at_walls;
pub use word_reader::WordReader;

/// The logarithm of the edge of a leaf of the tree, in bricks.
pub(crate) const LEAF_EDGE_LOG2: u32 = NODE_EDGE_LOG2;
/// The edge of a leaf, in voxels.
pub(crate) const LEAF_EDGE_VX: u32 = BRICK_EDGE_VX << LEAF_EDGE_LOG2;
/// Longest axis of a grid, in voxels.
pub const MAX_AXIS_VX: u32 = 8192;
/// Marks "no voxel" in an index map.
pub const NO_VOXEL: u32 = u32::MAX;

/// Returns the edge of the largest cube within a memory budget, in voxels.
fn largest_within(budget_mib: u64) -> u32 {
    let fits = |edge| Grid::bytes_for(UVec3::splat(edge)).div_ceil(1 << 20) <= budget_mib;
    // If a size fits, smaller ones fit as well.
    let (mut fitting, mut beyond) = (1, MAX_AXIS_VX + 1);
    while beyond - fitting > 1 {
        let middle = fitting.midpoint(beyond);
        let edge = if fits(middle) { &mut fitting } else { &mut beyond };
        *edge = middle;
    }
    fitting
}

/// Why a grid cannot be made.
#[derive(Debug, Error, PartialEq)]
pub enum GridError {
    /// The number of voxels on an axis is 0 or more than [`MAX_AXIS_VX`]; the size is given.
    #[error("grid of {0}x{1}x{2} voxels: every axis must be 1 to {MAX_AXIS_VX} voxels")]
    Axis(u32, u32, u32),
    /// The grid needs more memory than allowed.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The system does not provide the allowed memory.
    #[error(
        "grid of {dims} voxels: the system has not the {needed_mib} MiB that it needs; close other \
         programs or sculptures, or choose a smaller grid"
    )]
    NoMemory {
        /// Size in voxels.
        dims: UVec3,
        /// MiB needed.
        needed_mib: u64,
    },
    /// The edges of a voxel are not finite or not positive.
    #[error(transparent)]
    Invalid(#[from] InvalidValue),
}

/// Existence bits in bricks of 8^3.
#[derive(Clone, Debug)]
pub struct Grid {
    extent: Extent,
    voxel_size: Vec3,
    /// The node that spans the grid, at least of level 2, and its level.
    root: Arc<TreeNode>,
    levels: u32,
    /// The bits of full bricks that the upper border cuts: on the axes of the set bits of an index. `None` if it cuts
    /// none.
    cut: Option<Arc<[Brick; 8]>>,
}

impl PartialEq for Grid {
    fn eq(&self, other: &Grid) -> bool {
        self.extent == other.extent
            && self.voxel_size == other.voxel_size
            && (Arc::ptr_eq(&self.root, &other.root) || self.root == other.root)
    }
}

impl Grid {
    /// Returns about the bytes of a grid of `dims` voxels all of whose bricks are mixed, without colour: the bound by
    /// which limits are checked. Nodes of small grids may take more.
    pub fn bytes_for(dims: UVec3) -> u64 {
        let bricks = brick_dims(dims);
        let blocks = occupancy_dims(bricks);
        product(bricks) * (size_of::<Brick>() + size_of::<u16>()) as u64 + product(blocks) * 8
    }

    /// Performs the checks of [`Grid::new`] without allocating.
    pub fn check(dims: UVec3, voxel_size: Vec3, budget_bytes: u64) -> Result<(), GridError> {
        Self::check_size(dims, voxel_size)?;
        Self::check_memory(dims, budget_bytes)
    }

    /// Performs the checks of [`Grid::of_size`].
    pub fn check_size(dims: UVec3, voxel_size: Vec3) -> Result<(), GridError> {
        let UVec3 { x, y, z } = dims;
        if dims.min_element() == 0 || dims.max_element() > MAX_AXIS_VX {
            return Err(GridError::Axis(x, y, z));
        }
        let is_size = voxel_size.is_finite() && voxel_size.min_element() > 0.0;
        let rule = "is not valid: it must be a positive, finite length on every axis";
        Ok(InvalidValue::check(is_size, "voxel size", rule, voxel_size)?)
    }

    fn check_memory(dims: UVec3, budget_bytes: u64) -> Result<(), GridError> {
        let needed = Self::bytes_for(dims);
        if needed > budget_bytes {
            let what = format!("grid of {dims} voxels needs");
            let over = OverBudget::new(what, needed, MemoryBudget::Grids, budget_bytes);
            let cube = largest_within(over.budget_mib);
            let advice = format!("choose a smaller grid (at most {cube}x{cube}x{cube})");
            return Err(over.advise(advice).into());
        }
        Ok(())
    }

    /// Returns an empty grid of `dims` voxels with edges of `voxel_size`, for callers that check the memory of the voxels
    /// that they add.
    pub fn of_size(dims: UVec3, voxel_size: Vec3) -> Result<Grid, GridError> {
        Self::check_size(dims, voxel_size)?;
        Ok(Self::empty(dims, voxel_size))
    }

    /// Returns an empty grid of `dims` voxels with edges of `voxel_size`, all of whose bricks may become mixed within
    /// `budget_bytes`.
    pub fn new(dims: UVec3, voxel_size: Vec3, budget_bytes: u64) -> Result<Grid, GridError> {
        Self::check(dims, voxel_size, budget_bytes)?;
        Ok(Self::empty(dims, voxel_size))
    }

    /// Returns an empty grid of the cells between the centres of this grid's voxels and beyond its border: one longer on
    /// each axis, even where a sculpture may not be that long.
    pub(crate) fn of_cells(&self) -> Grid {
        Self::empty(self.extent.dims + 1, self.voxel_size)
    }

    /// Returns an empty grid of the same size.
    pub fn emptied(&self) -> Grid {
        Grid { root: empty_root(), cut: self.cut.clone(), ..*self }
    }

    fn empty(dims: UVec3, voxel_size: Vec3) -> Grid {
        let extent = Extent::new(dims);
        let edge = extent.bricks.max_element();
        let levels = (2..).find(|&level| edge <= 1 << (NODE_EDGE_LOG2 * level)).unwrap_or(2);
        let last = extent.bricks - 1;
        let is_cut = !extent.holds_brick(last);
        let cut = is_cut.then(|| {
            Arc::new(std::array::from_fn(|axes| {
                let cut_axis = UVec3::splat(axes as u32) >> UVec3::new(0, 1, 2) & 1;
                valid_mask(dims, last * cut_axis)
            }))
        });
        Grid { extent, voxel_size, root: empty_root(), levels, cut }
    }

    /// Returns the size in voxels.
    #[inline]
    pub fn dims(&self) -> UVec3 {
        self.extent.dims
    }

    /// Returns the size in bricks.
    #[inline]
    pub fn brick_dims(&self) -> UVec3 {
        self.extent.bricks
    }

    /// Returns the edge lengths of a voxel in world units.
    #[inline]
    pub fn voxel_size(&self) -> Vec3 {
        self.voxel_size
    }

    /// Returns the number of existing voxels.
    #[inline]
    pub fn opaque_count(&self) -> u64 {
        self.root.voxels
    }

    /// Returns the heap bytes in use, those shared with other grids included.
    pub fn heap_bytes(&self) -> u64 {
        let cut =
            if self.cut.is_some() { size_of::<[Brick; 8]>() + align_of::<Brick>() } else { 0 };
        self.root.heap_bytes() + cut as u64
    }

    /// Returns the linear index of the brick at brick coordinates `b` (must be inside).
    #[inline(always)]
    pub fn brick_index(&self, b: UVec3) -> usize {
        (b.x + self.extent.bricks.x * (b.y + self.extent.bricks.y * b.z)) as usize
    }

    /// Returns the brick coordinates of a linear brick index.
    #[inline]
    pub fn brick_coords(&self, index: usize) -> UVec3 {
        unflatten(index as u32, self.extent.bricks)
    }

    /// Returns the linear voxel index `x + y*dX + z*dX*dY`, of a grid of fewer than 2^32 voxels.
    #[inline(always)]
    pub fn voxel_index(&self, v: UVec3) -> u32 {
        v.x + self.extent.dims.x * (v.y + self.extent.dims.y * v.z)
    }

    /// Performs the inverse of [`Grid::voxel_index`].
    #[inline]
    pub fn voxel_coords(&self, index: u32) -> UVec3 {
        unflatten(index, self.extent.dims)
    }

    /// Returns whether `v` lies inside the grid.
    #[inline]
    pub fn contains(&self, v: IVec3) -> bool {
        v.cmpge(IVec3::ZERO).all() && v.as_uvec3().cmplt(self.extent.dims).all()
    }

    /// Returns whether the voxel at `v` exists; false outside the grid.
    #[inline]
    pub fn get(&self, v: IVec3) -> bool {
        self.contains(v) && {
            let v = v.as_uvec3();
            self.brick(v / BRICK_EDGE_VX).get(v.x & 7, v.y & 7, v.z & 7)
        }
    }

    /// Sets one voxel; ignores coordinates outside the grid. For loaders and tests; edits write whole bricks.
    pub fn set(&mut self, v: IVec3, exists: bool) {
        if !self.contains(v) {
            return;
        }
        let v = v.as_uvec3();
        let b = v / BRICK_EDGE_VX;
        let mut brick = *self.brick(b);
        brick.set(v.x & 7, v.y & 7, v.z & 7, exists);
        self.put_brick(b, &brick);
    }

    /// Returns the bits that the brick at `b` may hold: all but those beyond the grid's border.
    #[inline]
    pub fn valid_mask(&self, b: UVec3) -> Brick {
        valid_mask(self.extent.dims, b)
    }

    /// Sets every brick to the value of `f` for its coordinates (cut to the valid bits), in parallel. For loaders and
    /// generators.
    pub fn fill_bricks(&mut self, f: impl Fn(UVec3) -> Brick + Sync) {
        // Calls through a pointer once per brick: the parallel loop is compiled once, not per `f`.
        self.root = build::tree_of_bricks(self.extent, self.levels, &f);
    }

    /// Makes the voxels of a box exist, and no others.
    pub(crate) fn fill_box(&mut self, voxels: VoxelBox) {
        // A cube at the border is full with the voxels that it has.
        let all = VoxelBox::of_grid(self);
        let whole = |cube: BrickBox| match voxels.coverage(cube.voxels().intersect(all)) {
            BoxCoverage::None => Some(false),
            BoxCoverage::Part => None,
            BoxCoverage::All => Some(true),
        };
        self.fill_cubes(whole, |b| voxels.in_brick(b));
    }

    /// Sets all bricks, in parallel, as [`Grid::fill_bricks`] does; but asks `whole` about each cube of the tree first, the
    /// large ones before the small: a cube for which it returns whether it is full or empty is not divided further.
    pub(crate) fn fill_cubes(
        &mut self,
        whole: impl Fn(BrickBox) -> Option<bool> + Sync,
        f: impl Fn(UVec3) -> Brick + Sync,
    ) {
        self.root = build::tree_of_cubes(self.extent, self.levels, &whole, &f);
    }

    /// Lets `f` write all bricks, in runs of `run` in linear order, on all threads. `f` gets the linear index of a
    /// run's first brick and the run, to which it must add its bricks. Returns the values of `f` in order, or one of its
    /// errors.
    pub(crate) fn try_fill_runs<T: Send, E: Send>(
        &mut self,
        run: usize,
        f: impl Fn(usize, &mut BrickRun) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        let (root, values) = build::tree_of_runs(self.extent, self.levels, run, f)?;
        self.root = root;
        Ok(values)
    }

    /// Sets all bricks: the cubes that `whole` says to be full (`true`) or empty, large ones before small, and the leaves
    /// (coordinates of their lowest bricks divided by 8) that `f` writes in runs of `run`, on all threads. `f` gets the
    /// number of a run and its bricks, one leaf after the other. Returns the values of `f` in order, or one of its errors.
    pub(crate) fn try_fill_leaves<T: Send, E: Send>(
        &mut self,
        whole: impl Fn(BrickBox) -> Option<bool> + Sync,
        (leaves, run): (&[UVec3], usize),
        f: impl Fn(usize, &mut BrickRun) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        let (root, values) =
            build::tree_of_leaf_runs(self.extent, self.levels, &whole, (leaves, run), f)?;
        self.root = root;
        Ok(values)
    }

    /// Replaces the brick of a linear brick index. The bits must lie within [`Grid::valid_mask`].
    pub fn set_brick(&mut self, index: usize, brick: Brick) {
        self.put_brick(self.brick_coords(index), &brick);
    }

    /// Replaces the brick at brick coordinates `b`. The bits must lie within [`Grid::valid_mask`].
    pub(crate) fn put_brick(&mut self, b: UVec3, brick: &Brick) {
        let before = self.brick(b);
        let change = i64::from(brick.count()) - i64::from(before.count());
        if before != brick {
            put_brick(&mut self.root, self.levels, b, brick, change, &self.extent);
        }
    }
}

/// Replaces a brick in a tree of `level` levels by a different one, of `change` more voxels.
fn put_brick(
    node: &mut Arc<TreeNode>,
    level: u32,
    b: UVec3,
    brick: &Brick,
    change: i64,
    extent: &Extent,
) {
    let node = Arc::make_mut(node);
    if level == 1 {
        node.put_brick(Slot::of(b), brick, &valid_mask(extent.dims, b));
    } else {
        let slot = slot_in(b, level);
        let child = open(node, slot, b, level, extent);
        put_brick(child, level - 1, b, brick, change, extent);
        close(node, slot, b, level, extent);
    }
    node.voxels = node.voxels.wrapping_add_signed(change);
}

fn empty_root() -> Arc<TreeNode> {
    Arc::new(TreeNode::uniform(Brick::EMPTY, 0))
}

/// Returns the bits that a brick may have in a grid of `dims` voxels.
#[inline]
pub fn valid_mask(dims: UVec3, b: UVec3) -> Brick {
    let room = dims - b * BRICK_EDGE_VX;
    if room.min_element() >= BRICK_EDGE_VX { Brick::FULL } else { Brick::below(room.to_array()) }
}

/// Returns the size in bricks of a grid of `dims` voxels.
pub fn brick_dims(dims: UVec3) -> UVec3 {
    (dims + (BRICK_EDGE_VX - 1)) / BRICK_EDGE_VX
}

fn occupancy_dims(brick_dims: UVec3) -> UVec3 {
    (brick_dims + 3) / 4
}

fn product(v: UVec3) -> u64 {
    u64::from(v.x) * u64::from(v.y) * u64::from(v.z)
}

/// Returns the brick coordinates of a linear index among `dims` bricks.
#[inline]
pub(crate) fn unflatten(index: u32, dims: UVec3) -> UVec3 {
    let yz = index / dims.x;
    UVec3::new(index % dims.x, yz % dims.y, yz / dims.y)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    const ROOM: u64 = 1 << 32;

    /// Checks that the tree is canonical, packed and counted.
    pub(crate) fn check(grid: &Grid) {
        node::tests::check(&grid.root, UVec3::ZERO, grid.levels, &grid.extent);
    }

    fn small_grid(dims: UVec3) -> Grid {
        Grid::new(dims, Vec3::ONE, ROOM).unwrap()
    }

    #[test]
    fn uniform_grids_take_next_to_nothing_whatever_their_size() {
        for edge in [1, 64, 511, 1024, 1625, 4095, 4096, 8191, 8192] {
            let mut grid = Grid::of_size(UVec3::splat(edge), Vec3::ONE).unwrap();
            assert!(grid.heap_bytes() <= 1024, "{} bytes", grid.heap_bytes());
            grid.fill_box(VoxelBox::of_grid(&grid));
            assert!(grid.heap_bytes() <= 1024, "{} bytes", grid.heap_bytes());
            assert_eq!(grid.opaque_count(), u64::from(edge).pow(3));
            check(&grid);
        }
    }

    #[test]
    fn refusals_name_the_reason() {
        let new = |dims: [u32; 3], room| Grid::new(UVec3::from(dims), Vec3::ONE, room);
        assert!(matches!(new([0, 4, 4], ROOM), Err(GridError::Axis(0, 4, 4))));
        assert!(matches!(new([8193, 1, 1], ROOM), Err(GridError::Axis(..))));
        assert!(new([8192, 8192, 8192], u64::MAX).is_ok());
        let error = new([1024, 1024, 1024], 64 << 20).unwrap_err().to_string();
        assert!(error.contains("64 MiB allowed for grids"), "{error}");
        assert!(error.contains("at most 800x800x800"), "{error}");
        assert!(new([800; 3], 64 << 20).is_ok() && new([801; 3], 64 << 20).is_err());
        assert!(Grid::new(UVec3::ONE, Vec3::new(1.0, f32::NAN, 1.0), ROOM).is_err());
        assert!(Grid::new(UVec3::ONE, Vec3::new(1.0, 0.0, 1.0), ROOM).is_err());
    }

    #[test]
    fn a_1024_axis_works_to_its_last_voxel() {
        let mut grid = small_grid(UVec3::new(1024, 3, 1023));
        let last = IVec3::new(1023, 2, 1022);
        grid.set(last, true);
        assert!(grid.get(last));
        assert_eq!(grid.opaque_count(), 1);
        assert_eq!(grid.voxel_coords(grid.voxel_index(last.as_uvec3())), last.as_uvec3());
    }

    proptest! {
        #[test]
        fn bounds_are_those_of_the_bricks_in_use(
            dims in prop::array::uniform3(1u32..70),
            places in prop::collection::vec(prop::array::uniform3(0u32..70), 0..4),
        ) {
            let dims = UVec3::from(dims);
            let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
            let mut expected: Option<(UVec3, UVec3)> = None;
            for place in places {
                let voxel = UVec3::from(place) % dims;
                grid.set(voxel.as_ivec3(), true);
                let (low, high) = (voxel / 8 * 8, (voxel / 8 * 8 + 8).min(dims));
                let (least, most) = expected.unwrap_or((low, high));
                expected = Some((least.min(low), most.max(high)));
            }
            prop_assert_eq!(grid.bounds_vx(), expected);
        }

        #[test]
        fn counts_and_occupancy_follow_the_bits(
            dims in prop::array::uniform3(1u32..40),
            edits in prop::collection::vec((prop::array::uniform3(-2i32..42), any::<bool>()), 0..200),
        ) {
            let mut grid = small_grid(UVec3::from(dims));
            let mut naive = std::collections::HashSet::new();
            for (v, on) in edits {
                let v = IVec3::from(v);
                grid.set(v, on);
                if grid.contains(v) { if on { naive.insert(v); } else { naive.remove(&v); } }
            }
            prop_assert_eq!(grid.opaque_count(), naive.len() as u64);
            check(&grid);
            for index in 0..grid.brick_count() {
                let brick = grid.brick_at(index);
                prop_assert_eq!(brick.and_not(&grid.valid_mask(grid.brick_coords(index))), Brick::EMPTY);
            }
            let low = naive.iter().copied().reduce(IVec3::min);
            let high = naive.iter().copied().reduce(IVec3::max);
            let bounds = low.zip(high).map(|(l, h)| (l.as_uvec3(), h.as_uvec3() + 1));
            prop_assert_eq!(grid.opaque_bounds(), bounds);
            for v in naive { prop_assert!(grid.get(v)); }
            let mut copy = small_grid(grid.dims());
            copy.fill_bricks(|b| *grid.brick(b));
            prop_assert_eq!(copy, grid);
        }
    }
}
