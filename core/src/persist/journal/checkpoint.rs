//! A checkpoint: a session between two strokes, as records that restore it exactly.
//!
//! Records of a checkpoint, in this order: one for the beginning (program, process, time, limits and identifiers, as
//! JSON), one for the contents, one for each undo step and each redo step (nearest first), the clipboard if there is
//! one, the settings and the last operation as scripts, the file of each sculpture, each loaded picture, and the end
//! with the hash of the contents.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::command::Command;
use crate::command::text::{parse_path, parse_script, path_text};
use crate::document::DocumentSnapshot;
use crate::format::history::{ContentsShape, read_steps, write_step};
use crate::format::{FormatError, Texts, read_sculpture, write_sculpture};
use crate::persist::frame::{Record, RecordBuffer};
use crate::persist::payload::{put_text, take_text};
use crate::persist::sculpture_file::SculptureFile;
use crate::sculpture::clip::Clip;
use crate::sculpture::history::State;
use crate::sculpture::{Digest, Limits};

const BEGIN: u8 = 1;
const CONTENTS: u8 = 2;
const UNDO: u8 = 3;
const REDO: u8 = 4;
const CLIP: u8 = 5;
const SETTINGS: u8 = 6;
const LAST_USES: u8 = 7;
const FILE: u8 = 8;
const PICTURE: u8 = 9;
const END: u8 = 10;

const DAMAGED: FormatError =
    FormatError::Damaged("the checkpoint of the journal has no known form");

/// A session between two strokes.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    /// The document.
    pub document: DocumentSnapshot,
    /// The files of all sculptures that undo and redo lead to.
    pub files: Vec<SculptureFile>,
    /// The loaded pictures: paths, and the bytes of their files.
    pub pictures: Vec<(PathBuf, Arc<[u8]>)>,
    /// The limits of the session.
    pub limits: Limits,
}

/// The first record of a journal.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct JournalBeginning {
    /// Version of the program.
    pub program: String,
    /// The process id of the writer.
    pub process: u32,
    /// When the session began, in seconds since 1970 by the system's clock; for display only.
    pub began_unix_s: u64,
    limits: [u64; 3],
    #[serde(default)]
    history_disk_bytes: u64,
    state: [u64; 2],
    states: u64,
}

impl JournalBeginning {
    pub fn limits(&self) -> Limits {
        let [grid_bytes, colour_bytes, history_bytes] = self.limits;
        let history_disk_bytes = self.history_disk_bytes;
        Limits {
            grid_bytes,
            colour_bytes,
            history_bytes: history_bytes as usize,
            history_disk_bytes,
        }
    }
}

impl Checkpoint {
    /// Passes its records to `append`, one by one.
    pub(super) fn write<E: From<FormatError>>(
        &self,
        began_unix_s: u64,
        append: &mut dyn FnMut(RecordBuffer) -> Result<(), E>,
    ) -> Result<(), E> {
        let DocumentSnapshot { contents, history, clip, settings, last_uses, state, states } =
            &self.document;
        let Limits { grid_bytes, colour_bytes, history_bytes, history_disk_bytes } = self.limits;
        let beginning = JournalBeginning {
            program: env!("CARGO_PKG_VERSION").to_string(),
            process: std::process::id(),
            began_unix_s,
            limits: [grid_bytes, colour_bytes, history_bytes as u64],
            history_disk_bytes,
            state: [state.sculpture, state.number],
            states: *states,
        };
        let json = serde_json::to_vec(&beginning).map_err(|_| DAMAGED)?;
        append(RecordBuffer::with_payload(BEGIN, &json))?;
        append(RecordBuffer::with_payload(
            CONTENTS,
            &write_sculpture(contents, &Texts::default())?,
        ))?;
        for (kind, steps) in [(UNDO, &history.undo), (REDO, &history.redo)] {
            for step in steps.iter().rev() {
                append(RecordBuffer::with_payload(kind, &write_step(step)?))?;
            }
        }
        if let Some(clip) = clip {
            append(RecordBuffer::with_payload(
                CLIP,
                &write_sculpture(clip.contents(), &Texts::default())?,
            ))?;
        }
        append(RecordBuffer::with_payload(SETTINGS, script(settings).as_bytes()))?;
        append(RecordBuffer::with_payload(LAST_USES, script(last_uses).as_bytes()))?;
        for file in &self.files {
            append(file.to_record_of(FILE))?;
        }
        for (path, bytes) in &self.pictures {
            let mut record = RecordBuffer::new(PICTURE);
            put_text(&path_text(path), record.payload());
            record.payload().extend_from_slice(bytes);
            append(record)?;
        }
        append(RecordBuffer::with_payload(END, &Digest::of(contents).0))
    }

    /// Reads a checkpoint from the records of a journal. Contents may take as much as `limits` allow, or the recorded
    /// limits where these are larger. The history has the recorded limit, so that a replay drops the steps that the
    /// session dropped. `None` if the records end before the checkpoint does.
    pub(super) fn read(
        records: &mut dyn Iterator<Item = Record>,
        limits: &Limits,
    ) -> Result<Option<(JournalBeginning, Checkpoint)>, FormatError> {
        let Some(first) = records.next() else { return Ok(None) };
        if first.kind != BEGIN {
            return Err(DAMAGED);
        }
        let beginning: JournalBeginning =
            serde_json::from_slice(&first.payload).map_err(|_| DAMAGED)?;
        let own = beginning.limits();
        let limits = Limits {
            grid_bytes: limits.grid_bytes.max(own.grid_bytes),
            colour_bytes: limits.colour_bytes.max(own.colour_bytes),
            history_bytes: own.history_bytes,
            history_disk_bytes: own.history_disk_bytes,
        };
        let (mut contents, mut clip, mut undo, mut redo) = (None, None, vec![], vec![]);
        let (mut settings, mut last_uses, mut files, mut pictures) =
            (vec![], vec![], vec![], vec![]);
        for Record { kind, payload } in records {
            match kind {
                CONTENTS => contents = Some(read_sculpture(&payload, &limits)?.0),
                UNDO => undo.push(payload),
                REDO => redo.push(payload),
                CLIP => {
                    let contents = read_sculpture(&payload, &limits)?.0;
                    clip = Some(Arc::new(Clip::from_contents(contents)));
                }
                SETTINGS => settings = commands(&payload)?,
                LAST_USES => last_uses = commands(&payload)?,
                FILE => files.push(SculptureFile::from_payload(&payload)?),
                PICTURE => {
                    let mut rest = &payload[..];
                    let path = parse_path(take_text(&mut rest)?).map_err(|_| DAMAGED)?;
                    pictures.push((path, Arc::from(rest)));
                }
                END => {
                    let contents = contents.ok_or(DAMAGED)?;
                    if Digest::of(&contents).0[..] != payload[..] {
                        return Err(FormatError::Damaged(
                            "the sculpture at its checkpoint has another hash than the one kept",
                        ));
                    }
                    let history =
                        read_steps([&undo, &redo], ContentsShape::of(&contents), &limits)?;
                    let [sculpture, number] = beginning.state;
                    let document = DocumentSnapshot {
                        contents: Arc::new(contents),
                        history,
                        clip,
                        settings,
                        last_uses,
                        state: State { sculpture, number },
                        states: beginning.states,
                    };
                    return Ok(Some((beginning, Checkpoint { document, files, pictures, limits })));
                }
                _ => return Err(DAMAGED),
            }
        }
        Ok(None)
    }
}

fn script(commands: &[Command]) -> String {
    commands.iter().map(|command| format!("{command}\n")).collect()
}

fn commands(payload: &[u8]) -> Result<Vec<Command>, FormatError> {
    let text = str::from_utf8(payload).map_err(|_| DAMAGED)?;
    let commands = parse_script(text).map_err(|_| DAMAGED)?;
    Ok(commands.into_iter().map(|(_, command)| command).collect())
}
