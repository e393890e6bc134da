//! Shows what a video source gives: lists the cameras of this computer, or writes some frames of
//! any source as PNG and reports how they arrived.
//!
//! ```text
//! cargo run --example camera
//! cargo run --example camera -- v4l2:/dev/video0?size=1280x720 10 /tmp
//! cargo run --example camera -- http://192.168.0.20:8080/video
//! ```

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use virtual_sculpture::terminal::{self, OutputError};
use virtual_sculpture::video::{Address, PlaybackState, VideoFrame, VideoSource};

fn main() -> ExitCode {
    match run() {
        // As with `| head`: nobody wants more.
        Err(error) if matches!(error.downcast_ref(), Some(OutputError::ReaderGone)) => {
            ExitCode::SUCCESS
        }
        Err(error) => {
            terminal::print_notice(format_args!("error: {error:#}"));
            ExitCode::FAILURE
        }
        Ok(()) => ExitCode::SUCCESS,
    }
}

fn run() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(address) = arguments.first() else {
        return list();
    };
    let count = arguments.get(1).map_or("1", String::as_str);
    let count = count.parse().with_context(|| format!("{count:?} is no number of frames"))?;
    let folder = arguments.get(2).map_or(".", String::as_str);
    capture(address, count, Path::new(folder))
}

#[cfg(target_os = "linux")]
fn list() -> Result<()> {
    let cameras = virtual_sculpture::video::cameras()?;
    if cameras.is_empty() {
        terminal::print_result("No camera.")?;
    }
    for camera in cameras {
        terminal::print_result(format_args!("v4l2:{}  {}", camera.device.display(), camera.name))?;
        match camera.modes {
            Ok(modes) => {
                for mode in modes {
                    let format = String::from_utf8_lossy(&mode.format).into_owned();
                    let (width, height, rate) = (mode.width, mode.height, mode.per_second);
                    let size = format!("{width} x {height}");
                    terminal::print_result(format_args!(
                        "    {format} {size}, up to {rate:.1} a second"
                    ))?;
                }
            }
            Err(error) => terminal::print_result(format_args!("    {error}"))?,
        }
    }
    Ok(())
}

#[cfg(not(target_os = "linux"))]
fn list() -> Result<()> {
    bail!("only Linux can be asked for its cameras; name a film or an http:// address")
}

/// Writes `count` frames as they come, telling each change of state.
fn capture(address: &str, count: u64, folder: &Path) -> Result<()> {
    let mut source = VideoSource::open(&address.parse::<Address>()?)?;
    let start = Instant::now();
    let (mut written, mut told) = (0, String::new());
    while written < count {
        if let Some(frame) = source.poll() {
            written += 1;
            let path = folder.join(format!("frame-{written:04}.png"));
            save(frame, &path)?;
            let (number, at) = (frame.sequence, frame.position.as_secs_f64());
            terminal::print_done(format_args!("{}: frame {number} at {at:.3} s", path.display()));
        }
        let state = match source.state() {
            PlaybackState::Opening => "opening".to_owned(),
            PlaybackState::Live => format!("live after {:.3} s", start.elapsed().as_secs_f64()),
            PlaybackState::Lost(error) => format!("lost: {error}"),
            PlaybackState::Failed(error) => bail!("{error}"),
            PlaybackState::Ended if written < count => {
                bail!("the film ended after {written} frames")
            }
            PlaybackState::Ended => "ended".to_owned(),
        };
        let kind = state.split(' ').next().unwrap_or_default().to_owned();
        if !told.starts_with(&kind) || (kind == "lost:" && told != state) {
            terminal::print_done(&state);
            told = state;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    terminal::print_done(format_args!("{:?}", source.stats()));
    Ok(())
}

fn save(frame: &VideoFrame, path: &Path) -> Result<()> {
    let (width, height) = (frame.width, frame.height);
    image::save_buffer(path, &frame.pixels, width, height, image::ColorType::Rgba8)
        .with_context(|| format!("cannot write {}", path.display()))
}
