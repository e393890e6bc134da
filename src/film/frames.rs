//! The frames of a film being written: their properties, the source of their pictures, and the end of their file.
//!
//! Values and errors shared by all kinds of files; knows no kind.

use std::io::{BufWriter, Error};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::UVec2;
use image::RgbImage;

use super::FilmError;
use crate::format::store::AtomicFile;

/// Number of bytes written at once.
pub(super) const BUFFER_BYTES: usize = 1 << 20;

/// The properties of a film.
#[derive(Clone, PartialEq, Debug)]
pub struct Format {
    pub size: UVec2,
    pub fps: u16,
    /// The number of frames of the whole film.
    pub frames: u32,
    /// The frames to write, counted from 0.
    pub part: Range<u32>,
}

/// Gives the picture of a frame, counted from 0.
pub type NextPicture<'a> = dyn FnMut(u32) -> Result<Arc<RgbImage>, FilmError> + 'a;

impl Format {
    /// Returns the file of a frame, counted from 1, with enough digits for the whole film, at least four.
    pub fn frame_path(&self, folder: &Path, frame: u32) -> PathBuf {
        let digits = self.frames.to_string().len().max(4);
        folder.join(format!("frame-{:0digits$}.png", frame + 1))
    }
}

pub(super) fn finish(buffer: BufWriter<AtomicFile>, path: &Path) -> Result<(), FilmError> {
    let file = buffer.into_inner().map_err(|error| error.into_error());
    file.and_then(AtomicFile::finish).map_err(|error| cannot_write(path, error))
}

pub(super) fn cannot_write(path: &Path, error: Error) -> FilmError {
    FilmError::Write { path: path.to_path_buf(), error }
}
