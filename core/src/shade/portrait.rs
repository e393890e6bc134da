//! A picture of a sculpture that depends only on its voxels and colours: for hashes of its appearance, and for lists of
//! sculptures.
//!
//! Rays are cast and shaded on the CPU, from the upper right in front, with the usual light.

use glam::{UVec2, Vec3};

use super::{Lighting, NormalField, Pixels, ShadePose, ShadeSource, Smoothing, software};
use crate::sculpture::Placement;
use crate::sculpture::history::Contents;
use crate::surface::{IndexMap, raycast};
use crate::view::Camera;

/// Returns the picture, of `size` pixels; transparent where no voxel is visible. The same for any number of threads.
pub fn portrait(contents: &Contents, size: UVec2) -> Pixels {
    let Contents { grid, material, .. } = contents;
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    let radius = (grid.dims().as_vec3() * grid.voxel_size()).length() / 2.0;
    let eye = Camera::framing(radius, Vec3::new(0.8, 0.6, 1.0), Vec3::Y).eye(size);
    let rays = eye.pixel_rays(&world_from_grid);
    let mut map = IndexMap::new(rays);
    raycast::sample(grid, &rays, &mut map);
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    let lighting = Lighting { smooth_normals: Smoothing::Near, ..Lighting::default() };
    let source = ShadeSource { grid, material, normals: &NormalField::of(grid), mask: None };
    let mut pixels = Pixels::default();
    software::shade(&map, &source, &pose, &lighting, &mut pixels);
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::cheese;
    use crate::sculpture::{Brick, ColourDepth, Digest, Material, Rgb};

    #[test]
    fn a_portrait_is_the_same_for_any_number_of_threads_and_shows_the_sculpture() {
        let grid = cheese(48, 9, 7).unwrap();
        let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
        material.paint(glam::UVec3::ZERO, &Brick::FULL, Rgb::new(200, 10, 10));
        let contents = Contents::new(grid, material);
        let hashes = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let pixels = pool.install(|| portrait(&contents, UVec2::new(160, 120)));
            let seen = pixels.rgba.iter().filter(|pixel| pixel[3] > 0).count();
            assert!((2000..19_000).contains(&seen), "{seen}");
            (Digest::of(&contents), Digest::of_bytes(pixels.bytes()))
        });
        assert_eq!((hashes[0], hashes[1]), (hashes[1], hashes[2]));
    }
}
