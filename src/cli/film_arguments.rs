//! The arguments of `film`.

use std::path::PathBuf;

use clap::Args;

use super::error::ArgumentError;
use super::{ImportArgs, PictureArgs};
use crate::film::{FilmJob, FrameRange, Subject};

/// A film to make.
#[derive(Args, Debug)]
pub struct FilmArgs {
    /// Sculpture or volume for a turntable, or script (.sculpt) for a time lapse
    pub subject: PathBuf,
    /// The film to write: a folder for pictures, an animated picture (.apng, .png, .gif), or raw video (.y4m)
    #[arg(long)]
    pub out: PathBuf,
    /// Sculpture or volume that the script starts from
    #[arg(long = "in", value_name = "FILE")]
    pub input: Option<PathBuf>,
    /// Number of frames of the whole film
    #[arg(long, default_value_t = 120, value_name = "N",
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub frames: u32,
    /// Make only these frames, counted from 1: A..B, A.., ..B or one; they are the same as in the whole film
    #[arg(long, value_name = "A..B")]
    pub range: Option<FrameRange>,
    /// Frames per second
    #[arg(long, default_value_t = 30, value_name = "N",
          value_parser = clap::value_parser!(u16).range(1..=240))]
    pub fps: u16,
    /// How far to turn in the film, in degrees (default: 360 for a sculpture, 0 for a script)
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = parse_spin)]
    pub spin: Option<f32>,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub import: ImportArgs,
}

impl FilmArgs {
    pub fn job(&self) -> Result<FilmJob, ArgumentError> {
        Ok(FilmJob {
            subject: Subject::File(self.subject.clone()),
            input: self.input.clone(),
            out: self.out.clone(),
            frames: self.frames,
            range: self.range.unwrap_or_default(),
            fps: self.fps,
            spin_deg: self.spin,
            picture: self.picture.request()?,
            import: self.import.options(),
        })
    }
}

fn parse_spin(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(degrees) if degrees.abs() <= 36_000.0 => Ok(degrees),
        _ => Err("must be -36000 to 36000".to_string()),
    }
}
