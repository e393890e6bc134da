//! The file with the state that is restored at the next start.
//!
//! It is written when the state has changed: after a file was opened or saved, at intervals while the
//! program is idle, and at the end. Without [`Workspace::remember_in`] nothing is read or written, as in tests.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::workspace::Workspace;
use crate::command::Command;
use crate::folders;
use crate::format::store::write_atomically;
use crate::sculpture::orientation::Up;
use crate::ui::dialogs::files::folder_of;
use crate::ui::{WindowOptions, memory};

/// A longer file is not one of this program.
const LONGEST_BYTES: u64 = 1 << 20;
/// Shortest interval of writes while idle.
const EVERY: Duration = Duration::from_secs(30);

/// The file and its contents.
pub(super) struct MemoryFile {
    path: PathBuf,
    window: WindowOptions,
    written: String,
    at: Instant,
    /// A failure to write it has been reported.
    complained: bool,
}

impl Workspace {
    /// Restores the state in the file, if there is one, and from now on saves the state there.
    pub fn remember_in(&mut self, path: PathBuf, window: &WindowOptions) {
        let read = read(&path);
        match &read {
            Ok(Some(text)) => memory::recall(text, &mut self.ui, &mut self.editor.tool, window),
            Ok(None) => {}
            Err(error) => tracing::warn!("cannot read {}: {error}", path.display()),
        }
        self.read_references();
        self.editor.leave_ground();
        let session = self.editor.session();
        if let Some(path) = session.path() {
            self.ui.known_files.recent.note_open(path, session.assumed_up());
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

    /// Saves the state, if some time has passed since the last time.
    pub fn remember_at_rest(&mut self) {
        if self.memory.as_ref().is_some_and(|memory| memory.at.elapsed() >= EVERY) {
            self.remember();
        }
    }

    /// Saves the state, if it has changed.
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
                // The sculpture is not in danger, so this is no error dialog.
                if !std::mem::replace(&mut file.complained, true) {
                    tracing::warn!("cannot write {}: {error}", file.path.display());
                }
            }
        }
    }
}

/// The axis that was last chosen to point up for files of that format.
pub fn remembered_up(path: &Path) -> Option<Up> {
    let text = read(&folders::state_folder().join("state.toml"));
    text.ok().flatten().and_then(|text| memory::upright(&text).of(path))
}

/// The file's text; none if there is no file.
fn read(path: &Path) -> std::io::Result<Option<String>> {
    use std::io::{Error, ErrorKind};
    let metadata = match std::fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        metadata => metadata?,
    };
    if !metadata.is_file() || metadata.len() > LONGEST_BYTES {
        return Err(Error::new(ErrorKind::InvalidData, "it is not a file of this program"));
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
