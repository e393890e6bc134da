//! Tests long work from the program's side: its display, refused commands, messages, and what follows it.

use std::sync::mpsc::{Sender, channel};

use glam::UVec2;

use super::Workspace;
use crate::command::Command;
use crate::config::Config;
use crate::editor::job::Then;
use crate::editor::questions::Next;
use crate::input::{Action, Bindings};
use crate::progress::{Progress, ProgressReport};
use crate::session::Session;
use crate::trace::MAX_FINAL_SAMPLES;
use crate::ui::UiRequest;
use crate::ui::pictures::{FilmForm, FilmRequest, FilmSubject};
use crate::ui::pictures::{FinalFile, FinalRequest};
use crate::ui::widgets::toasts::Tone;

fn workspace() -> Workspace {
    let mut config = Config::default();
    config.new.dims = [24, 16, 8];
    let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    Workspace::new(session, &config, Bindings::presets().unwrap())
}

/// Starts a command whose work waits for a signal before it begins.
fn start_slowly(workspace: &mut Workspace, command: &str) -> Sender<()> {
    let command: Command = command.parse().unwrap();
    let work = workspace.session_mut().prepare(&command).unwrap().unwrap();
    let (go, wait) = channel();
    let slow = move |report: &ProgressReport| {
        report.begin("thinking");
        report.advance(0.25);
        wait.recv().unwrap();
        work.run(report)
    };
    workspace.editor.start_work(slow, &command, Then::Stay);
    while workspace.editor.busy().unwrap().stage.done.is_none() {
        std::thread::yield_now();
    }
    workspace.follow_job();
    go
}

fn tones(workspace: &Workspace) -> Vec<Tone> {
    workspace.ui.toasts.texts().map(|(tone, _)| tone).collect()
}

#[test]
fn while_it_runs_it_is_shown_and_nothing_changes() {
    let mut workspace = workspace();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    workspace.run_now(&"subtract cuboid at=4,4,4 half=2".parse().unwrap());
    let before = workspace.session().document().contents().clone();
    let go = start_slowly(&mut workspace, &format!("save {path:?}"));
    let busy = workspace.ui.dialogs.busy.clone().unwrap();
    assert_eq!((busy.what, busy.stage.done), ("Saving", Some(0.25)));
    assert_eq!(busy.stage.what, "thinking");
    assert!(workspace.ui.dialogs.is_modal());
    for refused in ["clear", "undo", "subtract cuboid at=9,9,4 half=3", "begin"] {
        assert!(!workspace.run_now(&refused.parse().unwrap()), "{refused}");
    }
    workspace.editor.run("new dims=8,8,8".parse().unwrap());
    assert!(workspace.run_now(&"place scale=2".parse().unwrap()), "the view may move");
    assert_eq!(*workspace.session().document().contents(), before);
    assert!(workspace.session().modified());
    go.send(()).unwrap();
    workspace.finish_job();
    assert!(workspace.ui.dialogs.busy.is_none() && !workspace.session().modified());
    let saved = crate::format::load(&path, &Default::default(), &Default::default(), &());
    assert_eq!(saved.unwrap().contents.grid, before.grid);
    assert!(workspace.run_now(&"clear".parse().unwrap()), "work goes on");
}

#[test]
fn a_cancelled_job_leaves_file_and_sculpture_as_they_were() {
    let mut workspace = workspace();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pvm");
    for line in [format!("save {path:?}"), format!("open {path:?}")] {
        if line.starts_with("open") {
            workspace
                .session_mut()
                .execute(&format!("save {path:?}").parse().unwrap(), &())
                .unwrap();
        }
        workspace.run_now(&"subtract cuboid at=4,4,4 half=2".parse().unwrap());
        let (before, there) = (workspace.session().document().revision(), path.exists());
        let go = start_slowly(&mut workspace, &line);
        workspace.editor.cancel_job();
        go.send(()).unwrap();
        workspace.finish_job();
        assert_eq!(workspace.session().document().revision(), before, "{line}");
        assert_eq!(path.exists(), there, "{line}");
        assert_eq!(tones(&workspace).last(), Some(&Tone::Note));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), usize::from(there));
    }
}

#[test]
fn leaving_waits_for_a_save_and_gives_up_an_opening() {
    let mut workspace = workspace();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    workspace.run_now(&"clear".parse().unwrap());
    let go = start_slowly(&mut workspace, &format!("save {path:?}"));
    workspace.ask_to_leave();
    workspace.follow_job();
    assert!(!workspace.is_leaving() && workspace.editor.is_busy());
    go.send(()).unwrap();
    workspace.finish_job();
    assert!(workspace.is_leaving() && path.exists());

    let mut workspace = self::workspace();
    let go = start_slowly(&mut workspace, &format!("open {path:?}"));
    workspace.ask_to_leave();
    go.send(()).unwrap();
    workspace.finish_job();
    assert!(workspace.is_leaving());
    assert!(workspace.session().document().grid().opaque_count() > 0, "it was not opened");
}

#[test]
fn leaving_with_work_under_way_asks_about_what_is_not_saved() {
    let mut workspace = workspace();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    workspace.run_now(&format!("save {path:?}").parse().unwrap());
    workspace.run_now(&"clear".parse().unwrap());
    let go = start_slowly(&mut workspace, &format!("open {path:?}"));
    workspace.ask_to_leave();
    assert!(!workspace.is_leaving() && workspace.ui.dialogs.unsaved.is_none());
    go.send(()).unwrap();
    workspace.finish_job();
    assert!(!workspace.is_leaving() && workspace.session().modified());
    assert_eq!(workspace.ui.dialogs.unsaved, Some(Next::Leave));
}

#[test]
fn a_failure_is_an_error_on_screen_and_keeps_the_program() {
    let mut workspace = workspace();
    workspace.run_now(&"clear".parse().unwrap());
    let go = start_slowly(&mut workspace, "save \"/nonexistent/a.pvm\"");
    workspace.ask_to_leave();
    go.send(()).unwrap();
    workspace.finish_job();
    assert!(!workspace.is_leaving() && workspace.session().modified());
    assert_eq!(tones(&workspace), [Tone::Error]);
}

#[test]
fn undo_and_redo_of_an_orientation_are_work_and_go_on_with_the_other_steps() {
    let mut workspace = workspace();
    let contents = |workspace: &Workspace| workspace.session().document().contents().clone();
    let undone = |workspace: &Workspace| workspace.session().document().history().redo_count();
    let mut states = vec![contents(&workspace)];
    for line in [
        "subtract cuboid at=4,4,4 half=2",
        "orient upright=z",
        "subtract cuboid at=9,4,4 half=3",
        "orient axes=z,x,y",
        "clear",
    ] {
        workspace.run_now(&line.parse().unwrap());
        states.push(contents(&workspace));
    }

    // Cancelling changes nothing.
    workspace.run_now(&"undo".parse().unwrap());
    let go = start_slowly(&mut workspace, "undo");
    assert_eq!(workspace.ui.dialogs.busy.as_ref().unwrap().what, "Undoing");
    workspace.editor.cancel_job();
    go.send(()).unwrap();
    workspace.finish_job();
    assert_eq!((undone(&workspace), contents(&workspace)), (1, states[4].clone()));

    // From the end: the orientation is a job, the next step is done at once, and so on.
    workspace.run_now(&"redo".parse().unwrap());
    for (line, stops) in [("undo all", [4, 2, 0]), ("redo all", [1, 3, 5]), ("undo 4", [4, 2, 1])] {
        workspace.editor.run(line.parse().unwrap());
        for at in stops {
            assert_eq!(contents(&workspace), states[at], "{line}: {at}");
            assert_eq!(workspace.editor.is_busy(), at != stops[2], "{line}: {at}");
            workspace.finish_job();
        }
        assert!(!workspace.editor.is_busy());
    }
    assert!(tones(&workspace).iter().all(|tone| *tone == Tone::Note), "the cancelled one alone");
}

#[test]
fn a_final_picture_is_work_that_changes_nothing_and_leaves_a_file_only_when_it_is_done() {
    let mut workspace = workspace();
    let folder = tempfile::tempdir().unwrap();
    let sculpture = folder.path().join("a.vsc");
    workspace.run_now(&"subtract cuboid at=4,4,4 half=2".parse().unwrap());
    workspace.run_now(&format!("save {sculpture:?}").parse().unwrap());
    workspace.finish_job();
    let revision = workspace.session().document().revision();
    let files = || std::fs::read_dir(folder.path()).unwrap().count();
    let mut wanted = final_request(UVec2::new(24, 16));

    // Its key requests it.
    let keys = workspace.controls.bindings().and_then(|table| table.shortcut(Action::FinalPicture));
    assert_eq!(keys.as_deref(), Some("Shift+F12"));
    workspace.act(Action::FinalPicture);
    assert!(workspace.ui.dialogs.final_picture.open && !workspace.editor.is_busy());
    workspace.act(Action::Cancel);
    assert!(!workspace.ui.dialogs.final_picture.open);

    // Cancelling leaves no file, at any time.
    wanted.trace.samples = MAX_FINAL_SAMPLES;
    workspace.start_final_picture(&wanted);
    while workspace.editor.busy().unwrap().stage.what != "tracing light" {
        std::thread::yield_now();
    }
    assert_eq!(workspace.editor.busy().unwrap().what, "Final picture");
    assert!(!workspace.run_now(&"clear".parse().unwrap()));
    workspace.start_final_picture(&wanted);
    workspace.follow_job();
    assert_eq!(tones(&workspace).last(), Some(&Tone::Error), "one at a time");
    let news = workspace.ui.dialogs.preview.as_ref().unwrap().news();
    while news.lock().unwrap().is_none() {
        std::thread::yield_now();
    }
    let shown = news.lock().unwrap().take().unwrap();
    assert_eq!(shown.size, UVec2::new(24, 16));
    assert!(shown.rgba.iter().any(|rgba| rgba[..3] != shown.rgba[0][..3]), "a picture already");
    workspace.editor.cancel_job();
    workspace.finish_job();
    assert_eq!((tones(&workspace).last(), files()), (Some(&Tone::Note), 1));

    assert!(workspace.ui.dialogs.preview.is_none(), "it goes with its work");
    wanted.trace.samples = 2;
    let names = ["a-final-1.png", "a-final-2.png", "a-final-1.jpg", "a-final-1.exr"];
    for (name, file) in
        names.into_iter().zip([FinalFile::Png, FinalFile::Png, FinalFile::Jpeg, FinalFile::Exr])
    {
        wanted.file = file;
        workspace.start_final_picture(&wanted);
        workspace.finish_job();
        let path = folder.path().join(name);
        if file == FinalFile::Exr {
            assert_eq!(std::fs::read(path).unwrap()[..4], 20_000_630u32.to_le_bytes());
        } else {
            let picture = image::open(path).unwrap();
            assert_eq!((picture.width(), picture.height()), (24, 16));
        }
        let texts: Vec<String> =
            workspace.ui.toasts.texts().map(|(_, text)| text.to_string()).collect();
        assert!(texts.last().unwrap().contains(name), "{texts:?}");
    }
    assert_eq!(workspace.session().document().revision(), revision);
    assert!(!workspace.session().modified());
}

fn final_request(size: UVec2) -> FinalRequest {
    FinalRequest {
        size,
        trace: Default::default(),
        denoise: true,
        exposure_ev: 0.0,
        file: FinalFile::Png,
        on_gpu: false,
    }
}

fn film_request(kind: FilmSubject, form: FilmForm) -> FilmRequest {
    let size = UVec2::new(40, 32);
    FilmRequest { kind, frames: 4, fps: 10, spin_deg: 360.0, size, samples: 1, form }
}

#[test]
fn a_film_is_work_that_changes_nothing_and_leaves_what_was_asked_for() {
    let mut workspace = workspace();
    let folder = tempfile::tempdir().unwrap();
    let sculpture = folder.path().join("a.vsc");
    workspace.run_now(&"subtract cuboid at=4,4,4 half=6".parse().unwrap());
    workspace.run_now(&format!("save {sculpture:?}").parse().unwrap());
    workspace.finish_job();
    workspace.ui.view.mode = crate::render::RenderMode::Ray;
    let revision = workspace.session().document().revision();
    let film = |workspace: &mut Workspace, wanted| {
        workspace.answer_requests(vec![UiRequest::Film(wanted)]);
        workspace.finish_job();
        workspace.ui.toasts.texts().last().map(|(tone, text)| (tone, text.to_string())).unwrap()
    };
    for (form, name) in [
        (FilmForm::AnimatedPng, "a-film-1.apng"),
        (FilmForm::Gif, "a-film-1.gif"),
        (FilmForm::Y4m, "a-film-1.y4m"),
        (FilmForm::Folder, "a-film-1"),
    ] {
        let (tone, text) = film(&mut workspace, film_request(FilmSubject::Turntable, form));
        assert!(tone == Tone::Note && text.contains(name), "{text}");
        assert!(folder.path().join(name).exists(), "{name}");
    }
    let frame = |n| {
        let path = folder.path().join(format!("a-film-1/frame-000{n}.png"));
        image::open(path).unwrap().to_rgb8()
    };
    assert_eq!(frame(1).dimensions(), (40, 32));
    assert!(frame(1) != frame(2) && frame(2) != frame(3), "it turns");
    assert!(!folder.path().join("a-film-1/frame-0005.png").exists());
    // The film begins with the side that the view shows.
    workspace.look_from(crate::input::Side::Back);
    film(&mut workspace, film_request(FilmSubject::Turntable, FilmForm::Folder));
    let from_behind = image::open(folder.path().join("a-film-2/frame-0001.png")).unwrap().to_rgb8();
    assert!(from_behind != frame(1));

    assert_eq!(workspace.session().document().revision(), revision, "the view alone");

    // Cancelling leaves no file.
    let long =
        FilmRequest { frames: 100_000, ..film_request(FilmSubject::Turntable, FilmForm::Gif) };
    workspace.answer_requests(vec![UiRequest::Film(long)]);
    while workspace.editor.busy().unwrap().stage.what != "filming" {
        std::thread::yield_now();
    }
    workspace.answer_requests(vec![UiRequest::StopWork]);
    workspace.finish_job();
    assert!(!folder.path().join("a-film-2.gif").exists());
    assert_eq!(workspace.ui.toasts.texts().last().unwrap().1, "Film: cancelled");
}

#[test]
fn the_undo_history_becomes_a_time_lapse_without_any_recording() {
    let mut workspace = workspace();
    let folder = tempfile::tempdir().unwrap();
    let wanted = film_request(FilmSubject::Lapse, FilmForm::Folder);
    let wanted = FilmRequest { frames: 4, spin_deg: 0.0, ..wanted };
    workspace.answer_requests(vec![UiRequest::Film(wanted)]);
    let (tone, text) = workspace.ui.toasts.texts().last().unwrap();
    assert!(tone == Tone::Error && text.contains("no steps yet"), "{text}");

    let sculpture = folder.path().join("a.vsc");
    for line in [
        "subtract cuboid at=12,16,4 half=6",
        "subtract cuboid at=4,4,4 half=6",
        "undo",
        "clear",
        "undo",
        "add ellipsoid at=12,16,4 half=3",
        "subtract cuboid at=4,4,12 half=5",
    ] {
        workspace.run_now(&line.parse().unwrap());
    }
    workspace.run_now(&format!("save {sculpture:?}").parse().unwrap());
    workspace.finish_job();
    let revision = workspace.session().document().revision();
    workspace.ui.view.mode = crate::render::RenderMode::Ray;
    workspace.answer_requests(vec![UiRequest::Film(wanted)]);
    workspace.finish_job();
    assert_eq!(workspace.session().document().revision(), revision, "the sculpture stays");
    let frame = |name: &str, n: u32| {
        let path = folder.path().join(format!("{name}/frame-000{n}.png"));
        image::open(path).unwrap().to_rgb8()
    };
    // The first frame shows the beginning, the next three the steps, and the last the present.
    let frames = [1, 2, 3, 4].map(|n| frame("a-film-1", n));
    for (i, j) in [(0, 1), (1, 2), (2, 3), (0, 2), (0, 3), (1, 3)] {
        assert!(frames[i] != frames[j], "frames {i} and {j}");
    }
    let now = FilmRequest { kind: FilmSubject::Turntable, frames: 1, ..wanted };
    workspace.answer_requests(vec![UiRequest::Film(now)]);
    workspace.finish_job();
    assert!(frames[3] == frame("a-film-2", 1), "the last frame is the sculpture as it is");
}

#[test]
fn a_recording_becomes_a_time_lapse() {
    let mut workspace = workspace();
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("session.sculpt");
    workspace.session_mut().record_to(&script).unwrap();
    let sculpture = folder.path().join("a.vsc");
    for line in ["subtract cuboid at=12,16,4 half=6", "subtract cuboid at=4,4,4 half=6"] {
        workspace.run_now(&line.parse().unwrap());
    }
    workspace.run_now(&format!("save {sculpture:?}").parse().unwrap());
    workspace.finish_job();
    workspace.ui.view.mode = crate::render::RenderMode::Ray;
    let wanted = film_request(FilmSubject::Lapse, FilmForm::Folder);
    let wanted = FilmRequest { frames: 3, spin_deg: 0.0, ..wanted };
    workspace.answer_requests(vec![UiRequest::Film(wanted)]);
    workspace.finish_job();
    let frames = [1, 2, 3].map(|n| {
        let path = folder.path().join(format!("a-film-1/frame-000{n}.png"));
        image::open(path).unwrap().to_rgb8()
    });
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
}
