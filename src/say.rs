//! Owns the words to the person at the terminal: results on standard output, everything else on
//! standard error.
//!
//! `println!` and `eprintln!` panic where nobody reads any more or the disk is full, and a panic costs
//! work. Here a result that cannot be said is an error, and all other words may be lost.

use std::fmt::Display;
use std::io::{ErrorKind, Write};

use thiserror::Error;
use tracing_subscriber::Layer;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::fmt::MakeWriter;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

/// Why a result was not said.
#[derive(Debug, Error)]
pub enum Unsaid {
    /// Whoever read the results has gone, as `head` does when it has enough: no failure.
    #[error("nobody reads the results any more")]
    ReaderGone,
    #[error("cannot write to the standard output: {0}")]
    Output(std::io::Error),
}

/// Says what the job was asked for.
pub fn result(text: impl Display) -> Result<(), Unsaid> {
    line(std::io::stdout().lock(), text).map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => Unsaid::ReaderGone,
        _ => Unsaid::Output(error),
    })
}

/// Says on standard output what has been done already, in files: the words may be lost.
pub fn done(text: impl Display) {
    let _ = line(std::io::stdout().lock(), text);
}

/// Says on standard error what is no result.
pub fn aside(text: impl Display) {
    let _ = line(std::io::stderr().lock(), text);
}

/// One write for the whole, so that lines of several processes do not mix.
fn line(mut to: impl Write, text: impl Display) -> std::io::Result<()> {
    to.write_all(format!("{text}\n").as_bytes())?;
    to.flush()
}

/// Where `RUST_LOG` says nothing: what this program warns of. Other people's libraries complain of what
/// they cope with; the driver's complaints come through this program's own messages.
const USUAL_LOG: &str = "error,virtual_sculpture=warn,sculpture_core=warn,tracking=warn,\
                         winit=off,egui=off,calloop=off,sctk=off,smithay_client_toolkit=off";

/// Starts writing the log to standard error: warnings of this program, or with `quiet` errors only.
/// `RUST_LOG` overrides that, as a list of `level` and `target=level`. Colours only on a terminal
/// without `NO_COLOR`.
pub fn begin_log(quiet: bool) {
    use std::io::IsTerminal;
    let usual = if quiet { "error,winit=off,egui=off" } else { USUAL_LOG };
    let wanted = std::env::var("RUST_LOG").ok().filter(|text| !text.is_empty());
    let filter: Option<Targets> = wanted.as_deref().and_then(|text| text.parse().ok());
    let malformed = wanted.filter(|_| filter.is_none());
    let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let lines = tracing_subscriber::fmt::layer()
        .with_ansi(std::io::stderr().is_terminal() && !refused)
        .log_internal_errors(false)
        .with_writer(Log)
        .with_filter(filter.unwrap_or_else(|| usual.parse().unwrap_or_default()));
    tracing_subscriber::registry().with(lines).init();
    if let Some(text) = malformed {
        aside(format_args!("RUST_LOG: '{text}' is no list of `level` and `target=level`; ignored"));
    }
}

/// Standard error for the log. A line that cannot be written is lost.
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
