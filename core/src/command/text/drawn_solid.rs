//! The text form of solids that are drawn.

use std::fmt;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use super::arguments::Arguments;
use super::{ParseError, list, number, numbers, parse_rotation, parse_vec3};
use crate::tools::drawn::{ControlPoint, DrawnSolid, Pose};

/// Writes the name and what follows it.
pub fn write(form: &DrawnSolid, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, " {}", form.name())?;
    match form {
        DrawnSolid::HalfSpace { at_vx, normal } => {
            write!(f, " at={} normal={}", list(at_vx.to_array()), list(normal.to_array()))
        }
        DrawnSolid::Ring { pose, radius, tube } => {
            write_pose(pose, f)?;
            write!(f, " radius={radius} tube={tube}")
        }
        DrawnSolid::Tube { control_points } => {
            let control_point = |b: &ControlPoint| list(b.at_vx.extend(b.radius).to_array());
            write!(f, " points={}", joined(control_points, ";", control_point))
        }
        DrawnSolid::Lathe { pose, profile } => {
            write_pose(pose, f)?;
            write!(f, " profile={}", points(profile))
        }
        DrawnSolid::Extrusion { pose, outlines, depth } => {
            write_pose(pose, f)?;
            write!(f, " depth={depth} outline={}", joined(outlines, "/", points))
        }
    }
}

fn write_pose(pose: &Pose, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let Pose { at_vx, rotation } = pose;
    write!(f, " at={} turn={}", list(at_vx.to_array()), list(rotation.to_array()))
}

fn points(points: &Arc<[Vec2]>) -> String {
    joined(points, ";", |p| list(p.to_array()))
}

fn joined<T>(items: &[T], between: &str, text: impl Fn(&T) -> String) -> String {
    items.iter().map(text).collect::<Vec<_>>().join(between)
}

/// Reads what follows the name; None if it is not that of a form.
pub fn parse(name: &str, args: &mut Arguments) -> Result<Option<DrawnSolid>, ParseError> {
    Ok(Some(match name {
        "half-space" => DrawnSolid::HalfSpace {
            at_vx: args.required("at", parse_vec3)?,
            normal: args.required("normal", parse_vec3)?,
        },
        "ring" => DrawnSolid::Ring {
            pose: parse_pose(args)?,
            radius: args.required("radius", number)?,
            tube: args.required("tube", number)?,
        },
        "tube" => {
            let radius = args.optional("radius", number)?;
            let control_point = |text: &str| parse_control_point(text, radius);
            let control_points =
                args.required("points", |text| text.split(';').map(control_point).collect())?;
            DrawnSolid::Tube { control_points }
        }
        "lathe" => DrawnSolid::Lathe {
            pose: parse_pose(args)?,
            profile: args.required("profile", parse_points)?,
        },
        "extrusion" => DrawnSolid::Extrusion {
            pose: parse_pose(args)?,
            depth: args.required("depth", number)?,
            outlines: args
                .required("outline", |text| text.split('/').map(parse_points).collect())?,
        },
        _ => return Ok(None),
    }))
}

fn parse_pose(args: &mut Arguments) -> Result<Pose, ParseError> {
    Ok(Pose {
        at_vx: args.required("at", parse_vec3)?,
        rotation: args.optional("turn", parse_rotation)?.unwrap_or(Quat::IDENTITY),
    })
}

fn parse_points(text: &str) -> Result<Arc<[Vec2]>, String> {
    text.split(';').map(|point| numbers::<f32, 2>(point).map(Vec2::from_array)).collect()
}

/// A point of four numbers, or of three with the radius of all.
fn parse_control_point(text: &str, radius: Option<f32>) -> Result<ControlPoint, String> {
    if let Some(radius) = radius {
        return Ok(ControlPoint { at_vx: parse_vec3(text)?, radius });
    }
    let [x, y, z, radius] = numbers::<f32, 4>(text).map_err(|error| {
        format!("{error}: place and radius; or give `radius=` and points of three numbers")
    })?;
    Ok(ControlPoint { at_vx: Vec3::new(x, y, z), radius })
}
