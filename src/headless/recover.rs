//! `recover`: restores the work of sessions that did not end normally, without a window.
//!
//! Takes the folder of the journals; lists them, as text or as JSON for programs, writes the sculpture of one to a new
//! file, or removes one. Skips journals of sessions that are still running.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::{Context, JobError};
use crate::command::Command;
use crate::format::options::ExportOptions;
use crate::persist::frame::Ending;
use crate::persist::journal::{AbandonedJournal, JournalDir};
use crate::remedy::told;
use crate::session::{self, Recovered, Summary};
use crate::terminal;
use crate::time_text::utc_text;

/// The arguments of [`recover`].
#[derive(Debug)]
pub struct RecoverJob {
    /// The folder of the journals.
    pub journal_dir: JournalDir,
    /// The number of a journal; `None`: list all.
    pub number: Option<u64>,
    /// The file to write.
    pub out: Option<PathBuf>,
    /// Remove the journal after writing the file.
    pub discard: bool,
    /// List them as JSON.
    pub json: bool,
}

/// Lists journals, or recovers one.
pub fn recover(job: &RecoverJob, context: &Context) -> Result<(), JobError> {
    let Some(number) = job.number else { return list(&job.journal_dir, job.json, context) };
    let difference = match &job.out {
        Some(out) => write(&job.journal_dir, number, out, context)?,
        None => None,
    };
    if let (Some(difference), Some(out)) = (difference, &job.out) {
        // A replay that differs may not be the work that was done: the journal stays.
        return Err(JobError::ReplayDiffers { out: out.clone(), number, difference });
    }
    if job.discard {
        // Opens it first, so that no journal in use is removed.
        let _locked = open(&job.journal_dir, number)?;
        let failed = |error| JobError::Journal { path: job.journal_dir.path(number), error };
        job.journal_dir.remove(number).map_err(failed)?;
        terminal::print_done(format_args!("removed journal {number}"));
    }
    Ok(())
}

fn open(
    journal_dir: &JournalDir,
    number: u64,
) -> Result<crate::persist::files::InputFile, JobError> {
    match journal_dir.open(number) {
        AbandonedJournal::Journal(source) => Ok(source),
        AbandonedJournal::InUse => Err(JobError::JournalInUse(number)),
        AbandonedJournal::Unreadable(error) if error.kind() == std::io::ErrorKind::NotFound => {
            Err(JobError::NoJournal(number))
        }
        AbandonedJournal::Unreadable(error) => {
            Err(JobError::Journal { path: journal_dir.path(number), error })
        }
    }
}

/// Writes the sculpture of a journal to a new file. Returns where the replay differed.
fn write(
    journal_dir: &JournalDir,
    number: u64,
    out: &Path,
    context: &Context,
) -> Result<Option<String>, JobError> {
    if out.symlink_metadata().is_ok() {
        return Err(JobError::OutExists(out.to_path_buf()));
    }
    let source = open(journal_dir, number)?;
    let limits = context.config.limits();
    let recovered = session::recover(source, &limits, Some(journal_dir.folder()), context.progress);
    let Recovered { mut session, report } = recovered
        .map_err(|error| JobError::Unrecoverable { path: journal_dir.path(number), error })?;
    let save = Command::Save { path: out.to_path_buf(), export: ExportOptions::default() };
    session.execute(&save, context.progress)?;
    let stroke = if report.in_stroke { ", with a stroke that had not ended" } else { "" };
    let entries = report.entries;
    terminal::print_done(format_args!("wrote {} ({entries} commands{stroke})", out.display()));
    Ok(report.difference)
}

fn list(journal_dir: &JournalDir, as_json: bool, context: &Context) -> Result<(), JobError> {
    let failed = |error| JobError::Journal { path: journal_dir.folder().to_path_buf(), error };
    let mut values = Vec::new();
    let mut untouched = 0;
    for number in journal_dir.numbers().map_err(failed)? {
        let source = match journal_dir.open(number) {
            AbandonedJournal::Journal(source) => source,
            AbandonedJournal::InUse => continue,
            // Removed meanwhile: its session has ended.
            AbandonedJournal::Unreadable(error) if error.kind() == std::io::ErrorKind::NotFound => {
                continue;
            }
            AbandonedJournal::Unreadable(error) => {
                values.push(damaged(number, &error.to_string(), as_json)?);
                continue;
            }
        };
        let (bytes, changed) = (source.bytes, source.changed_unix_s);
        let value = match session::summary(source, &context.config.limits()) {
            Err(error) => damaged(number, &told(&error), as_json)?,
            Ok(summary) if as_json => value_of(number, &summary, bytes, changed),
            Ok(summary) if summary.untouched => {
                untouched += 1;
                continue;
            }
            Ok(summary) => {
                terminal::print_result(line_of(number, &summary, changed))?;
                Value::Null
            }
        };
        values.push(value);
    }
    if as_json {
        terminal::print_result(Value::from(values))?;
    } else if untouched > 0 {
        let (plural, them) = if untouched == 1 { ("", "it") } else { ("s", "them") };
        terminal::print_notice(format_args!(
            "{untouched} session{plural} in which nothing was changed left out; `recover --json` lists {them}"
        ));
    }
    Ok(())
}

/// Describes a journal that cannot be restored. Removing it is up to the person.
fn damaged(number: u64, error: &str, as_json: bool) -> Result<Value, JobError> {
    if !as_json {
        terminal::print_result(format_args!("{number}: cannot be recovered: {error}"))?;
    }
    Ok(json!({ "number": number, "error": error }))
}

fn value_of(number: u64, summary: &Summary, bytes: u64, changed: Option<u64>) -> Value {
    let Summary { path, dims, voxels, steps, modified, untouched, .. } = summary;
    let Summary { began_unix_s, process, ending, .. } = summary;
    json!({
        "number": number,
        "file": path.as_ref().map(|path| path.to_string_lossy()),
        "dims": dims,
        "voxels": voxels,
        "steps": steps,
        "modified": modified,
        "untouched": untouched,
        "began_unix_s": began_unix_s,
        "changed_unix_s": changed,
        "process": process,
        "bytes": bytes,
        "whole": *ending == Ending::Whole,
    })
}

fn line_of(number: u64, summary: &Summary, changed: Option<u64>) -> String {
    let Summary { path, dims: [x, y, z], voxels, steps, modified, began_unix_s, .. } = summary;
    let name = match path {
        Some(path) => path.display().to_string(),
        None => "a new sculpture".to_string(),
    };
    let time = utc_text(changed.unwrap_or(*began_unix_s));
    let unsaved = if *modified { "" } else { ", saved" };
    let plural = if *steps == 1 { "" } else { "s" };
    format!("{number}: {name}, {time}, {steps} step{plural}, {x}x{y}x{z}, {voxels} voxels{unsaved}")
}
