//! The file of a history, as records of [`frame`](crate::persist::frame):
//!
//! 1. the beginning (32): JSON with version of the program, the sculpture's file and its hash, the hash of the
//!    contents, and the state that the steps lead from;
//! 2. steps to undo (33) and to redo (34), the nearest first, as [`write_step`] packs them;
//! 3. the texts of other sculptures that the steps lead to (35), without their paths: nothing here says where a file
//!    may be overwritten;
//! 4. the end (36): how many steps of both kinds there are (two u32).
//!
//! Reading takes all or nothing: a file that is truncated, damaged or made for other contents gives no step.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use crate::command::text::path_text;
use crate::document::DocumentSnapshot;
use crate::format::FormatError;
use crate::format::history::{ContentsShape, read_step, write_step};
use crate::persist::files::InputFile;
use crate::persist::frame::{FileRecords, Record, RecordBuffer};
use crate::persist::sculpture_file::SculptureFile;
use crate::sculpture::history::{Contents, HistorySnapshot, State, Step};
use crate::sculpture::{Digest, Limits};

const BEGIN: u8 = 32;
const UNDO: u8 = 33;
const REDO: u8 = 34;
const TEXTS: u8 = 35;
const END: u8 = 36;

/// Greatest memory of the kept steps per byte of the file limit: more would take too long to pack.
const MEMORY_PER_FILE: u64 = 4;

const DAMAGED: FormatError = FormatError::Damaged("it has no known form");
const CUT: FormatError = FormatError::Damaged("it is cut off or damaged");

#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
struct HistoryBeginning {
    program: String,
    file: String,
    file_hash: String,
    contents_hash: String,
    state: [u64; 2],
}

/// A history to keep, of a document in the state in which it was saved.
#[derive(Clone, Debug)]
pub struct HistoryToKeep {
    /// The path of the sculpture's file, absolute.
    pub path: PathBuf,
    /// The hash of that file's bytes.
    pub file_hash: Digest,
    /// The hash of the contents.
    pub contents_hash: Digest,
    /// Steps and state. Its contents are not needed.
    pub steps: KeptSteps,
}

/// The steps of a document, and the state from which they lead.
#[derive(Clone, Debug)]
pub struct KeptSteps {
    history: HistorySnapshot,
    state: State,
    files: Vec<SculptureFile>,
}

impl KeptSteps {
    /// Takes the steps of a document; `files`: the files of all sculptures that undo and redo lead to.
    pub fn of(document: DocumentSnapshot, files: Vec<SculptureFile>) -> KeptSteps {
        KeptSteps { history: document.history, state: document.state, files }
    }

    /// Returns whether there is anything to undo or redo.
    pub fn is_empty(&self) -> bool {
        self.history.undo.is_empty() && self.history.redo.is_empty()
    }
}

/// The steps around the contents of an opened file.
#[derive(Clone, PartialEq, Debug)]
pub struct SavedHistory {
    /// The steps to undo and to redo.
    pub history: HistorySnapshot,
    /// The state from which they lead.
    pub state: State,
    /// Other sculptures that they lead to, with their texts and no paths.
    pub files: Vec<SculptureFile>,
}

/// Passes the records of a history to `append`, with at most `max_bytes` of steps. Returns false if it was abandoned.
pub fn write(
    kept: &HistoryToKeep,
    max_bytes: u64,
    is_given_up: &AtomicBool,
    append: &mut dyn FnMut(RecordBuffer) -> std::io::Result<()>,
) -> Result<bool, FormatError> {
    let HistoryToKeep { path, file_hash, contents_hash, steps } = kept;
    let beginning = HistoryBeginning {
        program: env!("CARGO_PKG_VERSION").to_string(),
        file: path_text(path),
        file_hash: file_hash.to_string(),
        contents_hash: contents_hash.to_string(),
        state: [steps.state.sculpture, steps.state.number],
    };
    let json = serde_json::to_vec(&beginning).map_err(|_| DAMAGED)?;
    append(RecordBuffer::with_payload(BEGIN, &json))?;
    let mut lists = [(UNDO, &steps.history.undo), (REDO, &steps.history.redo)]
        .map(|(kind, steps)| (kind, steps.iter().rev().peekable(), 0u32));
    let (mut file_left, mut memory_left) = (max_bytes, max_bytes.saturating_mul(MEMORY_PER_FILE));
    let mut sculptures = vec![steps.state.sculpture];
    // Alternating, so that a long past leaves room for redo steps.
    while lists.iter_mut().any(|(_, steps, _)| steps.peek().is_some()) {
        for (kind, steps, count) in &mut lists {
            let Some(step) = steps.next() else { continue };
            if is_given_up.load(Ordering::Relaxed) {
                return Ok(false);
            }
            let packed = pack(step, &mut file_left, &mut memory_left)?;
            let Some(packed) = packed else {
                // More distant steps can only be reached through it.
                steps.by_ref().for_each(drop);
                continue;
            };
            append(RecordBuffer::with_payload(*kind, &packed))?;
            sculptures.push(step.state.sculpture);
            *count += 1;
        }
    }
    let own = steps.state.sculpture;
    let others =
        |file: &&SculptureFile| file.sculpture != own && sculptures.contains(&file.sculpture);
    for file in steps.files.iter().filter(others) {
        append(nameless(file).to_record_of(TEXTS))?;
    }
    let counts: Vec<u8> = lists.iter().flat_map(|(.., count)| count.to_le_bytes()).collect();
    append(RecordBuffer::with_payload(END, &counts))?;
    Ok(true)
}

/// Returns the bytes of a step, if there is room for them.
fn pack(
    step: &Step,
    file_left: &mut u64,
    memory_left: &mut u64,
) -> Result<Option<Vec<u8>>, FormatError> {
    let Some(memory) = memory_left.checked_sub(step.whole_bytes() as u64) else { return Ok(None) };
    let packed = write_step(step)?;
    let Some(file) = file_left.checked_sub(packed.len() as u64) else { return Ok(None) };
    (*file_left, *memory_left) = (file, memory);
    Ok(Some(packed))
}

fn nameless(file: &SculptureFile) -> SculptureFile {
    SculptureFile { path: None, saved: None, assumed_up: None, ..file.clone() }
}

/// Returns the path of the sculpture whose history a file holds.
pub fn path_of(source: InputFile) -> Option<PathBuf> {
    let first = FileRecords::new(source.reader, source.bytes).ok()?.next()?;
    let beginning = beginning(&first).ok()?;
    crate::command::text::parse_path(&beginning.file).ok()
}

fn beginning(first: &Record) -> Result<HistoryBeginning, FormatError> {
    if first.kind != BEGIN {
        return Err(DAMAGED);
    }
    serde_json::from_slice(&first.payload).map_err(|_| DAMAGED)
}

/// Reads the history of a file with `file_hash` that was read as `contents`. Steps beyond [`Limits::history_bytes`] are
/// left out, the most distant ones first.
///
/// # Errors
/// If any of it is damaged, missing, or made for something else.
pub fn read(
    source: InputFile,
    file_hash: Digest,
    contents: &Contents,
    limits: &Limits,
) -> Result<SavedHistory, FormatError> {
    let mut records = FileRecords::new(source.reader, source.bytes).map_err(|_| CUT)?;
    let first = beginning(&records.next().ok_or(CUT)?)?;
    if first.file_hash != file_hash.to_string() {
        return Err(FormatError::Damaged("it belongs to another file"));
    }
    if first.contents_hash != Digest::of(contents).to_string() {
        return Err(FormatError::Damaged("it was kept for other contents"));
    }
    let [sculpture, number] = first.state;
    let state = State { sculpture, number };
    let mut lists =
        [0, 1].map(|_| List { shape: ContentsShape::of(contents), steps: vec![], count: 0 });
    let mut left = limits.history_bytes;
    let mut files = Vec::new();
    for Record { kind, payload } in records.by_ref() {
        match kind {
            UNDO => lists[0].read(&payload, limits, &mut left)?,
            REDO => lists[1].read(&payload, limits, &mut left)?,
            TEXTS => files.push(nameless(&SculptureFile::from_payload(&payload)?)),
            END => {
                let counts: Vec<u8> =
                    lists.iter().flat_map(|list| list.count.to_le_bytes()).collect();
                if counts != payload || records.bytes_left() > 0 {
                    return Err(DAMAGED);
                }
                let [undo, redo] = lists.map(List::oldest_first);
                return Ok(SavedHistory { history: HistorySnapshot { undo, redo }, state, files });
            }
            _ => return Err(DAMAGED),
        }
    }
    Err(CUT)
}

/// The steps of one list during reading.
struct List {
    /// The shape of the contents that the next step leads from.
    shape: ContentsShape,
    /// The steps, nearest first.
    steps: Vec<Arc<Step>>,
    /// Number of steps in the file.
    count: u32,
}

impl List {
    fn read(
        &mut self,
        packed: &[u8],
        limits: &Limits,
        left: &mut usize,
    ) -> Result<(), FormatError> {
        // For steps without room in memory, only the checksum has been checked.
        if self.count as usize == self.steps.len() {
            let step = read_step(packed, self.shape, limits)?;
            self.shape = self.shape.after(&step.change);
            if let Some(rest) = left.checked_sub(step.heap_bytes()) {
                *left = rest;
                self.steps.push(Arc::new(step));
            }
        }
        self.count += 1;
        Ok(())
    }

    fn oldest_first(mut self) -> Vec<Arc<Step>> {
        self.steps.reverse();
        self.steps
    }
}
