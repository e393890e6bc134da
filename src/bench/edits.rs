//! Benchmarks of edits: throughput by solid, undo and redo, and the latency from an edit to its
//! picture.

use std::time::{Duration, Instant};

use glam::{EulerRot, Quat, UVec3, Vec3};
use serde::Serialize;

use super::LEAST_RUNS;
use super::pictures::BenchPictures;
use super::statistics::{Times, measure};
use crate::command::{Command, NewSculpture};
use crate::document::{ChangeSubscriber, CommandError, Document};
use crate::gpu::GpuError;
use crate::mesh::{ContentsVersion, KeptMesh, MeshKind, VertexColours};
use crate::scenes::Random;
use crate::sculpture::edit::EditOp;
use crate::sculpture::{ColourDepth, Limits, Rgb};
use crate::surface::raycast;
use crate::tools::drawn::{DrawnSolid, SolidPose};
use crate::tools::solid::{Primitive, Solid};

/// One edit, repeated.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct EditReport {
    pub name: String,
    /// Voxels that it changes.
    pub voxels: u64,
    pub times: Times,
    pub voxels_per_s: f64,
}

impl EditReport {
    fn of(name: &str, voxels: u64, times: Times) -> EditReport {
        let voxels_per_s = voxels as f64 / (times.median_ms * 1e-3);
        EditReport { name: name.to_string(), voxels, times, voxels_per_s }
    }
}

/// Edge of the block that is edited.
const BLOCK_VX: u32 = 512;

/// The middle of the solids that are cut, off all planes between voxels.
const MIDDLE_VX: Vec3 = Vec3::new(251.3, 260.7, 255.1);
const HALF_EDGE_VX: f32 = 64.0;
/// A segment of a stroke of such a solid, as made by the editor.
const SWEEP_VX: Vec3 = Vec3::new(9.0, 7.0, 6.0);

/// Returns the measured commands, each on a full block.
pub fn edits(runs: usize, limits: Limits) -> Result<Vec<EditReport>, CommandError> {
    let mut document = block(ColourDepth::None, limits)?;
    let mut reports = Vec::new();
    for (name, command) in solids().into_iter().chain(drawn_solids()) {
        reports.extend(timed(&mut document, &name, &command, runs)?);
    }
    reports.extend(carves(&mut document, runs.div_ceil(4))?);
    reports.extend(meshes_made_anew(&mut document, runs.div_ceil(4))?);
    Ok(reports)
}

/// Returns cuts with every solid: along the grid, turned, and swept.
fn solids() -> Vec<(String, Command)> {
    let (at_vx, turn, even) = (MIDDLE_VX, turn(), Vec3::splat(HALF_EDGE_VX));
    let of = |solid: Solid| format!("{} of half edge {HALF_EDGE_VX}", solid.name());
    let swept = |solid| Command::Construct {
        op: EditOp::Subtract,
        primitive: Primitive { solid, centre_vx: at_vx, half: even, rotation: turn },
        to_vx: Some(at_vx + SWEEP_VX),
    };
    let each = Solid::ALL.into_iter().flat_map(|solid| {
        [
            (of(solid), subtract(solid, at_vx, even, Quat::IDENTITY)),
            (format!("turned {}", of(solid)), subtract(solid, at_vx, even, turn)),
            (format!("sweep of a turned {}", of(solid)), swept(solid)),
        ]
    });
    let uneven = subtract(Solid::Ellipsoid, at_vx, Vec3::new(64.0, 40.0, 90.0), turn);
    each.chain([("turned ellipsoid 64 x 40 x 90".to_string(), uneven)]).collect()
}

/// Returns cuts with the example of every drawn solid.
fn drawn_solids() -> impl Iterator<Item = (String, Command)> {
    let pose = SolidPose { at_vx: MIDDLE_VX, rotation: turn() };
    DrawnSolid::ALL.into_iter().map(move |spec| {
        let drawn = (spec.example)(pose, HALF_EDGE_VX);
        (spec.bench_row.to_string(), Command::DrawnSolid { op: EditOp::Subtract, drawn })
    })
}

fn turn() -> Quat {
    Quat::from_euler(EulerRot::XYZ, 0.4, 0.7, 1.1)
}

/// Applies a command repeatedly, undoing it each time.
pub(super) fn timed(
    document: &mut Document,
    name: &str,
    command: &Command,
    runs: usize,
) -> Result<Option<EditReport>, CommandError> {
    let mut voxels = 0;
    let times = measure(runs, || {
        let start = Instant::now();
        voxels = document.apply(command)?.stats.voxels_changed();
        let time = start.elapsed();
        take_back(document)?;
        Ok::<Duration, CommandError>(time)
    })?;
    Ok(times.map(|times| EditReport::of(name, voxels, times)))
}

/// Meshes of the cheese after a ball of radius 64 is carved out of its middle: the blocks remade for the changed
/// voxels.
fn meshes_made_anew(document: &mut Document, runs: usize) -> Result<Vec<EditReport>, CommandError> {
    document.apply(&Command::Begin { label: String::new() })?;
    for sphere in &holes() {
        document.apply(sphere)?;
    }
    document.apply(&Command::End)?;
    let ball = subtract(Solid::Ellipsoid, MIDDLE_VX, Vec3::splat(HALF_EDGE_VX), Quat::IDENTITY);
    let mut reports = Vec::new();
    for (name, kind) in [
        ("faces made anew after a sphere of 64", MeshKind::Faces),
        ("smooth mesh made anew after that", MeshKind::Smooth),
    ] {
        let Some(mut kept) = KeptMesh::new(kind, VertexColours::None) else { continue };
        let (subscriber, mut number) = (ChangeSubscriber::default(), 0);
        let mut follow = |document: &mut Document| {
            let limits = *document.limits();
            let start = Instant::now();
            number += 1;
            document.drain_changes_for(&subscriber, |contents, bricks| {
                let version = ContentsVersion { number, changed: bricks.map(<[u32]>::to_vec) };
                // Limits with room for the cheese have room for its mesh; without one there is nothing to measure.
                let made = kept.update(contents, &version, &limits, &());
                made.ok().map(|[anew, _]| (start.elapsed(), anew))
            })
        };
        if follow(document).is_none() {
            continue;
        }
        let mut blocks = 0;
        let times = measure(runs, || {
            document.apply(&ball)?;
            let (time, anew) = follow(document).unwrap_or_default();
            blocks = anew as u64;
            take_back(document)?;
            follow(document);
            Ok::<Duration, CommandError>(time)
        })?;
        reports.extend(times.map(|times| EditReport::of(name, blocks, times)));
    }
    take_back(document)?;
    Ok(reports)
}

/// Returns the 2000 spheres of the cheese.
fn holes() -> Vec<Command> {
    let mut random = Random(1);
    let sphere = |_| {
        let centre = Vec3::new(random.unit(), random.unit(), random.unit());
        let radius = Vec3::splat(4.0 + 24.0 * random.unit());
        subtract(Solid::Ellipsoid, centre * BLOCK_VX as f32, radius, Quat::IDENTITY)
    };
    (0..2000).map(sphere).collect()
}

/// Returns the 2000 spheres of the cheese as commands of one stroke, with undo and redo.
fn carves(document: &mut Document, runs: usize) -> Result<Vec<EditReport>, CommandError> {
    let spheres = holes();
    let mut voxels = 0;
    let (mut undo, mut redo) = (Vec::new(), Vec::new());
    let times = measure(runs, || {
        document.apply(&Command::Begin { label: String::new() })?;
        let start = Instant::now();
        voxels = 0;
        for sphere in &spheres {
            voxels += document.apply(sphere)?.stats.voxels_changed();
        }
        document.apply(&Command::End)?;
        let time = start.elapsed();
        let mut timed = |command: Command, times: &mut Vec<Duration>| {
            let start = Instant::now();
            let result = document.apply(&command);
            times.push(start.elapsed());
            result
        };
        timed(Command::Undo { steps: Some(1) }, &mut undo)?;
        timed(Command::Redo { steps: Some(1) }, &mut redo)?;
        take_back(document)?;
        Ok::<Duration, CommandError>(time)
    })?;
    let named = [
        ("2000 spheres of the cheese", times),
        ("undo of these", Times::of(&undo)),
        ("redo of these", Times::of(&redo)),
    ];
    let reports = named.into_iter();
    Ok(reports.filter_map(|(name, times)| Some(EditReport::of(name, voxels, times?))).collect())
}

pub(super) fn subtract(solid: Solid, centre_vx: Vec3, half: Vec3, rotation: Quat) -> Command {
    let primitive = Primitive { solid, centre_vx, half, rotation };
    Command::Construct { op: EditOp::Subtract, primitive, to_vx: None }
}

pub(super) fn take_back(document: &mut Document) -> Result<(), CommandError> {
    document.apply(&Command::Undo { steps: Some(1) })?;
    document.drain_changes(|_, _| ());
    Ok(())
}

/// Returns a full block.
pub(super) fn block(colour_depth: ColourDepth, limits: Limits) -> Result<Document, CommandError> {
    let new = NewSculpture {
        dims: UVec3::splat(BLOCK_VX),
        voxel_size: Vec3::ONE,
        colour_depth,
        base: Rgb::new(200, 190, 170),
        solid: true,
        room_vx: 0,
        grows: false,
    };
    Document::new(&new, limits)
}

/// Latencies from an edit to its picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct EditToImage {
    /// From the command to the shaded picture.
    pub shaded: Times,
    /// From there to the finished picture, if that is another stage.
    pub composite: Option<Times>,
}

/// Number of edits until the sculpture is restored: few enough to leave most of it.
const BITES: usize = 20;

/// Subtracts balls at the visible surface, and measures each from the command to the shaded
/// picture. A picture at rest follows each, as in a window, and is not measured. Takes at most `patience`, except for one run and the smallest number of runs.
pub fn edit_to_image(
    document: &mut Document,
    pictures: &mut BenchPictures,
    radius_vx: f32,
    strokes: usize,
    patience: Duration,
) -> Result<Option<EditToImage>, GpuError> {
    let mut random = Random(32);
    let mut shaded = Vec::with_capacity(strokes);
    let mut composite = Vec::with_capacity(strokes);
    let mut measured = Duration::ZERO;
    let mut bites = 0;
    // Nothing is visible: the eye is inside of the sculpture, or the grid is empty.
    let mut missed = 0;
    while shaded.len() < strokes
        && missed < 1000
        && (shaded.len() < LEAST_RUNS || measured < patience)
    {
        // With separate rays, since some modes have no index map in memory.
        let rays = *pictures.rays();
        let at = random.next_u64();
        let (x, y) = (at as u32 % rays.size.x, (at >> 32) as u32 % rays.size.y);
        let Some(hit) = raycast::cast(document.grid(), rays.origin, rays.direction(x, y)) else {
            missed += 1;
            continue;
        };
        missed = 0;
        let centre = hit.voxel.as_vec3() + 0.5;
        let half = Vec3::splat(radius_vx);
        let bite = subtract(Solid::Ellipsoid, centre, half, Quat::IDENTITY);
        let start = Instant::now();
        if document.apply(&bite).is_err() {
            break;
        }
        let edited = start.elapsed();
        let after = pictures.after_edit(document)?;
        measured += edited + after.shaded;
        shaded.push(edited + after.shaded);
        composite.extend(after.composite);
        pictures.settle(document)?;
        bites += 1;
        if bites == BITES {
            renew(document, pictures, bites)?;
            bites = 0;
        }
    }
    renew(document, pictures, bites)?;
    let composite = Times::of(&composite);
    Ok(Times::of(&shaded).map(|shaded| EditToImage { shaded, composite }))
}

/// Undoes edits, in sculpture and picture.
fn renew(
    document: &mut Document,
    pictures: &mut BenchPictures,
    bites: usize,
) -> Result<(), GpuError> {
    // Undo cannot fail outside of a stroke.
    let undo = Command::Undo { steps: Some(bites as u32) };
    if bites > 0 && document.apply(&undo).is_ok() {
        pictures.after_edit(document)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_edit_is_reported_and_taken_back() {
        let reports = edits(1, Limits::default()).unwrap();
        assert_eq!(reports.len(), 3 * Solid::ALL.len() + 1 + DrawnSolid::ALL.len() + 5);
        let voxels = |name: &str| reports.iter().find(|r| r.name.starts_with(name)).unwrap().voxels;
        let ball = 4.0 / 3.0 * std::f64::consts::PI * 64f64.powi(3);
        assert!((voxels("ellipsoid") as f64 / ball - 1.0).abs() < 1e-3);
        assert_eq!(voxels("cuboid"), 128 * 128 * 128);
        assert!((voxels("turned cylinder") as f64 / (1.5 * ball) - 1.0).abs() < 1e-3);
        // A prism on the silhouette is added.
        assert!(
            (voxels("sweep of a turned ellipsoid") as f64 / ball
                - 1.0
                - 0.75 * 166f64.sqrt() / 64.0)
                .abs()
                < 1e-3
        );
        assert!(voxels("sweep of a turned cylinder") > voxels("turned cylinder") * 21 / 20);
        assert!(voxels("sweep of a turned torus") > voxels("turned torus") * 21 / 20);
        // Radii of a third and two thirds.
        let torus = std::f64::consts::PI.powi(2) * 4.0 / 27.0 * 64f64.powi(3);
        assert!((voxels("turned torus") as f64 / torus - 1.0).abs() < 1e-3);
        assert!((voxels("half space") as f64 / 512f64.powi(3) - 0.5).abs() < 0.05);
        let ring = 2.0 * std::f64::consts::PI.powi(2) * 64.0 * 16.0 * 16.0;
        assert!((voxels("turned ring") as f64 / ring - 1.0).abs() < 1e-3);
        assert!(voxels("tube") > 200_000);
        assert!(voxels("turned lathe") > 1_000_000);
        assert!(voxels("turned extrusion") > 10_000);
        assert!(voxels("2000 spheres") > 1 << 24);
        assert!(reports.iter().all(|r| r.voxels_per_s > 0.0));
    }
}
