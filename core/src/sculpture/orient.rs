//! Rotates and mirrors whole sculptures by an [`Orientation`].
//!
//! Takes contents and gives new ones, with sizes, voxels and colours in the new orientation. Cubes of the grid's tree
//! whose source is uniform are turned as a whole, all others brick by brick: the source of each voxel within a brick is
//! the same for all bricks, so one table of 512 entries serves them all. Memory is checked before it is allocated. Knows
//! no document.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;
use thiserror::Error;

use super::brick::{BRICK_EDGE_VX, BRICK_VOXELS, Brick, BrickKind, local_coords, local_index};
use super::contents::Contents;
use super::grid::{LEAF_EDGE_LOG2, uniform_in};
use super::material::{MAX_PAGE_BYTES, Page, PageView};
use super::orientation::Orientation;
use super::region::BrickBox;
use super::{Grid, GridError, Limits, Material};
use crate::progress::Progress;
use crate::refusal::{MemoryBudget, OverBudget};

/// Bricks in a leaf of the tree, and leaves between two reports of progress.
const LEAF_BRICKS: usize = 1 << (3 * LEAF_EDGE_LOG2);
const LEAVES_PER_REPORT: usize = 64;

/// Why a sculpture cannot be reoriented.
#[derive(Debug, Error)]
pub enum OrientError {
    /// The new grid is not possible.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The colours would not fit into [`Limits::colour_bytes`].
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// A prepared reorientation of a sculpture.
pub struct Reorientation<'a> {
    from: &'a Contents,
    orientation: Orientation,
    /// The source of each voxel of a brick: the index in its brick, plus 512 times the number of that brick among the
    /// up to eight that the new one overlaps.
    sources: Box<[u16]>,
    /// The numbers that occur in `sources`, as bits.
    overlapped: u8,
    /// A page of the base colour, in place of absent ones.
    base_page: Page,
}

impl<'a> Reorientation<'a> {
    /// Prepares the reorientation of `from`.
    pub fn new(from: &'a Contents, orientation: Orientation) -> Reorientation<'a> {
        let (dims, brick_dims) = (from.grid.dims(), from.grid.brick_dims());
        // The former upper border of a reversed axis begins the first brick. So bricks overlap two on that axis unless
        // the size is a multiple of the brick's.
        let first = orientation.source(IVec3::ZERO, brick_dims) * BRICK_EDGE_VX as i32;
        let mut overlapped = 0;
        let sources = (0..BRICK_VOXELS).map(|local| {
            let v = UVec3::from(local_coords(local)).as_ivec3();
            let delta = orientation.source(v, dims) - first;
            let before = delta.cmplt(IVec3::ZERO);
            overlapped |= 1 << before.bitmask();
            let [x, y, z] = delta.rem_euclid(IVec3::splat(8)).as_uvec3().to_array();
            (before.bitmask() * BRICK_VOXELS + local_index(x, y, z)) as u16
        });
        let sources = sources.collect();
        Reorientation {
            from,
            orientation,
            sources,
            overlapped,
            base_page: from.material.base_page(),
        }
    }

    /// Returns whether the inverse orientation restores every byte: bricks become bricks, or there are no pages of
    /// colours that could be divided differently.
    pub(crate) fn is_exact(&self) -> bool {
        self.overlapped == 1 || self.from.material.page_count() == 0
    }

    fn dims(&self) -> UVec3 {
        self.orientation.size(self.from.grid.dims())
    }

    /// Reorients the sculpture.
    ///
    /// # Errors
    /// If the result needs more memory than `limits` allow, or `progress` is cancelled.
    pub fn run(&self, limits: &Limits, progress: &dyn Progress) -> Result<Contents, OrientError> {
        let Contents { grid, material, mask, surface, frame } = self.from;
        let voxel_size = Vec3::from(self.orientation.permuted(grid.voxel_size().to_array()));
        Grid::check_size(self.dims(), voxel_size)?;
        self.check_bits_memory(limits.grid_bytes)?;
        let mut colours = Material::new(material.depth(), material.base(), self.dims());
        self.check_colour_memory(&colours, limits.colour_bytes)?;
        let mut turned = Grid::of_size(self.dims(), voxel_size)?;

        progress.begin("rotating the voxels");
        let (leaves, begun) = (turned.brick_count().div_ceil(LEAF_BRICKS), AtomicUsize::new(0));
        let whole = |bricks: BrickBox| {
            if progress.is_cancelled() {
                return Some(false);
            }
            let is_full = uniform_in(grid, self.source_box(bricks));
            if is_full.is_none() && (bricks.max - bricks.min).max_element() <= 1 << LEAF_EDGE_LOG2 {
                let before = begun.fetch_add(1, Ordering::Relaxed);
                if before % LEAVES_PER_REPORT == 0 {
                    progress.advance((before as f32 / leaves as f32).min(1.0));
                }
            }
            is_full
        };
        turned.fill_cubes(whole, |b| self.brick(b));
        progress.end();
        if material.page_count() > 0 {
            progress.begin("rotating the colours");
            let leaves = self.painted_leaves();
            for (at, portion) in leaves.chunks(LEAVES_PER_REPORT).enumerate() {
                if progress.is_cancelled() {
                    break;
                }
                progress.advance((at * LEAVES_PER_REPORT) as f32 / leaves.len() as f32);
                let bricks = portion.par_iter().flat_map_iter(|leaf| bricks_of(*leaf));
                let page = |b: UVec3| self.page(b).map(|page| (b, page));
                colours.set_pages(bricks.filter_map(page).collect());
            }
            progress.end();
        }
        match progress.is_cancelled() {
            true => Err(OrientError::Cancelled),
            false => {
                let frame = frame.oriented(self.orientation, grid.dims());
                let laid = Contents::new(turned, colours);
                let mut laid = Contents { surface: *surface, frame, ..laid };
                if let Some(mask) = mask {
                    let bits = Contents::of_bits((**mask).clone());
                    let turned = Reorientation::new(&bits, self.orientation).run(limits, &())?;
                    laid.mask = Some(Box::new(turned.grid));
                }
                Ok(laid)
            }
        }
    }

    /// Returns the bricks that hold the source of all voxels of a box of new bricks.
    fn source_box(&self, bricks: BrickBox) -> BrickBox {
        let dims = self.from.grid.brick_dims();
        let source = |b: UVec3| self.orientation.source(b.as_ivec3(), dims);
        let (a, b) = (source(bricks.min), source(bricks.max - 1));
        // Whether bricks overlap two on an axis.
        let numbers = [0b1010_1010, 0b1100_1100, 0b1111_0000];
        let before = numbers.map(|numbers| i32::from(self.overlapped & numbers != 0));
        let min = (a.min(b) - IVec3::from(before)).max(IVec3::ZERO);
        BrickBox { min: min.as_uvec3(), max: (a.max(b) + 1).as_uvec3() }
    }

    /// Returns the bricks of the new leaves in which colours may be painted, leaf by leaf.
    fn painted_leaves(&self) -> Vec<BrickBox> {
        let max = self.orientation.size(self.from.grid.brick_dims());
        let mut leaves = Vec::new();
        self.add_painted_leaves(BrickBox { min: UVec3::ZERO, max }, &mut leaves);
        leaves
    }

    /// Adds the painted leaves of a box that begins at the corner of one, by halves.
    fn add_painted_leaves(&self, bricks: BrickBox, leaves: &mut Vec<BrickBox>) {
        let BrickBox { min, max } = bricks;
        if !self.from.material.is_painted_in(self.source_box(bricks)) {
            return;
        }
        let size = (max - min).to_array();
        let axis = (0..3).max_by_key(|axis| size[*axis]).unwrap_or(0);
        let edge = 1 << LEAF_EDGE_LOG2;
        if size[axis] <= edge {
            leaves.push(bricks);
            return;
        }
        let middle = min[axis] + (size[axis].div_ceil(edge) / 2) * edge;
        let (mut low, mut high) = (bricks, bricks);
        (low.max[axis], high.min[axis]) = (middle, middle);
        self.add_painted_leaves(low, leaves);
        self.add_painted_leaves(high, leaves);
    }

    /// Returns the bricks that the new brick at `b` overlaps, by their numbers; `None` beyond the border.
    fn overlapped_bricks(&self, b: UVec3) -> [Option<UVec3>; 8] {
        let grid = &self.from.grid;
        let last = self.orientation.source(b.as_ivec3(), grid.brick_dims());
        std::array::from_fn(|number| {
            if self.overlapped >> number & 1 == 0 {
                return None;
            }
            let before = IVec3::new(number as i32 & 1, number as i32 >> 1 & 1, number as i32 >> 2);
            let at = last - before;
            at.cmpge(IVec3::ZERO).all().then(|| at.as_uvec3())
        })
    }

    fn brick(&self, b: UVec3) -> Brick {
        let grid = &self.from.grid;
        let overlapped = self.overlapped_bricks(b);
        let all_are = |wanted: BrickKind| {
            let mut known = overlapped.iter().flatten();
            known.all(|&at| grid.brick_kind(grid.brick_index(at)) == wanted)
        };
        if all_are(BrickKind::Empty) {
            return Brick::EMPTY;
        }
        // The part beyond the border is cut off in any case.
        if all_are(BrickKind::Full) {
            return Brick::FULL;
        }
        let brick = |at: Option<UVec3>| at.map_or(Brick::EMPTY, |at| *grid.brick(at));
        let from = overlapped.map(brick);
        let mut turned = Brick::EMPTY;
        for (word, sources) in turned.words.iter_mut().zip(self.sources.as_chunks::<64>().0) {
            for (bit, &source) in sources.iter().enumerate() {
                let source = usize::from(source);
                let bits = from[source >> 9].words[source >> 6 & 7];
                *word |= (bits >> (source & 63) & 1) << bit;
            }
        }
        turned
    }

    /// Returns the colours of a new brick; `None` if all have the base colour.
    fn page(&self, b: UVec3) -> Option<Page> {
        match self.from.material.depth().bytes() {
            0 => None,
            1 => self.page_of::<1>(b),
            2 => self.page_of::<2>(b),
            _ => self.page_of::<3>(b),
        }
    }

    /// Performs [`Self::page`] for colours of `B` bytes.
    fn page_of<const B: usize>(&self, b: UVec3) -> Option<Page> {
        let material = &self.from.material;
        let depth = material.depth();
        let pages = self.overlapped_bricks(b).map(|at| at.and_then(|at| material.page(at)));
        let first = pages.iter().flatten().next()?;
        // One brick, or several, of one colour.
        let is_one = |number: usize| {
            let page = pages[number].filter(|page| page.uniform().is_some());
            self.overlapped >> number & 1 == 0 || page == Some(*first)
        };
        let is_kept = self.overlapped == 1 || *first != PageView::of(&self.base_page, depth);
        if (0..8).all(is_one) {
            return is_kept.then(|| first.to_page());
        }
        let mut buffers = [[0; MAX_PAGE_BYTES]; 8];
        for (buffer, page) in buffers.iter_mut().zip(&pages) {
            page.unwrap_or(PageView::of(&self.base_page, depth)).write_to(buffer);
        }
        let from = buffers.each_ref().map(|buffer| buffer.as_chunks::<B>().0);
        let mut turned = [0; MAX_PAGE_BYTES];
        let turned = &mut turned[..material.page_bytes()];
        for (out, &source) in turned.as_chunks_mut::<B>().0.iter_mut().zip(&self.sources) {
            *out = from[usize::from(source >> 9)][usize::from(source & 511)];
        }
        let turned = Page::of_bytes(turned, depth);
        // A page that is moved as a whole is kept whatever its colours, so that the inverse is exact.
        (self.overlapped == 1 || turned != self.base_page).then_some(turned)
    }

    /// Refuses a result whose colours would take more memory than allowed. Counts the pages one by one only if an upper
    /// bound exceeds the budget.
    fn check_bits_memory(&self, budget: u64) -> Result<(), OrientError> {
        let most = self.from.grid.heap_bytes().saturating_mul(self.overlapped.count_ones().into());
        let needed = most.min(Grid::bytes_for(self.dims()));
        let what = "the rotated sculpture may need";
        Ok(OverBudget::check(what, needed, MemoryBudget::Grids, budget).map_err(GridError::from)?)
    }

    fn check_colour_memory(&self, colours: &Material, budget: u64) -> Result<(), OrientError> {
        let painted = self.from.material.page_count() as u64;
        let bricks = self.from.grid.brick_count();
        let most = (painted * u64::from(self.overlapped.count_ones())).min(bricks as u64);
        if painted == 0 || colours.bytes_for_pages(most, u64::MAX) <= budget {
            return Ok(());
        }
        let bytes = |b: UVec3| self.page(b).map(|page| (1, page.heap_bytes() as u64));
        let add = |(a, b): (u64, u64), (c, d): (u64, u64)| (a + c, b + d);
        let leaves = self.painted_leaves();
        let all = leaves.par_iter().flat_map_iter(|leaf| bricks_of(*leaf));
        let (pages, bytes) = all.filter_map(bytes).reduce(|| (0, 0), add);
        let needed = colours.bytes_for_pages(pages, bytes);
        if needed <= budget {
            return Ok(());
        }
        Err(OverBudget::new("this needs", needed, MemoryBudget::Colours, budget).into())
    }
}

/// Returns the bricks of a box.
fn bricks_of(bricks: BrickBox) -> impl Iterator<Item = UVec3> {
    let BrickBox { min, max } = bricks;
    (min.z..max.z).flat_map(move |z| {
        (min.y..max.y).flat_map(move |y| (min.x..max.x).map(move |x| UVec3::new(x, y, z)))
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::sculpture::brick_set::BrickSet;
    use crate::sculpture::edit::{EditOp, edit};
    use crate::sculpture::region::VoxelBox;
    use crate::sculpture::stroke::StrokeRecorder;
    use crate::sculpture::{ColourDepth, Rgb};

    /// Returns voxels and colours scattered by a simple rule, with some colours where there is no voxel.
    fn scattered(dims: UVec3, depth: ColourDepth, salt: u32) -> Contents {
        let mut grid = Grid::new(dims, Vec3::new(1.0, 2.0, 3.0), 1 << 30).unwrap();
        let mut material = Material::new(depth, Rgb::STONE, dims);
        let hash = |v: UVec3| {
            let mixed = v.x.wrapping_mul(0x9E37_79B1) ^ v.y.wrapping_mul(0x85EB_CA77);
            (mixed ^ v.z.wrapping_mul(0xC2B2_AE3D) ^ salt).wrapping_mul(0x27D4_EB2F) >> 16
        };
        grid.fill_bricks(|b| match hash(b) % 4 {
            0 => Brick::EMPTY,
            1 => Brick::FULL,
            _ => Brick { words: std::array::from_fn(|i| u64::from(hash(b * 8 + i as u32)) << 9) },
        });
        for at in (0..grid.brick_count()).filter(|at| at % 3 != 1) {
            let b = grid.brick_coords(at);
            let valid = grid.valid_mask(b);
            let colour = |local: u32| {
                let [r, g, ..] = hash(b * 8 + UVec3::from(local_coords(local))).to_le_bytes();
                Rgb([r, g, 7])
            };
            material.paint_each(b, &valid, colour);
        }
        Contents::new(grid, material)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        /// Compares with the definition, voxel by voxel, in all 48 orientations, and with their inverses.
        #[test]
        fn voxels_colours_and_sizes_follow_the_axes(
            dims in prop::array::uniform3(prop_oneof![1u32..30, Just(8), Just(16)]),
            depth in prop::sample::select(&ColourDepth::ALL[..]),
            salt: u32,
        ) {
            let dims = UVec3::from(dims);
            let from = scattered(dims, depth, salt);
            for orientation in Orientation::all() {
                let reorientation = Reorientation::new(&from, orientation);
                let turned = reorientation.run(&Limits::default(), &()).unwrap();
                prop_assert_eq!(turned.grid.dims(), orientation.size(dims));
                let size = orientation.permuted([1.0, 2.0, 3.0]);
                prop_assert_eq!(turned.grid.voxel_size(), Vec3::from(size));
                for index in 0..dims.element_product() {
                    let v = turned.grid.voxel_coords(index);
                    let source = orientation.source(v.as_ivec3(), dims);
                    prop_assert_eq!(turned.grid.get(v.as_ivec3()), from.grid.get(source));
                    prop_assert_eq!(turned.rgb(v), from.rgb(source.as_uvec3()));
                }
                prop_assert_eq!(turned.grid.opaque_count(), from.grid.opaque_count());
                // Equal to the bit in everything that a grid stores about its bricks.
                let mut counted = turned.grid.clone();
                counted.fill_bricks(|b| *turned.grid.brick(b));
                prop_assert_eq!(&counted, &turned.grid);

                let back = Reorientation::new(&turned, orientation.inverse());
                let back = back.run(&Limits::default(), &()).unwrap();
                prop_assert_eq!(&back.grid, &from.grid);
                if reorientation.is_exact() {
                    prop_assert_eq!(&back.material, &from.material);
                }
            }
        }
    }

    /// Returns a grid with large uniform cubes: full, but for some boxes.
    fn carved(dims: UVec3, boxes: &[([u32; 3], u32)]) -> Grid {
        let mut contents = Contents::of_bits(Grid::new(dims, Vec3::ONE, 1 << 32).unwrap());
        contents.grid.fill_bricks(|_| Brick::FULL);
        let (mut recorder, mut dirty) = (StrokeRecorder::default(), BrickSet::default());
        for (corner, edge) in boxes {
            let min = (UVec3::from(*corner) % dims).as_ivec3();
            let cube = VoxelBox { min, max: min + *edge as i32 };
            edit(&mut contents, &cube, EditOp::Subtract, &mut recorder, &mut dirty);
        }
        contents.grid
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8))]
        /// Compares all bricks, in sizes of several leaves and nodes.
        #[test]
        fn large_uniform_cubes_turn_as_their_bricks_do(
            dims in prop::sample::select(&[
                [700u32, 3, 70], [64, 640, 8], [128, 130, 200], [1, 1, 1030], [520, 96, 64], [513, 70, 9],
            ][..]),
            boxes in prop::collection::vec((prop::array::uniform3(0u32..1100), 1u32..90), 0..5),
            painted in prop::collection::vec((prop::array::uniform3(0u32..200), 1u8..3), 0..4),
            orientation in 0usize..48,
        ) {
            let dims = UVec3::from(dims);
            let grid = carved(dims, &boxes);
            let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
            for (corner, colour) in painted {
                let leaf = UVec3::from(corner) % grid.brick_dims() / 8 * 8;
                let end = (leaf + 8).min(grid.brick_dims());
                let inside = bricks_of(BrickBox { min: leaf, max: end });
                let mask = if colour == 1 { Brick::FULL } else { Brick { words: [0xFF; 8] } };
                inside.for_each(|b| material.paint(b, &mask, Rgb::new(90 * colour, 1, 2)));
            }
            let from = Contents::new(grid, material);
            let orientation = Orientation::all().nth(orientation).unwrap();
            let reorientation = Reorientation::new(&from, orientation);
            let turned = reorientation.run(&Limits::default(), &()).unwrap();
            let mut counted = turned.grid.emptied();
            counted.fill_bricks(|b| reorientation.brick(b));
            prop_assert_eq!(&counted, &turned.grid);
            prop_assert_eq!(turned.grid.opaque_count(), from.grid.opaque_count());
            let mut colours = Material::new(ColourDepth::Bits24, Rgb::STONE, turned.grid.dims());
            let all = BrickBox { min: UVec3::ZERO, max: turned.grid.brick_dims() };
            colours.set_pages(bricks_of(all).filter_map(|b| Some((b, reorientation.page(b)?))).collect());
            prop_assert_eq!(&colours, &turned.material);
        }
    }

    #[test]
    fn pages_are_counted_before_they_are_made() {
        // One brick is painted; after mirroring, its voxels lie in two.
        let mut from = scattered(UVec3::new(20, 8, 8), ColourDepth::Bits24, 1);
        (0..3).for_each(|x| drop(from.material.set_page(UVec3::new(x, 0, 0), None)));
        from.material.paint(UVec3::X, &Brick::FULL, Rgb::new(1, 2, 3));
        let mirror = Reorientation::new(&from, Orientation::mirroring(0));
        assert!(!mirror.is_exact());
        let turned = mirror.run(&Limits::default(), &()).unwrap();
        assert_eq!(turned.material.page_count(), 2);
        let needed = turned.material.heap_bytes();
        let limits = |colour_bytes| Limits { colour_bytes, ..Limits::default() };
        assert!(mirror.run(&limits(needed), &()).is_ok());
        let refused = mirror.run(&limits(needed - 1), &());
        assert!(matches!(
            refused,
            Err(OrientError::OverBudget(OverBudget { budget: MemoryBudget::Colours, .. }))
        ));
        let refused = mirror.run(&Limits { grid_bytes: 1, ..Limits::default() }, &());
        assert!(matches!(
            refused,
            Err(OrientError::Grid(GridError::OverBudget(OverBudget {
                budget: MemoryBudget::Grids,
                ..
            })))
        ));

        // Along an axis of whole bricks, nothing is divided.
        assert!(Reorientation::new(&from, Orientation::mirroring(1)).is_exact());
        assert!(Reorientation::new(&from, Orientation::quarter_turn(0)).is_exact());
    }

    #[test]
    fn cancelled_work_gives_nothing() {
        let report = crate::progress::ProgressReport::default();
        report.cancel();
        let from = scattered(UVec3::splat(16), ColourDepth::Bits8, 3);
        let result = Reorientation::new(&from, Orientation::mirroring(2));
        assert!(matches!(result.run(&Limits::default(), &report), Err(OrientError::Cancelled)));
    }
}
