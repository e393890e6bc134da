//! Computes the motion of clay ([`crate::tools::brush::kernel::grab`]): the source of the clay or empty space that
//! arrives at each voxel, and the resulting changes.
//!
//! From the contents and the pulls to [`Pulled`]. Bricks that receive only clay like their own are skipped. The others
//! are computed in rows of eight voxels, in loops that the compiler vectorises. Changes nothing itself.

use fearless_simd::{Level, Simd, dispatch};
use glam::{DVec3, IVec3, UVec3};
use rayon::prelude::*;

use super::field::{FINE, MARGIN_VX, SmoothedBits};
use super::motion::{EDGE, Pull, RowVectors};
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_VOXELS, BrickKind, local_index};
use crate::sculpture::history::Contents;
use crate::sculpture::region::{ListedBricks, VoxelBox};
use crate::sculpture::{Brick, Rgb};
use crate::tools::brush::falloff::Falloff;
use crate::tools::brush::kernel::pulled::Pulled;
use crate::tools::brush::kernel::stamp::Stamp;
use crate::tools::symmetry::MAX_IMAGES;

/// Number of fixed-point iterations for the source of a step; each reduces the error by the factor
/// [`super::STEP_SLOPE`].
const ROUNDS: usize = 3;

/// Number of images that axis-aligned planes make. More images take more memory for each row.
const FEW_PULLS: usize = 8;

/// The combined motion of all pulls.
///
/// Positions are relative to the mirror planes: mirrored ones differ in signs only and are rounded alike, so that the
/// result is symmetric to the voxel.
pub struct Flow<'a> {
    pub pulls: &'a [Pull],
    /// The origin in voxel coordinates.
    pub origin: DVec3,
    pub steps: usize,
    pub stretch: DVec3,
    pub radius: f64,
    pub falloff: Falloff,
}

impl Flow<'_> {
    /// Returns whether a ball ever comes within `beyond` of `p`, in units of the smallest edge.
    fn reaches(&self, p: DVec3, beyond: f64) -> bool {
        self.pulls.iter().any(|pull| {
            let from = (p - pull.centre) * self.stretch;
            let along = pull.displacement() * self.stretch * self.steps as f64;
            let length = along.length_squared().max(f64::MIN_POSITIVE);
            let share = (from.dot(along) / length).clamp(0.0, 1.0);
            (from - along * share).length() < self.radius + beyond
        })
    }

    /// Returns the bricks in which something may change, and the box of voxels that contains their sources.
    fn affected(&self, contents: &Contents, arrives: VoxelBox) -> (Vec<UVec3>, VoxelBox) {
        let edge = BRICK_EDGE_VX as i32;
        let (low, high) = (arrives.min / edge, (arrives.max + edge - 1) / edge);
        let half = DVec3::splat(0.5 * f64::from(BRICK_EDGE_VX));
        let beyond = (half * self.stretch).length();
        let mut bricks = Vec::new();
        let mut bounds = VoxelBox { min: IVec3::MAX, max: IVec3::MIN };
        for z in low.z..high.z {
            for y in low.y..high.y {
                for b in (low.x..high.x).map(|x| IVec3::new(x, y, z)) {
                    let middle = (b * edge).as_dvec3() + half - self.origin;
                    let sources = self.sources(b);
                    if self.reaches(middle, beyond) && !stays(contents, sources) {
                        bricks.push(b.as_uvec3());
                        bounds.min = bounds.min.min(sources.min);
                        bounds.max = bounds.max.max(sources.max);
                    }
                }
            }
        }
        (bricks, bounds)
    }

    /// Returns a box that contains the voxels from which the clay or empty space arriving in a brick comes.
    fn sources(&self, b: IVec3) -> VoxelBox {
        let edge = BRICK_EDGE_VX as i32;
        let (mut down, mut up) = (DVec3::ZERO, DVec3::ZERO);
        for pull in self.pulls {
            let [below, above] = pull.furthest(self.radius, self.stretch, self.falloff);
            let steps = self.steps as f64;
            (down, up) = (down.max(above * steps), up.max(below * steps));
        }
        let most = self.pulls.len() as f64;
        VoxelBox {
            min: b * edge - (down * most).ceil().as_ivec3() - 1,
            max: (b + 1) * edge + (up * most).ceil().as_ivec3() + 1,
        }
    }

    /// Computes the changes. Returns `None` for a box that lies outside the grid.
    pub fn carry_out(&self, contents: &Contents, reach: VoxelBox) -> Option<Pulled> {
        let grid = VoxelBox::of_grid(&contents.grid);
        let arrives = reach.intersect(grid);
        let (bricks, sources) = self.affected(contents, arrives);
        if bricks.is_empty() {
            return None;
        }
        let margin = |bounds: VoxelBox| VoxelBox {
            min: bounds.min - MARGIN_VX,
            max: bounds.max + MARGIN_VX,
        };
        let bounds = margin(reach).intersect(margin(grid)).intersect(margin(sources));
        let field = SmoothedBits::new(&contents.grid, bounds);
        let level = Level::new();
        let move_brick = |b: &UVec3| match self.pulls.len() <= FEW_PULLS {
            true => dispatch!(level, simd => {
                self.move_brick::<_, FEW_PULLS>(simd, contents, &field, *b, arrives)
            }),
            false => dispatch!(level, simd => {
                self.move_brick::<_, MAX_IMAGES>(simd, contents, &field, *b, arrives)
            }),
        };
        let done: Vec<Option<Moved>> = bricks.par_iter().map(move_brick).collect();
        let list = |part: fn(&Moved) -> Brick| {
            let of = |(b, moved): (&UVec3, &Option<Moved>)| {
                let mask = part(moved.as_ref()?);
                (!mask.is_empty()).then_some((*b, mask))
            };
            ListedBricks::new(bricks.iter().zip(&done).filter_map(of).collect())
        };
        let stamp = Stamp {
            remove: list(|moved| moved.remove),
            add: list(|moved| moved.add),
            paint: list(|moved| moved.paint),
        };
        let colours = bricks.into_iter().zip(done).filter_map(|(b, moved)| {
            let moved = moved.filter(|moved| !moved.paint.is_empty())?;
            Some((b, moved.colours?))
        });
        let colours = colours.collect();
        Some(Pulled { stamp, colours })
    }

    /// Computes the changes in a brick. Returns `None` if there are none.
    #[inline(always)]
    fn move_brick<S: Simd, const PULLS: usize>(
        &self,
        _simd: S,
        contents: &Contents,
        field: &SmoothedBits,
        b: UVec3,
        arrives: VoxelBox,
    ) -> Option<Moved> {
        let coloured = contents.material.depth().bytes() > 0;
        let before = *contents.grid.brick(b);
        let mut moved = Moved::default();
        for row in 0..BRICK_EDGE_VX * BRICK_EDGE_VX {
            let [y, z] = [row % BRICK_EDGE_VX, row / BRICK_EDGE_VX];
            let start = b * BRICK_EDGE_VX + UVec3::new(0, y, z);
            let offsets = self.row_of_offsets::<PULLS>(start);
            for x in 0..BRICK_EDGE_VX {
                let v = start + UVec3::X * x;
                let offset = IVec3::from(offsets.map(|axis| axis[x as usize]));
                // The field is known for these voxels only.
                if offset == IVec3::ZERO || !arrives.contains(v.as_ivec3()) {
                    continue;
                }
                let (exists, nearest) = field.sample(v, offset);
                let existed = before.get(x, y, z);
                match (existed, exists) {
                    (true, false) => moved.remove.set(x, y, z, true),
                    (false, true) => moved.add.set(x, y, z, true),
                    _ => {}
                }
                if coloured && exists {
                    let colour = contents.rgb(nearest);
                    let now = if existed { contents.rgb(v) } else { contents.material.base() };
                    if colour != now {
                        moved.paint.set(x, y, z, true);
                        let none = || Box::new([Rgb::default(); BRICK_VOXELS as usize]);
                        let local = local_index(x, y, z) as usize;
                        moved.colours.get_or_insert_with(none)[local] = colour;
                    }
                }
            }
        }
        let some = [moved.remove, moved.add, moved.paint].iter().any(|mask| !mask.is_empty());
        some.then_some(moved)
    }

    /// Returns the offsets to the sources of the clay or empty space that arrives at the centres of eight voxels, in
    /// units of 1 / [`FINE`] voxel.
    #[inline(always)]
    fn row_of_offsets<const PULLS: usize>(&self, start: UVec3) -> [[i32; EDGE]; 3] {
        let first = start.as_dvec3() + 0.5 - self.origin;
        let mut from_centres = [[[0.0; EDGE]; 3]; PULLS];
        for (pull, from_centre) in self.pulls.iter().zip(&mut from_centres) {
            let from = (first - pull.centre).to_array();
            *from_centre = from.map(|from| [from as f32; EDGE]);
            for (x, along) in from_centre[0].iter_mut().enumerate() {
                *along = (from[0] + x as f64) as f32;
            }
        }
        let mut arrived: RowVectors = [[0.0; EDGE]; 3];
        for step in (0..self.steps).rev() {
            let mut from = self.before(&from_centres, &arrived, &arrived, step + 1);
            for _ in 0..ROUNDS {
                from = self.before(&from_centres, &arrived, &from, step);
            }
            arrived = from;
        }
        let mut offsets = [[0; EDGE]; 3];
        for (offsets, arrived) in offsets.iter_mut().zip(&arrived) {
            for x in 0..EDGE {
                // Halves are rounded away from 0, on either side of a mirror.
                let fine = arrived[x] * FINE as f32;
                offsets[x] = (fine + 0.5f32.copysign(fine)) as i32;
            }
        }
        offsets
    }

    /// Returns `arrived` less the displacement of the clay at `at` in a step. All are relative to the voxels.
    #[inline(always)]
    fn before<const PULLS: usize>(
        &self,
        from_centres: &[RowVectors; PULLS],
        arrived: &RowVectors,
        at: &RowVectors,
        step: usize,
    ) -> RowVectors {
        let mut shifts = [[[0.0; EDGE]; 3]; PULLS];
        let scale = self.stretch.as_vec3().to_array();
        for ((pull, from_centre), shift) in self.pulls.iter().zip(from_centres).zip(&mut shifts) {
            let centre = (pull.displacement() * step as f64).as_vec3().to_array();
            let mut from: RowVectors = [[0.0; EDGE]; 3];
            for axis in 0..3 {
                for x in 0..EDGE {
                    let here = from_centre[axis][x] + (at[axis][x] - centre[axis]);
                    from[axis][x] = here * scale[axis];
                }
            }
            pull.shift(&from, self.stretch, self.radius, self.falloff, shift);
        }
        // Images are added in the pairs that a mirror plane makes.
        let (mut count, mut last) = (self.pulls.len(), [[0.0; EDGE]; 3]);
        while count > 1 {
            let pairs = count / 2;
            if count % 2 == 1 {
                // Nothing is added to the last one yet; it is kept behind the sums.
                last = shifts[count - 1];
            }
            for i in 0..pairs {
                let other = shifts[2 * i + 1];
                for (axis, other) in other.iter().enumerate() {
                    for x in 0..EDGE {
                        shifts[i][axis][x] = shifts[2 * i][axis][x] + other[x];
                    }
                }
            }
            if count % 2 == 1 {
                shifts[pairs] = last;
            }
            count = pairs + count % 2;
        }
        let mut before = *arrived;
        for (before, shift) in before.iter_mut().zip(&shifts[0]) {
            for x in 0..EDGE {
                before[x] -= shift[x];
            }
        }
        before
    }
}

/// Returns whether all points in `sources` are alike, so that nothing changes wherever the clay comes from.
fn stays(contents: &Contents, sources: VoxelBox) -> bool {
    let (grid, material) = (&contents.grid, &contents.material);
    let edge = IVec3::splat(BRICK_EDGE_VX as i32);
    let (low, high) = (sources.min.div_euclid(edge), (sources.max - 1).div_euclid(edge));
    let dims = grid.brick_dims().as_ivec3();
    let within = |b: IVec3| b.cmpge(IVec3::ZERO).all() && b.cmplt(dims).all();
    let mut kind = None;
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            for b in (low.x..=high.x).map(|x| IVec3::new(x, y, z)) {
                let at = within(b).then(|| b.as_uvec3());
                let here = at.map_or(BrickKind::Empty, |at| grid.brick_kind(grid.brick_index(at)));
                let painted = at.is_some_and(|at| material.page(at).is_some());
                if here == BrickKind::Mixed
                    || kind.is_some_and(|kind| kind != here)
                    || here == BrickKind::Full && painted
                {
                    return false;
                }
                kind = Some(here);
            }
        }
    }
    true
}

/// The changes in one brick.
struct Moved {
    remove: Brick,
    add: Brick,
    paint: Brick,
    colours: Option<Box<[Rgb; BRICK_VOXELS as usize]>>,
}

impl Default for Moved {
    fn default() -> Moved {
        Moved { remove: Brick::EMPTY, add: Brick::EMPTY, paint: Brick::EMPTY, colours: None }
    }
}
