//! The text form of brushes that move the surface.

use std::fmt;

use super::arguments::Arguments;
use super::grab::{parse_falloff, parse_pinch, parse_twist};
use super::spray::parse_surface;
use super::{ParseError, list, number, parse_vec3};
use crate::command::{Command, SpraySurface};
use crate::tools::brush::deform::{Brush, Deform, Draw, Plane};

/// Writes what follows the verb.
pub fn write(deform: &Deform, surface: SpraySurface, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let Deform { brush, centre_vx, radius, falloff } = deform;
    let at = list(centre_vx.to_array());
    write!(f, " {} at={at} radius={radius}", brush.kind().name())?;
    match brush {
        Brush::Inflate { height } => write!(f, " height={height}")?,
        Brush::Flatten(Plane { normal, strength })
        | Brush::Scrape(Plane { normal, strength })
        | Brush::Fill(Plane { normal, strength }) => {
            write!(f, " normal={} strength={strength}", list(normal.to_array()))?;
        }
        Brush::Draw(Draw { normal, height }) | Brush::Crease(Draw { normal, height }) => {
            write!(f, " normal={} height={height}", list(normal.to_array()))?;
        }
    }
    write!(f, " falloff={}", falloff.name())?;
    match surface {
        SpraySurface::Now => Ok(()),
        SpraySurface::Stroke => write!(f, " surface=stroke"),
    }
}

/// Reads what follows the verb.
pub fn parse(args: &mut Arguments) -> Result<Command, ParseError> {
    let name = args.word("a brush, such as inflate")?;
    let plane = |args: &mut Arguments| -> Result<Plane, ParseError> {
        Ok(Plane {
            normal: args.required("normal", parse_vec3)?,
            strength: args.optional("strength", number)?.unwrap_or(1.0),
        })
    };
    let draw = |args: &mut Arguments| -> Result<Draw, ParseError> {
        Ok(Draw {
            normal: args.required("normal", parse_vec3)?,
            height: args.required("height", number)?,
        })
    };
    let brush = match name.as_str() {
        "flatten" => Brush::Flatten(plane(args)?),
        "scrape" => Brush::Scrape(plane(args)?),
        "fill" => Brush::Fill(plane(args)?),
        "twist" => return parse_twist(args),
        "pinch" => return parse_pinch(args),
        "draw" => Brush::Draw(draw(args)?),
        "crease" => Brush::Crease(draw(args)?),
        "inflate" => Brush::Inflate { height: args.required("height", number)? },
        _ => {
            return Err(ParseError(format!(
                "`{name}` is not a brush that deforms; use inflate, flatten, scrape, fill, draw, crease, pinch or twist"
            )));
        }
    };
    let deform = Deform {
        brush,
        centre_vx: args.required("at", parse_vec3)?,
        radius: args.required("radius", number)?,
        falloff: args.optional("falloff", parse_falloff)?.unwrap_or_default(),
    };
    Ok(Command::Deform { deform, surface: parse_surface(args)? })
}
