//! Output names that would overwrite another file, and inputs that are no regular files: they are refused, with a
//! message, before anything is written or waited for.

use super::{bytes, fail, folder, picture, program, succeed};
use virtual_sculpture::session::{FileAccess, Session};

use crate::gpu::fixture::need_device;

const SCRIPT: &str = "new dims=16,16,16\nsubtract ellipsoid at=8,8,8 half=6\n";

#[test]
fn nothing_is_written_over_a_file_of_another_kind() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    let before = bytes(path.join("a.vsc"));
    for arguments in [
        &["render", "a.vsc", "--out", "a.vsc"][..],
        &["run", "s.sculpt", "--render", "a.vsc"],
        &["run", "s.sculpt", "--out", "s.sculpt"],
        &["convert", "a.vsc", "s.sculpt"],
        &["marker", "--out", "a.vsc"],
        &["bench", "a.vsc", "--json", "a.vsc"],
        &["bench", "a.vsc", "--plot", "a.vsc"],
    ] {
        let why = fail(path, arguments, 2);
        assert!(why.contains("must end in"), "{arguments:?}: {why}");
        assert_eq!(bytes(path.join("a.vsc")), before, "{arguments:?}");
        assert_eq!(bytes(path.join("s.sculpt")), SCRIPT.as_bytes(), "{arguments:?}");
    }
}

#[test]
fn a_file_that_another_program_has_open_is_read_but_not_saved() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), "subtract cuboid at=4,4,4 half=2\n").unwrap();
    std::fs::write(path.join("n.sculpt"), "new dims=16,16,16\n").unwrap();
    succeed(path, &["run", "n.sculpt", "--out", "a.vsc"]);
    let before = bytes(path.join("a.vsc"));
    let limits = virtual_sculpture::sculpture::Limits::default();
    let mut other = Session::open(&path.join("a.vsc"), &Default::default(), limits, &()).unwrap();
    other.set_file_access(FileAccess::Locked);

    let job = ["run", "s.sculpt", "--in", "a.vsc"];
    let why = fail(path, &[&job[..], &["--out", "a.vsc"]].concat(), 1);
    let process = format!("process {}", std::process::id());
    assert!(why.contains("a.vsc") && why.contains(&process), "{why}");
    assert!(why.contains("save under another name"), "{why}");
    assert_eq!(bytes(path.join("a.vsc")), before);
    succeed(path, &[&job[..], &["--out", "b.vsc"]].concat());

    drop(other);
    let why = fail(path, &[&job[..], &["--read-only", "--out", "a.vsc"]].concat(), 1);
    assert!(why.contains("opened read-only"), "{why}");
    assert_eq!(bytes(path.join("a.vsc")), before);
    succeed(path, &[&job[..], &["--out", "a.vsc"]].concat());
    assert_ne!(bytes(path.join("a.vsc")), before);
    let left = std::fs::read_dir(path).unwrap().map(|file| file.unwrap().file_name());
    let hidden: Vec<_> = left.filter(|name| name.to_string_lossy().starts_with('.')).collect();
    assert!(hidden.is_empty(), "{hidden:?}");
}

#[test]
fn a_picture_is_what_its_name_says() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    let render = |name: &str, more: &[&str]| {
        let arguments = ["render", "a.vsc", "--out", name, "--mode", "ray", "--size", "160x120"];
        succeed(path, &[&arguments[..], more].concat())
    };
    render("a.png", &[]);
    let exact = picture(path.join("a.png"));
    assert_eq!(image::guess_format(&bytes(path.join("a.png"))).unwrap(), image::ImageFormat::Png);
    for name in ["a.jpg", "a.JPEG"] {
        render(name, &[]);
        let file = bytes(path.join(name));
        assert_eq!(image::guess_format(&file).unwrap(), image::ImageFormat::Jpeg, "{name}");
        let seen = image::load_from_memory(&file).unwrap().to_rgb8();
        let off =
            seen.iter().zip(exact.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>();
        let mean = off as f64 / exact.len() as f64;
        assert!(mean < 3.0, "{name}: {mean} levels off in the mean");
    }
    let said = render("b.jpg", &["--stereo", "layers"]);
    assert!(said.contains("b.left.jpg") && said.contains("b.right.jpg"), "{said}");
    let left = bytes(path.join("b.left.jpg"));
    assert_eq!(image::guess_format(&left).unwrap(), image::ImageFormat::Jpeg);
}

#[test]
fn a_threshold_may_be_negative() {
    let folder = folder();
    let path = folder.path();
    let densities = [-300i16, -2, -1, 0, 1, 700, 800, 900].map(i16::to_le_bytes).concat();
    std::fs::write(path.join("ct.raw"), densities).unwrap();
    for (threshold, voxels) in [("-1", 6), ("-2.5", 7), ("-1e3", 8), ("700", 3)] {
        let arguments =
            ["convert", "ct.raw", "a.vsc", "--raw", "2x2x2:i16le", "--threshold", threshold];
        let said = succeed(path, &arguments);
        assert!(said.contains(&format!("{voxels} of 8 voxels")), "{threshold}: {said}");
    }
    let why = fail(path, &["info", "ct.raw", "--threshold", "--raw"], 2);
    assert!(why.contains("--threshold"), "{why}");
}

#[test]
fn a_scan_is_turned_upright_as_it_is_read() {
    let folder = folder();
    let path = folder.path();
    // 4 x 2 x 3 voxels; the slice of the highest z is full, so it lies at the top with z up.
    let scan: Vec<u8> = (0..24).map(|i| if i < 16 { 0 } else { 200 }).collect();
    std::fs::write(path.join("scan.raw"), scan).unwrap();
    let raw = ["--raw", "4x2x3:u8:size=1,2,3", "--threshold", "100"];
    for (upright, dims, size, top) in [
        ("y", "4x2x3", "1 2 3", None),
        ("z", "4x3x2", "1 3 2", Some(true)),
        ("-z", "4x3x2", "1 3 2", Some(false)),
        ("x", "2x4x3", "2 1 3", None),
    ] {
        let arguments = ["convert", "scan.raw", "a.vsc", "--upright", upright];
        let said = succeed(path, &[&arguments[..], &raw].concat());
        assert!(said.contains(&format!("sculpture {dims}, 8 of 24 voxels")), "{upright}: {said}");
        let said = succeed(path, &["info", "a.vsc"]);
        assert!(said.contains(&format!("voxel size: {size}")), "{upright}: {said}");
        if let Some(top) = top {
            let (full, empty) = if top { (2, 0) } else { (0, 2) };
            for (y, count) in [(full, 0), (empty, 8)] {
                let script = format!("mark at=0,{y},0 size=4,1,2\nclear marker\n");
                std::fs::write(path.join("s.sculpt"), script).unwrap();
                let said = succeed(path, &["run", "s.sculpt", "--in", "a.vsc"]);
                assert!(said.contains(&format!("{count} of 24 voxels")), "{upright}: {said}");
            }
        }
    }
    // Files that this program has written name their orientation.
    let said = succeed(path, &["convert", "a.vsc", "own.pvm"]);
    assert!(said.contains("sculpture 2x4x3"), "{said}");
    let said = succeed(path, &["convert", "own.pvm", "b.vsc", "--upright", "z"]);
    assert!(said.contains("sculpture 2x4x3"), "{said}");
    // In a script.
    let script = "open \"scan.raw\" threshold=100 upright=-z raw=4x2x3:u8\norient upright=-y\n";
    std::fs::write(path.join("s.sculpt"), script).unwrap();
    let said = succeed(path, &["run", "s.sculpt"]);
    assert!(said.contains("sculpture 4x3x2, 8 of 24 voxels"), "{said}");
    let why = fail(path, &["info", "scan.raw", "--upright", "up"], 2);
    assert!(why.contains("x, y, z, -x, -y or -z"), "{why}");
}

/// Each of these would wait for ever if it were opened.
#[cfg(target_os = "linux")]
#[test]
fn a_pipe_is_refused_and_not_waited_for() {
    let folder = folder();
    let path = folder.path();
    for name in ["pipe.pvm", "pipe.vsc", "pipe.png"] {
        let made = std::process::Command::new("mkfifo").arg(path.join(name)).status().unwrap();
        assert!(made.success());
    }
    std::fs::write(path.join("wrap.sculpt"), "texture \"pipe.png\" cuboid at=8,8,8 half=4\n")
        .unwrap();
    std::fs::write(path.join("nothing.txt"), "# no pose\n").unwrap();
    for (arguments, word) in [
        (&["info", "pipe.pvm"][..], "pipe"),
        (&["info", "pipe.vsc"], "pipe"),
        (&["convert", "pipe.vsc", "a.vsc"], "pipe"),
        (&["run", "wrap.sculpt"], "pipe.png"),
        (&["track", "--from", "script:nothing.txt"], "nothing.txt"),
    ] {
        let why = fail(path, arguments, 3);
        assert!(why.contains(word), "{arguments:?}: {why}");
    }
}

#[test]
fn an_error_names_the_file_that_was_meant_and_no_other() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    let protect = |readonly| {
        let mut permissions = std::fs::metadata(path.join("a.vsc")).unwrap().permissions();
        permissions.set_readonly(readonly);
        std::fs::set_permissions(path.join("a.vsc"), permissions).unwrap();
    };
    protect(true);
    let before = bytes(path.join("a.vsc"));
    for (to, word) in [("a.vsc", "write-protected"), ("none/a.vsc", "no folder none")] {
        let why = fail(path, &["run", "s.sculpt", "--out", to], 1);
        assert!(why.contains(to) && why.contains(word) && !why.contains(".part"), "{why}");
    }
    assert_eq!(bytes(path.join("a.vsc")), before);
    let why = fail(path, &["render", "a.vsc", "--out", "none/a.png", "--mode", "ray"], 1);
    assert!(why.contains("none/a.png") && why.contains("no folder none"), "{why}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_keeps_the_old_file_and_says_so() {
    // A file may take this much and no more: that is how a full disk looks from within.
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    std::fs::write(path.join("a.raw"), "kept").unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    let limited = "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\"";
    for (what, out) in [
        ("run s.sculpt --out", "a.raw"),
        ("run s.sculpt --out", "a.3mf"),
        ("render a.vsc --quality final --samples 1 --size 96x64 --out", "a.png"),
    ] {
        let output = std::process::Command::new("sh")
            .args(["-c", limited, env!("CARGO_BIN_EXE_virtual-sculpture")])
            .args(what.split(' '))
            .arg(out)
            .current_dir(path)
            .env("XDG_CONFIG_HOME", path)
            .output()
            .unwrap();
        let why = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{out}: {why}");
        assert!(why.contains(out) && why.contains("the disk takes no file"), "{why}");
        assert_eq!(why.lines().count(), 1, "{why}");
        assert_eq!(bytes(path.join("a.raw")), b"kept");
        let left: Vec<_> =
            std::fs::read_dir(path).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left.len(), 3, "{left:?}");
    }
}

#[test]
fn a_sculpture_too_large_for_the_device_in_a_mode_is_rendered_in_the_next() {
    need_device();
    let folder = folder();
    let path = folder.path();
    // Its colours take 226 MB; lavapipe's buffers hold 134 MB.
    let script = "new dims=420,420,420 colour=24 base=#808080\n\
                  recolour cuboid at=210,210,210 half=210 colour=#c04040\n";
    std::fs::write(path.join("s.sculpt"), script).unwrap();
    let render = |mode: &str| {
        let name = format!("{mode}.png");
        let arguments = ["run", "s.sculpt", "--render", &name, "--size", "64x48", "--mode", mode];
        let output = program(path, &arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{mode}: {said}");
        (picture(path.join(name)), said)
    };
    let (coloured, said) = render("gpu-colour");
    if said.contains("maxStorageBufferRange") {
        assert!(said.contains("rendering by GPU only, one colour"), "{said}");
        assert_eq!(coloured, render("gpu").0);
    } else {
        // A device with larger buffers; what it draws is compared elsewhere.
        assert!(!said.contains("rendering by"), "{said}");
    }
}

#[test]
fn a_misspelt_job_is_recognised_and_a_file_is_not() {
    let folder = folder();
    let path = folder.path();
    for (arguments, meant) in [
        (&["rendr", "x.vsc", "--out", "x.png"][..], "render"),
        (&["rendr"], "render"),
        (&["--quiet", "rendr", "--mode", "ray"], "render"),
        (&["--config", "c.toml", "cnvert", "a.pvm", "b.pvm"], "convert"),
        (&["infos"], "info"),
        (&["docter"], "doctor"),
        (&["comands", "--help"], "commands"),
    ] {
        let why = fail(path, arguments, 2);
        assert!(why.contains(&format!("did you mean '{meant}'")), "{arguments:?}: {why}");
    }
    // Meant as files: without a display there is no window for them.
    std::fs::write(path.join("rendr"), "").unwrap();
    for file in ["render.pvm", "./rendr", "rendr", "statue"] {
        let why = fail(path, &[file], 4);
        assert!(why.contains("display") && !why.contains("did you mean"), "{file}: {why}");
    }
    for help in [&["--help"][..], &["help", "render"], &["render", "--help"]] {
        assert!(succeed(path, help).contains("Usage"));
    }
}

#[test]
fn one_of_several_channels_and_times_is_asked_for() {
    let folder = folder();
    let path = folder.path();
    let fixtures = concat!(env!("CARGO_MANIFEST_DIR"), "/core/tests/fixtures/field/");
    let file = format!("{fixtures}04_tiff_imagej_2channels.tif");
    let said = succeed(path, &["info", &file, "--channel", "2"]);
    assert!(said.contains("channels: 2, read: 2\n") && !said.contains("was taken"), "{said}");
    let said = succeed(path, &["info", &file]);
    assert!(said.contains("channels: 2, read: 1\n") && said.contains("`channel`"), "{said}");
    for (arguments, part) in [
        (["--channel", "3"], "channel 3 was asked for, but the file has 2; choose one from 1 to 2"),
        (["--time", "2"], "time 2 was asked for, but the file has only one"),
    ] {
        let why = fail(path, &[&["info", &file][..], &arguments].concat(), 3);
        assert!(why.contains(part), "{why}");
    }
    assert!(fail(path, &["info", &file, "--time", "0"], 2).contains("counted from 1"));
    let script = format!("open {file:?} threshold=500 channel=2\n");
    std::fs::write(path.join("s.sculpt"), script).unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "by_script.vsc"]);
    let arguments = ["convert", &file, "by_option.vsc", "--threshold", "500", "--channel", "2"];
    let said = succeed(path, &arguments);
    assert!(said.contains("180 of 4800 voxels"), "{said}");
    assert_eq!(bytes(path.join("by_script.vsc")), bytes(path.join("by_option.vsc")));
}
