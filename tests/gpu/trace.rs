//! Final pictures by the device against those of the CPU: the same random numbers, so the same paths but for rounding.

use std::sync::Arc;

use glam::{UVec2, UVec3, Vec2, Vec3};
use virtual_sculpture::gpu::Device;
use virtual_sculpture::progress::ProgressReport;
use virtual_sculpture::render::{DeviceTraceError, trace_on_device};
use virtual_sculpture::scenes;
use virtual_sculpture::sculpture::{Brick, ColourDepth, Grid, Material, Placement, Rgb};
use virtual_sculpture::shade::{NormalField, ShadeSource};
use virtual_sculpture::trace::{
    AreaLight, Film, Lens, LightOptions, SunLight, TraceCamera, TraceError, TraceGround,
    TraceOptions, trace,
};
use virtual_sculpture::view::Camera;

use super::fixture::with_device;

struct Subject {
    grid: Grid,
    material: Material,
    normals: NormalField,
    shot: TraceCamera,
}

const WHITE: Rgb = Rgb::new(255, 255, 255);
const SIZE: UVec2 = UVec2::new(67, 50);

fn subject(grid: Grid, colour: Rgb, painted: bool) -> Subject {
    let mut material = Material::for_grid(&grid, ColourDepth::Bits24, colour);
    if painted {
        for index in (0..grid.brick_count()).step_by(3) {
            material.paint(grid.brick_coords(index), &Brick::FULL, Rgb::new(40, 90, 200));
        }
    }
    let normals = NormalField::of(&grid);
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    let radius = 0.5 * (grid.dims().as_vec3() * grid.voxel_size()).length();
    let eye = Camera::framing(radius, Vec3::new(0.8, 0.6, 1.0), Vec3::Y).eye(SIZE);
    Subject { grid, material, normals, shot: TraceCamera { eye, world_from_grid, up: Vec3::Y } }
}

impl Subject {
    fn source(&self) -> ShadeSource<'_> {
        ShadeSource {
            grid: &self.grid,
            material: &self.material,
            normals: &self.normals,
            mask: None,
        }
    }

    fn on_device(&self, device: &Arc<Device>, options: &TraceOptions) -> Film {
        trace_on_device(device, &self.source(), &self.shot, options, &()).unwrap()
    }

    fn on_cpu(&self, options: &TraceOptions) -> Film {
        trace((&self.source(), None), &self.shot, options, &()).unwrap()
    }
}

fn mean(film: &Film) -> Vec3 {
    film.pixels().iter().map(|pixel| pixel.radiance).sum::<Vec3>() / film.pixels().len() as f32
}

fn studio() -> LightOptions {
    let sun = SunLight { azimuth_deg: 60.0, elevation_deg: 20.0, size_deg: 5.0, strength: 0.5 };
    let lamp = AreaLight { azimuth_deg: 70.0, elevation_deg: 35.0, size: 1.5, strength: 1.0 };
    LightOptions::Outdoors { sun, sky: 0.4, area_light: Some(lamp) }
}

#[test]
fn a_device_and_the_cpu_make_the_same_picture() {
    let mut slab = Grid::new(UVec3::new(40, 20, 33), Vec3::new(1.0, 1.5, 0.8), 1 << 20).unwrap();
    slab.fill_bricks(|b| if b.y == 0 || b.x == 2 { Brick::FULL } else { Brick::EMPTY });
    let default = TraceOptions { samples: 8, ..TraceOptions::default() };
    let lens = Lens { aperture: 0.06, focus: Vec2::new(0.4, 0.6) };
    let cases = [
        (subject(scenes::cheese(64, 40, 3).unwrap(), Rgb::STONE, true), default),
        (subject(scenes::gyroid(48, 2).unwrap(), WHITE, false), TraceOptions { lens, ..default }),
        (
            subject(slab, Rgb::new(180, 60, 40), true),
            TraceOptions { light: studio(), ground: None, bounces: 2, ..default },
        ),
    ];
    with_device(|device| {
        for (subject, options) in &cases {
            let (ours, theirs) = (subject.on_device(device, options), subject.on_cpu(options));
            let (a, b) = (mean(&ours), mean(&theirs));
            assert!(((a - b) / b).abs().max_element() < 0.01, "{a} on the device, {b} on the CPU");
            let pairs = || ours.pixels().iter().zip(theirs.pixels());
            let close = |a: Vec3, b: Vec3, by: f32| (a - b).abs().max_element() < by;
            let same_light = pairs().filter(|(a, b)| close(a.radiance, b.radiance, 0.01)).count();
            let same_surface = pairs()
                .filter(|(a, b)| {
                    close(a.albedo, b.albedo, 1e-3)
                        && close(a.normal, b.normal, 1e-3)
                        && (a.depth - b.depth).abs() < 1e-3 * b.depth.max(1.0)
                })
                .count();
            let count = ours.pixels().len();
            assert!(same_surface * 100 > count * 98, "{same_surface} of {count} surfaces alike");
            assert!(same_light * 100 > count * 80, "{same_light} of {count} pixels alike");
        }
    });
}

#[test]
fn white_surfaces_vanish_in_a_white_furnace_on_the_device() {
    let subject = subject(scenes::cheese(48, 6, 5).unwrap(), WHITE, false);
    let options = TraceOptions {
        samples: 4,
        bounces: 2000,
        light: LightOptions::Uniform(Vec3::ONE),
        ground: Some(TraceGround { colour: WHITE }),
        ..TraceOptions::default()
    };
    with_device(|device| {
        let film = subject.on_device(device, &options);
        assert!(film.pixels().iter().map(|pixel| pixel.alpha).sum::<f32>() > 300.0);
        for pixel in film.pixels() {
            assert!((pixel.radiance - 1.0).abs().max_element() < 0.005, "{pixel:?}");
        }
    });
}

#[test]
fn a_cancelled_picture_of_the_device_is_none() {
    let subject = subject(scenes::solid_cube(16).unwrap(), WHITE, false);
    let report = ProgressReport::default();
    report.cancel();
    with_device(|device| {
        let options = TraceOptions::default();
        let result = trace_on_device(device, &subject.source(), &subject.shot, &options, &report);
        assert!(matches!(result, Err(DeviceTraceError::Trace(TraceError::Cancelled))));
    });
}
