//! Tests the light around a sculpture: directions, strengths, the sun's disc and the lamp.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::environment::{AreaLight, Environment, LightOptions, Standpoint, SunLight, WHITE};

fn standpoint() -> Standpoint {
    let to_viewer = Vec3::new(0.0, 3.0, 10.0);
    Standpoint { up: Vec3::Y, to_viewer, middle: Vec3::ZERO, radius: 1.0 }
}

fn outdoors(elevation_deg: f32, strength: f32, sky: f32) -> Environment {
    let sun = SunLight { azimuth_deg: 30.0, elevation_deg, size_deg: 4.0, strength };
    let lamp = AreaLight { azimuth_deg: 0.0, elevation_deg: 45.0, size: 1.0, strength: 1.0 };
    let light = LightOptions::Outdoors { sun, sky, area_light: Some(lamp) };
    Environment::new(&light, &standpoint())
}

#[test]
fn angles_are_the_viewers() {
    let at = standpoint();
    for (azimuth, elevation, expected) in [
        (0.0, 0.0, Vec3::Z),
        (90.0, 0.0, Vec3::X),
        (-90.0, 0.0, Vec3::NEG_X),
        (180.0, 0.0, Vec3::NEG_Z),
        (77.0, 90.0, Vec3::Y),
    ] {
        let found = at.towards(azimuth, elevation);
        assert!(found.abs_diff_eq(expected, 1e-6), "{azimuth} {elevation}: {found}");
    }
    // From straight above, any direction will do.
    let above = Standpoint { to_viewer: Vec3::Y, ..at };
    assert!(above.towards(10.0, 20.0).is_normalized());
}

#[test]
fn a_white_surface_that_faces_the_sun_is_as_bright_at_any_hour() {
    for elevation_deg in [2.0, 10.0, 30.0, 60.0, 90.0] {
        let environment = outdoors(elevation_deg, 1.0, 1.0);
        let sun = environment.sun.unwrap();
        let white =
            environment.open_irradiance(sun.direction).dot(Vec3::new(0.2126, 0.7152, 0.0722)) / PI;
        assert!((white / WHITE - 1.0).abs() < 0.01, "{elevation_deg}: {white}");
        // The low sun is red.
        assert!(sun.irradiance.x >= sun.irradiance.z);
    }
    let noon = outdoors(80.0, 1.0, 1.0).sun.unwrap().irradiance;
    let evening = outdoors(4.0, 1.0, 1.0).sun.unwrap().irradiance;
    assert!(evening.z / evening.x < 0.3 * noon.z / noon.x, "{evening} {noon}");
    assert!(outdoors(0.0, 1.0, 1.0).sun.is_none() && outdoors(50.0, 0.0, 1.0).sun.is_none());
    assert_eq!(outdoors(50.0, 1.0, 0.0).sky(Vec3::Y), Vec3::ZERO);
}

#[test]
fn the_disc_of_the_sun_has_its_irradiance() {
    let environment = outdoors(50.0, 1.0, 0.0);
    let sun = environment.sun.unwrap();
    // Points of a disc of twice the sun's size, as seen from the surface that faces it.
    let (u, v) = sun.direction.any_orthonormal_pair();
    let (mut sum, steps) = (Vec3::ZERO, 400);
    for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
        let at = (Vec2::new(i as f32, j as f32) + 0.5) / steps as f32 * 4.0 - 2.0;
        let off = at * sun.sin_radius;
        let direction = u * off.x + v * off.y + sun.direction * (1.0 - off.length_squared()).sqrt();
        sum += environment.seen(direction);
    }
    let projected = (4.0 * sun.sin_radius / steps as f32).powi(2);
    let ratio = sum * projected / sun.irradiance;
    assert!((ratio - 1.0).abs().max_element() < 0.01, "{ratio}");
}

#[test]
fn the_lamp_is_hit_on_its_lit_side_alone() {
    let lamp = outdoors(50.0, 1.0, 1.0).lamp.unwrap();
    let towards = lamp.centre.normalize();
    assert!((lamp.hit(Vec3::ZERO, towards).unwrap() - 3.0).abs() < 1e-5);
    assert_eq!(lamp.hit(lamp.centre * 2.0, -towards), None);
    let (inside, outside) = (lamp.centre + lamp.half_u * 0.99, lamp.centre + lamp.half_u * 1.01);
    assert!(lamp.hit(Vec3::ZERO, inside).is_some() && lamp.hit(Vec3::ZERO, outside).is_none());
}
