//! Long work seen from the program: what is shown, refused and said meanwhile, and what follows it.

use std::sync::mpsc::{Sender, channel};

use super::Workspace;
use crate::command::Command;
use crate::config::Config;
use crate::editor::job::Then;
use crate::input::{Action, Bindings};
use crate::picture::FinalOptions;
use crate::progress::{Progress, Report};
use crate::session::Session;
use crate::trace::MAX_FINAL_SAMPLES;
use crate::ui::toasts::Tone;

fn workspace() -> Workspace {
    let mut config = Config::default();
    config.new.dims = [24, 16, 8];
    let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    Workspace::new(session, &config, Bindings::presets().unwrap())
}

/// Starts a command whose work waits for a word before it begins.
fn start_slowly(workspace: &mut Workspace, command: &str) -> Sender<()> {
    let command: Command = command.parse().unwrap();
    let work = workspace.session_mut().prepare(&command).unwrap().unwrap();
    let (go, wait) = channel();
    let slow = move |report: &Report| {
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
fn what_is_cancelled_leaves_file_and_sculpture_as_they_were() {
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

    // Cancelled it leaves all as it is.
    workspace.run_now(&"undo".parse().unwrap());
    let go = start_slowly(&mut workspace, "undo");
    assert_eq!(workspace.ui.dialogs.busy.as_ref().unwrap().what, "Undoing");
    workspace.editor.cancel_job();
    go.send(()).unwrap();
    workspace.finish_job();
    assert_eq!((undone(&workspace), contents(&workspace)), (1, states[4].clone()));

    // From the end: the orientation is work, the next step is done at once, and so on.
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
    let mut options = FinalOptions::default();

    // By its key, and cancelled at once.
    let keys = workspace.controls.bindings().and_then(|table| table.shortcut(Action::FinalPicture));
    assert_eq!(keys.as_deref(), Some("Shift+F12"));
    workspace.act(Action::FinalPicture);
    assert_eq!(workspace.ui.dialogs.busy.as_ref().map(|busy| busy.what), Some("Final picture"));
    workspace.editor.cancel_job();
    workspace.finish_job();
    assert_eq!((tones(&workspace).last(), files()), (Some(&Tone::Note), 1));

    // Cancelled it leaves no file, whenever that is.
    options.trace.samples = MAX_FINAL_SAMPLES;
    workspace.start_final_picture(options);
    while workspace.editor.busy().unwrap().stage.what != "tracing light" {
        std::thread::yield_now();
    }
    assert_eq!(workspace.editor.busy().unwrap().what, "Final picture");
    assert!(!workspace.run_now(&"clear".parse().unwrap()));
    workspace.start_final_picture(options);
    workspace.follow_job();
    assert_eq!(tones(&workspace).last(), Some(&Tone::Error), "one at a time");
    workspace.editor.cancel_job();
    workspace.finish_job();
    assert_eq!((tones(&workspace).last(), files()), (Some(&Tone::Note), 1));

    options.trace.samples = 2;
    for name in ["a-final-1.png", "a-final-2.png"] {
        workspace.start_final_picture(options);
        workspace.finish_job();
        let picture = image::open(folder.path().join(name)).unwrap();
        let size = workspace.eyes()[0].size;
        assert_eq!((picture.width(), picture.height()), (size.x, size.y));
        let texts: Vec<String> =
            workspace.ui.toasts.texts().map(|(_, text)| text.to_string()).collect();
        assert!(texts.last().unwrap().contains(name), "{texts:?}");
    }
    assert_eq!(workspace.session().document().revision(), revision);
    assert!(!workspace.session().modified());
}
