//! Files and unsaved work, without a window: the questions before the sculpture is replaced and before what cannot be
//! undone, and what Save, Save as and Export write.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{DroppedFileHandle, Event, Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use virtual_sculpture::app::Workspace;
use virtual_sculpture::document::Limits;
use virtual_sculpture::format;
use virtual_sculpture::input::Bindings;
use virtual_sculpture::mesh::MeshKind;
use virtual_sculpture::session::Session;

use super::bench::{
    Bench, bench, bench_around, config, drag, key, middle, rest, run_by_palette, send, undo_count,
    voxels,
};

const ALL: u64 = 64 * 64 * 64;

fn execute(harness: &mut Bench, line: &str) {
    let session = harness.state_mut().session_mut();
    session.execute(&line.parse().unwrap(), &()).unwrap_or_else(|e| panic!("{line}: {e}"));
}

/// Types a command into the palette.
fn ask_for(harness: &mut Bench, line: &str) {
    run_by_palette(harness, line);
    settle(harness);
}

fn answer(harness: &mut Bench, label: &str) {
    // The bar along the top has a button of that name, too; the question lies over it.
    harness.get_all_by_label(label).last().unwrap().click();
    settle(harness);
}

fn settle(harness: &mut Bench) {
    for _ in 0..3 {
        harness.run_steps(2);
        harness.state_mut().finish_job();
    }
    rest(harness);
}

fn is_asked(harness: &Bench) -> bool {
    harness.query_by_label("You have unsaved changes").is_some()
}

fn edge(harness: &Bench) -> u32 {
    harness.state().session().document().grid().dims().x
}

fn saved_voxels(path: &Path) -> u64 {
    let loaded = format::load(path, &Default::default(), &Limits::default(), &()).unwrap();
    loaded.contents.grid.opaque_count()
}

#[test]
fn new_and_open_ask_where_there_is_unsaved_work() {
    let folder = tempfile::tempdir().unwrap();
    let [own, other] = ["own.vsc", "other.vsc"].map(|name| folder.path().join(name));
    let mut harness = bench();
    execute(&mut harness, &format!("save {other:?}"));
    for replace in ["new dims=24,24,24".to_string(), format!("open {other:?}")] {
        let mut harness = bench();
        ask_for(&mut harness, "new dims=40,40,40");
        assert_eq!((is_asked(&harness), edge(&harness)), (false, 40), "nothing to lose yet");

        ask_for(&mut harness, "clear");
        ask_for(&mut harness, &replace);
        assert!(is_asked(&harness), "{replace}");
        answer(&mut harness, "Cancel");
        assert_eq!((is_asked(&harness), edge(&harness)), (false, 40), "{replace}");
        ask_for(&mut harness, &replace);
        key(&mut harness, Modifiers::NONE, Key::Escape);
        assert_eq!((is_asked(&harness), edge(&harness)), (false, 40), "{replace}");

        // Saved first: to the file that it has.
        execute(&mut harness, &format!("save {own:?}"));
        execute(&mut harness, "add cuboid at=4,4,4 half=1 colour=#ff0000");
        ask_for(&mut harness, &replace);
        answer(&mut harness, "Save");
        assert_ne!(edge(&harness), 40, "{replace}");
        assert_eq!(saved_voxels(&own), 8);

        // Or not saved, and still there in the history.
        ask_for(&mut harness, "undo");
        ask_for(&mut harness, "clear");
        ask_for(&mut harness, &replace);
        answer(&mut harness, "Don't save");
        assert_ne!(edge(&harness), 40, "{replace}");
        assert_eq!(saved_voxels(&own), 8);
        ask_for(&mut harness, "undo");
        assert_eq!(edge(&harness), 40);
    }
}

/// A harness whose history has room for next to nothing.
fn forgetful() -> Bench {
    let config = config(64);
    let limits = Limits { history_bytes: 64, ..config.limits() };
    let session = Session::new(&config.new_sculpture(), limits).unwrap();
    let bench = Workspace::new(session, &config, Bindings::presets().unwrap());
    bench_around(bench, vec2(1280.0, 800.0))
}

#[test]
fn a_command_that_cannot_be_undone_is_asked_about_and_done_or_not() {
    for line in ["clear", "new dims=24,24,24"] {
        let mut harness = forgetful();
        let before = harness.state().session().document().contents().clone();
        ask_for(&mut harness, line);
        harness.get_by_label("Do something that cannot be undone?").rect();
        answer(&mut harness, "Cancel");
        assert!(harness.query_by_label("Do something that cannot be undone?").is_none());
        assert_eq!(*harness.state().session().document().contents(), before);
        ask_for(&mut harness, line);
        answer(&mut harness, "Do it");
        assert_ne!(*harness.state().session().document().contents(), before);
        assert_eq!(undo_count(&harness), 0);
        // It holds for that once.
        let other = if line == "clear" { "add" } else { "subtract" };
        ask_for(&mut harness, &format!("{other} cuboid at=4,4,4 half=2"));
        harness.get_by_label("Do something that cannot be undone?").rect();
    }
}

#[test]
fn a_stroke_that_cannot_be_undone_is_kept_or_taken_back() {
    let mut harness = forgetful();
    let at = middle(&harness);
    for (label, kept) in [("Take it back", false), ("Keep it", true)] {
        drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
        rest(&mut harness);
        assert!(voxels(&harness) < ALL, "it can be seen what it did");
        answer(&mut harness, label);
        assert_eq!(voxels(&harness) < ALL, kept);
        assert!(!harness.state().session().document().stroke_open());
        assert_eq!(undo_count(&harness), 0);
    }
    // Put aside it is taken back, too.
    let now = voxels(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at + vec2(60.0, 0.0)]);
    rest(&mut harness);
    assert_ne!(voxels(&harness), now);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert_eq!(voxels(&harness), now);
    assert!(!harness.state().session().document().stroke_open());
}

#[test]
fn save_as_proposes_a_sculpture_and_export_a_print() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("statue.vsc");
    let mut harness = bench();
    execute(&mut harness, &format!("save {path:?}"));
    key(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    settle(&mut harness);
    assert!(harness.query_all_by_value("statue.vsc").next().is_some());
    key(&mut harness, Modifiers::NONE, Key::Escape);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    settle(&mut harness);
    key(&mut harness, Modifiers::COMMAND, Key::E);
    settle(&mut harness);
    assert!(harness.query_all_by_value("statue.stl").next().is_some());
}

/// After the name, what the format leaves open; the answers stay for the next time. Formats that leave nothing open are
/// written at once.
#[test]
fn export_asks_for_what_the_format_leaves_open() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("statue.vsc");
    let mut harness = bench();
    ask_for(&mut harness, "new dims=40,40,40 fill=empty");
    ask_for(&mut harness, "add cuboid at=21,20,20 half=10,5,15");
    execute(&mut harness, &format!("save {path:?}"));
    let choose = |harness: &mut Bench, name: &str| {
        key(harness, Modifiers::COMMAND, Key::E);
        settle(harness);
        harness.query_all_by_value("statue.stl").next().unwrap().focus();
        rest(harness);
        key(harness, Modifiers::COMMAND, Key::A);
        send(harness, Event::Text(name.to_string()));
        rest(harness);
        harness.query_all_by_label_contains("Save").last().unwrap().click();
        settle(harness);
    };
    choose(&mut harness, "statue.stl");
    harness.get_by_label("Export statue.stl").rect();
    // As large as the voxels, of a millimetre each.
    harness.get_by_label("20.0 × 10.0 × 30.0 mm").rect();
    harness.get_by_label("Surface").rect();
    harness.state_mut().ui.dialogs.export.kind = MeshKind::Greedy;
    key(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    let triangles = |name: &str| {
        let file = std::fs::read(folder.path().join(name)).unwrap();
        u32::from_le_bytes(file[80..84].try_into().unwrap())
    };
    assert_eq!(triangles("statue.stl"), 12);
    // Escape leaves it.
    choose(&mut harness, "other.stl");
    key(&mut harness, Modifiers::NONE, Key::Escape);
    settle(&mut harness);
    assert!(harness.query_by_label("Export other.stl").is_none());
    assert!(!folder.path().join("other.stl").exists());
    choose(&mut harness, "other.stl");
    answer(&mut harness, "Export");
    assert_eq!(triangles("other.stl"), 12);
    choose(&mut harness, "statue.vox");
    assert!(folder.path().join("statue.vox").exists());
}

#[test]
fn one_enter_confirms_a_typed_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    let mut harness = bench();
    execute(&mut harness, &format!("save {path:?}"));
    let shift = Modifiers::COMMAND | Modifiers::SHIFT;
    key(&mut harness, shift, Key::S);
    settle(&mut harness);
    send(&mut harness, Event::Text("owl".to_string()));
    key(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    assert!(folder.path().join("owl.vsc").exists(), "the name is chosen but for its ending");

    // After the field has lost the focus to a press beside it, after a press on the list of formats, and after a choice
    // in it, Enter confirms all the same.
    for (name, beside) in [("b.vsc", "Cancel"), ("c.vsc", "Sculpture (.vsc)")] {
        key(&mut harness, shift, Key::S);
        settle(&mut harness);
        harness
            .query_all_by_value("owl.vsc")
            .chain(harness.query_all_by_value("b.vsc"))
            .next()
            .unwrap()
            .focus();
        rest(&mut harness);
        key(&mut harness, Modifiers::COMMAND, Key::A);
        send(&mut harness, Event::Text(name.to_string()));
        rest(&mut harness);
        if beside != "Cancel" {
            harness.query_all_by_value(beside).next().unwrap().click();
            rest(&mut harness);
            harness.get_by_label(beside).click();
            rest(&mut harness);
        }
        key(&mut harness, Modifiers::NONE, Key::Enter);
        settle(&mut harness);
        assert!(folder.path().join(name).exists(), "{name}");
    }

    // A path that is typed opens at once, too.
    key(&mut harness, Modifiers::COMMAND, Key::O);
    settle(&mut harness);
    execute_path(&mut harness, &path);
    assert_eq!(harness.state().session().path(), Some(path.as_path()));
}

/// Types a path into the line of folders of the dialog, and presses Enter once.
fn execute_path(harness: &mut Bench, path: &Path) {
    key(harness, Modifiers::COMMAND, Key::Slash);
    rest(harness);
    key(harness, Modifiers::COMMAND, Key::A);
    send(harness, Event::Text(path.display().to_string()));
    key(harness, Modifiers::NONE, Key::Enter);
    settle(harness);
}

#[test]
fn export_proposes_what_is_printed_and_then_what_was_chosen_last() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("statue.vsc");
    let mut harness = bench();
    execute(&mut harness, &format!("save {path:?}"));
    for (proposed, name) in [("statue.stl", "statue.GLB"), ("statue.glb", "statue.qb")] {
        key(&mut harness, Modifiers::COMMAND, Key::E);
        settle(&mut harness);
        harness.query_all_by_value(proposed).next().expect(proposed).focus();
        rest(&mut harness);
        key(&mut harness, Modifiers::COMMAND, Key::A);
        send(&mut harness, Event::Text(name.to_string()));
        key(&mut harness, Modifiers::NONE, Key::Enter);
        settle(&mut harness);
        key(&mut harness, Modifiers::NONE, Key::Enter);
        settle(&mut harness);
        assert!(folder.path().join(name).exists(), "{name}");
    }
    assert_eq!(harness.state().ui.dialogs.files.export_ending(), "qb");
}

#[test]
fn an_opened_sculpture_is_saved_to_its_file_and_an_opened_volume_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let [sculpture, volume] = ["a.vsc", "a.pvm"].map(|name| folder.path().join(name));
    let mut harness = bench();
    for path in [&sculpture, &volume] {
        execute(&mut harness, &format!("save {path:?}"));
    }
    execute(&mut harness, &format!("open {sculpture:?}"));
    execute(&mut harness, "clear");
    key(&mut harness, Modifiers::COMMAND, Key::S);
    settle(&mut harness);
    assert_eq!(saved_voxels(&sculpture), 0);
    assert!(!harness.state().session().modified());

    execute(&mut harness, &format!("open {volume:?}"));
    execute(&mut harness, "clear");
    // An export is no save: what a volume cannot hold would be lost.
    execute(&mut harness, &format!("save {:?}", folder.path().join("other.pvm")));
    assert!(harness.state().session().modified());
    key(&mut harness, Modifiers::COMMAND, Key::S);
    settle(&mut harness);
    assert!(harness.query_all_by_value("a.vsc").next().is_some());
    assert_eq!(saved_voxels(&volume), ALL);
}

/// A pipe without a reader fails like a full disk.
#[cfg(unix)]
#[test]
fn a_recording_that_ends_is_said_once_and_no_stroke_stays_open() {
    use virtual_sculpture::ui::widgets::toasts::Tone;

    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reading = pipe.clone();
    let reader = std::thread::spawn(move || {
        // Until the beginning has come.
        use std::io::BufRead;
        let mut lines = std::io::BufReader::new(std::fs::File::open(&reading)?).lines();
        lines.by_ref().take(2).collect::<Result<Vec<String>, _>>()
    });
    let mut harness = bench_of_recorded(&pipe);
    reader.join().unwrap().unwrap();
    let at = middle(&harness);
    for x in [0.0, 60.0] {
        drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at + vec2(x, 0.0)]);
    }
    assert_eq!(undo_count(&harness), 2);
    let errors = harness.state().ui.toasts.texts().filter(|(tone, _)| *tone == Tone::Error);
    let errors: Vec<&str> = errors.map(|(_, text)| text).collect();
    assert!(errors.len() == 1 && errors[0].contains("the recording ends here"), "{errors:?}");
}

#[cfg(unix)]
fn bench_of_recorded(path: &Path) -> Bench {
    let config = config(64);
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    session.record_to(path).unwrap();
    assert_eq!(session.document().grid().dims(), glam::UVec3::splat(64));
    let bench = Workspace::new(session, &config, Bindings::presets().unwrap());
    bench_around(bench, vec2(1280.0, 800.0))
}

/// A file that was dragged onto the window.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn files_dropped_on_the_window_are_opened_or_stand_as_references() {
    let folder = tempfile::tempdir().unwrap();
    let [other, picture] = ["other.vsc", "front.png"].map(|name| folder.path().join(name));
    let mut harness = bench();
    ask_for(&mut harness, "new dims=40,40,40");
    execute(&mut harness, &format!("save {other:?}"));
    ask_for(&mut harness, "new dims=24,24,24");
    image::RgbImage::new(4, 4).save(&picture).unwrap();
    let drop = |harness: &mut Bench, paths: &[&Path]| {
        let file = |path: &&Path| Arc::new(Dropped(path.to_path_buf())) as DroppedFileHandle;
        harness.input_mut().dropped_files = paths.iter().map(file).collect();
        settle(harness);
    };
    // Over the window a sign says what dropping would do; gone again, nothing has happened.
    let hovered = egui::HoveredFile { path: Some(other.clone()), ..egui::HoveredFile::default() };
    // X11 may name it several times.
    harness.input_mut().hovered_files = vec![hovered.clone(), hovered];
    harness.run_steps(2);
    assert!(harness.query_by_label("Drop to open other.vsc").is_some());
    harness.input_mut().hovered_files.clear();
    harness.run_steps(2);
    assert!(harness.query_by_label("Drop to open other.vsc").is_none());
    assert_eq!(edge(&harness), 24);

    // A file that is gone by the time it is dropped is said to be so, sculpture or picture.
    for name in ["gone.vsc", "gone.png"] {
        drop(&mut harness, &[&folder.path().join(name)]);
        let text = harness.state().ui.toasts.texts().last().map(|(_, text)| text.to_string());
        assert!(
            text.as_ref().is_some_and(|text| text.starts_with(&format!("{name} is not in"))),
            "{text:?}"
        );
        assert_eq!((harness.state().ui.references.len(), edge(&harness)), (0, 24));
    }

    drop(&mut harness, &[&picture]);
    assert_eq!(harness.state().ui.references.len(), 1);
    drop(&mut harness, &[&other]);
    assert_eq!((is_asked(&harness), edge(&harness)), (false, 40));
    execute(&mut harness, "clear");
    drop(&mut harness, &[&other]);
    assert!(is_asked(&harness), "there is unsaved work");
    drop(&mut harness, &[&other]);
    assert_eq!(voxels(&harness), 0, "a dialog is open");
    answer(&mut harness, "Cancel");
    assert_eq!(voxels(&harness), 0);
}
