//! Pictures in the window: a final one, shown while it is traced and given up by Escape, and one that is pasted.

use super::display::Picture;
use super::{Program, display, screenshot, start, tool_home};

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
    let before = screenshot(&program, "final-1-before");
    assert_eq!(brighter(&before.part(BESIDE), 120), 90 * 200);
    let before = before.part(UPPER);
    program.key(&["Shift_L", "F12"]);
    let dialog = screenshot(&program, "final-2-dialog");
    let dialog = lit(&dialog.part(PREVIEW));
    program.key(&["Return"]);
    program.until("the picture in progress is shown", || {
        let picture = now(&program);
        let is_dimmed = brighter(&picture.part(BESIDE), 120) == 0;
        is_dimmed && lit(&picture.part(PREVIEW)) > dialog + 20_000
    });
    now(&program).save("final-3-in-progress");
    program.key(&["Escape"]);
    let after = screenshot(&program, "final-4-cancelled").part(UPPER);
    assert_eq!(before.differing(&after), 0);
    program.close();
    program.expect_clean_exit();
}

#[test]
fn a_copied_picture_is_pasted_as_a_reference() {
    let display = display();
    let program = start(&display, &[]);
    tool_home(&program);
    let before = screenshot(&program, "paste-0-before");
    let pasted = program.folder().join(".local/state/virtual-sculpture/pasted");
    program.key(&["Control_L", "v"]);
    let nothing = screenshot(&program, "paste-1-nothing");
    assert!(nothing.differing(&before) > 1000 && !pasted.exists(), "it is said");
    program.key(&["Control_L", "F12"]);
    program.settle();
    let copied = program.copied_picture();
    program.key(&["Control_L", "v"]);
    let kept = || std::fs::read_dir(&pasted).ok()?.next()?.ok().map(|file| file.path());
    program.until("the picture is kept", || kept().is_some_and(|path| path.extension().is_some()));
    let picture = image::open(kept().unwrap()).unwrap().to_rgb8();
    assert!(picture.dimensions() == copied.dimensions() && picture.as_raw() == copied.as_raw());
    screenshot(&program, "paste-2-reference");
    program.close();
    program.expect_clean_exit();
}
