//! The smooth surface on the device: its maps agree with those of the CPU, and follow edits.

use std::sync::Arc;

use glam::{IVec3, Mat3, Quat, UVec2, UVec3, Vec3};
use virtual_sculpture::gpu::{Device, Frames, ResourceUse, read_image_once, run_once};
use virtual_sculpture::render::{EyeTask, IndexTarget, LevelMarch, LevelTask, Levels, Normals};
use virtual_sculpture::scenes;
use virtual_sculpture::sculpture::{Grid, NO_VOXEL, Placement};
use virtual_sculpture::shade::normal_field::PackedNormal;
use virtual_sculpture::shade::{LevelSampler, LevelSet, NormalField};
use virtual_sculpture::surface::{IndexMap, pixels_of_grid};
use virtual_sculpture::view::{Camera, PixelRays};

use super::fixture::with_device;

/// Neither a multiple of a tile.
const SIZE: UVec2 = UVec2::new(231, 173);

fn grid_of(edge_vx: u32, mut inside: impl FnMut(Vec3) -> bool) -> Grid {
    let mut grid = Grid::new(UVec3::splat(edge_vx), Vec3::ONE, 1 << 24).unwrap();
    for i in 0..edge_vx.pow(3) {
        let v = UVec3::new(i % edge_vx, i / edge_vx % edge_vx, i / edge_vx / edge_vx);
        if inside(v.as_vec3() + 0.5) {
            grid.set(v.as_ivec3(), true);
        }
    }
    grid
}

/// Rays to the middle of the grid, from `radius_vx` around it.
fn rays_at(grid: &Grid, radius_vx: f32, direction: Vec3) -> PixelRays {
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    Camera::framing(radius_vx, direction, Vec3::Y).eye(SIZE).pixel_rays(&world_from_grid)
}

/// The surface of a grid on the CPU.
struct Smooth {
    normals: NormalField,
    levels: LevelSet,
}

impl Smooth {
    fn of(grid: &Grid) -> Smooth {
        let normals = NormalField::of(grid);
        let mut levels = LevelSet::new(grid, 1 << 30).unwrap();
        levels.update(grid, &normals, &mut Vec::new());
        Smooth { normals, levels }
    }

    fn map(&self, grid: &Grid, rays: &PixelRays, sample: u32) -> IndexMap {
        let mut map = IndexMap::new(*rays);
        let mut sampler = LevelSampler::default();
        sampler.sample = sample;
        sampler.sample(grid, &self.normals, &self.levels, rays, &mut map);
        map
    }
}

/// The same on the device.
struct OnDevice {
    normals: Normals,
    levels: Levels,
    march: LevelMarch,
}

impl OnDevice {
    fn new(device: &Arc<Device>, grid: &Grid, smooth: &Smooth) -> OnDevice {
        OnDevice {
            normals: Normals::new(device, &smooth.normals).unwrap(),
            levels: Levels::new(device, grid, &smooth.levels).unwrap(),
            march: LevelMarch::new(device, 1).unwrap(),
        }
    }

    /// Voxels, and the complement of their packed normals.
    fn map(
        &mut self,
        device: &Arc<Device>,
        smooth: &Smooth,
        rays: &PixelRays,
        sample: u32,
    ) -> Vec<[u32; 2]> {
        let mut target = IndexTarget::with_normals(device, SIZE, 1).unwrap();
        self.march.begin(0);
        let visible = pixels_of_grid(smooth.levels.cells(), &LevelSet::rays_of_cells(rays));
        let part = EyeTask { visible, ..EyeTask::whole(0, *rays) };
        let task = LevelTask { part, sample };
        run_once(device, |recorder| {
            self.march.record(recorder, &self.levels, &self.normals, &task, &mut target)?;
            target.make_readable(recorder, 0);
            Ok(())
        })
        .unwrap();
        let image = target.index().image();
        let bytes =
            read_image_once(device, image.layer(0), image.size(), 8, ResourceUse::SHADER_READ);
        bytemuck::pod_collect_to_vec(&bytes.unwrap())
    }
}

/// Asserts that both see the same, but for rounding; returns how many pixels see anything.
fn assert_agree(what: &str, found: &[[u32; 2]], expected: &IndexMap) -> usize {
    let (width, height) = (SIZE.x as i32, SIZE.y as i32);
    let at = |x: i32, y: i32| (y * width + x) as usize;
    let is_found = |i: usize| found[i][0] != NO_VOXEL;
    let is_expected = |i: usize| expected.voxels[i] != NO_VOXEL;
    let (mut both, mut same, mut outline, mut turned) = (0, 0, 0, 0);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let i = at(x, y);
        if is_found(i) != is_expected(i) {
            let around = (-1..2).flat_map(|dy| (-1..2).map(move |dx| (x + dx, y + dy)));
            let around = around.filter(|(x, y)| (0..width).contains(x) && (0..height).contains(y));
            let mut around = around.map(|(x, y)| at(x, y));
            let near = around.any(|j| is_found(i) == is_expected(j));
            assert!(near, "{what}: the outline is elsewhere at {x}, {y}");
            outline += 1;
        } else if is_found(i) {
            both += 1;
            same += usize::from(found[i][0] == expected.voxels[i]);
            let normals = [(found[i][1] ^ 0xffff) as u16, expected.normals[i]];
            turned += match normals.map(|code| PackedNormal(code).unpack()) {
                [Some(a), Some(b)] => usize::from(a.angle_between(b).to_degrees() > 1.5),
                normals => usize::from(normals[0] != normals[1]),
            };
        }
    }
    assert!(
        100 * outline <= both,
        "{what}: {outline} pixels of the outline, {both} of the surface"
    );
    assert!(100 * (both - same) <= both, "{what}: {same} of {both} pixels see the same voxel");
    assert!(200 * turned <= both, "{what}: {turned} of {both} normals differ");
    both
}

#[test]
fn the_device_sees_the_smooth_surface_of_the_cpu() {
    let middle = Vec3::new(24.3, 23.7, 24.1);
    let turn = Mat3::from_quat(Quat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2));
    let mut random = scenes::Random(5);
    let shapes = [
        ("ball", grid_of(48, |p| p.distance(middle) < 19.0)),
        (
            "cuboid",
            grid_of(48, |p| (turn * (p - middle)).abs().cmplt(Vec3::new(16.0, 9.0, 12.0)).all()),
        ),
        (
            "wall",
            grid_of(48, |p| (turn * (p - middle)).x.abs() < 1.0 && p.cmpgt(Vec3::splat(4.0)).all()),
        ),
        ("noise", grid_of(24, |_| random.next_u64().is_multiple_of(3))),
        ("full", grid_of(40, |_| true)),
        ("cheese", scenes::cheese(51, 20, 2).unwrap()),
    ];
    with_device(|device| {
        for (name, grid) in &shapes {
            let smooth = Smooth::of(grid);
            let mut on_device = OnDevice::new(device, grid, &smooth);
            for (radius_vx, direction, sample) in [
                (36.0, Vec3::new(0.8, 0.6, 1.0), 0),
                (14.0, Vec3::new(-0.3, 0.2, 1.0), 3),
                (36.0, Vec3::X, 0),
            ] {
                let rays = rays_at(grid, radius_vx, direction);
                let found = on_device.map(device, &smooth, &rays, sample);
                let what = format!("{name} from {direction}");
                let seen = assert_agree(&what, &found, &smooth.map(grid, &rays, sample));
                assert!(seen > 2000, "{what}: {seen} pixels");
            }
            // From within the solid, and from within the grid.
            for origin in [Vec3::splat(20.3), Vec3::new(2.2, 3.1, 2.9)] {
                let rays = PixelRays { origin, ..rays_at(grid, 36.0, Vec3::new(-0.8, -0.6, -1.0)) };
                let found = on_device.map(device, &smooth, &rays, 0);
                assert_agree(&format!("{name} from {origin}"), &found, &smooth.map(grid, &rays, 0));
            }
        }
    });
}

#[test]
fn an_empty_grid_has_no_surface_on_the_device() {
    with_device(|device| {
        let grid = grid_of(20, |_| false);
        let rays = rays_at(&grid, 20.0, Vec3::ONE);
        let smooth = Smooth::of(&grid);
        let found = OnDevice::new(device, &grid, &smooth).map(device, &smooth, &rays, 0);
        assert!(found.iter().all(|[voxel, _]| *voxel == NO_VOXEL));
    });
}

/// A copy that follows edits is a copy made anew, whether the surface grows, vanishes or moves.
#[test]
fn edits_of_the_smooth_surface_are_uploaded_one_by_one() {
    with_device(|device| {
        let mut grid = scenes::cheese(51, 20, 2).unwrap();
        let mut smooth = Smooth::of(&grid);
        let mut on_device = OnDevice::new(device, &grid, &smooth);
        let mut frames = Frames::new(device).unwrap();
        let rays = rays_at(&grid, 36.0, Vec3::new(0.8, 0.6, 1.0));
        let mut before = on_device.map(device, &smooth, &rays, 0);
        let balls: [(Vec3, f32, bool); 5] = [
            (Vec3::new(40.0, 42.0, 46.0), 9.0, false),
            (Vec3::new(44.0, 30.0, 49.0), 6.0, true),
            (Vec3::splat(50.0), 12.0, true),
            // All of it, and half of it again: bricks become empty and full without a surface in them.
            (Vec3::splat(25.0), 90.0, false),
            (Vec3::splat(10.0), 30.0, true),
        ];
        for (middle, radius_vx, exists) in balls {
            let mut edited = Vec::new();
            for i in 0..51 * 51 * 51 {
                let v = IVec3::new(i % 51, i / 51 % 51, i / 51 / 51);
                let is_inside = (v.as_vec3() + 0.5).distance(middle) < radius_vx;
                if is_inside && grid.get(v) != exists {
                    grid.set(v, exists);
                    edited.push(grid.brick_index(v.as_uvec3() / 8) as u32);
                }
            }
            edited.sort_unstable();
            edited.dedup();
            let Smooth { normals, levels } = &mut smooth;
            let (mut reshaded, mut written, mut changed) = (edited.clone(), Vec::new(), Vec::new());
            normals.follow(&grid, Some(&edited));
            normals.update(&grid, &mut reshaded, || true);
            normals.take_written(&mut written);
            reshaded.sort_unstable();
            reshaded.dedup();
            levels.follow(&grid, &reshaded);
            levels.update(&grid, normals, &mut changed);
            assert!(on_device.levels.follow(&grid, levels, &changed), "there is room for them");
            let mut recorder = frames.begin().unwrap();
            let slot = frames.slot();
            let followed = (&grid, &*normals);
            on_device.normals.update(&mut recorder, slot, followed, &written, &reshaded).unwrap();
            on_device.levels.update(&mut recorder, slot, &grid, levels).unwrap();
            device.wait(frames.submit(recorder, &[], &[]).unwrap()).unwrap();
            let found = on_device.map(device, &smooth, &rays, 0);
            let anew = Smooth::of(&grid);
            let anew = OnDevice::new(device, &grid, &anew).map(device, &anew, &rays, 0);
            assert!(found == anew, "{middle} {radius_vx}");
            assert!(found != before, "{middle} {radius_vx} is seen");
            before = found;
        }
    });
}
