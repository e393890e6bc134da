//! Light and ground in the window: the ground with its lines, smooth edges, and the window of lights in both themes.

use super::program::{Program, SETTINGS};
use super::{display, screenshot, tool_home};

/// The picture of the sculpture without the lower part, in which messages are shown.
const UPPER: [u32; 4] = [120, 50, 900, 520];
/// Beside the foot of the sculpture.
const LOWER: [u32; 4] = [130, 500, 180, 200];
/// The window of lights.
const LIGHTS: [u32; 4] = [120, 50, 330, 600];

#[test]
fn the_ground_and_the_window_of_lights_are_shown_in_both_themes() {
    let display = display();
    for theme in ["dark", "light"] {
        let program = Program::start_themed(&display, theme);
        program.leave_picture();
        program.settle();
        tool_home(&program);
        let start = screenshot(&program, &format!("light-{theme}-10-start"));
        program.key(&["Control_L", "Alt_L", "g"]);
        let ground = screenshot(&program, &format!("light-{theme}-11-ground"));
        assert!(start.part(LOWER).differing(&ground.part(LOWER)) > 15_000, "{theme}: no ground");
        program.click([755, 17]);
        // On a busy machine it takes some pictures until the window has its size.
        let shown = (0..50).any(|_| {
            let lights = screenshot(&program, &format!("light-{theme}-12-lights"));
            ground.part(LIGHTS).differing(&lights.part(LIGHTS)) > 40_000
        });
        assert!(shown, "{theme}: no lights");
        program.close();
    }
}

#[test]
fn smooth_edges_differ_at_outlines_alone() {
    let display = display();
    let [sharp, smooth] = ["off", "on"].map(|edges| {
        let settings =
            SETTINGS.replace("[render]\n", &format!("[render]\nsmooth_edges = \"{edges}\"\n"));
        let program = Program::start_with(&display, &[], &settings);
        program.leave_picture();
        program.settle();
        tool_home(&program);
        let picture = screenshot(&program, &format!("light-20-edges-{edges}"));
        program.close();
        picture
    });
    let differing = sharp.part(UPPER).differing(&smooth.part(UPPER));
    assert!((200..10_000).contains(&differing), "{differing}");
}
