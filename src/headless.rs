//! Owns the jobs that need no screen: render, run, convert, info, demo, and the list of commands.
//!
//! Results go to stdout as one fact a line; progress and errors to stderr. Files are written before
//! anything is said of them, so that nobody's not listening costs one.

use std::path::{Path, PathBuf};

use glam::{UVec2, UVec3};
use thiserror::Error;

use crate::app::AppError;
use crate::bench::BenchError;
use crate::cli::PictureArgs;
use crate::command::{COMMANDS, Command};
use crate::command_text::{ScriptError, parse_script};
use crate::config::{Config, ConfigError};
use crate::document::Document;
use crate::fiducial::{family, sheet};
use crate::format::options::{ExportForm, ImportOptions};
use crate::format::{self, FormatError, store};
use crate::picture::{self, PictureError};
use crate::progress::Progress;
use crate::say::{self, Unsaid};
use crate::session::{Session, SessionError};
use crate::track::TrackError;
use crate::track::source::SourceError;

/// A scene that the program builds from a script.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, clap::ValueEnum)]
pub enum DemoScene {
    /// An island made of solids
    #[default]
    Island,
    /// The learning task of the evaluation of 2005
    LearningTask,
    /// Its main task: a house, a tree, a lake and a hill
    Landscape,
}

impl DemoScene {
    pub const ALL: [DemoScene; 3] =
        [DemoScene::Island, DemoScene::LearningTask, DemoScene::Landscape];

    /// Name of the files that it is written to.
    pub const fn name(self) -> &'static str {
        match self {
            DemoScene::Island => "demo",
            DemoScene::LearningTask => "learning-task",
            DemoScene::Landscape => "house-tree-lake-hill",
        }
    }

    pub const fn script(self) -> &'static str {
        match self {
            DemoScene::Island => include_str!("../config/demo.sculpt"),
            DemoScene::LearningTask => include_str!("../config/evaluation/learning-task.sculpt"),
            DemoScene::Landscape => {
                include_str!("../config/evaluation/house-tree-lake-hill.sculpt")
            }
        }
    }
}

/// Why a job failed.
#[derive(Debug, Error)]
pub enum JobError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error("cannot read {path}: {error}")]
    Info { path: PathBuf, error: FormatError },
    #[error("cannot read the script {path}: {error}")]
    ReadScript { path: PathBuf, error: std::io::Error },
    #[error("script {path}, {error}")]
    Script { path: PathBuf, error: ScriptError },
    #[error("script {path}, line {line} (`{command}`): {error}")]
    Command { path: PathBuf, line: usize, command: String, error: Box<SessionError> },
    #[error("cannot create the folder {path}: {error}")]
    Folder { path: PathBuf, error: std::io::Error },
    #[error(transparent)]
    Picture(#[from] PictureError),
    #[error(transparent)]
    App(#[from] AppError),
    #[error(transparent)]
    Track(#[from] TrackError),
    #[error("there is no marker {0}; use 0 to {last}", last = family::COUNT - 1)]
    NoMarker(u32),
    #[error("cannot write {path}: {error}")]
    WriteMarker { path: PathBuf, error: std::io::Error },
    #[error(transparent)]
    Bench(#[from] BenchError),
    #[error(transparent)]
    Unsaid(#[from] Unsaid),
    #[error(
        "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); `render`, `run`, `convert`, `info`, `demo` and `bench` need none"
    )]
    NoDisplay,
}

impl JobError {
    /// The exit code that [`crate::cli`] promises for this error.
    pub fn exit_code(&self) -> u8 {
        match self {
            JobError::Config(_)
            | JobError::Session(SessionError::Open { .. })
            | JobError::Info { .. }
            | JobError::ReadScript { .. }
            | JobError::Script { .. }
            | JobError::Command { .. }
            | JobError::Bench(BenchError::Subject { .. })
            | JobError::Track(TrackError::Source(
                SourceError::ReadScript(..) | SourceError::Script(..),
            )) => 3,
            JobError::Track(TrackError::NoSource) | JobError::NoMarker(_) => 2,
            JobError::Picture(PictureError::Gpu(_))
            | JobError::App(AppError::EventLoop(_) | AppError::Window(_) | AppError::Gpu(_))
            | JobError::NoDisplay => 4,
            JobError::Session(_)
            | JobError::Folder { .. }
            | JobError::WriteMarker { .. }
            | JobError::Track(_)
            | JobError::Picture(_)
            | JobError::Bench(_)
            | JobError::Unsaid(_)
            | JobError::App(_) => 1,
        }
    }

    /// Whether nothing went wrong, but nobody reads the results any more.
    pub fn is_reader_gone(&self) -> bool {
        use JobError::{Bench, Track, Unsaid as Own};
        matches!(
            self,
            Own(Unsaid::ReaderGone)
                | Bench(BenchError::Unsaid(Unsaid::ReaderGone))
                | Track(TrackError::Unsaid(Unsaid::ReaderGone))
        )
    }
}

/// Renders a file to a picture.
pub fn render(
    file: &Path,
    out: &Path,
    picture: &PictureArgs,
    import: &ImportOptions,
    config: &Config,
    progress: &dyn Progress,
) -> Result<(), JobError> {
    let session = Session::open(file, import, config.limits(), progress)?;
    render_session(session, out, picture, config)
}

/// Draws a marker whose black square is `size_mm` wide: an SVG where the name says so, else a PNG.
pub fn marker(id: u32, size_mm: f64, out: &Path) -> Result<(), JobError> {
    let is_svg = out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    let drawing = match is_svg {
        true => sheet::svg(id, size_mm).map(String::into_bytes),
        false => sheet::png(id, size_mm),
    };
    let drawing = drawing.ok_or(JobError::NoMarker(id))?;
    store::write_atomically(out, &drawing)
        .map_err(|error| JobError::WriteMarker { path: out.into(), error })?;
    let side_mm = sheet::side_mm(size_mm);
    let out = out.display();
    say::done(format_args!("{out}: marker {id}; print it {side_mm} mm wide, its paper included"));
    Ok(())
}

/// Carries out a script; saves and renders the result where asked.
pub fn run(job: &RunJob, config: &Config, progress: &dyn Progress) -> Result<(), JobError> {
    let text = store::read_text(&job.script)
        .map_err(|error| JobError::ReadScript { path: job.script.clone(), error })?;
    let mut session = match &job.input {
        Some(input) => Session::open(input, &job.import, config.limits(), progress)?,
        None => Session::new(&config.new_sculpture(), config.limits())?,
    };
    execute_script(&mut session, &text, &job.script, progress)?;
    if let Some(output) = &job.output {
        save(&mut session, output, ExportForm::Auto, progress)?;
    }
    describe(session.document());
    match &job.render {
        Some(picture) => render_session(session, picture, &job.picture, config),
        None => Ok(()),
    }
}

/// What `run` is asked to do.
#[derive(Debug)]
pub struct RunJob {
    pub script: PathBuf,
    pub input: Option<PathBuf>,
    pub output: Option<PathBuf>,
    pub render: Option<PathBuf>,
    pub picture: PictureArgs,
    pub import: ImportOptions,
}

/// Reads a file and writes it in the form that the name of `output` asks for.
pub fn convert(
    input: &Path,
    output: &Path,
    form: ExportForm,
    import: &ImportOptions,
    config: &Config,
    progress: &dyn Progress,
) -> Result<(), JobError> {
    let mut session = Session::open(input, import, config.limits(), progress)?;
    save(&mut session, output, form, progress)?;
    describe(session.document());
    Ok(())
}

/// Says what a file holds.
pub fn info(
    file: &Path,
    import: &ImportOptions,
    config: &Config,
    progress: &dyn Progress,
) -> Result<(), JobError> {
    let failed = |error| JobError::Info { path: file.to_path_buf(), error };
    let info = format::info_with(file, import, &config.limits(), progress).map_err(failed)?;
    Ok(say::result(info)?)
}

/// Builds a scene and writes a picture and the sculpture into `folder`.
pub fn demo(
    scene: DemoScene,
    folder: &Path,
    picture: &PictureArgs,
    config: &Config,
    progress: &dyn Progress,
) -> Result<(), JobError> {
    std::fs::create_dir_all(folder)
        .map_err(|error| JobError::Folder { path: folder.to_path_buf(), error })?;
    let mut session = Session::new(&config.new_sculpture(), config.limits())?;
    let file = |ending: &str| format!("{}.{ending}", scene.name());
    execute_script(&mut session, scene.script(), Path::new(&file("sculpt")), progress)?;
    save(&mut session, &folder.join(file("vsc")), ExportForm::Auto, progress)?;
    describe(session.document());
    render_session(session, &folder.join(file("png")), picture, config)
}

/// Prints the commands that scripts know.
pub fn commands() -> Result<(), JobError> {
    for command in COMMANDS {
        let (verb, usage, tooltip) = (command.verb, command.usage, command.tooltip);
        say::result(format_args!("{verb} {usage}\n    {tooltip}"))?;
    }
    Ok(())
}

fn execute_script(
    session: &mut Session,
    text: &str,
    path: &Path,
    progress: &dyn Progress,
) -> Result<(), JobError> {
    let commands =
        parse_script(text).map_err(|error| JobError::Script { path: path.to_path_buf(), error })?;
    let count = commands.len().max(1) as f32;
    progress.begin("running the script");
    for (i, (line, command)) in commands.iter().enumerate() {
        session.execute(command, &()).map_err(|error| JobError::Command {
            path: path.to_path_buf(),
            line: *line,
            command: command.to_string(),
            error: Box::new(error),
        })?;
        progress.advance(i as f32 / count);
    }
    progress.end();
    Ok(())
}

fn save(
    session: &mut Session,
    path: &Path,
    form: ExportForm,
    progress: &dyn Progress,
) -> Result<(), JobError> {
    session.execute(&Command::Save { path: path.to_path_buf(), form }, progress)?;
    say::done(format_args!("wrote {}", path.display()));
    Ok(())
}

fn render_session(
    mut session: Session,
    out: &Path,
    arguments: &PictureArgs,
    config: &Config,
) -> Result<(), JobError> {
    let view = picture::View {
        size: arguments.size,
        mode: arguments.mode.or(config.render.mode).unwrap_or_default(),
        direction: arguments.camera,
        up: arguments.up,
        turn_rad: arguments.turn.to_radians(),
        zoom: arguments.zoom,
        fov_y_rad: config.render.fov_deg.to_radians(),
        stereo: arguments.stereo.unwrap_or(config.stereo.layout),
    };
    for name in picture::render_to_file(session.document_mut(), &view, config, out)? {
        let UVec2 { x, y } = view.size;
        say::done(format_args!("wrote {} ({x}x{y})", name.display()));
    }
    Ok(())
}

fn describe(document: &Document) {
    let (grid, material) = (document.grid(), document.material());
    let UVec3 { x, y, z } = grid.dims();
    say::done(format_args!(
        "sculpture {x}x{y}x{z}, {} of {} voxels, {} bits of colour, {} painted bricks",
        grid.opaque_count(),
        u64::from(x) * u64::from(y) * u64::from(z),
        material.depth().bits(),
        material.page_count()
    ));
}
