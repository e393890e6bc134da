//! A final picture in the window: shown while it is traced, and given up by Escape.

use super::display::Picture;
use super::{Program, display, shot, start, tool_home};

/// Where the picture in progress is shown.
const PREVIEW: [u32; 4] = [430, 200, 420, 400];
/// The sculpture beside it: dark behind a dialog.
const BESIDE: [u32; 4] = [310, 280, 90, 200];
/// The sculpture above the messages.
const UPPER: [u32; 4] = [250, 60, 600, 500];

/// Pixels as bright as ground in the sun, as little else is behind and in a dialog.
fn lit(picture: &Picture) -> usize {
    brighter(picture, 150)
}

fn brighter(picture: &Picture, than: u8) -> usize {
    picture.pixels().iter().filter(|rgb| rgb.iter().all(|value| *value > than)).count()
}

fn now(program: &Program) -> Picture {
    program.display().picture()
}

#[test]
fn a_final_picture_is_shown_while_it_is_traced_and_escape_gives_it_up() {
    let display = display();
    let program = start(&display, &[]);
    tool_home(&program);
    let before = shot(&program, "final-1-before");
    assert_eq!(brighter(&before.part(BESIDE), 120), 90 * 200);
    let before = before.part(UPPER);
    program.key(&["Shift_L", "F12"]);
    let dialog = shot(&program, "final-2-dialog");
    let dialog = lit(&dialog.part(PREVIEW));
    program.key(&["Return"]);
    program.until("the picture in progress is shown", || {
        let picture = now(&program);
        let is_dimmed = brighter(&picture.part(BESIDE), 120) == 0;
        is_dimmed && lit(&picture.part(PREVIEW)) > dialog + 20_000
    });
    now(&program).save("final-3-in-progress");
    program.key(&["Escape"]);
    let after = shot(&program, "final-4-cancelled").part(UPPER);
    assert_eq!(before.differing(&after), 0);
    program.close();
    program.expect_clean_exit();
}
