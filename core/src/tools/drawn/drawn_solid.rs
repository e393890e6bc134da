//! Solids that are drawn rather than placed in a box: a half space, a ring, a tube along a curve, a turned profile and an
//! extruded outline.
//!
//! Defines what they are and which values are valid; [`super::region`] gives their voxels. Lengths are in units of
//! the smallest edge of a voxel, places in voxel coordinates. Knows no document.

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

/// Most points of a curve, or of all outlines together.
pub const MAX_POINTS: usize = 1024;
/// Furthest place from the origin and longest length, in voxels: far beyond every grid, and still exact.
pub const FURTHEST_VX: f32 = 1e6;

/// Whether a solid may be there, in voxel coordinates.
pub fn is_place(p: Vec3) -> bool {
    p.is_finite() && p.abs().max_element() <= FURTHEST_VX
}

/// A point of a tube's curve.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ControlPoint {
    /// Its place in voxel coordinates.
    pub at_vx: Vec3,
    /// The tube's radius there, in units of the smallest edge of a voxel.
    pub radius: f32,
}

/// Where a solid is and how it is turned.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pose {
    /// Its origin in voxel coordinates.
    pub at_vx: Vec3,
    /// Rotation of its axes against the grid's.
    pub rotation: Quat,
}

/// A solid that is drawn.
#[derive(Clone, PartialEq, Debug)]
pub enum DrawnSolid {
    /// All on the side of a plane that its normal points to.
    HalfSpace {
        /// A point of the plane, in voxel coordinates.
        at_vx: Vec3,
        /// Perpendicular to it in the world, of any length.
        normal: Vec3,
    },
    /// A torus about its y axis.
    Ring {
        /// Its centre and axis.
        pose: Pose,
        /// From the centre to the middle of the tube.
        radius: f32,
        /// Radius of the tube.
        tube: f32,
    },
    /// The volume that a ball sweeps along a curve through points, its radius changing from one to the next: a
    /// centripetal Catmull-Rom spline (Yuksel, Schaefer, Keyser: Parameterization and Applications of Catmull-Rom
    /// Curves, 2011). Two points make a line, one a ball.
    Tube {
        /// The points.
        control_points: Arc<[ControlPoint]>,
    },
    /// A profile turned about its y axis: points of distance from the axis and height. From the first and the last
    /// point, a straight line leads to the axis.
    Lathe {
        /// Its origin and axis.
        pose: Pose,
        /// The profile.
        profile: Arc<[Vec2]>,
    },
    /// Outlines in the plane of its x and y axes, extruded by half of `depth` to both sides. A point is inside if an odd
    /// number of outlines is around it, so that an outline in another one is a hole.
    Extrusion {
        /// Its origin and axes.
        pose: Pose,
        /// The outlines, each closed from its last point to its first.
        outlines: Arc<[Arc<[Vec2]>]>,
        /// Its length along z.
        depth: f32,
    },
}

impl DrawnSolid {
    /// The names of all forms, for messages.
    pub const NAMES: &str = "half-space, ring, tube, lathe or extrusion";

    /// Its name in the text form.
    pub const fn name(&self) -> &'static str {
        match self {
            DrawnSolid::HalfSpace { .. } => "half-space",
            DrawnSolid::Ring { .. } => "ring",
            DrawnSolid::Tube { .. } => "tube",
            DrawnSolid::Lathe { .. } => "lathe",
            DrawnSolid::Extrusion { .. } => "extrusion",
        }
    }

    /// An error that says which value is invalid, if one is.
    pub fn check(&self) -> Result<(), &'static str> {
        let place = is_place;
        let length = |v: f32| v > 0.0 && v <= FURTHEST_VX;
        let pose = |pose: &Pose| match pose.rotation.is_finite() && pose.rotation.is_normalized() {
            _ if !place(pose.at_vx) => Err("the place must be within a million voxels"),
            false => Err("the rotation must be a quaternion of length 1"),
            true => Ok(()),
        };
        let points = |points: &[Vec2]| match points.len() {
            0..2 => Err("at least two points are needed"),
            _ if points.iter().all(|p| place(p.extend(0.0))) => Ok(()),
            _ => Err("a point must be within a million voxels"),
        };
        match self {
            DrawnSolid::HalfSpace { at_vx, .. } if !place(*at_vx) => {
                Err("the place must be within a million voxels")
            }
            DrawnSolid::HalfSpace { normal, .. } => match normal.as_dvec3().length() {
                length if length > 1e-12 && length.is_finite() => Ok(()),
                _ => Err("the normal must have a direction"),
            },
            DrawnSolid::Ring { pose: at, radius, tube } => {
                pose(at)?;
                match length(*radius) && length(*tube) {
                    true => Ok(()),
                    false => Err("both radii must be above zero and at most a million voxels"),
                }
            }
            DrawnSolid::Tube { control_points } => match control_points.len() {
                0 => Err("at least one point is needed"),
                n if n > MAX_POINTS => Err("more than 1024 points; use several tubes"),
                _ if !control_points.iter().all(|control_point| place(control_point.at_vx)) => {
                    Err("a point must be within a million voxels")
                }
                _ if !control_points.iter().all(|control_point| length(control_point.radius)) => {
                    Err("a radius must be above zero and at most a million voxels")
                }
                _ if control_points.windows(2).any(|pair| pair[0].at_vx == pair[1].at_vx) => {
                    Err("two points that follow each other lie in the same place")
                }
                _ => Ok(()),
            },
            DrawnSolid::Lathe { pose: at, profile } => {
                pose(at)?;
                points(profile)?;
                match profile.iter().all(|p| p.x >= 0.0) {
                    _ if profile.len() > MAX_POINTS => Err("the profile has more than 1024 points"),
                    false => Err("the profile must not cross its axis: distances are at least 0"),
                    true => Ok(()),
                }
            }
            DrawnSolid::Extrusion { pose: at, outlines, depth } => {
                pose(at)?;
                if outlines.is_empty() {
                    return Err("at least one outline is needed");
                }
                outlines.iter().try_for_each(|outline| points(outline))?;
                match length(*depth) {
                    _ if outlines.iter().map(|outline| outline.len()).sum::<usize>()
                        > MAX_POINTS =>
                    {
                        Err("the outlines have more than 1024 points")
                    }
                    false => Err("the depth must be above zero and at most a million voxels"),
                    true => Ok(()),
                }
            }
        }
    }

    /// The same, moved by a number of voxels.
    pub fn shifted(&self, by_vx: Vec3) -> DrawnSolid {
        let mut form = self.clone();
        match &mut form {
            DrawnSolid::HalfSpace { at_vx, .. } => *at_vx += by_vx,
            DrawnSolid::Ring { pose, .. }
            | DrawnSolid::Lathe { pose, .. }
            | DrawnSolid::Extrusion { pose, .. } => {
                pose.at_vx += by_vx;
            }
            DrawnSolid::Tube { control_points } => {
                *control_points = control_points
                    .iter()
                    .map(|b| ControlPoint { at_vx: b.at_vx + by_vx, ..*b })
                    .collect();
            }
        }
        form
    }
}
