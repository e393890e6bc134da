//! The program in a headset: a real OpenXR runtime (Monado) with a scripted headset and controllers.
//! Needs the shared folder `openxr`; without it the tests are skipped, or fail with
//! VS_REQUIRE_SHARED.
//!
//! Each test runs itself again in a network namespace of its own, since the runtime listens on a
//! fixed port. The program writes what the eyes see as screenshots (`--headset-shots`) and the
//! commands as a journal (`--record`). The tests wait for conditions, never for a time.

mod blending;
mod failures;
mod keyboard;
mod main_loop;
mod program;
mod remote;
mod runtime;
mod screenshot;
mod tracker;

use std::time::Duration;

use glam::{Quat, Vec3};

use program::Program;
use remote::{Remote, Side};
use runtime::{Runtime, alone_in_network};
use screenshot::Predicted;

/// Edge of the cube in voxels; it is half a metre in the room.
pub const DIMS: u32 = 64;
const EDGE_M: f32 = 0.5;

/// The runtime with the head at rest, and the program in it.
pub fn begin() -> (Runtime, Remote, Program) {
    begin_with("")
}

/// The same with more settings.
pub fn begin_with(settings: &str) -> (Runtime, Remote, Program) {
    let runtime = Runtime::start();
    let mut remote = Remote::connect();
    remote.send();
    let program = Program::start(&runtime, DIMS, settings);
    program.wait_for_log("FOCUSED", 1);
    (runtime, remote, program)
}

/// The centre of the sculpture: before the head as it was at the start.
fn middle() -> Vec3 {
    remote::HEAD + Vec3::new(0.0, -0.3, -0.7)
}

/// Position of the hand with the board; it is upright.
const BOARD_HAND: Vec3 = Vec3::new(0.0, 1.2, -0.5);

/// Opens the board on the left hand; the right one is away.
pub fn open_board(remote: &mut Remote, program: &Program) {
    remote.place(Side::Left, BOARD_HAND, Quat::IDENTITY);
    remote.place(Side::Right, remote::AWAY, Quat::IDENTITY);
    program.frames(3);
    tap_menu_until(remote, program, "board open");
}

/// Taps the menu button until the log contains `what`. On a busy machine a tap may last too long, and is
/// then another gesture.
fn tap_menu_until(remote: &mut Remote, program: &Program, what: &str) {
    for _ in 0..20 {
        remote.menu(Side::Left, true);
        program.frames(2);
        remote.menu(Side::Left, false);
        program.frames(3);
        if program.log().contains(what) {
            return;
        }
    }
    panic!("never {what:?}: {}", program.log());
}

/// Points the right hand at a point of the board, in fractions from its upper left corner, and clicks.
pub fn press_board(remote: &mut Remote, program: &Program, share: [f32; 2]) {
    point_at_board(remote, program, share);
    pull(remote, program, |_| {});
}

/// Pulls the trigger over the board, calls `meanwhile`, and releases it. Each step waits only until
/// the program has handled the one before.
pub fn pull(remote: &mut Remote, program: &Program, meanwhile: impl FnOnce(&mut Remote)) {
    let count = |what: &str| program.log().matches(what).count() + 1;
    let (pressed, released) = (count("board pressed"), count("board released"));
    remote.trigger(Side::Right, true);
    program.wait_for_log("board pressed", pressed);
    meanwhile(remote);
    remote.trigger(Side::Right, false);
    program.wait_for_log("board released", released);
    program.frames(3);
}

/// Points the right hand at a point of the board, in fractions of its size.
pub fn point_at_board(remote: &mut Remote, program: &Program, share: [f32; 2]) {
    let from = Vec3::new(0.0, 1.4, 0.0);
    let at = program.board_point(share, BOARD_HAND);
    let aim = Quat::from_rotation_arc(Vec3::NEG_Z, (at - from).normalize());
    remote.place(Side::Right, from, aim);
    // However long the runtime takes to hand on where the hand is.
    let pointed_at = || -> Option<[f32; 2]> {
        let log = program.log();
        let (_, last) = log.rsplit_once("board pointed at ")?;
        let (x, y) = last.lines().next()?.split_once(',')?;
        Some([x.parse().ok()?, y.parse().ok()?])
    };
    let is_there = |at: [f32; 2]| at.iter().zip(share).all(|(at, share)| (at - share).abs() < 0.01);
    program.wait("the ray on the board", || pointed_at().filter(|at| is_there(*at)));
    program.frames(4);
}

#[test]
fn the_picture_moves_as_the_head_does() {
    if !alone_in_network() {
        return;
    }
    let (_runtime, mut remote, program) = begin();
    // Out of the picture.
    remote.hands_away();
    let cube = Predicted { centre: middle(), edge: EDGE_M, rotation: Quat::IDENTITY };
    for (position, rotation) in [
        (remote::HEAD, Quat::IDENTITY),
        (remote::HEAD + Vec3::new(0.3, 0.1, -0.1), Quat::from_rotation_y(0.35)),
        (remote::HEAD + Vec3::new(-0.25, -0.2, 0.2), Quat::from_rotation_x(-0.3)),
        (remote::HEAD + Vec3::new(0.0, 0.1, 0.3), Quat::from_rotation_z(0.4)),
    ] {
        remote.head = (position, rotation);
        remote.send();
        let screenshot = program.screenshot_of_head(position, rotation);
        for eye in 0..2 {
            screenshot.assert_shows(&cube, eye);
        }
    }
    program.stop();
}

/// Everything slow was done on the thread that connects, so that no window waits for it.
#[test]
fn the_first_pictures_in_a_headset_create_no_pipelines() {
    if !alone_in_network() {
        return;
    }
    let (_runtime, _remote, program) = begin_with("[render]\nmode = \"march-gpu\"\n");
    program.frames(3);
    let log = program.log();
    program.stop();
    let (connecting, connected) = log.split_once("Headset connected").unwrap();
    let created = |log: &str| log.matches("created pipeline").count();
    assert!(created(connecting) > 0, "{connecting}");
    assert_eq!(created(connected), 0, "{connected}");
}

#[test]
fn the_trigger_removes_voxels_and_the_controller_vibrates() {
    if !alone_in_network() {
        return;
    }
    let (_runtime, mut remote, program) = begin();
    // The tool is 0.08 m before the hand: at the centre of the front face.
    let front = middle() + Vec3::Z * (0.5 * EDGE_M);
    remote.place(Side::Right, front + Vec3::Z * 0.08, Quat::IDENTITY);
    remote.trigger(Side::Right, true);
    program.wait_for_command("subtract ellipsoid", 1);
    for i in 1..=10 {
        remote.place(Side::Right, front + Vec3::new(0.01 * i as f32, 0.0, 0.08), Quat::IDENTITY);
        program.frames(2);
    }
    remote.trigger(Side::Right, false);
    program.wait_for_command("end", 1);
    let journal = program.journal();
    let uses: Vec<Vec3> = program.places_of("subtract ellipsoid");
    assert!(uses.len() > 3, "{journal}");
    let dims = Vec3::splat(DIMS as f32);
    let voxel = |room: Vec3| (room - middle()) / (EDGE_M / DIMS as f32) + dims * 0.5;
    let (first, last) = (uses[0], uses[uses.len() - 1]);
    assert!(first.abs_diff_eq(voxel(front), 0.1), "{first} {journal}");
    let end = voxel(front + Vec3::X * 0.1);
    assert!(last.distance(end) < 2.0 && last.x <= end.x + 0.1, "{last} {end}");
    assert!(
        program.log().contains("Right hand vibrates"),
        "the runtime was asked to vibrate the controller"
    );

    // The same commands without a headset: half a ball of radius 3.84 vx and half a rod of 12.8 vx.
    let removed = program.removed_voxels();
    assert!((380..450).contains(&removed), "{removed} voxels are removed, about 415 expected");

    // The stick of the other hand undoes it.
    remote.stick(Side::Left, [-1.0, 0.0]);
    program.wait_for_command("undo", 1);
    remote.stick(Side::Left, [0.0, 0.0]);
    program.stop();
}

#[test]
fn grips_carry_turn_and_scale() {
    if !alone_in_network() {
        return;
    }
    let (_runtime, mut remote, program) = begin();
    remote.hands_away();
    let left = Vec3::new(-0.2, 1.2, -0.2);
    remote.place(Side::Left, left, Quat::IDENTITY);
    program.frames(3);
    remote.squeeze(Side::Left, true);
    program.frames(3);
    // The hand rotates and moves right and forward, and the sculpture with it.
    let (to, turn) = (left + Vec3::new(0.1, 0.05, -0.1), Quat::from_rotation_y(0.4));
    for i in 1..=10 {
        let share = i as f32 / 10.0;
        remote.place(Side::Left, left.lerp(to, share), Quat::IDENTITY.slerp(turn, share));
        program.frames(2);
    }
    program.frames(3);
    remote.squeeze(Side::Left, false);
    program.frames(3);
    let carried = Predicted { centre: to + turn * (middle() - left), edge: EDGE_M, rotation: turn };
    remote.place(Side::Left, remote::AWAY, Quat::IDENTITY);
    let screenshot = program.new_screenshot();
    (0..2).for_each(|eye| screenshot.assert_shows(&carried, eye));

    // Two hands move from 0.4 m to 0.2 m apart: half the size about the point between them.
    let between = Vec3::new(0.0, 1.2, -0.5);
    let apart = |half: f32| [between - Vec3::X * half, between + Vec3::X * half];
    let hands = |remote: &mut Remote, at: [Vec3; 2]| {
        remote.place(Side::Left, at[0], Quat::IDENTITY);
        remote.place(Side::Right, at[1], Quat::IDENTITY);
    };
    hands(&mut remote, apart(0.2));
    program.frames(3);
    remote.squeeze(Side::Left, true);
    remote.squeeze(Side::Right, true);
    program.frames(3);
    for i in 1..=10 {
        hands(&mut remote, apart(0.2 - 0.01 * i as f32));
        program.frames(2);
    }
    program.frames(3);
    remote.squeeze(Side::Left, false);
    remote.squeeze(Side::Right, false);
    program.frames(3);
    remote.hands_away();
    let small = Predicted {
        centre: between + (carried.centre - between) * 0.5,
        edge: EDGE_M * 0.5,
        rotation: turn,
    };
    let screenshot = program.new_screenshot();
    (0..2).for_each(|eye| screenshot.assert_shows(&small, eye));
    program.stop();
}

#[test]
fn the_board_opens_on_the_off_hand_and_is_pressed_by_a_ray() {
    if !alone_in_network() {
        return;
    }
    let (_runtime, mut remote, program) = begin();
    open_board(&mut remote, &program);
    let board = program.board();
    assert!(board.pixels().filter(|p| p.0[3] == 255).count() > 500_000, "it is drawn");

    // A click on the tool "Cuboid", the second of the first row, selects it and cuts nothing.
    press_board(&mut remote, &program, [118.0 / 1250.0, 105.0 / 800.0]);
    assert!(program.places_of("subtract").is_empty(), "{}", program.journal());
    tap_menu_until(&mut remote, &program, "board closed");
    // With the board closed the trigger cuts, with the selected tool.
    remote.place(Side::Right, middle() + Vec3::Z * (0.5 * EDGE_M + 0.08), Quat::IDENTITY);
    program.frames(3);
    remote.trigger(Side::Right, true);
    program.wait_for_command("subtract cuboid", 1);
    remote.trigger(Side::Right, false);
    program.wait_for_command("end", 1);
    program.stop();
}

#[test]
fn a_pull_that_lasts_a_second_and_turns_the_hand_is_a_click() {
    if !alone_in_network() {
        return;
    }
    let (_runtime, mut remote, program) = begin();
    open_board(&mut remote, &program);
    // The tool "Cuboid".
    let share = [118.0 / 1250.0, 105.0 / 800.0];
    point_at_board(&mut remote, &program, share);
    pull(&mut remote, &program, |remote| {
        let from = Vec3::new(0.0, 1.4, 0.0);
        let at = program.board_point(share, BOARD_HAND);
        let aim = Quat::from_rotation_arc(Vec3::NEG_Z, (at - from).normalize());
        for i in 1..=10 {
            let drift = Quat::from_rotation_y((0.05 * i as f32).to_radians());
            remote.place(Side::Right, from, drift * aim);
            std::thread::sleep(Duration::from_millis(100));
        }
    });
    remote.place(Side::Left, remote::AWAY, Quat::IDENTITY);
    remote.place(Side::Right, middle() + Vec3::Z * (0.5 * EDGE_M + 0.08), Quat::IDENTITY);
    program.frames(3);
    remote.trigger(Side::Right, true);
    program.wait_for_command("subtract cuboid", 1);
    program.stop();
}

#[test]
fn a_button_picks_the_colour_that_the_tool_touches() {
    if !alone_in_network() {
        return;
    }
    let (_runtime, mut remote, program) = begin();
    remote.place(Side::Right, middle() + Vec3::Z * (0.5 * EDGE_M + 0.08), Quat::IDENTITY);
    program.frames(3);
    remote.pick(Side::Right, true);
    program.wait_for_log("taken", 1);
    remote.pick(Side::Right, false);
    program.stop();
}

#[test]
fn a_runtime_that_ends_and_restarts_loses_no_work() {
    if !alone_in_network() {
        return;
    }
    let (mut runtime, mut remote, program) = begin();
    remote.place(Side::Right, middle() + Vec3::Z * (0.5 * EDGE_M + 0.08), Quat::IDENTITY);
    program.frames(3);
    remote.trigger(Side::Right, true);
    program.wait_for_command("subtract", 1);
    // In the middle of a stroke.
    runtime.kill();
    program.wait_for_log("no headset: ", 1);
    program.wait_for_command("end", 1);
    program.wait_for_log("trying again every", 1);
    runtime.restart();
    let mut remote = Remote::connect();
    remote.send();
    program.wait_for_log("Headset connected", 2);
    program.wait_for_log("FOCUSED", 2);
    // The cut is still there, and can be undone.
    remote.stick(Side::Left, [-1.0, 0.0]);
    program.wait_for_command("undo", 1);
    program.stop();
}

#[test]
fn a_runtime_that_hangs_and_continues_ends_only_the_stroke() {
    if !alone_in_network() {
        return;
    }
    let (runtime, mut remote, program) = begin();
    remote.place(Side::Right, middle() + Vec3::Z * (0.5 * EDGE_M + 0.08), Quat::IDENTITY);
    program.frames(3);
    for round in 1..=3 {
        remote.trigger(Side::Right, true);
        program.wait_for_command("subtract", round);
        runtime.set_stopped(true);
        // The main loop goes on, and ends the stroke.
        program.wait_for_log("does not respond", round);
        program.wait_for_command("end", round);
        remote.trigger(Side::Right, false);
        runtime.set_stopped(false);
        program.wait_for_log("answers again", round);
        program.frames(5);
    }
    assert!(!program.log().contains("no headset"), "{}", program.log());
    program.stop();
}

#[test]
fn taking_the_headset_off_and_on_keeps_the_connection() {
    if !alone_in_network() {
        return;
    }
    let mut runtime = Runtime::start();
    runtime.report_blend_modes("opaque");
    let mut remote = Remote::connect();
    remote.send();
    let program = Program::start(&runtime, DIMS, "");
    program.wait_for_log("FOCUSED", 1);
    for round in 1..=12 {
        program.frames(1 + round % 3);
        runtime.take_off(true);
        program.wait_for_log("headset session: STOPPING", round);
        runtime.take_off(false);
        program.wait_for_log("headset session: READY", round + 1);
    }
    program.frames(3);
    assert!(!program.log().contains("no headset"), "{}", program.log());
    program.stop();
}

#[test]
fn without_a_runtime_the_program_says_what_to_do() {
    if !alone_in_network() {
        return;
    }
    let mut runtime = Runtime::not_started();
    let program = Program::start(&runtime, DIMS, "");
    program.wait_for_log("no headset: ", 1);
    assert!(program.log().contains("start SteamVR, Monado"), "{}", program.log());
    // The runtime is started later.
    runtime.restart();
    program.wait_for_log("Headset connected", 1);
    program.stop();
}

/// Duration of the soak test in seconds, unless VS_HEADSET_SOAK_S is set.
const SOAK_S: u64 = 15;

/// Prints what it has measured with `--nocapture`.
#[test]
fn a_soak_test_leaks_no_memory_and_no_descriptors() {
    if !alone_in_network() {
        return;
    }
    let length_s = std::env::var("VS_HEADSET_SOAK_S");
    let length_s = length_s.map_or(SOAK_S, |text| text.parse().expect("whole seconds"));
    let (_runtime, mut remote, program) = begin_with("[memory]\nhistory_mib = 1\n");
    let mut work = |seconds: u64| {
        let start = std::time::Instant::now();
        let mut round = 0;
        // At least as much work on a slow machine.
        while start.elapsed() < Duration::from_secs(seconds) || round < 10 * seconds {
            let angle = round as f32 * 0.1;
            let sway = Vec3::new(0.2 * angle.sin(), 0.0, 0.1 * angle.cos());
            remote.head = (remote::HEAD + sway, Quat::from_rotation_y(0.3 * angle.sin()));
            let hand = middle() + Vec3::new(0.2 * (1.7 * angle).sin(), 0.0, 0.33);
            remote.place(Side::Right, hand, Quat::IDENTITY);
            remote.trigger(Side::Right, round / 10 % 2 == 1);
            round += 1;
            program.frames(2);
        }
    };
    // Until everything that is created once exists.
    work(8);
    let before = (program.memory_kib(), program.descriptors());
    work(length_s);
    let after = (program.memory_kib(), program.descriptors());
    trials::note!("{length_s} s: {before:?} KiB and descriptors before, {after:?} after");
    // The history may hold a stroke or two more.
    assert!(after.0 < before.0 + 4096, "{before:?} KiB before, {after:?} KiB after");
    // A screenshot may be being written.
    assert!(after.1 <= before.1 + 2, "{before:?} descriptors before, {after:?} after");
    program.stop();
}
