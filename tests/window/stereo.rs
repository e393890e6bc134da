//! Two eyes in one window.

use super::program::Program;
use super::{LEFT, display_of, screenshot, tool_home};

const SCREEN: [u32; 2] = [1280, 800];
/// The sculpture in a mono window.
const PICTURE: [u32; 4] = [150, 50, 800, 680];

#[test]
fn a_stroke_in_the_right_eyes_half_cuts_where_it_is_seen() {
    let display = display_of(SCREEN);
    let program = Program::start(&display, &[]);
    program.leave_picture();
    program.settle();
    tool_home(&program);
    let mono = screenshot(&program, "stereo-0-mono");

    // Without quad-buffered images the next layout is side by side.
    program.key(&["Alt_L", "s"]);
    program.leave_picture();
    let side = screenshot(&program, "stereo-1-side-by-side");
    let (left, right) = (side.part([0, 0, 640, 800]), side.part([640, 0, 640, 800]));
    assert!(side.differing(&mono) > 100_000);
    let parallax = left.differing(&right);
    assert!((2_000..250_000).contains(&parallax), "two eyes, one interface: {parallax}");

    // In the right half, where the right eye sees the centre of the block.
    program.drag(LEFT, &[[900, 380], [920, 400], [945, 410]]);
    program.leave_picture();
    tool_home(&program);
    let cut = screenshot(&program, "stereo-2-cut");
    assert!(cut.part([640, 0, 640, 800]).differing(&right) > 1000, "the right eye sees the cut");
    assert!(cut.part([0, 0, 640, 800]).differing(&left) > 1000, "so does the left one");

    // Through all layouts, back to mono.
    let mut before = cut;
    for name in ["top-bottom", "rows", "columns", "anaglyph", "mono"] {
        program.key(&["Alt_L", "s"]);
        program.leave_picture();
        let shown = screenshot(&program, &format!("stereo-3-{name}"));
        assert!(shown.differing(&before) > 10_000, "{name} is another picture");
        before = shown;
    }
    program.key(&["Control_L", "z"]);
    program.leave_picture();
    let undone = screenshot(&program, "stereo-4-undone").part(PICTURE);
    assert_eq!(undone.differing(&mono.part(PICTURE)), 0, "mono is as it was");
    // Everything is undone, so quitting does not ask.
    program.key(&["Control_L", "q"]);
    program.expect_clean_exit();
}
