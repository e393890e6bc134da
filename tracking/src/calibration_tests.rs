//! Properties of the calibration: the true transform is recovered, noise is averaged, degenerate input is refused.

use super::*;
use crate::predict::{PredictionOptions, predict};
use proptest::prelude::*;

fn vec3(limit: f64) -> impl Strategy<Value = DVec3> {
    [-limit..limit, -limit..limit, -limit..limit].prop_map(DVec3::from_array)
}

/// Returns touches of the corners of a 60 x 34 cm screen as seen by a tracker placed by `truth`.
fn corner_touches(truth: &Calibration, errors: &[DVec3; 4]) -> Vec<Touch> {
    let seen = |s: DVec3| truth.rotation.inverse() * (s - truth.translation_m) / truth.scale;
    screen_corners_m(0.6, 0.34)
        .iter()
        .zip(errors)
        .map(|(&screen_m, &error)| Touch { tracker_m: seen(screen_m) + error, screen_m })
        .collect()
}

fn truth(r: DVec3, t: DVec3, scale: f64) -> Calibration {
    Calibration {
        rotation: DQuat::from_scaled_axis(r),
        translation_m: t,
        scale,
        ..Default::default()
    }
}

proptest! {
    #[test]
    fn four_corners_find_the_truth(r in vec3(3.0), t in vec3(3.0), scale in 0.1..10.0f64) {
        let truth = truth(r, t, scale);
        let fit = fit_touches(&corner_touches(&truth, &[DVec3::ZERO; 4]), true).unwrap();
        prop_assert!(fit.rms_m < 1e-9 && fit.max_m() < 1e-9);
        prop_assert!((fit.calibration.scale - scale).abs() < 1e-9 * scale);
        prop_assert!(fit.calibration.rotation.dot(truth.rotation).abs() > 1.0 - 1e-12);
        // Also off the plane: a mirrored solution would fit the corners and miss this point.
        let p = DVec3::new(0.1, -0.3, 0.7);
        prop_assert!(fit.calibration.point(p).distance(truth.point(p)) < 1e-8);
    }

    #[test]
    fn noise_shows_in_the_residual_and_moves_the_head_little(
        r in vec3(3.0), t in vec3(3.0), e in [vec3(0.002), vec3(0.002), vec3(0.002), vec3(0.002)],
    ) {
        let truth = truth(r, t, 1.0);
        let fit = fit_touches(&corner_touches(&truth, &e), false).unwrap();
        let worst = e.iter().map(|e| e.length()).fold(0.0, f64::max);
        prop_assert!(fit.rms_m <= worst + 1e-12);
        // A head 60 cm before the screen: the plane's tilt error is at most about 2e/height.
        let head = truth.rotation.inverse() * (DVec3::new(0.0, 0.0, 0.6) - truth.translation_m);
        prop_assert!(fit.calibration.point(head).distance(DVec3::new(0.0, 0.0, 0.6)) < 0.03);
    }

    #[test]
    fn no_other_rigid_motion_fits_better(
        e in [vec3(0.05), vec3(0.05), vec3(0.05), vec3(0.05)],
        turn in vec3(0.2), shift in vec3(0.02),
    ) {
        let touches = corner_touches(&truth(DVec3::ONE, DVec3::X, 1.0), &e);
        let fit = fit_touches(&touches, false).unwrap();
        let mut other = fit.calibration;
        other.rotation = DQuat::from_scaled_axis(turn) * other.rotation;
        other.translation_m += shift;
        let rms_m = (touches.iter()
            .map(|t| other.point(t.tracker_m).distance_squared(t.screen_m)).sum::<f64>() / 4.0).sqrt();
        prop_assert!(rms_m >= fit.rms_m - 1e-12);
    }

    #[test]
    fn velocity_belongs_to_the_placement(
        r in vec3(3.0), t in vec3(1.0), p in vec3(1.0), q in vec3(3.0), v in vec3(1.0), w in vec3(2.0),
        eyes in vec3(0.2),
    ) {
        let mut c = truth(r, t, 1.3);
        c.sensor_from_eyes = Placement { position_m: eyes, orientation: DQuat::from_rotation_x(0.4) };
        let options = PredictionOptions { max_distance_m: 9.0, max_turn_rad: 3.0, max_ahead_s: 1.0 };
        let start = Placement { position_m: p, orientation: DQuat::from_scaled_axis(q) };
        let velocity = Velocity { linear_m_s: v, angular_rad_s: w };
        let h = 1e-5;
        let moved = c.apply(predict(start, velocity, h, &options));
        let screen = c.apply_velocity(start, velocity);
        let expected = predict(c.apply(start), screen, h, &options);
        prop_assert!(moved.position_m.distance(expected.position_m) < 1e-8);
        prop_assert!(moved.angle_to(expected) < 1e-8);
    }
}

#[test]
fn degenerate_touches_are_refused() {
    let touch = |t: [f64; 3], s: [f64; 3]| Touch {
        tracker_m: DVec3::from_array(t),
        screen_m: DVec3::from_array(s),
    };
    let on_a_line: Vec<_> =
        (0..4).map(|i| f64::from(i) * 0.1).map(|x| touch([x, x, 0.0], [x, 0.0, 0.0])).collect();
    assert!(matches!(fit_touches(&on_a_line, true), Err(CalibrationError::Degenerate { .. })));

    let one_spot: Vec<_> = screen_corners_m(0.6, 0.3)
        .iter()
        .map(|s| Touch { tracker_m: DVec3::ONE, screen_m: *s })
        .collect();
    assert!(matches!(
        fit_touches(&one_spot, false),
        Err(CalibrationError::Degenerate { side: "tracker", .. })
    ));
    assert_eq!(fit_touches(&one_spot[..2], false), Err(CalibrationError::Count(2)));
    let mut bad = corner_touches(&Calibration::default(), &[DVec3::ZERO; 4]);
    bad[2].tracker_m.y = f64::NAN;
    assert_eq!(fit_touches(&bad, false), Err(CalibrationError::NotFinite));
}

#[test]
fn swapped_corners_show_as_a_large_residual_or_are_refused() {
    let mut touches = corner_touches(&Calibration::default(), &[DVec3::ZERO; 4]);
    let screens: Vec<_> = touches.iter().map(|t| t.screen_m).collect();
    touches[0].screen_m = screens[1];
    touches[1].screen_m = screens[0];
    match fit_touches(&touches, false) {
        Ok(fit) => assert!(fit.rms_m > 0.1, "rms {}", fit.rms_m),
        Err(error) => assert_eq!(error, CalibrationError::Ambiguous),
    }
}

#[test]
fn values_of_a_config_are_checked() {
    assert!(Calibration::from_values(DVec3::new(0.0, f64::NAN, 0.0), [0.0; 3], 1.0).is_err());
    assert!(Calibration::from_values(DVec3::ZERO, [f64::INFINITY, 0.0, 0.0], 1.0).is_err());
    assert!(Calibration::from_values(DVec3::ZERO, [0.0; 3], f64::NAN).is_err());
    assert!(Calibration::from_values(DVec3::ZERO, [0.0; 3], 0.0).is_err());
    let c = Calibration::from_values(DVec3::Y, [90.0, 0.0, 0.0], 2.0).unwrap();
    assert!(c.point(DVec3::X).distance(DVec3::new(0.0, 1.0, -2.0)) < 1e-12);
}

#[test]
fn a_tip_is_found_from_the_sensor() {
    let sensor = Placement { position_m: DVec3::X, orientation: DQuat::from_rotation_z(1.5) };
    let touch = Touch::with_tip(sensor, DVec3::Y * 0.1, DVec3::ZERO);
    assert!((touch.tracker_m.distance(DVec3::X) - 0.1).abs() < 1e-12);
    assert!(touch.tracker_m.x < 1.0);
}
