//! The display switches: in the bar if it is wide enough, else in the menu; the choice of the stereo layout; the video
//! source.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::Vec3;
use virtual_sculpture::sculpture::history::SurfaceKind;
use virtual_sculpture::ui::widgets::toasts::Tone;
use virtual_sculpture::ui::{ScreenshotTo, Theme};
use virtual_sculpture::view::StereoLayout;

use super::bench::{
    Bench, bench, bench_of, click, config, drag, has, key, look, middle, rest, screen, send, voxels,
};

fn layout(harness: &Bench) -> StereoLayout {
    harness.state().ui.view.stereo.layout
}

/// Opens the choice of the layout in the bar.
fn open_layouts(harness: &mut Bench) {
    let text = layout(harness).label();
    let combos = harness.get_all_by_role(Role::ComboBox);
    let named = |value: Option<String>| value.as_deref() == Some(text);
    combos.into_iter().find(|node| named(node.value())).unwrap().click();
    harness.run_steps(6);
    rest(harness);
}

#[test]
fn a_wide_bar_has_the_switches() {
    let mut harness = bench();
    click(&mut harness, "Lights");
    assert!(harness.state().ui.dialogs.light.open && has(&harness, "Add light"));
    key(&mut harness, Modifiers::NONE, Key::F4);
    assert!(!harness.state().ui.dialogs.light.open, "the key and the switch are one");
    assert!(!has(&harness, "Rumble"), "there is no gamepad");
    open_layouts(&mut harness);
    click(&mut harness, "Anaglyph");
    assert_eq!(layout(&harness), StereoLayout::Anaglyph);
}

#[test]
fn a_narrow_bar_leaves_them_to_the_menu() {
    let mut harness = bench_of(&config(64), vec2(800.0, 600.0));
    rest(&mut harness);
    assert!(!has(&harness, "Lights") && !has(&harness, "Video"));
    click(&mut harness, "Menu");
    click(&mut harness, "Lights");
    assert!(harness.state().ui.dialogs.light.open);
    click(&mut harness, "Menu");
    click(&mut harness, "Stereo ⏵");
    click(&mut harness, "Side by side");
    assert_eq!(layout(&harness), StereoLayout::SideBySide);
}

#[test]
fn quad_buffers_are_offered_only_where_the_window_has_layers() {
    let mut harness = bench();
    open_layouts(&mut harness);
    assert!(harness.get_by_label("Quad-buffered").accesskit_node().is_disabled());
    click(&mut harness, "Quad-buffered");
    assert_eq!(layout(&harness), StereoLayout::Mono);

    let mut harness = bench();
    harness.state_mut().display.quad_buffered = true;
    open_layouts(&mut harness);
    click(&mut harness, "Quad-buffered");
    assert_eq!(layout(&harness), StereoLayout::Layers);
}

#[test]
fn the_address_of_a_video_is_taken_when_it_is_whole_and_good() {
    let mut config = config(64);
    config.video.source = "/there/is/no.y4m".to_string();
    let mut harness = bench_of(&config, vec2(1280.0, 1000.0));
    click(&mut harness, "Head tracking and AR");
    assert!(harness.query_by_role(Role::TextInput).is_none(), "it is off");
    // Pictures follow one another while a video is looked for, so the passes have no end.
    harness.get_by_label("Video").click();
    harness.run_steps(3);
    assert!(harness.state().ui.view.video.on);
    let source = |harness: &Bench| harness.state().ui.view.video.source.clone();
    let write = |harness: &mut Bench, text: &str| {
        harness.get_by_role(Role::TextInput).focus();
        harness.run_steps(3);
        key(harness, Modifiers::COMMAND, Key::A);
        send(harness, Event::Text(text.to_string()));
        harness.run_steps(3);
    };
    write(&mut harness, "/nor/is/this.y4m");
    assert_eq!(source(&harness), "/there/is/no.y4m", "not before Enter");
    key(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(source(&harness), "/nor/is/this.y4m");

    write(&mut harness, "table.avi");
    key(&mut harness, Modifiers::NONE, Key::Enter);
    harness.run_steps(3);
    assert_eq!(source(&harness), "/nor/is/this.y4m", "what cannot be is not taken");
    let toasts: Vec<_> = harness.state().ui.toasts.texts().collect();
    let told = |(tone, text): &(Tone, &str)| *tone == Tone::Error && text.contains("table.avi");
    assert!(toasts.iter().any(told), "{toasts:?}");
}

#[test]
fn the_view_is_zoomed_framed_and_saved_by_key_and_by_the_menu() {
    let mut harness = bench();
    let distance = |harness: &Bench| harness.state().eye().position().z;
    let far = distance(&harness);
    key(&mut harness, Modifiers::COMMAND, Key::ArrowUp);
    let near = distance(&harness);
    assert!(near < far);
    key(&mut harness, Modifiers::COMMAND, Key::ArrowDown);
    assert!((distance(&harness) - far).abs() < 1e-3 * far, "as far out as in");

    assert!(harness.state().ui.view.bounds);
    key(&mut harness, Modifiers::ALT, Key::G);
    assert!(!harness.state().ui.view.bounds);
    assert!(harness.state().ui.view.mask);
    key(&mut harness, Modifiers::COMMAND | Modifiers::ALT, Key::J);
    assert!(!harness.state().ui.view.mask);
    assert_eq!(harness.state().ui.appearance.theme, Theme::Dark);
    key(&mut harness, Modifiers::ALT, Key::T);
    assert_eq!(harness.state().ui.appearance.theme, Theme::Light);
    let asked = |harness: &mut Bench| {
        let ui = &mut harness.state_mut().ui;
        let tasks = std::mem::take(&mut ui.window_tasks);
        (tasks.switch_fullscreen, tasks.screenshot)
    };
    key(&mut harness, Modifiers::NONE, Key::F11);
    assert_eq!(asked(&mut harness), (true, None));
    key(&mut harness, Modifiers::NONE, Key::F12);
    assert_eq!(asked(&mut harness), (false, Some(ScreenshotTo::File)));
    key(&mut harness, Modifiers::COMMAND, Key::F12);
    assert_eq!(asked(&mut harness), (false, Some(ScreenshotTo::Clipboard)));

    click(&mut harness, "Menu");
    click(&mut harness, "Full screen");
    assert_eq!(asked(&mut harness), (true, None));
    click(&mut harness, "Menu");
    click(&mut harness, "Save picture");
    assert_eq!(asked(&mut harness), (false, Some(ScreenshotTo::File)));
    click(&mut harness, "Menu");
    click(&mut harness, "Copy picture");
    assert_eq!(asked(&mut harness), (false, Some(ScreenshotTo::Clipboard)));
    click(&mut harness, "Menu");
    click(&mut harness, "View ⏵");
    click(&mut harness, "Zoom in");
    assert!((distance(&harness) - near).abs() < 1e-3 * near);
}

#[test]
fn hidden_panels_leave_the_window_to_the_picture_until_they_are_wanted_again() {
    let mut harness = bench();
    // The harness leaves a margin, which a window does not.
    let whole = egui::Rect::from_min_size(egui::Pos2::ZERO, vec2(1280.0, 800.0)).shrink(8.0);
    let beside_panels = harness.state().picture();
    assert!(beside_panels.area() < 0.8 * whole.area());
    click(&mut harness, "Menu");
    click(&mut harness, "Hide panels");
    assert_eq!(harness.state().picture(), whole);
    assert!(!has(&harness, "Menu") && !has(&harness, "Ellipsoid"));
    let toasts: Vec<_> = harness.state().ui.toasts.texts().collect();
    assert!(toasts.iter().any(|(_, text)| text.contains("F10")), "{toasts:?}");
    // Tools work as before.
    let before = voxels(&harness);
    look(&mut harness);
    let at = middle(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    assert!(voxels(&harness) < before);
    // Without keys: a button at the upper edge, where the pointer is near.
    assert!(!has(&harness, "Show panels"));
    send(&mut harness, Event::PointerMoved(egui::pos2(700.0, 20.0)));
    rest(&mut harness);
    click(&mut harness, "Show panels");
    assert_eq!(harness.state().picture(), beside_panels);
    key(&mut harness, Modifiers::NONE, Key::F10);
    assert_eq!(harness.state().picture(), whole);
    key(&mut harness, Modifiers::NONE, Key::F10);
    assert_eq!(harness.state().picture(), beside_panels);
}

#[test]
fn in_an_orthographic_view_equal_things_are_equally_large_and_tools_work_where_one_points() {
    let mut harness = bench();
    key(&mut harness, Modifiers::NONE, Key::Num7);
    let width = |harness: &Bench, z: f32| {
        screen(harness, Vec3::new(64.0, 32.0, z)).x - screen(harness, Vec3::new(0.0, 32.0, z)).x
    };
    let (far, near) = (width(&harness, 0.0), width(&harness, 64.0));
    assert!(near > 1.2 * far);
    key(&mut harness, Modifiers::NONE, Key::O);
    assert!(harness.state().ui.view.orthographic);
    let (parallel_far, parallel_near) = (width(&harness, 0.0), width(&harness, 64.0));
    assert!((parallel_near - parallel_far).abs() < 2.0, "{parallel_far} {parallel_near}");
    assert!((far..near).contains(&parallel_near), "what is in the middle keeps its size");

    // A press near a corner of the front face cuts there.
    let corner = Vec3::new(60.0, 60.0, 64.0);
    let at = screen(&harness, corner);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    let grid = harness.state().session().document().grid();
    assert!(!grid.get(glam::IVec3::new(60, 60, 63)) && grid.get(glam::IVec3::new(32, 32, 63)));
    let centre = harness.state().editor.tool.centre_vx;
    assert!(centre.distance(corner) < 1.0, "{centre}");

    click(&mut harness, "Menu");
    click(&mut harness, "View ⏵");
    click(&mut harness, "Orthographic");
    assert!(!harness.state().ui.view.orthographic);
    assert!((width(&harness, 64.0) - near).abs() < 0.5);
}

#[test]
fn a_click_on_the_axis_gizmo_looks_from_that_side_and_a_drag_rotates() {
    let mut harness = bench();
    let rotation = |h: &Bench| h.state().session().document().placement().rotation;
    for (label, towards) in [
        ("+X", Vec3::X),
        ("+Y", Vec3::Y),
        ("+Z", Vec3::Z),
        ("−X", Vec3::NEG_X),
        ("−Y", Vec3::NEG_Y),
    ] {
        // Seen from a corner, no end hides another.
        key(&mut harness, Modifiers::NONE, Key::Num5);
        rest(&mut harness);
        click(&mut harness, label);
        assert!((rotation(&harness) * towards).abs_diff_eq(Vec3::Z, 1e-4), "{label}");
    }
    key(&mut harness, Modifiers::NONE, Key::Num5);
    rest(&mut harness);
    let before = rotation(&harness);
    let middle = harness
        .get_by_label("+Z")
        .rect()
        .center()
        .lerp(harness.get_by_label("−Z").rect().center(), 0.5);
    // Neither the tool nor the sculpture is touched below it.
    drag(
        &mut harness,
        PointerButton::Primary,
        Modifiers::NONE,
        &[middle, middle + vec2(16.0, 0.0)],
    );
    let turned = rotation(&harness);
    assert!((turned.angle_between(before) - 0.5).abs() < 0.1, "{}", turned.angle_between(before));
    assert!(((turned * Vec3::Z).x - (before * Vec3::Z).x) > 0.1, "the front follows the pointer");
    assert_eq!(voxels(&harness), 64u64.pow(3));

    assert!(harness.state().ui.view.gizmo);
    key(&mut harness, Modifiers::ALT, Key::O);
    rest(&mut harness);
    assert!(!harness.state().ui.view.gizmo && !has(&harness, "+X"));
}

#[test]
fn the_floor_grid_says_its_scale() {
    let mut harness = bench_of(&config(64), vec2(1280.0, 1000.0));
    assert!(!has(&harness, "Floor grid: 5 voxels"));
    key(&mut harness, Modifiers::SHIFT, Key::G);
    rest(&mut harness);
    assert!(harness.state().ui.view.floor && has(&harness, "Floor grid: 5 voxels"));
    click(&mut harness, "View");
    click(&mut harness, "Floor grid");
    assert!(!harness.state().ui.view.floor && !has(&harness, "Floor grid: 5 voxels"));
}

#[test]
fn the_ground_has_lines_of_the_same_scale() {
    let mut harness = bench_of(&config(64), vec2(1280.0, 1000.0));
    key(&mut harness, Modifiers::CTRL | Modifiers::ALT, Key::G);
    rest(&mut harness);
    assert!(harness.state().ui.view.ground && has(&harness, "Ground lines: 5 voxels"));
    // One says it for both.
    key(&mut harness, Modifiers::SHIFT, Key::G);
    rest(&mut harness);
    assert!(has(&harness, "Ground lines: 5 voxels") && !has(&harness, "Floor grid: 5 voxels"));
    click(&mut harness, "View");
    click(&mut harness, "Ground");
    assert!(!harness.state().ui.view.ground && has(&harness, "Floor grid: 5 voxels"));
}

/// The choice is kept with the sculpture, so it is undone like any other change, and what is exported follows.
#[test]
fn a_sculpture_is_shown_smooth_or_as_cubes() {
    // All view options on the screen.
    let mut harness = bench_of(&config(64), vec2(1280.0, 1600.0));
    click(&mut harness, "View");
    let surface = |harness: &Bench| harness.state().session().document().contents().surface;
    assert_eq!(surface(&harness), SurfaceKind::Smooth);
    click(&mut harness, "Smooth surface");
    assert_eq!(surface(&harness), SurfaceKind::Cubes);
    assert!(harness.state().session().modified(), "there is something to save");
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    rest(&mut harness);
    assert_eq!(surface(&harness), SurfaceKind::Smooth);
    // Settings that show cubes of all sculptures do not keep a person from the other.
    harness.state_mut().ui.view.smooth_surface = false;
    rest(&mut harness);
    click(&mut harness, "Smooth surface");
    assert!(harness.state().ui.view.smooth_surface);
    assert_eq!(surface(&harness), SurfaceKind::Smooth);
}
