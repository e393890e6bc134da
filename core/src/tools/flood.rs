//! Finds the connected patch of one colour on the surface around a voxel, which a flood fill recolours.
//!
//! A surface voxel is an existing voxel with an empty one among its 26 neighbours. Such a skin is face-connected
//! wherever the surface is. Takes the contents and the seed voxels; gives the voxels of their patches. Visits no brick
//! that the patches do not reach. Changes nothing.

use glam::{IVec3, UVec3};
use rustc_hash::FxHashMap;

use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, BrickKind, local_coords};
use crate::sculpture::grid::uniform_in;
use crate::sculpture::history::Contents;
use crate::sculpture::region::{BrickBox, ListedBricks};
use crate::sculpture::{Grid, Rgb};

/// The voxels of a brick as slices along z, each with bit x + 8 y.
pub(super) type Slices = [u64; BRICK_EDGE_VX as usize];

/// The voxels of a slice with the lowest and the highest x.
const LOWEST_X: u64 = 0x0101_0101_0101_0101;
const HIGHEST_X: u64 = LOWEST_X << 7;

/// The search state of a brick that a patch has reached.
struct Reached {
    /// The voxels that may belong to the patch.
    may: Slices,
    filled: Slices,
    /// Seeds found from neighbouring bricks that have not been spread yet.
    pending: Slices,
}

/// Returns whether a voxel exists and lies on the surface.
pub(crate) fn is_on_surface(grid: &Grid, v: IVec3) -> bool {
    grid.get(v) && (0..27).any(|i| !grid.get(v + IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)))
}

/// Returns the surface voxels that are face-connected to one of `starts` through voxels whose colours differ from the
/// colour of that start by at most `tolerance` of the range of each channel. Starts off the surface yield nothing.
pub fn patch(contents: &Contents, starts: &[UVec3], tolerance: f32) -> ListedBricks {
    let from_each = starts.iter().map(|start| {
        let colour = contents.rgb(*start);
        let is_alike = |other| is_alike(colour, other, tolerance);
        patch_by(&contents.grid, *start, &|b| alike_on_surface(contents, b, &is_alike))
    });
    ListedBricks::union(from_each)
}

fn is_alike(Rgb(a): Rgb, Rgb(b): Rgb, tolerance: f32) -> bool {
    a.into_iter().zip(b).all(|(a, b)| f32::from(a.abs_diff(b)) <= tolerance * 255.0)
}

/// Returns all existing voxels of a colour, to within `tolerance` of the range of each channel.
pub(crate) fn of_colour(contents: &Contents, colour: Rgb, tolerance: f32) -> Grid {
    let Contents { grid, material, .. } = contents;
    let base = is_alike(colour, material.base(), tolerance);
    let whole = |bricks: BrickBox| {
        let colour_of_all = material.uniform_in(bricks)?;
        let is_meant = colour_of_all.map_or(base, |own| is_alike(colour, own, tolerance));
        if is_meant { uniform_in(grid, bricks) } else { Some(false) }
    };
    let of_brick = |b: UVec3| {
        let mut alike = Brick::EMPTY;
        let voxels = grid.brick(b);
        let page = material.page(b);
        match (page, page.and_then(|page| page.uniform())) {
            (None, _) if base => alike = *voxels,
            (None, _) => {}
            (_, Some(own)) if is_alike(colour, own, tolerance) => alike = *voxels,
            (_, Some(_)) => {}
            (Some(page), None) => voxels.for_each(|local| {
                let [x, y, z] = local_coords(local);
                alike.set(x, y, z, is_alike(colour, page.rgb(local), tolerance));
            }),
        }
        alike
    };
    let mut found = grid.emptied();
    found.fill_cubes(whole, of_brick);
    found
}

/// Returns the voxels that are face-connected to `start` within the voxels that `may` returns for each brick.
pub(super) fn patch_by(grid: &Grid, start: UVec3, may: &dyn Fn(UVec3) -> Slices) -> ListedBricks {
    let dims = grid.brick_dims().as_ivec3();
    let mut reached: FxHashMap<UVec3, Reached> = FxHashMap::default();
    let mut open = Vec::new();
    let pass_on = |reached: &mut FxHashMap<UVec3, Reached>,
                   open: &mut Vec<UVec3>,
                   b: IVec3,
                   seeds: Slices| {
        if b.cmplt(IVec3::ZERO).any() || b.cmpge(dims).any() || seeds == [0; 8] {
            return;
        }
        let b = b.as_uvec3();
        let brick = reached.entry(b).or_insert_with(|| Reached {
            may: may(b),
            filled: [0; 8],
            pending: [0; 8],
        });
        let was_open = brick.pending != [0; 8];
        for (z, seeds) in seeds.into_iter().enumerate() {
            brick.pending[z] |= seeds & brick.may[z] & !brick.filled[z];
        }
        if !was_open && brick.pending != [0; 8] {
            open.push(b);
        }
    };
    let mut first = [0; 8];
    let local = start % BRICK_EDGE_VX;
    first[local.z as usize] = 1 << (local.x + 8 * local.y);
    pass_on(&mut reached, &mut open, (start / BRICK_EDGE_VX).as_ivec3(), first);
    while let Some(b) = open.pop() {
        let Some(brick) = reached.get_mut(&b) else { continue };
        let new = spread(std::mem::take(&mut brick.pending), &brick.may);
        brick.filled.iter_mut().zip(new).for_each(|(filled, new)| *filled |= new);
        let b = b.as_ivec3();
        let mut pass =
            |step: IVec3, seeds: Slices| pass_on(&mut reached, &mut open, b + step, seeds);
        pass(IVec3::NEG_X, new.map(|slice| (slice & LOWEST_X) << 7));
        pass(IVec3::X, new.map(|slice| (slice & HIGHEST_X) >> 7));
        pass(IVec3::NEG_Y, new.map(|slice| slice << 56));
        pass(IVec3::Y, new.map(|slice| slice >> 56));
        pass(IVec3::NEG_Z, [0, 0, 0, 0, 0, 0, 0, new[0]]);
        pass(IVec3::Z, [new[7], 0, 0, 0, 0, 0, 0, 0]);
    }
    let filled = reached.into_iter().map(|(b, reached)| (b, Brick::from_rows(&reached.filled)));
    let mut bricks: Vec<_> = filled.filter(|(_, brick)| !brick.is_empty()).collect();
    bricks.sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
    ListedBricks::new(bricks)
}

/// Returns all voxels of `may` that are face-connected to one of `seeds` within `may`.
fn spread(seeds: Slices, may: &Slices) -> Slices {
    let mut filled = seeds;
    loop {
        let before = filled;
        for z in 0..8 {
            let here = filled[z];
            let beside = (here & !HIGHEST_X) << 1 | (here & !LOWEST_X) >> 1 | here << 8 | here >> 8;
            let below = if z > 0 { filled[z - 1] } else { 0 };
            let above = if z < 7 { filled[z + 1] } else { 0 };
            filled[z] |= (beside | below | above) & may[z];
        }
        if filled == before {
            return filled;
        }
    }
}

/// Returns the surface voxels of a brick whose colour passes `is_alike`.
fn alike_on_surface(contents: &Contents, b: UVec3, is_alike: &dyn Fn(Rgb) -> bool) -> Slices {
    let Contents { grid, material, .. } = contents;
    let surface = surface_of(grid, b);
    let Some(page) = material.page(b) else {
        return if is_alike(material.base()) { surface } else { [0; 8] };
    };
    let mut alike = Brick::EMPTY;
    Brick::from_rows(&surface).for_each(|local| {
        if is_alike(page.rgb(local)) {
            let [x, y, z] = local_coords(local);
            alike.set(x, y, z, true);
        }
    });
    alike.to_rows()
}

/// Returns the surface voxels of a brick.
pub(super) fn surface_of(grid: &Grid, b: UVec3) -> Slices {
    // The voxels of the brick and one more on each side: bit x + 1 of the rows [z + 1][y + 1].
    let mut rows = [[0u16; 10]; 10];
    for i in 0..27 {
        let step = IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        let other = b.as_ivec3() + step;
        if other.cmplt(IVec3::ZERO).any() || other.cmpge(grid.brick_dims().as_ivec3()).any() {
            continue;
        }
        let other = other.as_uvec3();
        let slices = match grid.brick_kind(grid.brick_index(other)) {
            BrickKind::Empty => continue,
            BrickKind::Full => [u64::MAX; 8],
            BrickKind::Mixed => grid.brick(other).to_rows(),
        };
        // The needed voxels of the neighbouring brick, and the row that the first of them goes to.
        let wanted = |step: i32| match step {
            -1 => (7..8, 0),
            0 => (0..8, 1),
            _ => (0..1, 9),
        };
        let (zs, first_z) = wanted(step.z);
        for (z, to_z) in zs.zip(first_z..) {
            let (ys, first_y) = wanted(step.y);
            for (y, to_y) in ys.zip(first_y..) {
                let row = (slices[z] >> (8 * y) & 0xFF) as u16;
                rows[to_z][to_y] |= match step.x {
                    -1 => row >> 7,
                    0 => row << 1,
                    _ => (row & 1) << 9,
                };
            }
        }
    }
    let inside_rows = rows.map(|layer| layer.map(|row| row & row << 1 & row >> 1));
    std::array::from_fn(|z| {
        (0..8).fold(0, |slice, y| {
            let around = inside_rows[z..z + 3].iter().flat_map(|layer| &layer[y..y + 3]);
            let inside = around.fold(u16::MAX, |all, row| all & row);
            let surface = rows[z + 1][y + 1] & !inside;
            slice | u64::from(surface >> 1 & 0xFF) << (8 * y)
        })
    })
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use glam::Vec3;

    use super::*;
    use crate::scenes::{Random, grid_of};
    use crate::sculpture::{ColourDepth, Material};

    /// Returns the patch, found voxel by voxel.
    fn naive(contents: &Contents, start: UVec3, tolerance: f32) -> HashSet<UVec3> {
        let colour = contents.rgb(start);
        let belongs = |v: IVec3| {
            is_on_surface(&contents.grid, v)
                && is_alike(colour, contents.rgb(v.as_uvec3()), tolerance)
        };
        let (mut found, mut open) = (HashSet::new(), vec![start.as_ivec3()]);
        while let Some(v) = open.pop() {
            if belongs(v) && found.insert(v.as_uvec3()) {
                let steps = [IVec3::X, IVec3::Y, IVec3::Z];
                open.extend(steps.iter().flat_map(|step| [v + *step, v - *step]));
            }
        }
        found
    }

    fn listed(bricks: &ListedBricks) -> HashSet<UVec3> {
        let mut all = HashSet::new();
        for (b, brick) in bricks.bricks() {
            brick.for_each(|local| {
                all.insert(*b * BRICK_EDGE_VX + UVec3::from(local_coords(local)));
            });
        }
        all
    }

    #[test]
    fn a_patch_is_what_steps_from_voxel_to_voxel_find() {
        let mut random = Random(5);
        for (edge, share) in [(7, 1.0), (40, 0.0), (40, 0.3), (33, 0.6)] {
            let centre = Vec3::splat(edge as f32 * 0.5);
            let grid = grid_of(edge, |p| p.distance(centre) < edge as f32 * 0.55);
            let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
            let mut contents = Contents::new(grid, material);
            for brick in 0..contents.grid.brick_count() {
                let mask = Brick { words: std::array::from_fn(|_| random.next_u64()) };
                if random.unit() < share {
                    let grey = (random.unit() * 40.0) as u8;
                    contents.material.paint(
                        contents.grid.brick_coords(brick),
                        &mask,
                        Rgb::new(200, 190, 130 + grey),
                    );
                }
            }
            let dims = contents.grid.dims();
            let mut tried = 0;
            while tried < 12 {
                let start = random.voxel(dims).as_uvec3();
                let is_found = is_on_surface(&contents.grid, start.as_ivec3());
                let tolerance = random.unit() * 0.1;
                let found = listed(&patch(&contents, &[start], tolerance));
                assert_eq!(found, naive(&contents, start, tolerance), "{edge} {share} {start}");
                assert_eq!(found.contains(&start), is_found);
                tried += usize::from(is_found);
            }
        }
    }

    #[test]
    fn a_patch_does_not_leak_through_the_inside() {
        // A block with a ring of another colour around its waist, one voxel deep.
        let grid = grid_of(24, |_| true);
        let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
        let mut contents = Contents::new(grid, material);
        for index in 0..contents.grid.brick_count() {
            let b = contents.grid.brick_coords(index);
            if b.y == 1 {
                let ring = Brick::from_rows(&surface_of(&contents.grid, b));
                contents.material.paint(
                    contents.grid.brick_coords(index),
                    &ring,
                    Rgb::new(255, 0, 0),
                );
            }
        }
        let found = listed(&patch(&contents, &[UVec3::ZERO], 0.0));
        assert!(found.iter().all(|v| v.y < 8));
        assert_eq!(found.len(), 24 * 24 * 8 - 22 * 22 * 7);
        let both = listed(&patch(&contents, &[UVec3::ZERO, UVec3::new(5, 23, 5)], 0.0));
        assert_eq!(both.len(), 2 * found.len());
        assert!(listed(&patch(&contents, &[UVec3::splat(12)], 1.0)).is_empty());
    }
}
