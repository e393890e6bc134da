//! The dialogs of final pictures and films: what is chosen in them is what is made, and Cancel and Escape make nothing.

use std::path::{Path, PathBuf};

use egui::accesskit::Role;
use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;
use glam::UVec2;
use virtual_sculpture::render::RenderMode;
use virtual_sculpture::trace::LightOptions;
use virtual_sculpture::ui::dialogs::picture_size::PictureSize;
use virtual_sculpture::ui::pictures::FinalFile;
use virtual_sculpture::ui::pictures::{FilmForm, FilmSubject};

use super::bench::{Bench, bench, bench_of, click, click_once, config, has, key, key_in, rest};

/// A bench whose sculpture has a file in this folder.
fn saved_in(folder: &Path) -> Bench {
    let mut harness = bench();
    let path = folder.join("a.vsc");
    let workspace = harness.state_mut();
    workspace.ui.view.mode = RenderMode::Ray;
    for line in ["subtract ellipsoid at=60,60,60 half=30".to_string(), format!("save {path:?}")] {
        workspace.session_mut().execute(&line.parse().unwrap(), &()).unwrap();
    }
    harness
}

/// Waits for what was started, and gives the files beside the sculpture.
fn files_after(harness: &mut Bench, folder: &Path) -> Vec<PathBuf> {
    harness.run_steps(2);
    harness.state_mut().finish_job();
    rest(harness);
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|path| !path.ends_with("a.vsc")).collect();
    files.sort();
    files
}

fn busy(harness: &Bench) -> bool {
    harness.state().editor.is_busy()
}

#[test]
fn a_final_picture_is_what_its_dialog_says() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saved_in(folder.path());
    for leave in ["Cancel", "Escape"] {
        key(&mut harness, Modifiers::SHIFT, Key::F12);
        rest(&mut harness);
        assert!(has(&harness, "Make picture") && has(&harness, "Sun azimuth"));
        assert!(harness.state().ui.dialogs.is_modal(), "keys are for the dialog");
        match leave {
            "Escape" => key_in(&mut harness, Modifiers::NONE, Key::Escape),
            label => click(&mut harness, label),
        }
        assert!(!has(&harness, "Make picture") && !busy(&harness), "{leave}");
    }

    key(&mut harness, Modifiers::SHIFT, Key::F12);
    rest(&mut harness);
    click(&mut harness, "Remove noise");
    click(&mut harness, "Ground");
    click(&mut harness, "Lamp");
    harness.get_by_label("Lamp strength").rect();
    let light = &harness.state().ui.dialogs.final_picture.trace.light;
    assert!(matches!(light, LightOptions::Outdoors { area_light: Some(_), .. }));
    let dialog = &mut harness.state_mut().ui.dialogs.final_picture;
    assert!(!dialog.denoise && dialog.trace.ground.is_none() && dialog.trace.samples == 64);
    dialog.size = PictureSize::Custom(UVec2::new(48, 32));
    dialog.trace.samples = 2;
    rest(&mut harness);
    choose(&mut harness, "File", "JPEG");
    assert_eq!(harness.state().ui.dialogs.final_picture.file, FinalFile::Jpeg);
    click_once(&mut harness, "Make picture");
    let files = files_after(&mut harness, folder.path());
    assert_eq!(files, [folder.path().join("a-final-1.jpg")]);
    let picture = image::open(&files[0]).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (48, 32));
    // Without ground the sky ends in the colour below the horizon, which is not that of the ground.
    let corner = picture.get_pixel(0, 31).0;
    assert!(corner[0].abs_diff(corner[2]) < 40 && corner[0] < 150, "{corner:?}");

    // The choices are still there, and Enter makes the next picture.
    key(&mut harness, Modifiers::SHIFT, Key::F12);
    rest(&mut harness);
    assert!(!harness.state().ui.dialogs.final_picture.denoise);
    key_in(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(files_after(&mut harness, folder.path()).len(), 2);
    key(&mut harness, Modifiers::SHIFT, Key::F12);
    rest(&mut harness);
    click(&mut harness, "Defaults");
    assert!(harness.state().ui.dialogs.final_picture.denoise && has(&harness, "Make picture"));
}

#[test]
fn in_the_smallest_window_the_buttons_of_the_dialogs_can_be_reached() {
    let mut harness = bench_of(&config(16), vec2(640.0, 480.0));
    for (modifiers, label) in [(Modifiers::SHIFT, "Make picture"), (Modifiers::ALT, "Make film")] {
        key(&mut harness, modifiers, Key::F12);
        harness.run_steps(6);
        let button = harness.get_by_label(label).rect();
        assert!(button.min.y > 0.0 && button.max.y < 480.0, "{label}: {button:?}");
        key_in(&mut harness, Modifiers::NONE, Key::Escape);
        harness.run_steps(3);
    }
}

#[test]
fn a_final_picture_is_shown_while_it_is_made_and_can_be_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saved_in(folder.path());
    key(&mut harness, Modifiers::SHIFT, Key::F12);
    let dialog = &mut harness.state_mut().ui.dialogs.final_picture;
    dialog.size = PictureSize::Custom(UVec2::new(64, 48));
    dialog.trace.samples = 4096;
    rest(&mut harness);
    click_once(&mut harness, "Make picture");
    let news = harness.state().ui.dialogs.preview.as_ref().unwrap().news();
    while news.lock().unwrap().is_none() {
        std::thread::yield_now();
    }
    std::thread::sleep(std::time::Duration::from_millis(200));
    // The next preview may come at any time.
    let is_taken = (0..100).any(|_| {
        harness.run_steps(3);
        news.lock().unwrap().is_none()
    });
    assert!(is_taken && has(&harness, "Tracing light"), "it is shown");
    click_once(&mut harness, "Cancel");
    assert!(files_after(&mut harness, folder.path()).is_empty());
    assert!(harness.state().ui.dialogs.preview.is_none() && !has(&harness, "Tracing light"));
}

/// Chooses in the list of this name, whose title has the same name.
fn choose(harness: &mut Bench, list: &str, choice: &str) {
    harness.get_by_role_and_label(Role::ComboBox, list).click();
    harness.run_steps(6);
    click(harness, choice);
}

#[test]
fn a_film_is_what_its_dialog_says() {
    let mut harness = bench();
    let kind = |harness: &Bench| harness.state().ui.dialogs.film.kind;
    key(&mut harness, Modifiers::ALT, Key::F12);
    rest(&mut harness);
    assert!(has(&harness, "Make film") && has(&harness, "Turntable"));
    click(&mut harness, "Time lapse");
    assert_eq!(kind(&harness), FilmSubject::Turntable, "nothing has been done yet");

    let folder = tempfile::tempdir().unwrap();
    let mut harness = saved_in(folder.path());
    key(&mut harness, Modifiers::ALT, Key::F12);
    rest(&mut harness);
    click(&mut harness, "Time lapse");
    assert_eq!(kind(&harness), FilmSubject::Lapse, "undo leads back through what was done");
    click(&mut harness, "Turntable");
    assert_eq!(kind(&harness), FilmSubject::Turntable);
    key_in(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert!(!has(&harness, "Make film") && !busy(&harness));

    key(&mut harness, Modifiers::ALT, Key::F12);
    let dialog = &mut harness.state_mut().ui.dialogs.film;
    dialog.size = PictureSize::Custom(UVec2::new(32, 24));
    (dialog.frames, dialog.samples, dialog.fps) = (3, 1, 60);
    dialog.form = FilmForm::Gif;
    rest(&mut harness);
    click_once(&mut harness, "Make film");
    let files = files_after(&mut harness, folder.path());
    assert_eq!(files, [folder.path().join("a-film-1.gif")]);
    let film = std::fs::read(&files[0]).unwrap();
    assert_eq!((&film[..6], &film[6..10]), (&b"GIF89a"[..], &[32, 0, 24, 0][..]));
}
