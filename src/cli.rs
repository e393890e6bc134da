//! The command line: from arguments to a job and an exit code.
//!
//! Exit codes: 0 success, 1 the job failed, 2 wrong arguments, 3 an input file, script or the
//! settings cannot be used, 4 no usable Vulkan device or display,
//! 5 the checked sculpture cannot be printed as it is. Results go to stdout, everything
//! else to stderr.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::app::AppError;
use crate::bench;
use crate::config::{Config, Profile};
use crate::doctor;
use crate::film;
use crate::folders;
use crate::format;
use crate::format::options::ExportForm;
use crate::headless::{self, Context, DemoScene, RecoverJob};
use crate::manual;
use crate::persist::journal::{JournalDir, JournalOptions};
use crate::picture;
use crate::progress_bar::Bar;
use crate::screen::console;
use crate::terminal;
use crate::track::{self, TrackArgs};

mod arguments;
mod bench_arguments;
mod check_arguments;
mod choices;
mod error;
mod film_arguments;
mod final_arguments;
mod mesh_arguments;
mod panic_hook;
mod run_arguments;
mod shell;
mod window;

pub use arguments::{ImportArgs, PictureArgs};
pub use error::{ArgumentError, ProgramError};
pub use film_arguments::FilmArgs;

use bench_arguments::BenchArgs;
use check_arguments::CheckArgs;
use final_arguments::{FinalArgs, Tracer};
use mesh_arguments::MeshArgs;
use run_arguments::RunArgs;

use arguments::{named, parse_marker_mm};

const LOG_HELP: &str = "The environment variable RUST_LOG chooses what is logged, as a list of LEVEL and TARGET=LEVEL \
    (virtual_sculpture=debug); it overrides --verbose and --quiet.";

/// Shape a block of voxels as a sculptor shapes stone.
#[derive(Parser, Debug)]
#[command(version, about, long_about = None, after_help = LOG_HELP)]
pub struct Cli {
    /// Sculpture or volume to open in the window (.vsc, .pvm)
    pub file: Option<PathBuf>,
    /// Settings file to use instead of your own (`doctor` shows where that is)
    #[arg(long, global = true, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Preset for a way of working; your own settings override it
    #[arg(long, global = true, value_enum)]
    pub profile: Option<Profile>,
    /// Record every command as a script, to replay with `run`
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Do not save to the opened file; another program may have it open too
    #[arg(long)]
    pub read_only: bool,
    /// Keep no journal of this session: a crash loses unsaved work
    #[arg(long)]
    pub no_journal: bool,
    /// If there is no display, write the demo scene to the folder `out` instead
    #[arg(long)]
    pub or_demo: bool,
    /// Work in a headset, with or without a window
    #[arg(long)]
    pub headset: bool,
    /// Save what the headset shows to this folder now and then (for developers)
    #[arg(long, value_name = "DIR")]
    pub headset_shots: Option<PathBuf>,
    /// Print only errors and results
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Print the program's activity to standard error, for bug reports
    #[arg(long, short, global = true, conflicts_with = "quiet")]
    pub verbose: bool,
    #[command(flatten)]
    pub import: ImportArgs,
    #[command(subcommand)]
    pub job: Option<Job>,
}

#[derive(Subcommand, Debug)]
pub enum Job {
    /// Render a file to a picture, without a display
    Render {
        file: PathBuf,
        /// The picture to write (.png, .jpg; in final quality also .exr)
        #[arg(long, value_parser = named(&picture::FINAL_ENDINGS))]
        out: PathBuf,
        #[command(flatten)]
        picture: PictureArgs,
        #[command(flatten)]
        import: ImportArgs,
        #[command(flatten)]
        last: FinalArgs,
    },
    /// Make a film: a turntable of a sculpture, or a time lapse of a script
    Film(FilmArgs),
    /// Run a script of commands, without a display
    Run(RunArgs),
    /// List the sessions that did not end properly, or recover one
    Recover {
        /// Number of the session in the list
        number: Option<u64>,
        /// Write its sculpture to this file, which must not exist yet
        #[arg(long, value_name = "FILE", requires = "number", value_parser = named(&format::WRITE_ENDINGS))]
        out: Option<PathBuf>,
        /// Remove it, after writing the file if one is given
        #[arg(long, requires = "number")]
        discard: bool,
        /// List them as one line of JSON, for programs
        #[arg(long, conflicts_with = "number")]
        json: bool,
    },
    /// Convert a file to another format
    Convert {
        input: PathBuf,
        #[arg(value_parser = named(&format::WRITE_ENDINGS),
              help = format!("The file to write ({})", format::written_text()))]
        output: PathBuf,
        /// How voxels are written: auto, densities, rgba or packed
        #[arg(long, default_value_t, value_name = "FORM")]
        form: ExportForm,
        #[command(flatten)]
        mesh: MeshArgs,
        #[command(flatten)]
        import: ImportArgs,
    },
    /// Show what a file contains
    Info {
        file: PathBuf,
        /// Print one line of JSON, for programs
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        import: ImportArgs,
    },
    /// Check whether a sculpture can be printed in 3D, and list what is wrong (exit code 5 if it cannot)
    Check {
        file: PathBuf,
        #[command(flatten)]
        check: CheckArgs,
        /// Print one line of JSON, for programs
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        import: ImportArgs,
    },
    /// Build a scene from a script, save it and render it
    Demo {
        #[arg(long, value_enum, default_value_t)]
        scene: DemoScene,
        /// Folder for the picture and the sculpture (created if missing)
        #[arg(long, default_value = "out", value_name = "DIR")]
        out: PathBuf,
        #[command(flatten)]
        picture: PictureArgs,
    },
    /// Show the poses of a head tracker, or serve them over VRPN
    Track(TrackArgs),
    /// Draw a marker to print, for the sculpture to stand on in AR
    Marker {
        /// The drawing to write (.svg, .png)
        #[arg(long, value_name = "FILE", value_parser = named(&["svg", "png"]))]
        out: PathBuf,
        /// Its number, 0 to 29
        #[arg(long, default_value_t = 0)]
        id: u32,
        /// Width of its black square in millimetres
        #[arg(long, default_value_t = 80.0, value_name = "MM", value_parser = parse_marker_mm)]
        size_mm: f64,
    },
    /// Benchmark rendering, edits and files on this machine
    Bench(BenchArgs),
    /// List the commands that scripts can use
    Commands {
        /// Print the reference of the brushes instead, as a page in Markdown
        #[arg(long)]
        markdown: bool,
    },
    /// Show what was found on this machine: Vulkan devices, gamepads, cameras, OpenXR, settings
    Doctor,
    /// Print a script that completes commands and options in a shell
    Completions {
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
    /// Print the manual page, for `man -l -`
    Man {
        /// Command whose page is printed instead of the program's
        #[arg(value_name = "COMMAND")]
        of: Option<String>,
    },
}

/// Parses arguments. Those of the window are refused beside a job; global ones may be anywhere.
fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Cli, clap::Error> {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let mut command = Cli::command();
    if let Some(text) = misspelt_job(&command, &arguments) {
        return Err(command.error(ErrorKind::InvalidSubcommand, text));
    }
    let matches = command.try_get_matches_from_mut(arguments)?;
    if let Some(job) = matches.subcommand_name() {
        let given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
        let mut own = command.get_arguments().filter(|argument| !argument.is_global_set());
        let refused = own
            .find(|argument| given(argument.get_id().as_str()))
            .map(|argument| format!("'{argument}' applies only to the window; see '{job} --help'"));
        drop(own);
        if let Some(text) = refused {
            return Err(command.error(ErrorKind::ArgumentConflict, text));
        }
    }
    Cli::from_arg_matches(&matches)
}

/// Returns the message for a first word that is neither a job nor a file, but similar to a job. clap takes it for the
/// file to open, and complains about the words after it, if at all.
fn misspelt_job(command: &clap::Command, arguments: &[OsString]) -> Option<String> {
    let lenient = command.clone().ignore_errors(true).disable_help_flag(true);
    let matches = lenient.try_get_matches_from(arguments).ok()?;
    let file = matches.get_one::<PathBuf>("file").filter(|file| !file.exists())?;
    // A word with an extension or a folder means a file.
    let word = file.to_str().filter(|_| Path::new(file.file_name().unwrap_or_default()) == file)?;
    if matches.subcommand_name().is_some() || file.extension().is_some() {
        return None;
    }
    let jobs = command.get_subcommands().map(|job| (strsim::jaro(word, job.get_name()), job));
    let (likeness, job) = jobs.max_by(|a, b| a.0.total_cmp(&b.0))?;
    // The measure and threshold of clap's own suggestions.
    let name = job.get_name();
    (likeness > 0.7).then(|| format!("there is no command '{word}'; did you mean '{name}'?"))
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    console::attach();
    let cli = match parse(std::env::args_os()) {
        Ok(cli) => cli,
        Err(words) => return refuse(&words),
    };
    terminal::init_log(cli.quiet, cli.verbose);
    panic_hook::install();
    match dispatch(cli) {
        Err(error) if !error.is_reader_gone() => {
            terminal::print_notice(format_args!("error: {error}"));
            if matches!(error, ProgramError::App(_)) && error.exit_code() == 4 {
                terminal::print_notice(doctor::system().join("\n"));
            }
            console::show(&error.to_string());
            ExitCode::from(error.exit_code())
        }
        _ => ExitCode::SUCCESS,
    }
}

/// Prints clap's output: help and version, which are results, or errors.
fn refuse(words: &clap::Error) -> ExitCode {
    let error = words.print().is_err_and(|error| error.kind() != std::io::ErrorKind::BrokenPipe);
    match words.exit_code() {
        0 => ExitCode::from(u8::from(error)),
        code => ExitCode::from(u8::try_from(code).unwrap_or(2)),
    }
}

/// Returns the options of journals by these settings.
fn journal_options(config: &Config) -> JournalOptions {
    let journal_dir = JournalDir::new(&folders::journal_folder());
    JournalOptions { max_bytes: config.journal.max_bytes(), ..JournalOptions::new(journal_dir) }
}

fn dispatch(cli: Cli) -> Result<(), ProgramError> {
    // The program's texts about itself must not depend on settings, which may be invalid.
    let is_help =
        matches!(cli.job, Some(Job::Commands { .. } | Job::Completions { .. } | Job::Man { .. }));
    let config = match is_help {
        true => Config::default(),
        false => Config::load_over(cli.profile, cli.config.as_deref())?,
    };
    let device = config.device_options(folders::cache_folder());
    let progress = Bar::new(cli.quiet);
    let context = Context { config: &config, device: &device, progress: &progress };
    match cli.job {
        Some(Job::Render { file, out, picture, import, last }) => {
            let import = import.options();
            match last.options(&picture, &out)? {
                Some(options) => {
                    let picture = PictureArgs { samples: None, ..picture }.request()?;
                    let options = (&options, last.trace_on == Some(Tracer::Gpu));
                    headless::render_final(&file, &out, &picture, options, &import, &context)?;
                }
                None => headless::render(&file, &out, &picture.request()?, &import, &context)?,
            }
            Ok(())
        }
        Some(Job::Film(args)) => Ok(film::run(&args.job()?, &context)?),
        Some(Job::Run(args)) => {
            Ok(headless::run(&args.job(&config, journal_options(&config))?, &context)?)
        }
        Some(Job::Recover { number, out, discard, json }) => {
            let journal_dir = journal_options(&config).journal_dir;
            if number.is_some() && out.is_none() && !discard {
                return Err(ArgumentError::NothingToDo.into());
            }
            Ok(headless::recover(
                &RecoverJob { journal_dir, number, out, discard, json },
                &context,
            )?)
        }
        Some(Job::Convert { input, output, form, mesh, import }) => {
            let mesh = mesh.options(&output, form);
            Ok(headless::convert(&input, &output, form, mesh, &import.options(), &context)?)
        }
        Some(Job::Info { file, json, import }) => {
            Ok(headless::info(&file, &import.options(), json, &context)?)
        }
        Some(Job::Check { file, check, json, import }) => {
            Ok(headless::check(&file, &check.options(), json, &import.options(), &context)?)
        }
        Some(Job::Demo { scene, out, picture }) => {
            Ok(headless::demo(scene, &out, &picture.request()?, &context)?)
        }
        Some(Job::Track(args)) => Ok(track::run(&args, &config)?),
        Some(Job::Marker { out, id, size_mm }) => Ok(headless::marker(id, size_mm, &out)?),
        Some(Job::Bench(args)) => Ok(bench::run(&args.job(), &config, &device, &progress)?),
        Some(Job::Commands { markdown: false }) => Ok(headless::commands()?),
        Some(Job::Commands { markdown: true }) => {
            let page = manual::brushes().map_err(AppError::from)?;
            Ok(terminal::print_result(page.trim_end())?)
        }
        Some(Job::Doctor) => Ok(terminal::print_result(doctor::report())?),
        Some(Job::Completions { shell }) => Ok(shell::completions(shell, Cli::command())?),
        Some(Job::Man { of }) => match shell::manual(Cli::command(), of.as_deref())? {
            true => Ok(()),
            false => Err(ProgramError::NoJob(of.unwrap_or_default())),
        },
        None => window::window_or_demo(cli, config, device, &progress),
    }
}
