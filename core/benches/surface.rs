//! Measures the kernels of a picture on the CPU, by scene: exact ray caster, Quickstep, software shader, and all of a
//! partial update; and meshes of the voxels' faces and of a given smooth surface. The view is that of
//! `virtual-sculpture bench`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{Affine3A, UVec2, Vec3};
use sculpture_core::mesh::{Mesh, MeshKind, VertexColours};
use sculpture_core::scenes;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::{Brick, ColourDepth, Grid, Limits, Material, Rgb};
use sculpture_core::shade::{
    self, LevelSet, Lighting, NormalField, Pixels, ShadePose, ShadeSource,
};
use sculpture_core::surface::{IndexMap, changed_pixels, quickstep, raycast};
use sculpture_core::view::Camera;

fn subjects() -> Vec<(&'static str, Grid)> {
    let grids = [
        ("cube_256", scenes::solid_cube(256)),
        ("engine_256", scenes::engine_like(256)),
        ("cheese_512", scenes::cheese(512, 2000, 1)),
        ("gyroid_512", scenes::gyroid(512, 1)),
    ];
    grids.into_iter().map(|(name, grid)| (name, grid.expect("the scenes are small"))).collect()
}

fn pictures(c: &mut Criterion) {
    for (name, mut grid) in subjects() {
        let edge = grid.dims().x as f32;
        let world_from_grid = Affine3A::from_translation(Vec3::splat(-0.5 * edge));
        let camera = Camera {
            eye: Vec3::new(0.8, 0.6, 1.0) / 2f32.sqrt() * 1.9 * edge,
            near: 0.01 * edge,
            ..Camera::default()
        };
        let eye = camera.eye(UVec2::new(640, 480));
        let rays = eye.pixel_rays(&world_from_grid);
        let base = Rgb::new(200, 190, 170);
        let material = Material::for_grid(&grid, ColourDepth::None, base);
        let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
        let lighting = Lighting::default();
        let mut map = IndexMap::new(rays);
        let mut pixels = Pixels::new(rays.size);
        let mut normals = NormalField::of(&grid);

        let mut group = c.benchmark_group("picture");
        group.bench_function(BenchmarkId::new("quickstep", name), |b| {
            b.iter(|| quickstep::sample(&grid, &rays, &mut map));
        });
        group.bench_function(BenchmarkId::new("ray", name), |b| {
            b.iter(|| raycast::sample(&grid, &rays, &mut map));
        });
        group.bench_function(BenchmarkId::new("shade", name), |b| {
            let source =
                ShadeSource { grid: &grid, material: &material, normals: &normals, mask: None };
            b.iter(|| shade::shade(&map, &source, &pose, &lighting, &mut pixels));
        });
        let contents = Contents::new(grid.clone(), material.clone());
        group.bench_function(BenchmarkId::new("mesh_faces", name), |b| {
            b.iter(|| {
                Mesh::of(&contents, MeshKind::Faces, VertexColours::Voxels, &Limits::default(), &())
            });
        });
        let mut levels = LevelSet::new(&grid, u64::MAX).expect("the scenes are small");
        levels.update(&grid, &normals, &mut Vec::new());
        group.bench_function(BenchmarkId::new("mesh_smooth", name), |b| {
            b.iter(|| {
                Mesh::smooth(&contents, &levels, VertexColours::Voxels, &Limits::default(), &())
            });
        });
        drop((contents, levels));
        // The bricks of a ball of radius 32 at the side of the grid that faces the eye.
        let middle = grid.brick_dims().as_vec3() * Vec3::new(0.5, 0.5, 1.0);
        let changed: Vec<u32> = (0..grid.brick_count())
            .filter(|&index| grid.brick_coords(index).as_vec3().distance(middle) < 4.5)
            .map(|index| index as u32)
            .collect();
        group.bench_function(BenchmarkId::new("partial_update", name), |b| {
            let source =
                ShadeSource { grid: &grid, material: &material, normals: &normals, mask: None };
            b.iter(|| {
                let rects = changed_pixels(&grid, &changed, &rays, 16);
                for &rect in rects.as_slice() {
                    raycast::sample_rect(&grid, &mut map, rect);
                    shade::shade_rect(&map, &source, &pose, &lighting, rect, &mut pixels);
                }
                black_box(rects)
            });
        });
        group.bench_function(BenchmarkId::new("normals", name), |b| {
            b.iter(|| NormalField::of(&grid));
        });
        // The same bricks without their voxels and with them, alternately.
        let bricks: Vec<_> = changed.iter().map(|&index| *grid.brick_at(index as usize)).collect();
        let mut is_carved = false;
        group.bench_function(BenchmarkId::new("normals_of_edit", name), |b| {
            b.iter(|| {
                is_carved = !is_carved;
                for (&index, brick) in changed.iter().zip(&bricks) {
                    let brick = if is_carved { Brick::EMPTY } else { *brick };
                    grid.set_brick(index as usize, brick);
                }
                normals.follow(&grid, Some(&changed));
                let mut differs = Vec::new();
                normals.update(&grid, &mut differs, || true);
                differs
            });
        });
        group.finish();
    }
}

criterion_group!(benches, pictures);
criterion_main!(benches);
