//! The job `film`: a turntable of a sculpture, or the time lapse of a script or of a session, frame by frame.
//!
//! Frame i depends only on the sculpture or the script, the options, and i, so that any part of a film can be made
//! anywhere. One frame is in memory at a time. Takes a [`FilmJob`]; writes a folder of pictures, an animated PNG or
//! GIF, or raw video. Must not know windows.

mod frames;
mod framing;
mod gif;
mod lapse;
mod output;
mod stage;
mod timing;
mod y4m;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::UVec2;
use thiserror::Error;

use crate::document::DocumentSnapshot;
use crate::format::options::ImportOptions;
use crate::headless::{Context, JobError, PictureRequest};
use crate::sculpture::Placement;
use crate::sculpture::history::{Contents, StepStore};
use crate::terminal;
use crate::view::StereoLayout;
use frames::Format;
use lapse::Lapse;
pub use output::Form;
use output::Output;
use stage::FilmStage;
pub use timing::FrameRange;
use timing::Timing;

/// Extension of scripts, which become time lapses.
pub const SCRIPT_ENDING: &str = "sculpt";

/// The subject of a film.
#[derive(Clone, Debug)]
pub enum Subject {
    /// A sculpture or volume, or a script by its extension.
    File(PathBuf),
    /// An open sculpture.
    Sculpture { contents: Arc<Contents>, placement: Placement },
    /// The history of an open sculpture, as far back as undo goes. `store`: holds the steps that do not fit into
    /// memory.
    Steps { now: Box<DocumentSnapshot>, store: Option<Arc<dyn StepStore>> },
}

/// A film to make.
#[derive(Debug)]
pub struct FilmJob {
    pub subject: Subject,
    /// The initial file of a script.
    pub input: Option<PathBuf>,
    pub out: PathBuf,
    /// The number of frames of the whole film.
    pub frames: u32,
    /// The part to make.
    pub range: FrameRange,
    /// Frames per second.
    pub fps: u16,
    /// The angle by which the sculpture turns in the film; `None`: once around in a turntable, not at all in a time
    /// lapse.
    pub spin_deg: Option<f32>,
    /// Its turn is that of the first frame.
    pub picture: PictureRequest,
    pub import: ImportOptions,
}

impl FilmJob {
    fn is_lapse(&self) -> bool {
        let is_script = |file: &PathBuf| {
            file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(SCRIPT_ENDING))
        };
        matches!(self.subject, Subject::Steps { .. }) || self.file().is_some_and(is_script)
    }

    /// Returns the file of the subject, if it has one.
    fn file(&self) -> Option<&PathBuf> {
        match &self.subject {
            Subject::File(file) => Some(file),
            Subject::Sculpture { .. } | Subject::Steps { .. } => None,
        }
    }
}

/// The reason why a film could not be made.
#[derive(Debug, Error)]
pub enum FilmError {
    #[error(transparent)]
    Job(#[from] JobError),
    #[error("{0}")]
    Form(String),
    #[error("there are no frames {range} in a film with the frames 1 to {frames}")]
    Range { range: FrameRange, frames: u32 },
    #[error(
        "the stereo layout `layers` makes two pictures of a frame; choose another with `--stereo`"
    )]
    Layers,
    #[error("`--in` is what a script starts from, and {0} is no script (.{SCRIPT_ENDING})")]
    NoScript(PathBuf),
    #[error("{0} is needed for the film and would be overwritten by it; choose another name")]
    OverInput(PathBuf),
    #[error("cannot create the folder {path}: {error}")]
    Folder { path: PathBuf, error: std::io::Error },
    #[error("cannot write {path}: {error}")]
    Write { path: PathBuf, error: std::io::Error },
    #[error("the film was cancelled")]
    Cancelled,
}

/// Makes a film, or a part of one, and reports it.
pub fn run(job: &FilmJob, context: &Context) -> Result<(), FilmError> {
    let frames = make(job, context)?;
    let (UVec2 { x, y }, out) = (job.picture.size, job.out.display());
    let (first, last) = (frames.start + 1, frames.end);
    terminal::print_done(format_args!("wrote frames {first} to {last} to {out} ({x}x{y})"));
    Ok(())
}

/// Makes a film, or a part of one. Returns the frames that it made, counted from 0.
pub fn make(job: &FilmJob, context: &Context) -> Result<Range<u32>, FilmError> {
    let view = job.picture.view(context.config);
    if view.stereo == StereoLayout::Layers {
        return Err(FilmError::Layers);
    }
    if job.input.is_some() && !job.is_lapse() {
        let subject = job.file().cloned().unwrap_or_default();
        return Err(FilmError::NoScript(subject));
    }
    let outside = || FilmError::Range { range: job.range, frames: job.frames };
    let part = job.range.within(job.frames).ok_or_else(outside)?;
    let form = Form::of(&job.out).map_err(FilmError::Form)?;
    let spin_deg = job.spin_deg.unwrap_or(if job.is_lapse() { 0.0 } else { 360.0 });
    let timing = Timing { frames: job.frames, turn_deg: job.picture.turn_deg, spin_deg };
    let format = Format { size: view.size, fps: job.fps, frames: job.frames, part: part.clone() };

    let lapse = match &job.subject {
        Subject::Steps { now, .. } => Some(Lapse::of_steps(now.history.undo.len())),
        Subject::File(file) if job.is_lapse() => Some(Lapse::read(file)?),
        Subject::File(_) | Subject::Sculpture { .. } => None,
    };
    let of_script = lapse.iter().flat_map(Lapse::inputs);
    let inputs = job.file().into_iter().chain(&job.input).map(PathBuf::as_path);
    refuse_inputs(&form.paths(&job.out, &format), inputs.chain(of_script))?;
    let scene = stage::begin(job, context)?;
    // Before the work, which may be long.
    let output = Output::create(form, &job.out, format)?;

    let mut stage = FilmStage::new(job, scene, lapse, view, timing, context)?;
    let progress = context.progress;
    progress.begin("filming");
    let count = part.len() as f32;
    let picture = &mut |frame: u32| {
        progress.advance((frame - part.start) as f32 / count);
        stage.picture(frame)
    };
    let written = output.write(picture);
    progress.end();
    written.map(|()| part)
}

/// Refuses outputs that are also inputs, under any name.
fn refuse_inputs<'a>(
    outputs: &[PathBuf],
    inputs: impl Iterator<Item = &'a Path>,
) -> Result<(), FilmError> {
    let real = |path: &Path| path.canonicalize().ok();
    let inputs: Vec<PathBuf> = inputs.filter_map(real).collect();
    let is_input = |path: &&PathBuf| real(path).is_some_and(|path| inputs.contains(&path));
    match outputs.iter().find(is_input) {
        Some(path) => Err(FilmError::OverInput(path.clone())),
        None => Ok(()),
    }
}
