//! Blending with the surroundings. The runtime of the tests does not support it, so an API layer between it and the
//! program reports blend modes, and records the frames of the program.

use image::{Rgba, RgbaImage};

use super::program::Program;
use super::remote::Remote;
use super::runtime::{Runtime, alone_in_network};
use super::{DIMS, open_board, press_board};

/// Buttons of the board that hide or show the surroundings, in fractions of its size.
const HIDDEN: [f32; 2] = [1048.0 / 1250.0, 185.0 / 800.0];
const SEEN: [f32; 2] = [1122.0 / 1250.0, 185.0 / 800.0];
const CLEAR: Rgba<u8> = Rgba([0; 4]);

/// Waits for a frame with this blend mode and these layers.
fn wait_for_frame(program: &Program, runtime: &Runtime, what: &str) {
    let last = || runtime.last_frame().filter(|last| last == what);
    program.wait(&format!("a frame with {what:?}, not {:?},", runtime.last_frame()), last);
}

/// The upper corners, where nothing is drawn.
fn corners(picture: &RgbaImage) -> impl Iterator<Item = Rgba<u8>> {
    let right = picture.width() - 1;
    (0..8)
        .flat_map(move |y| (0..8).flat_map(move |x| [(x, y), (right - x, y)]))
        .map(|(x, y)| *picture.get_pixel(x, y))
}

#[test]
fn offered_modes_and_the_setting_decide_the_blend_mode() {
    if !alone_in_network() {
        return;
    }
    let mut runtime = Runtime::start();
    let mut remote = Remote::connect();
    remote.hands_away();
    for (offered, setting, frame) in [
        ("opaque,additive,alpha", "auto", "alpha projection+alpha"),
        ("opaque,additive", "auto", "additive projection"),
        ("alpha,opaque", "additive", "alpha projection+alpha"),
        ("alpha,additive,opaque", "opaque", "opaque projection"),
    ] {
        runtime.report_blend_modes(offered);
        let settings = format!("[headset]\nblend = \"{setting}\"\n");
        let program = Program::start(&runtime, DIMS, &settings);
        program.wait_for_log("FOCUSED", 1);
        wait_for_frame(&program, &runtime, frame);
        let screenshot = program.new_screenshot();
        for eye in &screenshot.eyes {
            let clear = eye.pixels().filter(|pixel| **pixel == CLEAR).count();
            let solid = eye.pixels().filter(|pixel| pixel.0[3] == 255).count();
            let all = (eye.width() * eye.height()) as usize;
            let counts = format!("{offered} {setting}: {clear} clear, {solid} solid of {all}");
            if frame.starts_with("opaque") {
                assert_eq!((clear, solid), (0, all), "{counts}");
                assert!(corners(eye).all(|pixel| pixel.0[..3] != [0; 3]), "{counts}");
                continue;
            }
            // Black adds no light, alpha 0 shows what is behind.
            assert!(corners(eye).all(|pixel| pixel == CLEAR), "{counts}");
            assert!(clear * 3 > all, "{counts}");
            assert!(solid > 1500, "the cube is there: {counts}");
            // Colours are premultiplied by alpha, as the layer flags declare.
            let exceeds = |pixel: &&Rgba<u8>| pixel.0[..3].iter().any(|c| *c > pixel.0[3]);
            assert_eq!(eye.pixels().find(exceeds), None, "{counts}");
        }
        program.stop();
    }
}

#[test]
fn the_surroundings_are_hidden_and_shown_while_the_program_runs() {
    if !alone_in_network() {
        return;
    }
    let mut runtime = Runtime::start();
    let mut remote = Remote::connect();
    remote.send();
    runtime.report_blend_modes("opaque,alpha");
    let program = Program::start(&runtime, DIMS, "");
    program.wait_for_log("FOCUSED", 1);
    wait_for_frame(&program, &runtime, "alpha projection+alpha");
    open_board(&mut remote, &program);
    wait_for_frame(&program, &runtime, "alpha projection+alpha quad+alpha");
    press_board(&mut remote, &program, HIDDEN);
    wait_for_frame(&program, &runtime, "opaque projection quad+alpha");
    let screenshot = program.new_screenshot();
    assert!(screenshot.eyes[0].pixels().all(|pixel| pixel.0[3] == 255));
    press_board(&mut remote, &program, SEEN);
    wait_for_frame(&program, &runtime, "alpha projection+alpha quad+alpha");
    let screenshot = program.new_screenshot();
    assert!(corners(&screenshot.eyes[0]).all(|pixel| pixel == CLEAR));
    program.stop();
}
