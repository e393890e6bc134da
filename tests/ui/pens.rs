//! A pen before the window, as a tablet reports it: what it presses, with which end, how hard and how it leans.

use egui::{Event, Modifiers, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use glam::Vec2;
use virtual_sculpture::editor::pen_use::{PenTool, PenUse};
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::input::pen::{PenEnd, PenPointer, PenSample};
use virtual_sculpture::input::{Action, Button, Buttons, ToolMode};
use virtual_sculpture::sculpture::Rgb;
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::tools::brush::keys::RADIUS;

use super::bench::{Bench, bench, bench_of, config, look, middle, rest, undo_count, voxels};

/// A pen whose pointer is made of its samples, as on Wayland.
struct Pen {
    pointer: PenPointer,
    end: PenEnd,
    tilt_deg: Vec2,
}

impl Pen {
    fn new(end: PenEnd) -> Pen {
        Pen { pointer: PenPointer::default(), end, tilt_deg: Vec2::ZERO }
    }

    /// The pen is at a place with so much pressure, on the surface if it is more than none, and with these buttons held.
    fn at(&mut self, harness: &mut Bench, at: Pos2, pressure: f32, held: &[Button]) {
        let mut buttons = held.iter().fold(Buttons::NONE, |set, button| set.with(*button));
        if pressure > 0.0 {
            let tip = if self.end == PenEnd::Tip { Button::Left } else { Button::Eraser };
            buttons = buttons.with(tip);
        }
        let sample = PenSample {
            position_px: Vec2::new(at.x, at.y),
            pressure: Some(pressure),
            tilt_deg: self.tilt_deg,
            end: self.end,
            buttons,
            is_near: true,
        };
        harness.state_mut().hear_pens(&[sample]);
        for event in self.pointer.events(&sample, 1.0, Modifiers::NONE) {
            harness.event(event);
        }
        harness.step();
    }

    /// A stroke of 40 points to the right, all of it with this pressure.
    fn stroke(&mut self, harness: &mut Bench, from: Pos2, pressure: f32) {
        self.at(harness, from, 0.0, &[]);
        look(harness);
        for i in 0..=8 {
            self.at(harness, from + vec2(5.0 * i as f32, 0.0), pressure, &[]);
        }
        self.at(harness, from + vec2(40.0, 0.0), 0.0, &[]);
        look(harness);
    }
}

fn holding(kind: BrushId, leads: PenUse) -> Bench {
    let mut harness = bench();
    let tool = &mut harness.state_mut().editor.tool;
    tool.kind = ToolKind::Brush(kind);
    tool.pens.set(PenTool::Brush(kind), leads);
    harness
}

/// The number of voxels that a stroke of the devourer removes.
fn removed(leads: PenUse, pressure: f32, tilt_deg: Vec2) -> u64 {
    let mut harness = holding(BrushId::Devour, leads);
    let before = voxels(&harness);
    let start = middle(&harness);
    let mut pen = Pen { tilt_deg, ..Pen::new(PenEnd::Tip) };
    pen.stroke(&mut harness, start, pressure);
    assert_eq!(undo_count(&harness), 1, "one stroke");
    before - voxels(&harness)
}

#[test]
fn pressure_leads_strength_or_size_or_nothing_and_tilt_widens() {
    let nothing = PenUse::default();
    let strength = PenUse { strength: true, ..nothing };
    let size = PenUse { size: true, ..nothing };
    let tilt = PenUse { tilt: true, ..nothing };
    let full = removed(nothing, 1.0, Vec2::ZERO);
    assert_eq!(removed(nothing, 0.3, Vec2::new(40.0, 0.0)), full);
    for leads in [strength, size] {
        let [light, half, whole] = [0.3, 0.6, 1.0].map(|p| removed(leads, p, Vec2::ZERO));
        assert!(0 < light && light < half && half < whole, "{leads:?}: {light} {half} {whole}");
        assert_eq!(whole, full, "{leads:?}");
    }
    assert!(removed(tilt, 0.3, Vec2::new(45.0, 0.0)) > full + full / 3);
    assert_eq!(removed(tilt, 0.3, Vec2::ZERO), full);
}

#[test]
fn the_curve_says_what_a_press_counts_for() {
    let of = |exponent: f32, full_at: f32| {
        let leads = PenUse { strength: true, ..PenUse::default() };
        let mut harness = holding(BrushId::Devour, leads);
        harness.state_mut().ui.pen.curve.exponent = exponent;
        harness.state_mut().ui.pen.curve.full_at = full_at;
        let before = voxels(&harness);
        let start = middle(&harness);
        Pen::new(PenEnd::Tip).stroke(&mut harness, start, 0.5);
        before - voxels(&harness)
    };
    let straight = of(1.0, 1.0);
    assert!(of(0.4, 1.0) > straight && straight > of(3.0, 1.0));
    assert!(of(1.0, 0.5) > straight, "half of the range is all");
}

#[test]
fn the_eraser_adds_what_the_tip_cuts_and_takes_paint_away() {
    let mut harness = bench();
    harness.state_mut().act(Action::Mode(ToolMode::Subtract));
    let (start, before) = (middle(&harness), voxels(&harness));
    Pen::new(PenEnd::Tip).stroke(&mut harness, start, 0.5);
    let cut = voxels(&harness);
    assert!(cut < before);
    Pen::new(PenEnd::Eraser).stroke(&mut harness, start, 0.5);
    assert!(voxels(&harness) > cut);

    let painted = |harness: &Bench, colour: Rgb| {
        let document = harness.state().session().document();
        let grid = document.grid();
        let coloured = |i: &u32| document.contents().rgb(grid.voxel_coords(*i)) == colour;
        (0..64 * 64 * 64).filter(coloured).count()
    };
    for act in [Action::Brush(BrushId::Paint), Action::Mode(ToolMode::Recolour)] {
        let mut harness = bench();
        harness.state_mut().act(act);
        let colour = harness.state().editor.tool.colour;
        let start = middle(&harness);
        Pen::new(PenEnd::Tip).stroke(&mut harness, start, 1.0);
        assert!(painted(&harness, colour) > 20, "{act:?}");
        Pen::new(PenEnd::Eraser).stroke(&mut harness, start, 1.0);
        assert_eq!(painted(&harness, colour), 0, "{act:?}");
        assert_eq!(harness.state().editor.tool.colour, colour);
        // As any stroke it is a step of its own.
        let session = harness.state_mut().session_mut();
        session.execute(&"undo 1".parse().unwrap(), &()).unwrap();
        assert!(painted(&harness, colour) > 20, "{act:?}");
    }
}

#[test]
fn a_pen_that_hovers_shows_the_tool_and_its_buttons_turn_and_undo() {
    let mut harness = bench();
    let at = middle(&harness);
    let mut pen = Pen::new(PenEnd::Tip);
    pen.at(&mut harness, at, 0.0, &[]);
    look(&mut harness);
    pen.at(&mut harness, at + vec2(3.0, 0.0), 0.0, &[]);
    assert!(harness.state().editor.pointer().is_some());
    let there = harness.state().editor.tool.centre_vx;
    pen.at(&mut harness, at + vec2(40.0, 0.0), 0.0, &[]);
    assert_ne!(harness.state().editor.tool.centre_vx, there, "the preview follows");
    assert_eq!(undo_count(&harness), 0);
    // The lower button turns the view.
    let before = harness.state().session().document().placement().rotation;
    pen.at(&mut harness, at, 0.0, &[Button::PenLower]);
    pen.at(&mut harness, at + vec2(60.0, 0.0), 0.0, &[Button::PenLower]);
    pen.at(&mut harness, at + vec2(60.0, 0.0), 0.0, &[]);
    let after = harness.state().session().document().placement().rotation;
    assert!(before.angle_between(after) > 0.05);
    // One that is given to a tap.
    look(&mut harness);
    pen.stroke(&mut harness, at, 1.0);
    assert_eq!(undo_count(&harness), 1);
    let dialogs = &mut harness.state_mut().ui.dialogs;
    dialogs.keys.open = true;
    dialogs.keys.listen_for(Action::Undo);
    harness.step();
    pen.at(&mut harness, at, 0.0, &[Button::PenUpper]);
    pen.at(&mut harness, at, 0.0, &[]);
    assert!(!harness.state().ui.dialogs.keys.is_catching() || taken_over(&mut harness));
    harness.state_mut().ui.dialogs.keys.open = false;
    harness.run_steps(2);
    pen.at(&mut harness, at, 0.0, &[Button::PenUpper]);
    pen.at(&mut harness, at, 0.0, &[]);
    assert_eq!(undo_count(&harness), 0, "undone by the pen");
}

/// The button belongs to another action: it is given to the new one.
fn taken_over(harness: &mut Bench) -> bool {
    harness.get_by_label("Reassign").click();
    harness.run_steps(3);
    true
}

#[test]
fn in_panels_a_pen_is_a_mouse_and_the_mouse_beside_it_presses_fully() {
    let mut harness = holding(BrushId::Devour, PenTool::Brush(BrushId::Devour).usual());
    let mut pen = Pen::new(PenEnd::Eraser);
    harness.run_steps(2);
    let button = harness.get_by_label("Reset options").rect().center();
    harness.state_mut().editor.tool.brushes.of_mut(BrushId::Devour).set(RADIUS, 55.0);
    harness.step();
    for pressure in [0.0, 0.4, 0.0] {
        pen.at(&mut harness, button, pressure, &[]);
    }
    harness.run_steps(2);
    assert_eq!(harness.state().editor.tool.brushes.radius(BrushId::Devour), 20.0);
    // After a light stroke of the pen, a mouse.
    let start = middle(&harness);
    Pen::new(PenEnd::Tip).stroke(&mut harness, start, 0.2);
    let session = harness.state_mut().session_mut();
    session.execute(&"undo 1".parse().unwrap(), &()).unwrap();
    look(&mut harness);
    let before = voxels(&harness);
    let path: Vec<Pos2> = (0..=8).map(|i| start + vec2(5.0 * i as f32, 0.0)).collect();
    super::bench::drag(&mut harness, egui::PointerButton::Primary, Modifiers::NONE, &path);
    let by_mouse = before - voxels(&harness);
    assert_eq!(by_mouse, removed(PenUse::default(), 1.0, Vec2::ZERO));
    harness.event(Event::PointerGone);
    harness.step();
}

#[test]
fn the_options_of_pens_stay_where_they_are_while_a_pen_touches() {
    let mut harness = bench_of(&config(64), vec2(1280.0, 1600.0));
    harness.state_mut().ui.pen.is_used = true;
    rest(&mut harness);
    let place = |harness: &Bench| {
        (
            harness.get_by_label_contains("counts as").rect().min,
            harness.get_by_label("Light").rect(),
        )
    };
    let at = middle(&harness);
    let mut pen = Pen::new(PenEnd::Tip);
    pen.at(&mut harness, at, 0.0, &[]);
    rest(&mut harness);
    let before = place(&harness);
    pen.at(&mut harness, at, 0.5, &[]);
    pen.at(&mut harness, at, 0.5, &[]);
    assert!(harness.query_by_label("counts as 50 %").is_some());
    assert_eq!(place(&harness), before);
}
