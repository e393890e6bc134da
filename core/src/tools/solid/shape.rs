//! The solids of the construction tools in tool space: their inside test and reach.
//!
//! From a kind and half extents to a [`Shape`]. Knows no voxels and no pose.

use glam::DVec3;

use super::planes::HalfSpace;
use super::simd_real::SimdReal;

/// The kind of a solid. In tool space it lies in [-1, 1] on every axis.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Solid {
    /// x^2 + y^2 + z^2 <= 1
    Ellipsoid,
    /// |x|, |y|, |z| <= 1
    Cuboid,
    /// Base at y = -1, apex at y = +1: |y| <= 1 and max(|x|, |z|) <= (1 - y) / 2
    Pyramid,
    /// |y| <= 1 and x^2 + z^2 <= 1
    Cylinder,
    /// Base at y = -1, apex at y = +1: |y| <= 1 and x^2 + z^2 <= ((1 - y) / 2)^2
    Cone,
    /// A ring about the y axis. Its tube is round and as thick as the solid is high, but at most a third of the outer
    /// radius to a side.
    Torus,
    /// A cylinder about the y axis with caps that are halves of balls, as far as the height has room for them.
    Capsule,
    /// A cuboid whose edges are rounded by a third of its smallest half extent.
    RoundedCuboid,
}

/// Largest radius of a torus's tube, as a fraction of its outer radius.
const THICKEST_TUBE: f64 = 1.0 / 3.0;
/// Radius of the edges of a rounded cuboid, as a fraction of its smallest half extent.
const EDGE_RADIUS: f64 = 1.0 / 3.0;

impl Solid {
    /// All solids, in the order in which interfaces offer them.
    pub const ALL: [Solid; 8] = [
        Solid::Ellipsoid,
        Solid::Cuboid,
        Solid::Pyramid,
        Solid::Cylinder,
        Solid::Cone,
        Solid::Torus,
        Solid::Capsule,
        Solid::RoundedCuboid,
    ];

    /// Their names, for messages.
    pub const NAMES: &str =
        "ellipsoid, cuboid, pyramid, cylinder, cone, torus, capsule or rounded-cuboid";

    /// Its name in the text form and the interface.
    pub const fn name(self) -> &'static str {
        match self {
            Solid::Ellipsoid => "ellipsoid",
            Solid::Cuboid => "cuboid",
            Solid::Pyramid => "pyramid",
            Solid::Cylinder => "cylinder",
            Solid::Cone => "cone",
            Solid::Torus => "torus",
            Solid::Capsule => "capsule",
            Solid::RoundedCuboid => "rounded-cuboid",
        }
    }

    /// The half spaces that meet in the solid, if it has flat faces only.
    pub(super) fn half_spaces(self) -> &'static [HalfSpace] {
        const fn face(x: f64, y: f64, z: f64, distance: f64) -> HalfSpace {
            HalfSpace { normal: DVec3::new(x, y, z), distance }
        }
        match self {
            Solid::Cuboid => {
                const {
                    &[
                        face(1.0, 0.0, 0.0, 1.0),
                        face(-1.0, 0.0, 0.0, 1.0),
                        face(0.0, 1.0, 0.0, 1.0),
                        face(0.0, -1.0, 0.0, 1.0),
                        face(0.0, 0.0, 1.0, 1.0),
                        face(0.0, 0.0, -1.0, 1.0),
                    ]
                }
            }
            Solid::Pyramid => {
                const {
                    &[
                        face(0.0, -1.0, 0.0, 1.0),
                        face(1.0, 0.5, 0.0, 0.5),
                        face(-1.0, 0.5, 0.0, 0.5),
                        face(0.0, 0.5, 1.0, 0.5),
                        face(0.0, 0.5, -1.0, 0.5),
                    ]
                }
            }
            _ => &[],
        }
    }
}

/// A solid with the proportions that it has at some half extents.
///
/// Torus, capsule and rounded cuboid are Minkowski sums: a core (a circle, a segment, a box that reaches 1), shrunk by
/// 1 - `round`, and an ellipsoid of half extents `round`, which is a ball outside of tool space where the solid is as
/// wide as deep.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Shape {
    solid: Solid,
    /// Extent of the core along each axis.
    core: DVec3,
    /// Half extents of the ellipsoid.
    round: DVec3,
}

impl Shape {
    /// The shape of `solid` with half extents `half`, in any unit.
    pub fn new(solid: Solid, half: DVec3) -> Shape {
        let whole = Shape { solid, core: DVec3::ZERO, round: DVec3::ONE };
        let width = half.x.min(half.z);
        match solid {
            Solid::Torus => {
                let tube = half.y.min(width * THICKEST_TUBE);
                let core = 1.0 - tube / width;
                // So that the outermost points are at 1, rounded or not.
                let round = DVec3::new(1.0 - core, tube / half.y, 1.0 - core);
                Shape { core: DVec3::new(core, 0.0, core), round, ..whole }
            }
            Solid::Capsule => {
                let core = 1.0 - (width / half.y).min(1.0);
                Shape { core: DVec3::Y * core, round: DVec3::new(1.0, 1.0 - core, 1.0), ..whole }
            }
            Solid::RoundedCuboid => {
                let core = 1.0 - half.min_element() * EDGE_RADIUS / half;
                Shape { core, round: 1.0 - core, ..whole }
            }
            _ => whole,
        }
    }

    /// Its kind.
    pub fn solid(&self) -> Solid {
        self.solid
    }

    /// Extent of the core along each axis.
    pub(super) fn core(&self) -> DVec3 {
        self.core
    }

    /// Half extents of the ellipsoid that rounds it; 1 where there is no core.
    pub fn round(&self) -> DVec3 {
        self.round
    }

    /// The inside test in tool space.
    #[inline(always)]
    pub fn contains(&self, p: DVec3) -> bool {
        self.holds(p.to_array())
    }

    /// The inside test of one point or eight, as coordinates in tool space.
    #[inline(always)]
    pub(super) fn holds<N: SimdReal>(&self, [x, y, z]: [N; 3]) -> N::Mask {
        let one = x.all(1.0);
        let around_y = x * x + z * z;
        match self.solid {
            Solid::Ellipsoid => (x * x + y * y + z * z).at_most(one),
            Solid::Cuboid => x.abs().max(y.abs()).max(z.abs()).at_most(one),
            Solid::Pyramid => y.abs().at_most(one) & x.abs().max(z.abs()).at_most((one - y) * 0.5),
            Solid::Cylinder => y.abs().at_most(one) & around_y.at_most(one),
            Solid::Cone => {
                let radius = (one - y) * 0.5;
                y.abs().at_most(one) & around_y.at_most(radius * radius)
            }
            Solid::Torus => {
                let out = (around_y.sqrt() - self.core.x) / self.round.x;
                let up = y / self.round.y;
                (out * out + up * up).at_most(one)
            }
            Solid::Capsule => {
                let up = (y.abs() - self.core.y).max(x.all(0.0)) / self.round.y;
                (around_y + up * up).at_most(one)
            }
            Solid::RoundedCuboid => {
                let [x, y, z] = self.beyond_core([x, y, z]);
                (x * x + y * y + z * z).at_most(one)
            }
        }
    }

    /// The part of a point that is beyond the core, without sign, in units of the ellipsoid that rounds it.
    #[inline(always)]
    pub(super) fn beyond_core<N: SimdReal>(&self, p: [N; 3]) -> [N; 3] {
        let (core, round) = (self.core, self.round);
        let [x, y, z] = p;
        let zero = x.all(0.0);
        [
            (x.abs() - core.x).max(zero) / round.x,
            (y.abs() - core.y).max(zero) / round.y,
            (z.abs() - core.z).max(zero) / round.z,
        ]
    }

    /// The largest `direction . p` over the solid.
    pub fn support(&self, direction: DVec3) -> f64 {
        let d = direction;
        match self.solid {
            Solid::Ellipsoid => d.length(),
            Solid::Cuboid => d.abs().element_sum(),
            // A corner of the base, or the apex.
            Solid::Pyramid => (d.x.abs() + d.z.abs() - d.y).max(d.y),
            Solid::Cylinder => d.y.abs() + d.x.hypot(d.z),
            Solid::Cone => (d.x.hypot(d.z) - d.y).max(d.y),
            Solid::Torus => self.core.x * d.x.hypot(d.z) + (self.round * d).length(),
            Solid::Capsule | Solid::RoundedCuboid => {
                (self.core * d).abs().element_sum() + (self.round * d).length()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn all_names_are_in_the_list_for_messages() {
        let [first @ .., last] = Solid::ALL.map(Solid::name);
        assert_eq!(Solid::NAMES, format!("{} or {last}", first.join(", ")));
    }

    fn half() -> impl Strategy<Value = DVec3> {
        let edge = || prop_oneof![4 => 0.3f64..60.0, 1 => Just(8.0), 1 => 1e-3f64..1e4];
        prop_oneof![(edge(), edge(), edge()).prop_map(DVec3::from), edge().prop_map(DVec3::splat),]
    }

    proptest! {
        /// No point reaches further than the support, and some reach it.
        #[test]
        fn the_support_is_as_far_as_points_reach(
            solid in prop::sample::select(&Solid::ALL[..]),
            half in half(),
            direction in prop::array::uniform3(-1.0f64..1.0),
        ) {
            let shape = Shape::new(solid, half);
            let direction = DVec3::from(direction);
            let most = shape.support(direction);
            // Points of a fine grid on a ball around the middle, drawn to the surface by halving.
            let mut furthest = f64::NEG_INFINITY;
            for i in 0..60 {
                for j in 0..120 {
                    let (up, turn) = ((f64::from(i) + 0.5) * 0.0523599, f64::from(j) * 0.0523599);
                    let way = DVec3::new(up.sin() * turn.cos(), up.cos(), up.sin() * turn.sin());
                    // Of a torus: around the middle of the tube, however thin it is.
                    let (middle, way) = match solid {
                        Solid::Torus => {
                            let ring = 1.0 - shape.round().x;
                            (DVec3::new(turn.cos(), 0.0, turn.sin()) * ring, way * shape.round())
                        }
                        _ => (DVec3::ZERO, way),
                    };
                    let (mut low, mut high) = (0.0, 2.0);
                    for _ in 0..24 {
                        let at = 0.5 * (low + high);
                        if shape.contains(middle + way * at) { low = at } else { high = at }
                    }
                    furthest = furthest.max(direction.dot(middle + way * low));
                }
            }
            prop_assert!(furthest <= most + 1e-9, "{} beyond {}", furthest, most);
            prop_assert!(furthest >= most - 0.1 * direction.length(), "{} of {}", furthest, most);
        }
    }
}
