//! The text form of commands that make a sculpture fit for printing.

use std::fmt;

use super::arguments::Arguments;
use super::{ParseError, number};
use crate::command::Command;
use crate::tools::repair::{Keep, Repair, Toward};

/// Default diameter of holes, in voxels.
const HOLE_VX: f32 = 3.0;

/// Writes the arguments after the verb.
pub fn write(repair: &Repair, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let smaller = |f: &mut fmt::Formatter<'_>, smaller_vx: &Option<u32>| match smaller_vx {
        Some(voxels) => write!(f, " smaller={voxels}"),
        None => Ok(()),
    };
    match repair {
        Repair::RemoveIslands { keep, smaller_vx } => {
            write!(f, " keep={}", keep.name())?;
            smaller(f, smaller_vx)
        }
        Repair::FillCavities { smaller_vx } => smaller(f, smaller_vx),
        Repair::Thicken { to_vx } => write!(f, " to={to_vx}"),
        Repair::Drain { diameter_vx, toward } => {
            write!(f, " diameter={diameter_vx} toward={}", toward.name())
        }
    }
}

/// Reads the arguments after one of the verbs.
pub fn parse(verb: &str, args: &mut Arguments) -> Result<Command, ParseError> {
    Ok(Command::Repair(match verb {
        "remove-islands" => Repair::RemoveIslands {
            keep: args
                .optional("keep", |text| {
                    let keep = Keep::ALL.into_iter().find(|keep| keep.name() == text);
                    keep.ok_or_else(|| "must be standing or largest".to_string())
                })?
                .unwrap_or_default(),
            smaller_vx: args.optional("smaller", number)?,
        },
        "fill-cavities" => Repair::FillCavities { smaller_vx: args.optional("smaller", number)? },
        "thicken" => Repair::Thicken { to_vx: args.required("to", number)? },
        _ => Repair::Drain {
            diameter_vx: args.optional("diameter", number)?.unwrap_or(HOLE_VX),
            toward: args
                .optional("toward", |text| {
                    let toward = Toward::ALL.into_iter().find(|toward| toward.name() == text);
                    toward.ok_or_else(|| "must be down or nearest".to_string())
                })?
                .unwrap_or_default(),
        },
    }))
}
