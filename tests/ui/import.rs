//! The import dialog: what it shows of scans and meshes, what is chosen in it is what is opened, and when it is not asked.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{DroppedFileHandle, Event, Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::UVec3;
use virtual_sculpture::format::options::{Cubic, Existence, MeshSize};

use super::bench::{
    Bench, bench, bench_of, click, config, has, key, run, send, undo_count, voxels,
};

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

/// A scan of a ball of density 100 with a core of 200, in voxels of two millimetres along the body.
pub fn scan(folder: &Path, name: &str) -> PathBuf {
    let mut file = b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 24 24 12\nencoding: raw\n\
        space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,2)\n\n"
        .to_vec();
    let centre = glam::Vec3::new(11.5, 11.5, 11.0);
    file.extend((0..24 * 24 * 12).map(|i| {
        let at =
            UVec3::new(i % 24, i / 24 % 24, i / 576).as_vec3() * glam::Vec3::new(1.0, 1.0, 2.0);
        match at.distance(centre) {
            ..4.0 => 200u8,
            ..9.0 => 100,
            _ => 5,
        }
    }));
    let path = folder.join(name);
    std::fs::write(&path, file).unwrap();
    path
}

/// A tetrahedron of 40 millimetres.
fn mesh(folder: &Path, name: &str) -> PathBuf {
    let text = "v 0 0 0\nv 40 0 0\nv 0 20 0\nv 0 0 30\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// A block of two colours, as high as it is wide and deep together.
fn model(folder: &Path, name: &str) -> PathBuf {
    let mut harness = bench();
    let path = folder.join(name);
    run(&mut harness, "new dims=8,16,8 colour=24");
    run(&mut harness, "recolour cuboid at=4,2,4 half=4,2,4 colour=#c03020");
    run(&mut harness, &format!("save {path:?}"));
    path
}

pub fn settle(harness: &mut Bench) {
    for _ in 0..3 {
        harness.run_steps(3);
        harness.state_mut().finish_job();
    }
    harness.run_steps(4);
}

fn drop_file(harness: &mut Bench, path: &Path) {
    let file = Arc::new(Dropped(path.to_path_buf())) as DroppedFileHandle;
    harness.input_mut().dropped_files = vec![file];
    settle(harness);
}

/// Clicks where a file is read then.
fn press(harness: &mut Bench, label: &str) {
    harness.get_by_label(label).click();
    settle(harness);
}

fn is_open(harness: &Bench) -> bool {
    harness.state().ui.dialogs.import.is_open()
}

fn dims(harness: &Bench) -> [u32; 3] {
    harness.state().session().document().grid().dims().to_array()
}

#[test]
fn a_scan_is_shown_and_opened_as_it_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = scan(folder.path(), "ball.nrrd");
    let mut harness = bench();
    for leave in ["Cancel", "Escape"] {
        drop_file(&mut harness, &path);
        for label in ["Import ball.nrrd", "Axial", "Coronal", "Sagittal", "Automatic", "Fill holes"]
        {
            assert!(has(&harness, label), "{label}");
        }
        assert!(harness.state().ui.dialogs.is_modal(), "keys are for the dialog");
        assert!(!has(&harness, "Up"), "the file says how the patient lies");
        harness.get_by_label("24 × 12 × 24 voxels, 24.0 × 24.0 × 24.0 mm").rect();
        match leave {
            "Escape" => key(&mut harness, Modifiers::NONE, Key::Escape),
            label => click(&mut harness, label),
        }
        assert!(!is_open(&harness) && dims(&harness) == [64; 3], "{leave}");
    }

    // By the thresholds shown, of cubes, and undone in one step.
    drop_file(&mut harness, &path);
    click(&mut harness, "Automatic");
    let plain = *harness.state().ui.dialogs.import.options();
    assert!(matches!(plain.existence, Existence::Threshold(least) if least > 5.0));
    click(&mut harness, "Largest piece only");
    key(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    assert_eq!((is_open(&harness), dims(&harness)), (false, [24, 12, 24]));
    let (ball, steps) = (voxels(&harness), undo_count(&harness));
    assert!(ball > 1200 && ball < 2000, "{ball}");
    assert!(!has(&harness, "Which axis points up?"));
    run(&mut harness, "undo");
    assert_eq!((dims(&harness), undo_count(&harness)), ([64; 3], steps - 1));

    // The next is asked about with the same, but for what belongs to one file.
    drop_file(&mut harness, &scan(folder.path(), "other.nrrd"));
    let next = *harness.state().ui.dialogs.import.options();
    assert!(next.largest_piece && next.existence == Existence::Auto);
}

/// A scan of two times in one file: the ball, and a smaller one.
fn scan_of_two_times(folder: &Path, name: &str) -> PathBuf {
    let path = scan(folder, name);
    let file = std::fs::read(&path).unwrap();
    let end = file.windows(2).position(|two| two == b"\n\n").unwrap() + 2;
    let header = String::from_utf8(file[..end].to_vec()).unwrap();
    let header = header
        .replace("dimension: 3", "dimension: 4")
        .replace("sizes: 24 24 12", "sizes: 24 24 12 2")
        .replace("(0,0,2)", "(0,0,2) none");
    let smaller: Vec<u8> =
        file[end..].iter().map(|level| if *level == 200 { 200 } else { 5 }).collect();
    std::fs::write(&path, [header.as_bytes(), &file[end..], &smaller].concat()).unwrap();
    path
}

#[test]
fn one_of_several_times_is_chosen_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = bench();
    drop_file(&mut harness, &scan(folder.path(), "ball.nrrd"));
    assert!(!has(&harness, "Time") && !has(&harness, "Channel"), "there is only one");
    click(&mut harness, "Cancel");

    let path = scan_of_two_times(folder.path(), "times.nrrd");
    drop_file(&mut harness, &path);
    assert!(has(&harness, "of 2") && !has(&harness, "Channel"));
    let note = "First of 2 volumes taken; the option `time` takes another";
    assert!(has(&harness, note));
    let both = share(&harness);
    click(&mut harness, "Largest piece only");
    harness.get_by_role_and_label(egui::accesskit::Role::SpinButton, "Time").focus();
    harness.run_steps(2);
    send(&mut harness, Event::Text("2".to_string()));
    assert!(is_open(&harness));
    key(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    let options = *harness.state().ui.dialogs.import.options();
    assert_eq!(options.time.map(|time| time.get()), Some(2));
    assert!(options.largest_piece, "other choices stay");
    assert!(is_open(&harness) && !has(&harness, note), "it was asked for");
    assert!(share(&harness) < both / 4.0, "its own histogram: {} {both}", share(&harness));
    press(&mut harness, "Import");
    let small = voxels(&harness);
    assert!(!is_open(&harness) && small > 100 && small < 200, "{small}");

    // It belongs to that file.
    drop_file(&mut harness, &path);
    assert_eq!(harness.state().ui.dialogs.import.options().time, None);
    press(&mut harness, "Import");
    assert!(voxels(&harness) > 1200);
}

/// The share of voxels that would exist, in percent.
fn share(harness: &Bench) -> f32 {
    let label = harness.get_by_label_contains("% of the voxels");
    let text = label.accesskit_node().value().or(label.accesskit_node().label()).unwrap();
    text.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn thresholds_are_dragged_in_the_histogram_and_slices_lead_to_one_another() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = bench();
    drop_file(&mut harness, &scan(folder.path(), "ball.nrrd"));
    let fields = harness.get_by_label("Automatic").rect();
    // The histogram is above its fields.
    let at = |x: f32| egui::pos2(fields.left() + x, fields.top() - 40.0);
    let drag = |harness: &mut Bench, from: f32, to: f32| {
        harness.drag_at(at(from));
        harness.run_steps(2);
        harness.hover_at(at(to));
        harness.run_steps(2);
        harness.drop_at(at(to));
        harness.run_steps(2);
    };
    let options = |harness: &Bench| *harness.state().ui.dialogs.import.options();
    drag(&mut harness, 20.0, 400.0);
    let Existence::Threshold(least) = options(&harness).existence else { panic!("the lower one") };
    assert!(least > 100.0 && least < 200.0, "{least}");
    drag(&mut harness, 640.0, 500.0);
    let Existence::Range(same, most) = options(&harness).existence else { panic!("both") };
    assert!(same == least && most > least && most < 200.0, "{same} {most}");
    click(&mut harness, "Automatic");
    assert_eq!(options(&harness).existence, Existence::Auto);
}

#[test]
fn a_mesh_is_measured_in_voxels_or_millimetres() {
    let folder = tempfile::tempdir().unwrap();
    let path = mesh(folder.path(), "wedge.obj");
    let mut harness = bench();
    drop_file(&mut harness, &path);
    harness.get_by_label("256 × 128 × 192 voxels, 40.0 × 20.0 × 30.0 mm").rect();
    click(&mut harness, "Voxel of");
    let options = *harness.state().ui.dialogs.import.options();
    assert!(matches!(options.mesh_size, MeshSize::VoxelMm(edge) if (edge - 0.15625).abs() < 1e-6));
    click(&mut harness, "Longest side");
    press(&mut harness, "Import");
    assert_eq!(dims(&harness), [256, 128, 192]);
    assert!(!has(&harness, "Which axis points up?"), "it was seen");
}

#[test]
fn a_voxel_model_is_shown_with_its_palette_and_turned() {
    let folder = tempfile::tempdir().unwrap();
    let path = model(folder.path(), "tower.vox");
    let mut harness = bench();
    drop_file(&mut harness, &path);
    for label in ["Import tower.vox", "Up", "Colours", "Palette: 2 colours"] {
        assert!(has(&harness, label), "{label}");
    }
    harness.get_by_label("8 × 16 × 8 voxels, 8.0 × 16.0 × 8.0 mm").rect();
    assert_eq!(dims(&harness), [64; 3], "nothing is opened yet");
    click(&mut harness, "Up");
    click(&mut harness, "−X up");
    harness.get_by_label("8 × 8 × 16 voxels, 8.0 × 8.0 × 16.0 mm").rect();
    click(&mut harness, "Colours");
    click(&mut harness, "8 bits");
    press(&mut harness, "Import");
    assert_eq!((is_open(&harness), dims(&harness)), (false, [8, 8, 16]));
    let depth = harness.state().session().document().material().depth();
    assert_eq!(depth.bits(), 8);
    assert!(!has(&harness, "Which axis points up?"));
    run(&mut harness, "undo");
    assert_eq!(dims(&harness), [64; 3]);
    // The next is asked about with the same.
    drop_file(&mut harness, &path);
    assert!(has(&harness, "8 × 8 × 16 voxels, 8.0 × 8.0 × 16.0 mm"));
    click(&mut harness, "Colours");
    click(&mut harness, "None");
    press(&mut harness, "Import");
    let depth = harness.state().session().document().material().depth();
    assert_eq!(depth.bits(), 0);
}

#[test]
fn a_file_opens_at_once_if_it_leaves_no_question_or_none_is_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own.pvm");
    let mut harness = bench();
    run(&mut harness, "new dims=16,16,16");
    run(&mut harness, &format!("save {own:?}"));
    run(&mut harness, "new dims=24,24,24");
    drop_file(&mut harness, &own);
    assert_eq!((is_open(&harness), dims(&harness)), (false, [16; 3]), "it says everything itself");

    let path = scan(folder.path(), "ball.nrrd");
    drop_file(&mut harness, &path);
    click(&mut harness, "Ask each time");
    click(&mut harness, "Cancel");
    drop_file(&mut harness, &path);
    assert_eq!((is_open(&harness), dims(&harness)), (false, [24, 12, 24]));
    // A raw file has to be described all the same.
    let raw = folder.path().join("cube.raw");
    std::fs::write(&raw, [[0u8; 32], [250; 32]].concat()).unwrap();
    harness.state_mut().ui.dialogs.import.ask = true;
    drop_file(&mut harness, &raw);
    click(&mut harness, "Read");
    assert!(has(&harness, "Layout"), "nothing was typed");
    harness.get_by_role_and_label(egui::accesskit::Role::TextInput, "Layout").focus();
    harness.run_steps(2);
    send(&mut harness, Event::Text("4x4x4:u8".to_string()));
    key(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    assert!(has(&harness, "Up") && has(&harness, "Axial"));
    press(&mut harness, "Import");
    assert_eq!((dims(&harness), voxels(&harness)), ([4; 3], 32));
}

#[test]
fn voxels_under_an_unknown_name_are_described_and_texts_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["scan.dat", "scan"] {
        let path = folder.path().join(name);
        std::fs::write(&path, [[0u8; 48], [250; 48]].concat()).unwrap();
        let mut harness = bench();
        drop_file(&mut harness, &path);
        harness.get_by_role_and_label(egui::accesskit::Role::TextInput, "Layout").focus();
        harness.run_steps(2);
        send(&mut harness, Event::Text("4x6x4:u8".to_string()));
        key(&mut harness, Modifiers::NONE, Key::Enter);
        settle(&mut harness);
        assert!(has(&harness, "Axial"), "{name}");
        press(&mut harness, "Import");
        assert_eq!(voxels(&harness), 48, "{name}");
    }
    let text = folder.path().join("notes.md");
    std::fs::write(&text, "no voxels\n").unwrap();
    let mut harness = bench();
    drop_file(&mut harness, &text);
    assert!(!is_open(&harness) && dims(&harness) == [64; 3]);
}

#[test]
fn a_file_that_cannot_be_read_is_said_in_the_dialog() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.nii");
    std::fs::write(&path, b"no scan").unwrap();
    let mut harness = bench();
    drop_file(&mut harness, &path);
    assert!(has(&harness, "Import broken.nii") && is_open(&harness));
    key(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    assert!(is_open(&harness), "it cannot be imported");
    click(&mut harness, "Cancel");
    assert!(!is_open(&harness) && dims(&harness) == [64; 3]);
}

#[test]
fn its_buttons_can_be_reached_in_small_windows() {
    let folder = tempfile::tempdir().unwrap();
    let scan = scan(folder.path(), "ball.nrrd");
    let mesh = mesh(folder.path(), "wedge.obj");
    let model = model(folder.path(), "tower.vox");
    for size in [vec2(640.0, 480.0), vec2(800.0, 600.0), vec2(1280.0, 800.0)] {
        let mut harness = bench_of(&config(16), size);
        for path in [&scan, &mesh, &model] {
            drop_file(&mut harness, path);
            for label in ["Import", "Cancel", "Ask each time"] {
                let button = harness.get_by_label(label).rect();
                let window = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
                assert!(window.contains_rect(button), "{size} {label}: {button:?}");
            }
            click(&mut harness, "Cancel");
        }
    }
}

#[test]
fn answers_are_found_again_at_the_next_start() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = bench();
    drop_file(&mut harness, &scan(folder.path(), "ball.nrrd"));
    click(&mut harness, "Fill holes");
    harness.get_by_label("Voxels").rect();
    press(&mut harness, "Import");
    let lines: Vec<String> = harness.state().ui.dialogs.import.remembered.lines().collect();
    assert_eq!(lines.len(), 1);
    assert!(lines[0].contains("holes=filled") && !lines[0].contains("ball"), "{lines:?}");
    assert_eq!(harness.state().ui.dialogs.import.options().cubic, Cubic::No);
}
