//! The text form of spray commands and stencils.

use std::fmt;

use super::arguments::Arguments;
use super::{ParseError, list, number, parse_colour, parse_vec3};
use crate::command::{Command, SpraySurface};
use crate::sculpture::Rgb;
use crate::tools::brush::footprint::{Coverage, Footprint, Outline};
use crate::tools::brush::kernel::level::Level;
use crate::tools::brush::spray::{Effect, Smoothing, Spray};

/// How far a spray reaches if no one says otherwise, in voxels.
const DEFAULT_REACH_VX: f32 = 3.0;

/// Writes what follows the verb.
pub fn write(spray: &Spray, surface: SpraySurface, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let Spray { effect, footprint, reach_vx } = spray;
    write!(f, " {}", effect.name())?;
    write_rays(footprint, f)?;
    write!(f, " outline={} reach={reach_vx}", footprint.outline.name())?;
    if surface == SpraySurface::Stroke {
        write!(f, " surface=stroke")?;
    }
    match effect {
        Effect::Paintbrush { colour, cover } => write!(f, " colour={colour} cover={cover}"),
        Effect::Devourer { outline } => write!(f, " bite={}", outline.name()),
        Effect::Erosion { threshold } => write!(f, " threshold={threshold}"),
        Effect::Dilation { threshold, colour } | Effect::Growth { threshold, colour } => {
            write!(f, " threshold={threshold}")?;
            colour.map_or(Ok(()), |colour| write!(f, " colour={colour}"))
        }
        Effect::Smooth(Smoothing::Majority { radius_vx }) => write!(f, " around={radius_vx}"),
        Effect::Smooth(Smoothing::Level(Level { strength, rounding })) => {
            write!(f, " strength={strength}")?;
            match *rounding == Level::NEAREST {
                true => Ok(()),
                false => write!(f, " rounding={rounding}"),
            }
        }
        Effect::Clay { colour } => write!(f, " colour={colour}"),
        Effect::Mask { .. } => Ok(()),
    }
}

fn write_rays(footprint: &Footprint, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let Footprint { eye_vx, aim, across, down, radius, .. } = footprint;
    for (key, vector) in [("eye", eye_vx), ("aim", aim), ("across", across), ("down", down)] {
        write!(f, " {key}={}", list(vector.to_array()))?;
    }
    write!(f, " radius={radius}")?;
    match footprint.coverage {
        // Recordings from before there was another one say nothing.
        Coverage::Rays => Ok(()),
        coverage => write!(f, " takes={}", coverage.name()),
    }
}

/// Writes what follows the image of a stencil.
pub fn write_stencil(
    footprint: &Footprint,
    colour: Option<Rgb>,
    cover: f32,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    write_rays(footprint, f)?;
    colour.map_or(Ok(()), |colour| write!(f, " colour={colour}"))?;
    write!(f, " cover={cover}")
}

/// Reads what follows the verb of a stencil.
pub fn parse_stencil(args: &mut Arguments) -> Result<Command, ParseError> {
    Ok(Command::Stencil {
        picture: args.path()?,
        footprint: parse_rays(args, Outline::Square)?,
        colour: args.optional("colour", parse_colour)?,
        cover: args.optional("cover", number)?.unwrap_or(1.0),
    })
}

fn parse_rays(args: &mut Arguments, outline: Outline) -> Result<Footprint, ParseError> {
    Ok(Footprint {
        eye_vx: args.required("eye", parse_vec3)?,
        aim: args.required("aim", parse_vec3)?,
        across: args.required("across", parse_vec3)?,
        down: args.required("down", parse_vec3)?,
        radius: args.required("radius", number)?,
        outline,
        coverage: args.optional("takes", parse_coverage)?.unwrap_or_default(),
    })
}

/// Reads what follows the verb.
pub fn parse(args: &mut Arguments) -> Result<Command, ParseError> {
    let name = args.word("a brush, such as devourer")?;
    let effect = match name.as_str() {
        "paintbrush" => Effect::Paintbrush {
            colour: args.required("colour", parse_colour)?,
            cover: args.optional("cover", number)?.unwrap_or(1.0),
        },
        "devourer" => {
            Effect::Devourer { outline: args.optional("bite", parse_outline)?.unwrap_or_default() }
        }
        "erosion" => {
            Effect::Erosion { threshold: args.optional("threshold", number)?.unwrap_or(14) }
        }
        "dilation" => Effect::Dilation {
            threshold: args.optional("threshold", number)?.unwrap_or(9),
            colour: args.optional("colour", parse_colour)?,
        },
        "growth" => Effect::Growth {
            threshold: args.optional("threshold", number)?.unwrap_or(12),
            colour: args.optional("colour", parse_colour)?,
        },
        "smooth" => Effect::Smooth(parse_smoothing(args)?),
        "clay" => Effect::Clay { colour: args.required("colour", parse_colour)? },
        "mask" => Effect::Mask { adds: true },
        "unmask" => Effect::Mask { adds: false },
        _ => {
            return Err(ParseError(format!(
                "`{name}` is not a brush; use paintbrush, devourer, erosion, dilation, \
                 growth, smooth, clay, mask or unmask"
            )));
        }
    };
    let outline = args.optional("outline", parse_outline)?.unwrap_or_default();
    let footprint = parse_rays(args, outline)?;
    let reach_vx = args.optional("reach", number)?.unwrap_or(DEFAULT_REACH_VX);
    let surface = parse_surface(args)?;
    Ok(Command::Spray { spray: Spray { effect, footprint, reach_vx }, surface })
}

/// A strength makes it smooth by the footprint's own radius.
fn parse_smoothing(args: &mut Arguments) -> Result<Smoothing, ParseError> {
    let Some(strength) = args.optional("strength", number)? else {
        let radius_vx = args.optional("around", number)?.unwrap_or(2);
        return Ok(Smoothing::Majority { radius_vx });
    };
    let rounding = args.optional("rounding", number)?.unwrap_or(Level::NEAREST);
    Ok(Smoothing::Level(Level { strength, rounding }))
}

/// Reads which surface is meant: the present one if nothing is said.
pub fn parse_surface(args: &mut Arguments) -> Result<SpraySurface, ParseError> {
    let surface = args.optional("surface", |text| match text {
        "now" => Ok(SpraySurface::Now),
        "stroke" => Ok(SpraySurface::Stroke),
        _ => Err("must be now or stroke".to_string()),
    })?;
    Ok(surface.unwrap_or_default())
}

fn parse_coverage(text: &str) -> Result<Coverage, String> {
    let coverage = Coverage::ALL.into_iter().find(|coverage| coverage.name() == text);
    coverage.ok_or_else(|| "must be rays or visible".to_string())
}

fn parse_outline(text: &str) -> Result<Outline, String> {
    let outline = Outline::ALL.into_iter().find(|outline| outline.name() == text);
    outline.ok_or_else(|| "must be round or square".to_string())
}
