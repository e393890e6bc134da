//! Pose estimation: from a marker's corners to its pose relative to the camera.
//!
//! A flat square seen from afar looks nearly the same in two tilts (G. Schweighofer, A. Pinz:
//! "Robust Pose Estimation from a Planar Target", PAMI 2006): both poses are returned.

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::homography;

/// The pose of a marker. Camera axes: x right, y up, z backwards; marker axes: x right, y up on the
/// paper, z out of it, with the origin in its centre. Metres.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MarkerPose {
    pub rotation: DQuat,
    pub translation_m: DVec3,
    /// Root mean square reprojection error of the corners, in pixels.
    pub error_px: f64,
}

impl MarkerPose {
    /// Transforms a point from the marker's axes to the camera's.
    pub fn apply(&self, marker_m: DVec3) -> DVec3 {
        self.rotation * marker_m + self.translation_m
    }
}

/// Largest number of refinement steps.
const STEPS: usize = 30;

/// Returns the poses of a marker `size_m` metres wide for its corners (rays at depth 1: upper left, upper right, lower
/// right, lower left), the better one first; empty if the corners are not those of a square. `focal_px` scales rays to
/// pixels for the errors.
pub fn poses(corners: &[DVec2; 4], size_m: f64, focal_px: f64) -> Vec<MarkerPose> {
    let Some(first) = first_guess(corners, 0.5 * size_m) else { return Vec::new() };
    let first = refine(first, corners, 0.5 * size_m, focal_px);
    // The other pose: the normal mirrored at the line of sight.
    let sight = first.translation.normalize_or_zero();
    let half = std::f64::consts::PI;
    let other = Guess {
        rotation: DQuat::from_axis_angle(sight, half)
            * first.rotation
            * DQuat::from_rotation_z(half),
        ..first
    };
    let other = refine(other, corners, 0.5 * size_m, focal_px);
    let same = first.rotation.angle_between(other.rotation) < 0.02;
    let mut found: Vec<MarkerPose> = [Some(first), (!same).then_some(other)]
        .into_iter()
        .flatten()
        .filter(|guess| guess.translation.z > 0.0 && guess.translation.is_finite())
        .map(|guess| guess.pose())
        .collect();
    found.sort_by(|a, b| a.error_px.total_cmp(&b.error_px));
    found
}

/// A pose in picture axes, x right, y down, z forwards, for camera and marker alike.
#[derive(Clone, Copy)]
struct Guess {
    rotation: DQuat,
    translation: DVec3,
    error_px: f64,
}

impl Guess {
    fn pose(&self) -> MarkerPose {
        // A half turn about x on both sides.
        let q = self.rotation;
        MarkerPose {
            rotation: DQuat::from_xyzw(q.x, -q.y, -q.z, q.w).normalize(),
            translation_m: self.translation * DVec3::new(1.0, -1.0, -1.0),
            error_px: self.error_px,
        }
    }
}

fn square(half_m: f64) -> [DVec3; 4] {
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| DVec3::new(x * half_m, y * half_m, 0.0))
}

/// Returns the pose of a homography, whose columns are, up to a factor, two axes of the marker and its position (Z.
/// Zhang, 2000).
fn first_guess(corners: &[DVec2; 4], half_m: f64) -> Option<Guess> {
    let map = homography::from_square(corners)?;
    let (x, y, t) = (map.x_axis, map.y_axis, map.z_axis);
    let factor = 2.0 / (x.length() + y.length());
    let factor = if t.z < 0.0 { -factor } else { factor };
    // The nearest pair of orthogonal axes.
    let (sum, difference) = ((x + y) * factor, (x - y) * factor);
    let (sum, difference) = (sum.try_normalize()?, difference.try_normalize()?);
    let x = (sum + difference).try_normalize()?;
    let y = (sum - difference).reject_from(x).try_normalize()?;
    let rotation = DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize();
    let translation = t * (factor * half_m);
    (rotation.is_finite() && translation.is_finite()).then_some(Guess {
        rotation,
        translation,
        error_px: f64::INFINITY,
    })
}

/// Refines a pose by Levenberg-Marquardt on the distances of the corners.
fn refine(mut guess: Guess, corners: &[DVec2; 4], half_m: f64, focal_px: f64) -> Guess {
    let points = square(half_m);
    let error = |guess: &Guess| -> f64 {
        let sum: f64 = points
            .iter()
            .zip(corners)
            .map(|(point, ray)| {
                let p = guess.rotation * *point + guess.translation;
                if p.z > 1e-6 { (p.truncate() / p.z).distance_squared(*ray) } else { 1e6 }
            })
            .sum();
        (sum / 4.0).sqrt() * focal_px
    };
    guess.error_px = error(&guess);
    let mut damping = 1e-4;
    for _ in 0..STEPS {
        // The normal equations: rows for rotation and translation.
        let mut system = [[0.0; 7]; 6];
        for (point, ray) in points.iter().zip(corners) {
            let arm = guess.rotation * *point;
            let p = arm + guess.translation;
            if p.z <= 1e-6 {
                return guess;
            }
            let rest = *ray - p.truncate() / p.z;
            for (axis, rest) in [(DVec3::X, rest.x), (DVec3::Y, rest.y)] {
                // Derivative of this coordinate of the ray with respect to the point.
                let by_point = (axis - DVec3::Z * (p.dot(axis) / p.z)) / p.z;
                let by_turn = arm.cross(by_point);
                let row = [by_turn.x, by_turn.y, by_turn.z, by_point.x, by_point.y, by_point.z];
                for i in 0..6 {
                    for j in 0..6 {
                        system[i][j] += row[i] * row[j];
                    }
                    system[i][6] += row[i] * rest;
                }
            }
        }
        for (i, row) in system.iter_mut().enumerate() {
            row[i] *= 1.0 + damping;
        }
        let Some(step) = solve(system) else { return guess };
        let turn = DVec3::new(step[0], step[1], step[2]);
        let shift = DVec3::new(step[3], step[4], step[5]);
        let mut next = Guess {
            rotation: (DQuat::from_scaled_axis(turn) * guess.rotation).normalize(),
            translation: guess.translation + shift,
            error_px: 0.0,
        };
        next.error_px = error(&next);
        if next.error_px < guess.error_px {
            let gain = guess.error_px - next.error_px;
            guess = next;
            damping = (damping * 0.1).max(1e-12);
            if gain < 1e-9 {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    guess
}

/// Solves the system by Gaussian elimination with pivoting; `None` if it is singular.
fn solve(mut system: [[f64; 7]; 6]) -> Option<[f64; 6]> {
    for column in 0..6 {
        let pivot = (column..6)
            .max_by(|&a, &b| system[a][column].abs().total_cmp(&system[b][column].abs()))?;
        system.swap(column, pivot);
        let head = system[column];
        if head[column].abs() < 1e-300 {
            return None;
        }
        for (index, row) in system.iter_mut().enumerate() {
            if index != column {
                let factor = row[column] / head[column];
                for (value, above) in row.iter_mut().zip(head) {
                    *value -= factor * above;
                }
            }
        }
    }
    let mut solution = [0.0; 6];
    for (i, value) in solution.iter_mut().enumerate() {
        *value = system[i][6] / system[i][i];
    }
    solution.iter().all(|value| value.is_finite()).then_some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn exact_corners_give_the_exact_pose(
            tilt in 0.15f64..1.2, azimuth in -3.1f64..3.1, spin in -3.1f64..3.1,
            x in -0.1f64..0.1, y in -0.1f64..0.1, z in 0.15f64..1.5,
        ) {
            // The marker faces the camera up to a tilt.
            let axis = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
            let rotation = DQuat::from_axis_angle(axis, tilt) * DQuat::from_rotation_z(spin);
            let truth = MarkerPose { rotation, translation_m: DVec3::new(x, y, -z), error_px: 0.0 };
            let corners = [(-0.04, 0.04), (0.04, 0.04), (0.04, -0.04), (-0.04, -0.04)].map(|(x, y)| {
                let p = truth.apply(DVec3::new(x, y, 0.0));
                DVec2::new(p.x / -p.z, -p.y / -p.z)
            });
            let found = poses(&corners, 0.08, 600.0);
            prop_assert!(!found.is_empty());
            prop_assert!(found[0].error_px < 1e-6);
            prop_assert!(found[0].translation_m.distance(truth.translation_m) < 1e-6);
            prop_assert!(found[0].rotation.angle_between(rotation) < 1e-5);
        }
    }

    #[test]
    fn no_square_no_pose() {
        let line = [DVec2::ZERO, DVec2::X, DVec2::X * 2.0, DVec2::X * 3.0];
        assert!(poses(&line, 0.08, 600.0).is_empty());
        assert!(poses(&[DVec2::NAN; 4], 0.08, 600.0).is_empty());
    }
}
