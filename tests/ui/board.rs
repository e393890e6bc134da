//! The panels in a headset: they do not mention mouse, keys and screens, and the first steps explain triggers and sticks.

use egui::vec2;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use virtual_sculpture::app::Workspace;
use virtual_sculpture::document::Limits;
use virtual_sculpture::format::options::ImportOptions;
use virtual_sculpture::input::Bindings;
use virtual_sculpture::sculpture::orientation::Up;
use virtual_sculpture::session::Session;

use super::bench::{Bench, click, config, has, key, rest};
use super::import::{scan, settle};

/// The board in the size that it has in a headset.
pub fn board() -> Bench {
    let config = config(32);
    board_of(Session::new(&config.new_sculpture(), config.limits()).unwrap())
}

fn board_of(session: Session) -> Bench {
    let config = config(32);
    board_around(Workspace::new(session, &config, Bindings::presets().unwrap()))
}

/// The board of this workspace.
pub fn board_around(bench: Workspace) -> Bench {
    Harness::builder()
        .with_size(vec2(1250.0, 800.0))
        .with_pixels_per_point(1.0)
        .build_ui_state(|ui, bench: &mut Workspace| bench.show_on_board(ui), bench)
}

#[test]
fn controls_that_need_a_desk_are_not_on_the_board() {
    let mut harness = board();
    rest(&mut harness);
    assert!(has(&harness, "Snap to voxels") && has(&harness, "Lights"));
    for label in ["Help", "Stereo", "Video", "Follow the pointer", "Rest on the surface"] {
        assert!(!has(&harness, label), "{label}");
    }
    assert!(!has(&harness, "Head tracking and AR"));
    click(&mut harness, "Menu");
    assert!(has(&harness, "First steps") && has(&harness, "Fill the grid"));
    for label in ["Controls ⏵", "Full screen", "Save picture", "Panels ⏵"] {
        assert!(!has(&harness, label), "{label}");
    }
    click(&mut harness, "Lights");
    assert!(has(&harness, "Add light"), "the lamps can be reached by hand");
}

#[test]
fn tooltips_on_the_board_name_no_keys() {
    let mut harness = board();
    rest(&mut harness);
    harness.get_by_label("Cuboid").hover();
    harness.run_steps(60);
    assert!(has(&harness, "Cuboid tool"));
    assert!(!has(&harness, "C"), "the key of the cuboid");
}

#[test]
fn the_first_steps_are_those_of_hands_and_come_true() {
    let mut harness = board();
    harness.state_mut().ui.dialogs.guide.open = true;
    rest(&mut harness);
    for title in ["1. Clear half of the grid", "2. Limit the tools to it"] {
        harness.get_by_label(title);
        harness.get_by_label("Do it for me").click();
        harness.run_steps(3);
        rest(&mut harness);
    }
    harness.get_by_label("3. Add a cuboid");
    harness.get_by_label_contains("pull the trigger");
    assert!(harness.query_by_label_contains("left button").is_none());
    for title in ["4. Roughen it", "5. Smooth it", "6. Paint it", "7. Recolour the ground"] {
        click(&mut harness, "Skip");
        harness.get_by_label(title);
        let told =
            harness.query_by_label_contains("Ctrl").or(harness.query_by_label_contains("mouse"));
        assert!(told.is_none(), "{title}");
    }
}

#[test]
fn a_volume_is_turned_upright_on_the_board() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("scan.pvm");
    let mut bytes = b"PVM\n24 16 8\n1\n".to_vec();
    bytes.extend((0..24 * 16 * 8).map(|i| if i < 24 * 16 * 2 { 200u8 } else { 0 }));
    std::fs::write(&scan, bytes).unwrap();
    let session = Session::open(&scan, &ImportOptions::default(), Limits::default(), &()).unwrap();
    let mut harness = board_of(session);
    rest(&mut harness);
    harness.get_by_label("Which axis points up?");
    // Nothing is covered by it.
    let strip = harness.get_by_label("Z up").rect();
    assert!(harness.get_by_label("Cuboid").rect().top() > strip.bottom());
    click(&mut harness, "Z up");
    harness.state_mut().finish_job();
    rest(&mut harness);
    let dims = harness.state().session().document().grid().dims();
    assert_eq!(dims, glam::UVec3::new(24, 8, 16));
    assert!(!has(&harness, "Which axis points up?"));
    assert_eq!(harness.state().ui.known_files.upright.of(&scan), Some(Up::Z));
}

#[test]
fn a_scan_is_chosen_shown_and_imported_on_the_board() {
    let folder = tempfile::tempdir().unwrap();
    scan(folder.path(), "ball.nrrd");
    let mut harness = board();
    harness.state_mut().ui.dialogs.files.set_folder(folder.path().to_path_buf());
    click(&mut harness, "Open");
    harness.run_steps(4);
    for choose in [egui::Key::ArrowDown, egui::Key::Enter] {
        key(&mut harness, egui::Modifiers::NONE, choose);
        harness.run_steps(4);
    }
    assert!(!harness.state().ui.dialogs.files.is_open(), "the file is chosen");
    settle(&mut harness);
    for label in ["Import ball.nrrd", "Axial", "Coronal", "Sagittal", "Automatic"] {
        assert!(has(&harness, label), "{label}");
    }
    for label in ["Import", "Cancel", "Fill holes", "Ask each time"] {
        let button = harness.get_by_label(label).rect();
        let board = egui::Rect::from_min_size(egui::Pos2::ZERO, vec2(1250.0, 800.0));
        assert!(board.contains_rect(button), "{label}: {button:?}");
    }
    click(&mut harness, "Fill holes");
    harness.get_by_label("Import").click();
    settle(&mut harness);
    let dims = harness.state().session().document().grid().dims();
    assert_eq!(dims, glam::UVec3::new(24, 12, 24));
    assert!(!harness.state().ui.dialogs.import.is_open());
}

/// While the board is closed its messages are there all the same, and nothing else.
#[test]
fn messages_are_shown_without_the_board() {
    let config = config(32);
    let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let mut workspace = Workspace::new(session, &config, Bindings::presets().unwrap());
    workspace.ui.toasts.note("Nothing was added: the tool was outside the grid");
    let mut harness = Harness::builder()
        .with_size(vec2(1250.0, 800.0))
        .build_ui_state(|ui, bench: &mut Workspace| bench.show_messages(ui), workspace);
    harness.run_steps(3);
    assert!(has(&harness, "Nothing was added: the tool was outside the grid"));
    assert!(!has(&harness, "Cuboid") && !has(&harness, "Menu"));
}
