//! The errors that end the program with windows.

use std::path::PathBuf;

use thiserror::Error;
use winit::error::{EventLoopError, OsError};

use super::system_window;
use crate::gpu::GpuError;
use crate::input::bindings::BindingsError;

/// An error that ends the program.
#[derive(Debug, Error)]
pub enum AppError {
    #[error("cannot open a window: {}", system_window::without_place(.0))]
    EventLoop(#[from] EventLoopError),
    #[error("cannot open a window: {}", system_window::without_place(.0))]
    Window(#[from] OsError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error("a preset of controls cannot be used: {0}")]
    Bindings(#[from] BindingsError),
    #[error("{error}; the sculpture was saved to {path}")]
    Recovered { error: GpuError, path: PathBuf },
    #[error("{error}; the work until then is in the journal {path}: the next start offers it")]
    Kept { error: GpuError, path: PathBuf },
    #[error("the validation layers reported {0} messages")]
    Validation(usize),
}
