//! The file with the state that is restored at the next start.
//!
//! It is written when the state has changed: after a file was opened or saved, at intervals while the program is idle,
//! and at the end. Nothing is read or written before [`Memory::open`], as in tests.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::editor::tool::ToolState;
use crate::folders;
use crate::format::store::write_atomically;
use crate::sculpture::orientation::Up;
use crate::ui::{UiState, WindowOptions, memory};

/// A longer file is not from this program.
const LONGEST_BYTES: u64 = 1 << 20;
/// Shortest interval of writes while idle.
const EVERY: Duration = Duration::from_secs(30);

/// The file that remembers the state, if there is one.
#[derive(Default)]
pub(super) struct Memory(Option<MemoryFile>);

/// The file and its contents.
struct MemoryFile {
    path: PathBuf,
    window: WindowOptions,
    written: String,
    at: Instant,
    /// A failed write has been reported.
    complained: bool,
}

impl Memory {
    /// Restores the state in the file, if there is one, and saves the state there from now on.
    pub fn open(
        &mut self,
        path: PathBuf,
        window: &WindowOptions,
        ui: &mut UiState,
        tool: &mut ToolState,
    ) {
        let read = read(&path);
        match &read {
            Ok(Some(text)) => memory::recall(text, ui, tool, window),
            Ok(None) => {}
            Err(error) => tracing::warn!("cannot read {}: {error}", path.display()),
        }
        let written = read.ok().flatten().unwrap_or_default();
        let window = window.clone();
        self.0 = Some(MemoryFile { path, window, written, at: Instant::now(), complained: false });
    }

    /// Returns whether some time has passed since the state was last looked at.
    pub fn is_due(&self) -> bool {
        self.0.as_ref().is_some_and(|memory| memory.at.elapsed() >= EVERY)
    }

    /// Saves the state, if it has changed.
    pub fn save(&mut self, ui: &UiState, tool: &ToolState) {
        let Some(file) = &mut self.0 else { return };
        let text = memory::to_text(ui, tool, &file.window);
        file.at = Instant::now();
        if text == file.written {
            return;
        }
        match write(&file.path, &text) {
            Ok(()) => file.written = text,
            Err(error) => {
                // The sculpture is safe, so a message is enough.
                if !std::mem::replace(&mut file.complained, true) {
                    tracing::warn!("cannot write {}: {error}", file.path.display());
                }
            }
        }
    }
}

/// Returns the up axis chosen last for files of that format.
pub fn remembered_up(path: &Path) -> Option<Up> {
    let text = read(&folders::state_folder().join("state.toml"));
    text.ok().flatten().and_then(|text| memory::upright(&text).of(path))
}

/// Returns the file's text; `None` if there is no file.
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
