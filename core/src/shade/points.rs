//! Point clouds: each voxel of an index map once, with its normal and colour, for a renderer that draws and lights
//! points.
//!
//! Takes an index map and the sculpture. Points are in the order of voxel indices, whichever sampler made the map.

use glam::Vec3;
use rayon::prelude::*;

use super::illumination::Illumination;
use super::light::Lighting;
use super::normal_field::PackedNormal;
use super::occlusion::OpennessTables;
use super::software::ShadePose;
use super::source::ShadeSource;
use crate::sculpture::NO_VOXEL;
use crate::surface::IndexMap;

/// A visible voxel, in the sixteen bytes that shaders/points.vert.wgsl reads.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SurfacePoint {
    /// Coordinates in the grid.
    pub voxel: [u16; 3],
    /// Its normal.
    pub normal: PackedNormal,
    /// The substitute for a missing normal: a vector out of the solid, of any length, a covector of grid coordinates.
    /// Then the share of ambient light that arrives, 0 to 127, with all bits inverted in the shadow of the sun.
    pub estimate: [i8; 4],
    /// sRGB, and 255.
    pub colour: [u8; 4],
}

/// The points of a picture. Keeps its memory from picture to picture.
#[derive(Clone, Debug, Default)]
pub struct PointCloud {
    indices: Vec<u32>,
    points: Vec<SurfacePoint>,
}

impl PointCloud {
    /// Replaces the points by those of `map`, with the occlusion and the colours that `lighting` specifies.
    pub fn take(
        &mut self,
        map: &IndexMap,
        source: &ShadeSource,
        pose: &ShadePose,
        lighting: &Lighting,
    ) {
        let illumination = Illumination::new(lighting, &pose.eye_from_world, &pose.world_from_grid);
        let occlusion = lighting.occlusion;
        let colours = source.colours(illumination.colour);
        let grid = source.grid;
        let width = map.rays.size.x as usize;
        self.indices.clear();
        let mut above: &[u32] = &[];
        for row in map.voxels.chunks(width.max(1)) {
            let mut last = NO_VOXEL;
            for (x, &voxel) in row.iter().enumerate() {
                // Most pixels show the voxel of a neighbour; sorting removes other duplicates.
                if voxel != NO_VOXEL && voxel != last && above.get(x) != Some(&voxel) {
                    self.indices.push(voxel);
                }
                last = voxel;
            }
            above = row;
        }
        self.indices.par_sort_unstable();
        self.indices.dedup();
        let point = |tables: &mut OpennessTables, &index: &u32| {
            let v = map.numbering.coords(index);
            let (normal, rgb) = (source.normal(v), colours.rgb(v));
            let estimate = match normal {
                PackedNormal::NONE => source.estimate(v),
                _ => Vec3::ZERO,
            };
            // Moments of 81 bits are below 40.
            let [x, y, z] = estimate.to_array().map(|c| c as i8);
            let open = if occlusion { source.openness(tables, v) } else { 1.0 };
            let open = (open * 127.0).round() as i8;
            let is_sunlit = illumination
                .sun
                .is_none_or(|sun| sun.reaching(grid, v, source.outwards(v, normal)) > 0.0);
            SurfacePoint {
                voxel: v.to_array().map(|c| c as u16),
                normal,
                estimate: [x, y, z, if is_sunlit { open } else { !open }],
                colour: [rgb.0[0], rgb.0[1], rgb.0[2], 255],
            }
        };
        let indices = self.indices.par_iter().with_min_len(256);
        indices.map_init(OpennessTables::default, point).collect_into_vec(&mut self.points);
    }

    /// Returns the points of the last call.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }
}

impl SurfacePoint {
    /// Returns the centre of the voxel, in grid coordinates.
    pub fn position(&self) -> Vec3 {
        Vec3::from(self.voxel.map(f32::from)) + 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;
    use crate::sculpture::{Brick, ColourDepth, Material, Placement, Rgb};
    use crate::shade::NormalField;
    use crate::shade::normal::gradient;
    use crate::surface::raycast;
    use crate::view::Camera;
    use glam::UVec2;
    use std::collections::BTreeSet;

    #[test]
    fn every_voxel_that_is_seen_is_one_point_with_normal_and_colour() {
        let grid = scenes::cheese(64, 30, 2).unwrap();
        let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
        for brick in (0..grid.brick_count()).step_by(2) {
            material.paint(grid.brick_coords(brick), &Brick::FULL, Rgb([brick as u8, 7, 9]));
        }
        let camera = Camera::framing(40.0, Vec3::new(1.0, 0.5, 0.7), Vec3::Y);
        let world_from_grid = Placement::default().world_from_grid(grid.dims(), Vec3::ONE);
        let eye = camera.eye(UVec2::new(150, 90));
        let rays = eye.pixel_rays(&world_from_grid);
        let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
        let mut map = IndexMap::new(rays);
        raycast::sample(&grid, &rays, &mut map);
        let seen: BTreeSet<u32> = map.voxels.iter().copied().filter(|&v| v != NO_VOXEL).collect();
        let (complete, mut incomplete) = (NormalField::of(&grid), NormalField::default());
        incomplete.follow(&grid, None);
        let mut cloud = PointCloud::default();
        let mut open_tables = OpennessTables::default();
        for (normals, occlusion) in [(&complete, false), (&complete, true), (&incomplete, false)] {
            let source = ShadeSource { grid: &grid, material: &material, normals, mask: None };
            cloud.take(&map, &source, &pose, &Lighting { occlusion, ..Lighting::default() });
            assert_eq!(cloud.points().len(), seen.len());
            for (point, &index) in cloud.points().iter().zip(&seen) {
                let v = grid.voxel_coords(index);
                assert_eq!(point.position(), v.as_vec3() + 0.5);
                assert_eq!(point.normal.unpack(), normals.normal(v));
                let [x, y, z, open] = point.estimate.map(f32::from);
                if point.normal == PackedNormal::NONE && !normals.is_complete() {
                    assert_eq!(Vec3::new(x, y, z), gradient(&grid, v));
                }
                let expected = if occlusion { source.openness(&mut open_tables, v) } else { 1.0 };
                // In steps of 1/255, then of 1/127.
                assert!((open / 127.0 - expected).abs() < 0.501 / 255.0 + 0.501 / 127.0);
                let local = crate::sculpture::brick::local_index(v.x & 7, v.y & 7, v.z & 7);
                let rgb = material.rgb(v / 8, local).0;
                assert_eq!(point.colour[..3], rgb);
            }
        }
    }
}
