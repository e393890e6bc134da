//! The view follows a scripted head.

use std::time::Duration;

use super::display_of;
use super::program::Program;

/// The sculpture without the panels.
const PICTURE: [u32; 4] = [150, 50, 800, 680];

#[test]
fn the_view_follows_the_head_and_stays_without_it() {
    let display = display_of([1280, 800]);
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("head.txt");
    let poses =
        "rate 60\nloop\n0 -0.2 0.1 0.5 0 0 0 1\n2 0.2 0 0.5 0 0 0 1\n4 -0.2 0.1 0.5 0 0 0 1\n";
    std::fs::write(&script, poses).unwrap();
    let settings = format!(
        "[new]\ndims = [96, 96, 96]\n[window]\nguide = false\n[screen]\nsize_m = [0.5, 0.3]\n\
         [tracking]\non = true\nsource = \"script:{}\"\n",
        script.display()
    );
    let program = Program::start_with(&display, &[], &settings);
    // Only the head moves, so the picture changes without any input.
    let until = |what: &str, is_so: &dyn Fn() -> bool| program.until(what, is_so);
    until("pictures are shown", &|| program.pictures() > 10);
    let before = display.picture();
    before.save("head-1-left");
    let moved = || display.picture().part(PICTURE).differing(&before.part(PICTURE)) > 20_000;
    until("the view follows the head", &moved);
    display.picture().save("head-2-right");

    // The calibration window opens and closes.
    program.leave_picture();
    program.key(&["Control_L", "Shift_L", "h"]);
    let shown = program.pictures();
    until("the window opens", &|| program.pictures() > shown + 5);
    display.picture().save("head-3-calibration");
    program.key(&["Escape"]);

    // Without head tracking nothing moves.
    program.key(&["Control_L", "h"]);
    program.settle();
    let off = display.picture();
    off.save("head-4-off");
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(display.picture().part(PICTURE).differing(&off.part(PICTURE)), 0);
    program.key(&["Control_L", "q"]);
    program.expect_clean_exit();
}
