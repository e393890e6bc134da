//! Owns the command line: arguments in, one of the jobs out, an exit code at the end.
//!
//! Exit codes: 0 done, 1 the job failed, 2 wrong arguments, 3 an input file, script or
//! configuration cannot be used, 4 no usable Vulkan device or display. Results are said on
//! stdout, everything else on stderr.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use glam::Vec3;

use crate::app;
use crate::bench::{self, BenchJob, Kernel, Suite};
use crate::config::{Config, Profile, RenderMode};
use crate::doctor;
use crate::format::options::{Colouring, Existence, ExportForm, ImportOptions, RawLayout};
use crate::headless::{self, DemoScene, JobError, RunJob};
use crate::progress_bar::Bar;
use crate::say;
use crate::sculpture::ColourDepth;
use crate::session::Session;
use crate::track::{self, TrackArgs};
use crate::view::StereoLayout;

/// Shape a block of voxels as a sculptor shapes stone.
#[derive(Parser, Debug)]
#[command(version, about, long_about = None)]
pub struct Cli {
    /// Sculpture or volume to open in the window (.vsc, .pvm)
    pub file: Option<PathBuf>,
    /// Settings instead of those in ~/.config/virtual-sculpture/config.toml
    #[arg(long, global = true, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Settings for a way of working, under your own
    #[arg(long, global = true, value_enum)]
    pub profile: Option<Profile>,
    /// Write every command of the window to a script, to be replayed with `run`
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Work in a headset, beside the window or without one
    #[arg(long)]
    pub headset: bool,
    /// Write what the eyes in the headset see to this folder, now and then (for developers)
    #[arg(long, value_name = "DIR")]
    pub headset_shots: Option<PathBuf>,
    /// Say nothing but errors and results
    #[arg(long, short, global = true)]
    pub quiet: bool,
    #[command(flatten)]
    pub import: ImportArgs,
    #[command(subcommand)]
    pub job: Option<Job>,
}

#[derive(Subcommand, Debug)]
pub enum Job {
    /// Render a file to a PNG, without a display
    Render {
        file: PathBuf,
        /// The PNG to write
        #[arg(long)]
        out: PathBuf,
        #[command(flatten)]
        picture: PictureArgs,
        #[command(flatten)]
        import: ImportArgs,
    },
    /// Carry out a script of commands, without a display
    Run {
        /// One command a line; see `virtual-sculpture commands`
        script: PathBuf,
        /// Sculpture or volume to begin with
        #[arg(long = "in", value_name = "FILE")]
        input: Option<PathBuf>,
        /// Where to save the result
        #[arg(long = "out", value_name = "FILE")]
        output: Option<PathBuf>,
        /// Also render the result to this PNG
        #[arg(long, value_name = "PNG")]
        render: Option<PathBuf>,
        #[command(flatten)]
        picture: PictureArgs,
        #[command(flatten)]
        import: ImportArgs,
    },
    /// Read a file and write it in another form
    Convert {
        input: PathBuf,
        output: PathBuf,
        /// What is written: auto, densities, rgba or packed
        #[arg(long, default_value_t, value_name = "FORM")]
        form: ExportForm,
        #[command(flatten)]
        import: ImportArgs,
    },
    /// Say what a file holds
    Info {
        file: PathBuf,
        #[command(flatten)]
        import: ImportArgs,
    },
    /// Build a scene with a script, render it and save it
    Demo {
        #[arg(long, value_enum, default_value_t)]
        scene: DemoScene,
        /// Folder for the picture and the sculpture (made if missing)
        #[arg(long, default_value = "out", value_name = "DIR")]
        out: PathBuf,
        #[command(flatten)]
        picture: PictureArgs,
    },
    /// Show the poses of a tracker, or serve them by VRPN
    Track(TrackArgs),
    /// Draw a marker for the sculpture to stand on, to be printed
    Marker {
        /// The PNG or SVG to write
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Its number, 0 to 29
        #[arg(long, default_value_t = 0)]
        id: u32,
        /// Width of its black square in millimetres
        #[arg(long, default_value_t = 80.0, value_name = "MM", value_parser = parse_marker_mm)]
        size_mm: f64,
    },
    /// Measure pictures, edits and files on this machine
    Bench {
        /// Write the figures to this file
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
        /// Draw modes against scenes to this SVG
        #[arg(long, value_name = "SVG")]
        plot: Option<PathBuf>,
        #[arg(long, value_enum, default_value_t)]
        suite: Suite,
        /// Measure pictures of this mode alone; may be given several times
        #[arg(long = "mode", value_enum, value_name = "MODE")]
        modes: Vec<RenderMode>,
        /// Run this kernel alone, for tools that count instructions
        #[arg(long, value_enum)]
        kernel: Option<Kernel>,
        /// How often to run the kernel
        #[arg(long, default_value_t = 1, value_name = "N", requires = "kernel")]
        repeat: usize,
        /// Pixels of the pictures
        #[arg(long, default_value = "640x480", value_name = "WxH", value_parser = parse_size)]
        size: glam::UVec2,
        /// Pictures made at once: 1, or 2 for the two eyes of a stereo picture
        #[arg(long, default_value_t = 1, value_name = "1|2", conflicts_with = "kernel",
              value_parser = clap::value_parser!(u32).range(1..=2))]
        eyes: u32,
        /// Scenes (cube, engine, cheese, gyroid) and files to measure with
        scenes: Vec<String>,
        #[command(flatten)]
        import: ImportArgs,
    },
    /// List the commands of scripts
    Commands,
    /// Say what this machine offers: Vulkan devices, gamepads, cameras, OpenXR, settings
    Doctor,
}

/// Reads arguments. Those of the window are refused beside a job, those of all jobs stand anywhere.
fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Cli, clap::Error> {
    let mut command = Cli::command();
    let matches = command.try_get_matches_from_mut(arguments)?;
    if let Some(job) = matches.subcommand_name() {
        let given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
        let mut own = command.get_arguments().filter(|argument| !argument.is_global_set());
        let refused = own.find(|argument| given(argument.get_id().as_str())).map(|argument| {
            format!("'{argument}' before '{job}' is for the window; see '{job} --help'")
        });
        drop(own);
        if let Some(text) = refused {
            return Err(command.error(ErrorKind::ArgumentConflict, text));
        }
    }
    Cli::from_arg_matches(&matches)
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    let cli = match parse(std::env::args_os()) {
        Ok(cli) => cli,
        Err(words) => return refuse(&words),
    };
    say::begin_log(cli.quiet);
    match dispatch(cli) {
        Err(error) if !error.is_reader_gone() => {
            say::aside(format_args!("error: {error}"));
            ExitCode::from(error.exit_code())
        }
        _ => ExitCode::SUCCESS,
    }
}

/// Says what clap has to say: help and version, which are results, or what is wrong.
fn refuse(words: &clap::Error) -> ExitCode {
    let unsaid = words.print().is_err_and(|error| error.kind() != std::io::ErrorKind::BrokenPipe);
    match words.exit_code() {
        0 => ExitCode::from(u8::from(unsaid)),
        code => ExitCode::from(u8::try_from(code).unwrap_or(2)),
    }
}

/// Without a job: the window where there is a display; elsewhere, unless a file was named, the
/// demo, so that the program shows what it does on any machine.
fn window_or_demo(cli: Cli, config: Config, progress: &Bar) -> Result<(), JobError> {
    let set = |name| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    let display =
        cfg!(not(unix)) || cfg!(target_os = "macos") || set("DISPLAY") || set("WAYLAND_DISPLAY");
    let mut config = config;
    config.headset.enabled |= cli.headset;
    if display || config.headset.enabled {
        let mut session = match &cli.file {
            Some(file) => Session::open(file, &cli.import.options(), config.limits(), progress)?,
            None => Session::new(&config.new_sculpture(), config.limits())?,
        };
        if let Some(record) = &cli.record {
            session.record_to(record)?;
        }
        match display {
            true => app::run(session, config, cli.headset_shots)?,
            false => app::headset::alone::run(session, &config, cli.headset_shots)?,
        }
        return Ok(());
    }
    if cli.file.is_some() || cli.record.is_some() {
        return Err(JobError::NoDisplay);
    }
    say::aside("no display: making the demo instead; see `virtual-sculpture --help` for more");
    headless::demo(
        DemoScene::default(),
        Path::new("out"),
        &PictureArgs::default(),
        &config,
        progress,
    )
}

fn dispatch(cli: Cli) -> Result<(), JobError> {
    let config = Config::load_over(cli.profile, cli.config.as_deref())?;
    let progress = Bar::new(cli.quiet);
    match cli.job {
        Some(Job::Render { file, out, picture, import }) => {
            headless::render(&file, &out, &picture, &import.options(), &config, &progress)
        }
        Some(Job::Run { script, input, output, render, picture, import }) => {
            let import = import.options();
            let job = RunJob { script, input, output, render, picture, import };
            headless::run(&job, &config, &progress)
        }
        Some(Job::Convert { input, output, form, import }) => {
            headless::convert(&input, &output, form, &import.options(), &config, &progress)
        }
        Some(Job::Info { file, import }) => {
            headless::info(&file, &import.options(), &config, &progress)
        }
        Some(Job::Demo { scene, out, picture }) => {
            headless::demo(scene, &out, &picture, &config, &progress)
        }
        Some(Job::Track(args)) => Ok(track::run(&args, &config)?),
        Some(Job::Marker { out, id, size_mm }) => headless::marker(id, size_mm, &out),
        Some(Job::Bench {
            json,
            plot,
            suite,
            modes,
            kernel,
            repeat,
            size,
            eyes,
            scenes,
            import,
        }) => {
            let import = import.options();
            let job =
                BenchJob { json, plot, suite, modes, kernel, repeat, size, eyes, scenes, import };
            Ok(bench::run(&job, &config, &progress)?)
        }
        Some(Job::Commands) => headless::commands(),
        Some(Job::Doctor) => Ok(say::result(doctor::report())?),
        None => window_or_demo(cli, config, &progress),
    }
}

/// How a file becomes a sculpture.
#[derive(Args, Debug, Clone)]
pub struct ImportArgs {
    /// Densities from this on exist: auto, or a number in the units of the file
    #[arg(long, default_value_t, value_name = "DENSITY")]
    pub threshold: Existence,
    /// Colours of the voxels: auto, none, grey, tissue or packed
    #[arg(long, default_value_t, value_name = "HOW")]
    pub colouring: Colouring,
    /// Bits of colour a voxel: 0, 8, 16 or 24 (default: as the file has)
    #[arg(long, value_name = "BITS", value_parser = parse_colour_bits)]
    pub colour_bits: Option<ColourDepth>,
    /// What a raw file holds: WIDTHxHEIGHTxDEPTH:TYPE[:skip=BYTES][:size=SX,SY,SZ]
    #[arg(long, value_name = "LAYOUT")]
    pub raw: Option<RawLayout>,
}

impl ImportArgs {
    pub fn options(&self) -> ImportOptions {
        ImportOptions {
            existence: self.threshold,
            colouring: self.colouring,
            colour_depth: self.colour_bits,
            raw: self.raw,
        }
    }
}

fn parse_colour_bits(text: &str) -> Result<ColourDepth, String> {
    let depth = text.parse().ok().and_then(ColourDepth::from_bits);
    depth.ok_or_else(|| "take 0, 8, 16 or 24".to_string())
}

/// How to look at the sculpture and what picture to make.
#[derive(Args, Debug, Clone)]
pub struct PictureArgs {
    /// Picture size in pixels
    #[arg(long, default_value = "640x480", value_name = "WxH", value_parser = parse_size)]
    pub size: glam::UVec2,
    /// How the surface is sampled (default: render.mode of the configuration)
    #[arg(long, value_enum)]
    pub mode: Option<RenderMode>,
    /// 3/4, front, back, left, right, top, bottom, or a direction X,Y,Z from the centre to the eye
    #[arg(long, default_value = "3/4", value_name = "VIEW", value_parser = parse_direction, allow_hyphen_values = true)]
    pub camera: Vec3,
    /// The axis of the grid that points up in the picture: x, y, z, -x, -y or -z
    #[arg(long, default_value = "y", value_name = "AXIS", value_parser = parse_axis, allow_hyphen_values = true)]
    pub up: Vec3,
    /// Degrees by which the sculpture is turned about the up axis
    #[arg(long, default_value_t = 0.0, value_name = "DEG", allow_hyphen_values = true)]
    pub turn: f32,
    /// Factor on the size in the picture; at 1 all that exists fits
    #[arg(long, default_value_t = 1.0, value_name = "FACTOR", value_parser = parse_zoom)]
    pub zoom: f32,
    /// How two eyes share the picture (default: stereo.layout of the configuration); layers writes
    /// two pictures
    #[arg(long, value_enum)]
    pub stereo: Option<StereoLayout>,
}

impl Default for PictureArgs {
    /// What the command line takes where nothing is said.
    fn default() -> Self {
        PictureArgs {
            size: glam::UVec2::new(640, 480),
            mode: None,
            camera: THREE_QUARTER,
            up: Vec3::Y,
            turn: 0.0,
            zoom: 1.0,
            stereo: None,
        }
    }
}

/// From the upper right in front: the view in which most shapes are read best.
const THREE_QUARTER: Vec3 = Vec3::new(0.8, 0.6, 1.0);

fn parse_size(text: &str) -> Result<glam::UVec2, String> {
    let size = text
        .split_once(['x', 'X'])
        .and_then(|(w, h)| Some(glam::UVec2::new(w.trim().parse().ok()?, h.trim().parse().ok()?)));
    match size {
        Some(s) if s.min_element() >= 1 && s.max_element() <= 16384 => Ok(s),
        _ => Err("write it as WIDTHxHEIGHT, each 1 to 16384".to_string()),
    }
}

fn parse_direction(text: &str) -> Result<Vec3, String> {
    Ok(match text {
        "3/4" => THREE_QUARTER,
        "front" => Vec3::Z,
        "back" => Vec3::NEG_Z,
        "left" => Vec3::NEG_X,
        "right" => Vec3::X,
        "top" => Vec3::Y,
        "bottom" => Vec3::NEG_Y,
        _ => {
            let parts: Vec<f32> = text.split(',').filter_map(|p| p.trim().parse().ok()).collect();
            let direction = <[f32; 3]>::try_from(parts).map(Vec3::from);
            match direction {
                Ok(d) if d.is_finite() && d.length_squared() > 1e-12 => d,
                _ => {
                    return Err("take 3/4, front, back, left, right, top, bottom, \
                                or three numbers X,Y,Z that are not all zero"
                        .to_string());
                }
            }
        }
    })
}

fn parse_axis(text: &str) -> Result<Vec3, String> {
    let (sign, name) = text.strip_prefix('-').map_or((1.0, text), |name| (-1.0, name));
    let axis = match name {
        "x" => Vec3::X,
        "y" => Vec3::Y,
        "z" => Vec3::Z,
        _ => return Err("take x, y, z, -x, -y or -z".to_string()),
    };
    Ok(sign * axis)
}

fn parse_zoom(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(zoom) if (0.01..=1000.0).contains(&zoom) => Ok(zoom),
        _ => Err("must be 0.01 to 1000".to_string()),
    }
}

fn parse_marker_mm(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(size) if (5.0..=5000.0).contains(&size) => Ok(size),
        _ => Err("must be 5 to 5000".to_string()),
    }
}
