//! The person's file of key tables: read at the start, written after every change.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::Controls;
use crate::format::store::write_atomically;
use crate::input::Personal;
use crate::input::remap::KeyChange;
use crate::notice::Notice;

/// The file of a person's key tables.
pub(super) struct KeyFile {
    path: PathBuf,
    /// It could not be parsed, and must not be overwritten.
    unusable: bool,
}

impl Controls {
    /// Loads the tables of a file, if it exists, and writes every change to it from now on. Reports an unusable file,
    /// and uses the presets as shipped.
    pub fn keep_keys_in(&mut self, path: PathBuf) -> Option<Notice> {
        let read = std::fs::read_to_string(&path);
        let parsed = match read {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error.to_string()),
            Ok(text) => {
                Personal::parse(&text, &self.pristine).map(Some).map_err(|error| error.to_string())
            }
        };
        let unusable = parsed.is_err();
        let mut notice = None;
        match parsed {
            Ok(None) => {}
            Ok(Some(Personal { tables, in_use })) => {
                self.presets = tables;
                self.preset = in_use;
            }
            Err(error) => {
                let text = format!(
                    "{}: {error}. The controls of the preset are used instead.",
                    path.display()
                );
                tracing::warn!("{text}");
                notice = Some(Notice::Error(text));
            }
        }
        self.key_file = Some(KeyFile { path, unusable });
        notice
    }

    /// Changes the table in use.
    pub fn change_keys(&mut self, change: KeyChange) -> Option<Notice> {
        let tables = self.presets.get_mut(self.preset).zip(self.pristine.get(self.preset));
        let (table, pristine) = tables?;
        match table.change(change, pristine) {
            Ok(()) => self.save_keys(),
            Err(unfit) => Some(Notice::error(unfit.to_string())),
        }
    }

    /// Switches to another table.
    pub fn use_preset(&mut self, preset: usize) -> Option<Notice> {
        self.preset = preset;
        self.save_keys()
    }

    /// Writes the tables, and the index of the one in use.
    fn save_keys(&mut self) -> Option<Notice> {
        let file = self.key_file.as_mut()?;
        let mine = Personal { tables: self.presets.clone(), in_use: self.preset };
        let text = mine.to_toml(&self.pristine);
        match write(file, &text) {
            Ok(None) => None,
            Ok(Some(aside)) => Some(Notice::note(format!(
                "The old controls have been renamed to {}",
                aside.display()
            ))),
            Err(error) => {
                let path = file.path.display();
                Some(Notice::error(format!("The controls cannot be saved to {path}: {error}")))
            }
        }
    }
}

/// Writes the file. Renames an unusable one, and returns its new path.
fn write(file: &mut KeyFile, text: &str) -> std::io::Result<Option<PathBuf>> {
    let KeyFile { path, unusable } = file;
    if let Some(folder) = path.parent().filter(|folder| *folder != Path::new("")) {
        std::fs::create_dir_all(folder)?;
    }
    let aside = unusable.then(|| path.with_extension("old.toml"));
    if let Some(aside) = &aside {
        std::fs::rename(&path, aside)?;
        *unusable = false;
    }
    write_atomically(path, text.as_bytes())?;
    Ok(aside)
}
