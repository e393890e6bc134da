//! The benchmark of the program: all modes on standard sculptures, edits, files, and a description
//! of the machine.
//!
//! Everything runs as in the program: edits as commands, pictures by the stages of a window, files
//! as by commands. Times are measured here alone.

mod edits;
mod features;
mod files;
mod final_pictures;
mod kernel;
mod kernel_pictures;
mod machine;
mod measured;
mod normals;
mod pictures;
mod plot;
mod report;
mod sizes;
mod sizes_plot;
mod statistics;
mod subjects;
mod uses;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use clap::ValueEnum;
use glam::UVec2;
use thiserror::Error;

use crate::config::Config;
use crate::document::{CommandError, Document};
use crate::format::options::ImportOptions;
use crate::format::{FormatError, store};
use crate::gpu::{Device, DeviceOptions, GpuError, Headless};
use crate::progress::Progress;
use crate::remedy::told;
use crate::render::renderer::DeviceTimes;
use crate::render::{RenderMode, Volume};
use crate::sculpture::GridError;
use crate::terminal::{self, OutputError};
use crate::trace::TraceError;
pub use kernel::Kernel;
use machine::Machine;
use measured::BenchScene;
use pictures::BenchPictures;
use report::{BenchReport, DeviceReport, ModeReport, SceneReport};
use statistics::{Times, measure};
use subjects::{BenchSubject, eyes_of};

/// The extent of the measurements.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, ValueEnum)]
pub enum Suite {
    /// As few runs as possible: shows that everything can be measured, and roughly how long it takes
    Brief,
    /// A few seconds per scene
    #[default]
    Quick,
    /// Minutes, for figures to be quoted
    Full,
}

impl Suite {
    fn name(self) -> &'static str {
        match self {
            Suite::Brief => "brief",
            Suite::Quick => "quick",
            Suite::Full => "full",
        }
    }

    /// Returns the number of pictures per mode and scene, and per feature.
    fn frames(self) -> usize {
        match self {
            Suite::Brief => 5,
            Suite::Quick => 20,
            Suite::Full => 200,
        }
    }

    /// Returns the number of edits per scene and mode, of radius 32 and 64.
    fn strokes(self) -> [usize; 2] {
        match self {
            Suite::Brief => [10, 5],
            Suite::Quick => [1000, 40],
            Suite::Full => [1000, 200],
        }
    }

    /// Returns the longest time per figure; slow modes then have fewer pictures.
    fn patience(self) -> Duration {
        match self {
            Suite::Brief => Duration::from_millis(100),
            Suite::Quick => Duration::from_secs(2),
            Suite::Full => Duration::from_secs(12),
        }
    }

    fn edits(self) -> usize {
        match self {
            Suite::Brief => 2,
            Suite::Quick => 40,
            Suite::Full => 200,
        }
    }

    /// Returns the samples of a final picture.
    fn final_samples(self) -> u32 {
        match self {
            Suite::Brief => 2,
            Suite::Quick => 2,
            Suite::Full => 64,
        }
    }

    fn files(self) -> usize {
        match self {
            Suite::Brief => 1,
            Suite::Quick => 3,
            Suite::Full => 10,
        }
    }
}

/// Smallest number of runs, however long they take.
const LEAST_RUNS: usize = 5;

/// A part that can be measured alone.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Only {
    Kernel(Kernel),
    /// The accuracy of normals.
    Normals,
    /// The growth of memory and times with the size of the grid.
    Sizes,
}

/// The arguments of [`run`].
#[derive(Debug)]
pub struct BenchJob {
    pub json: Option<PathBuf>,
    pub plot: Option<PathBuf>,
    pub suite: Suite,
    /// The modes to measure; empty for all.
    pub modes: Vec<RenderMode>,
    /// Measures nothing but this.
    pub only: Option<Only>,
    pub repeat: usize,
    /// Size of the pictures in pixels.
    pub size: UVec2,
    /// One or two.
    pub eyes: u32,
    /// Names of scenes and files; empty for the standard scenes.
    pub scenes: Vec<String>,
    pub import: ImportOptions,
}

/// The reason why a benchmark failed.
#[derive(Debug, Error)]
pub enum BenchError {
    #[error("cannot use {subject}: {}", told(error))]
    Subject { subject: String, error: FormatError },
    #[error("cannot measure files: {}", told(.0))]
    Files(FormatError),
    #[error("{}", told(.0))]
    Command(#[from] CommandError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error("{}", told(.0))]
    Grid(#[from] GridError),
    #[error(transparent)]
    Trace(#[from] TraceError),
    #[error("cannot write {path}: {error}")]
    Write { path: PathBuf, error: std::io::Error },
    #[error("cannot write the figures as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Measures, writes JSON and a plot if requested, and prints tables. Failing to write one of these
/// does not prevent the others.
pub fn run(
    job: &BenchJob,
    config: &Config,
    device: &DeviceOptions,
    progress: &dyn Progress,
) -> Result<(), BenchError> {
    match job.only {
        Some(Only::Kernel(kernel)) => return run_kernel(kernel, job, config, progress),
        Some(Only::Sizes) => return sizes::run(job, config, progress),
        Some(Only::Normals) => return Ok(terminal::print_result(normals::report(progress)?)?),
        None => {}
    }
    let device = Device::new(&mut Headless, device);
    let machine = Machine::survey(device.as_ref().map_err(|error| error.to_string()));
    let device = device.ok();
    let mut subjects: Vec<BenchSubject> =
        job.scenes.iter().map(|name| BenchSubject::of_name(name)).collect();
    if subjects.is_empty() || subjects.iter().all(|s| s.path().is_some()) {
        subjects = BenchSubject::STANDARD.into_iter().chain(subjects).collect();
    }
    // A bad file fails before minutes of measuring.
    for subject in subjects.iter().filter(|subject| subject.path().is_some()) {
        make(subject, job, config, progress)?;
    }
    let mut scenes = Vec::new();
    for subject in &subjects {
        scenes.push(measure_scene(subject, job, config, device.as_ref(), progress)?);
    }
    progress.begin("measuring edits");
    let mut edits = edits::edits(job.suite.edits(), config.limits())?;
    edits.extend(uses::uses(job.suite.edits(), config.limits())?);
    progress.end();
    let report = BenchReport {
        program: format!("virtual-sculpture {}", env!("CARGO_PKG_VERSION")),
        suite: job.suite.name().to_string(),
        machine,
        picture: job.size.to_array(),
        eyes: job.eyes,
        scenes,
        edits,
        peak_memory_bytes: machine::peak_memory_bytes(),
    };
    publish(job, serde_json::to_string_pretty(&report), plot::svg(&report), report.to_string())
}

/// Writes the figures as JSON and the plot if requested, and prints the table. Failing to write one of these does not
/// prevent the others.
fn publish(
    job: &BenchJob,
    json: Result<String, serde_json::Error>,
    plot: String,
    mut table: String,
) -> Result<(), BenchError> {
    let write = |path: &Option<PathBuf>, text: String| {
        let Some(path) = path else { return Ok(()) };
        store::write_atomically(path, text.as_bytes())
            .map_err(|error| BenchError::Write { path: path.clone(), error })
    };
    let json = match json {
        Ok(text) => write(&job.json, text + "\n"),
        Err(error) => Err(error.into()),
    };
    let plot = write(&job.plot, plot);
    for (path, written) in [(&job.json, &json), (&job.plot, &plot)] {
        if let (Some(path), Ok(())) = (path, written) {
            table += &format!("\nwrote {}", path.display());
        }
    }
    let printed = terminal::print_result(table).map_err(BenchError::from);
    json.and(plot).and(printed)
}

fn make(
    subject: &BenchSubject,
    job: &BenchJob,
    config: &Config,
    progress: &dyn Progress,
) -> Result<Document, BenchError> {
    progress.begin("making the scene");
    let made = subject.make(&job.import, config.limits(), progress);
    progress.end();
    made.map_err(|error| BenchError::Subject { subject: subject.name(), error })
}

fn run_kernel(
    kernel: Kernel,
    job: &BenchJob,
    config: &Config,
    progress: &dyn Progress,
) -> Result<(), BenchError> {
    let scenes = if job.scenes.is_empty() { &["cheese".to_string()][..] } else { &job.scenes };
    for name in scenes {
        let mut document = make(&BenchSubject::of_name(name), job, config, progress)?;
        if let Some(Times { min_ms, median_ms, p99_ms, .. }) =
            kernel::run(kernel, &mut document, job.size, job.repeat)
        {
            let times = format!("{min_ms:.3} {median_ms:.3} {p99_ms:.3} ms");
            terminal::print_result(format_args!("{name}: {times}: least, median, 99 of 100"))?;
        }
    }
    Ok(())
}

fn measure_scene(
    subject: &BenchSubject,
    job: &BenchJob,
    config: &Config,
    device: Option<&Arc<Device>>,
    progress: &dyn Progress,
) -> Result<SceneReport, BenchError> {
    let mut document = make(subject, job, config, progress)?;
    progress.begin("measuring pictures");
    let mut modes: Vec<ModeReport> = Vec::new();
    let wanted = |mode: &RenderMode| job.modes.is_empty() || job.modes.contains(mode);
    // One renderer for all modes, as in a window: compiled shaders and copies are kept.
    let mut pictures = None;
    for mode in RenderMode::ALL.into_iter().filter(wanted) {
        modes.extend(measure_mode(mode, &mut document, &mut pictures, job, config, device)?);
    }
    drop(pictures);
    let ray = modes.iter().find(|m| m.mode == mode_name(RenderMode::Ray));
    if let Some(ray_ms) = ray.map(|m| m.frame.median_ms) {
        modes.iter_mut().for_each(|m| m.to_ray = Some(m.frame.median_ms / ray_ms));
    }
    progress.end();
    let upload = match device {
        Some(device) => measure(5, || {
            let start = Instant::now();
            Volume::new(device, document.grid())?;
            Ok::<_, GpuError>(start.elapsed())
        })?,
        None => None,
    };
    progress.begin("tracing a final picture");
    let eye = subjects::eye_of(&document, job.size);
    let final_picture = final_pictures::final_picture(&document, &eye, job.suite)?;
    progress.end();
    progress.begin("measuring files");
    let contents = document.contents();
    // Few runs of the slow formats, which vary little.
    let (own, other): ([&str; 1], [&str; 1]) = (["vsc"], ["pvm"]);
    let limits = config.limits();
    let mut files =
        files::files(contents, &own, 5 * job.suite.files(), &limits).map_err(BenchError::Files)?;
    files.extend(
        files::files(contents, &other, job.suite.files(), &limits).map_err(BenchError::Files)?,
    );
    progress.end();
    let grid = document.grid();
    Ok(SceneReport {
        name: subject.name(),
        dims: grid.dims().to_array(),
        voxels: grid.opaque_count(),
        memory_bytes: grid.heap_bytes() + document.material().heap_bytes(),
        modes,
        upload,
        final_picture,
        files,
    })
}

/// Returns the name of a mode on the command line and in the settings.
fn mode_name(mode: RenderMode) -> String {
    mode.to_possible_value().map_or_else(String::new, |value| value.get_name().to_string())
}

fn measure_mode(
    mode: RenderMode,
    document: &mut Document,
    pictures: &mut Option<BenchPictures>,
    job: &BenchJob,
    config: &Config,
    device: Option<&Arc<Device>>,
) -> Result<Option<ModeReport>, BenchError> {
    let suite = job.suite;
    let eyes = eyes_of(document, job.size, job.eyes, &config.stereo);
    let scene = BenchScene { mode, eyes: &eyes, lighting: config.lighting() };
    if !pictures.as_mut().is_some_and(|pictures| pictures.turn_to(mode)) {
        *pictures = BenchPictures::new(&scene, document, device)?;
    }
    let Some(pictures) = pictures else { return Ok(None) };
    pictures.whole(document)?;
    let mut frames = Vec::new();
    let begun = Instant::now();
    while frames.len() < suite.frames()
        && (frames.len() < LEAST_RUNS || begun.elapsed() < suite.patience())
    {
        frames.push(pictures.whole(document)?);
    }
    let of = |stage: fn(&measured::StageTimes) -> Option<Duration>| {
        Times::of(&frames.iter().filter_map(stage).collect::<Vec<_>>())
    };
    let (Some(sample), Some(shade), Some(frame)) =
        (of(|f| Some(f.sample)), of(|f| Some(f.shade)), of(|f| Some(f.whole())))
    else {
        return Ok(None);
    };
    let of_device = |stage: fn(&DeviceTimes) -> Option<f32>| {
        let ms = frames.iter().filter_map(|f| stage(&f.device));
        let times: Vec<Duration> = ms.map(|ms| Duration::from_secs_f32(ms * 1e-3)).collect();
        Times::of(&times)
    };
    let lighting = config.lighting();
    let features = features::features(mode, &lighting, document, pictures, suite)?;
    let [strokes_32, strokes_64] = suite.strokes();
    let mut edits = |radius, strokes| {
        edits::edit_to_image(document, pictures, radius, strokes, suite.patience())
    };
    let (edit_32, edit_64) = (edits(32.0, strokes_32)?, edits(64.0, strokes_64)?);
    Ok(Some(ModeReport {
        mode: mode_name(mode),
        sample,
        read_back: of(|f| f.read_back),
        shade,
        composite: of(|f| f.composite),
        frame,
        to_ray: None,
        device: DeviceReport {
            sample: of_device(|d| d.sample_ms),
            shade: of_device(|d| d.shade_ms),
            compose: of_device(|d| d.compose_ms),
        },
        features,
        edit_32: edit_32.map(|edit| edit.shaded),
        edit_32_composite: edit_32.and_then(|edit| edit.composite),
        edit_64: edit_64.map(|edit| edit.shaded),
        edit_64_composite: edit_64.and_then(|edit| edit.composite),
    }))
}
