//! Choices that are remembered between starts, without a window: the workspace is started, used, closed and started again with the
//! same file.

use std::path::{Path, PathBuf};

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use virtual_sculpture::command::Command;
use virtual_sculpture::config::Config;
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::input::{Panel, ToolMode};
use virtual_sculpture::sculpture::Rgb;
use virtual_sculpture::tools::solid::Solid;
use virtual_sculpture::ui::Theme;
use virtual_sculpture::ui::widgets::toasts::Tone;

use super::bench::{self, Bench, config, key, rest};

fn start(file: &Path, config: &Config) -> Bench {
    let mut harness = bench::bench_of(config, egui::vec2(1280.0, 800.0));
    harness.state_mut().remember_in(file.to_path_buf(), &config.window);
    rest(&mut harness);
    harness
}

fn quit(mut harness: Bench) {
    harness.state_mut().finish_job();
    harness.state_mut().remember();
}

/// Carries out a command as a dialog would.
fn run(harness: &mut Bench, line: &str) {
    key(harness, Modifiers::COMMAND, Key::P);
    harness.step();
    harness.event(egui::Event::Text(line.to_string()));
    harness.step();
    bench::key_in(harness, Modifiers::NONE, Key::Enter);
    harness.run_steps(2);
    harness.state_mut().finish_job();
    harness.run_steps(2);
}

fn recent(harness: &Bench) -> Vec<PathBuf> {
    harness.state().ui.known_files.recent.paths().map(PathBuf::from).collect()
}

#[test]
fn looks_tool_and_panels_are_found_again_after_a_start() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("deep").join("state.toml");
    let config = config(32);
    let mut harness = start(&file, &config);
    harness.state_mut().ui.appearance.theme = Theme::Light;
    key(&mut harness, Modifiers::COMMAND, Key::Equals);
    key(&mut harness, Modifiers::NONE, Key::C);
    key(&mut harness, Modifiers::NONE, Key::T);
    key(&mut harness, Modifiers::NONE, Key::F7);
    harness.state_mut().editor.tool.colour = Rgb::new(9, 8, 7);
    rest(&mut harness);
    let scale = harness.state().ui.appearance.scale.factor();
    assert_eq!(harness.state().ui.appearance.theme, Theme::Light);
    quit(harness);

    let harness = start(&file, &config);
    let ui = &harness.state().ui;
    assert_eq!((ui.appearance.theme, ui.appearance.scale.factor()), (Theme::Light, scale));
    let tool = &harness.state().editor.tool;
    assert_eq!((tool.kind, tool.solid), (ToolKind::Solid, Solid::Cuboid));
    assert_eq!((tool.mode, tool.colour), (ToolMode::Add, Rgb::new(9, 8, 7)));
    assert!(ui.layout.detached.contains(&Panel::Options));
    assert_eq!(undone(&harness), 0, "what is remembered is no step");
    quit(harness);
    let left: Vec<_> = std::fs::read_dir(file.parent().unwrap()).unwrap().collect();
    assert_eq!(left.len(), 1, "nothing but the file: {left:?}");
}

fn undone(harness: &Bench) -> usize {
    harness.state().session().document().history().undo_count()
}

#[test]
fn sections_of_the_options_stay_open_or_closed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.toml");
    let mut harness = start(&file, &config(32));
    assert!(harness.query_by_label("Grid outline").is_none());
    harness.get_by_label("View").click();
    rest(&mut harness);
    harness.get_by_label("Grid outline").rect();
    harness.get_all_by_label("Tool").next().unwrap().click();
    rest(&mut harness);
    harness.get_by_label("Drawn solids").click();
    rest(&mut harness);
    quit(harness);
    let harness = start(&file, &config(32));
    assert!(harness.query_by_label("Lasso").is_none(), "nor do those of the toolbox");
    harness.get_by_label("Marker").rect();
    harness.get_by_label("Grid outline").rect();
    assert!(harness.query_by_label("Snap to voxels").is_none());
}

#[test]
fn recent_files_are_opened_again_and_those_gone_are_said_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.toml");
    let [a, b] = ["a one.vsc", "b.pvm"].map(|name| folder.path().join(name));
    let mut harness = start(&file, &config(32));
    run(&mut harness, &format!("save {a:?}"));
    run(&mut harness, &format!("save {b:?}"));
    assert_eq!(recent(&harness), [b.clone(), a.clone()]);
    let written = std::fs::read_to_string(&file).unwrap();
    assert!(written.contains("b.pvm"), "a killed program has it too");
    drop(harness);

    let mut harness = start(&file, &config(16));
    assert_eq!(harness.state().ui.dialogs.files.folder(), Some(folder.path()));
    let choose = |harness: &mut Bench, name: &str| {
        for label in ["Menu", "Open recent ⏵", name] {
            harness.get_by_label(label).click();
            // While a file is being read the window goes on drawing.
            harness.run_steps(3);
        }
        harness.state_mut().finish_job();
        harness.run_steps(3);
    };
    choose(&mut harness, "a one.vsc");
    assert_eq!(harness.state().session().path(), Some(a.as_path()));
    assert_eq!(harness.state().session().document().grid().dims().x, 32);
    assert_eq!(recent(&harness), [a.clone(), b.clone()]);

    std::fs::remove_file(&b).unwrap();
    choose(&mut harness, "b.pvm");
    assert_eq!(harness.state().session().path(), Some(a.as_path()), "nothing was opened");
    assert_eq!(recent(&harness), [a]);
    let said: Vec<_> = harness.state().ui.toasts.texts().collect();
    assert!(
        said.iter().any(|(tone, text)| *tone == Tone::Error && text.contains("b.pvm")),
        "{said:?}"
    );
}

#[test]
fn the_file_named_at_the_start_is_the_most_recent_and_its_options_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.toml");
    let raw = folder.path().join("x.raw");
    std::fs::write(&raw, [200u8; 4 * 4 * 4]).unwrap();
    let mut harness = start(&file, &config(32));
    run(&mut harness, &format!("open {raw:?} raw=4x4x4:u8"));
    assert_eq!(harness.state().session().document().grid().dims().x, 4);
    quit(harness);
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("raw=4x4x4:u8"), "{text}");
    let harness = start(&file, &config(32));
    let line = harness.state().ui.known_files.recent.lines().next().unwrap();
    let Command::Open { import, .. } = line.parse().unwrap() else { panic!("{line}") };
    assert!(import.raw.is_some());
}

#[test]
fn no_contents_of_the_file_and_no_folder_keep_the_program_from_starting() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.toml");
    let mut contents: Vec<Vec<u8>> = vec![
        Vec::new(),
        b"\xff\xfe\0\0".to_vec(),
        b"theme = \"purple\"\nscale = 1e300\nwindow = [-1, 5]\n".to_vec(),
        b"[tool]\ncolour = \"#zzzzzz\"\n[sprays]\nclay = 3\n".to_vec(),
        vec![b'a'; 3 << 20],
    ];
    contents.push("torn = [[[[".repeat(1000).into_bytes());
    for bytes in contents {
        std::fs::write(&file, &bytes).unwrap();
        let harness = start(&file, &config(16));
        assert_eq!(harness.state().ui.appearance.theme, Theme::Dark);
        quit(harness);
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("theme = \"dark\""), "it is written anew: {text}");
    }
    // A folder in its place, and a place where nothing can be.
    std::fs::remove_file(&file).unwrap();
    std::fs::create_dir(&file).unwrap();
    quit(start(&file, &config(16)));
    assert!(file.is_dir());
    quit(start(Path::new("/dev/null/state.toml"), &config(16)));
}

#[test]
fn without_a_file_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = bench::bench_of(&config(16), egui::vec2(1280.0, 800.0));
    run(&mut harness, &format!("save {:?}", folder.path().join("a.vsc")));
    harness.state_mut().remember();
    harness.state_mut().remember_at_rest();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
