//! The program from outside, as a person or a script runs it without a display: arguments, files, exit codes and
//! messages.

mod check;
mod files;
mod film;
mod final_picture;
#[cfg(target_os = "linux")]
mod limits;
mod masks;
mod meshes;
mod orthographic;
mod pipe;
mod recover;
mod samples;
#[cfg(target_os = "linux")]
mod streams;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use trials::shared_file;

use crate::gpu::fixture::need_device;

fn program(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().expect("the program starts")
}

/// The program without a display, to be run in a folder.
fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"));
    command
        .args(arguments)
        .current_dir(folder)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env("XDG_CONFIG_HOME", folder)
        .env("XDG_STATE_HOME", folder)
        .env("RUST_LOG", "warn");
    command
}

/// Runs the program, asserts success and returns its output.
fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = program(folder, arguments);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{arguments:?}: {:?}\n{text}\n{}",
        output.status,
        String::from_utf8_lossy(&output.stderr)
    );
    text
}

/// Runs the program, asserts an exit code and returns its error output.
fn fail(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = program(folder, arguments);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
    assert!(!text.contains("panicked"), "{text}");
    text
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

fn bytes(path: PathBuf) -> Vec<u8> {
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Pixels of a PNG: width, height, RGB.
fn picture(path: PathBuf) -> image::RgbImage {
    image::open(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).to_rgb8()
}

/// A deterministic script of carving commands within a box of voxels.
fn random_carvings(count: u32, dims: [f32; 3]) -> String {
    let mut state = 0x2005_u64;
    let mut next = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1u32 << 24) as f32
    };
    let mut script = String::new();
    for i in 0..count {
        let solid = ["ellipsoid", "cuboid", "pyramid"][i as usize % 3];
        let verb = ["subtract", "subtract", "add", "recolour"][i as usize / 3 % 4];
        let at = dims.map(|d| next() * d);
        let half = [0; 3].map(|_| 2.0 + 18.0 * next());
        let turn = [0; 3].map(|_| 360.0 * next());
        let list = |v: [f32; 3]| format!("{},{},{}", v[0], v[1], v[2]);
        script +=
            &format!("{verb} {solid} at={} half={} turn={}", list(at), list(half), list(turn));
        if verb != "subtract" {
            script += &format!(" colour=#{:06x}", (next() * 16777215.0) as u32);
        }
        script += "\n";
    }
    script
}

#[test]
fn without_a_display_and_arguments_nothing_is_written_unless_the_demo_is_asked_for() {
    let folder = folder();
    let why = fail(folder.path(), &[], 4);
    assert!(why.contains("there is no display") && why.contains("`demo`"), "{why}");
    let written: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert!(written.is_empty(), "{written:?}");
    let why = fail(folder.path(), &["--or-demo", "head.vsc"], 4);
    assert!(why.contains("there is no display") && !folder.path().join("out").exists(), "{why}");
    // As `run.sh` starts it.
    let script = include_str!("../../run.sh");
    assert!(script.contains("set -- --or-demo"), "{script}");
    std::fs::write(folder.path().join("c.toml"), "[render]\nmode = \"ray\"\n").unwrap();
    succeed(folder.path(), &["--config", "c.toml", "--or-demo"]);
    for name in ["demo.png", "demo.vsc"] {
        assert!(folder.path().join("out").join(name).exists(), "{name}");
    }
}

#[test]
fn the_demo_writes_a_picture_and_a_sculpture_that_reads_back() {
    let folder = folder();
    let said = succeed(folder.path(), &["demo", "--out", "made/here", "--mode", "ray"]);
    assert!(said.contains("demo.png") && said.contains("demo.vsc"), "{said}");
    let image = picture(folder.path().join("made/here/demo.png"));
    assert_eq!(image.dimensions(), (640, 480));
    let colours: std::collections::HashSet<_> = image.pixels().collect();
    assert!(colours.len() > 200, "only {} colours: nothing to see", colours.len());
    let info = succeed(folder.path(), &["info", "made/here/demo.vsc"]);
    assert!(info.contains("256x256x256"), "{info}");
    // The saved picture equals the rendered one.
    succeed(
        folder.path(),
        &["render", "made/here/demo.vsc", "--out", "again.png", "--mode", "ray"],
    );
    assert_eq!(picture(folder.path().join("again.png")), image);
}

#[test]
fn two_eyes_are_written_apart_and_together_by_either_sampler() {
    need_device();
    let folder = folder();
    let demo = |mode: &str, layout: &str| {
        let arguments = ["demo", "--out", layout, "--mode", mode, "--stereo", layout];
        succeed(folder.path(), &arguments)
    };
    let said = demo("ray", "layers");
    assert!(said.contains("demo.left.png") && said.contains("demo.right.png"), "{said}");
    let [left, right] =
        ["left", "right"].map(|eye| picture(folder.path().join(format!("layers/demo.{eye}.png"))));
    let parallax = left.pixels().zip(right.pixels()).filter(|(l, r)| l != r).count();
    assert!(parallax > 10_000, "only {parallax} pixels differ between the eyes");
    demo("slicing", "anaglyph");
    let together = picture(folder.path().join("anaglyph/demo.png"));
    let near = |a: u8, b: u8| a.abs_diff(b) <= 1;
    let other = together.enumerate_pixels().filter(|(x, y, pixel)| {
        let (l, r) = (left.get_pixel(*x, *y), right.get_pixel(*x, *y));
        !(near(pixel[0], l[0]) && near(pixel[1], r[1]) && near(pixel[2], r[2]))
    });
    assert!(other.count() <= 30, "slices and rays agree but for 0.01 % of the pixels");
}

#[test]
fn without_display_the_demo_is_made_where_it_is_asked_for() {
    need_device();
    let folder = folder();
    let said = succeed(folder.path(), &["--or-demo"]);
    assert!(folder.path().join("out/demo.png").exists() && said.contains("out/demo.vsc"), "{said}");
}

#[test]
fn two_hundred_carvings_saved_reloaded_and_undone_give_identical_bytes() {
    let volume = shared_file("data/derived/VisMale_128x256x256_u8.pvm");
    let folder = folder();
    let script = format!(
        "save \"before.pvm\"\n{}save \"carved.pvm\"\nopen \"carved.pvm\"\nsave \"reloaded.pvm\"\n\
         undo all\nsave \"after.pvm\"\nredo all\nsave \"redone.pvm\"\n",
        random_carvings(200, [128.0, 256.0, 256.0])
    );
    std::fs::write(folder.path().join("carve.sculpt"), script).unwrap();
    let volume = volume.to_str().unwrap();
    succeed(folder.path(), &["run", "carve.sculpt", "--in", volume]);
    let file = |name: &str| bytes(folder.path().join(name));
    assert_ne!(file("before.pvm"), file("carved.pvm"));
    assert_eq!(file("carved.pvm"), file("reloaded.pvm"));
    assert_eq!(file("before.pvm"), file("after.pvm"));
    assert_eq!(file("carved.pvm"), file("redone.pvm"));
}

#[test]
fn real_volumes_render_and_convert() {
    for (name, up) in [
        ("data/derived/VisMale_128x256x256_u8.pvm", "z"),
        ("data/derived/CraniumCT_128x128x108_u16.pvm", "z"),
        ("data/derived/spot96_rgb.pvm", "y"),
    ] {
        let volume = shared_file(name);
        let folder = folder();
        let volume = volume.to_str().unwrap();
        succeed(folder.path(), &["render", volume, "--out", "a.png", "--mode", "ray", "--up", up]);
        let image = picture(folder.path().join("a.png"));
        let corner = *image.get_pixel(0, 0);
        let covered = image.enumerate_pixels().filter(|(x, y, p)| {
            // The background changes slowly from top to bottom: compare along the row.
            (*x > 0) && *p != image.get_pixel(0, *y)
        });
        let share = covered.count() as f32 / (640.0 * 480.0);
        assert!((0.1..0.9).contains(&share), "{name}: {share} of the picture covered, {corner:?}");
        succeed(folder.path(), &["convert", volume, "b.pvm"]);
        succeed(folder.path(), &["render", "b.pvm", "--out", "b.png", "--mode", "ray", "--up", up]);
        assert_eq!(picture(folder.path().join("b.png")), image, "{name}: saving changed it");
    }
}

#[test]
fn wrong_use_gives_code_2_and_says_what_is_right() {
    let folder = folder();
    let error = fail(folder.path(), &["render", "x.pvm", "--out", "x.png", "--size", "0x9"], 2);
    assert!(error.contains("WIDTHxHEIGHT"), "{error}");
    let error = fail(folder.path(), &["render", "x.pvm", "--out", "x.png", "--camera", "up"], 2);
    assert!(error.contains("3/4, front"), "{error}");
    fail(folder.path(), &["frobnicate", "--all"], 2);
}

#[test]
fn unusable_input_gives_code_3_and_names_file_and_place() {
    let folder = folder();
    let error = fail(folder.path(), &["render", "no.pvm", "--out", "x.png"], 3);
    assert!(error.contains("no.pvm"), "{error}");
    std::fs::write(folder.path().join("bad.pvm"), "PVM\n4 4\n").unwrap();
    let error = fail(folder.path(), &["info", "bad.pvm"], 3);
    assert!(error.contains("bad.pvm"), "{error}");
    std::fs::write(folder.path().join("bad.sculpt"), "clear\n\nadd cube at=1,2,3\n").unwrap();
    let error = fail(folder.path(), &["run", "bad.sculpt"], 3);
    assert!(error.contains("bad.sculpt") && error.contains("line 3"), "{error}");
    std::fs::write(folder.path().join("end.sculpt"), "clear\nend\n").unwrap();
    let error = fail(folder.path(), &["run", "end.sculpt"], 3);
    assert!(error.contains("line 2") && error.contains("begin"), "{error}");
    std::fs::write(folder.path().join("c.toml"), "[memory]\ngrid_mib = \"much\"\n").unwrap();
    let error = fail(folder.path(), &["--config", "c.toml", "demo"], 3);
    assert!(error.contains("c.toml") && error.contains("grid_mib"), "{error}");
}

#[test]
fn settings_may_stand_before_a_job_and_arguments_of_the_window_may_not() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("c.toml"), "[new]\ndims = [8, 9, 10]\n").unwrap();
    std::fs::write(path.join("nothing.sculpt"), "").unwrap();
    let run = ["run", "nothing.sculpt", "--out", "a.vsc"];
    for arguments in [
        [&["--config", "c.toml", "--quiet"][..], &run].concat(),
        [&run[..], &["--config", "c.toml"]].concat(),
    ] {
        succeed(path, &arguments);
        let info = succeed(path, &["--profile", "desktop", "info", "a.vsc"]);
        assert!(info.contains("8x9x10"), "{info}");
        std::fs::remove_file(path.join("a.vsc")).unwrap();
    }
    for (arguments, named) in [
        (&["--record", "j.sculpt", "info", "a.vsc"][..], "--record"),
        (&["--threshold", "5", "info", "a.vsc"], "--threshold"),
        (&["--headset", "doctor"], "--headset"),
        (&["a.vsc", "commands"], "[FILE]"),
    ] {
        let error = fail(path, arguments, 2);
        assert!(error.contains(named) && error.contains("window"), "{error}");
    }
}

#[test]
fn a_failed_save_keeps_the_old_file() {
    let folder = folder();
    std::fs::write(folder.path().join("a.sculpt"), "new dims=8,8,8\nsave \"no/such/folder.pvm\"\n")
        .unwrap();
    let error = fail(folder.path(), &["run", "a.sculpt"], 3);
    assert!(error.contains("no/such/folder.pvm"), "{error}");
}

#[test]
fn every_command_of_the_manual_is_listed() {
    let folder = folder();
    let said = succeed(folder.path(), &["commands"]);
    for command in virtual_sculpture::command::COMMANDS.iter() {
        assert!(said.contains(command.verb) && said.contains(&*command.tooltip));
    }
}

#[test]
fn the_doctor_reports_without_failing() {
    let folder = folder();
    let said = succeed(folder.path(), &["doctor"]);
    for word in [
        "settings",
        "gamepad",
        "cameras",
        "OpenXR",
        "commit ",
        "kernel ",
        "session: none",
        "MiB available",
        "state: ",
        "journals: ",
        "Vulkan device 0: ",
        " (Vulkan 1.",
    ] {
        assert!(said.contains(word), "{word} lacks in\n{said}");
    }
}

#[test]
fn a_sculpture_in_the_own_format_is_as_good_as_a_volume() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(
        path.join("ball.sculpt"),
        "new dims=60,50,40 colour=16 base=#c8beaa fill=empty\n\
         add ellipsoid at=30,25,20 half=22,20,18 colour=#d9a441\n",
    )
    .unwrap();
    succeed(path, &["run", "ball.sculpt", "--out", "ball.vsc"]);
    succeed(path, &["run", "ball.sculpt", "--out", "ball.pvm"]);
    succeed(path, &["convert", "ball.vsc", "again.pvm"]);
    assert_eq!(bytes(path.join("again.pvm")), bytes(path.join("ball.pvm")));
    succeed(path, &["convert", "ball.pvm", "again.vsc"]);
    succeed(path, &["convert", "again.vsc", "third.pvm"]);
    assert_eq!(bytes(path.join("third.pvm")), bytes(path.join("ball.pvm")));
    let info = succeed(path, &["info", "ball.vsc"]);
    assert!(info.contains("60x50x40") && info.contains("16 bits of colour"), "{info}");

    let why = fail(path, &["convert", "ball.vsc", "shape.vsc", "--form", "densities"], 1);
    assert!(why.contains("always stores"), "{why}");
    let mut damaged = bytes(path.join("ball.vsc"));
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    std::fs::write(path.join("damaged.vsc"), damaged).unwrap();
    let why = fail(path, &["convert", "damaged.vsc", "a.pvm"], 3);
    assert!(why.contains("damaged"), "{why}");
}

fn name_of(entry: &serde_json::Value) -> &str {
    entry["name"].as_str().unwrap()
}

#[test]
fn the_benchmark_reports_as_table_json_and_plot() {
    need_device();
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("block.sculpt"), "new dims=64,64,64 colour=0 fill=solid\n").unwrap();
    succeed(path, &["run", "block.sculpt", "--out", "block.vsc"]);
    let said = succeed(path, &["bench", "--kernel", "ray", "block.vsc", "--repeat", "3"]);
    assert!(said.starts_with("block.vsc: "), "{said}");

    let said = succeed(
        path,
        &[
            "bench", "cube", "--mode", "ray", "--mode", "march", "--json", "b.json", "--plot",
            "b.svg", "--size", "320x200", "--eyes", "2", "--suite", "brief",
        ],
    );
    assert!(said.contains("cube 256") && said.contains("voxels/s"), "{said}");
    assert!(said.contains("pictures of 320x200 for two eyes"), "{said}");
    let json = String::from_utf8(bytes(path.join("b.json"))).unwrap();
    let report: serde_json::Value = serde_json::from_str(&json).unwrap();
    let modes = report["scenes"][0]["modes"].as_array().unwrap();
    let ray = modes.iter().find(|mode| mode["mode"] == "ray").unwrap();
    assert_eq!(report["picture"], serde_json::json!([320, 200]));
    assert_eq!(report["eyes"], 2);
    for times in ["sample", "shade", "frame", "edit_32", "edit_32_composite", "edit_64"] {
        let [least, median, most] =
            ["min_ms", "median_ms", "p99_ms"].map(|key| ray[times][key].as_f64().unwrap());
        assert!(0.0 < least && least <= median && median <= most, "{times}");
    }
    assert_eq!((ray["to_ray"].as_f64(), modes.len()), (Some(1.0), 2));
    let last = &report["scenes"][0]["final_picture"];
    assert!(last["trace_s"].as_f64().unwrap() > 0.0 && last["samples"] == 2, "{last}");
    assert!(said.contains("final pictures; s"), "{said}");
    let features: Vec<&str> = ray["features"].as_array().unwrap().iter().map(name_of).collect();
    let expected = ["occlusion", "shadow", "ground", "smooth edges", "smooth surface"];
    assert_eq!(features, expected);
    assert!(said.contains("what features add"), "{said}");
    // Times by the device, where it measures any, are within those by the clock.
    let march = modes.iter().find(|mode| mode["mode"] == "march").unwrap();
    let (on_device, ray_on_device) = (&march["device"], &ray["device"]);
    assert!(on_device["shade"].is_null() && ray_on_device["sample"].is_null());
    assert_eq!(on_device["sample"].is_null(), ray_on_device["compose"].is_null());
    if let Some(sample_ms) = on_device["sample"]["min_ms"].as_f64() {
        let wall_ms = march["sample"]["min_ms"].as_f64().unwrap();
        assert!(0.0 < sample_ms && sample_ms <= wall_ms, "{sample_ms} {wall_ms}");
        assert!(said.contains("on the device"), "{said}");
    }
    let plot = String::from_utf8(bytes(path.join("b.svg"))).unwrap();
    assert!(plot.starts_with("<svg") && plot.ends_with("</svg>\n") && plot.contains("cube 256"));
    assert!(plot.contains("two pictures of 320x200"));
    fail(path, &["bench", "missing.vsc"], 3);
    for (option, value, why) in [
        ("--size", "640", "WIDTHxHEIGHT"),
        ("--size", "0x480", "1 to 16384"),
        ("--eyes", "3", "1..=2"),
        ("--eyes", "two", "invalid"),
    ] {
        let said = fail(path, &["bench", option, value], 2);
        assert!(said.contains(option) && said.contains(why), "{said}");
    }
    let said = fail(path, &["bench", "--kernel", "ray", "--eyes", "2"], 2);
    assert!(said.contains("--kernel"), "{said}");

    let said = succeed(
        path,
        &[
            "bench", "--sizes", "--suite", "brief", "--json", "s.json", "--plot", "s.svg",
            "--size", "160x120",
        ],
    );
    assert!(said.contains("block, 1000 balls") && said.contains("most memory"), "{said}");
    let json = String::from_utf8(bytes(path.join("s.json"))).unwrap();
    let report: serde_json::Value = serde_json::from_str(&json).unwrap();
    let sizes = report["sizes"].as_array().unwrap();
    assert_eq!(sizes.len(), 4, "two sculptures of two sizes");
    for size in sizes {
        assert!(size["voxels"].as_u64() > Some(0) && size["file_bytes"].as_u64() > Some(0));
        for times in ["edit", "undo", "sample", "first_picture", "save", "load"] {
            assert!(size[times]["median_ms"].as_f64() > Some(0.0), "{times}");
        }
    }
    let plot = String::from_utf8(bytes(path.join("s.svg"))).unwrap();
    assert!(plot.ends_with("</svg>\n") && plot.matches("<polyline").count() == 10, "{plot}");
    let said = fail(path, &["bench", "--sizes", "cheese"], 2);
    assert!(said.contains("--sizes"), "{said}");
}
