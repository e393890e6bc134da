//! Masks in the interface: painted with the brush, put by solids, wand and the window of masks, and obeyed by tools.

use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::Queryable;
use glam::{IVec3, Vec3};
use virtual_sculpture::editor::tool::NextPress;
use virtual_sculpture::editor::wand::WandRule;
use virtual_sculpture::input::ToolMode;
use virtual_sculpture::sculpture::Rgb;
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::tools::brush::keys::REACH;

use super::bench::{
    Bench, bench, click, corner, drag, has, key, look, press, rest, run, screen, send, voxels,
};

const FULL: u64 = 64 * 64 * 64;

/// A workspace with a solid block of 64^3 voxels, seen from the front.
fn front() -> Bench {
    let mut harness = bench();
    rest(&mut harness);
    run(&mut harness, "place");
    harness
}

fn masked(harness: &Bench) -> u64 {
    harness.state().session().document().mask().map_or(0, |mask| mask.opaque_count())
}

fn is_masked(harness: &Bench, v: [i32; 3]) -> bool {
    harness.state().session().document().contents().is_masked(IVec3::from(v))
}

fn steps(harness: &Bench) -> usize {
    harness.state().session().document().history().undo_count()
}

fn at(harness: &Bench, x: f32, y: f32) -> Pos2 {
    screen(harness, Vec3::new(x, y, 64.0))
}

fn stroke(harness: &mut Bench, modifiers: Modifiers, from: [f32; 2], to: [f32; 2]) {
    let path = [from, to].map(|[x, y]| at(harness, x, y));
    drag(harness, PointerButton::Primary, modifiers, &path);
}

#[test]
fn a_painted_mask_protects_from_the_tool_and_is_undone_like_a_stroke() {
    let mut harness = front();
    key(&mut harness, Modifiers::SHIFT, Key::Q);
    harness.state_mut().editor.tool.brushes.of_mut(BrushId::Mask).set(REACH, 1.5);
    stroke(&mut harness, Modifiers::NONE, [20.0, 32.0], [44.0, 32.0]);
    assert!(is_masked(&harness, [32, 32, 63]) && is_masked(&harness, [32, 32, 65 - 2]));
    assert!(!is_masked(&harness, [32, 60, 63]));
    assert_eq!((voxels(&harness), steps(&harness)), (FULL, 1), "no voxel changes, one step");
    // Inverted it takes protection away.
    let before = masked(&harness);
    stroke(&mut harness, Modifiers::COMMAND, [20.0, 32.0], [22.0, 32.0]);
    assert!(masked(&harness) < before && !is_masked(&harness, [20, 32, 63]));
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(masked(&harness), before);
    // A ball cuts all around, and nothing that is masked.
    key(&mut harness, Modifiers::NONE, Key::E);
    key(&mut harness, Modifiers::NONE, Key::R);
    stroke(&mut harness, Modifiers::NONE, [32.0, 32.0], [32.0, 33.0]);
    let document = harness.state().session().document();
    assert!(voxels(&harness) < FULL);
    assert!(document.grid().get(IVec3::new(32, 32, 63)), "it is protected");
    assert!(!document.grid().get(IVec3::new(32, 32, 61)), "deeper there is no mask");
    // Undone to the beginning there is no mask.
    for _ in 0..2 {
        key(&mut harness, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!((masked(&harness), voxels(&harness)), (0, FULL));
}

#[test]
fn solids_protect_and_release() {
    let mut harness = front();
    key(&mut harness, Modifiers::NONE, Key::C);
    key(&mut harness, Modifiers::SHIFT, Key::J);
    assert_eq!(harness.state().editor.tool.mode, ToolMode::Protect);
    let middle = at(&harness, 32.0, 32.0);
    press(&mut harness, middle);
    assert!(is_masked(&harness, [32, 32, 63]) && voxels(&harness) == FULL);
    let before = masked(&harness);
    let path = [[30.0, 32.0], [31.0, 32.0]];
    stroke(&mut harness, Modifiers::COMMAND, path[0], path[1]);
    assert!(masked(&harness) < before, "with the modifier it releases");
    // The mode comes round by its key, and is never left as `Release`.
    for wanted in [ToolMode::Subtract, ToolMode::Add, ToolMode::Recolour, ToolMode::Protect] {
        key(&mut harness, Modifiers::NONE, Key::N);
        assert_eq!(harness.state().editor.tool.mode, wanted);
    }
}

#[test]
fn the_window_inverts_clears_and_moves_the_outline() {
    let mut harness = front();
    key(&mut harness, Modifiers::ALT, Key::J);
    rest(&mut harness);
    assert!(has(&harness, "Nothing is masked: all tools work everywhere"));
    click(&mut harness, "Marker's box");
    let box_voxels = masked(&harness);
    assert_eq!(box_voxels, 32 * 32 * 32);
    click(&mut harness, "Grow");
    assert!(masked(&harness) > box_voxels);
    click(&mut harness, "Shrink");
    assert!(masked(&harness).abs_diff(box_voxels) < box_voxels / 50);
    click(&mut harness, "Even out");
    assert!(masked(&harness) < box_voxels, "its corners are rounded");
    let share = masked(&harness);
    click(&mut harness, "Invert");
    assert_eq!(masked(&harness), FULL - share);
    click(&mut harness, "Take out");
    click(&mut harness, "Marker's box");
    assert!(!is_masked(&harness, [16, 16, 16]) && is_masked(&harness, [2, 2, 2]));
    key(&mut harness, Modifiers::COMMAND, Key::J);
    assert!(is_masked(&harness, [16, 16, 16]));
    key(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::J);
    assert_eq!(masked(&harness), 0);
    // Cavities and colours.
    run(&mut harness, "subtract cuboid at=32,32,62 half=30,2,3");
    run(&mut harness, "recolour cuboid at=32,60,32 half=40,4,40 colour=#ff0000");
    click(&mut harness, "Add to it");
    click(&mut harness, "Cavities");
    assert!(is_masked(&harness, [32, 31, 58]) && !is_masked(&harness, [32, 10, 63]));
    run(&mut harness, "mask clear");
    harness.state_mut().editor.tool.colour = Rgb::new(255, 0, 0);
    click(&mut harness, "Tool's colour");
    assert!(is_masked(&harness, [1, 62, 1]) && !is_masked(&harness, [1, 50, 1]));
}

#[test]
fn the_wand_protects_a_face_a_colour_or_a_piece() {
    let mut harness = front();
    run(&mut harness, "recolour cuboid at=32,60,32 half=40,4,40 colour=#ff0000");
    run(&mut harness, "subtract cuboid at=32,20,32 half=40,1,40");
    for (rule, inside, outside) in [
        (WandRule::Flat, [[32, 40, 63], [32, 60, 63]], [[32, 10, 63], [32, 40, 55]]),
        (WandRule::Colour, [[32, 40, 63], [32, 50, 63]], [[32, 63, 63], [32, 10, 63]]),
        (WandRule::Piece, [[32, 63, 0], [0, 22, 30]], [[32, 10, 63], [32, 0, 0]]),
    ] {
        run(&mut harness, "mask clear");
        let tool = &mut harness.state_mut().editor.tool;
        tool.wand.rule = rule;
        tool.next_press = Some(NextPress::Wand);
        let steps = steps(&harness);
        let pos = at(&harness, 32.0, 40.0);
        press(&mut harness, pos);
        for v in inside {
            assert!(is_masked(&harness, v), "{rule:?} {v:?}");
        }
        for v in outside {
            assert!(!is_masked(&harness, v), "{rule:?} {v:?}");
        }
        assert_eq!(self::steps(&harness), steps + 1);
        assert!(harness.state().editor.tool.next_press.is_none(), "once");
    }
    // By key where the pointer is, and released again.
    run(&mut harness, "mask clear");
    key(&mut harness, Modifiers::ALT, Key::M);
    assert!(masked(&harness) > 0);
    harness.state_mut().editor.tool.wand.adds = false;
    key(&mut harness, Modifiers::ALT, Key::M);
    assert_eq!(masked(&harness), 0);
    let beside = corner(&harness);
    send(&mut harness, Event::PointerMoved(beside));
    look(&mut harness);
    key(&mut harness, Modifiers::ALT, Key::M);
    assert_eq!(masked(&harness), 0, "beside the sculpture there is nothing");
}

#[test]
fn buttons_of_the_window_that_change_nothing_say_why() {
    let mut harness = front();
    let says = |harness: &mut Bench, name: &str, why: &str| {
        harness.get_by_label(name).click();
        harness.run_steps(3);
        let texts: Vec<String> =
            harness.state().ui.toasts.texts().map(|(_, text)| text.to_string()).collect();
        assert!(texts.iter().any(|text| text.contains(why)), "{name}: {texts:?}");
        harness.state_mut().ui.toasts = Default::default();
    };
    harness.state_mut().ui.dialogs.masks.open = true;
    harness.run_steps(3);
    says(&mut harness, "Cavities", "there are no cavities");
    harness.state_mut().editor.tool.colour = Rgb::new(1, 250, 3);
    run(&mut harness, "mask add grid");
    harness.run_steps(2);
    says(&mut harness, "Everything", "it is masked already");
    says(&mut harness, "Grow", "the mask fills the grid already");
    says(&mut harness, "Shrink", "no outline within the grid");
    says(&mut harness, "Even out", "the outline of the mask is even");
    run(&mut harness, "mask clear");
    harness.get_by_label("Take out").click();
    harness.run_steps(2);
    says(&mut harness, "Everything", "it is not masked");
}
