//! The text form of import options, as `open` takes them. Defaults are left out.

use std::fmt;

use super::arguments::Arguments;
use super::{ParseError, choice, parse_colour_depth};
use crate::format::options::{Colouring, Cubic, Existence, ImportOptions, MeshFill, MeshSize};

/// Writes the arguments after the name of the file.
pub fn write(import: &ImportOptions, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let ImportOptions {
        existence,
        colouring,
        colour_depth,
        upright,
        raw,
        channel,
        time,
        region,
        cubic,
        largest_piece,
        fill_holes,
        mesh_size,
        mesh_fill,
    } = import;
    if *existence != Existence::Auto {
        write!(f, " threshold={existence}")?;
    }
    if *colouring != Colouring::Auto {
        write!(f, " colouring={colouring}")?;
    }
    if let Some(depth) = colour_depth {
        write!(f, " colour={}", depth.bits())?;
    }
    if let Some(up) = upright {
        write!(f, " upright={up}")?;
    }
    if let Some(raw) = raw {
        write!(f, " raw={raw}")?;
    }
    if let Some(channel) = channel {
        write!(f, " channel={channel}")?;
    }
    if let Some(time) = time {
        write!(f, " time={time}")?;
    }
    if let Some(region) = region {
        write!(f, " region={region}")?;
    }
    if *cubic != Cubic::No {
        write!(f, " cubic={cubic}")?;
    }
    if *largest_piece {
        f.write_str(" pieces=largest")?;
    }
    if *fill_holes {
        f.write_str(" holes=filled")?;
    }
    if *mesh_size != MeshSize::default() {
        write!(f, " mesh_size={mesh_size}")?;
    }
    if *mesh_fill != MeshFill::default() {
        write!(f, " mesh_fill={mesh_fill}")?;
    }
    Ok(())
}

/// Reads the arguments after the name of the file.
pub fn parse(args: &mut Arguments) -> Result<ImportOptions, ParseError> {
    Ok(ImportOptions {
        existence: args.optional("threshold", str::parse)?.unwrap_or_default(),
        colouring: args.optional("colouring", str::parse)?.unwrap_or_default(),
        colour_depth: args.optional("colour", parse_colour_depth)?,
        upright: args.optional("upright", str::parse)?,
        raw: args.optional("raw", str::parse)?,
        channel: args.optional("channel", str::parse)?,
        time: args.optional("time", str::parse)?,
        region: args.optional("region", str::parse)?,
        cubic: args.optional("cubic", str::parse)?.unwrap_or_default(),
        largest_piece: choice(args, "pieces", ["all", "largest"])?,
        fill_holes: choice(args, "holes", ["open", "filled"])?,
        mesh_size: args.optional("mesh_size", str::parse)?.unwrap_or_default(),
        mesh_fill: args.optional("mesh_fill", str::parse)?.unwrap_or_default(),
    })
}
