//! The text form of the command that pulls at clay.

use std::fmt;

use super::arguments::Arguments;
use super::spray::parse_surface;
use super::{ParseError, list, number, parse_vec3};
use crate::command::{Command, SpraySurface};
use crate::tools::grab::{Falloff, Grab};

/// Writes what follows the verb.
pub fn write(grab: &Grab, surface: SpraySurface, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let Grab { centre_vx, radius, by_vx, falloff } = grab;
    let [at, by] = [centre_vx, by_vx].map(|v| list(v.to_array()));
    write!(f, " at={at} radius={radius} by={by} falloff={}", falloff.name())?;
    match surface {
        SpraySurface::Now => Ok(()),
        SpraySurface::Stroke => write!(f, " surface=stroke"),
    }
}

/// Reads what follows the verb.
pub fn parse(args: &mut Arguments) -> Result<Command, ParseError> {
    let grab = Grab {
        centre_vx: args.required("at", parse_vec3)?,
        radius: args.required("radius", number)?,
        by_vx: args.required("by", parse_vec3)?,
        falloff: args.optional("falloff", parse_falloff)?.unwrap_or_default(),
    };
    Ok(Command::Grab { grab, surface: parse_surface(args)? })
}

/// Reads how an effect falls off.
pub fn parse_falloff(text: &str) -> Result<Falloff, String> {
    let found = Falloff::ALL.into_iter().find(|falloff| falloff.name() == text);
    found.ok_or_else(|| "use smooth, sharp or flat".to_string())
}
