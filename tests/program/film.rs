//! Films: what is in their frames, that parts made apart are those of the whole, and what is refused.

use std::io::Cursor;
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{AnimationDecoder, DynamicImage, RgbImage, RgbaImage};

use super::{bytes, fail, folder, picture, program, succeed};
use crate::gpu::fixture::need_device;

/// A block with a step and a tower of another colour: no turn looks like another.
const SCRIPT: &str = "new dims=40,32,24 colour=24 base=#c8beaa fill=empty
add cuboid at=20,6,12 half=18,6,10 colour=#4070c0
save \"not-written.vsc\"
begin
add cuboid at=30,16,12 half=6,12,5 colour=#d9a441
subtract ellipsoid at=30,20,17 half=4
end
mark at=0,0,0 size=4,4,4
recolour cuboid at=6,6,12 half=4,8,12 colour=#b5432e
add ellipsoid at=10,14,8 half=5 colour=#60a050
";

const SMALL: [&str; 4] = ["--size", "96x72", "--mode", "ray"];

fn subjects(path: &Path) {
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    std::fs::remove_file(path.join("not-written.vsc")).unwrap();
}

fn film(path: &Path, subject: &str, out: &str, more: &[&str]) -> String {
    succeed(path, &[&["film", subject, "--out", out][..], &SMALL, more].concat())
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn frames(folder: &Path) -> Vec<RgbImage> {
    names(folder).iter().map(|name| picture(folder.join(name))).collect()
}

/// The mean difference of two pictures, in levels.
fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    let sum: u64 = a.iter().zip(b.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.len() as f64
}

/// Pixels in which the sculpture is: the background has one colour in each row.
fn covered(image: &RgbImage) -> usize {
    image.enumerate_pixels().filter(|(_, y, pixel)| *pixel != image.get_pixel(0, *y)).count()
}

#[test]
fn a_turntable_turns_once_around_and_closes() {
    let folder = folder();
    let path = folder.path();
    subjects(path);
    let said = film(path, "a.vsc", "turn", &["--frames", "24"]);
    assert!(said.contains("frames 1 to 24") && said.contains("96x72"), "{said}");
    let expected: Vec<String> = (1..=24).map(|frame| format!("frame-{frame:04}.png")).collect();
    assert_eq!(names(&path.join("turn")), expected);
    let frames = frames(&path.join("turn"));
    let steps: Vec<f64> = (0..24).map(|i| difference(&frames[i], &frames[(i + 1) % 24])).collect();
    let (least, most) =
        (steps.iter().copied().fold(f64::MAX, f64::min), steps.iter().copied().fold(0.0, f64::max));
    assert!(least > 0.2, "each frame differs from the one before: {steps:?}");
    assert!(steps[23] < 1.5 * most.min(steps[0] + steps[22]), "no jump to the first: {steps:?}");
    assert!(difference(&frames[0], &frames[12]) > 2.0 * steps[23], "half a turn is another view");
    for (i, frame) in frames.iter().enumerate() {
        let share = covered(frame) as f64 / (96.0 * 72.0);
        assert!((0.1..0.8).contains(&share), "frame {i}: {share} of the picture covered");
        let rim = |x: u32, y: u32| frame.get_pixel(x, y) == frame.get_pixel(0, y);
        assert!((0..96).all(|x| rim(x, 0) && rim(x, 71)), "frame {i} is cut off");
    }
    // One turn in half as many frames has every second of them.
    film(path, "a.vsc", "fast", &["--frames", "12"]);
    let fast = self::frames(&path.join("fast"));
    assert!(fast.iter().eq(frames.iter().step_by(2)));
}

#[test]
fn a_time_lapse_goes_from_the_beginning_to_what_the_script_makes() {
    let folder = folder();
    let path = folder.path();
    subjects(path);
    film(path, "s.sculpt", "lapse", &["--frames", "6"]);
    let frames = frames(&path.join("lapse"));
    assert_eq!(covered(&frames[0]), 0, "the new sculpture is empty");
    for (i, pair) in frames.windows(2).enumerate() {
        assert_ne!(pair[0], pair[1], "five steps in six frames: one between {i} and the next");
    }
    let run = ["run", "s.sculpt", "--render", "end.png"];
    succeed(path, &[&run[..], &SMALL].concat());
    assert_eq!(frames[5], picture(path.join("end.png")), "the last frame is the picture");
    assert!(path.join("not-written.vsc").exists(), "`run` writes it");
    std::fs::remove_file(path.join("not-written.vsc")).unwrap();
    // From another sculpture, slowly turning; what the script saves is not written.
    std::fs::write(path.join("more.sculpt"), "add cuboid at=20,24,12 half=3\nsave \"x.vsc\"\n")
        .unwrap();
    film(path, "more.sculpt", "on", &["--in", "a.vsc", "--frames", "3", "--spin", "-45"]);
    let turned = self::frames(&path.join("on"));
    assert!(covered(&turned[0]) > 500 && turned[0] != turned[1] && turned[1] != turned[2]);
    assert!(!path.join("not-written.vsc").exists() && !path.join("x.vsc").exists());
}

/// Makes a film at once and in parts by workers side by side, and compares the folders.
fn compare_workers(mode: &str) {
    let folder = folder();
    let path = folder.path();
    subjects(path);
    for (subject, more) in [
        ("a.vsc", &["--turn", "10"][..]),
        ("s.sculpt", &[]),
        ("s.sculpt", &["--spin", "200", "--up", "z", "--stereo", "anaglyph"]),
    ] {
        let arguments = |out: &str, range: &str| -> Vec<String> {
            let all = ["film", subject, "--out", out, "--range", range, "--frames", "9", "--mode"];
            let words = all.into_iter().chain([mode, "--size", "96x72"]);
            words.chain(more.iter().copied()).map(ToString::to_string).collect()
        };
        let make = |out: &str, range: &str| {
            let arguments = arguments(out, range);
            succeed(path, &arguments.iter().map(String::as_str).collect::<Vec<_>>());
        };
        make("one", "1..");
        std::thread::scope(|scope| {
            // The second one has no frame before its own, and the third one comes upon files of others.
            for range in ["1..4", "5..9", "5..5"] {
                scope.spawn(move || make("parts", range));
            }
        });
        assert_eq!(names(&path.join("parts")), names(&path.join("one")), "{subject} {more:?}");
        assert_eq!(names(&path.join("one")).len(), 9);
        for name in names(&path.join("one")) {
            let [one, part] = ["one", "parts"].map(|made| bytes(path.join(made).join(&name)));
            assert!(one == part, "{mode} {subject} {more:?}: {name} differs");
        }
        for made in ["one", "parts"] {
            std::fs::remove_dir_all(path.join(made)).unwrap();
        }
    }
}

#[test]
fn parts_made_by_several_workers_are_those_of_one() {
    compare_workers("ray");
}

#[test]
fn parts_made_by_several_workers_are_those_of_one_on_a_device() {
    need_device();
    compare_workers("slicing");
}

#[test]
fn animated_pictures_and_raw_video_have_the_frames_of_the_folder() {
    let folder = folder();
    let path = folder.path();
    subjects(path);
    let more = ["--frames", "7", "--range", "2..6", "--fps", "10"];
    for out in ["frames", "a.apng", "a.png", "a.gif", "a.y4m"] {
        film(path, "a.vsc", out, &more);
    }
    let frames = frames(&path.join("frames"));
    assert_eq!(names(&path.join("frames"))[0], "frame-0002.png");
    assert_eq!(bytes(path.join("a.png")), bytes(path.join("a.apng")));
    let decoder = PngDecoder::new(Cursor::new(bytes(path.join("a.apng")))).unwrap();
    let animated = decoder.apng().unwrap().into_frames().collect_frames().unwrap();
    let delays: Vec<_> = animated.iter().map(|frame| frame.delay().numer_denom_ms()).collect();
    assert_eq!(delays, [(100, 1); 5]);
    let read = animated.into_iter().map(|f| DynamicImage::from(f.into_buffer()).to_rgb8());
    assert!(read.eq(frames.iter().cloned()));
    // A GIF has 256 colours a frame.
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(Cursor::new(bytes(path.join("a.gif")))).unwrap();
    for (number, frame) in frames.iter().enumerate() {
        let read = decoder.read_next_frame().unwrap().unwrap();
        assert_eq!(read.delay, 10);
        let seen = RgbaImage::from_raw(96, 72, read.buffer.to_vec()).unwrap();
        let off = difference(frame, &DynamicImage::from(seen).to_rgb8());
        assert!(off < 2.0, "frame {number} is {off} levels off");
    }
    assert!(decoder.read_next_frame().unwrap().is_none());
    let fast = fail(path, &["film", "a.vsc", "--out", "b.gif", "--fps", "60"], 2);
    assert!(fast.contains("50 frames a second"), "{fast}");
    // The program reads its own video.
    let mut source = crate::video::open(path.join("a.y4m").to_str().unwrap());
    let start = std::time::Instant::now();
    let frame = loop {
        if let Some(frame) = source.poll() {
            break frame.clone();
        }
        assert!(start.elapsed().as_secs() < 60, "{:?}", source.state());
        std::thread::sleep(std::time::Duration::from_millis(1));
    };
    assert_eq!((frame.width, frame.height), (96, 72));
    let rgb = frame.pixels.as_chunks::<4>().0.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
    let seen = RgbImage::from_raw(96, 72, rgb).unwrap();
    let nearest = frames.iter().map(|frame| difference(frame, &seen)).fold(f64::MAX, f64::min);
    assert!(nearest < 1.0, "{nearest} levels from the nearest frame");
    let length = bytes(path.join("a.y4m")).len();
    let header = "YUV4MPEG2 W96 H72 F10:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n".len();
    assert_eq!(length, header + 5 * (6 + 3 * 96 * 72));
}

#[test]
fn an_impossible_film_is_refused_with_the_reason() {
    let folder = folder();
    let path = folder.path();
    subjects(path);
    std::fs::write(path.join("bad.sculpt"), "new dims=8,8,8\n\nadd cube at=1,2,3\n").unwrap();
    std::fs::write(path.join("end.sculpt"), "clear\nend\n").unwrap();
    std::fs::create_dir(path.join("folder.y4m")).unwrap();
    for (arguments, code, words) in [
        (&["no.vsc", "--out", "f"][..], 3, &["no.vsc"][..]),
        (&["no.sculpt", "--out", "f"], 3, &["no.sculpt"]),
        (&["bad.sculpt", "--out", "f"], 3, &["bad.sculpt", "line 3"]),
        (&["end.sculpt", "--out", "g"], 3, &["end.sculpt", "line 2"]),
        (&["a.vsc", "--out", "f", "--frames", "0"], 2, &["--frames", "1000000"]),
        (&["a.vsc", "--out", "f", "--fps", "0"], 2, &["--fps"]),
        (&["a.vsc", "--out", "f", "--range", "3..2"], 2, &["A..B"]),
        (&["a.vsc", "--out", "f", "--range", "119..121"], 2, &["119..121", "1 to 120"]),
        (&["a.vsc", "--out", "f", "--spin", "nan"], 2, &["36000"]),
        (&["a.vsc", "--out", "f", "--stereo", "layers"], 2, &["layers", "--stereo"]),
        (&["a.vsc", "--out", "f", "--in", "a.vsc"], 2, &["--in", "a.vsc"]),
        (&["a.vsc", "--out", "f.mp4"], 2, &[".y4m", "folder"]),
        (&["a.vsc", "--out", "a.vsc"], 2, &["must end in"]),
        (&["a.vsc", "--out", "a.vsc/f"], 1, &["a.vsc/f"]),
        (&["a.vsc", "--out", "none/f.y4m"], 1, &["none/f.y4m", "no folder none"]),
    ] {
        let why = fail(path, &[&["film"], arguments].concat(), code);
        assert!(words.iter().all(|word| why.contains(word)), "{arguments:?}: {why}");
    }
    assert!(!path.join("f").exists(), "nothing is begun without a subject or with wrong arguments");
    film(path, "a.vsc", "folder.y4m", &["--frames", "1"]);
    assert_eq!(names(&path.join("folder.y4m")), ["frame-0001.png"], "a folder stays one");
}

#[test]
fn a_film_is_never_written_over_what_it_is_made_of() {
    let folder = folder();
    let path = folder.path();
    std::fs::create_dir(path.join("pictures")).unwrap();
    let texture = RgbImage::from_pixel(2, 2, image::Rgb([200, 30, 30]));
    texture.save(path.join("pictures/frame-0002.png")).unwrap();
    let script = "new dims=8,8,8\ntexture \"pictures/frame-0002.png\" cuboid at=4,4,4 half=3\n";
    std::fs::write(path.join("s.sculpt"), script).unwrap();
    let before = bytes(path.join("pictures/frame-0002.png"));
    for out in ["pictures", "./pictures/../pictures/frame-0002.png"] {
        let why = fail(path, &["film", "s.sculpt", "--out", out, "--mode", "ray"], 2);
        assert!(why.contains("frame-0002.png") && why.contains("overwritten"), "{out}: {why}");
    }
    assert_eq!(names(&path.join("pictures")), ["frame-0002.png"]);
    assert_eq!(bytes(path.join("pictures/frame-0002.png")), before);
    film(path, "s.sculpt", "pictures", &["--frames", "3", "--range", "3"]);
    assert_eq!(names(&path.join("pictures")), ["frame-0002.png", "frame-0003.png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_a_film_and_leaves_no_half_file() {
    let folder = folder();
    let path = folder.path();
    subjects(path);
    std::fs::write(path.join("a.y4m"), "kept").unwrap();
    for (out, blocks) in [("a.y4m", 60), ("a.apng", 8), ("frames", 1)] {
        let film = format!(
            "trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" film a.vsc --out {out} {} --frames 8",
            SMALL.join(" ")
        );
        let output = std::process::Command::new("bash")
            .args(["-c", &film, env!("CARGO_BIN_EXE_virtual-sculpture")])
            .current_dir(path)
            .env("XDG_CONFIG_HOME", path)
            .output()
            .unwrap();
        let why = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{out}: {why}");
        assert!(why.contains(out) && why.contains("large") && !why.contains(".part"), "{why}");
    }
    assert_eq!(bytes(path.join("a.y4m")), b"kept");
    assert!(names(&path.join("frames")).is_empty());
    assert_eq!(names(path), ["a.vsc", "a.y4m", "frames", "s.sculpt"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_film_that_is_interrupted_leaves_no_half_film_and_the_next_one_tidies_up() {
    let folder = folder();
    let path = folder.path();
    subjects(path);
    let arguments = ["film", "a.vsc", "--out", "a.y4m", "--frames", "100000", "--mode", "ray"];
    let mut child = super::command(path, &arguments).spawn().unwrap();
    let part = || {
        let names = names(path);
        let part = names.into_iter().find(|name| name.ends_with(".part"));
        part.filter(|name| path.join(name).metadata().is_ok_and(|part| part.len() > 0))
    };
    let start = std::time::Instant::now();
    while part().is_none() {
        assert!(start.elapsed().as_secs() < 60 && child.try_wait().unwrap().is_none());
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    // Not SIGINT, which what shells start in the background ignores.
    let interrupt =
        std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
    assert!(interrupt.unwrap().success());
    assert!(!child.wait().unwrap().success());
    assert!(!path.join("a.y4m").exists());
    film(path, "a.vsc", "a.y4m", &["--frames", "2"]);
    assert_eq!(names(path), ["a.vsc", "a.y4m", "s.sculpt"]);
}

#[test]
fn a_film_says_nothing_of_frames_on_a_terminal_that_is_none() {
    let folder = folder();
    let path = folder.path();
    subjects(path);
    let film = ["film", "a.vsc", "--out", "f", "--frames", "3"];
    let output = program(path, &[&film[..], &SMALL].concat());
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "wrote frames 1 to 3 to f (96x72)\n");
}
