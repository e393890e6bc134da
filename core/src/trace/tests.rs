//! Tests general properties of final pictures: energy, independence of threads, the lens, the filter.

use glam::{UVec2, UVec3, Vec2, Vec3};

use super::*;
use crate::progress::ProgressReport;
use crate::scenes;
use crate::sculpture::{ColourDepth, Grid, Material, Placement};
use crate::shade::NormalField;
use crate::view::Camera;

pub(super) struct Subject {
    pub grid: Grid,
    pub material: Material,
    pub normals: NormalField,
    pub camera: TraceCamera,
}

pub(super) fn subject(grid: Grid, colour: Rgb, size: UVec2) -> Subject {
    let material = Material::for_grid(&grid, ColourDepth::Bits24, colour);
    let normals = NormalField::of(&grid);
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    let radius = 0.5 * (grid.dims().as_vec3() * grid.voxel_size()).length();
    let eye = Camera::framing(radius, Vec3::new(0.8, 0.6, 1.0), Vec3::Y).eye(size);
    let camera = TraceCamera { eye, world_from_grid, up: Vec3::Y };
    Subject { grid, material, normals, camera }
}

impl Subject {
    pub fn source(&self) -> ShadeSource<'_> {
        ShadeSource {
            grid: &self.grid,
            material: &self.material,
            normals: &self.normals,
            mask: None,
        }
    }

    pub fn trace(&self, options: &TraceOptions) -> Film {
        trace((&self.source(), None), &self.camera, options, &()).unwrap()
    }
}

pub(super) const WHITE: Rgb = Rgb::new(255, 255, 255);
pub(super) const SIZE: UVec2 = UVec2::new(80, 60);

pub(super) fn cheese() -> Grid {
    scenes::cheese(64, 40, 3).unwrap()
}

/// Returns a ball of voxels that are 2.5 times as high as wide, with steps of all slopes.
pub(super) fn stretched_ball() -> Grid {
    let mut grid = Grid::new(UVec3::new(60, 24, 60), Vec3::new(1.0, 2.5, 1.0), 1 << 20).unwrap();
    grid.fill_bricks(|brick| {
        let mut voxels = crate::sculpture::Brick::EMPTY;
        for local in 0..512 {
            let [x, y, z] = local_coords(local);
            let at = (brick * 8 + UVec3::new(x, y, z)).as_vec3() + 0.5 - grid_middle();
            voxels.set(x, y, z, (at * Vec3::new(1.0, 2.5, 1.0)).length() < 28.0);
        }
        voxels
    });
    grid
}

fn grid_middle() -> Vec3 {
    Vec3::new(30.0, 12.0, 30.0)
}

/// In light of the same strength from all directions, surfaces that reflect all of it are invisible.
#[test]
fn white_surfaces_vanish_in_a_white_furnace() {
    for grid in [cheese(), scenes::gyroid(64, 1).unwrap(), stretched_ball()] {
        let subject = subject(grid, WHITE, SIZE);
        let furnace = TraceOptions {
            samples: 4,
            bounces: 4000,
            light: LightOptions::Uniform(Vec3::ONE),
            ground: Some(TraceGround { colour: WHITE }),
            ..TraceOptions::default()
        };
        for ground in [None, furnace.ground] {
            let film = subject.trace(&TraceOptions { ground, ..furnace });
            assert!(film.pixels().iter().map(|pixel| pixel.alpha).sum::<f32>() > 500.0);
            for pixel in film.pixels() {
                let error = (pixel.radiance - 1.0).abs().max_element();
                assert!(error < 0.005, "{:?}", pixel);
            }
        }
    }
}

/// Little light is lost after the usual number of bounces, even where nothing is absorbed.
#[test]
fn few_paths_end_early() {
    let subject = subject(stretched_ball(), WHITE, SIZE);
    let light = LightOptions::Uniform(Vec3::ONE);
    let film = subject.trace(&TraceOptions { samples: 4, light, ..TraceOptions::default() });
    let sum: f32 = film.pixels().iter().map(|pixel| pixel.radiance.x).sum();
    assert!(sum / film.pixels().len() as f32 > 0.4 && sum / film.pixels().len() as f32 <= 1.0);
}

/// Seen from so far away that rounding moves points of rays by fractions of a voxel.
#[test]
fn the_furnace_is_white_from_afar() {
    let mut subject = subject(cheese(), WHITE, UVec2::splat(40));
    let eye = Vec3::new(0.8, 0.6, 1.0).normalize() * 240_000.0;
    let camera = Camera { eye, fov_y_rad: 120.0 / 240_000.0, near: 100.0, ..Camera::default() };
    subject.camera.eye = camera.eye(UVec2::splat(40));
    let light = LightOptions::Uniform(Vec3::ONE);
    let options =
        TraceOptions { samples: 4, bounces: 4000, light, ground: None, ..TraceOptions::default() };
    let film = subject.trace(&options);
    let seen: f32 = film.pixels().iter().map(|pixel| pixel.alpha).sum();
    assert!(seen > 150.0, "{seen} pixels");
    for pixel in film.pixels() {
        assert!((pixel.radiance - 1.0).abs().max_element() < 0.005, "{pixel:?}");
    }
}

#[test]
fn no_surface_sends_more_light_than_it_gets() {
    let subject = subject(cheese(), Rgb::new(200, 120, 60), SIZE);
    for (radiance, bounces) in [(0.5, 8), (2.0, 0), (2.0, 8)] {
        let light = LightOptions::Uniform(Vec3::splat(radiance));
        let options =
            TraceOptions { samples: 8, bounces, light, ground: None, ..Default::default() };
        for pixel in subject.trace(&options).pixels().iter().filter(|pixel| pixel.alpha == 1.0) {
            let most = pixel.albedo * radiance;
            // Roulette makes single paths brighter, but not their mean.
            assert!(bounces > 0 || pixel.radiance.cmple(most * 1.0001).all(), "{pixel:?}");
            assert!(pixel.radiance.min_element() >= 0.0);
        }
    }
}

#[test]
fn a_surface_in_the_open_is_as_bright_as_its_light_says() {
    // The top of a slab under a sky without a sun receives all of its light, and none from elsewhere.
    let mut grid = Grid::new(UVec3::new(64, 8, 64), Vec3::ONE, 1 << 20).unwrap();
    grid.fill_bricks(|_| crate::sculpture::Brick::FULL);
    let mut subject = subject(grid, WHITE, UVec2::splat(16));
    subject.camera.eye = Camera::framing(8.0, Vec3::Y, Vec3::Z).eye(UVec2::splat(16));
    let sun = SunLight { azimuth_deg: 30.0, elevation_deg: 50.0, size_deg: 1.0, strength: 1.0 };
    let light = LightOptions::Outdoors { sun, sky: 1.0, area_light: None };
    let options = TraceOptions { samples: 64, light, ground: None, ..TraceOptions::default() };
    let film = subject.trace(&options);
    let tracer = tracer((&subject.source(), None), &subject.camera, &options);
    let expected = tracer.environment.open_irradiance(Vec3::Y) * FRAC_1_PI;
    for pixel in film.pixels() {
        let ratio = pixel.radiance / expected;
        assert!((ratio - 1.0).abs().max_element() < 0.02, "{ratio}");
    }
    // Twice the sun and no sky.
    let sun = SunLight { strength: 2.0, ..sun };
    let light = LightOptions::Outdoors { sun, sky: 0.0, area_light: None };
    let options = TraceOptions { light, ..options };
    let facing = self::tracer((&subject.source(), None), &subject.camera, &options);
    let facing = facing.environment.sun.unwrap();
    let expected = facing.irradiance * 50f32.to_radians().sin() * FRAC_1_PI;
    for pixel in subject.trace(&options).pixels() {
        let ratio = pixel.radiance / expected;
        assert!((ratio - 1.0).abs().max_element() < 0.01, "{ratio}");
    }
}

#[test]
fn a_lamp_lights_what_faces_it_and_the_sculpture_throws_a_shadow() {
    let subject = subject(scenes::solid_cube(32).unwrap(), WHITE, SIZE);
    let sun = SunLight { azimuth_deg: 0.0, elevation_deg: 40.0, size_deg: 1.0, strength: 0.0 };
    let lamp = AreaLight { azimuth_deg: 0.0, elevation_deg: 80.0, size: 1.0, strength: 1.0 };
    let light = LightOptions::Outdoors { sun, sky: 0.0, area_light: Some(lamp) };
    let options = TraceOptions { samples: 16, bounces: 0, light, ..TraceOptions::default() };
    let film = subject.trace(&options);
    let mean = |wanted: &dyn Fn(&film::PixelSum) -> bool| {
        let those: Vec<f32> =
            film.pixels().iter().filter(|p| wanted(p)).map(|p| p.radiance.x).collect();
        those.iter().sum::<f32>() / those.len() as f32
    };
    let top = mean(&|p| p.alpha == 1.0 && p.normal.y > 0.9);
    let side = mean(&|p| p.alpha == 1.0 && p.normal.y.abs() < 0.1);
    assert!((0.4..2.0).contains(&top) && side < 0.5 * top, "{top} {side}");
    let ground = |p: &film::PixelSum| p.surface == 1.0 && p.alpha == 0.0;
    let dark = film.pixels().iter().filter(|p| ground(p) && p.radiance.x < 0.01).count();
    assert!(dark > 10, "{dark} pixels in the shadow");
}

#[test]
fn a_picture_is_the_same_for_any_number_of_threads() {
    let subject = subject(cheese(), Rgb::STONE, SIZE);
    let lens = Lens { aperture: 0.05, focus: Vec2::splat(0.5) };
    for options in [TraceOptions::default(), TraceOptions { lens, ..Default::default() }] {
        let options = TraceOptions { samples: 3, ..options };
        let by = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| display_pixels(&denoise(subject.trace(&options)), 0.0))
        };
        let one = by(1);
        assert!(one.rgba.iter().any(|pixel| *pixel != one.rgba[0]));
        assert!(by(2) == one && by(5) == one);
    }
}

/// Returns how much neighbours in rows differ within a mask.
fn contrast(film: &Film, within: &[bool]) -> f32 {
    let pairs = within.windows(2).zip(film.pixels().windows(2));
    pairs
        .filter(|(mask, _)| mask[0] && mask[1])
        .map(|(_, p)| (p[0].albedo.x - p[1].albedo.x).abs())
        .sum()
}

#[test]
fn surfaces_in_focus_are_sharp_and_others_are_not() {
    // A striped floor that extends away from the eye.
    let grid = {
        let mut grid = Grid::new(UVec3::new(48, 8, 480), Vec3::ONE, 1 << 24).unwrap();
        grid.fill_bricks(|_| crate::sculpture::Brick::FULL);
        grid
    };
    let size = UVec2::new(96, 96);
    let mut subject = subject(grid, WHITE, size);
    for index in 0..subject.grid.brick_count() {
        let dark = subject.grid.brick_coords(index).x.is_multiple_of(2);
        if dark {
            subject.material.paint(
                subject.grid.brick_coords(index),
                &crate::sculpture::Brick::FULL,
                Rgb::new(0, 0, 0),
            );
        }
    }
    let camera = Camera {
        eye: Vec3::new(0.0, 60.0, 300.0),
        target: Vec3::new(0.0, 0.0, 40.0),
        ..Camera::default()
    };
    subject.camera.eye = camera.eye(size);
    let options = TraceOptions { samples: 32, bounces: 0, ground: None, ..TraceOptions::default() };
    let sharp = subject.trace(&options);
    let near: Vec<bool> = (0..96 * 96).map(|i| (70..90).contains(&(i / 96))).collect();
    let far: Vec<bool> = (0..96 * 96).map(|i| (36..40).contains(&(i / 96))).collect();
    let by = |focus_y: f32| {
        let lens = Lens { aperture: 0.12, focus: Vec2::new(0.5, focus_y) };
        let film = subject.trace(&TraceOptions { lens, ..options });
        [&near, &far].map(|mask| contrast(&film, mask) / contrast(&sharp, mask))
    };
    let [near_in, far_out] = by(0.83);
    let [near_out, far_in] = by(0.4);
    assert!(near_in > 0.8 && far_in > 0.8, "{near_in} {far_in}");
    assert!(near_out < 0.7 && far_out < 0.7, "{near_out} {far_out}");
}

#[test]
fn the_filter_keeps_an_even_picture_and_removes_noise_without_edges() {
    let even = subject(cheese(), WHITE, SIZE);
    let furnace = TraceOptions {
        samples: 2,
        bounces: 4000,
        light: LightOptions::Uniform(Vec3::ONE),
        ..TraceOptions::default()
    };
    let furnace = TraceOptions { ground: Some(TraceGround { colour: WHITE }), ..furnace };
    for pixel in denoise(even.trace(&furnace)).pixels() {
        assert!((pixel.radiance - 1.0).abs().max_element() < 1e-3, "{pixel:?}");
    }

    let noisy = subject(cheese(), Rgb::new(180, 140, 90), SIZE);
    let options = |samples| TraceOptions { samples, ..TraceOptions::default() };
    let exact = noisy.trace(&options(1024));
    let rough = noisy.trace(&options(8));
    let error = |film: &Film| {
        let pairs = film.pixels().iter().zip(exact.pixels());
        let squares = pairs.map(|(a, b)| (a.radiance - b.radiance).length_squared());
        (squares.sum::<f32>() / film.pixels().len() as f32).sqrt()
    };
    let (before, after) = (error(&rough), error(&denoise(rough.clone())));
    assert!(after < 0.75 * before, "{before} to {after}");
    // Even if the noise is unknown.
    let one = noisy.trace(&options(1));
    let (before, after) = (error(&one), error(&denoise(one.clone())));
    assert!(after < 0.75 * before, "{before} to {after}");
    // Much less is filtered if there is less noise.
    let fine = noisy.trace(&options(256));
    let (before, after) = (error(&fine), error(&denoise(fine.clone())));
    assert!(after < 1.1 * before, "{before} to {after}");
}

#[test]
fn a_cancelled_picture_is_none_and_too_large_ones_are_refused() {
    let subject = subject(cheese(), WHITE, SIZE);
    let report = ProgressReport::default();
    report.cancel();
    let options = TraceOptions::default();
    let cancelled = trace((&subject.source(), None), &subject.camera, &options, &report);
    assert_eq!(cancelled.unwrap_err(), TraceError::Cancelled);
    let mut camera = subject.camera;
    camera.eye.size = UVec2::new(16384, 16384);
    let refused = trace((&subject.source(), None), &camera, &options, &()).unwrap_err();
    assert_eq!(refused, TraceError::TooLarge(16384, 16384));
    assert!(refused.to_string().contains("67108864"));
}

#[test]
fn an_empty_sculpture_and_an_eye_within_one_have_pictures() {
    let grid = Grid::new(UVec3::splat(16), Vec3::ONE, 1 << 20).unwrap();
    let empty = subject(grid, WHITE, UVec2::splat(8));
    let mut within = subject(scenes::solid_cube(32).unwrap(), WHITE, UVec2::splat(8));
    within.camera.eye =
        Camera { eye: Vec3::ZERO, target: Vec3::X, ..Camera::default() }.eye(UVec2::splat(8));
    for subject in [empty, within] {
        for aperture in [0.0, 0.1] {
            let lens = Lens { aperture, focus: Vec2::splat(0.5) };
            let options = TraceOptions { samples: 2, lens, ..TraceOptions::default() };
            let film = denoise(subject.trace(&options));
            assert!(film.pixels().iter().all(|pixel| pixel.radiance.is_finite()));
        }
    }
}
