//! Reference pictures by their window, and brushes in an orthographic view.

use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use virtual_sculpture::input::Side;

use super::bench::{Bench, bench, click, drag, has, key, middle, rest, undo_count, voxels};

/// Clicks on the last of what has a label with this text, beside icons: that lies uppermost.
fn click_last(harness: &mut Bench, text: &str) {
    harness.get_all_by_label_contains(text).last().unwrap().click();
    harness.run_steps(6);
    rest(harness);
}

#[test]
fn a_reference_picture_is_added_from_a_file_changed_and_removed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.png");
    image::RgbImage::from_pixel(60, 40, image::Rgb([9, 8, 7])).save(&path).unwrap();
    let mut harness = bench();
    harness.state_mut().ui.dialogs.files.set_folder(folder.path().to_path_buf());
    key(&mut harness, Modifiers::COMMAND | Modifiers::ALT, Key::R);
    rest(&mut harness);
    click(&mut harness, "Add …");
    assert!(harness.state().ui.dialogs.files.is_open());
    // The folder is read on a thread of the dialog.
    for _ in 0..200 {
        if harness.query_all_by_label_contains("plan.png").next().is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
        harness.step();
    }
    click_last(&mut harness, "plan.png");
    click_last(&mut harness, "Open");
    assert!(!harness.state().ui.dialogs.files.is_open());
    let only = |harness: &Bench| {
        let [reference] = &harness.state().ui.references[..] else { panic!("one picture") };
        reference.clone()
    };
    let added = only(&harness);
    let pixels = added.pixels.as_ref().unwrap();
    assert_eq!((added.side, pixels.size.to_array(), added.locked), (Side::Front, [60, 40], false));

    click(&mut harness, "Lock to view");
    assert!(only(&harness).locked);
    click(&mut harness, "plan.png");
    assert!(!only(&harness).shown);
    click(&mut harness, "Remove");
    assert!(harness.state().ui.references.is_empty());
    key(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert!(!has(&harness, "Add …"));
    assert_eq!(undo_count(&harness), 0, "none of it belongs to the sculpture");
}

#[test]
fn brushes_do_in_an_orthographic_view_what_they_do_in_perspective() {
    let cut = |orthographic: bool| {
        let mut harness = bench();
        key(&mut harness, Modifiers::NONE, Key::Num7);
        if orthographic {
            key(&mut harness, Modifiers::NONE, Key::O);
        }
        let before = voxels(&harness);
        key(&mut harness, Modifiers::NONE, Key::D);
        let at = middle(&harness);
        let way = [at - vec2(60.0, 0.0), at, at + vec2(60.0, 30.0)];
        drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &way);
        assert_eq!(undo_count(&harness), 1);
        (before - voxels(&harness)) as f32
    };
    let (perspective, orthographic) = (cut(false), cut(true));
    // The front is nearer than the middle of the grid, so that in perspective a pixel there is smaller.
    let ratio = orthographic / perspective;
    assert!(perspective > 200.0 && (1.0..1.8).contains(&ratio), "{perspective} {orthographic}");
}
