//! The images that tools paint with, under the names that commands use for them.
//!
//! Takes decoded images: the session reads the files.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::CommandError;
use crate::tools::texture::Texture;

/// The loaded images.
#[derive(Debug, Default)]
pub(super) struct LoadedPictures(HashMap<PathBuf, Arc<Texture>>);

impl LoadedPictures {
    pub fn has(&self, name: &Path) -> bool {
        self.0.contains_key(name)
    }

    pub fn learn(&mut self, name: &Path, picture: Texture) {
        self.0.insert(name.to_path_buf(), Arc::new(picture));
    }

    pub fn forget_all(&mut self) {
        self.0.clear();
    }

    /// Returns an image; an error if it is not loaded.
    pub fn get(&self, name: &Path) -> Result<&Arc<Texture>, CommandError> {
        self.0.get(name).ok_or_else(|| CommandError::NoPicture(name.to_path_buf()))
    }
}
