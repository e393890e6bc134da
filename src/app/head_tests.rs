//! Tests head tracking on the workspace, with a scripted tracker and simulated time.

use std::path::Path;

use std::time::Duration;

use egui::{Context, Pos2, RawInput, Rect};
use glam::{DQuat, DVec3, IVec2, UVec2, Vec2, Vec3};
use tracking::calibration::Calibration;
use tracking::calibration::screen_corners_m;

use super::Workspace;
use crate::config::Config;
use crate::input::Action;
use crate::input::Bindings;
use crate::session::Session;
use crate::ui::UiRequest;
use crate::viewpoint::head::{CalibrationStep, Monitor};

/// A workspace whose head is played from a script, drawn at a rate, without a screen.
struct Desk {
    workspace: Workspace,
    ctx: Context,
    /// Holds the script and the files of the workspace.
    folder: tempfile::TempDir,
}

impl Desk {
    fn new(script: &str, settings: &str) -> Desk {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("head.txt");
        std::fs::write(&path, script).unwrap();
        let toml = format!(
            "[new]\ndims = [32, 32, 32]\n[screen]\nsize_m = [0.5, 0.3]\n\
             [tracking]\non = true\nsource = \"script:{}\"\n{settings}",
            path.display()
        );
        let config = Config::parse(&toml, Path::new("test.toml")).unwrap();
        let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        let workspace = Workspace::new(session, &config, Bindings::presets().unwrap());
        let mut desk = Desk { workspace, ctx: Context::default(), folder };
        desk.workspace.on_screen(Some(Monitor {
            size_px: UVec2::new(2000, 1200),
            window_px: Some(IVec2::new(300, 100)),
            window_size_px: UVec2::new(1000, 700),
        }));
        desk.picture(0.0);
        desk
    }

    /// Draws a picture at `now_s`. Returns when the next one is wanted.
    fn picture(&mut self, now_s: f64) -> Duration {
        self.workspace.track_at(now_s);
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(1000.0, 700.0)));
        let input = RawInput { screen_rect, time: Some(now_s), ..RawInput::default() };
        let mut output = self.ctx.run_ui(input, |root| self.workspace.show(root));
        output.textures_delta.clear();
        output.viewport_output[&egui::ViewportId::ROOT].repaint_delay
    }

    fn play(&mut self, from_s: f64, to_s: f64) {
        let pictures = ((to_s - from_s) * 60.0).round() as i32;
        for i in 1..=pictures {
            self.picture(from_s + f64::from(i) / 60.0);
        }
    }

    /// Returns where on the screen a point of the world is seen, in metres from the centre.
    fn seen_m(&self, world: Vec3) -> Vec2 {
        let eye = self.workspace.eye();
        let clip = eye.projection * eye.eye_from_world.transform_point3(world).extend(1.0);
        let share = Vec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5;
        let picture = self.workspace.picture();
        let px = Vec2::new(picture.min.x, picture.min.y)
            + share * Vec2::new(picture.width(), picture.height())
            + Vec2::new(300.0, 100.0);
        (px / Vec2::new(2000.0, 1200.0) - 0.5) * Vec2::new(0.5, -0.3)
    }

    fn head_m(&self) -> Vec3 {
        self.workspace.viewpoint.head.placement().position_m.as_vec3()
    }
}

#[test]
fn a_moving_head_sees_through_the_screen_as_through_a_window() {
    let script = "rate 60\n0 0 0 0.6 0 0 0 1\n1 0.2 0.1 0.5 0 0 0 1\n4 0.2 0.1 0.5 0 0 0 1";
    let mut desk = Desk::new(script, "");
    desk.play(0.0, 0.05);
    let plane = desk.workspace.viewpoint.head.plane(desk.workspace.viewpoint.viewport());
    let units_per_m = desk.workspace.viewpoint.turntable.window_height() / plane.height_m;
    let middle = plane.centre_m;
    let radius = 0.3 * plane.height_m;
    let mut places = Vec::new();
    for second in 0..4 {
        let from_s = f64::from(second) + 0.05;
        desk.play(from_s, from_s + 1.0);
        let head = desk.head_m();
        places.push(head);
        // Points in the plane of the screen do not move. Points behind it appear where the line to the eye crosses the
        // screen.
        for (x, y, z) in [(0.0, 0.0, 0.0), (1.0, -0.5, 0.0), (0.5, 0.5, -1.0), (0.0, 0.0, 0.5)] {
            let point_m = Vec3::new(x, y, z) * radius;
            let seen = desk.seen_m(point_m * units_per_m);
            let point_m = point_m + middle.extend(0.0);
            let crossing = head + (point_m - head) * (head.z / (head.z - point_m.z));
            assert!(seen.distance(crossing.truncate()) < 2e-4, "{seen} {crossing}");
        }
    }
    assert!(places[0].distance(Vec3::new(0.2, 0.1, 0.5)) < 0.02, "{places:?}");
    assert!(places[2].distance(Vec3::new(0.2, 0.1, 0.5)) < 2e-3, "{places:?}");
}

#[test]
fn pictures_are_wanted_while_the_head_is_tracked_and_no_longer() {
    let mut desk = Desk::new("rate 60\nloop\n0 0 0 0.6 0 0 0 1\n2 0.1 0 0.6 0 0 0 1", "");
    desk.play(0.0, 1.0);
    assert_eq!(desk.picture(1.01), Duration::ZERO);
    desk.workspace.act(Action::ToggleHead);
    desk.play(1.02, 2.0);
    assert!(desk.picture(2.01) > Duration::from_millis(500));
    assert_eq!(desk.workspace.eye(), desk.workspace.viewpoint.turntable.eye());
    assert!(desk.workspace.viewpoint.tracked_eyes(0.06).is_none());
}

#[test]
fn a_lost_head_fades_to_its_place_of_rest_and_back() {
    let script = "rate 60\n0 0.2 0 0.5 0 0 0 1\n1 0.2 0 0.5 0 0 0 1\n1.01 lost\n\
                  5 -0.2 0 0.7 0 0 0 1\n9 -0.2 0 0.7 0 0 0 1";
    let mut desk = Desk::new(script, "");
    let mut last = None;
    let mut states = Vec::new();
    for i in 1..500 {
        let now_s = f64::from(i) / 60.0;
        desk.picture(now_s);
        let head = desk.head_m();
        if let Some(last) = last {
            let step_m = head.distance(last);
            assert!(step_m < 0.03, "{step_m} m in a picture at {now_s} s");
        }
        last = Some(head);
        let context = desk.workspace.viewpoint.head.status();
        if states.last() != Some(&context.label()) {
            states.push(context.label());
        }
        if i == 285 {
            assert!(head.distance(Vec3::new(0.0, 0.0, 0.6)) < 1e-3, "at rest: {head}");
        }
    }
    assert_eq!(
        states,
        ["Head found", "Head tracked", "Head lost", "No head", "Head found", "Head tracked"]
    );
    assert!(last.unwrap().distance(Vec3::new(-0.2, 0.0, 0.7)) < 1e-3);
    assert_eq!(desk.workspace.viewpoint.head.status().losses, 1);
}

#[test]
fn buttons_of_the_tracker_are_actions() {
    let script = "0 0 0 0.6 0 0 0 1\n0.5 button 2 down\n0.6 button 2 up\n1.5 button 0 down\n\
                  1.8 button 0 up\n2.5 button 1 down";
    let bound = "buttons = { 0 = \"apply\", 1 = \"undo\", 2 = \"clear\" }";
    let mut desk = Desk::new(script, bound);
    let voxels = |desk: &Desk| desk.workspace.session().document().grid().opaque_count();
    let full = voxels(&desk);
    desk.play(0.0, 1.0);
    assert_eq!(voxels(&desk), 0, "cleared");
    desk.workspace.editor.tool.mode = crate::input::ToolMode::Add;
    desk.play(1.0, 1.6);
    assert!(desk.workspace.editor.is_stroking(), "held");
    desk.play(1.6, 2.0);
    assert!(!desk.workspace.editor.is_stroking());
    assert!(voxels(&desk) > 0 && voxels(&desk) < full);
    desk.play(2.0, 3.0);
    assert_eq!(voxels(&desk), 0, "undone");
}

#[test]
fn both_eyes_lie_along_the_head() {
    // A head that lies on its side.
    let (s, c) = std::f64::consts::FRAC_PI_4.sin_cos();
    let script = format!("rate 60\n0 0 0 0.6 0 0 {s} {c}\n3 0 0 0.6 0 0 {s} {c}");
    let mut desk = Desk::new(&script, "");
    desk.play(0.0, 2.0);
    let [left, right] = desk.workspace.viewpoint.tracked_eyes(0.06).unwrap();
    let apart = right.position() - left.position();
    let plane = desk.workspace.viewpoint.head.plane(desk.workspace.viewpoint.viewport());
    let units_per_m = desk.workspace.viewpoint.turntable.window_height() / plane.height_m;
    assert!((apart / units_per_m).abs_diff_eq(Vec3::new(0.0, 0.06, 0.0), 1e-4), "{apart}");
    assert!(desk.workspace.eye().position().abs_diff_eq(left.position() + apart * 0.5, 1e-3));
}

#[test]
fn four_touches_calibrate_the_tracker_and_are_kept() {
    // The tracker is rotated and displaced: these are the corners in its space.
    let truth = Calibration {
        rotation: DQuat::from_rotation_y(0.4) * DQuat::from_rotation_x(-0.2),
        translation_m: DVec3::new(0.3, -0.4, 1.0),
        ..Calibration::default()
    };
    let tracker = |screen_m: DVec3| truth.rotation.inverse() * (screen_m - truth.translation_m);
    let mut script = "rate 60\n".to_owned();
    let head_m = DVec3::new(0.1, 0.05, 0.55);
    let places = screen_corners_m(0.5, 0.3).into_iter().chain([head_m]);
    for (second, screen_m) in places.enumerate() {
        let at = tracker(screen_m);
        let line = |time_s: f64| format!("{time_s} {} {} {} 0 0 0 1\n", at.x, at.y, at.z);
        script += &(line(second as f64) + &line(second as f64 + 0.9));
    }
    script += &format!(
        "9 {0} {1} {2} 0 0 0 1\n",
        tracker(head_m).x,
        tracker(head_m).y,
        tracker(head_m).z
    );
    let mut desk = Desk::new(&script, "");
    let file = desk.folder.path().join("calibration.toml");
    desk.workspace.keep_calibration_in(file.clone());
    desk.workspace.act(Action::CalibrateHead);
    assert!(desk.workspace.ui.dialogs.is_modal());
    // Between two corners, nothing is recorded.
    desk.play(0.0, 0.98);
    desk.workspace.answer_requests(vec![UiRequest::Calibrate(CalibrationStep::Take)]);
    assert_eq!(desk.workspace.viewpoint.head.status().calibration.unwrap().taken, 0);
    assert!(desk.workspace.viewpoint.head.status().calibration.unwrap().problem.is_some());
    desk.workspace.act(Action::ToggleHead);
    desk.workspace.act(Action::CalibrateHead);
    // The script begins again with a new source.
    let zero_s = 1.0;
    for corner in 0..4 {
        let from_s = zero_s + f64::from(corner);
        desk.play(from_s, from_s + 0.8);
        desk.workspace.answer_requests(vec![UiRequest::Calibrate(CalibrationStep::Take)]);
        desk.play(from_s + 0.8, from_s + 1.0);
    }
    let context = desk.workspace.viewpoint.head.status().calibration.unwrap();
    assert_eq!(context.taken, 4);
    assert!(context.rms_mm.unwrap() < 0.5, "{context:?}");
    desk.workspace.answer_requests(vec![UiRequest::Calibrate(CalibrationStep::Keep)]);
    assert!(!desk.workspace.ui.dialogs.is_modal());
    desk.play(zero_s + 4.0, zero_s + 6.0);
    assert!(desk.head_m().distance(head_m.as_vec3()) < 2e-3, "{}", desk.head_m());
    // The next start takes it from the file.
    let mut next = Desk::new(&script, "");
    next.workspace.keep_calibration_in(file);
    next.play(0.0, 8.0);
    assert!(next.head_m().distance(head_m.as_vec3()) < 2e-3, "{}", next.head_m());
}

#[test]
fn a_tracker_that_cannot_be_opened_is_reported_and_the_work_goes_on() {
    let mut desk = Desk::new("nonsense", "");
    assert!(!desk.workspace.viewpoint.head.is_on());
    let texts: Vec<String> = desk.workspace.ui.toasts.texts().map(|(_, t)| t.to_owned()).collect();
    assert!(texts.iter().any(|text| text.contains("line 1")), "{texts:?}");
    desk.picture(1.0);
    assert_eq!(desk.workspace.eye(), desk.workspace.viewpoint.turntable.eye());
}
