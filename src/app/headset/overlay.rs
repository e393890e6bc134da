//! The overlay of a headset's pictures: tool previews and lines as in the window, the cone of a brush
//! in the hand, the ray to the board, and a grid on the floor.

use std::f32::consts::TAU;

use glam::Vec3;

use crate::app::overlay::{self, OverlayScene};
use crate::app::workspace::Workspace;
use crate::editor::hand::grid_point;
use crate::render::overlay::{OverlayLine, ToolPreview};
use crate::sculpture::Rgb;
use crate::view::Room;

/// Half the side of the floor's grid and the distance between its lines, in metres.
const FLOOR_M: f32 = 2.0;
const FLOOR_STEP_M: f32 = 0.5;
const FLOOR: Rgb = Rgb::new(0x8a, 0x94, 0xa4);
const RAY: Rgb = Rgb::new(0x4a, 0xc8, 0xf0);
const SEGMENTS: usize = 32;

/// Returns everything that is drawn besides the sculpture. `ray`: from a hand to the board; `floor`: draws a grid on
/// the floor, since the pictures hide the real one.
pub fn overlay(
    workspace: &Workspace,
    room: &Room,
    ray: Option<[Vec3; 2]>,
    floor: bool,
) -> (Option<ToolPreview>, Vec<OverlayLine>) {
    // The pointer and the surface under it belong to the window.
    let scene = OverlayScene { seen: None, pointer: None, ..workspace.overlay_scene() };
    let (preview, mut lines) = (overlay::preview(&scene), overlay::lines(&scene));
    let line =
        |from, to, colour, width_px, opacity| OverlayLine { from, to, colour, width_px, opacity };
    let editor = &workspace.editor;
    let cone = editor.hand.cone(editor.document(), &editor.tool, room);
    if let Some(cone) = cone.filter(|_| workspace.ui.view.tool) {
        let tip = cone.eye_vx + cone.aim;
        let rim = |i: usize| {
            let (sin, cos) = (TAU * i as f32 / SEGMENTS as f32).sin_cos();
            tip + (cone.across * cos + cone.down * sin) * cone.radius
        };
        let colour = editor.tool.colour;
        lines.extend((0..SEGMENTS).map(|i| line(rim(i), rim(i + 1), colour, 1.4, [0.9, 0.3])));
        lines.push(line(cone.eye_vx, tip, colour, 1.2, [0.6, 0.2]));
    }
    let at = |point| grid_point(editor.document(), point, room);
    if let Some([from, to]) = ray {
        lines.push(line(at(from), at(to), RAY, 1.8, [0.8, 0.8]));
    }
    if floor {
        let count = (2.0 * FLOOR_M / FLOOR_STEP_M) as i32;
        for i in 0..=count {
            let x = i as f32 * FLOOR_STEP_M - FLOOR_M;
            for [from, to] in [
                [Vec3::new(x, 0.0, -FLOOR_M), Vec3::new(x, 0.0, FLOOR_M)],
                [Vec3::new(-FLOOR_M, 0.0, x), Vec3::new(FLOOR_M, 0.0, x)],
            ] {
                lines.push(line(at(from), at(to), FLOOR, 1.0, [0.35, 0.0]));
            }
        }
    }
    (preview, lines)
}
