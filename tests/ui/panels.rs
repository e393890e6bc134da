//! Panels and workspace without a window: buttons, keys and mouse cause commands, and commands change the sculpture. The
//! visible voxels come from the exact ray caster.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::UVec3;
use virtual_sculpture::app::Workspace;
use virtual_sculpture::command::Command;
use virtual_sculpture::editor::stroke::sweep::SweepSegment;
use virtual_sculpture::input::{Bindings, Panel, ToolMode};
use virtual_sculpture::render::RenderMode;
use virtual_sculpture::session::Session;
use virtual_sculpture::tools::solid::Solid;
use virtual_sculpture::ui::Theme;

use super::bench::{
    Bench, bench, bench_of, config, corner, drag, key, key_in, look, middle, rest, send,
    undo_count, voxels, wheel,
};

#[test]
fn a_click_cuts_and_undo_brings_the_same_bytes_back() {
    let mut harness = bench();
    let before = harness.state().session().document().contents().clone();
    let at = middle(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    assert!(voxels(&harness) < before.grid.opaque_count());
    assert_eq!(undo_count(&harness), 1);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(*harness.state().session().document().contents(), before);
    key(&mut harness, Modifiers::COMMAND, Key::Y);
    assert!(voxels(&harness) < before.grid.opaque_count());
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    key(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert!(voxels(&harness) < before.grid.opaque_count());
}

#[test]
fn a_drag_on_the_sculpture_is_one_step_that_neither_digs_nor_depends_on_the_pace() {
    let run = |events: usize| {
        let mut harness = bench();
        let from = middle(&harness) - vec2(80.0, 40.0);
        let to = middle(&harness) + vec2(80.0, 40.0);
        let path: Vec<Pos2> =
            (0..=events).map(|i| from.lerp(to, i as f32 / events as f32)).collect();
        drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &path);
        assert_eq!(undo_count(&harness), 1);
        voxels(&harness)
    };
    let (few, many) = (run(4), run(40));
    let cut = 64u64.pow(3) - many;
    assert!(cut > 500, "{cut}");
    // The looks at the surface fall on other pixels, so the stops differ by a little.
    assert!(few.abs_diff(many) * 20 < cut, "{few} {many}");
}

#[test]
fn escape_takes_the_stroke_back() {
    let mut harness = bench();
    let at = middle(&harness);
    let press = |pressed| Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    send(&mut harness, Event::PointerMoved(at));
    send(&mut harness, press(true));
    send(&mut harness, Event::PointerMoved(at + vec2(30.0, 0.0)));
    assert!(harness.state().editor.is_stroking());
    assert!(voxels(&harness) < 64u64.pow(3));
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!harness.state().editor.is_stroking());
    send(&mut harness, press(false));
    assert_eq!((voxels(&harness), undo_count(&harness)), (64u64.pow(3), 0));
}

#[test]
fn beside_the_sculpture_and_with_the_right_button_it_turns() {
    let mut harness = bench();
    let rotation = |h: &Bench| h.state().session().document().placement().rotation;
    let start = rotation(&harness);
    let beside = corner(&harness);
    drag(
        &mut harness,
        PointerButton::Primary,
        Modifiers::NONE,
        &[beside, beside + vec2(60.0, 0.0)],
    );
    let turned = rotation(&harness);
    assert!(turned.angle_between(start) > 0.1);
    let at = middle(&harness);
    drag(&mut harness, PointerButton::Secondary, Modifiers::NONE, &[at, at + vec2(0.0, 60.0)]);
    assert!(rotation(&harness).angle_between(turned) > 0.1);
    assert_eq!((voxels(&harness), undo_count(&harness)), (64u64.pow(3), 0));
    key(&mut harness, Modifiers::NONE, Key::Home);
    assert!(rotation(&harness).angle_between(start) < 1e-3);
}

#[test]
fn the_middle_button_shifts_and_the_wheel_zooms_or_sizes() {
    let mut harness = bench();
    let at = middle(&harness);
    drag(&mut harness, PointerButton::Middle, Modifiers::NONE, &[at, at + vec2(50.0, 0.0)]);
    assert!(harness.state().session().document().placement().translation.x > 0.0);
    let distance = |h: &Bench| h.state().eye().position().z;
    let before = distance(&harness);
    wheel(&mut harness, Modifiers::NONE, at, 2.0);
    assert!(distance(&harness) < before);
    let half = harness.state().editor.tool.half().x;
    wheel(&mut harness, Modifiers::COMMAND, at, 1.0);
    assert!(harness.state().editor.tool.half().x > half);
    key(&mut harness, Modifiers::NONE, Key::OpenBracket);
    key(&mut harness, Modifiers::NONE, Key::OpenBracket);
    assert!(harness.state().editor.tool.half().x < half);
}

#[test]
fn tools_are_chosen_by_buttons_and_by_keys() {
    let mut harness = bench();
    for (name, solid) in [
        ("Cuboid", Solid::Cuboid),
        ("Pyramid", Solid::Pyramid),
        ("Cylinder", Solid::Cylinder),
        ("Cone", Solid::Cone),
        ("Torus", Solid::Torus),
        ("Capsule", Solid::Capsule),
        ("Rounded", Solid::RoundedCuboid),
        ("Ellipsoid", Solid::Ellipsoid),
    ] {
        harness.get_by_label(name).click();
        rest(&mut harness);
        assert_eq!(harness.state().editor.tool.solid, solid);
    }
    for (name, mode) in
        [("Add", ToolMode::Add), ("Paint", ToolMode::Recolour), ("Cut", ToolMode::Subtract)]
    {
        harness.get_by_label(name).click();
        rest(&mut harness);
        assert_eq!(harness.state().editor.tool.mode, mode);
    }
    for (k, solid) in
        [(Key::P, Solid::Pyramid), (Key::C, Solid::Cuboid), (Key::E, Solid::Ellipsoid)]
    {
        key(&mut harness, Modifiers::NONE, k);
        assert_eq!(harness.state().editor.tool.solid, solid);
    }
    for (k, solid) in [
        (Key::P, Solid::Cone),
        (Key::O, Solid::Torus),
        (Key::K, Solid::Capsule),
        (Key::B, Solid::RoundedCuboid),
    ] {
        key(&mut harness, Modifiers::SHIFT, k);
        assert_eq!(harness.state().editor.tool.solid, solid);
    }
    key(&mut harness, Modifiers::NONE, Key::K);
    assert_eq!(harness.state().editor.tool.solid, Solid::Cylinder);
    for (k, mode) in [(Key::T, ToolMode::Add), (Key::G, ToolMode::Recolour)] {
        key(&mut harness, Modifiers::NONE, k);
        assert_eq!(harness.state().editor.tool.mode, mode);
    }
}

#[test]
fn adding_and_painting_use_the_chosen_colour() {
    let mut harness = bench();
    let at = middle(&harness);
    key(&mut harness, Modifiers::NONE, Key::T);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    // A ball on a corner of a full grid can add nothing, and nothing is no step.
    assert_eq!(undo_count(&harness), 0);
    key(&mut harness, Modifiers::NONE, Key::G);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    assert_eq!(undo_count(&harness), 1);
    let bench = harness.state();
    let material = bench.session().document().material();
    assert!(material.page_count() > 0);
    // The other way round, cutting adds.
    let ctrl = Modifiers::COMMAND;
    harness.get_by_label("Cut").click();
    rest(&mut harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    let cut = voxels(&harness);
    drag(&mut harness, PointerButton::Primary, ctrl, &[at]);
    assert!(voxels(&harness) > cut);
}

#[test]
fn the_keyboard_alone_moves_and_uses_the_tool() {
    let mut harness = bench();
    let before = harness.state().editor.tool.centre_vx;
    key(&mut harness, Modifiers::NONE, Key::ArrowRight);
    let by = harness.state().editor.tool.centre_vx - before;
    assert!((by.length() - 1.0).abs() < 1e-6 && by.abs().max_element() == 1.0, "{by}");
    key(&mut harness, Modifiers::NONE, Key::PageUp);
    key(&mut harness, Modifiers::NONE, Key::Space);
    assert_eq!(undo_count(&harness), 1);
    assert!(voxels(&harness) < 64u64.pow(3));
    key(&mut harness, Modifiers::COMMAND, Key::Delete);
    assert_eq!(voxels(&harness), 0);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(voxels(&harness) > 0);
}

#[test]
fn both_buttons_of_the_thesis_mouse_use_the_tool_while_it_moves() {
    let mut harness = bench();
    harness.state_mut().controls.preset = 1;
    let at = middle(&harness);
    let press = |button, pressed| Event::PointerButton {
        pos: at,
        button,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let start = harness.state().editor.tool.centre_vx;
    send(&mut harness, Event::PointerMoved(at));
    assert_eq!(harness.state().editor.tool.centre_vx, start, "here the tool does not follow");
    send(&mut harness, press(PointerButton::Primary, true));
    send(&mut harness, Event::PointerMoved(at + vec2(20.0, 0.0)));
    assert_ne!(harness.state().editor.tool.centre_vx, start);
    assert_eq!(voxels(&harness), 64u64.pow(3));
    send(&mut harness, press(PointerButton::Secondary, true));
    let ball = voxels(&harness);
    assert!(ball < 64u64.pow(3));
    send(&mut harness, Event::PointerMoved(at + vec2(60.0, 0.0)));
    assert!(voxels(&harness) < ball, "used along the way");
    send(&mut harness, press(PointerButton::Secondary, false));
    send(&mut harness, press(PointerButton::Primary, false));
    assert_eq!(undo_count(&harness), 1);
}

#[test]
fn the_top_bar_counts_and_undoes_and_the_history_travels() {
    let mut harness = bench();
    let at = middle(&harness);
    for x in [-120.0, 0.0, 120.0] {
        let at = at + vec2(x, 0.0);
        drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    }
    rest(&mut harness);
    harness.get_by_label("⟲ Undo 3").click();
    rest(&mut harness);
    assert_eq!(undo_count(&harness), 2);
    harness.get_by_label("⟳ Redo 1").click();
    rest(&mut harness);
    assert_eq!(undo_count(&harness), 3);
    harness.get_by_label("Start").click();
    rest(&mut harness);
    assert_eq!((undo_count(&harness), voxels(&harness)), (0, 64u64.pow(3)));
    harness.get_all_by_label("Cut ellipsoid").last().unwrap().click();
    rest(&mut harness);
    assert_eq!(undo_count(&harness), 3);
}

#[test]
fn the_new_dialog_makes_sculptures_of_any_size() {
    let mut harness = bench();
    harness.get_by_label("New").click();
    rest(&mut harness);
    harness.get_by_label("128").click();
    rest(&mut harness);
    harness.get_by_label("an empty grid").click();
    rest(&mut harness);
    harness.get_by_label("Create").click();
    harness.run_steps(2);
    harness.state_mut().finish_job();
    rest(&mut harness);
    let grid = harness.state().session().document().grid();
    assert_eq!((grid.dims(), grid.opaque_count()), (UVec3::splat(128), 0));
    let tool = harness.state().editor.tool.centre_vx;
    assert_eq!(tool, glam::Vec3::splat(64.0), "the tool has come along");

    // In the empty grid a click adds in the middle.
    look(&mut harness);
    key(&mut harness, Modifiers::NONE, Key::T);
    let at = middle(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    assert!(voxels(&harness) > 0);

    key(&mut harness, Modifiers::COMMAND, Key::N);
    rest(&mut harness);
    assert!(harness.state().ui.dialogs.new.open);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert!(!harness.state().ui.dialogs.new.open);

    key(&mut harness, Modifiers::COMMAND, Key::N);
    harness.state_mut().ui.dialogs.new.dims = UVec3::splat(32);
    rest(&mut harness);
    key_in(&mut harness, Modifiers::NONE, Key::Enter);
    harness.run_steps(2);
    harness.get_by_label("Don't save").click();
    harness.run_steps(2);
    harness.state_mut().finish_job();
    rest(&mut harness);
    let dims = harness.state().session().document().grid().dims();
    assert_eq!(dims, UVec3::splat(32), "Enter creates");

    // A stone of the largest size takes no time and no memory.
    key(&mut harness, Modifiers::COMMAND, Key::N);
    harness.state_mut().ui.dialogs.new.dims = UVec3::splat(4096);
    rest(&mut harness);
    harness.get_by_label("a solid block").click();
    rest(&mut harness);
    harness.get_by_label("Create").click();
    harness.run_steps(2);
    harness.state_mut().finish_job();
    rest(&mut harness);
    let grid = harness.state().session().document().grid();
    assert_eq!((grid.dims(), grid.opaque_count()), (UVec3::splat(4096), 1 << 36));
}

#[test]
fn leaving_asks_before_work_is_lost() {
    let mut harness = bench();
    key(&mut harness, Modifiers::COMMAND, Key::Q);
    assert!(harness.state().is_leaving(), "nothing to lose");

    let mut harness = bench();
    key(&mut harness, Modifiers::NONE, Key::Delete);
    harness.state_mut().ask_to_leave();
    rest(&mut harness);
    assert!(!harness.state().is_leaving());
    harness.get_by_label("Cancel").click();
    rest(&mut harness);
    assert!(!harness.state().is_leaving() && harness.state().ui.dialogs.unsaved.is_none());
    harness.state_mut().ask_to_leave();
    rest(&mut harness);
    harness.get_by_label("Don't save").click();
    rest(&mut harness);
    assert!(harness.state().is_leaving());
}

#[test]
fn an_open_dialog_keeps_the_keys_from_the_sculpture() {
    let mut harness = bench();
    key(&mut harness, Modifiers::COMMAND, Key::N);
    key(&mut harness, Modifiers::NONE, Key::Delete);
    let at = corner(&harness);
    drag(&mut harness, PointerButton::Secondary, Modifiers::NONE, &[at, at + vec2(40.0, 0.0)]);
    assert_eq!((voxels(&harness), undo_count(&harness)), (64u64.pow(3), 0));
}

#[test]
fn errors_are_shown_and_nothing_changes() {
    let mut config = config(32);
    config.new.colour_bits = virtual_sculpture::sculpture::ColourDepth::None;
    let mut harness = bench_of(&config, vec2(1280.0, 800.0));
    harness.get_by_label_contains("only one colour").rect();
    key(&mut harness, Modifiers::NONE, Key::G);
    let at = middle(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    assert!(!harness.state().editor.is_stroking());
    harness.get_by_label_contains("this sculpture has no colours").rect();
    assert_eq!(undo_count(&harness), 0);
}

#[test]
fn the_options_change_the_tool_and_the_view() {
    let mut harness = bench_of(&config(64), vec2(1280.0, 1000.0));
    harness.get_by_label("Snap to voxels").click();
    rest(&mut harness);
    assert!(harness.state().editor.tool.snap);
    harness.get_by_label("View").click();
    rest(&mut harness);
    harness.get_by_label("Grid outline").click();
    rest(&mut harness);
    assert!(!harness.state().ui.view.bounds);
    let mode = harness.state().ui.view.mode;
    key(&mut harness, Modifiers::NONE, Key::M);
    assert_ne!(harness.state().ui.view.mode, mode);
    assert!(RenderMode::ALL.contains(&harness.state().ui.view.mode));
    harness.get_by_label("Menu").click();
    rest(&mut harness);
    harness.get_by_label("Fill the grid").click();
    rest(&mut harness);
    assert_eq!(undo_count(&harness), 0, "a full grid has nothing to fill");
}

/// No widget is cut off: all lie within the window, even at the smallest size.
#[test]
fn everything_fits_at_both_sizes_and_in_both_themes() {
    for size in [vec2(1280.0, 800.0), vec2(800.0, 600.0)] {
        for theme in [Theme::Dark, Theme::Light] {
            let mut config = config(64);
            config.window.theme = theme;
            let mut harness = bench_of(&config, size);
            rest(&mut harness);
            let window = egui::Rect::from_min_size(Pos2::ZERO, size).expand(0.5);
            for role in [Role::Button, Role::ComboBox, Role::CheckBox, Role::SpinButton] {
                for node in harness.get_all_by_role(role) {
                    let rect = node.rect();
                    let across = rect.left() >= window.left() && rect.right() <= window.right();
                    assert!(across, "{size} {rect} {node:?}");
                }
            }
            let picture = harness.state().picture();
            assert!(
                picture.width() > 0.55 * size.x && picture.height() > 0.85 * size.y,
                "{picture}"
            );
            assert!(
                harness.get_by_label("Menu").rect().left()
                    > harness.get_by_label("Help").rect().right() - 0.5
            );
        }
    }
}

#[test]
fn opening_and_saving_go_through_the_dialogs() {
    // While the dialog reads a folder it shows a spinner, so the passes have no end of their own.
    let mut harness = bench();
    key(&mut harness, Modifiers::COMMAND, Key::O);
    harness.run_steps(8);
    assert!(harness.state().ui.dialogs.files.is_open());
    key(&mut harness, Modifiers::NONE, Key::Escape);
    harness.run_steps(8);
    assert!(!harness.state().ui.dialogs.files.is_open());
    key(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    harness.run_steps(8);
    assert!(harness.state().ui.dialogs.files.is_open());
}

#[test]
fn scripts_say_what_the_mouse_does() {
    let mut harness = bench();
    let at = middle(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    let tool = &harness.state().editor.tool;
    let command = tool.command(tool.mode, &SweepSegment::place(&tool.primitive()));
    let again: Command = command.to_string().parse().unwrap();
    assert_eq!(again, command);
}

#[test]
fn a_detached_panel_does_the_same_in_a_window_of_its_own() {
    let mut harness = bench();
    harness.get_by_label("Detach: Toolbox").click();
    rest(&mut harness);
    assert!(harness.query_by_label("Cuboid").is_none(), "it is not in the main window");
    let wider = harness.state().picture();
    harness.get_by_label("Detach: Options").click();
    rest(&mut harness);
    harness.get_by_label("Detach: History").click();
    rest(&mut harness);
    assert!(harness.state().picture().width() > wider.width() + 200.0);

    // The same work, through the window of a panel.
    for (panel, label) in
        [(Panel::Toolbox, "Cuboid"), (Panel::Options, "Snap to voxels"), (Panel::History, "Start")]
    {
        let presets = Bindings::presets().unwrap();
        let config = config(32);
        let mut bench = Workspace::new(
            Session::new(&config.new_sculpture(), config.limits()).unwrap(),
            &config,
            presets,
        );
        bench.ui.layout.detached.insert(panel);
        let mut window = Harness::builder().with_size(vec2(260.0, 640.0)).build_ui_state(
            move |ui, bench: &mut Workspace| {
                bench.show_panel(panel, ui);
            },
            bench,
        );
        window.get_by_label(label).click();
        window.run();
        let tool = &window.state().editor.tool;
        match panel {
            Panel::Toolbox => assert_eq!(tool.solid, Solid::Cuboid),
            Panel::Options => assert!(tool.snap),
            Panel::History => {}
        }
        key_in(&mut window, Modifiers::COMMAND, Key::Delete);
        assert_eq!(voxels(&window), 0);
        key_in(&mut window, Modifiers::COMMAND, Key::Z);
        assert_eq!(voxels(&window), 32u64.pow(3));
        // Windows over the sculpture keep the keys of panels away, too.
        key_in(&mut window, Modifiers::COMMAND, Key::N);
        key_in(&mut window, Modifiers::COMMAND, Key::Delete);
        assert_eq!(voxels(&window), 32u64.pow(3));
        window.state_mut().ui.dialogs.new.open = false;
        window.run();
        window.get_by_label(&format!("Dock: {}", panel.title())).click();
        window.run();
        assert!(window.state().ui.layout.detached.is_empty());
    }
}
