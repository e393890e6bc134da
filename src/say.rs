//! Owns the words to the person at the terminal: results on standard output, everything else on
//! standard error.
//!
//! `println!` and `eprintln!` panic where nobody reads any more or the disk is full, and a panic costs
//! work. Here a result that cannot be said is an error, and all other words may be lost.

use std::fmt::Display;
use std::io::{ErrorKind, Write};

use thiserror::Error;
use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::MakeWriter;

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

/// Begins to write the log to standard error: warnings of this program, or with `quiet` errors alone;
/// `RUST_LOG` says otherwise. Colours only for a terminal whose owner does not mind (`NO_COLOR`).
pub fn begin_log(quiet: bool) {
    use std::io::IsTerminal;
    let usual = if quiet { "error,winit=off,egui=off" } else { USUAL_LOG };
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(usual));
    let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_ansi(std::io::stderr().is_terminal() && !refused)
        .log_internal_errors(false)
        .with_writer(Log)
        .init();
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
