//! Work left by earlier sessions that did not end normally. A dialog lists it at the start and restores or removes it
//! as the person chooses.
//!
//! Journals are read and replayed on a thread, while the window stays alive.

use std::sync::PoisonError;

use glam::UVec2;

use crate::document::Limits;
use crate::editor::job::Failure;
use crate::format::options::ImportOptions;
use crate::format::{self, FormatError};
use crate::notice::Notice;
use crate::persist::files::InputFile;
use crate::persist::journal::{AbandonedJournal, JournalDir, JournalError, JournalOptions};
use crate::progress::{Progress, ProgressReport};
use crate::remedy::told;
use crate::sculpture::Digest;
use crate::session::{self, Recovered, Session};
use crate::shade::portrait;
use crate::time_text::utc_text;
use crate::ui::dialogs::recovery::{LeftSession, LeftWork, RecoveryDialog};

/// Size of the pictures in the list, in pixels.
const PICTURE_PX: UVec2 = UVec2::new(128, 96);

/// The journals of earlier sessions, once their folder is known.
#[derive(Default)]
pub(super) struct AbandonedWork {
    /// Where journals lie and how they are kept.
    journals: Option<JournalOptions>,
}

impl AbandonedWork {
    /// Sets where journals lie. Returns true if earlier sessions have left some.
    pub fn look_in(&mut self, journals: JournalOptions) -> bool {
        let is_some_left = journals.journal_dir.count_left() > 0;
        self.journals = Some(journals);
        is_some_left
    }

    /// Returns the work that reads the journals for the dialog. `none`: the message if nothing is found.
    pub fn list(
        &self,
        none: &'static str,
        limits: Limits,
        dialog: &RecoveryDialog,
    ) -> Option<impl FnOnce(&ProgressReport) -> Result<String, Failure> + Send + use<>> {
        let journal_dir = self.journals.as_ref()?.journal_dir.clone();
        let news = dialog.news();
        Some(move |report: &ProgressReport| {
            let found = all_left(&journal_dir, &limits, report)?;
            let text = if found.is_empty() { none } else { "" };
            *news.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
            Ok(text.to_string())
        })
    }

    /// Returns the work that restores the journal of this number, to replace `session`.
    pub fn recovery(
        &self,
        number: u64,
        session: &Session,
    ) -> Option<impl FnOnce(&ProgressReport) -> Result<(Session, Notice), Failure> + Send + use<>>
    {
        let journals = self.journals.clone()?;
        let limits = *session.document().limits();
        let keeps = session.keeps_journal();
        let histories = session.saved_history_options().cloned();
        Some(move |report: &ProgressReport| {
            let (mut session, notice) = bring_back(number, &journals, keeps, &limits, report)?;
            if let Some(histories) = histories {
                session.keep_saved_histories(histories);
            }
            Ok((session, notice))
        })
    }

    /// Removes the unwanted journal of this number. Returns `None` if it is not known where journals lie.
    pub fn discard(&self, number: u64) -> Option<Result<(), String>> {
        let journal_dir = &self.journals.as_ref()?.journal_dir;
        // Opens it first, so that no journal in use is removed.
        Some(source_of(journal_dir, number).and_then(|_locked| {
            journal_dir.remove(number).map_err(|error| failure(journal_dir, number, &error))
        }))
    }
}

fn failure(journal_dir: &JournalDir, number: u64, error: &dyn std::fmt::Display) -> String {
    format!("{}: {error}", journal_dir.path(number).display())
}

fn source_of(journal_dir: &JournalDir, number: u64) -> Result<InputFile, String> {
    match journal_dir.open(number) {
        AbandonedJournal::Journal(source) => Ok(source),
        AbandonedJournal::InUse => {
            Err(failure(journal_dir, number, &"another session is using it"))
        }
        AbandonedJournal::Unreadable(error) => Err(failure(journal_dir, number, &error)),
    }
}

/// Returns the recoverable sessions, latest first. Removes journals without changes, or whose file is complete.
fn all_left(
    journal_dir: &JournalDir,
    limits: &Limits,
    report: &ProgressReport,
) -> Result<Vec<LeftSession>, Failure> {
    let numbers = journal_dir
        .numbers()
        .map_err(|error| Failure::Error(format!("{}: {error}", journal_dir.folder().display())))?;
    let mut found = Vec::new();
    for number in numbers {
        if report.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        let source = match journal_dir.open(number) {
            AbandonedJournal::Journal(source) => source,
            AbandonedJournal::InUse => continue,
            AbandonedJournal::Unreadable(error) => {
                let work = Err(failure(journal_dir, number, &error));
                found.push(LeftSession { number, changed_unix_s: 0, time: String::new(), work });
                continue;
            }
        };
        let changed_unix_s = source.changed_unix_s.unwrap_or(0);
        let work = match session::recover(source, limits, Some(journal_dir.folder()), report) {
            Err(JournalError::Checkpoint(FormatError::Cancelled)) => {
                return Err(Failure::Cancelled);
            }
            Err(error) => Err(failure(journal_dir, number, &told(&error))),
            Ok(recovered)
                if is_untouched(&recovered.session)
                    || is_in_its_file(&recovered, limits, report) =>
            {
                // If it stays, the next search finds it again.
                let _ = journal_dir.remove(number);
                continue;
            }
            Ok(recovered) => Ok(work_of(&recovered)),
        };
        let time = utc_text(changed_unix_s);
        found.push(LeftSession { number, changed_unix_s, time, work });
    }
    found.sort_by_key(|left| std::cmp::Reverse(left.changed_unix_s));
    Ok(found)
}

/// Returns whether there is nothing to lose: there is no step, and the sculpture can be made or read again.
fn is_untouched(session: &Session) -> bool {
    let history = session.document().history();
    !session.modified() && history.undo_count() + history.redo_count() == 0
}

/// Returns whether the sculpture was saved and its file is unchanged. A program that was killed then leaves no more
/// than one that was quit.
fn is_in_its_file(recovered: &Recovered, limits: &Limits, report: &ProgressReport) -> bool {
    let Recovered { session, report: replay } = recovered;
    let Some(path) = session.path().filter(|_| !session.modified()) else { return false };
    if replay.difference.is_some() {
        return false;
    }
    if !format::is_sculpture(path) {
        // Read, but never written: nothing in it was made here.
        return path.is_file();
    }
    let digest = |session: &Session| Digest::of(session.document().contents());
    Session::open(path, &ImportOptions::default(), *limits, report)
        .is_ok_and(|saved| digest(&saved) == digest(session))
}

fn work_of(Recovered { session, report }: &Recovered) -> LeftWork {
    let document = session.document();
    let name = session.path().map_or("A new sculpture".to_string(), |path| {
        path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
    });
    LeftWork {
        name,
        path: session.path().map(|path| path.to_path_buf()),
        steps: document.history().undo_count(),
        dims: document.grid().dims().to_array(),
        saved: !session.modified(),
        differs: report.difference.clone(),
        picture: portrait(document.contents(), PICTURE_PX),
    }
}

/// Replays a journal, begins a new one for the session if one is to be kept, and then removes the first, unless the
/// replay differed from the recording.
fn bring_back(
    number: u64,
    journals: &JournalOptions,
    keeps: bool,
    limits: &Limits,
    report: &ProgressReport,
) -> Result<(Session, Notice), Failure> {
    let source = source_of(&journals.journal_dir, number).map_err(Failure::Error)?;
    let recovered = session::recover(source, limits, Some(journals.journal_dir.folder()), report);
    let Recovered { mut session, report } = recovered.map_err(|error| match error {
        JournalError::Checkpoint(FormatError::Cancelled) => Failure::Cancelled,
        error => Failure::Error(failure(&journals.journal_dir, number, &told(&error))),
    })?;
    let path = journals.journal_dir.path(number);
    if let Some(difference) = report.difference {
        let text = format!(
            "The recovered work differs from the original ({difference}). Its journal is kept: {}",
            path.display()
        );
        return Ok((session, Notice::error(text)));
    }
    if !keeps {
        let text =
            format!("Recovered. The journal is kept until you discard it: {}", path.display());
        return Ok((session, Notice::note(text)));
    }
    let begun = session.keep_journal(journals.clone());
    begun.map_err(|error| Failure::Error(failure(&journals.journal_dir, number, &error)))?;
    session.sync_journal();
    if session.journal_path().is_none() {
        let text = format!(
            "Recovered, but no new journal can be written. The old one is kept: {}",
            path.display()
        );
        return Ok((session, Notice::error(text)));
    }
    Ok(match journals.journal_dir.remove(number) {
        Ok(()) => (session, Notice::note("Recovered, with undo and redo as they were")),
        Err(error) => (session, Notice::error(failure(&journals.journal_dir, number, &error))),
    })
}
