//! The text form of changes of a sculpture's box.

use std::fmt;

use glam::UVec3;

use super::arguments::Arguments;
use super::{ParseError, list, number, numbers, selection};
use crate::command::CanvasChange;
use crate::sculpture::canvas_frame::CanvasSides;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Writes the arguments after the verb.
pub fn write(change: &CanvasChange, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, " {}", change.name())?;
    match change {
        CanvasChange::Size(dims) => write!(f, " dims={}", list(dims.to_array())),
        CanvasChange::Grow { by_vx, sides } => {
            write!(f, " by={by_vx} sides={}", sides_text(sides))
        }
        CanvasChange::Crop => Ok(()),
        CanvasChange::Auto(on) => write!(f, " {}", if *on { "on" } else { "off" }),
    }
}

fn sides_text(sides: &CanvasSides) -> String {
    let names = AXES.iter().enumerate().flat_map(|(axis, name)| {
        let high = sides.high[axis].then(|| name.to_string());
        let low = sides.low[axis].then(|| format!("-{name}"));
        [high, low].into_iter().flatten()
    });
    names.collect::<Vec<_>>().join(",")
}

/// Reads the arguments after the verb.
pub fn parse(args: &mut Arguments) -> Result<CanvasChange, ParseError> {
    const CHANGES: &str = "size, grow, crop or auto";
    let name = args.word(CHANGES)?;
    Ok(match name.as_str() {
        "size" => {
            let dims = |text: &str| numbers::<u32, 3>(text).map(UVec3::from_array);
            CanvasChange::Size(args.required("dims", dims)?)
        }
        "grow" => CanvasChange::Grow {
            by_vx: args.required("by", number)?,
            sides: args.optional("sides", parse_sides)?.unwrap_or(CanvasSides::ALL),
        },
        "crop" => CanvasChange::Crop,
        "auto" => CanvasChange::Auto(selection::parse_switch(args)?),
        _ => return Err(ParseError(format!("`{name}` is not valid; use {CHANGES}"))),
    })
}

fn parse_sides(text: &str) -> Result<CanvasSides, String> {
    let mut sides = CanvasSides { low: [false; 3], high: [false; 3] };
    for side in text.split(',').filter(|side| !side.is_empty()) {
        let (name, of) = match side.strip_prefix('-') {
            Some(name) => (name, &mut sides.low),
            None => (side, &mut sides.high),
        };
        let axis = AXES.iter().position(|axis| *axis == name);
        of[axis.ok_or_else(|| "must be some of x, -x, y, -y, z and -z".to_string())?] = true;
    }
    Ok(sides)
}
