//! Tests the video behind the sculpture without a window: a film, a missing camera, and the messages.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::Workspace;
use crate::config::Config;
use crate::input::{Action, Bindings};
use crate::session::Session;
use crate::ui::widgets::toasts::Tone;
use crate::video::{Intrinsics, VideoFrame};
use crate::viewpoint::camera::VideoState;

fn workspace(source: &str) -> Workspace {
    let mut config = Config::default();
    config.video.source = source.to_string();
    config.new.dims = [16; 3];
    let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    Workspace::new(session, &config, Bindings::presets().unwrap())
}

/// Returns the frame behind the sculpture and its lens.
fn video(workspace: &Workspace) -> Option<(&Arc<VideoFrame>, Option<Intrinsics>)> {
    workspace.viewpoint.video(&workspace.ui.view.video)
}

/// Returns a folder of `count` pictures, each of one colour.
fn film(count: u8) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for i in 0..count {
        let picture = image::RgbImage::from_pixel(8, 6, image::Rgb([i, 100, 200]));
        picture.save(folder.path().join(format!("{i:03}.png"))).unwrap();
    }
    folder
}

fn wait(workspace: &mut Workspace, done: impl Fn(&Workspace) -> bool) {
    let start = Instant::now();
    while !done(workspace) {
        assert!(
            start.elapsed() < Duration::from_secs(20),
            "{:?}",
            *workspace.viewpoint.camera.state()
        );
        std::thread::sleep(Duration::from_millis(5));
        workspace.follow_camera();
    }
}

#[test]
fn frames_come_while_the_video_is_on_and_the_camera_is_let_go_when_it_is_off() {
    let folder = film(3);
    let mut workspace = workspace(&format!("{}/?fps=50", folder.path().display()));
    workspace.follow_camera();
    assert!(video(&workspace).is_none() && !workspace.viewpoint.camera.is_open(), "off at first");
    workspace.act(Action::ToggleVideo);
    wait(&mut workspace, |workspace| video(workspace).is_some());
    let (frame, lens) = video(&workspace).unwrap();
    assert_eq!((frame.width, frame.height, lens), (8, 6, None));
    let first = frame.sequence;
    wait(&mut workspace, |workspace| video(workspace).unwrap().0.sequence > first + 3);
    assert!(workspace.viewpoint.camera.repaint_after().is_some(), "pictures go on by themselves");
    workspace.act(Action::ToggleVideo);
    workspace.follow_camera();
    assert!(video(&workspace).is_none() && !workspace.viewpoint.camera.is_open());
}

#[test]
fn a_camera_that_is_not_there_is_said_once_and_another_address_is_opened() {
    let mut workspace = workspace("v4l2:/dev/video-that-is-not-there");
    workspace.act(Action::ToggleVideo);
    wait(&mut workspace, |workspace| {
        matches!(*workspace.viewpoint.camera.state(), VideoState::Lost(_))
    });
    for _ in 0..20 {
        workspace.follow_camera();
    }
    let errors = workspace.ui.toasts.texts().filter(|(tone, _)| *tone == Tone::Error).count();
    assert_eq!(errors, 1);
    let folder = film(2);
    workspace.ui.view.video.source = folder.path().display().to_string();
    wait(&mut workspace, |workspace| video(workspace).is_some());
    assert_eq!(*workspace.viewpoint.camera.state(), VideoState::Live);
}

#[test]
fn a_lens_that_cannot_be_used_is_an_error_with_its_name() {
    let folder = film(1);
    let mut workspace = workspace(&folder.path().display().to_string());
    let lens = folder.path().join("lens.toml");
    std::fs::write(&lens, "width = 8\nheight = 6\nfx = -1.0\nfy = 8.0\ncx = 4.0\ncy = 3.0")
        .unwrap();
    workspace.ui.view.video.lens = lens;
    workspace.act(Action::ToggleVideo);
    workspace.follow_camera();
    let said = workspace.ui.toasts.texts().any(|(_, text)| text.contains("lens.toml"));
    assert!(said && video(&workspace).is_none());
}
