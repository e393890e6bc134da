//! The program in its window, under a private X server, with real mouse and key events.
//!
//! Needs `Xvfb` (Debian, Ubuntu: xvfb). Without it the tests are skipped, or fail with
//! `VS_REQUIRE_WINDOW=1`; so are those on Wayland without `weston`. Screenshots are left in
//! target/test-output/window.

mod changed_on_disk;
mod clay;
mod disks;
mod display;
mod draw;
mod endings;
mod failures;
mod head;
mod house;
mod import;
mod in_use;
mod keys;
mod kills;
mod light;
mod masks;
mod memory;
mod panels;
mod pictures;
mod print_check;
mod process;
mod program;
mod stereo;
mod view;
mod wayland;

use std::time::Duration;

use crate::gpu::fixture::need_device;

use display::{Display, Picture};
use program::Program;

const LEFT: u8 = 1;
const MIDDLE: u8 = 2;
const RIGHT: u8 = 3;

/// The picture of the sculpture within a window of 1280x800, with a margin to the panels.
const PICTURE: [u32; 4] = [120, 50, 900, 700];

/// The program on a display of its own, idle, with a sculpture of 96^3 voxels.
fn start<'a>(display: &'a Display, arguments: &[&str]) -> Program<'a> {
    ready(Program::start(display, arguments))
}

fn ready(program: Program) -> Program {
    program.leave_picture();
    program.settle();
    program
}

/// A display of the usual size.
fn display() -> Display {
    display_of([1280, 800])
}

/// A display of another size in pixels. Skips the test where there is no X server or no Vulkan device.
fn display_of(size: [u32; 2]) -> Display {
    need_device();
    Display::start(size).unwrap_or_else(|lack| trials::lacks("VS_REQUIRE_WINDOW", &lack))
}

/// Moves the tool to its initial position, so that pictures of the same voxels are equal.
fn tool_home(program: &Program) {
    program.key(&["Shift_L", "Home"]);
    program.settle();
}

fn screenshot(program: &Program, name: &str) -> Picture {
    program.settle();
    let picture = program.display().picture();
    picture.save(name);
    picture
}

#[test]
fn a_stroke_changes_the_picture_and_undo_restores_it() {
    let display = display();
    let program = ready(Program::start(&display, &[]));
    tool_home(&program);
    let before = screenshot(&program, "1-before").part(PICTURE);
    let colours = before.colours();
    assert!(colours > 50, "only {colours} colours: is there a picture?");

    program.drag(LEFT, &[[430, 380], [470, 400], [520, 410], [560, 400]]);
    tool_home(&program);
    let after = screenshot(&program, "2-after-a-stroke").part(PICTURE);
    let changed = before.differing(&after);
    assert!(changed > 1500, "the stroke changed {changed} pixels");

    program.key(&["Control_L", "z"]);
    let undone = screenshot(&program, "3-undone").part(PICTURE);
    assert_eq!(before.differing(&undone), 0, "undo restores the picture");
    program.key(&["Control_L", "y"]);
    let redone = screenshot(&program, "4-redone").part(PICTURE);
    assert_eq!(after.differing(&redone), 0, "redo restores the stroke");

    // Painting and the other render modes.
    program.key(&["g"]);
    program.drag(LEFT, &[[640, 250], [700, 260]]);
    tool_home(&program);
    let slicing = screenshot(&program, "5-painted-slicing").part(PICTURE);
    assert!(redone.differing(&slicing) > 500);
    program.key(&["m"]);
    let ray = screenshot(&program, "6-ray-caster").part(PICTURE);
    program.key(&["m"]);
    let quickstep = screenshot(&program, "7-quickstep").part(PICTURE);
    // The samplers may differ along silhouettes only.
    let pixels = PICTURE[2] * PICTURE[3];
    for other in [&ray, &quickstep] {
        let share = slicing.differing(other) as f32 / pixels as f32;
        assert!(share < 0.01, "{share} of the pixels differ");
    }
    program.key(&["m"]);

    // Closing asks, since the sculpture is not saved.
    program.close();
    let asked = screenshot(&program, "8-save-before-leaving");
    assert!(asked.differing(&redone.clone().on(&asked, PICTURE)) > 1000, "the question is shown");
    assert!(program.is_running());
    program.key(&["Escape"]);
    program.settle();
    assert!(program.is_running());
    program.key(&["Control_L", "q"]);
    program.settle();
    program.leave_without_saving();
}

#[test]
fn the_view_rotates_pans_and_zooms_and_home_resets_it() {
    let display = display();
    let program = start(&display, &[]);
    tool_home(&program);
    let before = screenshot(&program, "view-1-home").part(PICTURE);
    program.drag(RIGHT, &[[500, 400], [600, 420], [700, 440]]);
    let rotated = screenshot(&program, "view-2-rotated").part(PICTURE);
    assert!(before.differing(&rotated) > 20_000);
    program.drag(MIDDLE, &[[500, 400], [560, 360]]);
    let panned = screenshot(&program, "view-3-panned").part(PICTURE);
    assert!(rotated.differing(&panned) > 10_000);
    program.wheel([500, 400], 3);
    let zoomed = screenshot(&program, "view-4-zoomed").part(PICTURE);
    assert!(panned.differing(&zoomed) > 10_000);
    program.drag(LEFT, &[[140, 70], [190, 80]]);
    let beside = screenshot(&program, "view-5-rotated-beside").part(PICTURE);
    assert!(zoomed.differing(&beside) > 10_000, "a drag beside the sculpture rotates it");
    program.key(&["Home"]);
    tool_home(&program);
    let home = screenshot(&program, "view-6-home-again").part(PICTURE);
    assert_eq!(before.differing(&home), 0);
    program.close();
    program.expect_clean_exit();
}

#[test]
fn the_window_is_resized_minimised_and_restored() {
    let display = display();
    let program = start(&display, &[]);
    tool_home(&program);
    let before = screenshot(&program, "size-1-before");
    for (i, size) in [[800, 600], [1000, 700], [640, 480], [333, 222], [40, 30]].iter().enumerate()
    {
        program.resize(*size);
        screenshot(&program, &format!("size-2-{i}-{}x{}", size[0], size[1]));
        assert!(program.is_running(), "{size:?}");
    }
    program.resize([1280, 800]);
    let back = screenshot(&program, "size-3-back");
    // The status line shows another time of the last picture.
    assert_eq!(before.part(PICTURE).differing(&back.part(PICTURE)), 0);

    program.hide();
    program.settle();
    let pictures = program.pictures();
    std::thread::sleep(Duration::from_secs(1));
    let drawn = program.pictures() - pictures;
    assert!(drawn <= 5, "{drawn} pictures in a second of a hidden window");
    program.show();
    let restored = screenshot(&program, "size-4-restored");
    assert_eq!(before.part(PICTURE).differing(&restored.part(PICTURE)), 0);

    // An idle program draws nothing.
    let pictures = program.pictures();
    std::thread::sleep(Duration::from_secs(2));
    let drawn = program.pictures() - pictures;
    assert!(drawn <= 1, "{drawn} pictures in two idle seconds");

    // Many resizes, faster than they can be drawn.
    for i in 0..20 {
        program.resize([700 + 25 * i, 500 + 13 * i]);
    }
    program.resize([1280, 800]);
    let back = screenshot(&program, "size-5-after-many");
    assert_eq!(before.part(PICTURE).differing(&back.part(PICTURE)), 0);
    program.close();
    program.expect_clean_exit();
}

#[test]
fn every_window_opens_by_key_and_closes_by_escape() {
    let display = display();
    let program = start(&display, &[]);
    tool_home(&program);
    let before = screenshot(&program, "panels-0-none").part(PICTURE);
    for (name, keys) in [
        ("help", &["F1"][..]),
        ("new", &["Control_L", "n"]),
        ("final-picture", &["Shift_L", "F12"]),
        ("film", &["Alt_L", "F12"]),
        ("open", &["Control_L", "o"]),
        ("save-as", &["Control_L", "Shift_L", "s"]),
    ] {
        program.key(keys);
        let open = screenshot(&program, &format!("panels-{name}")).part(PICTURE);
        assert!(before.differing(&open) > 10_000, "{name} is shown");
        // The first Escape leaves a text field, the second closes the window.
        program.key(&["Escape"]);
        program.settle();
        if before.differing(&program.display().picture().part(PICTURE)) > 0 {
            program.key(&["Escape"]);
        }
        let closed = screenshot(&program, &format!("panels-{name}-closed")).part(PICTURE);
        assert_eq!(before.differing(&closed), 0, "{name} is closed");
    }
    program.close();
    program.expect_clean_exit();
}

#[test]
fn a_file_that_cannot_be_opened_is_an_error_before_any_window() {
    let display = display();
    let program = Program::start(&display, &["/nonexistent/statue.pvm"]);
    let (status, text) = program.wait();
    assert_eq!(status.code(), Some(3), "{text}");
    assert!(text.contains("/nonexistent/statue.pvm"), "{text}");
}
