//! The workspace without a window, driven by events as a person would cause them.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::{Vec3, Vec4Swizzles};
use virtual_sculpture::app::Workspace;
use virtual_sculpture::command::Command;
use virtual_sculpture::config::Config;
use virtual_sculpture::input::Bindings;
use virtual_sculpture::session::Session;
use virtual_sculpture::surface::{IndexMap, raycast};

pub type Bench = Harness<'static, Workspace>;

/// The settings with a block of this edge, in a box that ends there: `canvas` tests what grows.
pub fn config(edge: u32) -> Config {
    let mut config = Config::default();
    (config.new.dims, config.new.grow) = ([edge; 3], false);
    config
}

pub fn bench_of(config: &Config, size: Vec2) -> Bench {
    let presets = Bindings::presets().unwrap();
    let bench = Workspace::new(
        Session::new(&config.new_sculpture(), config.limits()).unwrap(),
        config,
        presets,
    );
    bench_around(bench, size)
}

pub fn bench_around(bench: Workspace, size: Vec2) -> Bench {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_pixels_per_point(1.0)
        .build_ui_state(|ui, bench: &mut Workspace| bench.show(ui), bench);
    look(&mut harness);
    harness
}

pub fn bench() -> Bench {
    bench_of(&config(64), vec2(1280.0, 800.0))
}

/// Does what the renderer does after a frame: gives the workspace the visible voxels.
pub fn look(harness: &mut Bench) {
    let bench = harness.state_mut();
    let rays = bench.eye().pixel_rays(&bench.world_from_grid());
    let mut map = IndexMap::new(rays);
    raycast::sample(bench.session().document().grid(), &rays, &mut map);
    let Workspace { viewpoint, editor, .. } = bench;
    viewpoint.set_pick_map(Arc::new(map), editor.document());
}

pub fn voxels(harness: &Bench) -> u64 {
    harness.state().session().document().grid().opaque_count()
}

pub fn undo_count(harness: &Bench) -> usize {
    harness.state().session().document().history().undo_count()
}

pub fn middle(harness: &Bench) -> Pos2 {
    harness.state().picture().center()
}

pub fn corner(harness: &Bench) -> Pos2 {
    harness.state().picture().min + vec2(10.0, 10.0)
}

/// One event a pass, as a slow hand would send them.
pub fn send(harness: &mut Bench, event: Event) {
    harness.event(event);
    harness.step();
}

/// A click on the picture, which is looked at before and after.
pub fn press(harness: &mut Bench, pos: Pos2) {
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    send(harness, Event::PointerMoved(pos));
    look(harness);
    for pressed in [true, false] {
        send(harness, Event::PointerButton { pos, button, pressed, modifiers });
        look(harness);
    }
}

pub fn drag(harness: &mut Bench, button: PointerButton, modifiers: Modifiers, path: &[Pos2]) {
    let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
    send(harness, Event::PointerMoved(path[0]));
    send(harness, press(path[0], true));
    for &pos in path {
        send(harness, Event::PointerMoved(pos));
    }
    send(harness, press(path[path.len() - 1], false));
    look(harness);
}

pub fn key(harness: &mut Bench, modifiers: Modifiers, key: Key) {
    key_in(harness, modifiers, key);
    look(harness);
}

/// The same in any window.
pub fn key_in(harness: &mut Bench, modifiers: Modifiers, key: Key) {
    for pressed in [true, false] {
        send(harness, Event::Key { key, physical_key: None, pressed, repeat: false, modifiers });
    }
}

pub fn wheel(harness: &mut Bench, modifiers: Modifiers, at: Pos2, notches: f32) {
    send(harness, Event::PointerMoved(at));
    send(
        harness,
        Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: vec2(0.0, notches),
            modifiers,
            phase: egui::TouchPhase::Move,
        },
    );
    look(harness);
}

/// Carries out a command as scripts write it.
pub fn run(harness: &mut Bench, line: &str) {
    let command: Command = line.parse().unwrap();
    harness.state_mut().session_mut().execute(&command, &()).unwrap();
    look(harness);
}

/// The position on screen of a point of the grid.
pub fn screen(harness: &Bench, point: Vec3) -> Pos2 {
    let bench = harness.state();
    let clip = bench.eye().clip_from_grid(&bench.world_from_grid()) * point.extend(1.0);
    let at = (clip.xy() / clip.w * 0.5 + 0.5) * bench.eye().size.as_vec2();
    bench.picture().min + vec2(at.x, at.y)
}

/// Clicks where pictures go on being drawn.
pub fn click_once(harness: &mut Bench, label: &str) {
    harness.get_by_label(label).click();
    harness.run_steps(3);
}

/// Clicks on what has this label, and waits until windows and menus have their size.
pub fn click(harness: &mut Bench, label: &str) {
    harness.get_by_label(label).click();
    // Menus and windows take some frames to their size.
    harness.run_steps(6);
    rest(harness);
}

/// How long the dialog of files may take to read a folder, on a thread of its own.
const FOLDER_TIME: Duration = Duration::from_secs(20);

/// Waits for long work, and until the interface has nothing more to draw. While there is long work, or a folder is being
/// read, frames are asked for again and again.
pub fn rest(harness: &mut Bench) {
    while harness.state().editor.is_busy() {
        harness.state_mut().finish_job();
        harness.run_steps(2);
    }
    let began = Instant::now();
    while harness.try_run().is_err() {
        assert!(began.elapsed() < FOLDER_TIME, "the interface never comes to rest");
        std::thread::sleep(Duration::from_millis(5));
    }
}

pub fn has(harness: &Bench, label: &str) -> bool {
    harness.query_by_label(label).is_some()
}

/// Types a command into the palette and runs it.
pub fn run_by_palette(harness: &mut Bench, line: &str) {
    key(harness, Modifiers::COMMAND, Key::P);
    rest(harness);
    send(harness, Event::Text(line.to_string()));
    key(harness, Modifiers::NONE, Key::Enter);
}
