//! Panels in windows of their own, and the scale of text and buttons.

use super::program::Program;
use super::{LEFT, display_of, screenshot, tool_home};

/// Space for the main window, at the left, and windows of panels beside it.
const SCREEN: [u32; 2] = [1700, 800];
/// The sculpture, with the toolbox docked or detached.
const PICTURE: [u32; 4] = [150, 50, 800, 680];
/// The buttons that detach the toolbox and the options.
const DETACH_TOOLBOX: [i16; 2] = [100, 52];
const DETACH_OPTIONS: [i16; 2] = [1256, 52];
/// The rectangle of the toolbox's window.
const TOOLBOX: [u32; 4] = [1300, 20, 110, 740];
/// The button of the cuboid in it.
const CUBOID: [i16; 2] = [1379, 95];
/// A point outside of all windows.
const NOWHERE: [i16; 2] = [1690, 790];

fn start<'a>(display: &'a super::Display, theme: &str) -> Program<'a> {
    let program = Program::start_themed(display, theme);
    display.device(6, 0, NOWHERE);
    program.settle();
    program
}

#[test]
fn a_detached_toolbox_works_with_the_main_window_and_docks() {
    let display = display_of(SCREEN);
    let program = start(&display, "dark");
    tool_home(&program);
    let docked = screenshot(&program, "detached-0-docked");

    program.click(DETACH_TOOLBOX);
    assert!(program.has_window("Toolbox"));
    program.place_panel("Toolbox", TOOLBOX);
    display.device(6, 0, NOWHERE);
    let detached = screenshot(&program, "detached-1-toolbox");
    assert!(detached.part(TOOLBOX).colours() > 20, "the toolbox is shown in its window");
    let column = [0, 70, 70, 380];
    assert!(
        docked.part(column).differing(&detached.part(column)) > 1000,
        "it left the main window"
    );

    // A tool selected there is used in the main window.
    program.click(CUBOID);
    display.device(6, 0, NOWHERE);
    let cuboid = screenshot(&program, "detached-2-cuboid");
    assert!(detached.part(PICTURE).differing(&cuboid.part(PICTURE)) > 100);
    assert!(detached.part(TOOLBOX).differing(&cuboid.part(TOOLBOX)) > 1000);

    // A stroke in the main window is undone by a key in the panel; a key in the main window selects
    // a tool in the panel.
    program.drag(LEFT, &[[430, 380], [470, 400], [520, 410]]);
    display.device(6, 0, NOWHERE);
    tool_home(&program);
    let cut = screenshot(&program, "detached-3-cut").part(PICTURE);
    assert!(cuboid.part(PICTURE).differing(&cut) > 1500);
    program.key_in_panel("Toolbox", &["Control_L", "z"]);
    let undone = screenshot(&program, "detached-4-undone");
    assert_eq!(cuboid.part(PICTURE).differing(&undone.part(PICTURE)), 0);
    program.key(&["e"]);
    let ball = screenshot(&program, "detached-5-ball");
    assert_eq!(detached.part(TOOLBOX).differing(&ball.part(TOOLBOX)), 0);

    // A resized window is filled to its edges.
    let large = [1300, 20, 250, 700];
    program.place_panel("Toolbox", large);
    let resized = screenshot(&program, "detached-6-resized");
    let corner = resized.part([1540, 700, 8, 18]);
    assert_eq!(corner.colours(), 1);
    assert_eq!(corner.differing(&resized.part([1302, 22, 8, 18])), 0, "the panel's background");
    for size in [[120, 140], [333, 222], [97, 600]] {
        program.place_panel("Toolbox", [1300, 20, size[0], size[1]]);
        program.settle();
    }
    program.place_panel("Toolbox", large);
    let again = screenshot(&program, "detached-7-resized-again");
    assert_eq!(resized.part(large).differing(&again.part(large)), 0);

    // An idle program draws in neither window.
    let pictures = program.pictures();
    std::thread::sleep(std::time::Duration::from_secs(1));
    assert!(program.pictures() - pictures <= 1);

    program.close_panel("Toolbox");
    let back = screenshot(&program, "detached-8-back");
    assert!(!program.has_window("Toolbox"));
    let toolbox = [0, 36, 115, 730];
    assert_eq!(docked.part(toolbox).differing(&back.part(toolbox)), 0);

    // Detached again, it has its former position and size.
    program.click(DETACH_TOOLBOX);
    assert_eq!(program.panel_place("Toolbox"), large);
    // With unsaved changes, quitting from the panel asks in the main window.
    program.key_in_panel("Toolbox", &["space"]);
    program.settle();
    program.key_in_panel("Toolbox", &["Control_L", "q"]);
    screenshot(&program, "detached-9-leaving");
    program.leave_without_saving();
}

#[test]
fn the_window_stays_responsive_while_a_large_sculpture_is_saved() {
    let display = display_of([1280, 800]);
    let settings = "[new]\ndims = [448, 448, 448]\ncolour_bits = 0\n\
                    [window]\ntheme = \"light\"\n[render]\nrefine = false\n";
    let program = Program::start_with(&display, &[], settings);
    program.leave_picture();
    program.settle();
    let before = screenshot(&program, "saving-0-before").part(PICTURE);
    program.key(&["g"]);
    program.click([500, 400]);
    program.leave_picture();
    let error = screenshot(&program, "saving-0-error").part(PICTURE);
    assert!(before.differing(&error) > 1000, "painting without colours is an error message");
    program.key(&["Control_L", "s"]);
    let dialog = screenshot(&program, "saving-1-dialog");
    program.key(&["Return"]);
    display.picture().save("saving-2-bar");
    program.close();
    let file = program.folder().join("sculpture.vsc");
    // Closing waits for the end of the save, and then does not ask.
    let (status, text) = program.wait();
    assert!(status.success(), "{text}");
    assert!(dialog.colours() > 20);
    let info = virtual_sculpture::format::info(&file).unwrap();
    assert_eq!(info.dims.to_array(), [448; 3]);
}

#[test]
fn all_panels_are_detached_in_the_light_theme_and_scaled_together() {
    let display = display_of(SCREEN);
    let program = start(&display, "light");
    program.click(DETACH_TOOLBOX);
    program.click(DETACH_OPTIONS);
    // The history has no fixed position to click.
    program.key(&["F8"]);
    program.place_panel("Toolbox", [1290, 10, 110, 480]);
    program.place_panel("Options", [1410, 10, 280, 780]);
    program.place_panel("History", [1000, 480, 270, 280]);
    display.device(6, 0, NOWHERE);
    let usual = screenshot(&program, "detached-light-1");
    assert!(["Toolbox", "Options", "History"].iter().all(|title| program.has_window(title)));

    program.key_in_panel("Options", &["Control_L", "minus"]);
    program.key_in_panel("History", &["Control_L", "minus"]);
    program.key(&["Control_L", "minus"]);
    let small = screenshot(&program, "detached-light-2-small");
    for part in [[1290, 10, 110, 480], [1410, 10, 280, 780], [1000, 480, 270, 280], [0, 0, 900, 34]]
    {
        assert!(usual.part(part).differing(&small.part(part)) > 200, "{part:?}");
    }
    program.key_in_panel("Toolbox", &["Control_L", "0"]);
    let reset = screenshot(&program, "detached-light-3-reset");
    for part in [[1290, 10, 110, 480], [1410, 10, 280, 780], [1000, 480, 270, 280]] {
        assert_eq!(usual.part(part).differing(&reset.part(part)), 0, "{part:?}");
    }
    program.key_in_panel("Options", &["Control_L", "s"]);
    screenshot(&program, "detached-light-4-modal");
    program.key(&["Return"]);
    screenshot(&program, "detached-light-5-saved");
    // Quitting with detached panels.
    program.key_in_panel("Toolbox", &["Control_L", "q"]);
    program.expect_clean_exit();
}
