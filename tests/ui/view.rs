//! Reference pictures by their window, and brushes in an orthographic view.

use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use virtual_sculpture::input::Side;

use super::bench::{
    Bench, bench, click, drag, has, key, middle, rest, run, screen, undo_count, voxels, wheel,
};

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
        let drawn = [at - vec2(60.0, 0.0), at, at + vec2(60.0, 30.0)];
        drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &drawn);
        assert_eq!(undo_count(&harness), 1);
        (before - voxels(&harness)) as f32
    };
    let (perspective, orthographic) = (cut(false), cut(true));
    // The front is nearer than the middle of the grid, so that in perspective a pixel there is smaller.
    let ratio = orthographic / perspective;
    assert!(perspective > 200.0 && (1.0..1.8).contains(&ratio), "{perspective} {orthographic}");
}

/// However far the wheel is turned, the camera stays before the surface under the pointer, and comes as near as it is.
#[test]
fn the_wheel_stops_before_the_surface() {
    for at in [Vec3::new(32.0, 32.0, 64.0), Vec3::new(50.0, 12.0, 40.0)] {
        let mut harness = bench();
        rest(&mut harness);
        run(&mut harness, "place turn=10,20,0");
        run(&mut harness, "subtract cuboid at=50,12,52 half=14,12,12");
        let pointer = screen(&harness, at);
        let mut nearest = f32::INFINITY;
        for _ in 0..40 {
            wheel(&mut harness, Modifiers::NONE, pointer, 3.0);
            let eye = eye_in_grid(&harness);
            let grid = harness.state().session().document().grid();
            assert!(!grid.get(eye.floor().as_ivec3()), "the camera is in the stone at {eye}");
            assert!(screen(&harness, at).distance(pointer) < 3.0, "it stays under the pointer");
            nearest = nearest.min(eye.distance(at));
        }
        assert!((0.5..4.0).contains(&nearest), "{nearest} voxels before the surface");
        // As many notches out lead back.
        for _ in 0..40 {
            wheel(&mut harness, Modifiers::NONE, pointer, -3.0);
        }
        assert!(eye_in_grid(&harness).distance(at) > 100.0);
    }
}

/// A camera that the sculpture has been turned or grown around comes out with the next notch.
#[test]
fn the_wheel_leads_out_of_the_stone() {
    for notches in [1.0, -1.0] {
        let mut harness = bench();
        rest(&mut harness);
        run(&mut harness, "clear grid");
        run(&mut harness, "add cuboid at=32,32,4 half=4");
        run(&mut harness, "place");
        let centre = middle(&harness);
        for _ in 0..12 {
            wheel(&mut harness, Modifiers::NONE, centre, 2.0);
        }
        run(&mut harness, "fill grid");
        let is_inside = |harness: &Bench| {
            let grid = harness.state().session().document().grid();
            grid.get(eye_in_grid(harness).floor().as_ivec3())
        };
        assert!(is_inside(&harness));
        drag(
            &mut harness,
            PointerButton::Secondary,
            Modifiers::NONE,
            &[centre, centre + vec2(3.0, 0.0)],
        );
        let texts: Vec<_> = harness.state().ui.toasts.texts().map(|(_, text)| text).collect();
        assert!(texts.iter().any(|text| text.contains("inside the sculpture")), "{texts:?}");
        wheel(&mut harness, Modifiers::NONE, centre, notches);
        assert!(!is_inside(&harness));
        let eye = eye_in_grid(&harness);
        assert!(eye.z > 64.0 && eye.z < 72.0, "just outside, not far away: {eye}");
    }
}

fn eye_in_grid(harness: &Bench) -> Vec3 {
    let bench = harness.state();
    bench.eye().pixel_rays(&bench.world_from_grid()).origin
}
