//! The text form of drawn solids, made from their fields: a new solid needs nothing here.

use std::fmt;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use super::arguments::Arguments;
use super::{ParseError, list, number, numbers, parse_rotation, parse_vec3};
use crate::tools::drawn::{ControlPoint, DrawnSolid, DrawnSpec, Field, FieldValue, SolidPose};

/// Returns the name of a solid and its arguments for help, optional ones last.
pub fn usage(spec: &DrawnSpec) -> String {
    let mut solid = (spec.example)(SolidPose::IDENTITY, 1.0);
    let (optional, required): (Vec<_>, Vec<_>) =
        solid.fields().into_iter().partition(Field::is_optional);
    let required = required.iter().map(|field| format!(" {}={}", field.key, field.usage));
    let optional = optional.iter().map(|field| format!(" [{}={}]", field.key, field.usage));
    spec.name.to_string() + &required.chain(optional).collect::<String>()
}

/// Writes the name and the arguments.
pub fn write(solid: &DrawnSolid, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, " {}", solid.name())?;
    solid.clone().fields().into_iter().try_for_each(|Field { key, value, .. }| match value {
        FieldValue::Place(v) | FieldValue::Direction(v) => {
            write!(f, " {key}={}", list(v.to_array()))
        }
        FieldValue::Rotation(rotation) => write!(f, " {key}={}", list(rotation.to_array())),
        FieldValue::Length(length) => write!(f, " {key}={length}"),
        FieldValue::Curve(curve) => {
            let point = |p: &ControlPoint| list(p.at_vx.extend(p.radius).to_array());
            write!(f, " {key}={}", joined(curve, ";", point))
        }
        FieldValue::Outline(outline) => write!(f, " {key}={}", points(outline)),
        FieldValue::Outlines(outlines) => write!(f, " {key}={}", joined(outlines, "/", points)),
    })
}

fn points(points: &Arc<[Vec2]>) -> String {
    joined(points, ";", |p| list(p.to_array()))
}

fn joined<T>(items: &[T], between: &str, text: impl Fn(&T) -> String) -> String {
    items.iter().map(text).collect::<Vec<_>>().join(between)
}

/// Reads the arguments after the name; `None` if it is not the name of a drawn solid.
pub fn parse(name: &str, args: &mut Arguments) -> Result<Option<DrawnSolid>, ParseError> {
    let Some(spec) = DrawnSolid::named(name) else { return Ok(None) };
    // Every field of the example is overwritten.
    let mut solid = (spec.example)(SolidPose::IDENTITY, 1.0);
    solid.fields().into_iter().try_for_each(|field| read(field, args))?;
    Ok(Some(solid))
}

fn read(Field { key, value, .. }: Field<'_>, args: &mut Arguments) -> Result<(), ParseError> {
    match value {
        FieldValue::Place(v) | FieldValue::Direction(v) => *v = args.required(key, parse_vec3)?,
        FieldValue::Rotation(rotation) => {
            *rotation = args.optional(key, parse_rotation)?.unwrap_or(Quat::IDENTITY);
        }
        FieldValue::Length(length) => *length = args.required(key, number)?,
        FieldValue::Curve(curve) => {
            let radius = args.optional("radius", number)?;
            let point = |text: &str| parse_control_point(text, radius);
            *curve = args.required(key, |text| text.split(';').map(point).collect())?;
        }
        FieldValue::Outline(outline) => *outline = args.required(key, parse_points)?,
        FieldValue::Outlines(outlines) => {
            *outlines = args.required(key, |text| text.split('/').map(parse_points).collect())?;
        }
    }
    Ok(())
}

fn parse_points(text: &str) -> Result<Arc<[Vec2]>, String> {
    text.split(';').map(|point| numbers::<f32, 2>(point).map(Vec2::from_array)).collect()
}

/// Reads a point of four numbers, or of three with the common radius.
fn parse_control_point(text: &str, radius: Option<f32>) -> Result<ControlPoint, String> {
    if let Some(radius) = radius {
        return Ok(ControlPoint { at_vx: parse_vec3(text)?, radius });
    }
    let [x, y, z, radius] = numbers::<f32, 4>(text).map_err(|error| {
        format!("{error}: place and radius; or give `radius=` and points of three numbers")
    })?;
    Ok(ControlPoint { at_vx: Vec3::new(x, y, z), radius })
}
