//! The errors of the program, and the exit code of each.

use thiserror::Error;

use crate::app::AppError;
use crate::bench::BenchError;
use crate::config::ConfigError;
use crate::film::FilmError;
use crate::head_tracking::SourceError;
use crate::headless::JobError;
use crate::picture::{LINEAR_ENDING, PictureError};
use crate::print_check::CheckError;
use crate::remedy::told;
use crate::session::SessionError;
use crate::terminal::OutputError;
use crate::track::TrackError;
use crate::view::MAX_SAMPLES;

/// The reason why arguments cannot be used together.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum ArgumentError {
    #[error(
        "--samples {0}: a picture is the mean of 1 to {MAX_SAMPLES} samples; only `render --quality final` takes more"
    )]
    Samples(u32),
    #[error("--{0} applies to final pictures only; add `--quality final`")]
    FinalOnly(&'static str),
    #[error("say what to do with it: `--out FILE` writes it, `--discard` removes it")]
    NothingToDo,
    #[error("--{0} does not apply to final pictures; leave it out, or `--quality final`")]
    NotFinal(&'static str),
    #[error(
        "only final pictures are written as .{LINEAR_ENDING}; add `--quality final`, or use .png"
    )]
    LinearFile,
}

/// The error that ends the program.
#[derive(Debug, Error)]
pub enum ProgramError {
    #[error(transparent)]
    Arguments(#[from] ArgumentError),
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error("{}", told(.0))]
    Session(#[from] SessionError),
    #[error(transparent)]
    Job(#[from] JobError),
    #[error(transparent)]
    App(#[from] AppError),
    #[error(transparent)]
    Track(#[from] TrackError),
    #[error(transparent)]
    Bench(#[from] BenchError),
    #[error(transparent)]
    Film(#[from] FilmError),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error("cannot start a journal: {0}; `--no-journal` works without one")]
    Journal(std::io::Error),
    #[error("there is no command '{0}'; `virtual-sculpture --help` lists them")]
    NoJob(String),
    #[error(
        "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); `render`, `film`, `run`, `recover`, `convert`, `info`, `check`, `demo` and `bench` need none, and `virtual-sculpture --help` lists them"
    )]
    NoDisplay,
}

impl ProgramError {
    /// Returns the exit code that the header of [`crate::cli`] documents.
    pub fn exit_code(&self) -> u8 {
        match self {
            ProgramError::Job(error) | ProgramError::Film(FilmError::Job(error)) => job_code(error),
            ProgramError::Config(_)
            | ProgramError::Session(SessionError::Open { .. })
            | ProgramError::Bench(BenchError::Subject { .. })
            | ProgramError::Track(TrackError::Source(
                SourceError::ReadScript(..) | SourceError::Script(..),
            )) => 3,
            ProgramError::Arguments(_)
            | ProgramError::NoJob(_)
            | ProgramError::Track(TrackError::NoSource)
            | ProgramError::Film(
                FilmError::Form(_)
                | FilmError::Range { .. }
                | FilmError::Layers
                | FilmError::NoScript(_)
                | FilmError::OverInput(_),
            ) => 2,
            ProgramError::App(AppError::EventLoop(_) | AppError::Window(_) | AppError::Gpu(_))
            | ProgramError::NoDisplay => 4,
            ProgramError::Session(_)
            | ProgramError::Film(
                FilmError::Folder { .. } | FilmError::Write { .. } | FilmError::Cancelled,
            )
            | ProgramError::Track(_)
            | ProgramError::Bench(_)
            | ProgramError::Output(_)
            | ProgramError::Journal(_)
            | ProgramError::App(_) => 1,
        }
    }

    /// Returns whether the only failure is that the reader of standard output has closed it.
    pub fn is_reader_gone(&self) -> bool {
        let error = match self {
            ProgramError::Output(error)
            | ProgramError::Job(JobError::Output(error))
            | ProgramError::Bench(BenchError::Output(error))
            | ProgramError::Track(TrackError::Output(error)) => error,
            _ => return false,
        };
        matches!(error, OutputError::ReaderGone)
    }
}

fn job_code(error: &JobError) -> u8 {
    match error {
        JobError::Session(SessionError::Open { .. })
        | JobError::Info { .. }
        | JobError::ReadScript { .. }
        | JobError::Script { .. }
        | JobError::Command { .. }
        | JobError::Refused(_)
        | JobError::Unrecoverable { .. } => 3,
        JobError::NotPrintable => 5,
        JobError::Check(CheckError::Invalid(_) | CheckError::Wall { .. })
        | JobError::NoMarker(_)
        | JobError::NoJournal(_)
        | JobError::OutExists(_)
        | JobError::Picture(PictureError::SmoothOnDevice) => 2,
        JobError::Picture(PictureError::Gpu(_) | PictureError::TraceDevice(_)) => 4,
        JobError::Session(_)
        | JobError::Input(_)
        | JobError::Unheard(_)
        | JobError::Journal { .. }
        | JobError::JournalInUse(_)
        | JobError::ReplayDiffers { .. }
        | JobError::Folder { .. }
        | JobError::Check(_)
        | JobError::WriteMarker { .. }
        | JobError::Picture(_)
        | JobError::Output(_) => 1,
    }
}
