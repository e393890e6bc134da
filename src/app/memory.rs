//! The file in which the program remembers what a person finds again at the next start.
//!
//! It is written when it has changed: when a file was opened or saved, now and then at rest, and at
//! the end. Without [`Workspace::remember_in`] nothing is read or written, as in tests.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::workspace::Workspace;
use crate::command::Command;
use crate::folders;
use crate::format::store::write_atomically;
use crate::sculpture::orientation::Up;
use crate::ui::state::folder_of;
use crate::ui::{WindowOptions, memory};

/// A longer file is none of this program's.
const LONGEST_BYTES: u64 = 1 << 20;
/// At rest it is written no more often than this.
const EVERY: Duration = Duration::from_secs(30);

/// The file and what it holds.
pub(super) struct MemoryFile {
    path: PathBuf,
    window: WindowOptions,
    written: String,
    at: Instant,
    /// That it cannot be written has been said.
    complained: bool,
}

impl Workspace {
    /// Remembers what the file holds, if there is one, and from now on writes what is to be
    /// remembered to it.
    pub fn remember_in(&mut self, path: PathBuf, window: &WindowOptions) {
        let read = read(&path);
        match &read {
            Ok(Some(text)) => memory::recall(text, &mut self.ui, &mut self.editor.tool, window),
            Ok(None) => {}
            Err(error) => tracing::warn!("cannot read {}: {error}", path.display()),
        }
        self.editor.leave_ground();
        let session = self.editor.session();
        if let Some(path) = session.path() {
            self.ui.known_files.recent.note_open(path, session.assumed_up().unwrap_or_default());
        }
        let written = read.ok().flatten().unwrap_or_default();
        let window = window.clone();
        self.memory =
            Some(MemoryFile { path, window, written, at: Instant::now(), complained: false });
    }

    /// A file was opened or saved by a command.
    pub(super) fn note_file(&mut self, command: &Command) {
        if let Command::Open { path, .. } | Command::Save { path, .. } = command {
            self.ui.known_files.recent.note(command);
            if let Some(folder) = folder_of(std::path::absolute(path).ok().as_deref()) {
                self.ui.dialogs.files.set_folder(folder);
            }
            self.remember();
        }
    }

    /// The same, if some time has gone by since.
    pub fn remember_at_rest(&mut self) {
        if self.memory.as_ref().is_some_and(|memory| memory.at.elapsed() >= EVERY) {
            self.remember();
        }
    }

    /// Writes what is to be remembered, if it has changed.
    pub fn remember(&mut self) {
        let Some(file) = &mut self.memory else { return };
        let text = memory::to_text(&self.ui, &self.editor.tool, &file.window);
        file.at = Instant::now();
        if text == file.written {
            return;
        }
        match write(&file.path, &text) {
            Ok(()) => file.written = text,
            Err(error) => {
                // The work is not in danger, so nobody is kept from it.
                if !std::mem::replace(&mut file.complained, true) {
                    tracing::warn!("cannot write {}: {error}", file.path.display());
                }
            }
        }
    }
}

/// The axis that the person has last found to point up in files of that format.
pub fn remembered_up(path: &Path) -> Up {
    let text = read(&folders::state_folder().join("state.toml"));
    let up = text.ok().flatten().and_then(|text| memory::upright(&text).of(path));
    up.unwrap_or_default()
}

/// The file's text; none if there is no file.
fn read(path: &Path) -> std::io::Result<Option<String>> {
    use std::io::{Error, ErrorKind};
    let metadata = match std::fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        metadata => metadata?,
    };
    if !metadata.is_file() || metadata.len() > LONGEST_BYTES {
        return Err(Error::new(ErrorKind::InvalidData, "it is no file of this program"));
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(LONGEST_BYTES).read_to_end(&mut bytes)?;
    Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
}

fn write(path: &Path, text: &str) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    write_atomically(path, text.as_bytes())
}
