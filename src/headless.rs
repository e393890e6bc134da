//! Owns the jobs that need no screen: render, run, convert, info, demo, and the list of commands.
//!
//! Results go to stdout as one fact a line; progress and errors to stderr.

use std::path::{Path, PathBuf};

use glam::{Quat, UVec2, Vec3};
use thiserror::Error;

use crate::cli::PictureArgs;
use crate::command::{COMMANDS, Command};
use crate::command_text::{ScriptError, parse_script};
use crate::config::{Config, ConfigError, RenderMode};
use crate::document::Document;
use crate::format::{self, FormatError, ImportOptions, Progress};
use crate::session::{Session, SessionError};
use crate::view::Camera;

/// The script of the demo scene.
pub const DEMO_SCRIPT: &str = include_str!("../config/demo.sculpt");

/// Why a job failed.
#[derive(Debug, Error)]
pub enum JobError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error("cannot read {path}: {error}")]
    Info { path: PathBuf, error: FormatError },
    #[error("cannot read the script {path}: {error}")]
    ReadScript { path: PathBuf, error: std::io::Error },
    #[error("script {path}, {error}")]
    Script { path: PathBuf, error: ScriptError },
    #[error("script {path}, line {line} (`{command}`): {error}")]
    Command { path: PathBuf, line: usize, command: String, error: SessionError },
    #[error("cannot make the folder {path}: {error}")]
    Folder { path: PathBuf, error: std::io::Error },
    #[error("cannot write the picture {path}: {error}")]
    Picture { path: PathBuf, error: image::ImageError },
}
