//! Tests augmented reality: the sculpture on a marker, with drawn frames as the camera.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{UVec2, Vec2, Vec3};

use super::Workspace;
use crate::config::Config;
use crate::editor::tool::ToolKind;
use crate::fiducial::family;
use crate::input::{Action, ActionEvent, Bindings};
use crate::session::Session;
use crate::surface::{IndexMap, raycast};
use crate::tools::brush::BrushId;
use crate::video::{Fit, Framing, Intrinsics, VideoFrame};
use crate::viewpoint::ar::{CameraView, rest};

const FOCAL_PX: f64 = 600.0;
/// Size in pixels of a cell of the drawn marker: 80 mm wide and 0.4 m away at this focal length.
const CELL_PX: f64 = 15.0;

fn workspace() -> Workspace {
    let toml = "[new]\ndims = [20, 40, 20]\n[ar]\nmarker = 4\nvoxel_mm = 1.0";
    let config = Config::parse(toml, std::path::Path::new("test.toml")).unwrap();
    let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    Workspace::new(session, &config, Bindings::presets().unwrap())
}

fn lens() -> Intrinsics {
    let even = Intrinsics::pinhole(640, 480, 1.0);
    Intrinsics { fx: FOCAL_PX, fy: FOCAL_PX, ..even }
}

/// Returns a frame with the marker straight before the camera and its middle at `middle` in pixels, or without a
/// marker.
fn frame(sequence: u64, middle: Option<(f64, f64)>) -> Arc<VideoFrame> {
    let mut pixels = Vec::new();
    for (x, y) in (0..480).flat_map(|y| (0..640).map(move |x| (x, y))) {
        let cell = |v: i32, middle: f64| ((f64::from(v) - middle) / CELL_PX + 4.0).floor();
        let white = middle.is_none_or(|middle| {
            let (x, y) = (cell(x, middle.0), cell(y, middle.1));
            let printed = x >= 0.0 && y >= 0.0;
            !printed || family::is_white(4, x as usize, y as usize).unwrap_or(true)
        });
        let grey = if white { 220 } else { 30 };
        pixels.extend([grey, grey, grey, 255]);
    }
    Arc::new(VideoFrame { width: 640, height: 480, pixels, sequence, ..VideoFrame::empty() })
}

/// Gives a frame and waits until it has been searched for the marker.
fn see(workspace: &mut Workspace, frame: &Arc<VideoFrame>, now_s: f64) {
    let look = CameraView { lens: Some(lens()), fit: Fit::Fill, mirror: false };
    workspace.viewpoint.ar.see(frame, look);
    let started = Instant::now();
    while workspace.viewpoint.ar.frame().is_none_or(|shown| shown.sequence != frame.sequence) {
        assert!(started.elapsed() < Duration::from_secs(60), "the frame was not looked through");
        std::thread::sleep(Duration::from_millis(1));
        workspace.track_at(now_s);
    }
}

/// Returns the position of a grid point in the camera's picture, in pixels.
fn pixel(workspace: &Workspace, voxel: Vec3) -> Vec2 {
    let eye = workspace.eye();
    let clip = eye.clip_from_grid(&workspace.world_from_grid()) * voxel.extend(1.0);
    let screen = Vec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5;
    let framing = Framing::new(UVec2::new(640, 480), eye.size, Fit::Fill, false);
    framing.picture_from_screen(screen) * Vec2::new(640.0, 480.0) - 0.5
}

#[test]
fn the_sculpture_stands_on_the_marker_and_goes_with_it() {
    let mut workspace = workspace();
    workspace.track_at(0.0);
    workspace.act(Action::ToggleAr);
    assert_eq!(workspace.eye(), workspace.viewpoint.turntable.eye(), "no frames yet");
    let (mut now_s, mut sequence) = (0.0, 0);
    for middle in [(320.0, 240.0), (200.0, 300.0), (400.0, 200.0)] {
        // At first it comes from its rest position.
        for _ in 0..6 {
            (now_s, sequence) = (now_s + 0.1, sequence + 1);
            see(&mut workspace, &frame(sequence, Some(middle)), now_s);
        }
        // Its edges lie between pixels: half a pixel is subtracted from the coordinates.
        let middle = Vec2::new(middle.0 as f32, middle.1 as f32) - 0.5;
        // Upright on the marker: the lower side of the grid lies on the middle of the paper.
        let foot = pixel(&workspace, Vec3::new(10.0, 0.0, 10.0));
        assert!(foot.distance(middle) < 1.0, "{foot} {middle}");
        // 10 voxels of 1 mm to the right are 10 mm, 0.4 m away.
        let right = pixel(&workspace, Vec3::new(20.0, 0.0, 10.0));
        assert!((right - foot).distance(Vec2::new(15.0, 0.0)) < 0.3, "{}", right - foot);
        // Its front faces the lower edge of the marker.
        let front = pixel(&workspace, Vec3::new(10.0, 0.0, 20.0));
        assert!((front - foot).distance(Vec2::new(0.0, 15.0)) < 0.3, "{}", front - foot);
        // The top is 40 mm nearer.
        let side = Vec3::new(20.0, 40.0, 10.0) - Vec3::new(10.0, 40.0, 10.0);
        let top = pixel(&workspace, Vec3::new(10.0, 40.0, 10.0));
        let across = pixel(&workspace, Vec3::new(10.0, 40.0, 10.0) + side) - top;
        assert!((across.x - 600.0 * 10.0 / 360.0).abs() < 0.3, "{across}");
    }
    workspace.answer_event(&ActionEvent::Wheel {
        action: Action::Zoom,
        notches: 1.0,
        at: Vec2::ZERO,
    });
    assert!((workspace.viewpoint.ar.status().voxel_mm - 1.1).abs() < 1e-5);
    workspace.act(Action::ToggleAr);
    assert_eq!(workspace.eye(), workspace.viewpoint.turntable.eye());
}

#[test]
fn a_lost_marker_is_held_then_left_without_a_jump() {
    let mut workspace = workspace();
    workspace.track_at(0.0);
    workspace.act(Action::ToggleAr);
    see(&mut workspace, &frame(1, Some((320.0, 240.0))), 0.1);
    let mut now_s = 0.1;
    let mut last = workspace.viewpoint.ar.placement().position_m;
    let mut step_to = |workspace: &mut Workspace, to_s: f64, now_s: &mut f64| {
        while *now_s < to_s {
            *now_s += 0.016;
            workspace.track_at(*now_s);
            let place = workspace.viewpoint.ar.placement().position_m;
            assert!(place.distance(last) < 0.02, "a jump at {now_s}");
            last = place;
        }
    };
    see(&mut workspace, &frame(2, None), now_s);
    step_to(&mut workspace, 0.9, &mut now_s);
    assert!(!workspace.viewpoint.ar.status().seen);
    step_to(&mut workspace, 4.0, &mut now_s);
    assert!(workspace.viewpoint.ar.placement().position_m.distance(rest().position_m) < 1e-6);
    see(&mut workspace, &frame(3, Some((320.0, 240.0))), now_s);
    let mut sequence = 3;
    for _ in 0..30 {
        sequence += 1;
        now_s += 0.016;
        see(&mut workspace, &frame(sequence, Some((320.0, 240.0))), now_s);
        step_to(&mut workspace, now_s, &mut now_s);
    }
    assert!(workspace.viewpoint.ar.status().seen);
    assert!((workspace.viewpoint.ar.placement().position_m.z + 0.4).abs() < 2e-3);
}

/// Presses on the middle of the sculpture as it is shown.
fn press(workspace: &mut Workspace) -> Vec2 {
    let picker = workspace.picker();
    let sight = picker.sight();
    let mut map = IndexMap::new(sight.rays);
    let document = workspace.session().document();
    raycast::sample(document.grid(), &sight.rays, &mut map);
    let at = sight.pixel_of(document.contents().frame.centre_vx()).unwrap();
    let Workspace { viewpoint, editor, .. } = workspace;
    viewpoint.set_pick_map(Arc::new(map), editor.document());
    workspace.answer_event(&ActionEvent::Begin { action: Action::Sculpt, at: Some(at) });
    assert!(workspace.editor.is_stroking());
    at
}

fn drag(workspace: &mut Workspace, at: Vec2, by: Vec2) {
    workspace.answer_event(&ActionEvent::Drag { action: Action::Sculpt, at, by });
}

#[test]
fn a_leap_of_the_marker_ends_the_stroke_of_the_pointer() {
    for tool in [ToolKind::Solid, ToolKind::Brush(BrushId::Devour), ToolKind::Brush(BrushId::Grab)]
    {
        let mut workspace = workspace();
        workspace.editor.tool.kind = tool;
        workspace.track_at(0.0);
        workspace.act(Action::ToggleAr);
        let (mut now_s, mut sequence) = (0.0, 0);
        let mut show = |workspace: &mut Workspace, middle: Option<f64>| {
            (now_s, sequence) = (now_s + 0.033, sequence + 1);
            see(workspace, &frame(sequence, middle.map(|x| (x, 240.0))), now_s);
        };
        (0..15).for_each(|_| show(&mut workspace, Some(120.0)));
        assert!(workspace.viewpoint.ar.status().seen);

        // 13 mm in 33 ms is a movement; 270 mm is a jump.
        let at = press(&mut workspace);
        show(&mut workspace, Some(140.0));
        drag(&mut workspace, at + 1.0, Vec2::ONE);
        assert!(workspace.editor.is_stroking(), "{tool:?}");
        show(&mut workspace, Some(540.0));
        assert!(!workspace.editor.is_stroking(), "{tool:?}: a tunnel would be cut");
        // Nothing more happens until the button is released.
        let state =
            (workspace.session().document().grid().opaque_count(), workspace.editor.tool.centre_vx);
        drag(&mut workspace, at + 40.0, Vec2::splat(39.0));
        assert!(!workspace.editor.is_stroking());
        assert_eq!(
            (workspace.session().document().grid().opaque_count(), workspace.editor.tool.centre_vx),
            state
        );
        workspace.answer_event(&ActionEvent::End(Action::Sculpt));

        // The same holds when the marker is lost and when it returns.
        for lost in [true, false] {
            press(&mut workspace);
            (0..12).for_each(|_| show(&mut workspace, (!lost).then_some(540.0)));
            assert_eq!(workspace.viewpoint.ar.status().seen, !lost);
            assert!(!workspace.editor.is_stroking(), "{tool:?}, lost: {lost}");
            workspace.answer_event(&ActionEvent::End(Action::Sculpt));
        }
    }
}
