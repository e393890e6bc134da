//! Single kernels, for profilers that count instructions: `bench --kernel ray cheese --repeat 11`
//! less `--repeat 1` is ten runs of the kernel and nothing else.

use std::time::Instant;

use clap::ValueEnum;
use glam::{EulerRot, Quat, UVec2, Vec3};

use super::statistics::Times;
use super::subjects::eye_of;
use crate::command::Command;
use crate::document::Document;
use crate::sculpture::edit::EditOp;
use crate::shade::{self, Lighting, NormalField, Pixels, ShadePose, ShadeSource};
use crate::surface::{IndexMap, quickstep, raycast};
use crate::tools::solid::{Primitive, Solid};

/// The kernels.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Kernel {
    /// Exact ray caster, a whole picture
    Ray,
    /// Quickstep, a whole picture
    Quickstep,
    /// Software shader, a whole picture
    Shade,
    /// Normals of all surface voxels
    Normals,
    /// Subtracting a ball of radius 64, and undo
    Sphere,
    /// Subtracting a turned ellipsoid, and undo
    Ellipsoid,
}

/// Runs a kernel `repeat` times after its setup, and returns the times. `size`: of the picture, in
/// pixels.
pub fn run(kernel: Kernel, document: &mut Document, size: UVec2, repeat: usize) -> Option<Times> {
    let eye = eye_of(document, size);
    let world_from_grid = document.world_from_grid();
    let rays = eye.pixel_rays(&world_from_grid);
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    let mut map = IndexMap::new(rays);
    let mut pixels = Pixels::new(rays.size);
    if kernel == Kernel::Shade {
        raycast::sample(document.grid(), &rays, &mut map);
    }
    let lighting = Lighting::default();
    let carve = |rotation, half| {
        let centre_vx = document.grid().dims().as_vec3() * 0.49;
        let primitive = Primitive { solid: Solid::Ellipsoid, centre_vx, half, rotation };
        Command::Construct { op: EditOp::Subtract, primitive, to_vx: None }
    };
    let ball = carve(Quat::IDENTITY, Vec3::splat(64.0));
    let turn = Quat::from_euler(EulerRot::XYZ, 0.4, 0.7, 1.1);
    let ellipsoid = carve(turn, Vec3::new(64.0, 40.0, 90.0));
    let mut edit = |command: &Command| {
        let undo = Command::Undo { steps: Some(1) };
        // Neither can fail outside of a stroke.
        if document.apply(command).is_ok() && document.apply(&undo).is_ok() {
            document.drain_changes(|_, _| ());
        }
    };
    let mut times = Vec::with_capacity(repeat);
    for _ in 0..repeat {
        let start = Instant::now();
        match kernel {
            Kernel::Sphere => edit(&ball),
            Kernel::Ellipsoid => edit(&ellipsoid),
            Kernel::Ray | Kernel::Quickstep | Kernel::Shade | Kernel::Normals => {}
        }
        times.push(start.elapsed());
    }
    let (grid, material) = (document.grid(), document.material());
    let normals = match kernel {
        Kernel::Shade => NormalField::of(grid),
        _ => NormalField::default(),
    };
    let source = ShadeSource { grid, material, normals: &normals, mask: None };
    for time in &mut times {
        let start = Instant::now();
        match kernel {
            Kernel::Ray => raycast::sample(grid, &rays, &mut map),
            Kernel::Quickstep => quickstep::sample(grid, &rays, &mut map),
            Kernel::Shade => shade::shade(&map, &source, &pose, &lighting, &mut pixels),
            Kernel::Normals => {
                std::hint::black_box(NormalField::of(grid));
            }
            Kernel::Sphere | Kernel::Ellipsoid => {}
        }
        *time += start.elapsed();
    }
    Times::of(&times)
}
