//! A single use of a brush: the brush, the place and the values. Commands hold such uses; the brush's file computes
//! what they change.

use std::path::PathBuf;

use glam::Vec3;

use super::BrushId;
use super::footprint::{Footprint, MAX_FOOTPRINT};
use super::keys::COLOUR;
use super::limits::{MAX_PULL_VX, MAX_RADIUS, MIN_RADIUS};
use super::options::ParamValues;
use super::param::{Key, Omitted, OptionValue, Param, ParamValue};
use crate::refusal::InvalidValue;

/// The name by which errors call any brush.
pub(in crate::tools::brush) const OWNER: &str = "brush";

/// A single use of a brush.
#[derive(Clone, PartialEq, Debug)]
pub struct BrushUse {
    brush: BrushId,
    /// The place where it is used.
    pub contact: Contact,
    /// The surface on which it works.
    pub surface: BrushSurface,
    /// The PNG or JPEG file with which it paints; its longer side is as long as the brush is wide.
    pub picture: Option<PathBuf>,
    values: ParamValues,
}

/// The surface on which the rays of a brush are cast, or the clay that it moves.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum BrushSurface {
    /// The current surface, so that strokes go deeper where they overlap, and pulls continue from there.
    #[default]
    Now,
    /// The surface before the first use with this setting in the stroke, so that no use reverts the effect of others. A
    /// pull replaces all that the stroke has done so far.
    Stroke,
}

/// The place where a brush is used.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Contact {
    /// Under an outline in a picture.
    Footprint(Footprint),
    /// In a ball.
    Ball(BrushBall),
}

/// The kinds of places where brushes are used.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum ContactKind {
    /// Under an outline in a picture.
    Footprint,
    /// In a ball, along the normals of the surface.
    Ball,
    /// In a ball with an outward direction.
    BallWithNormal,
    /// In a ball that is displaced.
    BallWithDisplacement,
}

/// A ball in which a brush works.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BrushBall {
    /// The centre, in voxel coordinates.
    pub centre_vx: Vec3,
    /// The radius in units of the smallest voxel edge, from [`MIN_RADIUS`] to [`MAX_RADIUS`].
    pub radius: f32,
    /// The direction in which the brush works.
    pub frame: BrushDirection,
}

/// The direction in which a brush works.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum BrushDirection {
    /// None: along the normals of the surface.
    None,
    /// The outward direction, or an axis, of any length.
    Normal(Vec3),
    /// The displacement of the centre of the ball, in voxels; at most [`MAX_PULL_VX`] along each axis.
    Displacement(Vec3),
}

impl BrushUse {
    /// Creates a use with the values that a script need not state.
    pub fn new(brush: BrushId, contact: Contact) -> BrushUse {
        let omitted = |param: &Param| match param.omitted {
            Omitted::Required | Omitted::InsteadOf(..) => OptionValue::Absent,
            Omitted::Is(value) | Omitted::Unwritten(value) => value,
        };
        let values = ParamValues::new(brush.spec().params(), omitted);
        BrushUse { brush, contact, surface: BrushSurface::Now, picture: None, values }
    }

    /// Creates a use under an outline in a picture.
    pub fn under(brush: BrushId, footprint: Footprint) -> BrushUse {
        BrushUse::new(brush, Contact::Footprint(footprint))
    }

    /// Creates a use in a ball.
    pub fn in_ball(brush: BrushId, ball: BrushBall) -> BrushUse {
        BrushUse::new(brush, Contact::Ball(ball))
    }

    /// Returns the same use on another surface.
    pub fn on(mut self, surface: BrushSurface) -> BrushUse {
        self.surface = surface;
        self
    }

    /// Returns the same use with another value of a parameter, if the brush has it.
    pub fn with<T: ParamValue>(mut self, key: Key<T>, value: T) -> BrushUse {
        self.set_value(key.param.key, value.to_value());
        self
    }

    /// Sets the value of a parameter given by its name.
    pub fn set_value(&mut self, key: &str, value: OptionValue) {
        self.values.set(self.brush.spec().params(), key, value);
    }

    /// Returns the same use with the values that replace omitted parameters.
    pub(crate) fn completed(mut self) -> BrushUse {
        let params = self.brush.spec().params();
        for param in params {
            if let Omitted::InsteadOf(other, value) = param.omitted
                && self.values.get(params, other) == Some(OptionValue::Absent)
                && self.values.get(params, param.key) == Some(OptionValue::Absent)
            {
                self.set_value(param.key, value);
            }
        }
        self
    }

    /// Returns the brush.
    pub fn brush(&self) -> BrushId {
        self.brush
    }

    /// Returns the value of a parameter, if it has one.
    pub fn find<T: ParamValue>(&self, key: Key<T>) -> Option<T> {
        self.values.get(self.brush.spec().params(), key.param.key).and_then(T::from_value)
    }

    /// Returns the value of a parameter given by its name, if it has one.
    pub(crate) fn value(&self, key: &str) -> Option<OptionValue> {
        let value = self.values.get(self.brush.spec().params(), key);
        value.filter(|value| *value != OptionValue::Absent)
    }

    /// Returns the value of a parameter that has passed the check.
    pub(super) fn get<T: ParamValue + Default>(&self, key: Key<T>) -> T {
        self.find(key).unwrap_or_default()
    }

    /// Returns all parameters with their values, in the order of the text form.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Param, OptionValue)> + use<> {
        self.values.iter(self.brush.spec().params())
    }

    /// Returns the footprint under which the brush is used.
    pub fn footprint(&self) -> Option<&Footprint> {
        match &self.contact {
            Contact::Footprint(footprint) => Some(footprint),
            Contact::Ball(_) => None,
        }
    }

    /// Returns the ball in which the brush is used.
    pub fn ball(&self) -> Option<&BrushBall> {
        match &self.contact {
            Contact::Ball(ball) => Some(ball),
            Contact::Footprint(_) => None,
        }
    }

    /// Returns whether it replaces what the stroke has done so far.
    pub fn replaces_stroke(&self) -> bool {
        let replaces = self.brush.spec().script.is_some_and(|script| script.replaces_stroke);
        replaces && self.surface == BrushSurface::Stroke
    }

    /// Returns the same use, translated by a number of voxels.
    pub(crate) fn shifted(&self, by_vx: Vec3) -> BrushUse {
        let mut moved = self.clone();
        match &mut moved.contact {
            Contact::Footprint(footprint) => footprint.eye_vx += by_vx,
            Contact::Ball(ball) => ball.centre_vx += by_vx,
        }
        moved
    }

    /// Returns an error that names the first invalid field, if there is one.
    pub fn check(&self) -> Result<(), InvalidValue> {
        self.check_fields().map_err(|error| error.of(OWNER))
    }

    fn check_fields(&self) -> Result<(), InvalidValue> {
        match &self.contact {
            Contact::Footprint(footprint) => check_footprint(footprint)?,
            Contact::Ball(ball) => check_ball(ball)?,
        }
        if self.brush.spec().script.is_none_or(|script| script.contact != self.contact.kind()) {
            return Err(InvalidValue::without_value("place", "is not one where it can be used"));
        }
        for (param, value) in self.iter() {
            let is_needed = match param.omitted {
                // An image has its own colours.
                Omitted::Required => self.picture.is_none() || param.key != COLOUR.param.key,
                Omitted::InsteadOf(other, _) => {
                    self.values.get(self.brush.spec().params(), other) == Some(OptionValue::Absent)
                }
                Omitted::Is(_) | Omitted::Unwritten(_) => false,
            };
            if value == OptionValue::Absent && is_needed {
                return Err(InvalidValue::without_value(param.key, "is missing"));
            }
            if value != OptionValue::Absent && !param.allows(value, MIN_RADIUS..=MAX_RADIUS) {
                return Err(InvalidValue::new(param.key, param.rule(), value));
            }
        }
        Ok(())
    }
}

impl Contact {
    /// Returns the kind of contact.
    pub fn kind(&self) -> ContactKind {
        match self {
            Contact::Footprint(_) => ContactKind::Footprint,
            Contact::Ball(BrushBall { frame: BrushDirection::None, .. }) => ContactKind::Ball,
            Contact::Ball(BrushBall { frame: BrushDirection::Normal(_), .. }) => {
                ContactKind::BallWithNormal
            }
            Contact::Ball(BrushBall { frame: BrushDirection::Displacement(_), .. }) => {
                ContactKind::BallWithDisplacement
            }
        }
    }
}

fn check_footprint(footprint: &Footprint) -> Result<(), InvalidValue> {
    let Footprint { eye_vx, aim, across, down, radius, .. } = footprint;
    if let Some(ray) = [eye_vx, aim, across, down].into_iter().find(|vector| !vector.is_finite()) {
        return Err(InvalidValue::new("footprint", "must have finite rays", ray));
    }
    match (0.0..=MAX_FOOTPRINT).contains(radius) {
        true => Ok(()),
        false => {
            let rule = format!("must be from 0 to {MAX_FOOTPRINT} rays");
            Err(InvalidValue::new("radius", rule, radius))
        }
    }
}

fn check_ball(ball: &BrushBall) -> Result<(), InvalidValue> {
    let BrushBall { centre_vx, radius, frame } = *ball;
    if !centre_vx.is_finite() || centre_vx.abs().max_element() > 1e6 {
        return Err(InvalidValue::new("middle", "must lie near the grid", centre_vx));
    }
    if !(MIN_RADIUS..=MAX_RADIUS).contains(&radius) {
        let rule = format!("must be from {MIN_RADIUS} to {MAX_RADIUS} voxels");
        return Err(InvalidValue::new("radius", rule, radius));
    }
    match frame {
        BrushDirection::Normal(normal) if normal.try_normalize().is_none() => {
            Err(InvalidValue::new("normal", "must be a direction", normal))
        }
        BrushDirection::Displacement(by)
            if !by.is_finite() || by.abs().max_element() > MAX_PULL_VX =>
        {
            let rule = format!("must be at most {MAX_PULL_VX} voxels along each axis");
            Err(InvalidValue::new("pull", rule, by))
        }
        _ => Ok(()),
    }
}
