//! Describes the surfaces of the solids in tool space, as interfaces draw them: faces, or a profile revolved about the
//! y axis.
//!
//! Pure data for outlines and meshes; takes no part in the inside test.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

/// The surface of a solid in tool space.
#[derive(Clone, Copy, Debug)]
pub enum Body {
    /// Flat faces.
    Faces {
        /// The corners.
        corners: &'static [Vec3],
        /// The indices of the corners of each face, counter-clockwise seen from outside.
        faces: &'static [&'static [usize]],
    },
    /// A profile from the top down along the outside, revolved about the y axis, and the circles that an outline shows.
    Revolved {
        /// The segments of the profile, in order.
        profile: &'static [Stretch],
        /// A point of each circle.
        rims: &'static [ProfilePoint],
    },
    /// A box whose faces are bent over its edges by the rounding ellipsoid.
    RoundedBox,
}

impl Body {
    /// Returns whether the surface contains straight lines: along faces, or from rim to rim of a side.
    pub fn has_straight_lines(&self) -> bool {
        match self {
            Body::Faces { .. } | Body::RoundedBox => true,
            Body::Revolved { profile, .. } => {
                profile.iter().any(|stretch| matches!(stretch, Stretch::Line(_)))
            }
        }
    }
}

/// A segment of a profile: x away from the axis, y along it.
#[derive(Clone, Copy, Debug)]
pub enum Stretch {
    /// A straight line of a solid without a core.
    Line([Vec2; 2]),
    /// A circular arc of radius 1 about a point of the core, by angles in turns from the upper end of the axis.
    Arc {
        /// The centre.
        core: Vec2,
        /// The angles at which it begins and ends.
        turns: [f32; 2],
    },
}

impl Stretch {
    /// Returns whether it is a line perpendicular to the axis, which closes a side.
    pub fn is_cap(&self) -> bool {
        matches!(self, Stretch::Line([from, to]) if from.y == to.y)
    }

    /// Returns the point at a fraction of its length from 0 to 1, with the normal there.
    pub fn at(&self, share: f32) -> (ProfilePoint, Vec2) {
        match *self {
            Stretch::Line([from, to]) => {
                let along = to - from;
                let normal = Vec2::new(-along.y, along.x).normalize();
                (ProfilePoint { core: Vec2::ZERO, offset: from + along * share }, normal)
            }
            Stretch::Arc { core, turns: [from, to] } => {
                let (sin, cos) = (TAU * (from + (to - from) * share)).sin_cos();
                let offset = Vec2::new(sin, cos);
                (ProfilePoint { core, offset }, offset)
            }
        }
    }
}

/// A point of a profile: x away from the axis, y along it. With half extents `round` of the rounding ellipsoid, its
/// position is `core * (1 - round) + offset * round`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ProfilePoint {
    /// The point of the core; 0 where there is none.
    pub core: Vec2,
    /// The point of the unit circle about it.
    pub offset: Vec2,
}
