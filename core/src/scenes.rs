//! Scenes for tests and benchmarks: sculptures from formulas, the same on every machine and in every run.
//!
//! Takes sizes and seeds, returns grids. A voxel exists if its centre lies in the solid.

use glam::{IVec3, UVec3, Vec3};

use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::region::{BrickBox, VoxelBox};
use crate::sculpture::{Brick, Grid, GridError};

/// Returns a full cube.
pub fn solid_cube(edge_vx: u32) -> Result<Grid, GridError> {
    let mut grid = cube(edge_vx)?;
    grid.fill_box(VoxelBox::of_grid(&grid));
    Ok(grid)
}

/// Returns a cube minus `spheres` balls of radius 4 to 28 voxels with centres anywhere in it.
pub fn cheese(edge_vx: u32, spheres: u32, seed: u64) -> Result<Grid, GridError> {
    let mut grid = cube(edge_vx)?;
    let mut random = Random(seed);
    let spheres: Vec<(Vec3, f32)> = (0..spheres)
        .map(|_| {
            let centre = Vec3::new(random.unit(), random.unit(), random.unit());
            (centre * edge_vx as f32, 4.0 + 24.0 * random.unit())
        })
        .collect();
    // The spheres that reach into each column of bricks along z.
    let columns = grid.brick_dims().x;
    let reach = |centre: Vec3, radius: f32, corner: Vec3, edge: Vec3| {
        let gap = centre - centre.clamp(corner, corner + edge);
        gap.length_squared() <= radius * radius
    };
    let near: Vec<Vec<(Vec3, f32)>> = (0..columns * columns)
        .map(|i| {
            let corner = UVec3::new(i % columns, i / columns, 0).as_vec3() * 8.0;
            let edge = Vec3::new(8.0, 8.0, edge_vx as f32);
            let inside = |&(centre, radius): &(Vec3, f32)| reach(centre, radius, corner, edge);
            spheres.iter().copied().filter(inside).collect()
        })
        .collect();
    grid.fill_bricks(|b| {
        let corner = (b * BRICK_EDGE_VX).as_vec3();
        let mut brick = Brick::FULL;
        for &(centre, radius) in &near[(b.x + b.y * columns) as usize] {
            if reach(centre, radius, corner, Vec3::splat(8.0)) {
                let centre = centre - corner;
                brick = brick.and_not(&brick_of(|p| p.distance_squared(centre) <= radius * radius));
            }
        }
        brick
    });
    Ok(grid)
}

/// Returns a gyroid shell of eight cells an edge, cut to a ball. Its surface is roughened by noise of about two voxels'
/// depth, different in every voxel.
pub fn gyroid(edge_vx: u32, seed: u64) -> Result<Grid, GridError> {
    let mut grid = cube(edge_vx)?;
    let edge = edge_vx as f32;
    let waves: Vec<(f32, f32)> = (0..edge_vx)
        .map(|i| ((i as f32 + 0.5) * 8.0 * std::f32::consts::TAU / edge).sin_cos())
        .collect();
    // The gyroid's slope is about 1.5 per radian: converts voxels to its value.
    let per_voxel = 1.5 * 8.0 * std::f32::consts::TAU / edge;
    let (half_thickness, roughness) = (0.035 * edge * 0.25 * per_voxel, 2.0 * per_voxel);
    grid.fill_bricks(|b| {
        let corner = b * BRICK_EDGE_VX;
        let centre = corner.as_vec3() + 4.0 - 0.5 * edge;
        if centre.length() > 0.5 * edge + 8.0 {
            return Brick::EMPTY;
        }
        brick_of(|p| {
            let v = (corner + p.as_uvec3()).min(UVec3::splat(edge_vx - 1));
            let from_centre = corner.as_vec3() + p - 0.5 * edge;
            let [(sx, cx), (sy, cy), (sz, cz)] = v.to_array().map(|i| waves[i as usize]);
            let value = (sx * cy + sy * cz + sz * cx).abs();
            let noise = hash(seed ^ voxel_key(v)) as f32 / u64::MAX as f32 - 0.5;
            value + noise * roughness < half_thickness
                && from_centre.length_squared() < 0.25 * edge * edge
        })
    });
    Ok(grid)
}

/// Returns a smooth gyroid shell of eight cells an edge, cut to a ball: the shape of [`gyroid`] without noise, made in time
/// proportional to its surface.
pub fn gyroid_shell(edge_vx: u32) -> Result<Grid, GridError> {
    let mut grid = cube(edge_vx)?;
    let (edge, per_voxel) = (edge_vx as f32, 8.0 * std::f32::consts::TAU / edge_vx as f32);
    let waves: Vec<(f32, f32)> =
        (0..edge_vx).map(|i| ((i as f32 + 0.5) * per_voxel).sin_cos()).collect();
    // The value of `gyroid` at half of the thickness.
    let most = 0.035 * 0.25 * 1.5 * 8.0 * std::f32::consts::TAU;
    // Each of the three slopes is at most the root of two.
    let steepest = 6f32.sqrt() * per_voxel;
    let uniform = |cube: BrickBox| {
        let VoxelBox { min, max } = cube.voxels();
        let (centre, radius) = ((min + max).as_vec3() * 0.5, (max - min).as_vec3().length() * 0.5);
        let [(sx, cx), (sy, cy), (sz, cz)] = (centre * per_voxel).to_array().map(f32::sin_cos);
        let (value, margin) = ((sx * cy + sy * cz + sz * cx).abs(), steepest * radius + 1e-3);
        let from_centre = (centre - 0.5 * edge).length();
        if value - margin > most || from_centre - radius > 0.5 * edge + 1.0 {
            return Some(false);
        }
        let is_inside = value + margin < most && from_centre + radius < 0.5 * edge - 1.0;
        is_inside.then_some(true)
    };
    grid.fill_cubes(uniform, |b| {
        let corner = b * BRICK_EDGE_VX;
        brick_of(|p| {
            let v = (corner + p.as_uvec3()).min(UVec3::splat(edge_vx - 1));
            let from_centre = corner.as_vec3() + p - 0.5 * edge;
            let [(sx, cx), (sy, cy), (sz, cz)] = v.to_array().map(|i| waves[i as usize]);
            (sx * cy + sy * cz + sz * cx).abs() < most
                && from_centre.length_squared() < 0.25 * edge * edge
        })
    });
    Ok(grid)
}

/// Returns a machine of cylinders, bores, fins, pipes and bolts, like a scanned engine part.
pub fn engine_like(edge_vx: u32) -> Result<Grid, GridError> {
    let mut grid = cube(edge_vx)?;
    let scale = 1.0 / edge_vx as f32;
    grid.fill_bricks(|b| {
        let corner = (b * BRICK_EDGE_VX).as_vec3();
        brick_of(|p| in_engine((corner + p) * scale))
    });
    Ok(grid)
}

/// Returns whether a point is in the engine, which fills a unit cube with z up.
fn in_engine(p: Vec3) -> bool {
    let within = |low: [f32; 3], high: [f32; 3]| {
        p.cmpge(Vec3::from(low)).all() && p.cmple(Vec3::from(high)).all()
    };
    // Distance from an axis along `along`.
    let from_axis = |along: usize, centre: [f32; 2]| {
        let (a, b) = match along {
            0 => (p.y, p.z),
            1 => (p.x, p.z),
            _ => (p.x, p.y),
        };
        (a - centre[0]).hypot(b - centre[1])
    };
    let mut solid = within([0.12, 0.25, 0.2], [0.88, 0.75, 0.55]);
    for cylinder in 0..3 {
        let centre = [0.25 + 0.25 * cylinder as f32, 0.5];
        let r = from_axis(2, centre);
        let fin = (p.z * 40.0).fract() < 0.45;
        solid |= (0.55..0.85).contains(&p.z) && r < if fin { 0.118 } else { 0.092 };
        solid &= !(p.z > 0.3 && r < 0.068);
        // Valve stems in the bores.
        solid |= (0.3..0.93).contains(&p.z) && r < 0.012;
        // Exhaust pipes that bend from the front downwards.
        let bend = Vec3::new(p.x - centre[0], p.y - 0.25, p.z - 0.33);
        let ring = (bend.y.hypot(bend.z) - 0.09).hypot(bend.x);
        solid |= p.y < 0.26 && (0.022..0.036).contains(&ring);
    }
    // Crankshaft tunnel and shaft with webs.
    let shaft = from_axis(0, [0.5, 0.3]);
    solid &= shaft > 0.085;
    let web = (p.x * 12.0).fract() < 0.3 && (0.12..0.88).contains(&p.x);
    solid |= (0.04..0.96).contains(&p.x) && shaft < if web { 0.07 } else { 0.03 };
    // Flywheel with holes, flange with bolts.
    let spoke = (p.z - 0.3).atan2(p.y - 0.5) * 8.0 / std::f32::consts::TAU;
    let hole = ((shaft - 0.13) / 0.13).hypot((spoke.fract() + 1.0).fract() * 2.0 - 1.0) < 0.45;
    solid |= (0.04..0.08).contains(&p.x) && shaft < 0.22 && !hole;
    solid |= within([0.08, 0.2, 0.52], [0.92, 0.8, 0.56]);
    for bolt in 0..16 {
        let (i, side) = (bolt % 8, bolt / 8);
        let centre = [0.12 + 0.108 * i as f32, 0.225 + 0.55 * side as f32];
        solid |= (0.5..0.6).contains(&p.z) && from_axis(2, centre) < 0.018;
    }
    solid
}

fn cube(edge_vx: u32) -> Result<Grid, GridError> {
    Grid::new(UVec3::splat(edge_vx), Vec3::ONE, u64::MAX)
}

/// Returns the brick of the voxels whose centre (in voxels from the brick's corner) is `inside`.
fn brick_of(inside: impl Fn(Vec3) -> bool) -> Brick {
    let mut brick = Brick::EMPTY;
    for z in 0..BRICK_EDGE_VX {
        for y in 0..BRICK_EDGE_VX {
            for x in 0..BRICK_EDGE_VX {
                if inside(UVec3::new(x, y, z).as_vec3() + 0.5) {
                    brick.set(x, y, z, true);
                }
            }
        }
    }
    brick
}

/// A pseudorandom number generator with the same sequence everywhere (Steele, Lea and Flood, "Fast splittable
/// pseudorandom number generators", 2014).
pub struct Random(pub u64);

impl Random {
    /// Returns the next number, all 64 bits of it random.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        hash(self.0)
    }

    /// Returns the next number in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 / (1 << 24) as f32
    }

    /// Returns a random voxel of a grid of `dims` voxels.
    pub fn voxel(&mut self, dims: UVec3) -> IVec3 {
        let unit = Vec3::new(self.unit(), self.unit(), self.unit());
        (unit * dims.as_vec3()).as_ivec3()
    }
}

fn hash(v: u64) -> u64 {
    let v = (v ^ v >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let v = (v ^ v >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    v ^ v >> 31
}

fn voxel_key(v: UVec3) -> u64 {
    u64::from(v.x) | u64::from(v.y) << 20 | u64::from(v.z) << 40
}

/// Returns a cube of `edge_vx` voxels an edge with the voxels whose centres are `inside`. For tests.
#[cfg(test)]
pub(crate) fn grid_of(edge_vx: u32, mut inside: impl FnMut(Vec3) -> bool) -> Grid {
    let mut grid = Grid::new(UVec3::splat(edge_vx), Vec3::ONE, 1 << 24).unwrap();
    for z in 0..edge_vx {
        for y in 0..edge_vx {
            for x in 0..edge_vx {
                let v = UVec3::new(x, y, z);
                if inside(v.as_vec3() + 0.5) {
                    grid.set(v.as_ivec3(), true);
                }
            }
        }
    }
    grid
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cheese_is_the_cube_minus_its_spheres() {
        let grid = cheese(64, 20, 7).unwrap();
        let mut random = Random(7);
        let mut naive = solid_cube(64).unwrap();
        for _ in 0..20 {
            let centre = Vec3::new(random.unit(), random.unit(), random.unit()) * 64.0;
            let radius = 4.0 + 24.0 * random.unit();
            for index in 0..64 * 64 * 64 {
                let v = naive.voxel_coords(index);
                // Relative to the brick, as the scene computes it, so that distances are rounded equally.
                let corner = (v / 8 * 8).as_vec3();
                let p = (v % 8).as_vec3() + 0.5;
                if p.distance_squared(centre - corner) <= radius * radius {
                    naive.set(v.as_ivec3(), false);
                }
            }
        }
        assert!(grid == naive);
        assert!(grid.opaque_count() > 0 && grid.opaque_count() < 64 * 64 * 64);
    }

    /// Whole cubes of the tree are what their voxels are.
    #[test]
    fn a_shell_is_that_of_its_formula() {
        for edge in [64u32, 250] {
            let grid = gyroid_shell(edge).unwrap();
            let wave = |i: u32| {
                ((i as f64 + 0.5) * 8.0 * std::f64::consts::TAU / f64::from(edge)).sin_cos()
            };
            let mut close = 0;
            for index in 0..edge * edge * edge {
                let v = grid.voxel_coords(index);
                let [(sx, cx), (sy, cy), (sz, cz)] = v.to_array().map(wave);
                let value = (sx * cy + sy * cz + sz * cx).abs();
                let from_centre = (v.as_dvec3() + 0.5 - 0.5 * f64::from(edge)).length();
                let (most, radius) = (0.105 * std::f64::consts::TAU, 0.5 * f64::from(edge));
                let is_inside = value < most && from_centre < radius;
                let is_close = (value - most).abs() < 1e-4 || (from_centre - radius).abs() < 1e-3;
                close += u32::from(is_close);
                assert!(is_close || grid.get(v.as_ivec3()) == is_inside, "{edge}: {v}");
            }
            assert!(close < edge * edge, "{close} voxels too close to tell");
        }
    }

    #[test]
    fn scenes_are_neither_empty_nor_full_and_repeat() {
        for make in [|| gyroid(96, 1), || engine_like(96)] {
            let grid = make().unwrap();
            let share = grid.opaque_count() as f32 / (96f32 * 96.0 * 96.0);
            assert!((0.03..0.6).contains(&share), "{share}");
            assert!(grid == make().unwrap());
        }
        assert!(gyroid(96, 1).unwrap() != gyroid(96, 2).unwrap());
    }
}
