//! The arguments of `run`.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{ImportArgs, PictureArgs, named};
use super::error::ArgumentError;
use crate::config::Config;
use crate::folders;
use crate::format;
use crate::headless::RunJob;
use crate::persist::journal::JournalOptions;
use crate::picture;

/// A script to run.
#[derive(Args, Debug)]
pub struct RunArgs {
    /// Script with one command per line; see `virtual-sculpture commands`. `-`: from standard input, each line
    /// answered by a line of JSON
    pub script: PathBuf,
    /// Sculpture or volume to start from
    #[arg(long = "in", value_name = "FILE")]
    pub input: Option<PathBuf>,
    #[arg(long = "out", value_name = "FILE", value_parser = named(&format::WRITE_ENDINGS),
          help = format!("Where to save the result ({})", format::written_text()))]
    pub output: Option<PathBuf>,
    /// Also render the result to this picture (.png, .jpg)
    #[arg(long, value_name = "PICTURE", value_parser = named(&picture::ENDINGS))]
    pub render: Option<PathBuf>,
    /// Print a hash of the scene, and one of its picture as the CPU shades it
    #[arg(long)]
    pub hash: bool,
    /// Keep the undo history of the files that it saves, and continue that of the files that it opens, as the
    /// window does
    #[arg(long)]
    pub history: bool,
    /// Do not save to the files that are opened
    #[arg(long)]
    pub read_only: bool,
    /// Keep a journal, as the window does, so that work survives even if the program is killed
    #[arg(long)]
    pub journal: bool,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub import: ImportArgs,
}

impl RunArgs {
    /// Returns the job by the settings. `journal`: their options of journals.
    pub fn job(self, config: &Config, journal: JournalOptions) -> Result<RunJob, ArgumentError> {
        Ok(RunJob {
            script: self.script,
            input: self.input,
            output: self.output,
            render: self.render,
            picture: self.picture.request()?,
            import: self.import.options(),
            hash: self.hash,
            saved_history: self.history.then(|| config.saved_history.options()),
            read_only: self.read_only,
            journal: self.journal.then_some(journal),
            history_folder: folders::journal_folder(),
        })
    }
}
