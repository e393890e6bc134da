//! `run`: executes a script, or commands from standard input, and saves, renders or hashes the result.
//!
//! A journal is kept only on request, since a script can be run again.

use std::path::PathBuf;

use glam::UVec2;

use super::{
    Context, JobError, PictureRequest, describe, execute_script, pipe, read_script, render_session,
    save,
};
use crate::command::Command;
use crate::document::Document;
use crate::format::options::{ExportForm, ExportOptions, ImportOptions};
use crate::persist::journal::JournalOptions;
use crate::persist::saved_history::SavedHistoryOptions;
use crate::picture;
use crate::sculpture::Digest;
use crate::session::{FileAccess, Session};
use crate::shade::portrait;
use crate::terminal;

/// Runs a script; saves and renders the result if requested. The script `-` is standard input, whose lines are
/// answered; failed lines do not stop the others.
pub fn run(job: &RunJob, context: &Context) -> Result<(), JobError> {
    if pipe::reads_input(job) {
        return run_piped(job, context);
    }
    let text = read_script(&job.script)?;
    let mut session = job.session(context)?;
    let done = execute_script(&mut session, &text, &job.script, context.progress);
    if job.output.is_none() || done.is_err() {
        tell_of_journal(&session);
    }
    done?;
    if let Some(output) = &job.output {
        save(&mut session, output, ExportForm::Auto, context.progress)?;
        tell_of_history(&session);
    }
    describe(session.document());
    if job.hash {
        let [scene, picture] = hashes(session.document());
        terminal::print_result(format_args!("scene {scene}\npicture {picture}"))?;
    }
    match &job.render {
        Some(picture) => render_session(session, picture, &job.picture, context),
        None => Ok(()),
    }
}

/// Does [`run`] for standard input. Prints only answers and hashes on standard output.
fn run_piped(job: &RunJob, context: &Context) -> Result<(), JobError> {
    let mut session = job.session(context)?;
    let refused = pipe::converse(&mut session, &());
    // The changes are saved however the conversation ended.
    let saved = job.output.as_ref().map(|path| {
        let save = Command::Save { path: path.clone(), export: ExportOptions::default() };
        session.execute(&save, context.progress)
    });
    match (&saved, &refused) {
        (Some(Ok(_)), Ok(_)) => tell_of_history(&session),
        _ => tell_of_journal(&session),
    }
    saved.transpose()?;
    let refused = refused?;
    if let Some(out) = &job.render {
        let view = job.picture.view(context.config);
        let options = context.config.picture_options(context.device);
        picture::render_to_file(session.document_mut(), &view, &options, out)?;
    }
    if job.hash {
        let [scene, picture] = hashes(session.document()).map(|hash| hash.to_string());
        terminal::print_result(serde_json::json!({ "scene": scene, "picture": picture }))?;
    }
    if refused > 0 { Err(JobError::Refused(refused)) } else { Ok(()) }
}

/// The arguments of [`run`].
#[derive(Debug)]
pub struct RunJob {
    pub script: PathBuf,
    pub input: Option<PathBuf>,
    pub output: Option<PathBuf>,
    pub render: Option<PathBuf>,
    pub picture: PictureRequest,
    pub import: ImportOptions,
    /// Print hashes of the scene and of its picture.
    pub hash: bool,
    /// Folder of undo steps that do not fit into memory.
    pub history_folder: PathBuf,
    /// The options for undo histories of opened and saved files; `None`: no histories, so that a script does the same
    /// everywhere.
    pub saved_history: Option<SavedHistoryOptions>,
    /// Does not save to opened files.
    pub read_only: bool,
    /// The options of a journal; `None`: no journal, since a script can be run again.
    pub journal: Option<JournalOptions>,
}

impl RunJob {
    fn session(&self, context: &Context) -> Result<Session, JobError> {
        let mut session = match &self.input {
            Some(input) => context.open_session(input, &self.import)?,
            None => context.new_session()?,
        };
        let path = self.history_folder.clone();
        let begun = session.keep_history_in(&path);
        begun.map_err(|error| JobError::Journal { path, error })?;
        if let Some(options) = &self.saved_history {
            session.keep_saved_histories(options.clone());
        }
        session.set_file_access(match self.read_only {
            true => FileAccess::ReadOnly,
            // A program that drives the session may take as long as a person.
            false if pipe::reads_input(self) => FileAccess::Locked,
            false => FileAccess::Brief,
        });
        if let Some(options) = &self.journal {
            let path = options.journal_dir.folder().to_path_buf();
            let begun = session.keep_journal(options.clone());
            begun.map_err(|error| JobError::Journal { path, error })?;
        }
        Ok(session)
    }
}

/// Returns hashes of the scene, and of its picture as shaded by the CPU: the same for any number of threads.
fn hashes(document: &Document) -> [Digest; 2] {
    const PICTURE_PX: UVec2 = UVec2::new(640, 480);
    let contents = document.contents();
    [Digest::of(contents), Digest::of_bytes(portrait(contents, PICTURE_PX).bytes())]
}

/// Reports errors of the history on disk and of those of saved files.
fn tell_of_history(session: &Session) {
    session.wait_for_saved_history();
    while let Some(message) = session.take_history_message() {
        terminal::print_notice(message);
    }
}

/// Reports errors of the journal, and the place of unsaved changes.
fn tell_of_journal(session: &Session) {
    tell_of_history(session);
    session.wait_for_journal();
    if let Some(message) = session.take_journal_message() {
        terminal::print_notice(message);
    }
    if let Some(number) = session.journal_number().filter(|_| session.modified()) {
        terminal::print_notice(format_args!(
            "unsaved work is kept in journal {number}; `virtual-sculpture recover {number} --out FILE` writes it"
        ));
    }
}
