//! The text form of commands for the mask.

use std::fmt;

use super::arguments::Arguments;
use super::{
    ParseError, drawn_solid, list, number, parse_colour, parse_place, parse_swept, solid_names,
    write_placed,
};
use crate::command::{Area, Command, MaskArea, MaskChange, PatchRule};

/// Default distance at which cavities are sought, in voxels.
const REACH_VX: u32 = 4;
/// Default depth below the surface to which a patch protects, in voxels.
const DEPTH_VX: u32 = 2;

/// Writes the arguments after the verb.
pub fn write(change: &MaskChange, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, " {}", change.name())?;
    match change {
        MaskChange::Clear | MaskChange::Invert => Ok(()),
        MaskChange::Grow(by) | MaskChange::Shrink(by) => write!(f, " by={by}"),
        MaskChange::Smooth(around) => write!(f, " around={around}"),
        MaskChange::Put { what, .. } => match what {
            MaskArea::Area(area) => write!(f, " {}", area.name()),
            MaskArea::Solid { primitive, to_vx } => write_placed(primitive, *to_vx, f),
            MaskArea::DrawnSolid(drawn) => drawn_solid::write(drawn, f),
            MaskArea::Colour { colour, tolerance } => {
                write!(f, " colour colour={colour} tolerance={tolerance}")
            }
            MaskArea::Cavities { reach_vx, depth_vx } => {
                write!(f, " cavities within={reach_vx} depth={depth_vx}")
            }
            MaskArea::Patch { at, by, depth_vx } => {
                write!(f, " patch at={}", list(at.to_array()))?;
                match by {
                    PatchRule::Colour(tolerance) => write!(f, " tolerance={tolerance}"),
                    PatchRule::Flat(angle_deg) => write!(f, " angle={angle_deg}"),
                }?;
                write!(f, " depth={depth_vx}")
            }
            MaskArea::Piece { at } => write!(f, " piece at={}", list(at.to_array())),
        },
    }
}

/// Reads the arguments after the verb.
pub fn parse(args: &mut Arguments) -> Result<Command, ParseError> {
    const CHANGES: &str = "add, subtract, clear, invert, grow, shrink or smooth";
    let name = args.word(CHANGES)?;
    let change = match name.as_str() {
        "clear" => MaskChange::Clear,
        "invert" => MaskChange::Invert,
        "grow" => MaskChange::Grow(args.optional("by", number)?.unwrap_or(1)),
        "shrink" => MaskChange::Shrink(args.optional("by", number)?.unwrap_or(1)),
        "smooth" => MaskChange::Smooth(args.optional("around", number)?.unwrap_or(2)),
        "add" | "subtract" => MaskChange::Put { adds: name == "add", what: parse_area(args)? },
        _ => return Err(ParseError(format!("`{name}` is not valid; use {CHANGES}"))),
    };
    Ok(Command::Mask(change))
}

fn parse_area(args: &mut Arguments) -> Result<MaskArea, ParseError> {
    let names =
        format!("grid, selection, marker, colour, cavities, patch, piece, {}", solid_names());
    let name = args.word(&names)?;
    if let Some(area) = Area::ALL.into_iter().find(|area| area.name() == name) {
        return Ok(MaskArea::Area(area));
    }
    Ok(match name.as_str() {
        "colour" => MaskArea::Colour {
            colour: args.required("colour", parse_colour)?,
            tolerance: args.optional("tolerance", number)?.unwrap_or(0.0),
        },
        "cavities" => MaskArea::Cavities {
            reach_vx: args.optional("within", number)?.unwrap_or(REACH_VX),
            depth_vx: args.optional("depth", number)?.unwrap_or(DEPTH_VX),
        },
        "patch" => MaskArea::Patch {
            at: args.required("at", parse_place)?,
            by: match (args.optional("tolerance", number)?, args.optional("angle", number)?) {
                (None, Some(angle_deg)) => PatchRule::Flat(angle_deg),
                (tolerance, None) => PatchRule::Colour(tolerance.unwrap_or(0.0)),
                _ => {
                    let both = "a patch is by colour (`tolerance=`) or flat (`angle=`), not both";
                    return Err(ParseError(both.to_string()));
                }
            },
            depth_vx: args.optional("depth", number)?.unwrap_or(DEPTH_VX),
        },
        "piece" => MaskArea::Piece { at: args.required("at", parse_place)? },
        _ => match drawn_solid::parse(&name, args)? {
            Some(drawn) => MaskArea::DrawnSolid(drawn),
            None => {
                let (primitive, to_vx) = parse_swept(&name, args, &names)?;
                MaskArea::Solid { primitive, to_vx }
            }
        },
    })
}
