//! The view follows a head that a script moves.

use std::time::Duration;

use super::display_of;
use super::program::Program;

/// The sculpture, less the panels.
const PICTURE: [u32; 4] = [150, 50, 800, 680];

#[test]
fn the_picture_goes_with_the_head_and_rests_without() {
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
    // The head moves, and nothing else does: pictures differ by themselves.
    let until = |what: &str, is_so: &dyn Fn() -> bool| program.until(what, is_so);
    until("pictures come", &|| program.pictures() > 10);
    let before = display.picture();
    before.save("head-1-left");
    let moved = || display.picture().part(PICTURE).differing(&before.part(PICTURE)) > 20_000;
    until("the picture goes with the head", &moved);
    display.picture().save("head-2-right");

    // The window that leads through the calibration, and away again.
    program.leave_picture();
    program.key(&["Control_L", "Shift_L", "h"]);
    let shown = program.pictures();
    until("the window opens", &|| program.pictures() > shown + 5);
    display.picture().save("head-3-calibration");
    program.key(&["Escape"]);

    // Without the head nothing moves any more.
    program.key(&["Control_L", "h"]);
    program.settle();
    let off = display.picture();
    off.save("head-4-off");
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(display.picture().part(PICTURE).differing(&off.part(PICTURE)), 0);
    program.key(&["Control_L", "q"]);
    program.expect_clean_exit();
}
