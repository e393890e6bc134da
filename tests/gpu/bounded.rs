//! Pictures of a sculpture whose normals take more memory than its document allows, as a window makes them: every view
//! that rests becomes the picture of a renderer that has all normals.

use std::time::Duration;

use glam::{Affine3A, UVec2, Vec3};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::render::{FrameDesc, RenderMode, SmoothSurface};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material, Rgb};
use virtual_sculpture::shade::{NormalField, Pixels};
use virtual_sculpture::view::Camera;

use super::fixture::with_device;
use super::refine::{Painter, desc};

const EDGE: u32 = 160;
/// The frames within which a resting picture is to be complete.
const MOST_FRAMES: usize = 2000;
/// The time that a screen waits after a frame.
const SCREEN: Duration = Duration::from_millis(10);

fn document(limits: Limits) -> Document {
    document_of(scenes::cheese(EDGE, 60, 5).unwrap(), limits)
}

fn document_of(grid: Grid, limits: Limits) -> Document {
    let material = Material::for_grid(&grid, ColourDepth::None, Rgb::new(200, 180, 160));
    Document::from_contents(Contents::new(grid, material), limits)
}

/// Paints until the picture is complete. Returns it, and the number of frames.
fn rest(painter: &mut Painter, document: &mut Document, desc: &FrameDesc) -> (Vec<Pixels>, usize) {
    rest_at(painter, document, desc, Duration::ZERO)
}

/// Does the same at the rate of a screen, which waits after each frame.
fn rest_at(
    painter: &mut Painter,
    document: &mut Document,
    desc: &FrameDesc,
    wait: Duration,
) -> (Vec<Pixels>, usize) {
    for frame in 1..MOST_FRAMES {
        let (report, pictures) = painter.paint(document, desc);
        if report.complete {
            return (pictures, frame);
        }
        std::thread::sleep(wait);
    }
    panic!("{:?} is not complete within {MOST_FRAMES} frames", desc.mode);
}

#[test]
fn a_resting_picture_has_all_its_normals_however_little_memory_they_may_take() {
    with_device(|device| {
        let mut whole = document(Limits::default());
        let all_bytes = NormalField::of(whole.grid()).heap_bytes();
        let limits = Limits { grid_bytes: all_bytes / 6, ..Limits::default() };
        let mut bounded = document(limits);
        let sides = [Vec3::X, Vec3::Y, -Vec3::X, -Vec3::Z, Vec3::new(0.8, 0.6, 1.0), Vec3::X];
        for mode in [
            RenderMode::Ray,
            RenderMode::RayPoints,
            RenderMode::Slicing,
            RenderMode::March,
            RenderMode::MarchGpu,
        ] {
            let mut window = Painter::new(device, FORMAT);
            window.renderer.set_patience(Some(Duration::from_millis(1)));
            let mut reference = Painter::new(device, FORMAT);
            let mut counts = Vec::new();
            for side in sides {
                // Less than three voxels a pixel, so that all normals are refined.
                let eyes = [Camera::framing(110.0, side, Vec3::Y).eye(UVec2::new(240, 180))];
                let world_from_grid = Affine3A::from_translation(Vec3::splat(-0.5 * EDGE as f32));
                let desc = FrameDesc { world_from_grid, ..desc(mode, &eyes) };
                let (expected, _) = rest(&mut reference, &mut whole, &desc);
                let (found, frames) = rest(&mut window, &mut bounded, &desc);
                assert!(found == expected, "{mode:?} from {side}, after {frames} frames");
                counts.push(frames);
            }
            // The first side has lost its normals to the others meanwhile, where index maps tell what is seen.
            let is_bounded = mode != RenderMode::MarchGpu;
            assert_eq!(counts[5] > 1, is_bounded, "{mode:?}: {counts:?}");
        }
    });
}

/// The smooth surface, antialiased, of a sculpture whose normals do not fit: what a view at rest shows is computed for it,
/// also where it was removed, or edited out of sight, meanwhile.
#[test]
fn a_resting_picture_has_all_of_its_smooth_surface() {
    with_device(|device| {
        let mut whole = document(Limits::default());
        let all_bytes = NormalField::of(whole.grid()).heap_bytes();
        let limits = Limits { grid_bytes: all_bytes / 6, ..Limits::default() };
        let mut bounded = document(limits);
        let painter = |patience| {
            let mut painter = Painter::new(device, FORMAT);
            painter.renderer.set_patience(patience);
            painter.renderer.set_refinement(3);
            painter
        };
        let mut window = painter(Some(Duration::from_millis(1)));
        let mut reference = painter(None);
        let aslant = Vec3::new(0.8, 0.6, 1.0);
        let mut frames = Vec::new();
        for (side, edit) in [
            (Vec3::X, None),
            (Vec3::Y, None),
            (-Vec3::X, Some("subtract ellipsoid at=150,80,80 half=20")),
            (aslant, Some("add ellipsoid at=80,150,80 half=16")),
            (Vec3::X, None),
            (Vec3::Y, Some("undo")),
            (Vec3::Y, None),
        ] {
            for document in [&mut whole, &mut bounded] {
                edit.iter().for_each(|line| _ = document.apply(&line.parse().unwrap()).unwrap());
            }
            // Of more than a pixel for each voxel.
            let eyes = [Camera::framing(55.0, side, Vec3::Y).eye(UVec2::new(200, 150))];
            let world_from_grid = Affine3A::from_translation(Vec3::splat(-0.5 * EDGE as f32));
            let smooth_surface = SmoothSurface::AtRest;
            let desc =
                FrameDesc { world_from_grid, smooth_surface, ..desc(RenderMode::Ray, &eyes) };
            let (expected, _) = rest(&mut reference, &mut whole, &desc);
            let (found, count) = rest(&mut window, &mut bounded, &desc);
            assert!(found == expected, "from {side} after {edit:?} and {count} frames");
            let blocky = FrameDesc { smooth_surface: SmoothSurface::Never, ..desc };
            assert!(rest(&mut reference, &mut whole, &blocky).0 != expected, "it is not smooth");
            frames.push(count);
        }
        assert!(frames[4] > 5 && frames[6] < frames[4], "{frames:?}");
    });
}

/// No frame waits for the cells of the smooth surface of a large sculpture. Edits meanwhile are not lost.
#[test]
fn a_large_sculpture_is_smooth_once_its_cells_are_found() {
    with_device(|device| {
        let grid = scenes::gyroid_shell(640).unwrap();
        assert!(grid.heap_bytes() > 8 << 20, "it is not large: {} bytes", grid.heap_bytes());
        // So that few normals are computed beside those that are seen.
        let limits = Limits { grid_bytes: grid.heap_bytes() / 4 * 5, ..Limits::default() };
        let mut shown = document_of(grid, limits);
        let mut window = Painter::new(device, FORMAT);
        window.renderer.set_patience(Some(Duration::from_millis(20)));
        window.renderer.set_refinement(2);
        // A corner, of some pixels for each voxel.
        let eyes = [Camera::framing(30.0, Vec3::ONE, Vec3::Y).eye(UVec2::new(120, 90))];
        let corner = Affine3A::from_translation(Vec3::splat(-616.0));
        let smooth_surface = SmoothSurface::AtRest;
        let desc =
            FrameDesc { world_from_grid: corner, smooth_surface, ..desc(RenderMode::Ray, &eyes) };
        for edit in ["subtract ellipsoid at=626,621,616 half=12", "undo"] {
            for _ in 0..6 {
                window.paint(&mut shown, &desc);
            }
            shown.apply(&edit.parse().unwrap()).unwrap();
            let (found, frames) = rest_at(&mut window, &mut shown, &desc, SCREEN);
            let mut same = document_of(shown.grid().clone(), limits);
            let mut other = Painter::new(device, FORMAT);
            other.renderer.set_patience(Some(Duration::from_secs(60)));
            other.renderer.set_refinement(2);
            let (expected, _) = rest_at(&mut other, &mut same, &desc, SCREEN);
            assert!(found == expected, "after {edit} and {frames} frames");
        }
    });
}
