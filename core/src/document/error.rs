//! Owns why a command is refused, in words for the person.

use std::path::PathBuf;

use thiserror::Error;

use super::tools::{MAX_ARRAY, MAX_REPEATED};
use crate::sculpture::GridError;
use crate::sculpture::selection::MAX_BOXES;

/// Why a command was refused. The sculpture is as it was before.
#[derive(Debug, Error)]
pub enum CommandError {
    #[error(transparent)]
    Grid(#[from] GridError),
    #[error("this sculpture has no colours; create or open one with 8, 16 or 24 bits of colour")]
    NoColour,
    #[error(
        "painting here may need {needed_mib} MiB for colours, more than the {budget_mib} MiB \
         allowed; raise memory.colour_mib in the settings"
    )]
    ColourMemory { needed_mib: u64, budget_mib: u64 },
    #[error(
        "the history cannot keep `{step}`: it takes {needed_mib} MiB of the {budget_mib} MiB \
         allowed; raise memory.history_mib in the configuration, or say `irreversible on` to do it \
         without a way back"
    )]
    Irreversible { step: String, needed_mib: usize, budget_mib: usize },
    #[error("a stroke is open; end or cancel it before `{0}`")]
    StrokeOpen(&'static str),
    #[error("`{0}` without an open stroke; `begin` one first")]
    NoStroke(&'static str),
    #[error("`{0}` works on files and cannot be applied to a document")]
    NotHere(&'static str),
    #[error("the {0} of the placement is not valid: it must be finite, and the scale above zero")]
    Placement(&'static str),
    #[error("the brush is not valid: {0} is out of range")]
    Spray(&'static str),
    #[error("{0} of the solid must be finite and its half extent above zero")]
    Primitive(&'static str),
    #[error("the image {0} has not been loaded")]
    NoPicture(PathBuf),
    #[error("{0}")]
    Marker(&'static str),
    #[error("the selection already holds {MAX_BOXES} boxes; remove some first")]
    StackFull,
    #[error("nothing is selected; add the marker's box to the selection first")]
    NothingSelected,
    #[error("the marker contains no voxels{0}; move or resize it first")]
    NothingMarked(&'static str),
    #[error("there is nothing to paste; copy or cut something first")]
    NothingToPaste,
    #[error("there is no operation to repeat; use a solid, a brush or paste first")]
    NothingToRepeat,
    #[error(
        "the last stroke is too long to repeat: it has more than {MAX_REPEATED} uses of a tool"
    )]
    TooLongToRepeat,
    #[error(
        "an array must have 1 to {MAX_ARRAY} copies and at most {MAX_REPEATED} uses of a tool in all"
    )]
    Array,
}
