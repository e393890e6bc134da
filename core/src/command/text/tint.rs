//! The text form of commands that change colours voxel by voxel.

use std::fmt;

use glam::IVec3;

use super::arguments::Arguments;
use super::{ParseError, list, number, parse_colour, parse_place, parse_vec3, selection};
use crate::command::{Area, Command};
use crate::sculpture::Rgb;
use crate::tools::tint::Tint;

/// Default size of the patches of noise, in units of the smallest edge of a voxel.
const SIZE: f32 = 16.0;
/// Default amount of noise.
const AMOUNT: f32 = 0.5;

/// Writes the arguments after the verb of a tint.
pub fn write(area: Area, tint: &Tint, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, " {}", area.name())?;
    match tint {
        Tint::Adjust { hue_deg, saturation, value } => {
            write!(f, " hue={hue_deg} saturation={saturation} value={value}")
        }
        Tint::Gradient { from_vx, to_vx, colours: [colour, end], strength } => {
            let [from, to] = [from_vx, to_vx].map(|point| list(point.to_array()));
            write!(f, " from={from} to={to} colour={colour} end={end} strength={strength}")
        }
        Tint::Noise { colour, size, amount, seed } => {
            write!(f, " colour={colour} size={size} amount={amount} seed={seed}")
        }
    }
}

/// Reads the arguments after the verb of a tint.
pub fn parse(verb: &str, args: &mut Arguments) -> Result<Command, ParseError> {
    let area = selection::parse_area(args)?;
    let tint = match verb {
        "adjust" => Tint::Adjust {
            hue_deg: args.optional("hue", number)?.unwrap_or(0.0),
            saturation: args.optional("saturation", number)?.unwrap_or(1.0),
            value: args.optional("value", number)?.unwrap_or(1.0),
        },
        "gradient" => Tint::Gradient {
            from_vx: args.required("from", parse_vec3)?,
            to_vx: args.required("to", parse_vec3)?,
            colours: [args.required("colour", parse_colour)?, args.required("end", parse_colour)?],
            strength: args.optional("strength", number)?.unwrap_or(1.0),
        },
        _ => Tint::Noise {
            colour: args.required("colour", parse_colour)?,
            size: args.optional("size", number)?.unwrap_or(SIZE),
            amount: args.optional("amount", number)?.unwrap_or(AMOUNT),
            seed: args.optional("seed", number)?.unwrap_or(0),
        },
    };
    Ok(Command::Tint { area, tint })
}

/// Writes the arguments after the verb of a flood fill.
pub(crate) fn write_flood(
    at: IVec3,
    colour: Rgb,
    tolerance: f32,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    write!(f, " at={} colour={colour} tolerance={tolerance}", list(at.to_array()))
}

/// Reads the arguments after the verb of a flood fill.
pub(crate) fn parse_flood(args: &mut Arguments) -> Result<Command, ParseError> {
    Ok(Command::Flood {
        at: args.required("at", parse_place)?,
        colour: args.required("colour", parse_colour)?,
        tolerance: args.optional("tolerance", number)?.unwrap_or(0.0),
    })
}
