//! The fields of drawn solids. Each solid lists its own once, in the order of the text form. Reading, writing, usage,
//! checks, shifts and random tests follow from the list.
//!
//! A list of references rather than a visitor, so that every loop over it can stop at the first error. Lengths are in
//! units of the smallest edge of a voxel, positions in voxel coordinates. Knows no solid and no text form.

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

/// Maximum number of points of a curve, or of all outlines together.
pub const MAX_POINTS: usize = 1024;
/// Maximum distance of a position from the origin, and maximum length, in voxels: far beyond every grid, and still
/// exact.
pub const FURTHEST_VX: f32 = 1e6;

/// Returns whether a solid may be at this position, in voxel coordinates.
pub fn is_place(p: Vec3) -> bool {
    p.is_finite() && p.abs().max_element() <= FURTHEST_VX
}

/// A point of a tube's curve.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ControlPoint {
    /// Its position in voxel coordinates.
    pub at_vx: Vec3,
    /// The tube's radius there, in units of the smallest edge of a voxel.
    pub radius: f32,
}

/// The position and rotation of a solid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SolidPose {
    /// Its origin in voxel coordinates.
    pub at_vx: Vec3,
    /// Rotation of its axes relative to the grid's.
    pub rotation: Quat,
}

impl SolidPose {
    /// At the origin of the grid, not rotated.
    pub const IDENTITY: SolidPose = SolidPose { at_vx: Vec3::ZERO, rotation: Quat::IDENTITY };

    /// Returns its fields.
    pub(super) fn fields(&mut self) -> [Field<'_>; 2] {
        let turn = FieldValue::Rotation(&mut self.rotation);
        [
            Field::place(&mut self.at_vx),
            Field { key: "turn", usage: "...", rule: NOT_A_ROTATION, value: turn },
        ]
    }
}

/// A field of a drawn solid.
#[derive(Debug)]
pub struct Field<'a> {
    /// Its name in scripts.
    pub key: &'static str,
    /// Its values in scripts, for help.
    pub usage: &'static str,
    /// The rule for values, as a sentence for messages. For lists of points: the rule for their number.
    pub rule: &'static str,
    /// Its value.
    pub value: FieldValue<'a>,
}

/// The value of a field.
#[derive(Debug)]
pub enum FieldValue<'a> {
    /// A position, in voxel coordinates.
    Place(&'a mut Vec3),
    /// A direction in the world, of any length.
    Direction(&'a mut Vec3),
    /// A rotation; the identity if a script does not state one.
    Rotation(&'a mut Quat),
    /// A length, in units of the smallest edge of a voxel.
    Length(&'a mut f32),
    /// Points of a curve, with radii. A script may state one radius for all.
    Curve(&'a mut Arc<[ControlPoint]>),
    /// Points of an outline in a plane.
    Outline(&'a mut Arc<[Vec2]>),
    /// Several outlines.
    Outlines(&'a mut Arc<[Arc<[Vec2]>]>),
}

const NOT_A_PLACE: &str = "the place must be within a million voxels";
const NOT_A_ROTATION: &str = "the rotation must be a quaternion of length 1";
const NOT_A_POINT: &str = "a point must be within a million voxels";

impl<'a> Field<'a> {
    /// Returns the field for the position of a solid.
    pub(super) fn place(at_vx: &'a mut Vec3) -> Field<'a> {
        let value = FieldValue::Place(at_vx);
        Field { key: "at", usage: "X,Y,Z", rule: NOT_A_PLACE, value }
    }

    /// Returns the field for a length. Help shows it as a letter.
    pub(super) fn length(
        key: &'static str,
        usage: &'static str,
        rule: &'static str,
        length: &'a mut f32,
    ) -> Field<'a> {
        Field { key, usage, rule, value: FieldValue::Length(length) }
    }

    /// Returns whether scripts may omit it.
    pub fn is_optional(&self) -> bool {
        matches!(self.value, FieldValue::Rotation(_))
    }

    pub(super) fn is_length(&self) -> bool {
        matches!(self.value, FieldValue::Length(_))
    }

    /// Returns an error that says why the value is invalid, if it is.
    pub(super) fn check(&self) -> Result<(), &'static str> {
        let holds = match &self.value {
            FieldValue::Place(at_vx) => is_place(**at_vx),
            FieldValue::Direction(direction) => {
                let length = direction.as_dvec3().length();
                length > 1e-12 && length.is_finite()
            }
            FieldValue::Rotation(rotation) => rotation.is_finite() && rotation.is_normalized(),
            FieldValue::Length(length) => is_length(**length),
            FieldValue::Curve(points) => return check_curve(points, self.rule),
            FieldValue::Outline(points) => {
                check_outline(points)?;
                points.len() <= MAX_POINTS
            }
            FieldValue::Outlines(outlines) => {
                require(!outlines.is_empty(), "at least one outline is needed")?;
                outlines.iter().try_for_each(|outline| check_outline(outline))?;
                outlines.iter().map(|outline| outline.len()).sum::<usize>() <= MAX_POINTS
            }
        };
        require(holds, self.rule)
    }

    /// Moves the value with its solid by a number of voxels.
    pub(super) fn shift(self, by_vx: Vec3) {
        match self.value {
            FieldValue::Place(at_vx) => *at_vx += by_vx,
            FieldValue::Curve(points) => {
                *points = points
                    .iter()
                    .map(|point| ControlPoint { at_vx: point.at_vx + by_vx, ..*point })
                    .collect();
            }
            FieldValue::Direction(_)
            | FieldValue::Rotation(_)
            | FieldValue::Length(_)
            | FieldValue::Outline(_)
            | FieldValue::Outlines(_) => {}
        }
    }
}

/// Returns the rule as an error if it does not hold.
pub(super) fn require(holds: bool, rule: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(rule) }
}

fn is_length(length: f32) -> bool {
    length > 0.0 && length <= FURTHEST_VX
}

fn check_curve(points: &[ControlPoint], most: &'static str) -> Result<(), &'static str> {
    require(!points.is_empty(), "at least one point is needed")?;
    require(points.len() <= MAX_POINTS, most)?;
    require(points.iter().all(|point| is_place(point.at_vx)), NOT_A_POINT)?;
    require(
        points.iter().all(|point| is_length(point.radius)),
        "a radius must be above zero and at most a million voxels",
    )
}

fn check_outline(points: &[Vec2]) -> Result<(), &'static str> {
    require(points.len() >= 2, "at least two points are needed")?;
    require(points.iter().all(|point| is_place(point.extend(0.0))), NOT_A_POINT)
}
