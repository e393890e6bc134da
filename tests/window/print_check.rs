//! The print check in the window: the panel in both themes, and the marks in the picture.

use std::process::Command;

use super::display::Picture;
use super::program::SETTINGS;
use super::{PICTURE, Program, display, ready, screenshot};

/// A block with a cavity, a thin fin, an arm and a cube in the air.
const SCRIPT: &str = "new dims=96,96,96 fill=empty
add cuboid at=44,24,48 half=20,24,20
subtract cuboid at=44,24,48 half=6
add cuboid at=44.5,56,48 half=0.5,9,16
add cuboid at=76,40,48 half=14,4,12
add cuboid at=44,84,48 half=5
";

/// Pixels of the colour of marks, drawn over whatever lies behind them.
fn magenta(picture: &Picture) -> usize {
    let is_mark = |[r, g, b]: &[u8; 3]| *r > 130 && *b > 110 && *g < 120 && r.abs_diff(*b) < 80;
    picture.pixels().iter().filter(|rgb| is_mark(rgb)).count()
}

#[test]
fn faults_are_marked_in_the_picture() {
    let display = display();
    let folder = tempfile::tempdir().unwrap();
    let [script, file] = ["s.sculpt", "a.vsc"].map(|name| folder.path().join(name));
    std::fs::write(&script, SCRIPT).unwrap();
    let mut run = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"));
    let made = run.arg("run").arg(&script).arg("--out").arg(&file).output().unwrap();
    assert!(made.status.success());
    for theme in ["dark", "light"] {
        let settings = SETTINGS.replace("[window]\n", &format!("[window]\ntheme = \"{theme}\"\n"));
        let program = Program::start_with(&display, &[file.to_str().unwrap()], &settings);
        let program = ready(program);
        let before = screenshot(&program, &format!("print-1-before-{theme}"));
        assert_eq!(magenta(&before.part(PICTURE)), 0);
        program.key(&["Control_L", "Alt_L", "p"]);
        program.until("the findings are marked", || {
            magenta(&program.display().picture().part(PICTURE)) > 100
        });
        screenshot(&program, &format!("print-2-found-{theme}"));
        program.key(&["Escape"]);
        let after = screenshot(&program, &format!("print-3-closed-{theme}"));
        assert_eq!(magenta(&after.part(PICTURE)), 0);
        program.close();
        program.expect_clean_exit();
    }
}
