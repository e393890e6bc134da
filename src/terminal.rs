//! Output on a terminal: results on standard output; notices and the log on standard error.
//!
//! `println!` and `eprintln!` panic when the reader is gone or the disk is full, and a panic costs work. Here, a result
//! that cannot be written is an error, and everything else may be lost.

use std::fmt::Display;
use std::io::{ErrorKind, Write};

use thiserror::Error;
use tracing_subscriber::Layer;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::fmt::MakeWriter;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

/// The reason why a result could not be written.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The reader has closed the pipe, like `head` when it has enough: no failure.
    #[error("the reader of the results has gone")]
    ReaderGone,
    #[error("cannot write to the standard output: {0}")]
    Output(std::io::Error),
}

/// Prints a result of the job.
pub fn print_result(text: impl Display) -> Result<(), OutputError> {
    line(std::io::stdout().lock(), text).map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => OutputError::ReaderGone,
        _ => OutputError::Output(error),
    })
}

/// Prints a report on standard output about work done in files: this text may be lost.
pub fn print_done(text: impl Display) {
    let _ = line(std::io::stdout().lock(), text);
}

/// Prints a message other than a result on standard error.
pub fn print_notice(text: impl Display) {
    let _ = line(std::io::stderr().lock(), text);
}

/// Writes a line in a single call, so that lines of several processes do not mix.
fn line(mut to: impl Write, text: impl Display) -> std::io::Result<()> {
    to.write_all(format!("{text}\n").as_bytes())?;
    to.flush()
}

/// The filter without `RUST_LOG`: warnings of this program. Libraries warn about what they handle
/// themselves; messages of the driver are part of this program's own log.
const DEFAULT_LOG: &str = "error,virtual_sculpture=warn,sculpture_core=warn,tracking=warn,\
                         winit=off,egui=off,calloop=off,sctk=off,smithay_client_toolkit=off";

/// The filter with `--verbose`.
const VERBOSE_LOG: &str =
    "warn,virtual_sculpture=debug,sculpture_core=debug,tracking=debug,egui=off";

/// Starts the log on standard error: warnings of this program, with `quiet` errors only, and with `verbose` its
/// activity. `RUST_LOG` overrides that, as a list of `level` and `target=level`. Colours only on a terminal without
/// `NO_COLOR`.
pub fn init_log(quiet: bool, verbose: bool) {
    use std::io::IsTerminal;
    let default = match (quiet, verbose) {
        (true, _) => "error,winit=off,egui=off",
        (false, true) => VERBOSE_LOG,
        (false, false) => DEFAULT_LOG,
    };
    let wanted = std::env::var("RUST_LOG").ok().filter(|text| !text.is_empty());
    let filter: Option<Targets> = wanted.as_deref().and_then(|text| text.parse().ok());
    let malformed = wanted.filter(|_| filter.is_none());
    let no_colour = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let lines = tracing_subscriber::fmt::layer()
        .with_ansi(std::io::stderr().is_terminal() && !no_colour)
        .log_internal_errors(false)
        .with_writer(Log)
        .with_filter(filter.unwrap_or_else(|| default.parse().unwrap_or_default()));
    tracing_subscriber::registry().with(lines).init();
    if let Some(text) = malformed {
        print_notice(format_args!(
            "RUST_LOG: '{text}' is no list of `level` and `target=level`; ignored"
        ));
    }
}

/// Standard error for the log. Lines that cannot be written are lost.
struct Log;

impl<'a> MakeWriter<'a> for Log {
    type Writer = Log;

    fn make_writer(&'a self) -> Log {
        Log
    }
}

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let _ = std::io::stderr().lock().write_all(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
