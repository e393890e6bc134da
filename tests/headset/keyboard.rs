//! Typing a name on the board's keyboard with a ray and a trigger.

use egui::{Pos2, Rect, vec2};
use virtual_sculpture::ui::widgets::keyboard::{Cap, keys, place};

use super::program::Program;
use super::remote::{Remote, Side};
use super::runtime::alone_in_network;
use super::{begin, open_board, point_at_board, press_board};

/// The board, in points.
const BOARD: Rect = Rect { min: Pos2::ZERO, max: Pos2::new(1000.0, 640.0) };
/// The button in the bar, in fractions of the board.
const SAVE_AS: [f32; 2] = [151.0 / 1000.0, 17.0 / 640.0];

/// Where a key is, in fractions of the board, while the field is in its lower part.
fn key(cap: Cap) -> [f32; 2] {
    let field = Rect::from_min_size(Pos2::new(300.0, 500.0), vec2(300.0, 20.0));
    let (_, rect) = keys(place(field, BOARD)).find(|(other, _)| *other == cap).unwrap();
    let at = rect.center();
    [at.x / BOARD.width(), at.y / BOARD.height()]
}

/// Presses a key, after `before` others, and waits until press and release are handled.
fn press_key(remote: &mut Remote, program: &Program, cap: Cap, before: usize) {
    point_at_board(remote, program, key(cap));
    remote.trigger(Side::Right, true);
    program.wait_for_log("key of the board pressed", before + 1);
    remote.trigger(Side::Right, false);
    program.wait_for_log("key of the board released", before + 1);
}

#[test]
fn a_file_is_saved_under_a_name_typed_with_a_ray() {
    if !alone_in_network() {
        return;
    }
    let (_runtime, mut remote, program) = begin();
    open_board(&mut remote, &program);
    assert!(!program.log().contains("keyboard on the board"), "no field has the focus");
    press_board(&mut remote, &program, SAVE_AS);
    // The field of the name has the focus, and the proposed name is selected.
    program.wait_for_log("keyboard on the board", 1);
    let letter = |small: char| Cap::Char(small, small.to_ascii_uppercase());
    // A held Backspace repeats; at the start of the text there is nothing left to delete.
    let typed = [
        Cap::Backspace,
        letter('a'),
        Cap::Shift,
        letter('b'),
        Cap::Char('_', '~'),
        Cap::Char('1', '!'),
        Cap::Enter,
    ];
    for (before, cap) in typed.into_iter().enumerate() {
        press_key(&mut remote, &program, cap, before);
    }
    program.wait_for_log("keyboard gone", 1);
    program.wait_for_file("aB_1.vsc");
    program.stop();
}
