//! The text form of the commands that move a ball of clay: `grab`, and `deform twist` and `deform pinch`.

use std::fmt;

use super::arguments::Arguments;
use super::spray::parse_surface;
use super::{ParseError, list, number, parse_vec3};
use crate::command::{Command, SpraySurface};
use crate::tools::brush::kernel::grab::{Falloff, Grab, Motion};

/// Writes what follows the verb.
pub fn write(grab: &Grab, surface: SpraySurface, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let Grab { centre_vx, radius, motion, falloff } = grab;
    if let Motion::Twist { .. } | Motion::Pinch { .. } = motion {
        write!(f, " {}", motion.kind().name())?;
    }
    write!(f, " at={} radius={radius}", list(centre_vx.to_array()))?;
    match motion {
        Motion::Pull { by_vx } => write!(f, " by={}", list(by_vx.to_array()))?,
        Motion::Twist { normal, angle_deg } => {
            write!(f, " normal={} angle={angle_deg}", list(normal.to_array()))?;
        }
        Motion::Pinch { normal, strength } => {
            write!(f, " normal={} strength={strength}", list(normal.to_array()))?;
        }
    }
    write!(f, " falloff={}", falloff.name())?;
    match surface {
        SpraySurface::Now => Ok(()),
        SpraySurface::Stroke => write!(f, " surface=stroke"),
    }
}

/// Reads what follows `grab`.
pub fn parse(args: &mut Arguments) -> Result<Command, ParseError> {
    let motion = Motion::Pull { by_vx: args.required("by", parse_vec3)? };
    parse_ball(args, motion)
}

/// Reads what follows `deform twist`.
pub fn parse_twist(args: &mut Arguments) -> Result<Command, ParseError> {
    let normal = args.required("normal", parse_vec3)?;
    let motion = Motion::Twist { normal, angle_deg: args.required("angle", number)? };
    parse_ball(args, motion)
}

/// Reads what follows `deform pinch`.
pub fn parse_pinch(args: &mut Arguments) -> Result<Command, ParseError> {
    let normal = args.required("normal", parse_vec3)?;
    let motion = Motion::Pinch { normal, strength: args.required("strength", number)? };
    parse_ball(args, motion)
}

fn parse_ball(args: &mut Arguments, motion: Motion) -> Result<Command, ParseError> {
    let grab = Grab {
        centre_vx: args.required("at", parse_vec3)?,
        radius: args.required("radius", number)?,
        motion,
        falloff: args.optional("falloff", parse_falloff)?.unwrap_or_default(),
    };
    Ok(Command::Grab { grab, surface: parse_surface(args)? })
}

/// Reads how an effect falls off.
pub fn parse_falloff(text: &str) -> Result<Falloff, String> {
    let found = Falloff::ALL.into_iter().find(|falloff| falloff.name() == text);
    found.ok_or_else(|| "use smooth, sharp or flat".to_string())
}
