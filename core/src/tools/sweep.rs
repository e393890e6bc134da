//! The spacing of a solid's uses along a path so that the result looks swept: between two uses, all
//! that a continuous sweep would cover lies within [`SCALLOP_VX`] of what is covered.
//!
//! Pure geometry of one solid and one direction; knows no path.

use glam::{DMat3, DVec3, Vec3};

use super::construct::{Primitive, Solid};

/// Deepest scallop between two uses, in units of the smallest edge of a voxel.
pub const SCALLOP_VX: f64 = 0.3;
/// Uses closer than this leave no deeper scallop whatever the solid: every point that a sweep
/// covers is within half of it of one of two uses.
pub const NEAREST_VX: f64 = 2.0 * SCALLOP_VX;
/// Largest spacing, as a fraction of the smallest half extent: the tool must not lag behind the hand.
const FURTHEST: f64 = 0.35;

impl Primitive {
    /// The spacing along `direction`, which may have any length; in units of the smallest edge of a
    /// voxel, as is the result.
    pub fn spacing_along(&self, direction: Vec3) -> f32 {
        let furthest = FURTHEST * f64::from(self.half.min_element());
        let rotation = DMat3::from_quat(self.rotation.as_dquat());
        let along = (rotation.transpose() * direction.as_dvec3()).normalize_or_zero();
        let half = self.half.as_dvec3();
        let smooth = match self.solid {
            // A sum with an ellipsoid is all of the ellipsoid's places at once.
            Solid::Ellipsoid | Solid::Torus | Solid::Capsule | Solid::RoundedCuboid => {
                along_ellipsoid(half * self.shape().round(), along)
            }
            Solid::Cuboid | Solid::Pyramid => self.along_faces(half, along),
            Solid::Cylinder => along_cylinder(half, along),
            Solid::Cone => NEAREST_VX,
        };
        // A direction of no length gives no bound.
        smooth.min(furthest).max(NEAREST_VX) as f32
    }

    /// The spacing that suffices in all directions.
    pub fn spacing_anywhere(&self) -> f32 {
        match self.solid {
            Solid::Ellipsoid | Solid::Torus | Solid::Capsule | Solid::RoundedCuboid => {
                let half = self.half.as_dvec3() * self.shape().round();
                let shortest = scallop_of_ball(half) * half.min_element();
                let furthest = FURTHEST * f64::from(self.half.min_element());
                shortest.min(furthest).max(NEAREST_VX) as f32
            }
            Solid::Cuboid | Solid::Pyramid | Solid::Cylinder | Solid::Cone => NEAREST_VX as f32,
        }
    }

    /// Of a solid with flat faces: between two uses the face that goes ahead of the first meets the
    /// face that trails behind the second in a notch.
    fn along_faces(&self, half: DVec3, along: DVec3) -> f64 {
        let faces = self.solid.half_spaces();
        let mut deepest: f64 = 0.0;
        for ahead in faces {
            for behind in faces {
                let (ahead, behind) =
                    ((ahead.normal / half).normalize(), (behind.normal / half).normalize());
                let (rise, fall) = (ahead.dot(along), -behind.dot(along));
                let edge = ahead.cross(behind);
                let sine = edge.length();
                if rise <= 1e-9 || fall <= 1e-9 || sine <= 1e-9 {
                    continue;
                }
                let across_edge = along.reject_from(edge).length();
                deepest = deepest.max(rise * fall / (across_edge * sine).max(1e-9));
            }
        }
        SCALLOP_VX / deepest
    }
}

/// As an ellipsoid moves, what it leaves is a ball's scallops stretched by at most its longest half
/// extent.
fn along_ellipsoid(half: DVec3, along: DVec3) -> f64 {
    scallop_of_ball(half) / (along / half).length()
}

/// Across the axis two uses leave the scallop of the disc; obliquely they leave a notch, too, between
/// the cap that goes ahead of the first and the side that trails behind the second.
fn along_cylinder(half: DVec3, along: DVec3) -> f64 {
    let across = DVec3::new(along.x, 0.0, along.z);
    if across.length() <= 1e-9 {
        return f64::INFINITY;
    }
    // What is as far from the cap as from the side, which are at right angles.
    let (rise, fall) = (along.y.abs(), across.length());
    let notch = rise * fall / (rise + fall);
    let missing = |step: f64| {
        // The chord of two discs of radius 1; an ellipse's scallop is stretched by its longer half extent.
        let chord = (0.5 * step * (across / half).length()).min(1.0);
        let scallop = 1.0 - (1.0 - chord * chord).sqrt();
        scallop * half.x.max(half.z) + step * notch
    };
    let (mut enough, mut far) = (0.0, 2.0 / (across / half).length());
    for _ in 0..30 {
        let middle = 0.5 * (enough + far);
        if missing(middle) <= SCALLOP_VX { enough = middle } else { far = middle }
    }
    enough
}

/// The distance of two balls of radius 1 whose scallop is deep enough.
fn scallop_of_ball(half: DVec3) -> f64 {
    let depth = (SCALLOP_VX / half.max_element()).min(1.0);
    2.0 * (depth * (2.0 - depth)).sqrt()
}

#[cfg(test)]
mod tests {
    use glam::Quat;
    use glam::swizzles::Vec3Swizzles;
    use proptest::prelude::*;

    use super::*;
    use crate::tools::construct_tests::rotation;

    /// Whether `p` (from the centre of the first use) is in the solid, and so in tool space.
    fn inside(primitive: &Primitive, p: DVec3) -> bool {
        let rotation = DMat3::from_quat(primitive.rotation.as_dquat());
        primitive.shape().contains(rotation.transpose() * p / primitive.half.as_dvec3())
    }

    /// Directions that are spread evenly over the sphere.
    fn spread(count: usize) -> impl Iterator<Item = DVec3> {
        (0..count).map(move |i| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
            let turn = i as f64 * 2.399_963_229_728_653;
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * turn.cos(), r * turn.sin(), z)
        })
    }

    /// The deepest point of a continuous sweep below what uses at `step` cover, as far as points on
    /// the surface of the solid tell: steps of `look` around each are tried.
    fn deepest(primitive: &Primitive, step: DVec3) -> f64 {
        let rotation = DMat3::from_quat(primitive.rotation.as_dquat());
        let half = primitive.half.as_dvec3();
        let covered = |p: DVec3| (-3..=4).any(|i| inside(primitive, p - step * f64::from(i)));
        // Where ways to the surface begin: in the middle, or in the middle of the tube.
        let shape = primitive.shape();
        let inmost = |direction: DVec3| match primitive.solid {
            Solid::Torus => {
                DVec3::new(direction.x, 0.0, direction.z).normalize() * (1.0 - shape.round().x)
            }
            _ => DVec3::ZERO,
        };
        // Towards the uses, too, where the solid is too thin for other ways to meet it.
        let (to, fro) = (step.normalize(), -step.normalize());
        let around: Vec<DVec3> = spread(300).chain([to, fro]).collect();
        let mut deepest = 0.0f64;
        for direction in spread(400) {
            // The surface towards `direction`: by halving.
            let inmost = inmost(direction.zxy());
            let (mut low, mut high) = (0.0, 4.0);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                match shape.contains(inmost + direction * middle) {
                    true => low = middle,
                    false => high = middle,
                }
            }
            let on_surface = rotation * ((inmost + direction * low) * half) * (1.0 - 1e-6);
            for part in [0.25, 0.5, 0.75] {
                let p = on_surface + step * part;
                let near = |depth: f64| around.iter().any(|way| covered(p + *way * depth));
                // The least of a few depths that reaches what is covered.
                let depth = (0..40).map(|i| f64::from(i) * 0.02).find(|&d| covered(p) || near(d));
                deepest = deepest.max(depth.unwrap_or(f64::INFINITY));
            }
        }
        deepest
    }

    fn direction() -> impl Strategy<Value = Vec3> {
        prop_oneof![
            prop::array::uniform3(-1f32..1.0).prop_map(Vec3::from),
            prop::sample::select(vec![Vec3::X, Vec3::Y, Vec3::NEG_Z, Vec3::new(1.0, 1.0, 0.0)]),
        ]
        .prop_filter("a direction", |d| d.length() > 0.1)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

        #[test]
        fn scallops_stay_shallow_in_every_direction(
            solid in prop::sample::select(&Solid::ALL[..]),
            half in prop::array::uniform3(prop_oneof![0.4f32..8.0, 8f32..120.0]),
            rotation in rotation(),
            direction in direction(),
        ) {
            let primitive =
                Primitive { solid, centre_vx: Vec3::ZERO, half: half.into(), rotation };
            let spacing = primitive.spacing_along(direction);
            prop_assert!(spacing >= NEAREST_VX as f32);
            prop_assert!(primitive.spacing_anywhere() <= spacing);
            let step = direction.as_dvec3().normalize() * f64::from(spacing);
            let depth = deepest(&primitive, step);
            // The ways looked at are some degrees apart.
            prop_assert!(depth <= SCALLOP_VX + 0.03, "{} deep, {} apart", depth, spacing);
        }
    }

    #[test]
    fn a_cylinder_that_moves_obliquely_leaves_shallow_notches_at_its_rims() {
        for degrees in [0.0f32, 5.0, 17.0, 30.0, 45.0, 60.0, 73.0, 85.0, 90.0] {
            for half in [Vec3::new(6.14, 6.64, 7.84), Vec3::splat(40.0), Vec3::new(60.0, 9.0, 20.0)]
            {
                let cylinder = Primitive {
                    solid: Solid::Cylinder,
                    centre_vx: Vec3::ZERO,
                    half,
                    rotation: Quat::IDENTITY,
                };
                let (sine, cosine) = degrees.to_radians().sin_cos();
                let direction = Vec3::new(0.0, cosine, sine);
                let step = direction.as_dvec3() * f64::from(cylinder.spacing_along(direction));
                let depth = deepest(&cylinder, step);
                assert!(depth <= SCALLOP_VX + 0.03, "{depth} deep at {degrees} degrees, {half}");
            }
        }
    }

    #[test]
    fn a_share_of_the_extent_alone_leaves_ridges() {
        let ball = |radius: f32| Primitive {
            solid: Solid::Ellipsoid,
            centre_vx: Vec3::ZERO,
            half: Vec3::splat(radius),
            rotation: Quat::IDENTITY,
        };
        assert!(deepest(&ball(60.0), DVec3::X * 0.35 * 60.0) > 2.0 * SCALLOP_VX);
        assert!(ball(60.0).spacing_along(Vec3::X) < 0.21 * 60.0);
        // Where the share is enough, nothing is done more often.
        assert_eq!(ball(8.0).spacing_along(Vec3::X), 0.35 * 8.0);
        let cube = Primitive { solid: Solid::Cuboid, ..ball(20.0) };
        assert_eq!(cube.spacing_along(Vec3::X), 7.0);
        assert!((cube.spacing_along(Vec3::new(1.0, 0.0, -1.0)) - 0.6).abs() < 1e-3);
        assert!(deepest(&cube, DVec3::new(1.0, 1.0, 0.0) * 3.0) > 3.0 * SCALLOP_VX);
        assert_eq!(cube.spacing_along(Vec3::ZERO), 7.0);
    }
}
