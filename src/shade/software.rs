//! Owns the software shader: from an index map, the grid and its colours to a picture.
//!
//! Takes what is seen and how it is lit; gives RGBA with alpha 0 where nothing is seen. Works in
//! eye space, on all cores, without allocating.

use glam::{Affine3A, Mat3, Vec3};
use rayon::prelude::*;

use super::light::{EyeLighting, Lighting, SurfacePoint, linear, srgb};
use super::normal;
use super::pixels::Pixels;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_index};
use crate::sculpture::{Grid, Material, NO_VOXEL};
use crate::surface::IndexMap;

/// Pixels that one parallel task shades.
const TASK_PIXELS: usize = 4096;

/// Where the sculpture and the eye are.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ShadePose {
    pub eye_from_world: Affine3A,
    pub world_from_grid: Affine3A,
}

/// Shades every pixel of `map`. `out` takes the size of the map and keeps its memory.
pub fn shade(
    map: &IndexMap,
    grid: &Grid,
    material: &Material,
    pose: &ShadePose,
    lighting: &Lighting,
    out: &mut Pixels,
) {
    out.reset(map.rays.size);
    let shader = Shader {
        grid,
        material,
        eye_from_grid: pose.eye_from_world * pose.world_from_grid,
        normal_from_gradient: normal_matrix(&(pose.eye_from_world * pose.world_from_grid)),
        lighting: EyeLighting::new(lighting, &pose.eye_from_world),
    };
    out.rgba.par_chunks_mut(TASK_PIXELS).zip(map.voxels.par_chunks(TASK_PIXELS)).for_each(
        |(out, voxels)| {
            for (pixel, &voxel) in out.iter_mut().zip(voxels) {
                *pixel = if voxel == NO_VOXEL { [0; 4] } else { shader.pixel(voxel) };
            }
        },
    );
}

/// Takes gradients (covectors) from grid to eye space: the inverse transpose.
fn normal_matrix(eye_from_grid: &Affine3A) -> Mat3 {
    Mat3::from(eye_from_grid.matrix3).inverse().transpose()
}

/// What all pixels of a picture share.
struct Shader<'a> {
    grid: &'a Grid,
    material: &'a Material,
    eye_from_grid: Affine3A,
    normal_from_gradient: Mat3,
    lighting: EyeLighting,
}

impl Shader<'_> {
    fn pixel(&self, voxel: u32) -> [u8; 4] {
        let v = self.grid.voxel_coords(voxel);
        let position = self.eye_from_grid.transform_point3(v.as_vec3() + 0.5);
        let gradient = normal::gradient(self.grid, v);
        let normal = facing(self.normal_from_gradient * gradient, position);
        let brick = self.grid.brick_index(v / BRICK_EDGE_VX);
        let albedo = linear(self.material.rgb(brick, local_index(v.x & 7, v.y & 7, v.z & 7)));
        let [r, g, b] = srgb(self.lighting.reflected(&SurfacePoint { position, normal, albedo })).0;
        [r, g, b, 255]
    }
}

/// The unit normal from one of any length at a point seen from the origin: what is seen cannot
/// look away, so the part of the normal that does is taken off, and a voxel without a normal
/// faces the eye.
fn facing(normal: Vec3, position: Vec3) -> Vec3 {
    let to_eye = (-position).normalize_or_zero();
    let normal = normal.normalize_or_zero();
    let away = normal.dot(to_eye).min(0.0);
    (normal - to_eye * away).try_normalize().unwrap_or(to_eye)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::{Brick, ColourDepth, Placement, Rgb};
    use crate::surface::raycast;
    use crate::view::Camera;
    use glam::{UVec2, UVec3};

    #[test]
    fn a_lit_face_is_brighter_than_its_ambient_light_and_nothing_is_transparent() {
        let mut grid = Grid::new(UVec3::splat(16), Vec3::ONE, 1 << 20).unwrap();
        grid.fill_bricks(|_| Brick::FULL);
        let material = Material::new(ColourDepth::Bits24, Rgb::new(200, 100, 50), 8);
        let eye = Camera::framing(16.0, Vec3::Z, Vec3::Y).eye(UVec2::new(64, 48));
        let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
        let rays = eye.pixel_rays(&world_from_grid);
        let mut map = IndexMap::new(rays);
        raycast::sample(&grid, &rays, &mut map);
        let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
        let mut lit = Pixels::default();
        shade(&map, &grid, &material, &pose, &Lighting::default(), &mut lit);
        let dark = Lighting { lights: [None; 4], ..Lighting::default() };
        let mut unlit = Pixels::default();
        shade(&map, &grid, &material, &pose, &dark, &mut unlit);
        let seen = lit.rgba.iter().filter(|p| p[3] == 255).count();
        assert_eq!(seen, map.covered());
        let centre = 24 * 64 + 32;
        assert!(lit.rgba[centre][0] > unlit.rgba[centre][0] + 50);
        assert_eq!(lit.rgba[0], [0; 4]);
        // 200 / 255 times 80 / 255, both square-rooted back from gamma 2.0.
        assert_eq!(unlit.rgba[centre][..3], [63, 31, 17]);
    }
}
