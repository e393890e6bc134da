//! Resamples and reshades what an edit may have changed, and compares with the whole picture.

use glam::{Quat, UVec2, Vec3};
use proptest::prelude::*;

use super::occlusion::OCCLUSION_REACH_VX;
use super::{Lighting, NormalField, Pixels, ShadePose, ShadeSource, shade, shade_rect};
use crate::scenes::{self, Random};
use crate::sculpture::{ColourDepth, Grid, Material, Placement, Rgb};
use crate::surface::{IndexMap, PixelRect, changed_pixels, quickstep, raycast};
use crate::view::{Camera, PixelRays};

type Sample = fn(&Grid, &PixelRays, &mut IndexMap);
type SampleRect = fn(&Grid, &mut IndexMap, PixelRect);
const SAMPLERS: [(Sample, SampleRect); 2] =
    [(raycast::sample, raycast::sample_rect), (quickstep::sample, quickstep::sample_rect)];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Resampling and reshading only the rectangles gives the same as the whole picture.
    #[test]
    fn outside_of_the_rectangles_nothing_changes(
        seed: u64,
        spots in 1usize..12,
        eye in prop::array::uniform3(-1.2f32..1.2),
        turn in prop::array::uniform3(-3f32..3.0),
        fov_y_deg in 20f32..110.0,
        occlusion: bool,
    ) {
        let mut random = Random(seed);
        let mut grid = scenes::cheese(80, 20, seed).unwrap();
        let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::default());
        let placement = Placement {
            rotation: Quat::from_scaled_axis(Vec3::from(turn)),
            ..Placement::default()
        };
        let world_from_grid = placement.world_from_grid(grid.dims(), grid.voxel_size());
        let camera = Camera {
            eye: Vec3::from(eye) * 100.0,
            target: Vec3::splat(random.unit()),
            fov_y_rad: fov_y_deg.to_radians(),
            ..Camera::default()
        };
        let eye = camera.eye(UVec2::new(203, 149));
        let rays = eye.pixel_rays(&world_from_grid);
        let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
        let lighting = Lighting { occlusion, ..Lighting::default() };
        let mut maps = [(); 2].map(|()| IndexMap::new(rays));
        for (map, (sample, _)) in maps.iter_mut().zip(SAMPLERS) {
            sample(&grid, &rays, map);
        }
        let mut pixels = Pixels::default();
        let mut normals = NormalField::of(&grid);
        let source = ShadeSource { grid: &grid, material: &material, normals: &normals, mask: None };
        shade(&maps[0], &source, &pose, &lighting, &mut pixels);

        let mut changed = Vec::new();
        for _ in 0..spots {
            let v = random.voxel(grid.dims());
            let brick = grid.brick_index(v.as_uvec3() / 8);
            let bits = random.next_u64();
            let was = *grid.brick_at(brick);
            grid.set_brick(brick, was.zip(&was, |word, _| word ^ bits));
            material.paint(grid.brick_coords(brick), grid.brick_at(brick), Rgb([bits as u8, 90, 200]));
            changed.push(brick as u32);
        }
        changed.sort_unstable();
        changed.dedup();
        let to_sample = changed_pixels(&grid, &changed, &rays, 0);
        for (map, (sample, sample_rect)) in maps.iter_mut().zip(SAMPLERS) {
            for rect in to_sample.as_slice() {
                sample_rect(&grid, map, *rect);
            }
            let mut whole = IndexMap::new(rays);
            sample(&grid, &rays, &mut whole);
            prop_assert!(*map == whole);
        }
        normals.follow(&grid, Some(&changed));
        normals.update(&grid, &mut changed, || true);
        changed.sort_unstable();
        changed.dedup();
        let source = ShadeSource { grid: &grid, material: &material, normals: &normals, mask: None };
        let reach_vx = if occlusion { OCCLUSION_REACH_VX } else { 0 };
        let to_shade = changed_pixels(&grid, &changed, &rays, reach_vx);
        for rect in to_shade.as_slice() {
            shade_rect(&maps[0], &source, &pose, &lighting, *rect, &mut pixels);
        }
        let mut whole = Pixels::default();
        shade(&maps[0], &source, &pose, &lighting, &mut whole);
        prop_assert!(pixels == whole);
    }
}
