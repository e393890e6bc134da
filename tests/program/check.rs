//! `check`: what it finds, as text and JSON, and its exit codes.

use std::path::Path;

use serde_json::{Value, json};

use super::{fail, folder, program, succeed};

/// Exit code and standard output.
fn output_of(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output = program(folder, arguments);
    (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
}

/// A block with a cavity; beside it a plate of one voxel, and a cube in the air.
const SCRIPT: &str = "new dims=48,48,48 fill=empty
add cuboid at=16,12,16 half=12
subtract cuboid at=16,12,16 half=4
add cuboid at=40.5,12,16 half=0.5,12,12
add cuboid at=16,40,16 half=2
";

#[test]
fn faults_are_listed_and_mended_by_the_commands_that_are_named() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    let (code, text) = output_of(path, &["check", "a.vsc", "--wall-mm", "2", "--quiet"]);
    assert_eq!(code, 5, "{text}");
    for line in [
        "size: 37 x 42 x 24 mm, in voxels of 1 x 1 x 1 mm",
        "bed: fits 220 x 250 x 220 mm; 600.0 mm2 stand on it",
        "floating pieces: 1 (64 voxels)\n  at 14,38,14: 4 x 4 x 4 mm, 64 voxels\n  fix: remove-islands keep=standing",
        "closed cavities: 1 (512 voxels)",
        "thin walls: 1 (576 voxels)",
        "  fix: thicken to=2",
        "printable: no",
    ] {
        assert!(text.contains(line), "{line}\nis not in\n{text}");
    }
    let repaired = format!("{SCRIPT}remove-islands\nfill-cavities\nthicken to=2\n");
    std::fs::write(path.join("m.sculpt"), repaired).unwrap();
    succeed(path, &["run", "m.sculpt", "--out", "m.vsc"]);
    let arguments = ["check", "m.vsc", "--wall-mm", "2", "--json", "--quiet"];
    let (code, text) = output_of(path, &arguments);
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((code, &found["printable"], &found["findings"]), (0, &json!(true), &json!([])));
    // Larger than the bed, in larger voxels.
    let (code, text) =
        output_of(path, &["check", "m.vsc", "--millimetres", "10", "--json", "--quiet"]);
    let found: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (code, &found["fits"], &found["voxel_mm"]),
        (5, &json!(false), &json!([10.0, 10.0, 10.0]))
    );
}

#[test]
fn invalid_options_are_named() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), "new dims=8,8,8\n").unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    for (option, value, word) in [
        ("--bed", "220x220", "WIDTHxDEPTHxHEIGHT"),
        ("--wall-mm", "0", "above 0"),
        ("--wall-mm", "100", "more than 64 voxels"),
        ("--overhang-deg", "100", "0 to 90"),
        ("--bridge-mm", "nan", "0 or more"),
        ("--millimetres", "inf", "above 0"),
    ] {
        let why = fail(path, &["check", "a.vsc", option, value], 2);
        assert!(why.contains(word), "{option} {value}: {why}");
    }
    fail(path, &["check", "missing.vsc"], 3);
}
