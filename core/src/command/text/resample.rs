//! The text form of a change of the resolution.

use std::fmt;

use glam::UVec3;

use super::arguments::Arguments;
use super::{ParseError, list, number, numbers};
use crate::resample::Resolution;

/// Writes the arguments after the verb.
pub fn write(to: &Resolution, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match to {
        Resolution::Factor(factor) => write!(f, " {factor}"),
        Resolution::Dims(dims) => write!(f, " dims={}", list(dims.to_array())),
    }
}

/// Reads the arguments after the verb.
pub fn parse(args: &mut Arguments) -> Result<Resolution, ParseError> {
    let dims = |text: &str| numbers::<u32, 3>(text).map(UVec3::from_array);
    if let Some(dims) = args.optional("dims", dims)? {
        return Ok(Resolution::Dims(dims));
    }
    const WORDS: &str = "half, double, a factor or dims=";
    Ok(Resolution::Factor(match args.word(WORDS)?.as_str() {
        "half" => 0.5,
        "double" => 2.0,
        factor => number(factor)
            .map_err(|_| ParseError(format!("`{factor}` is not valid; use {WORDS}")))?,
    }))
}
