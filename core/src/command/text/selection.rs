//! The text form of commands for areas (marker, selection, symmetry, copies) and orientations, and of switches and
//! choices.

use std::fmt;

use glam::{IVec3, UVec3};

use super::arguments::Arguments;
use super::{ParseError, list, number, numbers, parse_ivec3, parse_vec3};
use crate::command::{Area, Command, SelectOp};
use crate::sculpture::history::SurfaceKind;
use crate::sculpture::orientation::{Orientation, Up};
use crate::sculpture::region::VoxelBox;
use crate::tools::symmetry::{MirrorPlane, Parity, Radial, Symmetry};

const AXES: [&str; 3] = ["x", "y", "z"];

/// Writes the arguments after the verb.
pub fn write(command: &Command, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match command {
        Command::Mark(marker) => {
            // Sizes, since people think in them; they may exceed `i32`.
            let size = |axis: usize| i64::from(marker.max[axis]) - i64::from(marker.min[axis]);
            let size = [size(0), size(1), size(2)];
            write!(f, " at={} size={}", list(marker.min.to_array()), list(size))
        }
        Command::Select(op) => write!(f, " {}", op.name()),
        Command::Limit(on) | Command::Irreversible(on) => {
            write!(f, " {}", if *on { "on" } else { "off" })
        }
        Command::Symmetry(symmetry) => {
            AXES.iter().zip(symmetry.axes).try_for_each(|(axis, parity)| {
                write!(f, " {axis}={}", parity.map_or("off", Parity::name))
            })?;
            if let Some(MirrorPlane { at_vx, normal }) = symmetry.plane {
                let (at, normal) = (list(at_vx.to_array()), list(normal.to_array()));
                write!(f, " plane={at} normal={normal}")?;
            }
            if let Some(Radial { at_vx, axis, count }) = symmetry.radial {
                let (at, axis) = (list(at_vx.to_array()), list(axis.to_array()));
                write!(f, " radial={count} about={at} axis={axis}")?;
            }
            Ok(())
        }
        Command::Paste { at, orientation } => {
            write!(f, " at={} axes={orientation}", list(at.to_array()))
        }
        Command::Move { by, orientation } => {
            write!(f, " by={} axes={orientation}", list(by.to_array()))
        }
        Command::Array { count, step } => {
            write!(f, " count={count} step={}", list(step.to_array()))
        }
        Command::Orient(orientation) => write!(f, " axes={orientation}"),
        Command::Surface(kind) => write!(f, " {}", kind.name()),
        _ => Ok(()),
    }
}

/// Reads the arguments after one of the verbs.
pub fn parse(verb: &str, args: &mut Arguments) -> Result<Command, ParseError> {
    let axes = |args: &mut Arguments| -> Result<Orientation, ParseError> {
        Ok(args.optional("axes", str::parse)?.unwrap_or_default())
    };
    Ok(match verb {
        "mark" => {
            let min = args.required("at", parse_ivec3)?;
            let max = args.required("size", |text| {
                let size = UVec3::from_array(numbers::<u32, 3>(text)?);
                let max = min.as_i64vec3() + size.as_i64vec3();
                let max = IVec3::try_from(max).map_err(|_| "is too large".to_string())?;
                if max.cmple(min).any() { Err("must be at least 1".to_string()) } else { Ok(max) }
            })?;
            Command::Mark(VoxelBox { min, max })
        }
        "select" => {
            let name = args.word("add, subtract, drop or clear")?;
            let op = SelectOp::ALL.into_iter().find(|op| op.name() == name);
            Command::Select(op.ok_or_else(|| {
                ParseError(format!("`{name}` is not valid; use add, subtract, drop or clear"))
            })?)
        }
        "limit" => Command::Limit(parse_switch(args)?),
        "irreversible" => Command::Irreversible(parse_switch(args)?),
        "symmetry" => {
            let mut symmetry = Symmetry::default();
            for (axis, name) in AXES.into_iter().enumerate() {
                symmetry.axes[axis] = args.optional(name, parse_parity)?.flatten();
            }
            if let Some(at_vx) = args.optional("plane", parse_vec3)? {
                let normal = args.required("normal", parse_vec3)?;
                symmetry.plane = Some(MirrorPlane { at_vx, normal });
            }
            if let Some(count) = args.optional("radial", number)? {
                let (at_vx, axis) =
                    (args.required("about", parse_vec3)?, args.required("axis", parse_vec3)?);
                symmetry.radial = Some(Radial { at_vx, axis, count });
            }
            Command::Symmetry(symmetry)
        }
        "copy" => Command::Copy,
        "cut" => Command::Cut,
        "paste" => {
            Command::Paste { at: args.required("at", parse_ivec3)?, orientation: axes(args)? }
        }
        "move" => Command::Move {
            by: args.optional("by", parse_ivec3)?.unwrap_or_default(),
            orientation: axes(args)?,
        },
        "orient" => {
            let upright = args.optional("upright", str::parse)?.map(Up::turned_upright);
            let axes = args.optional("axes", str::parse)?;
            Command::Orient(match (upright, axes) {
                (Some(orientation), None) | (None, Some(orientation)) => orientation,
                _ => {
                    let needs = "`orient` needs either `upright=` or `axes=`";
                    return Err(ParseError(needs.to_string()));
                }
            })
        }
        "surface" => {
            let name = args.word("smooth or cubes")?;
            let named = SurfaceKind::NAMED.into_iter().find(|(_, known)| *known == name);
            let unknown = || ParseError(format!("`{name}` is not a surface; use smooth or cubes"));
            Command::Surface(named.ok_or_else(unknown)?.0)
        }
        _ => Command::Array {
            count: args.required("count", number)?,
            step: args.required("step", parse_ivec3)?,
        },
    })
}

/// Reads the area that a command works on: by default the whole grid.
pub(crate) fn parse_area(args: &mut Arguments) -> Result<Area, ParseError> {
    let Some(name) = args.optional_word()? else { return Ok(Area::Grid) };
    let area = Area::ALL.into_iter().find(|area| area.name() == name);
    area.ok_or_else(|| {
        ParseError(format!("`{name}` is not an area; use grid, selection or marker"))
    })
}

pub(super) fn parse_switch(args: &mut Arguments) -> Result<bool, ParseError> {
    let word = args.word("on or off")?;
    let unknown = || ParseError(format!("`{word}` is not valid; use on or off"));
    is_on(&word).ok_or_else(unknown)
}

/// Returns the value of a switch.
pub(super) fn is_on(word: &str) -> Option<bool> {
    match word {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

fn parse_parity(text: &str) -> Result<Option<Parity>, String> {
    match text {
        "off" => Ok(None),
        "even" => Ok(Some(Parity::Even)),
        "odd" => Ok(Some(Parity::Odd)),
        _ => Err("must be off, even or odd".to_string()),
    }
}
