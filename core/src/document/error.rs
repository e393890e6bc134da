//! Errors of commands. The messages are for users, but name no setting or flag: only the program knows these.

use std::path::PathBuf;

use glam::IVec3;
use thiserror::Error;

use super::strokes::MAX_REPEATED;
use crate::refusal::{InvalidValue, OverBudget};
use crate::resample::ResampleError;
use crate::sculpture::GridError;
use crate::sculpture::orient::OrientError;
use crate::sculpture::reframe::CanvasError;
use crate::sculpture::selection::MAX_BOXES;
use crate::tools::repair::RepairError;

/// Why a command was refused. The sculpture is as it was before.
#[derive(Debug, Error)]
pub enum CommandError {
    /// The new grid is impossible.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The command concerns colours, but the sculpture stores none.
    #[error("this sculpture has no colours; create or open one with 8, 16 or 24 bits of colour")]
    NoColour,
    /// The work needs more memory than [`crate::sculpture::Limits`] allow.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The step cannot be undone, and that was not allowed.
    #[error(
        "the history cannot keep `{step}`: it takes {needed_mib} MiB of the {budget_mib} MiB \
         allowed for undo steps; `irreversible on` does it without undo"
    )]
    Irreversible {
        /// Label of the step.
        step: String,
        /// MiB needed.
        needed_mib: usize,
        /// MiB allowed.
        budget_mib: usize,
    },
    /// The values of an undo or redo step cannot be read back from the disk.
    #[error(
        "`{step}` cannot be read back from the history on disk: {reason}; the sculpture is as it was"
    )]
    NotReadBack {
        /// Label of the step.
        step: String,
        /// The reason, as a part of a sentence.
        reason: String,
    },
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// The command (its verb) is not possible within a stroke.
    #[error("a stroke is open; end or cancel it before `{0}`")]
    StrokeOpen(&'static str),
    /// The command (its verb) needs an open stroke.
    #[error("`{0}` without an open stroke; `begin` one first")]
    NoStroke(&'static str),
    /// The command (its verb) concerns files: a session executes it.
    #[error("`{0}` works on files and cannot be applied to a document")]
    NotHere(&'static str),
    /// A value of the command breaks a rule.
    #[error(transparent)]
    Invalid(#[from] InvalidValue),
    /// No voxel of the surface is there to flood from.
    #[error("there is no voxel of the surface at {0}; name one that can be seen")]
    NotOnSurface(IVec3),
    /// The image to paint with is not known to the document.
    #[error("the image {0} has not been loaded")]
    NoPicture(PathBuf),
    /// The selection has the largest possible number of boxes.
    #[error("the selection already holds {MAX_BOXES} boxes; remove some first")]
    StackFull,
    /// The command needs a selection.
    #[error("nothing is selected; add the marker's box to the selection first")]
    NothingSelected,
    /// The marker's box has no voxels to work on.
    #[error("the marker contains no voxels{0}; move or resize it first")]
    NothingMarked(&'static str),
    /// The box cannot be cropped to nothing.
    #[error("the sculpture has no voxels to crop the canvas to; add some first")]
    NothingToCrop,
    /// The clipboard is empty.
    #[error("there is nothing to paste; copy or cut something first")]
    NothingToPaste,
    /// No operation has been done yet.
    #[error("there is no operation to repeat; use a solid, a brush or paste first")]
    NothingToRepeat,
    /// The last operation used a tool more often than an array may repeat.
    #[error(
        "the last stroke is too long to repeat: it has more than {MAX_REPEATED} uses of a tool"
    )]
    TooLongToRepeat,
}

impl From<RepairError> for CommandError {
    fn from(error: RepairError) -> CommandError {
        match error {
            RepairError::Cancelled => CommandError::Cancelled,
            RepairError::Invalid(error) => CommandError::Invalid(error),
            RepairError::OverBudget(over) => CommandError::OverBudget(over),
        }
    }
}

impl From<CanvasError> for CommandError {
    fn from(error: CanvasError) -> CommandError {
        match error {
            CanvasError::Grid(error) => CommandError::Grid(error),
            CanvasError::OverBudget(over) => CommandError::OverBudget(over),
            CanvasError::Invalid(error) => CommandError::Invalid(error),
        }
    }
}

impl From<ResampleError> for CommandError {
    fn from(error: ResampleError) -> CommandError {
        match error {
            ResampleError::Grid(error) => CommandError::Grid(error),
            ResampleError::OverBudget(over) => CommandError::OverBudget(over),
            ResampleError::Invalid(error) => CommandError::Invalid(error),
            ResampleError::Cancelled => CommandError::Cancelled,
        }
    }
}

impl From<OrientError> for CommandError {
    fn from(error: OrientError) -> CommandError {
        match error {
            OrientError::Grid(error) => CommandError::Grid(error),
            OrientError::OverBudget(over) => CommandError::OverBudget(over),
            OrientError::Cancelled => CommandError::Cancelled,
        }
    }
}
