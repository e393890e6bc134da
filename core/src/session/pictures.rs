//! The images that a session has loaded for textures, as the bytes of their files.
//!
//! Loads them when a command needs them, and keeps the bytes for the journal, which holds images by content. The
//! document owns the textures. Writes no file.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::error::SessionError;
use crate::command::Command;
use crate::document::Document;
use crate::format::{self, FormatError};

/// The bytes of images that are loaded, or were loaded for the last stroke.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    files: HashMap<PathBuf, Arc<[u8]>>,
}

impl Pictures {
    /// Returns the paths of the images that a command needs, loaded or not.
    pub fn needed(command: &Command, document: &Document) -> Vec<PathBuf> {
        match command {
            Command::Array { .. } => document.pictures_to_repeat().map(Path::to_path_buf).collect(),
            command => command.picture().map(Path::to_path_buf).into_iter().collect(),
        }
    }

    /// Reads an image for the document, or takes it from `embedded` if a command has given its content. Returns the
    /// bytes of its file.
    pub fn read(
        path: &Path,
        embedded: Option<&Arc<[u8]>>,
        document: &mut Document,
    ) -> Result<Vec<u8>, SessionError> {
        let failed = |error| SessionError::Picture { path: path.to_path_buf(), error };
        let (texture, file) = match embedded {
            Some(file) => (format::picture_of(file).map_err(failed)?, file.to_vec()),
            None => format::load_picture_file(path).map_err(failed)?,
        };
        document.learn_picture(path, texture);
        Ok(file)
    }

    /// Keeps the bytes of an image's file and returns them; `None` if they have not changed.
    pub fn keep(&mut self, path: &Path, file: Vec<u8>) -> Option<Arc<[u8]>> {
        let same = self.files.get(path).is_some_and(|known| known[..] == file[..]);
        let file: Arc<[u8]> = file.into();
        self.files.insert(path.to_path_buf(), file.clone());
        (!same).then_some(file)
    }

    /// Gives an image to the document from the bytes of its file, and keeps them.
    pub fn restore(
        &mut self,
        path: PathBuf,
        file: Arc<[u8]>,
        document: &mut Document,
    ) -> Result<(), FormatError> {
        document.learn_picture(&path, format::picture_of(&file)?);
        self.files.insert(path, file);
        Ok(())
    }

    /// Returns the latest bytes of an image's file.
    pub fn file(&self, path: &Path) -> Option<Arc<[u8]>> {
        self.files.get(path).cloned()
    }

    /// Makes every stroke read images again: a file may have changed.
    pub(crate) fn forget_at_stroke(&mut self, command: &Command, document: &mut Document) {
        if matches!(command, Command::Begin { .. }) && !document.stroke_open() {
            self.forget_unloaded(document);
            document.forget_pictures();
        }
    }

    /// Forgets the images that the document has not loaded.
    fn forget_unloaded(&mut self, document: &Document) {
        self.files.retain(|path, _| document.has_picture(path));
    }

    /// Returns the loaded images. A checkpoint holds all of these and no others: entries after it know no earlier
    /// images.
    pub fn loaded(&mut self, document: &Document) -> Vec<(PathBuf, Arc<[u8]>)> {
        self.forget_unloaded(document);
        self.files.iter().map(|(path, file)| (path.clone(), file.clone())).collect()
    }
}
