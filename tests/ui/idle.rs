//! Tests the reasons that are given for changes that do nothing or are cut off by the walls: once, and rightly.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use glam::Vec3;
use virtual_sculpture::editor::tool::{ToolEdit, ToolKind};
use virtual_sculpture::input::{Action, DrawKind, ToolMode};
use virtual_sculpture::sculpture::Rgb;
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::tools::brush::keys::{REACH, STRENGTH};
use virtual_sculpture::tools::solid::Solid;

use super::bench::{self, Bench, drag, key, middle, rest, run, screen, send, voxels};

/// A block of 64^3 voxels, seen from the front: all of the grid, or half of it.
fn front(full: bool) -> Bench {
    let mut harness = bench::bench();
    rest(&mut harness);
    run(&mut harness, "place");
    if !full {
        run(&mut harness, "subtract cuboid at=32,32,48 half=32,32,16");
    }
    harness
}

fn use_at(harness: &mut Bench, modifiers: Modifiers, path: &[Pos2]) {
    drag(harness, PointerButton::Primary, modifiers, path);
}

/// Forgets what has been said; does something; what was said then.
fn said(harness: &mut Bench, act: impl FnOnce(&mut Bench)) -> Vec<String> {
    harness.state_mut().ui.toasts = Default::default();
    act(harness);
    harness.state().ui.toasts.texts().map(|(_, text)| text.to_string()).collect()
}

/// Checks that `act` changes nothing, and says so in one message that contains `why`.
fn says(harness: &mut Bench, why: &str, act: impl FnOnce(&mut Bench)) {
    let before = harness.state().session().document().contents().clone();
    let texts = said(harness, act);
    assert_eq!(harness.state().session().document().contents(), &before, "{why}");
    assert!(texts.len() == 1 && texts[0].contains(why), "{why:?}, but it said {texts:?}");
}

fn press(harness: &mut Bench) {
    let at = middle(harness);
    use_at(harness, Modifiers::NONE, &[at]);
}

#[test]
fn a_solid_that_rests_on_the_surface_says_why_it_does_nothing() {
    let mut harness = front(true);
    harness.state_mut().editor.tool.edit(ToolEdit::Stand(true));
    says(&mut harness, "Nothing was cut: the tool rests on the surface", press);
    harness.state_mut().act(Action::Mode(ToolMode::Add));
    harness.state_mut().editor.tool.edit(ToolEdit::Stand(true));
    says(&mut harness, "Nothing was added: the tool was outside the grid", press);
    says(&mut harness, "Nothing was cut: the tool rests on the surface", |harness| {
        let at = middle(harness);
        use_at(harness, Modifiers::COMMAND, &[at]);
    });
    harness.state_mut().act(Action::Mode(ToolMode::Recolour));
    harness.state_mut().editor.tool.edit(ToolEdit::Stand(true));
    says(&mut harness, "Nothing was painted: the tool rests on the surface", press);
    // Without resting it is the place that is full.
    harness.state_mut().editor.tool.edit(ToolEdit::Stand(false));
    harness.state_mut().act(Action::Mode(ToolMode::Add));
    says(&mut harness, "this part of the grid is full", press);
}

#[test]
fn resting_on_the_surface_does_not_survive_a_change_to_cut() {
    let mut harness = front(false);
    for by_cycling in [false, true] {
        harness.state_mut().act(Action::Mode(ToolMode::Add));
        harness.state_mut().editor.tool.edit(ToolEdit::Stand(true));
        match by_cycling {
            // Add, paint, protect, cut.
            true => (0..3).for_each(|_| harness.state_mut().act(Action::NextToolMode)),
            false => harness.state_mut().act(Action::Mode(ToolMode::Subtract)),
        }
        let tool = &harness.state().editor.tool;
        assert_eq!((tool.mode, tool.stand), (ToolMode::Subtract, false));
        let before = voxels(&harness);
        press(&mut harness);
        assert!(voxels(&harness) < before);
        harness.state_mut().act(Action::Mode(ToolMode::Subtract));
        assert!(!harness.state().editor.tool.stand, "nor by choosing it once more");
        harness.state_mut().act(Action::Mode(ToolMode::Add));
        assert!(harness.state().editor.tool.stand, "what adds rests as before");
        harness.state_mut().editor.tool.edit(ToolEdit::Stand(false));
    }
}

#[test]
fn a_tool_reports_voxels_that_have_its_colour_already() {
    let mut harness = front(true);
    run(&mut harness, "dye grid colour=#123456");
    // Neither the limit nor a mask is to blame, though both are there.
    run(&mut harness, "mark at=0,0,0 size=64,64,64");
    run(&mut harness, "limit on");
    run(&mut harness, "mask add ellipsoid at=0,0,0 half=3");
    harness.state_mut().editor.tool.colour = Rgb::new(0x12, 0x34, 0x56);
    harness.state_mut().act(Action::Mode(ToolMode::Recolour));
    says(&mut harness, "it has this colour already", press);
    harness.state_mut().editor.tool.kind = ToolKind::Brush(BrushId::Paint);
    says(&mut harness, "it has this colour already", press);
    says(&mut harness, "it has this colour already", |harness| {
        key(harness, Modifiers::COMMAND, Key::G);
    });
    // Where they are to blame it is they.
    harness.state_mut().editor.tool.colour = Rgb::new(1, 2, 3);
    run(&mut harness, "mask add grid");
    says(&mut harness, "the voxels there are masked", press);
    run(&mut harness, "mask clear");
    run(&mut harness, "limit off");
    run(&mut harness, "mark at=0,0,0 size=2,2,2");
    key(&mut harness, Modifiers::NONE, Key::L);
    says(&mut harness, "limited to the selection", press);
}

#[test]
fn brushes_on_the_wall_and_on_what_is_done_say_why() {
    let mut harness = front(true);
    harness.state_mut().editor.tool.kind = ToolKind::Brush(BrushId::Clay);
    says(&mut harness, "the grid ends here", press);
    harness.state_mut().editor.tool.kind = ToolKind::Brush(BrushId::Smooth);
    says(&mut harness, "it is smooth here", press);
    harness.state_mut().act(Action::Brush(BrushId::Draw));
    says(&mut harness, "the grid ends here", press);
    harness.state_mut().act(Action::Brush(BrushId::Flatten));
    says(&mut harness, "the clay already has the shape that the brush makes", press);
    harness.state_mut().editor.tool.brushes.of_mut(BrushId::Flatten).set(STRENGTH, 0.0);
    says(&mut harness, "strength of the brush is 0", press);
    run(&mut harness, "mask add grid");
    harness.state_mut().editor.tool.kind = ToolKind::Brush(BrushId::Mask);
    says(&mut harness, "it is masked already", press);
}

#[test]
fn the_cut_at_the_end_of_the_grid_is_reported_once_until_a_use_fits() {
    const CUT_OFF: &str = "The grid ends there";
    let cut_off = |harness: &mut Bench, act: &mut dyn FnMut(&mut Bench)| {
        let before = voxels(harness);
        let texts = said(harness, |harness| act(harness));
        assert!(voxels(harness) > before, "something was added");
        let about = texts.iter().filter(|text| text.contains(CUT_OFF)).count();
        assert_eq!(about, texts.len(), "{texts:?}");
        about
    };
    // A ball half outside, twice; one that is inside; and one outside again.
    let mut harness = front(false);
    harness.state_mut().act(Action::Mode(ToolMode::Add));
    let ball = |at: Vec3| {
        move |harness: &mut Bench| {
            harness.state_mut().editor.tool.follow = false;
            harness.state_mut().editor.tool.centre_vx = at;
            key(harness, Modifiers::NONE, Key::Space);
        }
    };
    let (wall, inside) = (Vec3::new(0.0, 10.0, 45.0), Vec3::new(32.0, 32.0, 40.0));
    assert_eq!(cut_off(&mut harness, &mut ball(wall)), 1);
    assert_eq!(cut_off(&mut harness, &mut ball(wall + Vec3::Y * 8.0)), 0, "it was said");
    assert_eq!(cut_off(&mut harness, &mut ball(inside)), 0);
    assert_eq!(cut_off(&mut harness, &mut ball(wall + Vec3::Y * 24.0)), 1);
    // A solid that ends flush with the wall is whole.
    let mut harness = front(false);
    run(&mut harness, "mark at=0,0,0 size=8,8,8");
    run(&mut harness, "copy");
    run(&mut harness, "mark at=56,0,32 size=8,8,8");
    assert_eq!(cut_off(&mut harness, &mut |harness| send(harness, Event::Paste("".into()))), 0);
    run(&mut harness, "mark at=60,20,32 size=4,8,8");
    assert_eq!(cut_off(&mut harness, &mut |harness| send(harness, Event::Paste("".into()))), 1);
    // A handle that is drawn out of the grid.
    let mut harness = front(false);
    harness.state_mut().act(Action::Draw(DrawKind::Line));
    harness.state_mut().act(Action::Mode(ToolMode::Add));
    let from = screen(&harness, Vec3::new(50.0, 32.0, 32.0));
    let mut handle = |harness: &mut Bench| {
        use_at(harness, Modifiers::NONE, &[from, from + vec2(60.0, 0.0), from + vec2(120.0, 0.0)]);
    };
    assert_eq!(cut_off(&mut harness, &mut handle), 1);
    // Clay that grows over the edge.
    let mut harness = front(false);
    run(&mut harness, "add cuboid at=32,32,47.5 half=8,8,15.5");
    harness.state_mut().editor.tool.kind = ToolKind::Brush(BrushId::Clay);
    harness.state_mut().editor.tool.brushes.of_mut(BrushId::Clay).set(REACH, 6.0);
    assert_eq!(cut_off(&mut harness, &mut press), 1);
    harness.state_mut().act(Action::Solid(Solid::Ellipsoid));
}
