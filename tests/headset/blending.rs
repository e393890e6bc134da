//! Blending with the surroundings. The runtime of the tests cannot do that, so an API layer between it and the program
//! claims that it can, and records what the program does.

use image::{Rgba, RgbaImage};

use super::program::Program;
use super::remote::Remote;
use super::runtime::{Runtime, alone_in_network};
use super::{DIMS, open_board, press_board};

/// What becomes of the surroundings: buttons on the board, as shares of it.
const HIDDEN: [f32; 2] = [1048.0 / 1250.0, 185.0 / 800.0];
const SEEN: [f32; 2] = [1122.0 / 1250.0, 185.0 / 800.0];
const CLEAR: Rgba<u8> = Rgba([0; 4]);

/// Waits for a frame that was ended with this.
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
fn what_the_headset_offers_and_the_person_wishes_decides_how_pictures_blend() {
    if !alone_in_network() {
        return;
    }
    let mut runtime = Runtime::start();
    let mut remote = Remote::connect();
    remote.hands_away();
    for (offered, wish, frame) in [
        ("opaque,additive,alpha", "auto", "alpha projection+alpha"),
        ("opaque,additive", "auto", "additive projection"),
        ("alpha,opaque", "additive", "alpha projection+alpha"),
        ("alpha,additive,opaque", "opaque", "opaque projection"),
    ] {
        runtime.pretend(offered);
        let settings = format!("[headset]\nblend = \"{wish}\"\n");
        let program = Program::start(&runtime, DIMS, &settings);
        program.wait_for_log("FOCUSED", 1);
        wait_for_frame(&program, &runtime, frame);
        let shot = program.fresh_shot();
        for eye in &shot.eyes {
            let clear = eye.pixels().filter(|pixel| **pixel == CLEAR).count();
            let solid = eye.pixels().filter(|pixel| pixel.0[3] == 255).count();
            let all = (eye.width() * eye.height()) as usize;
            let said = format!("{offered} {wish}: {clear} clear, {solid} solid of {all}");
            if frame.starts_with("opaque") {
                assert_eq!((clear, solid), (0, all), "{said}");
                assert!(corners(eye).all(|pixel| pixel.0[..3] != [0; 3]), "{said}");
                continue;
            }
            // Black adds no light, alpha 0 shows what is behind.
            assert!(corners(eye).all(|pixel| pixel == CLEAR), "{said}");
            assert!(clear * 3 > all, "{said}");
            assert!(solid > 1500, "the cube is there: {said}");
            // Colours come multiplied by alpha, as the frame says.
            let loud = |pixel: &&Rgba<u8>| pixel.0[..3].iter().any(|c| *c > pixel.0[3]);
            assert_eq!(eye.pixels().find(loud), None, "{said}");
        }
        program.stop();
    }
}

#[test]
fn the_surroundings_are_hidden_and_seen_again_while_the_program_runs() {
    if !alone_in_network() {
        return;
    }
    let mut runtime = Runtime::start();
    let mut remote = Remote::connect();
    remote.send();
    runtime.pretend("opaque,alpha");
    let program = Program::start(&runtime, DIMS, "");
    program.wait_for_log("FOCUSED", 1);
    wait_for_frame(&program, &runtime, "alpha projection+alpha");
    open_board(&mut remote, &program);
    wait_for_frame(&program, &runtime, "alpha projection+alpha quad+alpha");
    press_board(&mut remote, &program, HIDDEN);
    wait_for_frame(&program, &runtime, "opaque projection quad+alpha");
    let shot = program.fresh_shot();
    assert!(shot.eyes[0].pixels().all(|pixel| pixel.0[3] == 255));
    press_board(&mut remote, &program, SEEN);
    wait_for_frame(&program, &runtime, "alpha projection+alpha quad+alpha");
    let shot = program.fresh_shot();
    assert!(corners(&shot.eyes[0]).all(|pixel| pixel == CLEAR));
    program.stop();
}
