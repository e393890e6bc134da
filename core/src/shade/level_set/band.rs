//! The levels of one brick, from the planes of the surface voxels in it and beside it.
//!
//! A surface voxel has its own depth. Any other voxel that touches a surface voxel gets the mean distance from the
//! planes of those that are nearest to it: across a face, or else an edge, or else a corner. So a voxel above a face
//! ignores the plane round the edge, and edges stay as sharp as the normals. All others are far inside or outside.

use glam::{IVec3, UVec3, Vec3};

use super::thin::{BricksAround, SurfacePlane, moved};
use super::{FAR, LEAST, PageLevels, place};
use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, BrickKind};
use crate::shade::NormalField;
use crate::shade::normal_field::{NO_PAGE, PackedDepth};

/// Edge of a brick with a voxel around it.
const EDGE: usize = 10;
/// The bits of a row, for each y and z.
type Rows = [[u16; EDGE]; EDGE];
/// A plane for each voxel.
type BrickPlanes = [[[SurfacePlane; EDGE]; EDGE]; EDGE];

/// A brick with the surface in it and around it.
pub(super) struct Band {
    /// Existing voxels, and surface voxels. Bit and index 0 are the voxel before the brick.
    existing: Rows,
    surface: Rows,
    /// The planes of the surface voxels, moved for thin parts; unspecified for other voxels.
    planes: BrickPlanes,
    /// Voxels of the brick that touch a surface voxel, or are one.
    near: Rows,
}

/// Returns the bricks around one: their number and offset.
fn around() -> impl Iterator<Item = (usize, IVec3)> {
    (0..27).map(|i| (i, IVec3::new(i as i32 % 3, i as i32 / 3 % 3, i as i32 / 9) - 1))
}

/// The offsets of the voxels that share a face, an edge or a corner with one.
const RINGS: [&[[i8; 3]]; 3] = [
    &[[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]],
    &[
        [-1, -1, 0],
        [1, -1, 0],
        [-1, 1, 0],
        [1, 1, 0],
        [-1, 0, -1],
        [1, 0, -1],
        [-1, 0, 1],
        [1, 0, 1],
        [0, -1, -1],
        [0, 1, -1],
        [0, -1, 1],
        [0, 1, 1],
    ],
    &[
        [-1, -1, -1],
        [1, -1, -1],
        [-1, 1, -1],
        [1, 1, -1],
        [-1, -1, 1],
        [1, -1, 1],
        [-1, 1, 1],
        [1, 1, 1],
    ],
];

/// Without a normal, the plane is half a voxel from the centre in every direction.
const NO_NORMAL_DEPTH: f32 = 0.5 * PackedDepth::PER_VX;

impl Band {
    /// Returns the brick at `b`; `None` if it has no voxel near the surface.
    pub fn of(grid: &Grid, normals: &NormalField, b: UVec3) -> Option<Band> {
        let b = b.as_ivec3();
        let dims = grid.brick_dims().as_ivec3();
        let mut pages = [NO_PAGE; 27];
        let mut surface = [[0; 8]; 27];
        for (i, offset) in around() {
            let at = b + offset;
            if at.cmpge(IVec3::ZERO).all() && at.cmplt(dims).all() {
                pages[i] = normals.table().page(at.as_uvec3());
                if pages[i] != NO_PAGE {
                    surface[i] = *normals.pages().layers(pages[i]);
                }
            }
        }
        if pages.iter().all(|&page| page == NO_PAGE) {
            return None;
        }
        let surface = joined(&surface);
        let near = dilated(&surface);
        if near == Rows::default() {
            return None;
        }
        let bricks = bricks_around(grid, b);
        let planes = planes(&bricks, &surface, |at: IVec3| {
            let brick: i32 = ((at + 8) >> 3i32).dot(IVec3::new(1, 3, 9));
            let local: UVec3 = (at & 7).as_uvec3();
            normals.plane(pages[brick as usize], local)
        });
        Some(Band { existing: joined(&bricks), surface, near, planes })
    }

    /// Returns the levels of the brick's voxels.
    pub fn levels(&self) -> PageLevels {
        let mut levels = [FAR; 512];
        for z in 0..8 {
            for y in 0..8 {
                let existing = self.existing[z + 1][y + 1];
                let near = self.near[z + 1][y + 1];
                for x in 0..8 {
                    let bit = 1 << (x + 1);
                    let inside = existing & bit != 0;
                    let at = IVec3::new(x, y as i32, z as i32);
                    let distance = match near & bit != 0 {
                        true => self.distance(at, inside),
                        false => FAR.into(),
                    };
                    let least = f32::from(LEAST);
                    levels[place(x as u32, y as u32, z as u32)] = match inside {
                        true => -(distance.clamp(least, FAR.into()) + 0.5).floor() as i8,
                        false => (distance.clamp(least, FAR.into()) + 0.5).floor() as i8,
                    };
                }
            }
        }
        levels
    }

    /// Returns the distance of a voxel from the surface, positive on its own side, in units of a level.
    fn distance(&self, at: IVec3, inside: bool) -> f32 {
        let side = if inside { -1.0 } else { 1.0 };
        if inside && let Some((_, depth)) = self.plane(at) {
            return depth;
        }
        for ring in RINGS {
            let (mut sum, mut count) = (0.0, 0.0);
            for &offset in ring {
                let offset = IVec3::from(offset.map(i32::from));
                let Some((normal, depth)) = self.plane(at + offset) else { continue };
                sum += match normal == Vec3::ZERO {
                    true => PackedDepth::PER_VX - depth,
                    false => {
                        let height = normal.dot(-offset.as_vec3()) * PackedDepth::PER_VX - depth;
                        height * side
                    }
                };
                count += 1.0;
            }
            if count > 0.0 {
                return sum / count;
            }
        }
        FAR.into()
    }

    /// Returns the plane of a surface voxel; coordinates are those of the brick, -1 to 8.
    #[inline(always)]
    fn plane(&self, at: IVec3) -> Option<SurfacePlane> {
        let UVec3 { x, y, z } = (at + 1).as_uvec3();
        let row = self.surface[z as usize][y as usize];
        (row >> x & 1 != 0).then(|| self.planes[z as usize][y as usize][x as usize])
    }
}

/// Returns the planes of the voxels of `surface`. `plane` gives the unmoved ones, by coordinates of the brick from -8
/// to 15.
fn planes(
    bricks: &BricksAround,
    surface: &Rows,
    plane: impl Fn(IVec3) -> Option<SurfacePlane>,
) -> BrickPlanes {
    let mut planes = [[[(Vec3::ZERO, NO_NORMAL_DEPTH); EDGE]; EDGE]; EDGE];
    let rows = surface.iter().zip(&mut planes).zip(-1..);
    for ((rows, planes), z) in rows {
        for ((row, planes), y) in rows.iter().zip(planes).zip(-1..) {
            let mut rest = *row;
            while rest != 0 {
                let x = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let at = IVec3::new(x as i32 - 1, y, z);
                let Some(own) = plane(at) else { continue };
                let own = match own.0 == Vec3::ZERO {
                    true => (Vec3::ZERO, NO_NORMAL_DEPTH),
                    false => own,
                };
                planes[x] = moved(bricks, at, own, &plane);
            }
        }
    }
    planes
}

/// Returns the rows of the voxels in a brick and next to it, from the layers (`x + 8 y`) of the 27 bricks.
fn joined(bricks: &BricksAround) -> Rows {
    let mut rows = Rows::default();
    // Along an axis: the index of the brick, and that of the voxel in it.
    let at = |i: usize| (i.div_ceil(8), (i + 7) % 8);
    for (z, rows) in rows.iter_mut().enumerate() {
        let (brick_z, z) = at(z);
        for (y, row) in rows.iter_mut().enumerate() {
            let (brick_y, y) = at(y);
            let first = 3 * brick_y + 9 * brick_z;
            let [low, middle, high] =
                [0, 1, 2].map(|x| (bricks[first + x][z] >> (8 * y) & 255) as u16);
            *row = low >> 7 | middle << 1 | (high & 1) << 9;
        }
    }
    rows
}

/// Returns the bits of the brick that have a set bit among the 27 at and around them.
fn dilated(rows: &Rows) -> Rows {
    let mut out = Rows::default();
    for z in 1..EDGE - 1 {
        for y in 1..EDGE - 1 {
            let all = rows[z - 1..=z + 1].iter().flat_map(|layer| &layer[y - 1..=y + 1]);
            let any = all.fold(0, |any, row| any | row);
            out[z][y] = (any | any << 1 | any >> 1) & 0x1FE;
        }
    }
    out
}

/// Returns the existing voxels of the brick at brick coordinates `b`, which may be outside, and of the 26 around it.
fn bricks_around(grid: &Grid, b: IVec3) -> BricksAround {
    let dims = grid.brick_dims().as_ivec3();
    let mut bricks = [[0; 8]; 27];
    for (i, offset) in around() {
        let at = b + offset;
        if at.cmpge(IVec3::ZERO).all() && at.cmplt(dims).all() {
            let at = at.as_uvec3();
            bricks[i] = match grid.kind(at) {
                BrickKind::Empty => continue,
                BrickKind::Full => [u64::MAX; 8],
                BrickKind::Mixed => grid.brick(at).to_rows(),
            };
        }
    }
    bricks
}

/// Returns the cells of a brick of cells that have an existing voxel at one of their corners.
pub(super) fn cells_at(grid: &Grid, b: IVec3) -> Brick {
    let existing = joined(&bricks_around(grid, b));
    let mut layers = [0u64; BRICK_EDGE_VX as usize];
    for (z, layer) in layers.iter_mut().enumerate() {
        for y in 0..8 {
            let any =
                existing[z][y] | existing[z][y + 1] | existing[z + 1][y] | existing[z + 1][y + 1];
            *layer |= u64::from((any | any >> 1) & 255) << (8 * y);
        }
    }
    Brick::from_rows(&layers)
}
