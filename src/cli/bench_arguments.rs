//! The arguments of `bench`.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{ImportArgs, named, parse_size};
use crate::bench::{BenchJob, Kernel, Only, Suite};
use crate::render::RenderMode;

/// A benchmark to run.
#[derive(Args, Debug)]
pub struct BenchArgs {
    /// Write the figures to this file (.json)
    #[arg(long, value_name = "JSON", value_parser = named(&["json"]))]
    pub json: Option<PathBuf>,
    /// Plot modes against scenes in this file (.svg)
    #[arg(long, value_name = "SVG", value_parser = named(&["svg"]))]
    pub plot: Option<PathBuf>,
    #[arg(long, value_enum, default_value_t)]
    pub suite: Suite,
    /// Measure only this mode; may be repeated
    #[arg(long = "mode", value_enum, value_name = "MODE")]
    pub modes: Vec<RenderMode>,
    /// Run only this kernel, for profilers
    #[arg(long, value_enum)]
    pub kernel: Option<Kernel>,
    /// Only measure the accuracy of normals on analytic shapes
    #[arg(long, conflicts_with_all = ["kernel", "modes", "scenes", "json", "plot"])]
    pub normals: bool,
    /// Only measure how memory and times grow with the size of the grid
    #[arg(long, conflicts_with_all = ["kernel", "modes", "scenes", "normals", "eyes"])]
    pub sizes: bool,
    /// Number of times to run the kernel
    #[arg(long, default_value_t = 1, value_name = "N", requires = "kernel")]
    pub repeat: usize,
    /// Picture size in pixels
    #[arg(long, default_value = "640x480", value_name = "WxH", value_parser = parse_size)]
    pub size: glam::UVec2,
    /// Pictures rendered at once: 1, or 2 for stereo
    #[arg(long, default_value_t = 1, value_name = "1|2", conflicts_with = "kernel",
          value_parser = clap::value_parser!(u32).range(1..=2))]
    pub eyes: u32,
    /// Scenes (cube, engine, cheese, gyroid) or files to measure
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub import: ImportArgs,
}

impl BenchArgs {
    pub fn job(self) -> BenchJob {
        let BenchArgs { json, plot, suite, modes, repeat, size, eyes, scenes, .. } = self;
        let only = match () {
            () if self.normals => Some(Only::Normals),
            () if self.sizes => Some(Only::Sizes),
            () => self.kernel.map(Only::Kernel),
        };
        let import = self.import.options();
        BenchJob { json, plot, suite, modes, only, repeat, size, eyes, scenes, import }
    }
}
