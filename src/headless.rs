//! The jobs that need no screen: render, run, recover, convert, info, check, demo, and the list of commands.
//!
//! Results go to stdout, one fact per line; progress and errors to stderr. Files are written before
//! they are reported, so that a closed stdout costs none.

mod check;
mod info;
mod pipe;
mod recover;
mod run;

use std::path::{Path, PathBuf};

use glam::{UVec2, UVec3, Vec3};
use thiserror::Error;

use crate::command::text::{ScriptError, parse_script};
use crate::command::{COMMANDS, Command, NewSculpture};
use crate::config::Config;
use crate::document::Document;
use crate::fiducial::{family, sheet};
use crate::format::options::{ExportForm, ExportOptions, ImportOptions};
use crate::format::{self, FormatError, MeshOptions, store};
use crate::gpu::DeviceOptions;
use crate::mesh::MeshKind;
use crate::persist::journal::JournalError;
use crate::picture::{self, FinalOptions, FinalPicture, PictureError, TraceOn};
use crate::print_check::CheckError;
use crate::progress::Progress;
use crate::remedy::told;
use crate::render::RenderMode;
use crate::sculpture::Rgb;
use crate::session::{Session, SessionError};
use crate::shade::Ground;
use crate::shade::ground::line_spacing_vx;
use crate::terminal::{self, OutputError};
use crate::trace::TraceCamera;
use crate::view::StereoLayout;

pub use check::check;
pub use info::info;
pub use recover::{RecoverJob, recover};
pub use run::{RunJob, run};

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

    /// Base name of its files.
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

/// The values used by every job.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    pub config: &'a Config,
    /// The device to make for render modes that need one.
    pub device: &'a DeviceOptions,
    pub progress: &'a dyn Progress,
}

impl Context<'_> {
    /// Returns a session with the new sculpture of the settings, in a box that fits it: scripts say if it should grow.
    pub fn new_session(&self) -> Result<Session, SessionError> {
        let new = NewSculpture { room_vx: 0, grows: false, ..self.config.new_sculpture() };
        Session::new(&new, self.config.limits())
    }

    /// Returns a session with the contents of a file.
    pub fn open_session(
        &self,
        file: &Path,
        import: &ImportOptions,
    ) -> Result<Session, SessionError> {
        Session::open(file, import, self.config.limits(), self.progress)
    }
}

/// A picture of the sculpture to render.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PictureRequest {
    /// Pixels.
    pub size: UVec2,
    /// `None`: the mode of the settings.
    pub mode: Option<RenderMode>,
    /// Shows the voxels' cubes instead of the smooth surface, whatever the settings say.
    pub voxels: bool,
    /// From the centre to the eye.
    pub camera: Vec3,
    /// The axis of the grid that points up in the picture.
    pub up: Vec3,
    /// The angle by which the sculpture is turned about `up`.
    pub turn_deg: f32,
    /// 1 fits the whole sculpture.
    pub zoom: f32,
    /// Uses parallel projection.
    pub orthographic: bool,
    /// `None`: the layout of the settings.
    pub stereo: Option<StereoLayout>,
    /// The colour of the ground, if there is one.
    pub ground: Option<Rgb>,
    /// The picture is the mean of so many; 1: without antialiasing.
    pub samples: u32,
}

impl PictureRequest {
    /// From the upper right in front: the view in which most shapes are easiest to read.
    pub const THREE_QUARTER: Vec3 = Vec3::new(0.8, 0.6, 1.0);

    /// Returns the view, with the settings for everything that the request leaves open.
    pub fn view(&self, config: &Config) -> picture::PictureView {
        picture::PictureView {
            size: self.size,
            mode: self.mode.or(config.render.mode).unwrap_or_default(),
            smooth_surface: config.render.smooth_surface && !self.voxels,
            direction: self.camera,
            up: self.up,
            turn_rad: self.turn_deg.to_radians(),
            zoom: self.zoom,
            orthographic: self.orthographic,
            fov_y_rad: config.render.fov_deg.to_radians(),
            stereo: self.stereo.unwrap_or(config.stereo.layout),
            ground: self.ground.map(|colour| Ground {
                up: self.up,
                colour,
                shadow_only: false,
                sun_deg: config.light.sun_deg,
                sample: 0,
            }),
            samples: self.samples,
        }
    }
}

impl Default for PictureRequest {
    fn default() -> Self {
        PictureRequest {
            size: UVec2::new(640, 480),
            mode: None,
            voxels: false,
            camera: PictureRequest::THREE_QUARTER,
            up: Vec3::Y,
            turn_deg: 0.0,
            zoom: 1.0,
            orthographic: false,
            stereo: None,
            ground: None,
            samples: 1,
        }
    }
}

/// The reason why a job failed.
#[derive(Debug, Error)]
pub enum JobError {
    #[error("{}", told(.0))]
    Session(#[from] SessionError),
    #[error("cannot read {path}: {}", told(error))]
    Info { path: PathBuf, error: FormatError },
    #[error("cannot read the script {path}: {error}")]
    ReadScript { path: PathBuf, error: std::io::Error },
    #[error("script {path}, {error}")]
    Script { path: PathBuf, error: ScriptError },
    #[error("script {path}, line {line} (`{command}`): {}", told(error))]
    Command { path: PathBuf, line: usize, command: String, error: Box<SessionError> },
    #[error("cannot read commands from the standard input: {0}")]
    Input(std::io::Error),
    #[error("{0} of the commands from the standard input failed; their answers say why")]
    Refused(usize),
    #[error(
        "nobody reads the answers any more: only the lines of the standard input up to {0} were executed (`--out` saves their result)"
    )]
    Unheard(usize),
    #[error("there is no journal {0}; `virtual-sculpture recover` lists what was left")]
    NoJournal(u64),
    #[error("journal {0} belongs to a session that is still running")]
    JournalInUse(u64),
    #[error("{0} already exists, and recovery overwrites nothing; choose another name")]
    OutExists(PathBuf),
    #[error("cannot use the journal {path}: {error}")]
    Journal { path: PathBuf, error: std::io::Error },
    #[error("nothing can be recovered from {path}: {}", told(error))]
    Unrecoverable { path: PathBuf, error: JournalError },
    #[error(
        "{out} was written, but it may differ from the original: {difference}; journal {number} is kept"
    )]
    ReplayDiffers { out: PathBuf, number: u64, difference: String },
    #[error("cannot create the folder {path}: {error}")]
    Folder { path: PathBuf, error: std::io::Error },
    #[error("{}", told(.0))]
    Check(#[from] CheckError),
    #[error("it cannot be printed as it is; the findings say why")]
    NotPrintable,
    #[error(transparent)]
    Picture(#[from] PictureError),
    #[error("there is no marker {0}; use 0 to {last}", last = family::COUNT - 1)]
    NoMarker(u32),
    #[error("cannot write {path}: {error}")]
    WriteMarker { path: PathBuf, error: std::io::Error },
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Renders a file to a picture.
pub fn render(
    file: &Path,
    out: &Path,
    picture: &PictureRequest,
    import: &ImportOptions,
    context: &Context,
) -> Result<(), JobError> {
    let session = context.open_session(file, import)?;
    render_session(session, out, picture, context)
}

/// Renders a file to a final picture, by path tracing on the CPU or on a device.
pub fn render_final(
    file: &Path,
    out: &Path,
    request: &PictureRequest,
    (options, on_gpu): (&FinalOptions, bool),
    import: &ImportOptions,
    context: &Context,
) -> Result<(), JobError> {
    let session = context.open_session(file, import)?;
    let (view, document) = (request.view(context.config), session.document());
    let placement = view.placement(document);
    let camera =
        TraceCamera { eye: placement.eye, world_from_grid: placement.world_from_grid, up: view.up };
    let on = if on_gpu { TraceOn::Gpu(context.device.clone()) } else { TraceOn::Cpu };
    let options = FinalOptions { smooth_surface: view.smooth_surface, ..*options };
    let contents = document.contents();
    let picture = FinalPicture { contents, camera: &camera, options: &options, on: &on };
    picture::write_final(picture, out, context.progress, &mut |_, _| {})?;
    let UVec2 { x, y } = view.size;
    terminal::print_done(format_args!("wrote {} ({x}x{y})", out.display()));
    Ok(())
}

/// Draws a marker whose black square is `size_mm` wide, as an SVG if the name has that extension, otherwise a PNG.
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
    terminal::print_done(format_args!(
        "{out}: marker {id}; print it {side_mm} mm wide, its paper included"
    ));
    Ok(())
}

/// The options of [`convert`] for meshes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MeshRequest {
    /// Its surface; `None`: the one that the sculpture shows.
    pub kind: Option<MeshKind>,
    /// All other options.
    pub options: MeshOptions,
}

/// Converts a file to the format of the extension of `output`, with the options of `mesh` if that is one.
pub fn convert(
    input: &Path,
    output: &Path,
    form: ExportForm,
    mesh: Option<MeshRequest>,
    import: &ImportOptions,
    context: &Context,
) -> Result<(), JobError> {
    let mut session = context.open_session(input, import)?;
    match mesh {
        Some(MeshRequest { kind, options }) => {
            let (contents, limits) = (session.document().contents(), context.config.limits());
            let kind = kind.unwrap_or(format::usual_surface(contents.surface));
            let options = MeshOptions { kind, ..options };
            let written = format::save_mesh(output, contents, &options, &limits, context.progress);
            let failed = |error| SessionError::Save { path: output.to_path_buf(), error };
            let summary = written.map_err(failed)?;
            terminal::print_done(format_args!("wrote {} ({summary})", output.display()));
        }
        None => save(&mut session, output, form, context.progress)?,
    }
    describe(session.document());
    Ok(())
}

/// Builds a scene and writes a picture and the sculpture into `folder`.
pub fn demo(
    scene: DemoScene,
    folder: &Path,
    picture: &PictureRequest,
    context: &Context,
) -> Result<(), JobError> {
    std::fs::create_dir_all(folder)
        .map_err(|error| JobError::Folder { path: folder.to_path_buf(), error })?;
    let mut session = context.new_session()?;
    let file = |ending: &str| format!("{}.{ending}", scene.name());
    execute_script(&mut session, scene.script(), Path::new(&file("sculpt")), context.progress)?;
    save(&mut session, &folder.join(file("vsc")), ExportForm::Auto, context.progress)?;
    describe(session.document());
    render_session(session, &folder.join(file("png")), picture, context)
}

/// Prints the commands for scripts.
pub fn commands() -> Result<(), JobError> {
    for command in COMMANDS.iter() {
        let (verb, usage, tooltip) = (command.verb, &command.usage, &command.tooltip);
        terminal::print_result(format_args!("{verb} {usage}\n    {tooltip}"))?;
    }
    Ok(())
}

/// Returns the text of a script.
pub fn read_script(path: &Path) -> Result<String, JobError> {
    store::read_text(path).map_err(|error| JobError::ReadScript { path: path.to_path_buf(), error })
}

/// Returns the commands of a script, with their lines; `path` is for messages.
pub fn script_commands(text: &str, path: &Path) -> Result<Vec<(usize, Command)>, JobError> {
    parse_script(text).map_err(|error| JobError::Script { path: path.to_path_buf(), error })
}

/// Executes a command of the script at `path`.
pub fn execute_command(
    session: &mut Session,
    (line, command): &(usize, Command),
    path: &Path,
) -> Result<(), JobError> {
    session.execute(command, &()).map(drop).map_err(|error| JobError::Command {
        path: path.to_path_buf(),
        line: *line,
        command: command.to_string(),
        error: Box::new(error),
    })
}

fn execute_script(
    session: &mut Session,
    text: &str,
    path: &Path,
    progress: &dyn Progress,
) -> Result<(), JobError> {
    let commands = script_commands(text, path)?;
    let count = commands.len().max(1) as f32;
    progress.begin("running the script");
    for (i, command) in commands.iter().enumerate() {
        execute_command(session, command, path)?;
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
    let mut export = ExportOptions::from(form);
    if format::is_mesh(path) {
        export.mesh.kind = format::usual_surface(session.document().contents().surface);
    }
    session.execute(&Command::Save { path: path.to_path_buf(), export }, progress)?;
    terminal::print_done(format_args!("wrote {}", path.display()));
    Ok(())
}

fn render_session(
    mut session: Session,
    out: &Path,
    request: &PictureRequest,
    context: &Context,
) -> Result<(), JobError> {
    let view = request.view(context.config);
    let options = context.config.picture_options(context.device);
    for name in picture::render_to_file(session.document_mut(), &view, &options, out)? {
        let UVec2 { x, y } = view.size;
        terminal::print_done(format_args!("wrote {} ({x}x{y})", name.display()));
    }
    if view.ground.is_some() {
        let spacing = line_spacing_vx(session.document().grid().dims());
        terminal::print_done(format_args!("lines on the ground: every {spacing} voxels"));
    }
    Ok(())
}

fn describe(document: &Document) {
    let (grid, material) = (document.grid(), document.material());
    let UVec3 { x, y, z } = grid.dims();
    terminal::print_done(format_args!(
        "sculpture {x}x{y}x{z}, {} of {} voxels, {} bits of colour, {} painted bricks",
        grid.opaque_count(),
        u64::from(x) * u64::from(y) * u64::from(z),
        material.depth().bits(),
        material.page_count()
    ));
}
