//! State kept between runs: the program is used, closed and started again, and looks as before.

use super::program::{Program, SETTINGS};
use super::{LEFT, display_of, screenshot};

/// Room for the main window and that of a panel.
const SCREEN: [u32; 2] = [1700, 800];
const HISTORY: [u32; 4] = [1300, 20, 250, 500];
/// A point outside of all windows.
const NOWHERE: [i16; 2] = [1690, 790];

#[test]
fn the_program_restores_its_state() {
    let display = display_of(SCREEN);
    let program = Program::start_with(&display, &[], SETTINGS);
    program.leave_picture();
    program.settle();
    let folder = program.folder().to_path_buf();
    screenshot(&program, "memory-0-first");
    program.resize([1100, 720]);
    program.key(&["c"]);
    program.key(&["t"]);
    program.key(&["F8"]);
    program.settle();
    program.place_panel("History", HISTORY);
    program.key(&["Control_L", "equal"]);
    display.device(6, 0, NOWHERE);
    let left = screenshot(&program, "memory-1-left");
    program.key(&["Control_L", "q"]);
    program.expect_clean_exit();
    let kept = folder.join(".local/state/virtual-sculpture/state.toml");
    let text = std::fs::read_to_string(&kept).unwrap();
    assert!(text.contains("window = [1100, 720]"), "{text}");

    let program = Program::start_in(&display, folder.clone(), &[], SETTINGS);
    program.settle();
    assert_eq!(program.size(), [1100, 720]);
    assert_eq!(program.panel_place("History"), HISTORY);
    display.device(6, 0, NOWHERE);
    let again = screenshot(&program, "memory-2-again");
    // The same picture of the sculpture with the same tool.
    let sculpture = [140, 60, 660, 600];
    assert_eq!(left.part(sculpture).differing(&again.part(sculpture)), 0);
    // Elsewhere edges of panels are rounded to other pixels, since the scale was changed while it
    // ran, and the status line shows the time of the last picture.
    let all = [0, 0, 1100, 720];
    let others = left.part(all).differing(&again.part(all));
    assert!(others < 1100 * 720 / 100, "{others}");

    // After a stroke, a killed program, and damage to the file it still starts.
    program.drag(LEFT, &[[430, 380], [470, 400]]);
    program.settle();
    drop(program);
    for damage in ["", "theme = ", "\u{fffd}\u{0}", "window = [3, 3]\nscale = -1\n"] {
        std::fs::write(&kept, damage).unwrap();
        let program = Program::start_in(&display, folder.clone(), &[], SETTINGS);
        program.settle();
        assert_eq!(program.size(), [1280, 800], "{damage:?}");
        assert!(!program.has_window("History"));
        program.close();
        let (status, output) = program.wait();
        assert!(status.success(), "{damage:?}: {output}");
    }
    let text = std::fs::read_to_string(&kept).unwrap();
    assert!(text.contains("window = [1280, 800]"), "{text}");
}
