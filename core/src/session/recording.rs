//! The recording of a session: a script that grows by a line with every command, so that a crash loses nothing and
//! `run` reproduces the session anywhere. Opened files and images are embedded. A command that the script cannot
//! repeat, such as an undo of steps from before its beginning, becomes a checkpoint: the present sculpture embedded,
//! with clipboard and settings.
//!
//! Non-empty files are never opened for writing, and a replay writes none. Knows no document.

use std::collections::HashMap;
use std::fs::{File, OpenOptions, metadata};
use std::io::{Error, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use glam::IVec3;

use super::SessionError;
use crate::command::{Command, SelectOp};
use crate::document::{Applied, DocumentSnapshot};
use crate::format::options::ImportOptions;
use crate::format::{self, Texts};
use crate::sculpture::history::Contents;
use crate::sculpture::region::VoxelBox;

const TITLE: &str = "# Recorded by Virtual Sculpture";

/// A recording in progress.
#[derive(Debug)]
pub(super) struct ScriptRecording {
    path: PathBuf,
    file: File,
    /// Size in bytes of the complete lines.
    length: u64,
    /// The latest version of the images in it.
    pictures: HashMap<PathBuf, Vec<u8>>,
    /// The number of steps of the undo and of the redo list that a replay lacks: those furthest away.
    missing: [usize; 2],
    /// Whether a replay lacks the uses that an array would repeat.
    lacks_uses: bool,
    /// Within a stroke: whether a tool was used in it.
    stroke: Option<bool>,
    /// Whether the script lacks a change, so that only a checkpoint may follow.
    is_behind: bool,
}

impl ScriptRecording {
    /// Starts a recording with the command that reproduces the session's start. `contents` and `texts`: of the session,
    /// if it began with a file.
    pub fn begin(
        path: &Path,
        beginning: &Command,
        contents: &Contents,
        texts: &Texts,
    ) -> Result<ScriptRecording, SessionError> {
        let failed = |error| SessionError::Journal { path: path.to_path_buf(), error };
        let mut options = OpenOptions::new();
        options.write(true);
        match metadata(path) {
            Ok(there) if there.is_file() && there.len() > 0 => {
                let holds = match is_recording(path) {
                    true => "holds a recording already",
                    false => "is there already and is no recording",
                };
                return Err(SessionError::JournalTaken { path: path.to_path_buf(), holds });
            }
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => drop(options.create_new(true)),
            Err(error) => return Err(failed(error)),
        }
        let file = options.open(path).map_err(failed)?;
        let mut recording = ScriptRecording {
            path: path.to_path_buf(),
            file,
            length: 0,
            pictures: HashMap::new(),
            missing: [0; 2],
            lacks_uses: false,
            stroke: None,
            is_behind: false,
        };
        let head = format!("{TITLE}; replay with `virtual-sculpture run`\n");
        recording.write_line(head).map_err(failed)?;
        match beginning {
            Command::Open { path, .. } => recording.write_opened(path, contents, texts)?,
            beginning => recording.write(beginning, Applied::default())?,
        }
        Ok(recording)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds an executed command with its effect.
    pub fn write(&mut self, command: &Command, applied: Applied) -> Result<(), SessionError> {
        let Some(line) = line_of(command, applied) else { return Ok(()) };
        self.write_line(line)
            .map_err(|error| SessionError::Journal { path: self.path.clone(), error })
    }

    /// Returns whether only a checkpoint can follow the executed command. `left`: the steps in the undo and the redo
    /// list afterwards.
    pub(crate) fn needs_checkpoint(&mut self, command: &Command, left: [usize; 2]) -> bool {
        use Command::{Array, Begin, Cancel, End, Redo, Undo};
        self.is_behind |= match command {
            Undo { .. } | Redo { .. } => std::iter::zip(left, self.missing).any(|(l, m)| l < m),
            Array { .. } => self.lacks_uses,
            _ => false,
        };
        match command {
            Begin { .. } => self.stroke = Some(false),
            End if self.stroke.take() == Some(true) => self.lacks_uses = false,
            Cancel => self.stroke = None,
            used if used.is_tool_use() => match &mut self.stroke {
                Some(used) => *used = true,
                None => self.lacks_uses = false,
            },
            _ => {}
        }
        if left[1] == 0 {
            self.missing[1] = 0;
        }
        self.is_behind
    }

    /// Notes a change that the script does not repeat.
    pub(crate) fn fall_behind(&mut self) {
        self.is_behind = true;
    }

    /// Adds the present state of the session without its history, which later lines cannot use. `name`: of the
    /// sculpture's file.
    pub(crate) fn write_checkpoint(
        &mut self,
        name: &Path,
        now: &DocumentSnapshot,
        texts: &Texts,
    ) -> Result<(), SessionError> {
        if self.stroke.take().is_some() {
            self.write(&Command::Cancel, Applied::default())?;
        }
        // A limit or a small history must not prevent the replay.
        for freed in
            [Command::Select(SelectOp::Clear), Command::Limit(false), Command::Irreversible(true)]
        {
            self.write(&freed, Applied::default())?;
        }
        if let Some(clip) = &now.clip {
            self.write_opened(Path::new("clipboard.vsc"), clip.contents(), &Texts::default())?;
            let all = VoxelBox { min: IVec3::ZERO, max: clip.size().as_ivec3() };
            self.write(&Command::Mark(all), Applied::default())?;
            self.write(&Command::Copy, Applied::default())?;
        }
        self.write_opened(name, &now.contents, texts)?;
        for setting in &now.settings {
            self.write(setting, Applied::default())?;
        }
        self.missing = [now.history.undo.len(), now.history.redo.len()];
        self.lacks_uses = !now.last_uses.is_empty();
        self.is_behind = false;
        Ok(())
    }

    /// Adds the opening of a file, by its content.
    pub(crate) fn write_opened(
        &mut self,
        path: &Path,
        contents: &Contents,
        texts: &Texts,
    ) -> Result<(), SessionError> {
        let failed = |error| SessionError::Open { path: path.to_path_buf(), error };
        let file = format::write_sculpture(contents, texts).map_err(failed)?.into();
        let path = absolute(path);
        self.write(&Command::Embed { path: path.clone(), file }, Applied::default())?;
        let import = ImportOptions::default();
        self.write(&Command::Open { path, import }, Applied::default())
    }

    /// Adds an image that the next commands use, unless the recording holds the same one.
    pub(crate) fn write_picture(&mut self, path: &Path, file: &[u8]) -> Result<(), SessionError> {
        let path = absolute(path);
        if self.pictures.get(&path).is_some_and(|known| known == file) {
            return Ok(());
        }
        self.write(&Command::Embed { path: path.clone(), file: file.into() }, Applied::default())?;
        self.pictures.insert(path, file.to_vec());
        Ok(())
    }

    /// Writes a line at once. If there is no room for all of it, removes the written part.
    fn write_line(&mut self, line: String) -> Result<(), Error> {
        let written = self.file.write_all(line.as_bytes());
        match written {
            Ok(()) => self.length += line.len() as u64,
            // Devices and pipes cannot be truncated; the first error is the one that matters.
            Err(_) => drop(self.file.set_len(self.length)),
        }
        written
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
}

/// Returns the line that repeats a command; `None` if it had no effect.
fn line_of(command: &Command, applied: Applied) -> Option<String> {
    Some(match command {
        // A replay writes no file unless someone removes the comment sign.
        Command::Save { path, export } => {
            let save = Command::Save { path: absolute(path), export: *export };
            format!("# {save}\n")
        }
        Command::Open { path, import } => {
            format!("{}\n", Command::Open { path: absolute(path), import: *import })
        }
        command if command.picture().is_some() => {
            let absolute = command.picture().map(absolute).unwrap_or_default();
            format!("{}\n", command.clone().with_picture(absolute))
        }
        // The actual number of steps: a replay has one more before them, the beginning.
        Command::Undo { .. } | Command::Redo { .. } if applied.steps == 0 => return None,
        Command::Undo { .. } => format!("{}\n", Command::Undo { steps: Some(applied.steps) }),
        Command::Redo { .. } => format!("{}\n", Command::Redo { steps: Some(applied.steps) }),
        other => format!("{other}\n"),
    })
}

fn is_recording(path: &Path) -> bool {
    let mut start = Vec::new();
    let read = File::open(path).and_then(|f| f.take(TITLE.len() as u64).read_to_end(&mut start));
    read.is_ok() && start == TITLE.as_bytes()
}

#[cfg(test)]
#[path = "recording_tests.rs"]
mod tests;
