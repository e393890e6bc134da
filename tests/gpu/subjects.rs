//! The grids and views that index maps are compared on.

use glam::{Affine3A, EulerRot, IVec3, Mat4, Quat, UVec2, UVec3, Vec3};
use virtual_sculpture::scenes::Random;
use virtual_sculpture::sculpture::{Brick, Grid, Placement};
use virtual_sculpture::view::eye::Frustum;
use virtual_sculpture::view::{Camera, Eye, PixelRays};

fn range(random: &mut Random, low: f32, high: f32) -> f32 {
    low + random.unit() * (high - low)
}

fn point(random: &mut Random, dims: UVec3) -> Vec3 {
    dims.as_vec3() * Vec3::new(random.unit(), random.unit(), random.unit())
}

fn empty(dims: UVec3, voxel_size: Vec3) -> Grid {
    Grid::new(dims, voxel_size, 1 << 30).unwrap()
}

fn fill(grid: &mut Grid, exists: impl Fn(Vec3) -> bool + Sync) {
    grid.fill_bricks(|b| {
        let mut brick = Brick::EMPTY;
        for z in 0..8 {
            for y in 0..8 {
                for x in 0..8 {
                    let local = UVec3::new(x, y, z);
                    brick.set(x, y, z, exists((b * 8 + local).as_vec3() + 0.5));
                }
            }
        }
        brick
    });
}

pub fn solid(dims: [u32; 3]) -> Grid {
    let mut grid = empty(UVec3::from(dims), Vec3::ONE);
    grid.fill_bricks(|_| Brick::FULL);
    grid
}

/// Balls; `carved` out of a solid, or standing in the empty.
pub fn balls(dims: [u32; 3], voxel_size: Vec3, carved: bool, seed: u64) -> Grid {
    let dims = UVec3::from(dims);
    let mut random = Random(seed);
    let balls: Vec<(Vec3, f32)> =
        (0..40).map(|_| (point(&mut random, dims), range(&mut random, 2.0, 16.0))).collect();
    let mut grid = empty(dims, voxel_size);
    fill(&mut grid, |p| balls.iter().any(|(c, r)| c.distance(p) < *r) != carved);
    grid
}

/// Spherical shells one voxel thick, inside each other.
pub fn shells(edge: u32) -> Grid {
    let mut grid = empty(UVec3::splat(edge), Vec3::ONE);
    let centre = Vec3::splat(0.5 * edge as f32);
    fill(&mut grid, |p| {
        let r = p.distance(centre);
        // Open on one side, so that the inner ones are seen.
        (r % 9.0) < 1.0 && p.x + p.y < 1.3 * edge as f32
    });
    grid
}

/// Single voxels, `share` of all.
pub fn noise(dims: [u32; 3], share: f32, seed: u64) -> Grid {
    let mut random = Random(seed);
    let mut grid = empty(UVec3::from(dims), Vec3::ONE);
    for z in 0..dims[2] {
        for y in 0..dims[1] {
            for x in 0..dims[0] {
                grid.set(UVec3::new(x, y, z).as_ivec3(), range(&mut random, 0.0, 1.0) < share);
            }
        }
    }
    grid
}

pub fn dust(dims: [u32; 3]) -> Grid {
    let mut random = Random(7);
    let mut grid = empty(UVec3::from(dims), Vec3::ONE);
    for _ in 0..60 {
        let v = point(&mut random, UVec3::from(dims)).as_ivec3();
        grid.set(v, true);
        grid.set(v + IVec3::X, true);
    }
    grid
}

/// A grid and the rays through the pixels of a picture of it.
pub struct Subject {
    pub name: &'static str,
    pub grid: Grid,
    pub views: Vec<View>,
}

pub struct View {
    pub eye: Eye,
    pub world_from_grid: Affine3A,
}

impl View {
    pub fn rays(&self) -> PixelRays {
        self.eye.pixel_rays(&self.world_from_grid)
    }
}

/// Odd, so that there is a pixel in the middle, whose ray runs along the view's axis.
pub const SIZE: UVec2 = UVec2::new(201, 151);

fn placed(grid: &Grid, placement: Placement) -> Affine3A {
    placement.world_from_grid(grid.dims(), grid.voxel_size())
}

/// From outside, from all sides and at odd angles.
fn outside(grid: &Grid, seed: u64) -> Vec<View> {
    let radius = 0.5 * (grid.dims().as_vec3() * grid.voxel_size()).length();
    let mut random = Random(seed);
    let mut directions = vec![Vec3::X, Vec3::NEG_Y, Vec3::Z, Vec3::new(0.8, 0.6, 1.0)];
    directions.extend((0..4).map(|_| {
        Vec3::from(std::array::from_fn(|_| range(&mut random, -1.0, 1.0))) + Vec3::splat(1e-3)
    }));
    let camera = |direction| Camera::framing(radius, direction, Vec3::Y);
    let diameter_vx = grid.dims().as_vec3().length();
    let parallel = directions.clone().into_iter().skip(2).step_by(2).map(|direction| {
        // With parallel rays: all of it, and a part.
        let camera = camera(direction);
        let nearer = if direction.x < 0.5 { 1.0 } else { 0.1 };
        Camera { eye: camera.eye * nearer, ..camera }.orthographic(2.0 * radius, diameter_vx)
    });
    let cameras: Vec<Camera> =
        directions.iter().map(|direction| camera(*direction)).chain(parallel).collect();
    let view = |camera: Camera| View {
        eye: camera.eye(SIZE),
        world_from_grid: placed(grid, Placement::default()),
    };
    cameras.into_iter().map(view).collect()
}

/// Turned, moved and scaled, seen from fixed eyes.
fn rotated(grid: &Grid, seed: u64) -> Vec<View> {
    let radius = 0.5 * (grid.dims().as_vec3() * grid.voxel_size()).length();
    let mut random = Random(seed);
    (0..5)
        .map(|_| {
            let mut angle = || range(&mut random, -3.0, 3.0);
            let rotation = Quat::from_euler(EulerRot::XYZ, angle(), angle(), angle());
            let translation = 0.2 * radius * Vec3::new(angle(), angle(), angle());
            let placement = Placement { rotation, translation, scale: 1.7 };
            View {
                eye: Camera::framing(2.0 * radius, Vec3::new(0.3, 0.1, 1.0), Vec3::Y).eye(SIZE),
                world_from_grid: placed(grid, placement),
            }
        })
        .collect()
}

/// Eyes within the grid: in the empty, in the solid, on voxel boundaries.
fn inside(grid: &Grid, fov_y_deg: f32, seed: u64) -> Vec<View> {
    let mut random = Random(seed);
    let dims = grid.dims();
    let mut eyes = vec![dims.as_vec3() * 0.5, (dims / 2).as_vec3() + Vec3::new(0.0, 0.0, 0.25)];
    eyes.extend((0..6).map(|_| point(&mut random, dims)));
    eyes.into_iter()
        .map(|eye| {
            let look = Vec3::from(std::array::from_fn(|_| range(&mut random, -1.0, 1.0)));
            let camera = Camera {
                eye: grid.voxel_size() * eye,
                target: grid.voxel_size() * eye + look + Vec3::splat(1e-3),
                up: Vec3::new(0.1, 1.0, 0.2),
                fov_y_rad: fov_y_deg.to_radians(),
                near: 0.01,
            };
            let world_from_grid = Affine3A::from_scale(grid.voxel_size());
            View { eye: camera.eye(SIZE), world_from_grid }
        })
        .collect()
}

/// Eyes on voxel boundaries and at voxel centres, inside and outside, looking along the axes.
fn along_axes(grid: &Grid) -> Vec<View> {
    let dims = grid.dims().as_vec3();
    let middle = (0.5 * dims).floor();
    let mut views = Vec::new();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for side in [-1.0, 1.0] {
            for (distance, offset) in [(0.0, 0.0), (0.0, 0.5), (1.0, 0.0), (1.0, 0.5), (3.0, 0.0)] {
                let along = side * (distance * 0.5 * dims.dot(axis)).ceil();
                let eye = middle + axis * along + Vec3::splat(offset);
                let up = if axis == Vec3::Y { Vec3::Z } else { Vec3::Y };
                let camera = Camera { eye, target: eye - side * axis, up, ..Camera::default() };
                views.push(View { eye: camera.eye(SIZE), world_from_grid: Affine3A::IDENTITY });
            }
        }
    }
    views
}

/// An off-axis frustum, as one eye of a tracked screen has it.
fn off_axis(grid: &Grid) -> Vec<View> {
    let mut views = outside(grid, 3);
    for view in &mut views {
        let frustum = Frustum { left: -0.2, right: 0.6, down: -0.5, up: 0.1 };
        view.eye.projection = frustum.projection(0.1) as Mat4;
    }
    views
}

/// All of them.
pub fn all() -> Vec<Subject> {
    let mut subjects = Vec::new();
    let mut add = |name, grid: Grid, views: Vec<View>| subjects.push(Subject { name, grid, views });
    let grid = solid([64, 64, 64]);
    let views = outside(&grid, 1);
    add("solid cube", grid, views);
    let grid = solid([13, 7, 30]);
    let views = outside(&grid, 2);
    add("solid of odd size", grid, views);
    let grid = solid([1, 1, 1]);
    let views = outside(&grid, 3);
    add("one voxel", grid, views);
    let grid = balls([100, 90, 80], Vec3::ONE, false, 4);
    let views = outside(&grid, 4);
    add("balls", grid, views);
    let grid = balls([100, 90, 80], Vec3::ONE, true, 5);
    let views = rotated(&grid, 5);
    add("carved, placed at random", grid, views);
    let grid = balls([70, 90, 50], Vec3::new(1.0, 0.4, 2.3), true, 6);
    let views = outside(&grid, 6).into_iter().chain(rotated(&grid, 6)).collect();
    add("voxels of unequal edges", grid, views);
    let grid = shells(80);
    let views = outside(&grid, 7);
    add("thin shells", grid, views);
    let grid = noise([60, 50, 40], 0.03, 8);
    let views = outside(&grid, 8).into_iter().chain(off_axis(&grid)).collect();
    add("noise", grid, views);
    let grid = dust([200, 17, 64]);
    let views = outside(&grid, 9);
    add("dust", grid, views);
    let grid = balls([100, 90, 80], Vec3::ONE, true, 10);
    let views = inside(&grid, 60.0, 10);
    add("from inside", grid, views);
    let grid = balls([100, 90, 80], Vec3::ONE, false, 11);
    let views = inside(&grid, 150.0, 11);
    add("from inside, wide", grid, views);
    let grid = noise([64, 40, 33], 0.02, 13);
    let views = along_axes(&grid);
    add("along the axes", grid, views);
    let grid = solid([40, 40, 40]);
    let views = inside(&grid, 90.0, 12);
    add("from inside a solid", grid, views);
    subjects
}
