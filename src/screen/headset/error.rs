//! Errors of headsets, with messages that name the missing parts, and whether another attempt makes sense.

use openxr as xr;
use thiserror::Error;

use crate::gpu::GpuError;
use crate::install_hint;

pub type Result<T> = std::result::Result<T, HeadsetError>;

#[derive(Debug, Error)]
pub enum HeadsetError {
    #[error("no OpenXR loader ({0}); {hint}", hint = install_hint::OPENXR_LOADER)]
    NoLoader(String),
    #[error(
        "no OpenXR runtime is running ({0}); start SteamVR, Monado or the headset's own software"
    )]
    NoRuntime(String),
    #[error("the OpenXR runtime finds no headset ({0}); connect it and switch it on")]
    NoHeadset(String),
    #[error("the OpenXR runtime {runtime} {problem}")]
    Unsuitable { runtime: String, problem: String },
    /// The runtime was closed, or asked the program to end its session.
    #[error("the connection to the headset was lost ({0})")]
    Lost(&'static str),
    #[error("OpenXR could not {doing}: {result}")]
    Xr { doing: &'static str, result: xr::sys::Result },
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error("cannot start a thread for the headset: {0}")]
    Thread(std::io::Error),
}

/// Adds the step of an OpenXR call to its error: `.doing("make a swapchain")`.
pub(super) trait Doing<T> {
    fn doing(self, doing: &'static str) -> Result<T>;
}

impl<T> Doing<T> for xr::Result<T> {
    fn doing(self, doing: &'static str) -> Result<T> {
        use xr::sys::Result as R;
        self.map_err(|result| match result {
            R::ERROR_INSTANCE_LOST | R::ERROR_SESSION_LOST | R::ERROR_RUNTIME_UNAVAILABLE => {
                HeadsetError::Lost(doing)
            }
            result => HeadsetError::Xr { doing, result },
        })
    }
}
