//! Regions: sets of voxels as edits query them. A region has a bounding box. For each row of bricks along x, it tells
//! which bricks it touches, which it covers entirely, and which voxels of the others. For any box of voxels, it tells
//! whether it covers all or none of them, as far as that can be known without examining them.
//!
//! The unit is a row because solids are convex: the values that decide the 64 rows of voxels in a row of bricks are
//! computed once, and the bricks in the middle are then known without examining them. Knows no tool.

use std::ops::Range;

use fearless_simd::Simd;
use glam::{IVec3, UVec3};

use super::brick::{BRICK_EDGE_VX, Brick};
use super::grid::Grid;

/// A half-open box of voxels, `min` inclusive and `max` exclusive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VoxelBox {
    /// Lowest voxel.
    pub min: IVec3,
    /// One past the highest voxel.
    pub max: IVec3,
}

impl VoxelBox {
    /// Returns all voxels of `grid`.
    pub fn of_grid(grid: &Grid) -> VoxelBox {
        VoxelBox { min: IVec3::ZERO, max: grid.dims().as_ivec3() }
    }

    /// Returns the voxels in both; empty if there are none.
    pub fn intersect(self, other: VoxelBox) -> VoxelBox {
        VoxelBox { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Returns the box moved by a number of voxels.
    pub fn shifted(self, by: IVec3) -> VoxelBox {
        VoxelBox { min: self.min.saturating_add(by), max: self.max.saturating_add(by) }
    }

    /// Returns whether the box holds no voxel.
    pub fn is_empty(self) -> bool {
        !self.min.cmplt(self.max).all()
    }

    /// Returns the size in voxels; 0 on an axis where `max` is below `min`.
    pub fn size(self) -> UVec3 {
        self.max.saturating_sub(self.min).max(IVec3::ZERO).as_uvec3()
    }

    /// Returns its voxels in the brick at `b`.
    pub fn in_brick(self, b: UVec3) -> Brick {
        let edge = BRICK_EDGE_VX as i32;
        let first = b.as_ivec3() * edge;
        let local = |v: IVec3| (v - first).clamp(IVec3::ZERO, IVec3::splat(edge)).as_uvec3();
        let (low, high) = (local(self.min), local(self.max));
        let below = (0..3).fold(Brick::EMPTY, |below, axis| {
            let mut limit = [BRICK_EDGE_VX; 3];
            limit[axis] = low[axis];
            below.or(&Brick::below(limit))
        });
        Brick::below(high.to_array()).and_not(&below)
    }

    /// Returns whether the voxel `v` is in the box.
    pub fn contains(self, v: IVec3) -> bool {
        v.cmpge(self.min).all() && v.cmplt(self.max).all()
    }
}

/// How a region covers a box of voxels.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BoxCoverage {
    /// None of the voxels.
    None,
    /// Some of them, or unknown.
    Part,
    /// All of them.
    All,
}

impl BoxCoverage {
    /// Returns the coverage of the same box by the voxels outside of the region.
    pub fn inverse(self) -> BoxCoverage {
        match self {
            BoxCoverage::None => BoxCoverage::All,
            BoxCoverage::Part => BoxCoverage::Part,
            BoxCoverage::All => BoxCoverage::None,
        }
    }

    /// Returns the coverage by the voxels that are in two regions.
    pub fn and(self, other: BoxCoverage) -> BoxCoverage {
        match (self, other) {
            (BoxCoverage::None, _) | (_, BoxCoverage::None) => BoxCoverage::None,
            (BoxCoverage::All, BoxCoverage::All) => BoxCoverage::All,
            _ => BoxCoverage::Part,
        }
    }

    /// Returns the coverage by the voxels that are in either of two regions.
    pub fn or(self, other: BoxCoverage) -> BoxCoverage {
        self.inverse().and(other.inverse()).inverse()
    }
}

/// The part of a row's bricks that a box covers on y and z, in voxels of the brick: 0 to 8.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct BoxRow {
    low: [u32; 2],
    high: [u32; 2],
}

impl Region for VoxelBox {
    type Row = BoxRow;

    fn bounds_vx(&self) -> VoxelBox {
        *self
    }

    fn cut_row<S: Simd>(&self, _: S, y_vx: u32, z_vx: u32, row: &mut BoxRow) -> RowReach {
        let edge = BRICK_EDGE_VX as i32;
        let local = |v: i32, origin: u32| v.saturating_sub(origin as i32).clamp(0, edge) as u32;
        row.low = [local(self.min.y, y_vx), local(self.min.z, z_vx)];
        row.high = [local(self.max.y, y_vx), local(self.max.z, z_vx)];
        let (from, to) = (self.min.x.max(0) as u32, self.max.x.max(0) as u32);
        if from >= to || row.low[0] >= row.high[0] || row.low[1] >= row.high[1] {
            return RowReach::NONE;
        }
        let touched = from / BRICK_EDGE_VX..to.div_ceil(BRICK_EDGE_VX);
        let whole = from.div_ceil(BRICK_EDGE_VX)..to / BRICK_EDGE_VX;
        let across = row.low == [0; 2] && row.high == [BRICK_EDGE_VX; 2];
        let whole = if across && !whole.is_empty() { whole } else { 0..0 };
        RowReach { touched, whole }
    }

    fn mask<S: Simd>(&self, _: S, row: &BoxRow, _: &RowReach, brick_x: u32) -> Brick {
        let origin = (brick_x * BRICK_EDGE_VX) as i32;
        let edge = BRICK_EDGE_VX as i32;
        let low = self.min.x.saturating_sub(origin).clamp(0, edge) as u32;
        let high = self.max.x.saturating_sub(origin).clamp(0, edge) as u32;
        let all = BRICK_EDGE_VX;
        Brick::below([high, row.high[0], row.high[1]])
            .and_not(&Brick::below([low, all, all]))
            .and_not(&Brick::below([all, row.low[0], all]))
            .and_not(&Brick::below([all, all, row.low[1]]))
    }

    fn coverage(&self, bounds: VoxelBox) -> BoxCoverage {
        match bounds.intersect(*self) {
            both if both.is_empty() => BoxCoverage::None,
            both if both == bounds => BoxCoverage::All,
            _ => BoxCoverage::Part,
        }
    }
}

/// A half-open box of bricks of one grid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BrickBox {
    /// Lowest brick coordinates.
    pub min: UVec3,
    /// One past the highest brick coordinates.
    pub max: UVec3,
}

impl BrickBox {
    /// Returns the bricks of `grid` within the bounds of `region`, if there are any.
    pub fn around(region: &impl Region, grid: &Grid) -> Option<BrickBox> {
        let bounds = region.bounds_vx().intersect(VoxelBox::of_grid(grid));
        (!bounds.is_empty()).then(|| BrickBox {
            min: bounds.min.as_uvec3() / BRICK_EDGE_VX,
            max: (bounds.max.as_uvec3() + (BRICK_EDGE_VX - 1)) / BRICK_EDGE_VX,
        })
    }

    /// Returns the voxels of the bricks, those beyond a grid's border included.
    pub fn voxels(self) -> VoxelBox {
        let edge = BRICK_EDGE_VX;
        VoxelBox { min: (self.min * edge).as_ivec3(), max: (self.max * edge).as_ivec3() }
    }

    /// Returns the number of bricks in the box.
    pub fn brick_count(self) -> u64 {
        (self.max - self.min).as_u64vec3().element_product()
    }
}

/// How a region covers the bricks of a row. Bricks are named by their brick coordinate along x; they may lie beyond the
/// grid's border.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RowReach {
    /// Bricks outside of this range are not covered at all.
    pub touched: Range<u32>,
    /// Bricks in this range are covered entirely. Empty, or within `touched`.
    pub whole: Range<u32>,
}

impl RowReach {
    /// No brick of the row is covered.
    pub const NONE: RowReach = RowReach { touched: 0..0, whole: 0..0 };
}

/// A set of voxels that is queried by rows of bricks, with vector instructions chosen for the whole edit.
pub trait Region: Sync {
    /// Values computed once for a row of bricks along x; their memory is reused for the next row.
    type Row: Default;

    /// Returns a box outside which the region covers nothing (it may extend beyond the grid).
    fn bounds_vx(&self) -> VoxelBox;

    /// Intersects the region with the row of bricks whose lower edge runs along x at voxel coordinates `y_vx`, `z_vx`.
    fn cut_row<S: Simd>(&self, simd: S, y_vx: u32, z_vx: u32, row: &mut Self::Row) -> RowReach;

    /// Returns the covered voxels of a touched brick of the row passed to [`Region::cut_row`] last. May include voxels
    /// beyond the grid's border.
    fn mask<S: Simd>(&self, simd: S, row: &Self::Row, reach: &RowReach, brick_x: u32) -> Brick;

    /// Returns how the region covers the voxels of `bounds`, which may lie anywhere. `Part` is always allowed. `None` and
    /// `All` hold for every voxel that a grid contains; as in masks, those beyond its border may count as covered. An
    /// empty box is not covered.
    fn coverage(&self, bounds: VoxelBox) -> BoxCoverage;
}

/// A region of all voxels.
pub struct Everywhere;

impl Region for Everywhere {
    type Row = ();

    fn bounds_vx(&self) -> VoxelBox {
        VoxelBox { min: IVec3::ZERO, max: IVec3::MAX }
    }

    fn cut_row<S: Simd>(&self, _: S, _: u32, _: u32, (): &mut ()) -> RowReach {
        RowReach { touched: 0..u32::MAX, whole: 0..u32::MAX }
    }

    fn mask<S: Simd>(&self, _: S, (): &(), _: &RowReach, _: u32) -> Brick {
        Brick::FULL
    }

    fn coverage(&self, bounds: VoxelBox) -> BoxCoverage {
        if bounds.is_empty() { BoxCoverage::None } else { BoxCoverage::All }
    }
}

/// A region of listed bricks, each with the voxels covered.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ListedBricks {
    /// Brick coordinates and masks, x fastest, then y, then z; each brick at most once.
    bricks: Vec<(UVec3, Brick)>,
}

impl ListedBricks {
    /// Takes bricks in the order x fastest, then y, then z, each at most once.
    pub fn new(bricks: Vec<(UVec3, Brick)>) -> ListedBricks {
        debug_assert!(bricks.is_sorted_by_key(|(b, _)| (b.z, b.y, b.x)));
        ListedBricks { bricks }
    }

    /// Returns the brick coordinates and masks, x fastest, then y, then z.
    pub fn bricks(&self) -> &[(UVec3, Brick)] {
        &self.bricks
    }

    /// Returns the voxels that are in any of `lists`.
    pub fn union(lists: impl IntoIterator<Item = ListedBricks>) -> ListedBricks {
        let mut bricks: Vec<(UVec3, Brick)> = lists.into_iter().flat_map(|l| l.bricks).collect();
        bricks.sort_by_key(|(b, _)| (b.z, b.y, b.x));
        bricks.dedup_by(|(next, mask), (b, all)| {
            *next == *b && {
                *all = all.or(mask);
                true
            }
        });
        ListedBricks { bricks }
    }

    /// Returns the position of the first listed brick of a box that has a voxel.
    fn first_in(&self, inside: BrickBox) -> Option<usize> {
        let BrickBox { min, max } = inside;
        let mut at = 0;
        loop {
            let (b, mask) = self.bricks.get(at)?;
            // The first brick of the box, in the order of the list, that can follow.
            let next = match () {
                _ if b.z >= max.z => return None,
                _ if b.z < min.z => min,
                _ if b.y < min.y => UVec3::new(min.x, min.y, b.z),
                _ if b.y >= max.y => UVec3::new(min.x, min.y, b.z + 1),
                _ if b.x < min.x => UVec3::new(min.x, b.y, b.z),
                _ if b.x >= max.x => UVec3::new(min.x, b.y + 1, b.z),
                _ if mask.is_empty() => UVec3::new(b.x + 1, b.y, b.z),
                () => return Some(at),
            };
            let next = (next.z, next.y, next.x);
            at += self.bricks[at..].partition_point(|(b, _)| (b.z, b.y, b.x) < next);
        }
    }

    /// Returns whether all bricks of a box are listed with all their voxels.
    fn fills(&self, inside: BrickBox) -> bool {
        let BrickBox { min, max } = inside;
        let mut rows = (min.z..max.z).flat_map(|z| (min.y..max.y).map(move |y| (z, y)));
        inside.brick_count() <= self.bricks.len() as u64
            && rows.all(|(z, y)| {
                let start = self.bricks.partition_point(|(b, _)| (b.z, b.y, b.x) < (z, y, min.x));
                let mut row = self.bricks[start..].iter().zip(min.x..max.x);
                let is_whole = |((b, mask), x): (&(UVec3, Brick), u32)| {
                    *b == UVec3::new(x, y, z) && mask.is_full()
                };
                row.len() == (max.x - min.x) as usize && row.all(is_whole)
            })
    }
}

impl Region for ListedBricks {
    /// The position of the row's bricks in the list.
    type Row = Range<usize>;

    fn bounds_vx(&self) -> VoxelBox {
        let low = self.bricks.iter().map(|(b, _)| *b).reduce(UVec3::min);
        let high = self.bricks.iter().map(|(b, _)| *b).reduce(UVec3::max);
        let (low, high) = low.zip(high).map_or_else(Default::default, |(l, h)| (l, h + 1));
        VoxelBox { min: (low * BRICK_EDGE_VX).as_ivec3(), max: (high * BRICK_EDGE_VX).as_ivec3() }
    }

    fn cut_row<S: Simd>(&self, _: S, y_vx: u32, z_vx: u32, row: &mut Range<usize>) -> RowReach {
        let wanted = (z_vx / BRICK_EDGE_VX, y_vx / BRICK_EDGE_VX);
        let start = self.bricks.partition_point(|(b, _)| (b.z, b.y) < wanted);
        let end = self.bricks.partition_point(|(b, _)| (b.z, b.y) <= wanted);
        *row = start..end;
        match &self.bricks[start..end] {
            [] => RowReach::NONE,
            [(first, _), ..] => {
                let last = self.bricks[end - 1].0;
                RowReach { touched: first.x..last.x + 1, whole: 0..0 }
            }
        }
    }

    fn mask<S: Simd>(&self, _: S, row: &Range<usize>, _: &RowReach, brick_x: u32) -> Brick {
        let bricks = &self.bricks[row.clone()];
        let found = bricks.binary_search_by_key(&brick_x, |(b, _)| b.x);
        found.map_or(Brick::EMPTY, |at| bricks[at].1)
    }

    fn coverage(&self, bounds: VoxelBox) -> BoxCoverage {
        // No brick lies below 0.
        let (low, high) = (bounds.min.max(IVec3::ZERO), bounds.max.max(IVec3::ZERO));
        if !low.cmplt(high).all() {
            return BoxCoverage::None;
        }
        let edge = UVec3::splat(BRICK_EDGE_VX);
        let high = high.as_uvec3().map(|v| v.div_ceil(BRICK_EDGE_VX));
        let inside = BrickBox { min: low.as_uvec3() / edge, max: high };
        match self.first_in(inside) {
            None => BoxCoverage::None,
            Some(_) if low == bounds.min && self.fills(inside) => BoxCoverage::All,
            Some(_) => BoxCoverage::Part,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::sculpture::brick::local_coords;

    fn cube(min: i32, max: i32) -> VoxelBox {
        VoxelBox { min: IVec3::splat(min), max: IVec3::splat(max) }
    }

    #[test]
    fn a_box_covers_boxes_inside_and_none_beside_it() {
        let region = cube(-16, 64);
        for (bounds, coverage) in [
            (cube(-16, 64), BoxCoverage::All),
            (cube(-8, 0), BoxCoverage::All),
            (cube(-17, 0), BoxCoverage::Part),
            (cube(56, 65), BoxCoverage::Part),
            (cube(64, 72), BoxCoverage::None),
            (cube(-24, -16), BoxCoverage::None),
            (cube(8, 8), BoxCoverage::None),
            (cube(9, 8), BoxCoverage::None),
            (cube(i32::MIN, i32::MAX), BoxCoverage::Part),
        ] {
            assert_eq!(region.coverage(bounds), coverage, "{bounds:?}");
        }
        let all = cube(i32::MIN, i32::MAX);
        assert_eq!(all.coverage(all), BoxCoverage::All);
        assert_eq!(cube(5, 5).coverage(all), BoxCoverage::None);
        assert_eq!(Everywhere.coverage(all), BoxCoverage::All);
        assert_eq!(Everywhere.coverage(cube(-4096, 0)), BoxCoverage::All);
        assert_eq!(Everywhere.coverage(cube(3, 3)), BoxCoverage::None);
    }

    #[test]
    fn coverages_combine_like_sets() {
        use BoxCoverage::{All, None, Part};
        for a in [None, Part, All] {
            assert_eq!((a.and(None), a.and(All)), (None, a));
            assert_eq!((a.or(None), a.or(All)), (a, All));
            assert_eq!(
                (a.and(Part), a.inverse().inverse()),
                (if a == None { None } else { Part }, a)
            );
        }
    }

    #[test]
    fn listed_bricks_reach_the_greatest_coordinates() {
        let list =
            ListedBricks::new(vec![(UVec3::ZERO, Brick::FULL), (UVec3::splat(511), Brick::FULL)]);
        for (bounds, coverage) in [
            (cube(0, 8), BoxCoverage::All),
            (cube(2, 5), BoxCoverage::All),
            (cube(-8, 8), BoxCoverage::Part),
            (cube(i32::MIN, 0), BoxCoverage::None),
            (cube(8, 4088), BoxCoverage::None),
            (cube(4088, 4096), BoxCoverage::All),
            (cube(4096, i32::MAX), BoxCoverage::None),
            (cube(i32::MIN, i32::MAX), BoxCoverage::Part),
            (cube(4, 4), BoxCoverage::None),
        ] {
            assert_eq!(list.coverage(bounds), coverage, "{bounds:?}");
        }
        assert_eq!(ListedBricks::default().coverage(cube(0, 8)), BoxCoverage::None);
    }

    fn kind() -> impl Strategy<Value = Option<Brick>> {
        let odd = Brick { words: [!1; 8] };
        prop::sample::select(vec![
            None,
            Some(Brick::EMPTY),
            Some(odd),
            Some(Brick::FULL),
            Some(Brick::FULL),
            Some(Brick::FULL),
        ])
    }

    proptest! {
        #[test]
        fn listed_bricks_cover_what_their_masks_do(
            bricks in prop::collection::vec(kind(), 4 * 4 * 4),
            filled in prop::array::uniform3(0usize..3),
            corner in prop::array::uniform3(-9i32..30),
            size in prop::array::uniform3(1i32..24),
        ) {
            let place = |i: usize| [i % 4, i / 4 % 4, i / 16];
            let listed = |i: usize| {
                let full = (0..3).all(|axis| place(i)[axis] >= filled[axis]);
                let mask = if full { Some(Brick::FULL) } else { bricks[i] };
                Some((UVec3::from(place(i).map(|v| v as u32 + 1)), mask?))
            };
            let bricks: Vec<_> = (0..64).filter_map(listed).collect();
            let list = ListedBricks::new(bricks.clone());
            let (exact, aligned) = (IVec3::from(corner), IVec3::from(corner) * 2 / 8 * 8);
            let sizes = [IVec3::from(size), IVec3::from(size) / 8 * 8 + 8];
            for (min, size) in [(exact, sizes[0]), (aligned, sizes[1]), (aligned, IVec3::splat(8))] {
                let bounds = VoxelBox { min, max: min + size };
                let voxels = bricks.iter().flat_map(|(b, mask)| {
                    let is_inside = |i: &u32| {
                        let [x, y, z] = local_coords(*i);
                        let v = (*b * BRICK_EDGE_VX).as_ivec3() + IVec3::new(x as i32, y as i32, z as i32);
                        mask.get(x, y, z) && bounds.contains(v)
                    };
                    (0..512).filter(is_inside)
                });
                let count = voxels.count() as i32;
                let coverage = list.coverage(bounds);
                prop_assert!(count == 0 || coverage != BoxCoverage::None);
                prop_assert!(count == size.element_product() || coverage != BoxCoverage::All);
                // Whole bricks are decided.
                if min == aligned && count == 0 {
                    prop_assert_eq!(coverage, BoxCoverage::None);
                }
                if min == aligned && count == size.element_product() {
                    prop_assert_eq!(coverage, BoxCoverage::All);
                }
            }
        }
    }
}
