//! Tests light on the smooth surface: energy, walls that block all light, no shadows of the surface's own ripples.

use glam::{Quat, UVec2, Vec3};

use super::tests::{SIZE, Subject, WHITE, cheese, stretched_ball, subject};
use super::*;
use crate::scenes::{self, grid_of};
use crate::sculpture::Grid;
use crate::view::Camera;

fn smooth(subject: &Subject) -> LevelSet {
    let mut levels = LevelSet::whole(&subject.grid, 1 << 30).unwrap();
    levels.update(&subject.grid, &subject.normals, &mut Vec::new());
    levels
}

fn traced(subject: &Subject, options: &TraceOptions) -> Film {
    let levels = smooth(subject);
    trace((&subject.source(), Some(&levels)), &subject.camera, options, &()).unwrap()
}

/// Returns a hollow, rotated box whose walls are two voxels thick.
fn turned_box() -> Grid {
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2);
    grid_of(48, |p| {
        let most = (turn * (p - 24.0)).abs().max_element();
        (12.0..14.0).contains(&most)
    })
}

fn furnace() -> TraceOptions {
    TraceOptions {
        samples: 4,
        bounces: 4000,
        light: LightOptions::Uniform(Vec3::ONE),
        ground: Some(TraceGround { colour: WHITE }),
        ..TraceOptions::default()
    }
}

#[test]
fn a_white_smooth_surface_vanishes_in_a_white_furnace() {
    let gyroid = scenes::gyroid(64, 1).unwrap();
    for grid in [cheese(), gyroid, stretched_ball(), turned_box()] {
        let subject = subject(grid, WHITE, SIZE);
        for ground in [None, furnace().ground] {
            let film = traced(&subject, &TraceOptions { ground, ..furnace() });
            assert!(film.pixels().iter().map(|pixel| pixel.alpha).sum::<f32>() > 300.0);
            for pixel in film.pixels() {
                assert!((pixel.radiance - 1.0).abs().max_element() < 0.005, "{pixel:?}");
            }
        }
    }
}

/// Paths do not wander within the surface: of those that leave it, few need many bounces.
#[test]
fn few_paths_on_a_smooth_surface_end_early() {
    let subject = subject(stretched_ball(), WHITE, SIZE);
    let film = traced(&subject, &TraceOptions { bounces: 3, ground: None, ..furnace() });
    let seen: Vec<f32> =
        film.pixels().iter().filter(|p| p.alpha == 1.0).map(|p| p.radiance.x).collect();
    assert!(seen.iter().sum::<f32>() / seen.len() as f32 > 0.995);
}

#[test]
fn no_light_comes_through_a_wall_of_two_voxels() {
    let mut subject = subject(turned_box(), WHITE, SIZE);
    let light = LightOptions::default();
    let options = TraceOptions { samples: 16, light, ground: None, ..TraceOptions::default() };
    for target in [Vec3::X, Vec3::NEG_Z, Vec3::new(0.5, -0.7, 0.4)] {
        let camera = Camera { eye: Vec3::ZERO, target, fov_y_rad: 1.6, ..Camera::default() };
        subject.camera.eye = camera.eye(SIZE);
        let film = traced(&subject, &options);
        for pixel in film.pixels() {
            assert!(pixel.alpha == 1.0 && pixel.radiance == Vec3::ZERO, "{pixel:?}");
        }
    }
}

/// Low light on a ball is as bright as its angle implies, up to the terminator.
#[test]
fn a_ball_throws_no_shadow_on_itself() {
    let middle = Vec3::new(32.2, 31.9, 32.3);
    let mut subject = subject(grid_of(64, |p| p.distance(middle) < 28.0), WHITE, UVec2::splat(120));
    subject.camera.eye = Camera::framing(30.0, Vec3::Z, Vec3::Y).eye(UVec2::splat(120));
    let sun = SunLight { azimuth_deg: 80.0, elevation_deg: 10.0, size_deg: 0.5, strength: 1.0 };
    let light = LightOptions::Outdoors { sun, sky: 0.0, area_light: None };
    let options =
        TraceOptions { samples: 4, bounces: 0, light, ground: None, ..TraceOptions::default() };
    let levels = smooth(&subject);
    let source = subject.source();
    let sun = tracer((&source, Some(&levels)), &subject.camera, &options).environment.sun.unwrap();
    let film = traced(&subject, &options);
    let (mut lit, mut dim) = (0, 0);
    for pixel in film.pixels().iter().filter(|pixel| pixel.alpha == 1.0) {
        let cosine = pixel.normal.normalize().dot(sun.direction);
        if cosine > 0.08 {
            lit += 1;
            let expected = sun.irradiance.x * cosine * FRAC_1_PI;
            dim += usize::from((pixel.radiance.x / expected - 1.0).abs() > 0.05);
        } else if cosine < -0.05 {
            assert_eq!(pixel.radiance, Vec3::ZERO, "{pixel:?}");
        }
    }
    assert!(lit > 1500 && dim * 200 < lit, "{dim} of {lit}");
}

/// The share of each pixel that the sculpture covers is that of a ball, more exactly than voxels allow.
#[test]
fn the_outline_of_a_ball_is_round() {
    let middle = Vec3::new(16.2, 15.9, 16.1);
    let size = UVec2::splat(100);
    let mut subject = subject(grid_of(32, |p| p.distance(middle) < 12.0), WHITE, size);
    subject.camera.eye = Camera::framing(14.0, Vec3::new(0.3, 0.2, 1.0), Vec3::Y).eye(size);
    let options = TraceOptions { samples: 16, bounces: 0, ground: None, ..Default::default() };
    let rays = subject.camera.eye.pixel_rays(&subject.camera.world_from_grid);
    let covers = |x: f32, y: f32| {
        let along = rays.direction_at(x, y).normalize();
        let to_middle = middle - rays.origin;
        (to_middle - along * to_middle.dot(along)).length() < 12.0
    };
    let error = |film: &Film| {
        let pixels = film.pixels().iter().enumerate();
        let errors = pixels.map(|(i, pixel)| {
            let (x, y) = ((i % 100) as f32, (i / 100) as f32);
            let points = (0..64).map(|k| ((k % 8) as f32 + 0.5, (k / 8) as f32 + 0.5));
            let inside = points.filter(|(u, v)| covers(x + u / 8.0, y + v / 8.0)).count();
            (pixel.alpha - inside as f32 / 64.0).abs()
        });
        errors.sum::<f32>()
    };
    let (smooth, voxels) = (error(&traced(&subject, &options)), error(&subject.trace(&options)));
    assert!(smooth < 0.35 * voxels, "{smooth} of {voxels} pixels");
}

#[test]
fn a_smooth_picture_is_the_same_for_any_number_of_threads() {
    let subject = subject(cheese(), Rgb::STONE, SIZE);
    let lens = Lens { aperture: 0.05, focus: Vec2::splat(0.5) };
    for options in [TraceOptions::default(), TraceOptions { lens, ..Default::default() }] {
        let options = TraceOptions { samples: 3, ..options };
        let by = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| traced(&subject, &options))
        };
        let one = by(1);
        assert!(one.pixels().iter().any(|pixel| pixel.alpha > 0.0));
        assert!(by(2) == one && by(5) == one);
    }
}
