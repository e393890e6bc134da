//! The software shader with its filters of normals and colours. Without filters it equals [`super::shade`], which needs
//! neither memory nor a second pass.
//!
//! Has the inputs and outputs of [`super::shade`]. Keeps its memory from picture to picture.

use fearless_simd::{Level, Simd, dispatch, prelude::*};
use glam::{Mat3, UVec3, Vec3};
use rayon::prelude::*;

use super::illumination::{Illumination, LANES, SurfacePoints};
use super::light::{Lighting, Smoothing};
use super::normal_field::PackedNormal;
use super::occlusion::OpennessTables;
use super::pixels::Pixels;
use super::smooth::{PixelSurface, Surfaces};
use super::software::{ShadePose, shade};
use super::source::ShadeSource;
use crate::sculpture::NO_VOXEL;
use crate::surface::{IndexMap, VoxelNumbering};

/// The software shader with its buffers.
#[derive(Debug, Default)]
pub struct SoftwareShader {
    shown: Vec<PixelSurface>,
    smooth: Vec<PixelSurface>,
    /// Shares of the ambient light and of the sun's that arrive.
    reaching: Vec<[f32; 2]>,
}

impl SoftwareShader {
    /// Shades every pixel of `map`, with the options in `lighting`. `out` takes the size of the map and keeps its
    /// memory.
    pub fn shade(
        &mut self,
        map: &IndexMap,
        source: &ShadeSource,
        pose: &ShadePose,
        lighting: &Lighting,
        out: &mut Pixels,
    ) {
        let filters = [lighting.smooth_normals, lighting.smooth_colours];
        if filters == [Smoothing::Off; 2] {
            return shade(map, source, pose, lighting, out);
        }
        let illumination = Illumination::new(lighting, &pose.eye_from_world, &pose.world_from_grid);
        out.reset(map.rays.size);
        let width = map.rays.size.x as usize;
        if width == 0 || map.rays.size.y == 0 {
            return;
        }
        self.look(map, source, &illumination, lighting.occlusion);
        let edges = illumination.eye_from_grid.matrix3;
        let volume = edges.determinant().abs();
        let distance = edges * glam::Vec3A::from(map.rays.corner);
        let pixel = edges * glam::Vec3A::from(map.rays.step_x);
        let surfaces = Surfaces {
            size: map.rays.size,
            voxels: &map.voxels,
            shown: &self.shown,
            voxel_edge: volume.cbrt(),
            pixel_at_1: pixel.length() / distance.z.abs(),
        };
        let [normals, colours] = filters;
        surfaces.smooth(normals, colours, &mut self.smooth);
        let shown = &self.smooth;
        let reaching = &self.reaching;
        let back = illumination.normal_from_gradient.inverse();
        let rows = out.rgba.par_chunks_mut(width).zip(map.voxels.par_chunks(width)).enumerate();
        rows.for_each(|(y, (out, voxels))| {
            let row = y * width..(y + 1) * width;
            let row = PixelRow {
                numbering: &map.numbering,
                voxels,
                shown: &shown[row.clone()],
                reaching: &reaching[row],
            };
            dispatch!(Level::new(), simd => row.shade(simd, &illumination, &back, out));
        });
    }

    /// Finds the surface of each pixel.
    fn look(
        &mut self,
        map: &IndexMap,
        source: &ShadeSource,
        illumination: &Illumination,
        occlusion: bool,
    ) {
        let grid = source.grid;
        let width = map.rays.size.x as usize;
        self.shown.resize(map.voxels.len(), PixelSurface::default());
        self.reaching.resize(map.voxels.len(), [1.0; 2]);
        let rows = self.shown.par_chunks_mut(width).zip(self.reaching.par_chunks_mut(width));
        rows.zip(map.voxels.par_chunks(width)).enumerate().for_each(
            |(y, ((shown, reaching), voxels))| {
                let normals = map.normals.get(y * width..(y + 1) * width);
                let mut last = (NO_VOXEL, PixelSurface::default(), [1.0; 2]);
                let mut tables = OpennessTables::default();
                for (x, ((shown, reaching), &voxel)) in
                    shown.iter_mut().zip(reaching).zip(voxels).enumerate()
                {
                    if voxel == NO_VOXEL {
                        continue;
                    }
                    if voxel != last.0 {
                        let v = map.numbering.coords(voxel);
                        let open = if occlusion { source.openness(&mut tables, v) } else { 1.0 };
                        let sunlit = illumination.sun.map_or(1.0, |sun| {
                            sun.reaching(grid, v, source.outwards(v, source.normal(v)))
                        });
                        last = (voxel, show(source, illumination, v), [open, sunlit]);
                    }
                    (*shown, *reaching) = (last.1, last.2);
                    let own = normals.and_then(|normals| PackedNormal(normals[x]).unpack());
                    if let Some(normal) = own {
                        shown.normal =
                            (illumination.normal_from_gradient * normal).normalize_or_zero();
                    }
                }
            },
        );
    }
}

fn show(source: &ShadeSource, illumination: &Illumination, v: UVec3) -> PixelSurface {
    let rgb = source.colours(illumination.colour).rgb(v);
    let normal = illumination.normal_from_gradient * source.outwards(v, source.normal(v));
    let colour = Vec3::from(rgb.0.map(f32::from)) / 255.0;
    PixelSurface {
        position: illumination.eye_from_grid.transform_point3(v.as_vec3() + 0.5),
        normal: normal.normalize_or_zero(),
        colour: colour * colour,
    }
}

/// A row of pixels with their surfaces.
struct PixelRow<'a> {
    numbering: &'a VoxelNumbering,
    voxels: &'a [u32],
    shown: &'a [PixelSurface],
    reaching: &'a [[f32; 2]],
}

impl PixelRow<'_> {
    /// Shades a row. `back` maps normals in eye space to gradients.
    #[inline(always)]
    fn shade<S: Simd>(
        &self,
        simd: S,
        illumination: &Illumination,
        back: &Mat3,
        out: &mut [[u8; 4]],
    ) {
        let mut points = SurfacePoints::default();
        for first in (0..out.len()).step_by(LANES) {
            let lanes = first..out.len().min(first + LANES);
            if self.voxels[lanes.clone()].iter().all(|&v| v == NO_VOXEL) {
                out[lanes].fill([0; 4]);
                continue;
            }
            for (lane, i) in lanes.clone().enumerate() {
                if self.voxels[i] == NO_VOXEL {
                    continue;
                }
                let shown = &self.shown[i];
                let position = self.numbering.coords(self.voxels[i]).as_vec3() + 0.5;
                let gradient = *back * shown.normal;
                for axis in 0..3 {
                    points.position[axis][lane] = position[axis];
                    points.gradient[axis][lane] = gradient[axis];
                }
                let [r, g, b] = shown.colour.to_array().map(|c| (c.sqrt() * 255.0 + 0.5) as u8);
                points.colour[lane] = u32::from_le_bytes([r, g, b, 0]);
                [points.open[lane], points.sunlit[lane]] = self.reaching[i];
            }
            let colours = illumination.shade(simd, &points).to_array();
            for (lane, i) in lanes.enumerate() {
                let seen = self.voxels[i] != NO_VOXEL;
                out[i] = if seen { colours[lane].to_le_bytes() } else { [0; 4] };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;
    use crate::sculpture::{ColourDepth, Grid, Material, Placement, Rgb};
    use crate::shade::NormalField;
    use crate::surface::raycast;
    use crate::view::Camera;
    use glam::UVec2;

    fn shaded(grid: &Grid, lighting: &Lighting, shader: &mut SoftwareShader) -> Pixels {
        let material = Material::for_grid(grid, ColourDepth::Bits24, Rgb::STONE);
        let camera = Camera::framing(40.0, Vec3::new(1.0, 0.5, 0.7), Vec3::Y);
        let eye = camera.eye(UVec2::new(150, 90));
        let world_from_grid = Placement::default().world_from_grid(grid.dims(), Vec3::ONE);
        let rays = eye.pixel_rays(&world_from_grid);
        let mut map = IndexMap::new(rays);
        raycast::sample(grid, &rays, &mut map);
        let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
        let mut out = Pixels::default();
        let normals = NormalField::of(grid);
        let source = ShadeSource { grid, material: &material, normals: &normals, mask: None };
        shader.shade(&map, &source, &pose, lighting, &mut out);
        out
    }

    fn difference(a: &Pixels, b: &Pixels) -> u32 {
        let pairs = a.bytes().iter().zip(b.bytes());
        pairs.map(|(a, b)| u32::from(a.abs_diff(*b))).sum()
    }

    /// The passes for filters and occlusion, with nothing to do, give the plain shader's picture.
    #[test]
    fn open_surroundings_and_equal_neighbours_change_nothing() {
        let mut grid = Grid::new(UVec3::splat(64), Vec3::ONE, 1 << 20).unwrap();
        // Voxels so far apart that each lies outside the filters and the occlusion of the others.
        for i in 0..64 {
            grid.set(glam::IVec3::new(i % 4, i / 4 % 4, i / 16) * 16, true);
        }
        let mut shader = SoftwareShader::default();
        let plain = Lighting::default();
        let short = shaded(&grid, &plain, &mut shader);
        let all = Lighting {
            occlusion: true,
            smooth_normals: Smoothing::Near,
            smooth_colours: Smoothing::Near,
            ..plain
        };
        assert_eq!(shaded(&grid, &all, &mut shader), short);
    }

    #[test]
    fn each_option_changes_the_picture_its_own_way() {
        let grid = scenes::cheese(64, 30, 2).unwrap();
        let mut shader = SoftwareShader::default();
        let plain = Lighting::default();
        let short = shaded(&grid, &plain, &mut shader);
        let dark = shaded(&grid, &Lighting { occlusion: true, ..plain }, &mut shader);
        assert!(dark.bytes().iter().zip(short.bytes()).all(|(dark, short)| dark <= short));
        assert!(difference(&dark, &short) > 1000);
        let normals = Lighting { smooth_normals: Smoothing::Wide, ..plain };
        assert!(difference(&shaded(&grid, &normals, &mut shader), &short) > 1000);
        // A uniform colour stays unchanged.
        let colours = Lighting { smooth_colours: Smoothing::Wide, ..plain };
        assert_eq!(shaded(&grid, &colours, &mut shader), short);
    }
}
