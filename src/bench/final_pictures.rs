//! The time of a final picture of a scene: preparation, tracing, and the filter.
//!
//! Takes a sculpture and an eye; few samples, since the time goes with their number.

use std::time::Instant;

use glam::Vec3;
use serde::Serialize;

use super::Suite;
use crate::document::Document;
use crate::sculpture::Limits;
use crate::shade::{LevelSet, NormalField, ShadeSource};
use crate::trace::{self, TraceCamera, TraceError, TraceOptions};
use crate::view::Eye;

/// Times of one picture, in seconds.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct FinalReport {
    /// Rays of each pixel.
    pub samples: u32,
    /// The picture is of the smooth surface, or of voxels, as the program chooses.
    pub smooth: bool,
    /// Normals and smooth surface.
    pub prepare_s: f64,
    pub trace_s: f64,
    pub denoise_s: f64,
}

/// Makes a final picture with the usual light, ground and number of bounces.
pub fn final_picture(
    document: &Document,
    eye: &Eye,
    suite: Suite,
) -> Result<FinalReport, TraceError> {
    let (grid, material) = (document.grid(), document.material());
    let camera =
        TraceCamera { eye: *eye, world_from_grid: document.world_from_grid(), up: Vec3::Y };
    let begun = Instant::now();
    let normals = NormalField::of(grid);
    let rays = camera.eye.pixel_rays(&camera.world_from_grid);
    let levels = LevelSet::shows(grid, &rays)
        .then(|| LevelSet::whole(grid, Limits::default().grid_bytes).ok())
        .flatten()
        .map(|mut levels| {
            levels.update(grid, &normals, &mut Vec::new());
            levels
        });
    let prepare_s = begun.elapsed().as_secs_f64();
    let source = ShadeSource { grid, material, normals: &normals, mask: None };
    let options = TraceOptions { samples: suite.final_samples(), ..TraceOptions::default() };
    let begun = Instant::now();
    let film = trace::trace((&source, levels.as_ref()), &camera, &options, &())?;
    let trace_s = begun.elapsed().as_secs_f64();
    let begun = Instant::now();
    std::hint::black_box(trace::denoise(film));
    let denoise_s = begun.elapsed().as_secs_f64();
    let (samples, smooth) = (options.samples, levels.is_some());
    Ok(FinalReport { samples, smooth, prepare_s, trace_s, denoise_s })
}
