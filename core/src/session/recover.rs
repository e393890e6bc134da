//! Replays a journal to a session that continues where the writing session ended.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Session;
use super::error::SessionError;
use super::files::SculptureFiles;
use super::histories::Histories;
use crate::command::{Command, CommandClass};
use crate::document::{Document, Limits};
use crate::format::FormatError;
use crate::persist::files::InputFile;
use crate::persist::frame::Ending;
use crate::persist::journal::{Checkpoint, JournalEntry, JournalError, JournalReader, Mark};
use crate::progress::Progress;
use crate::sculpture::history::State;

/// A recovered session.
#[derive(Debug)]
pub struct Recovered {
    /// Continues where the lost session ended, with its undo and redo steps. It keeps no journal yet.
    pub session: Session,
    /// The report on the replay.
    pub report: RecoveryReport,
}

/// The outcome of a journal's replay.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RecoveryReport {
    /// Entries since the checkpoint that were replayed.
    pub entries: u64,
    /// Whether a stroke was open. It is now an undo step, as far as it went.
    pub in_stroke: bool,
    /// The reason why the journal ends.
    pub ending: Ending,
    /// The first difference between the replay and the lost session, or the reason why the replay could not continue.
    pub difference: Option<String>,
}

/// The contents of a journal, as far as known without a replay.
#[derive(Clone, PartialEq, Debug)]
pub struct Summary {
    /// The file of the sculpture, if it has one.
    pub path: Option<PathBuf>,
    /// Size in voxels.
    pub dims: [u32; 3],
    /// Number of existing voxels.
    pub voxels: u64,
    /// Number of steps that can be undone.
    pub steps: u64,
    /// Whether the file, if there is one, lacks changes.
    pub modified: bool,
    /// Whether nothing was changed, now or in any step, so that nothing can be lost.
    pub untouched: bool,
    /// When the session began, in seconds since 1970 by the clock of that time.
    pub began_unix_s: u64,
    /// The process that wrote it.
    pub process: u32,
    /// The reason why the journal ends.
    pub ending: Ending,
}

/// Recovers the session of a journal. `history_folder`: the place for undo steps for which memory has no room, if the
/// writing session had such a place or the limits allow one.
///
/// # Errors
/// If it holds no complete checkpoint. Entries after the checkpoint are replayed as far as possible.
pub fn recover(
    source: InputFile,
    limits: &Limits,
    history_folder: Option<&Path>,
    progress: &dyn Progress,
) -> Result<Recovered, JournalError> {
    let bytes = source.bytes.max(1);
    let (mut reader, checkpoint) = JournalReader::open(source, limits)?;
    let mut replay = Replay::begin(checkpoint, history_folder)?;
    let mut report =
        RecoveryReport { entries: 0, in_stroke: false, ending: Ending::Whole, difference: None };
    progress.begin("replaying the journal");
    while let Some(entry) = reader.next() {
        if progress.is_cancelled() {
            return Err(FormatError::Cancelled.into());
        }
        progress.advance(1.0 - reader.bytes_left() as f32 / bytes as f32);
        let number = report.entries + 1;
        let replayed = match entry {
            Ok(entry) => replay.repeat(entry).map_err(|error| error.to_string()),
            Err(error) => Err(error.to_string()),
        };
        match replayed {
            Ok(None) => {}
            Ok(Some(what)) => {
                report.difference.get_or_insert(format!("entry {number}: {what}"));
            }
            Err(error) => {
                report.difference.get_or_insert(format!("entry {number}: {error}"));
                break;
            }
        }
        report.entries = number;
    }
    progress.end();
    report.ending = reader.ending().unwrap_or(Ending::Damaged);
    let mut session = replay.session;
    session.document.raise_history_budget(limits);
    let lacks_store = session.histories.step_store().is_none();
    if let Some(folder) = history_folder.filter(|_| lacks_store) {
        session.keep_history_in(folder).map_err(FormatError::from)?;
    }
    if session.document.stroke_open() {
        report.in_stroke = true;
        // The history may have no room for the stroke; then only the stroke is lost.
        if session.document.apply(&Command::End).is_err() {
            session.document.apply(&Command::Cancel).map_err(|_| JournalError::Incomplete)?;
        }
    }
    Ok(Recovered { session, report })
}

/// Reads the contents of a journal.
///
/// # Errors
/// As [`recover`].
pub fn summary(source: InputFile, limits: &Limits) -> Result<Summary, JournalError> {
    let (mut reader, checkpoint) = JournalReader::open(source, limits)?;
    let document = &checkpoint.document;
    let mut steps = document.history.undo.len() as u64;
    let mut settled = document.state;
    let mut now = settled;
    let mut dims = document.contents.grid.dims().to_array();
    let mut voxels = document.contents.grid.opaque_count();
    let mut files = SculptureFiles::restored(checkpoint.files);
    let mut in_stroke = false;
    let begun = now;
    let mut untouched = document.history.undo.is_empty() && document.history.redo.is_empty();
    for entry in reader.by_ref().map_while(Result::ok) {
        let mark = match entry {
            JournalEntry::Command { command, mark } => {
                let before = settled;
                match command {
                    Command::Begin { .. } => in_stroke = true,
                    Command::End | Command::Cancel => in_stroke = false,
                    Command::New(_) => files.made(mark.state),
                    Command::Undo { steps: Some(gone) } => {
                        steps = steps.saturating_sub(gone.into())
                    }
                    Command::Redo { steps: Some(gone) } => steps += u64::from(gone),
                    _ => {}
                }
                if !in_stroke {
                    settled = mark.state;
                    let travels = command.class() == CommandClass::Travel;
                    steps += u64::from(settled != before && !travels);
                }
                mark
            }
            JournalEntry::Opened { path, texts, assumed_up, mark, .. } => {
                steps += 1;
                settled = mark.state;
                files.opened(mark.state, path, texts, assumed_up);
                mark
            }
            JournalEntry::Saved { path, state } => {
                files.saved(state, path);
                continue;
            }
            JournalEntry::Picture { .. } => continue,
        };
        untouched &= mark.state == begun;
        (now, voxels, dims) = (mark.state, mark.voxels, mark.dims);
    }
    Ok(Summary {
        path: files.path(now).map(PathBuf::from),
        dims,
        voxels,
        steps: steps + u64::from(now != settled),
        modified: !files.is_saved(now),
        untouched: untouched && files.is_saved(now),
        began_unix_s: reader.began_unix_s(),
        process: reader.process(),
        ending: reader.ending().unwrap_or(Ending::Damaged),
    })
}

/// A session that is recovered entry by entry.
struct Replay {
    session: Session,
}

impl Replay {
    /// Begins with a checkpoint.
    fn begin(checkpoint: Checkpoint, history_folder: Option<&Path>) -> Result<Replay, FormatError> {
        let Checkpoint { document, files, pictures, limits } = checkpoint;
        let histories =
            history_folder.map(|folder| Histories::with_steps_in(folder, &limits)).transpose()?;
        let histories = histories.unwrap_or_default();
        let document = Document::restored(document, limits, histories.step_store())
            .map_err(|_| FormatError::Damaged("a setting of the session is refused"))?;
        // A recording begins before any change; this session is past that.
        let beginning = Command::Undo { steps: Some(0) };
        let mut session = Session::with_document(document, beginning);
        session.histories = histories;
        session.files = SculptureFiles::restored(files);
        for (path, file) in pictures {
            session.pictures.restore(path, file, &mut session.document)?;
        }
        Ok(Replay { session })
    }

    /// Repeats an entry without reading any file. Returns the difference from the lost session, if there is one.
    fn repeat(&mut self, entry: JournalEntry) -> Result<Option<String>, SessionError> {
        let session = &mut self.session;
        match entry {
            JournalEntry::Command { command, mark } => {
                session.pictures.forget_at_stroke(&command, &mut session.document);
                session.document.apply(&command)?;
                if matches!(command, Command::New(_)) {
                    session.files.made(session.document.state());
                }
                if !session.document.stroke_open() {
                    session.keep_reachable_files();
                }
                Ok(difference(&session.document, mark))
            }
            JournalEntry::Opened { path, contents, texts, assumed_up, mark } => {
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
                let contents = Arc::unwrap_or_clone(contents);
                session.document.replace(contents, &format!("open {name}"))?;
                session.files.opened(session.document.state(), path, texts, assumed_up);
                session.keep_reachable_files();
                Ok(difference(&session.document, mark))
            }
            JournalEntry::Saved { path, state } => {
                session.files.saved(state, path);
                Ok(None)
            }
            JournalEntry::Picture { path, file } => {
                let file = file.or_else(|| session.pictures.file(&path));
                let lost = FormatError::Damaged("the journal does not hold the image");
                let restored = file.ok_or(lost).and_then(|file| {
                    session.pictures.restore(path.clone(), file, &mut session.document)
                });
                match restored {
                    Ok(()) => Ok(None),
                    Err(error) => Err(SessionError::Picture { path, error }),
                }
            }
        }
    }
}

/// Returns how a document differs from the lost session, if it does.
fn difference(document: &Document, mark: Mark) -> Option<String> {
    let now = Mark::of(document);
    let State { sculpture, number } = mark.state;
    let differs = now != mark;
    differs.then(|| {
        let of = |mark: Mark| format!("{} voxels and {} painted bricks", mark.voxels, mark.pages);
        format!(
            "the replay led to {}, the session had {} (state {sculpture}.{number})",
            of(now),
            of(mark)
        )
    })
}
