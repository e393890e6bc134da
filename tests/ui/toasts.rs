//! Messages without a window: they keep clear of dialogs, fade, and disappear by themselves.

use egui::{Event, Id, Key, Modifiers, Order, Rect, vec2};
use egui_kittest::kittest::Queryable;
use virtual_sculpture::ui::widgets::toasts::Tone;

use super::bench::{Bench, bench, bench_of, config, key_in, send};

fn rect(harness: &Bench) -> Rect {
    harness.ctx.memory(|memory| memory.area_rect(Id::new("toasts")).unwrap())
}

/// Windows and dialogs, but for the shade behind them.
fn dialogs(harness: &Bench) -> Vec<Rect> {
    let screen = harness.ctx.content_rect();
    harness.ctx.memory(|memory| {
        let layers = memory.areas().visible_layer_ids().into_iter();
        layers
            .filter(|layer| [Order::Middle, Order::Foreground].contains(&layer.order))
            .filter(|layer| layer.id != Id::new("toasts"))
            .map(|layer| memory.area_rect(layer.id).unwrap())
            .filter(|rect| !rect.contains_rect(screen.shrink(1.0)))
            .collect()
    })
}

fn texts(harness: &Bench) -> Vec<Tone> {
    harness.state().ui.toasts.texts().map(|(tone, _)| tone).collect()
}

/// Lets time go by.
fn wait(harness: &mut Bench, seconds: f64) {
    harness.input_mut().time = Some(harness.ctx.input(|input| input.time) + seconds);
    harness.step();
    harness.input_mut().time = None;
}

#[test]
fn messages_keep_clear_of_every_dialog() {
    let dialogs_of = [
        (Modifiers::COMMAND, Key::N),
        (Modifiers::COMMAND, Key::O),
        (Modifiers::COMMAND | Modifiers::SHIFT, Key::S),
        (Modifiers::COMMAND, Key::P),
        (Modifiers::NONE, Key::F1),
    ];
    for (modifiers, key) in dialogs_of {
        for size in [vec2(1280.0, 800.0), vec2(800.0, 600.0)] {
            let mut harness = bench_of(&config(32), size);
            key_in(&mut harness, modifiers, key);
            harness
                .state_mut()
                .ui
                .toasts
                .error("a long message, that is longer than a line is wide");
            harness.state_mut().ui.toasts.note("a note");
            (0..4).for_each(|_| harness.step());
            let open = dialogs(&harness);
            assert!(!open.is_empty(), "{key:?}");
            let own = rect(&harness);
            let covered = open.iter().any(|dialog| dialog.intersects(own));
            let layer = harness.ctx.memory(|memory| {
                let mut layers = memory.areas().visible_layer_ids().into_iter();
                layers.find(|layer| layer.id == Id::new("toasts")).unwrap()
            });
            // Where there is no room they lie below.
            assert_eq!(covered, layer.order == Order::Background, "{key:?} at {size}: {own}");
            if size.x > 1000.0 {
                assert!(!covered, "{key:?} at {size}: {own} {open:?}");
            }
        }
    }
}

#[test]
fn messages_keep_clear_of_the_first_steps() {
    for size in [vec2(1280.0, 800.0), vec2(800.0, 600.0)] {
        let mut harness = bench_of(&config(32), size);
        key_in(&mut harness, Modifiers::NONE, Key::F2);
        harness.state_mut().ui.toasts.error("a long message, that is longer than a line is wide");
        (0..4).for_each(|_| harness.step());
        let (own, picture) = (rect(&harness), harness.state().picture());
        assert!(harness.query_by_label("Skip").is_some());
        assert!(picture.contains_rect(own), "{size}: {own} in {picture}");
    }
}

#[test]
fn a_message_under_a_dialog_waits_until_it_can_be_seen() {
    let mut harness = bench_of(&config(32), vec2(640.0, 480.0));
    key_in(&mut harness, Modifiers::COMMAND, Key::O);
    harness.state_mut().ui.toasts.error("the file cannot be read");
    (0..3).for_each(|_| harness.step());
    for _ in 0..10 {
        wait(&mut harness, 10.0);
    }
    assert_eq!(texts(&harness), [Tone::Error]);
    key_in(&mut harness, Modifiers::NONE, Key::Escape);
    key_in(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!harness.state().ui.dialogs.files.is_open());
    (0..3).for_each(|_| harness.step());
    harness.get_by_label("the file cannot be read").rect();
    wait(&mut harness, 20.0);
    assert_eq!(texts(&harness), []);
}

#[test]
fn notes_fade_and_go_before_errors_do() {
    let mut harness = bench();
    harness.state_mut().ui.toasts.error("an error");
    harness.state_mut().ui.toasts.note("a note");
    (0..2).for_each(|_| harness.step());
    assert_eq!(texts(&harness), [Tone::Error, Tone::Note]);
    // How much of the message is seen: the strongest of its text's colours.
    let strength = |harness: &Bench, text: &str| {
        let mut strongest = 0;
        for clipped in &harness.output().shapes {
            strongest = strongest.max(strength_of(&clipped.shape, text));
        }
        strongest
    };
    let whole = strength(&harness, "a note");
    assert!(whole > 100, "{whole}");
    wait(&mut harness, 3.6);
    let fading = strength(&harness, "a note");
    assert!(fading > 0 && fading < whole, "{fading} of {whole}");
    assert_eq!(strength(&harness, "an error"), strength(&harness, "an error").max(whole));
    wait(&mut harness, 0.5);
    assert_eq!(texts(&harness), [Tone::Error]);
    wait(&mut harness, 8.0);
    assert_eq!(texts(&harness), [Tone::Error], "errors stay longer");
    // A message under the pointer stays.
    let at = rect(&harness).center();
    send(&mut harness, Event::PointerMoved(at));
    for _ in 0..10 {
        wait(&mut harness, 1.0);
    }
    assert_eq!(texts(&harness), [Tone::Error]);
    send(&mut harness, Event::PointerGone);
    for _ in 0..3 {
        wait(&mut harness, 1.0);
    }
    assert_eq!(texts(&harness), []);
}

/// The opacity of a text among shapes.
fn strength_of(shape: &egui::Shape, text: &str) -> u8 {
    match shape {
        egui::Shape::Vec(shapes) => {
            shapes.iter().map(|shape| strength_of(shape, text)).max().unwrap_or(0)
        }
        egui::Shape::Text(shown) if shown.galley.text() == text => {
            let colours = shown.galley.job.sections.iter().map(|part| part.format.color.a());
            let own = colours.max().unwrap_or(0).max(shown.fallback_color.a());
            let own = shown.override_text_color.map_or(own, |colour| colour.a());
            (f32::from(own) * shown.opacity_factor).round() as u8
        }
        _ => 0,
    }
}
