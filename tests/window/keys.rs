//! Key bindings changed in the window and used at once, the command palette, and copies by key with an
//! empty clipboard.

use super::program::{Program, REFINED};
use super::{PICTURE, display, screenshot, tool_home};

fn start<'a>(display: &'a super::Display, theme: &str) -> Program<'a> {
    let program = Program::start_themed(display, theme);
    program.leave_picture();
    program.settle();
    program
}

fn write(program: &Program, text: &str) {
    for letter in text.chars() {
        match letter {
            ' ' => program.key(&["space"]),
            '=' => program.key(&["equal"]),
            ',' => program.key(&["comma"]),
            letter => program.key(&[&letter.to_string()]),
        }
    }
    program.settle();
}

#[test]
fn a_key_is_changed_used_and_saved_and_the_palette_runs_a_command() {
    let display = display();
    let program = start(&display, "dark");
    tool_home(&program);
    let before = screenshot(&program, "keys-0-before").part(PICTURE);

    // Bind "clear" to J: filter for it, then its + button.
    program.key(&["F1"]);
    screenshot(&program, "keys-1-table-dark");
    program.click(FILTER);
    write(&program, "delete every");
    screenshot(&program, "keys-2-filtered");
    program.click(ADD);
    screenshot(&program, "keys-3-listening");
    program.key(&["j"]);
    screenshot(&program, "keys-4-added");
    program.click(ADD);
    program.key(&["Control_L", "z"]);
    screenshot(&program, "keys-5-conflict");
    program.key(&["Escape"]);
    program.settle();
    program.key(&["Escape"]);
    program.settle();
    tool_home(&program);
    assert_eq!(before.differing(&screenshot(&program, "keys-6-closed").part(PICTURE)), 0);
    let kept = program.folder().join(".config/virtual-sculpture/bindings.toml");
    let text = std::fs::read_to_string(kept).unwrap();
    assert!(text.contains("clear = [\"ctrl+delete\", \"j\"]"), "{text}");

    program.key(&["j"]);
    let cleared = screenshot(&program, "keys-7-cleared").part(PICTURE);
    assert!(before.differing(&cleared) > 20_000, "the new key clears");
    program.key(&["Control_L", "z"]);
    assert_eq!(before.differing(&screenshot(&program, "keys-8-undone").part(PICTURE)), 0);

    program.key(&["Control_L", "p"]);
    screenshot(&program, "keys-9-palette-dark");
    write(&program, "subtract cuboid at=48,48,88 half=");
    screenshot(&program, "keys-10-palette-error");
    write(&program, "16");
    screenshot(&program, "keys-11-palette-command");
    program.key(&["Return"]);
    program.settle();
    tool_home(&program);
    let cut = screenshot(&program, "keys-12-cut").part(PICTURE);
    assert!(before.differing(&cut) > 1000, "the typed command was run");
    program.close();
    program.leave_without_saving();
}

#[test]
fn copies_are_pasted_by_key_with_an_empty_clipboard() {
    let display = display();
    let program = start(&display, "light");
    program.key(&["F1"]);
    screenshot(&program, "keys-20-table-light");
    program.key(&["Escape"]);
    program.key(&["F3"]);
    screenshot(&program, "keys-21-palette-light");
    write(&program, "mark at=40,40,80 size=16,16,16");
    program.key(&["Return"]);
    program.settle();
    program.key(&["q"]);
    program.key(&["Control_L", "c"]);
    program.key(&["Delete"]);
    program.settle();
    let gone = screenshot(&program, "keys-22-gone").part(PICTURE);
    program.key(&["Control_L", "v"]);
    program.settle();
    let pasted = screenshot(&program, "keys-23-pasted").part(PICTURE);
    assert!(gone.differing(&pasted) > 300, "Ctrl+V pastes");
    program.close();
    program.leave_without_saving();
}

/// The filter of the controls window, and the + of the first row below it.
const FILTER: [i16; 2] = [600, 160];
const ADD: [i16; 2] = [639, 250];

#[test]
fn a_picture_of_the_view_is_saved_by_key_without_tool_and_lines() {
    let display = display();
    let program = Program::start_with(&display, &[], REFINED);
    program.leave_picture();
    program.settle();
    tool_home(&program);
    let before = screenshot(&program, "keys-30-before");
    program.key(&["F12"]);
    screenshot(&program, "keys-31-saved");
    // Pictures of a sculpture without a file go to the person's folder of pictures.
    let saved = image::open(program.folder().join("sculpture-1.png")).unwrap().to_rgb8();
    let [_, _, width, height] = PICTURE;
    assert!(saved.width() >= width && saved.height() >= height);
    // Stone and background are nearly grey, the cutting tool is red.
    let red = |[r, g, _]: [u8; 3]| r > g.saturating_add(25);
    let stone = |[r, g, b]: [u8; 3]| r > 120 && g > 100 && b > 80;
    let saved: Vec<[u8; 3]> = saved.pixels().map(|pixel| pixel.0).collect();
    let shown = before.part(PICTURE).pixels();
    let count = |of: &[[u8; 3]], is: fn([u8; 3]) -> bool| of.iter().filter(|p| is(**p)).count();
    assert!(count(&shown, red) > 100, "the tool is red, and nothing else");
    assert_eq!(count(&saved, red), 0);
    assert!(count(&saved, stone) > 20_000);

    // The same picture goes to the clipboard.
    program.key(&["Control_L", "F12"]);
    program.settle();
    let copied: Vec<[u8; 3]> = program.copied_picture().pixels().map(|pixel| pixel.0).collect();
    assert_eq!(copied.len(), saved.len());
    assert!(copied == saved, "the copied picture differs from the saved one");
    program.close();
    program.expect_clean_exit();

    // It is the refined one: without refinement its edges are others, and nothing else.
    let display = self::display();
    let program = self::start(&display, "dark");
    program.key(&["F12"]);
    program.settle();
    let plain = image::open(program.folder().join("sculpture-1.png")).unwrap().to_rgb8();
    let differing = plain.pixels().zip(&saved).filter(|(a, b)| a.0 != **b).count();
    assert!((200..saved.len() / 20).contains(&differing), "{differing} pixels were refined");
    program.close();
    program.expect_clean_exit();
}
