//! A brush follows how hard a pen or a finger presses, where the system tells.

use egui::{Event, Modifiers, PointerButton, TouchDeviceId, TouchId, TouchPhase, vec2};
use virtual_sculpture::editor::pen_use::{PenTool, PenUse};
use virtual_sculpture::editor::sizes::SizeUnit;
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::tools::brush::keys::RADIUS;

use super::bench::{Bench, bench, middle, send, voxels};

const ALL: u64 = 64 * 64 * 64;

fn creasing() -> Bench {
    let mut harness = bench();
    let tool = &mut harness.state_mut().editor.tool;
    tool.kind = ToolKind::Brush(BrushId::Crease);
    tool.brushes.unit = SizeUnit::Sculpture;
    tool.brushes.of_mut(BrushId::Crease).set(RADIUS, 8.0);
    harness
}

/// A short furrow, drawn with a pen of this force; voxels that are gone then.
fn furrow(harness: &mut Bench, force: Option<f32>) -> u64 {
    let before = voxels(harness);
    let start = middle(harness);
    let touch = |phase, pos| Event::Touch {
        device_id: TouchDeviceId(1),
        id: TouchId(1),
        phase,
        pos,
        force,
    };
    let press = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    send(harness, Event::PointerMoved(start));
    harness.event(touch(TouchPhase::Start, start));
    send(harness, press(start, true));
    let mut at = start;
    for _ in 0..6 {
        at += vec2(5.0, 0.0);
        harness.event(touch(TouchPhase::Move, at));
        send(harness, Event::PointerMoved(at));
    }
    harness.event(touch(TouchPhase::End, at));
    send(harness, press(at, false));
    harness.run_steps(2);
    before - voxels(harness)
}

#[test]
fn a_pen_that_presses_less_makes_a_flatter_furrow() {
    let of = |force| furrow(&mut creasing(), force);
    let [light, half, full] = [0.2, 0.5, 1.0].map(|force| of(Some(force)));
    assert!(0 < light && light < half && half < full && full < ALL, "{light} {half} {full}");
    for nothing in [None, Some(0.0), Some(f32::NAN)] {
        assert_eq!(of(nothing), full, "{nothing:?}: as a mouse");
    }
    let mut harness = creasing();
    let pens = &mut harness.state_mut().editor.tool.pens;
    pens.set(PenTool::Brush(BrushId::Crease), PenUse::default());
    assert_eq!(furrow(&mut harness, Some(0.2)), full);
    // A light touch leaves nothing for the next one without a force.
    let mut harness = creasing();
    assert_eq!(furrow(&mut harness, Some(0.2)), light);
    let session = harness.state_mut().session_mut();
    session.execute(&"undo 1".parse().unwrap(), &()).unwrap();
    assert_eq!(furrow(&mut harness, None), full);
}
