//! The benchmark of sizes: how memory and times grow with the edge of the grid.
//!
//! Measures two sculptures of each size: a full block with a thousand carved balls, of which about as much is surface
//! whatever its size, and a gyroid's shell, whose surface grows with the square of the edge. Everything runs as in the
//! program without a device.

use std::fmt;
use std::time::{Duration, Instant};

use glam::{Quat, UVec3, Vec3};
use serde::Serialize;

use super::machine::{self, Machine};
use super::statistics::{Times, measure};
use super::subjects::{eye_of, without_colour};
use super::{BenchError, BenchJob, Suite, files, publish, sizes_plot};
use crate::command::Command;
use crate::config::Config;
use crate::document::{Document, Limits};
use crate::progress::Progress;
use crate::scenes::{self, Random};
use crate::sculpture::edit::EditOp;
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::{Grid, GridError};
use crate::shade::{self, Lighting, NormalField, Pixels, ShadePose, ShadeSource};
use crate::surface::{IndexMap, raycast};
use crate::tools::solid::{Primitive, Solid};

/// Radii of carved balls, in voxels.
const LEAST_RADIUS_VX: f32 = 8.0;
/// Radius of the ball that is carved repeatedly, in voxels.
const EDIT_RADIUS_VX: f32 = 64.0;
/// Files that are larger are saved and loaded only once.
const LARGE_BYTES: u64 = 1 << 28;
/// More than the largest of these grids takes.
const GRID_BYTES: u64 = 16 << 30;

impl Suite {
    /// Returns the edges of the grids, in voxels.
    fn edges(self) -> &'static [u32] {
        match self {
            Suite::Brief => &[128, 256],
            Suite::Quick => &[512, 1024, 2048, 4096],
            Suite::Full => &[512, 1024, 2048, 4096, 8192],
        }
    }
}

/// The results. Times are in milliseconds.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct SizesReport {
    pub program: String,
    pub suite: String,
    pub machine: Machine,
    /// Size of the pictures in pixels.
    pub picture: [u32; 2],
    pub sizes: Vec<SizeReport>,
    pub peak_memory_bytes: Option<u64>,
}

/// A sculpture of one size.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct SizeReport {
    pub shape: String,
    pub edge_vx: u32,
    pub voxels: u64,
    /// Memory of the bits.
    pub bits_bytes: u64,
    /// The carving of all balls, with undo.
    pub make_ms: Option<f64>,
    /// Carving a ball of radius 64, and undoing it.
    pub edit: Option<Times>,
    pub undo: Option<Times>,
    /// The voxels of all pixels by the exact ray caster.
    pub sample: Option<Times>,
    /// The first picture of an opened sculpture: voxels, normals of those that are seen, and shading.
    pub first_picture: Option<Times>,
    /// As `.vsc`.
    pub file_bytes: u64,
    pub save: Option<Times>,
    pub load: Option<Times>,
}

/// A sculpture to measure.
struct SizedSubject {
    shape: String,
    document: Document,
    make_ms: Option<f64>,
}

impl SizedSubject {
    /// Returns a full block of which balls of random places and radii are carved, as one step.
    fn block(edge_vx: u32, balls: u32, most_vx: f32, limits: Limits) -> Result<Self, BenchError> {
        let mut document = document(scenes::solid_cube(edge_vx), limits)?;
        let mut random = Random(1);
        let start = Instant::now();
        document.apply(&Command::Begin { label: String::new() })?;
        for _ in 0..balls {
            let unit = Vec3::new(random.unit(), random.unit(), random.unit());
            let radius = LEAST_RADIUS_VX + (most_vx - LEAST_RADIUS_VX) * random.unit();
            document.apply(&ball(unit * edge_vx as f32, radius))?;
        }
        document.apply(&Command::End)?;
        let make_ms = Some(start.elapsed().as_secs_f64() * 1e3);
        Ok(SizedSubject { shape: format!("block, {balls} balls"), document, make_ms })
    }

    fn shell(edge_vx: u32, limits: Limits) -> Result<Self, BenchError> {
        let document = document(scenes::gyroid_shell(edge_vx), limits)?;
        Ok(SizedSubject { shape: "shell".to_string(), document, make_ms: None })
    }

    fn measured(mut self, job: &BenchJob) -> Result<SizeReport, BenchError> {
        let edge_vx = self.document.grid().dims().x;
        let [edit, undo] = edits(&mut self.document, job.suite.edits())?;
        let [sample, first_picture] = pictures(&self.document, job);
        let grid = self.document.grid();
        let (voxels, bits_bytes) = (grid.opaque_count(), grid.heap_bytes());
        let runs = if bits_bytes > LARGE_BYTES { 1 } else { job.suite.files() };
        let limits = Limits { grid_bytes: GRID_BYTES, ..Limits::default() };
        let file = files::files(self.document.contents(), &["vsc"], runs, &limits)
            .map_err(BenchError::Files)?
            .pop();
        Ok(SizeReport {
            shape: self.shape,
            edge_vx,
            voxels,
            bits_bytes,
            make_ms: self.make_ms,
            edit,
            undo,
            sample,
            first_picture,
            file_bytes: file.as_ref().map_or(0, |file| file.bytes),
            save: file.as_ref().map(|file| file.save),
            load: file.as_ref().map(|file| file.load),
        })
    }
}

fn document(grid: Result<Grid, GridError>, limits: Limits) -> Result<Document, BenchError> {
    let contents = without_colour(grid);
    let told = |error| BenchError::Subject { subject: "a scene".to_string(), error };
    Ok(Document::from_contents(contents.map_err(told)?, limits))
}

fn ball(centre_vx: Vec3, radius_vx: f32) -> Command {
    let half = Vec3::splat(radius_vx);
    let primitive =
        Primitive { solid: Solid::Ellipsoid, centre_vx, half, rotation: Quat::IDENTITY };
    Command::Construct { op: EditOp::Subtract, primitive, to_vx: None }
}

/// Returns the times to carve a ball near the middle, and to undo it.
fn edits(document: &mut Document, runs: usize) -> Result<[Option<Times>; 2], BenchError> {
    let command = ball(document.grid().dims().as_vec3() * 0.49, EDIT_RADIUS_VX);
    let undo = Command::Undo { steps: Some(1) };
    let mut undone = Vec::new();
    let done = measure(runs, || {
        let start = Instant::now();
        document.apply(&command)?;
        let time = start.elapsed();
        let start = Instant::now();
        document.apply(&undo)?;
        undone.push(start.elapsed());
        document.drain_changes(|_, _| ());
        Ok::<Duration, BenchError>(time)
    })?;
    Ok([done, Times::of(&undone)])
}

/// Returns the times to find the voxels of a picture, and to make the first picture.
fn pictures(document: &Document, job: &BenchJob) -> [Option<Times>; 2] {
    let (grid, material) = (document.grid(), document.material());
    let eye = eye_of(document, job.size);
    let world_from_grid = document.world_from_grid();
    let rays = eye.pixel_rays(&world_from_grid);
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    let mut map = IndexMap::new(rays);
    let mut sampled = || {
        let start = Instant::now();
        raycast::sample(grid, &rays, &mut map);
        start.elapsed()
    };
    let sample: Vec<Duration> = (0..=job.suite.frames()).map(|_| sampled()).skip(1).collect();
    let mut pixels = Pixels::new(rays.size);
    let mut first = || {
        let start = Instant::now();
        let mut map = IndexMap::new(rays);
        raycast::sample(grid, &rays, &mut map);
        let mut normals = NormalField::default();
        normals.follow(grid, None);
        normals.complete_seen(grid, [&map], &mut Vec::new(), || true);
        let source = ShadeSource { grid, material, normals: &normals, mask: None };
        shade::shade(&map, &source, &pose, &Lighting::default(), &mut pixels);
        start.elapsed()
    };
    let first: Vec<Duration> = (0..super::LEAST_RUNS).map(|_| first()).collect();
    [Times::of(&sample), Times::of(&first)]
}

/// Measures all sizes, writes JSON and a plot if requested, and prints a table.
pub fn run(job: &BenchJob, config: &Config, progress: &dyn Progress) -> Result<(), BenchError> {
    let machine = Machine::survey(Err("not used".to_string()));
    let limits = Limits { grid_bytes: GRID_BYTES, ..config.limits() };
    let mut sizes = Vec::new();
    for &edge_vx in job.suite.edges() {
        progress.begin(&format!("measuring {} voxels", UVec3::splat(edge_vx)));
        let most_vx = EDIT_RADIUS_VX.min(edge_vx as f32 / 8.0);
        sizes.push(SizedSubject::block(edge_vx, 1000, most_vx, limits)?.measured(job)?);
        sizes.push(SizedSubject::shell(edge_vx, limits)?.measured(job)?);
        if edge_vx == MAX_AXIS_VX {
            sizes.push(SizedSubject::block(edge_vx, 10_000, 128.0, limits)?.measured(job)?);
        }
        progress.end();
    }
    let report = SizesReport {
        program: format!("virtual-sculpture {}", env!("CARGO_PKG_VERSION")),
        suite: job.suite.name().to_string(),
        machine,
        picture: job.size.to_array(),
        sizes,
        peak_memory_bytes: machine::peak_memory_bytes(),
    };
    publish(
        job,
        serde_json::to_string_pretty(&report),
        sizes_plot::svg(&report),
        report.to_string(),
    )
}

impl fmt::Display for SizesReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}, suite {}", self.program, self.suite)?;
        writeln!(f, "{}", self.machine)?;
        let [width, height] = self.picture;
        writeln!(f, "\nmedian ms; pictures of {width}x{height} by the CPU")?;
        writeln!(
            f,
            "{:<20} {:>5} {:>12} {:>9} {:>9} {:>8} {:>8} {:>8} {:>9} {:>10} {:>9} {:>9}",
            "sculpture",
            "edge",
            "voxels",
            "MiB",
            "carving",
            "edit",
            "undo",
            "sample",
            "first",
            "vsc bytes",
            "save",
            "load",
        )?;
        let ms =
            |times: Option<Times>| times.map_or_else(|| "-".to_string(), |t| number(t.median_ms));
        for size in &self.sizes {
            writeln!(
                f,
                "{:<20} {:>5} {:>12} {:>9.2} {:>9} {:>8} {:>8} {:>8} {:>9} {:>10} {:>9} {:>9}",
                size.shape,
                size.edge_vx,
                size.voxels,
                size.bits_bytes as f64 / f64::from(1 << 20),
                size.make_ms.map_or_else(|| "-".to_string(), number),
                ms(size.edit),
                ms(size.undo),
                ms(size.sample),
                ms(size.first_picture),
                size.file_bytes,
                ms(size.save),
                ms(size.load),
            )?;
        }
        match self.peak_memory_bytes {
            Some(bytes) => write!(f, "\nmost memory in use: {} MiB", bytes >> 20),
            None => Ok(()),
        }
    }
}

fn number(ms: f64) -> String {
    format!("{ms:.2}")
}
