//! Points have no gaps up close and do not shimmer far away: with both samplers their pictures cover what the index map
//! covers, and are as steady as those of the ray caster.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{Affine3A, Quat, UVec2, Vec3};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::RenderMode;
use virtual_sculpture::render::{Background, FrameDesc, Renderer, SmoothSurface};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material, NO_VOXEL, Placement, Rgb};
use virtual_sculpture::shade::{
    Lighting, NormalField, Pixels, ShadePose, ShadeSource, SoftwareShader,
};
use virtual_sculpture::surface::{IndexMap, raycast};
use virtual_sculpture::view::{Camera, Eye};

use super::fixture::with_device;
use super::modes::painted;

const MODES: [RenderMode; 2] = [RenderMode::RayPoints, RenderMode::SlicingPoints];

/// A colour that white light on grey stone never gives.
const BEHIND: Vec3 = Vec3::new(1.0, 0.0, 1.0);
const BEHIND_RGBA: [u8; 4] = [255, 0, 255, 255];

/// Grey stone.
fn document(grid: Grid) -> Document {
    let material = Material::for_grid(&grid, ColourDepth::None, Rgb::new(190, 180, 160));
    Document::from_contents(Contents::new(grid, material), Limits::default())
}

struct Screen {
    frames: Frames,
    renderer: Renderer,
}

impl Screen {
    fn new(device: &Arc<Device>) -> Screen {
        let renderer = Renderer::new(device, FORMAT).unwrap();
        Screen { frames: Frames::new(device).unwrap(), renderer }
    }

    /// The picture of `eye` by points, and the index map of the points.
    fn points(
        &mut self,
        document: &mut Document,
        eye: Eye,
        world_from_grid: &Affine3A,
        mode: RenderMode,
    ) -> (Pixels, Arc<IndexMap>) {
        let desc = FrameDesc {
            eyes: &[eye],
            world_from_grid: *world_from_grid,
            smooth_surface: SmoothSurface::Never,
            sample: 0,
            mode,
            lighting: Lighting::default(),
            show_mask: false,
            background: Background::Gradient { top: BEHIND, bottom: BEHIND },
            ground: None,
            smooth_edges: false,
            video: None,
            previews: &[],
            lines: &[],
        };
        let mut pictures = painted(&mut self.frames, &mut self.renderer, document, &desc);
        (pictures.remove(0), self.renderer.maps()[0].clone())
    }
}

/// The picture of the ray caster and the software shader. `normals` are those of the document's grid.
fn cast(
    document: &Document,
    normals: &NormalField,
    eye: &Eye,
    world_from_grid: &Affine3A,
) -> (Pixels, IndexMap) {
    let rays = eye.pixel_rays(world_from_grid);
    let mut map = IndexMap::new(rays);
    raycast::sample(document.grid(), &rays, &mut map);
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid: *world_from_grid };
    let (grid, material) = (document.grid(), document.material());
    let mut pixels = Pixels::default();
    let lighting = Lighting::default();
    let source = ShadeSource { grid, material, normals, mask: None };
    SoftwareShader::default().shade(&map, &source, &pose, &lighting, &mut pixels);
    for pixel in pixels.rgba.iter_mut().filter(|pixel| pixel[3] == 0) {
        *pixel = BEHIND_RGBA;
    }
    (pixels, map)
}

/// Pixels in which a voxel is seen and yet the background shows.
fn gaps(picture: &Pixels, map: &IndexMap) -> usize {
    let seen = picture.rgba.iter().zip(&map.voxels).filter(|&(_, &voxel)| voxel != NO_VOXEL);
    seen.filter(|(pixel, _)| **pixel == BEHIND_RGBA).count()
}

/// Pixels that show a point.
fn drawn(picture: &Pixels) -> usize {
    picture.rgba.iter().filter(|pixel| **pixel != BEHIND_RGBA).count()
}

/// Mean of each channel over the whole picture.
fn mean_colour(picture: &Pixels) -> [f64; 3] {
    let sum = |channel: usize| picture.rgba.iter().map(|p| f64::from(p[channel])).sum::<f64>();
    [0, 1, 2].map(|channel| sum(channel) / picture.rgba.len() as f64)
}

#[test]
fn near_by_points_leave_no_gaps() {
    with_device(|device| {
        let mut document = document(scenes::cheese(96, 60, 8).unwrap());
        let normals = NormalField::of(document.grid());
        let mut screen = Screen::new(device);
        let size = UVec2::new(320, 240);
        let placement = Placement {
            rotation: Quat::from_scaled_axis(Vec3::new(0.4, 1.1, -0.5)),
            translation: Vec3::ZERO,
            scale: 0.02,
        };
        let dims = document.grid().dims();
        // Turned, and straight before the eye, where the edges of voxels lie along rows of pixels.
        for world in [placement, Placement::default()].map(|p| p.world_from_grid(dims, Vec3::ONE)) {
            let scale = world.matrix3.determinant().cbrt();
            for direction in [Vec3::Z, Vec3::new(0.8, 0.6, 1.0), Vec3::new(-0.2, 1.0, 0.1)] {
                let usual = Camera::framing(85.0 * scale, direction, Vec3::Y);
                let rays = usual.eye(size).pixel_rays(&world);
                let middle = rays.direction(size.x / 2, size.y / 2);
                let hit = raycast::cast(document.grid(), rays.origin, middle).unwrap();
                let surface = world.transform_point3(rays.origin + middle * hit.t);
                for distance_vx in [1.5, 4.0, 11.0] {
                    let eye = surface + direction.normalize() * distance_vx * scale;
                    let target = surface + Vec3::new(0.2, 0.1, -0.1) * scale;
                    let near = 0.01 * scale;
                    let eye = Camera { eye, target, fov_y_rad: 1.0, near, ..usual }.eye(size);
                    let (_, seen) = cast(&document, &normals, &eye, &world);
                    let voxels: BTreeSet<u32> =
                        seen.voxels.iter().copied().filter(|&v| v != NO_VOXEL).collect();
                    let of_a_voxel = seen.covered() / voxels.len().max(1);
                    assert!(of_a_voxel > 30, "{of_a_voxel} pixels of a voxel at {distance_vx}");
                    for mode in MODES {
                        let (picture, map) = screen.points(&mut document, eye, &world, mode);
                        let what = format!("{mode:?}, {direction} at {distance_vx}");
                        assert_eq!(gaps(&picture, &seen), 0, "{what}: of what the caster sees");
                        assert_eq!(gaps(&picture, &map), 0, "{what}: of what was found");
                    }
                }
            }
        }
    });
}

/// Largest change from one value to the next.
fn largest_change(values: &[f64]) -> f64 {
    values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
}

#[test]
fn far_away_points_are_all_drawn_and_do_not_shimmer() {
    with_device(|device| {
        let mut document = document(scenes::cheese(96, 60, 8).unwrap());
        let normals = NormalField::of(document.grid());
        let mut screen = Screen::new(device);
        let world = Placement::default().world_from_grid(document.grid().dims(), Vec3::ONE);
        let views = [
            // Size, the voxel's in pixels, from where.
            (UVec2::new(203, 150), 0.6, Vec3::new(0.8, 0.6, 1.0)),
            (UVec2::new(203, 150), 0.25, Vec3::Z),
            (UVec2::new(61, 47), 0.05, Vec3::Z),
            (UVec2::new(61, 47), 0.08, Vec3::new(-0.1, 1.0, 0.2)),
            (UVec2::new(640, 480), 0.7, Vec3::new(0.1, 0.05, 1.0)),
        ];
        for ((size, voxel_px, direction), mode) in
            views.into_iter().flat_map(|view| MODES.map(|mode| (view, mode)))
        {
            let fov_y_rad = 0.7f32;
            // A pixel's edge is as long there as `1 / voxel_px` voxels.
            let pixel = 1.0 / voxel_px;
            let distance = pixel * size.y as f32 * 0.5 / (0.5 * fov_y_rad).tan();
            let camera = Camera {
                eye: direction.normalize() * distance,
                target: Vec3::ZERO,
                fov_y_rad,
                ..Camera::default()
            };
            let (mut counts, mut means) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
            for step in 0..12 {
                // An eleventh of a pixel at each step.
                let aside = Vec3::new(1.0, 0.4, 0.0) * pixel * step as f32 / 11.0;
                let eye =
                    Camera { eye: camera.eye + aside, target: camera.target + aside, ..camera };
                let eye = eye.eye(size);
                let (expected, seen) = cast(&document, &normals, &eye, &world);
                let (picture, map) = screen.points(&mut document, eye, &world, mode);
                let what = format!("{mode:?}, {size} pixels, voxels of {voxel_px}, step {step}");
                assert!(seen.covered() > 15, "{what}: {} pixels", seen.covered());
                assert_eq!(gaps(&picture, &map), 0, "{what}: found and not drawn");
                let (drawn_px, found_px) = (drawn(&picture), map.covered());
                // At an outline a device may round to the other side.
                let most_px = found_px + found_px.div_ceil(1000);
                assert!(drawn_px <= most_px, "{what}: {drawn_px} drawn, {found_px} found");
                for (picture, i) in [(&picture, 0), (&expected, 1)] {
                    counts[i].push(drawn(picture) as f64);
                    means[i].push(mean_colour(picture));
                }
            }
            let what = format!("{mode:?}, {size} pixels, voxels of {voxel_px}");
            let [points, caster] = [&counts[0], &counts[1]].map(|counts| largest_change(counts));
            trials::note!("{what}: pixels change by {points}, by the caster's {caster}");
            // Slices find another voxel than the caster at a pixel in a thousand.
            let rounding = counts[1][0] * 1e-3;
            assert!(points <= caster + rounding, "{what}: {points} pixels, caster {caster}");
            for channel in 0..3 {
                let of = |means: &[[f64; 3]]| -> Vec<f64> {
                    means.iter().map(|mean| mean[channel]).collect()
                };
                let [points, caster] = [&means[0], &means[1]].map(|m| largest_change(&of(m)));
                // A level of a channel is what the two may round apart, in each of two pictures;
                // hardly ever do all of a picture's pixels.
                assert!(points <= caster + 0.1, "{what}: {points} levels, caster {caster}");
            }
        }
    });
}
