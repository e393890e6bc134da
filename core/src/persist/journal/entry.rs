//! The entries of a journal, one for each event of a session, and their encoding.
//!
//! Most entries carry a [`Mark`] of the document afterwards, so that a diverging replay is detected where it diverges.
//! Contents are packed as in .vsc files, commands and file names are stored in the text form of commands.

use std::path::PathBuf;
use std::sync::Arc;

use crate::command::text::{parse_path, path_text};
use crate::command::{Command, CommandClass};
use crate::document::Document;
use crate::format::{FormatError, Texts, read_sculpture, write_sculpture};
use crate::persist::frame::{Record, RecordBuffer};
use crate::persist::payload::{DAMAGED, put_text, take_text, take_u64};
use crate::sculpture::Limits;
use crate::sculpture::history::{Contents, State};
use crate::sculpture::orientation::Up;

const COMMAND: u8 = 16;
const OPENED: u8 = 17;
const SAVED: u8 = 18;
const PICTURE: u8 = 19;
const SAME_PICTURE: u8 = 20;

/// A summary of the document after an entry.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Mark {
    /// Its state.
    pub state: State,
    /// Number of existing voxels.
    pub voxels: u64,
    /// Number of painted bricks.
    pub pages: u64,
    /// Size in voxels.
    pub dims: [u32; 3],
}

impl Mark {
    /// Returns the mark of a document in its present state.
    pub fn of(document: &Document) -> Mark {
        Mark {
            state: document.state(),
            voxels: document.grid().opaque_count(),
            pages: document.material().page_count() as u64,
            dims: document.grid().dims().to_array(),
        }
    }

    const BYTES: usize = 44;

    fn write(&self, out: &mut Vec<u8>) {
        let Mark { state, voxels, pages, dims } = *self;
        for value in [state.sculpture, state.number, voxels, pages] {
            out.extend_from_slice(&value.to_le_bytes());
        }
        dims.iter().for_each(|edge| out.extend_from_slice(&edge.to_le_bytes()));
    }

    fn read(bytes: &[u8; Mark::BYTES]) -> Mark {
        let [sculpture, number, voxels, pages]: [u64; 4] = std::array::from_fn(|i| {
            u64::from_le_bytes(std::array::from_fn(|byte| bytes[8 * i + byte]))
        });
        let dims = std::array::from_fn(|i| {
            u32::from_le_bytes(std::array::from_fn(|byte| bytes[32 + 4 * i + byte]))
        });
        Mark { state: State { sculpture, number }, voxels, pages, dims }
    }
}

/// An event of a session.
#[derive(Clone, Debug)]
pub enum JournalEntry {
    /// A command was executed that needs nothing but the session. Undo and redo state the number of steps.
    Command {
        /// The command.
        command: Command,
        /// The mark of the document afterwards.
        mark: Mark,
    },
    /// A file was opened.
    Opened {
        /// Its path.
        path: PathBuf,
        /// The contents as read.
        contents: Arc<Contents>,
        /// Its texts.
        texts: Texts,
        /// The axis that was assumed to point up, if an assumption was necessary.
        assumed_up: Option<Up>,
        /// The mark of the document afterwards.
        mark: Mark,
    },
    /// The sculpture was saved, possibly while it was being changed further.
    Saved {
        /// The file.
        path: PathBuf,
        /// The state that the file holds.
        state: State,
    },
    /// An image was loaded for the commands that follow.
    Picture {
        /// Its path.
        path: PathBuf,
        /// The bytes of its file; `None` if they are unchanged since the last time.
        file: Option<Arc<[u8]>>,
    },
}

impl JournalEntry {
    /// Returns whether the entry must be on disk soon. This holds for the end of a stroke, but neither inside a stroke
    /// nor for changes of no voxel, such as a dragged marker. `in_stroke` is whether a stroke is open, before and
    /// after.
    pub(super) fn settles(&self, in_stroke: &mut bool) -> bool {
        let JournalEntry::Command { command, .. } = self else { return !*in_stroke };
        match command.class() {
            CommandClass::Stroke => *in_stroke = matches!(command, Command::Begin { .. }),
            CommandClass::Copy => return false,
            CommandClass::Setting if !matches!(command, Command::Irreversible(_)) => return false,
            CommandClass::Setting
            | CommandClass::Replace
            | CommandClass::File
            | CommandClass::Tool
            | CommandClass::Area
            | CommandClass::Mask
            | CommandClass::Arrange
            | CommandClass::Whole
            | CommandClass::Orient
            | CommandClass::Canvas
            | CommandClass::Travel => {}
        }
        !*in_stroke
    }

    /// Encodes the entry as a record.
    pub(super) fn to_record(&self) -> Result<RecordBuffer, FormatError> {
        let (kind, mark) = match self {
            JournalEntry::Command { mark, .. } => (COMMAND, Some(mark)),
            JournalEntry::Opened { mark, .. } => (OPENED, Some(mark)),
            JournalEntry::Saved { .. } => (SAVED, None),
            JournalEntry::Picture { file: Some(_), .. } => (PICTURE, None),
            JournalEntry::Picture { file: None, .. } => (SAME_PICTURE, None),
        };
        let mut record = RecordBuffer::new(kind);
        let out = record.payload();
        if let Some(mark) = mark {
            mark.write(out);
        }
        match self {
            JournalEntry::Command { command, .. } => {
                use std::io::Write;
                // Writing to memory does not fail.
                let _ = write!(out, "{command}");
            }
            JournalEntry::Opened { path, contents, texts, assumed_up, .. } => {
                put_text(&path_text(path), out);
                put_text(&assumed_up.map(|up| up.to_string()).unwrap_or_default(), out);
                out.extend(write_sculpture(contents, texts)?);
            }
            JournalEntry::Saved { path, state } => {
                put_text(&path_text(path), out);
                out.extend_from_slice(&state.sculpture.to_le_bytes());
                out.extend_from_slice(&state.number.to_le_bytes());
            }
            JournalEntry::Picture { path, file } => {
                put_text(&path_text(path), out);
                out.extend_from_slice(file.as_deref().unwrap_or_default());
            }
        }
        Ok(record)
    }

    /// Decodes the entry of a record. Contents are read within `limits`.
    pub(super) fn from_record(
        record: &Record,
        limits: &Limits,
    ) -> Result<JournalEntry, FormatError> {
        let mut rest = &record.payload[..];
        let path = |rest: &mut &[u8]| parse_path(take_text(rest)?).map_err(|_| DAMAGED);
        match record.kind {
            COMMAND => {
                let mark = take_mark(&mut rest)?;
                let text = str::from_utf8(rest).map_err(|_| DAMAGED)?;
                let command = text.parse().map_err(|_| DAMAGED)?;
                Ok(JournalEntry::Command { command, mark })
            }
            OPENED => {
                let mark = take_mark(&mut rest)?;
                let path = path(&mut rest)?;
                let assumed_up = match take_text(&mut rest)? {
                    "" => None,
                    up => Some(up.parse().map_err(|_| DAMAGED)?),
                };
                let (contents, texts) = read_sculpture(rest, limits)?;
                let contents = Arc::new(contents);
                Ok(JournalEntry::Opened { path, contents, texts, assumed_up, mark })
            }
            SAVED => {
                let path = path(&mut rest)?;
                let [sculpture, number] = [take_u64(&mut rest)?, take_u64(&mut rest)?];
                Ok(JournalEntry::Saved { path, state: State { sculpture, number } })
            }
            PICTURE => {
                let path = path(&mut rest)?;
                Ok(JournalEntry::Picture { path, file: Some(rest.into()) })
            }
            SAME_PICTURE => Ok(JournalEntry::Picture { path: path(&mut rest)?, file: None }),
            _ => Err(DAMAGED),
        }
    }
}

fn take_mark(rest: &mut &[u8]) -> Result<Mark, FormatError> {
    let (bytes, after) = rest.split_first_chunk().ok_or(DAMAGED)?;
    *rest = after;
    Ok(Mark::read(bytes))
}
