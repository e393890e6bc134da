//! Meshes from the command line: which files are written, how large they are, and what is refused.

use super::{bytes, fail, folder, succeed};

const SCRIPT: &str =
    "new dims=16,16,16\nsubtract cuboid at=8,8,8 half=8\nadd cuboid at=8,8,8 half=4,2,3\n";

#[test]
fn convert_writes_meshes_with_their_options() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    let said = succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    assert!(said.contains("192 of 4096 voxels"), "{said}");
    // The exposed faces of 8x4x6 voxels.
    let faces = 2 * (8 * 4 + 4 * 6 + 6 * 8);
    for ending in ["stl", "ply", "obj", "glb", "3mf"] {
        let name = format!("a.{ending}");
        let said = succeed(path, &["convert", "a.vsc", &name, "--mesh", "faces"]);
        assert!(said.contains(&format!("{} triangles", 2 * faces)), "{said}");
        assert!(bytes(path.join(&name)).len() > 1000);
    }
    assert!(path.join("a.mtl").exists());
    let stl = bytes(path.join("a.stl"));
    assert_eq!(stl.len(), 84 + 50 * 2 * faces);
    let convert =
        |more: &[&str]| succeed(path, &[&["convert", "a.vsc", "b.stl"][..], more].concat());
    let said = convert(&["--mesh", "greedy", "--up", "y", "--millimetres", "0.5"]);
    assert!(said.contains("12 triangles, 8 vertices, 4.0x2.0x3.0 mm"), "{said}");
    let said = convert(&["--mesh", "greedy"]);
    assert!(said.contains("8.0x6.0x4.0 mm"), "z points up: {said}");
    let smooth = convert(&[]);
    assert!(smooth.contains(&format!("{} triangles", 2 * faces)), "the default: {smooth}");
    let said = convert(&["--triangles", "40"]);
    assert!(said.contains("40 triangles"), "{said}");
    let said = succeed(path, &["convert", "a.vsc", "p.ply", "--points"]);
    assert!(said.contains("0 triangles"), "{said}");
    // Without options, wherever a sculpture is written.
    succeed(path, &["run", "s.sculpt", "--out", "r.stl"]);
    convert(&[]);
    assert_eq!(bytes(path.join("r.stl")), bytes(path.join("b.stl")));
}

#[test]
fn meshes_that_cannot_be_are_refused_with_a_remedy() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    for (arguments, remedy, code) in [
        (&["a.pvm", "--mesh", "faces"][..], "choose such a name", 1),
        (&["a.glb", "--up", "z"], "leave out", 1),
        (&["a.obj", "--points"], ".ply", 1),
        (&["a.stl", "--millimetres", "-2"], "positive", 1),
        (&["a.stl", "--form", "rgba"], "leave it out", 1),
        (&["a.stl", "--triangles", "3"], "4..", 2),
        (&["a.stl", "--mesh", "round"], "smooth", 2),
    ] {
        let why = fail(path, &[&["convert", "a.vsc"], arguments].concat(), code);
        assert!(why.contains(remedy), "{arguments:?}: {why}");
        assert!(!path.join(arguments[0]).exists());
    }
    std::fs::write(path.join("e.sculpt"), "new dims=8,8,8\nsubtract cuboid at=4,4,4 half=4\n")
        .unwrap();
    let why = fail(path, &["run", "e.sculpt", "--out", "e.stl"], 1);
    assert!(why.contains("no voxels"), "{why}");
}

#[test]
fn models_of_cubes_are_shown_and_exported_as_cubes() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vox"]);
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    let convert = |from: &str, more: &[&str]| {
        succeed(path, &[&["convert", from, "b.stl"][..], more].concat())
    };
    let said = convert("a.vox", &[]);
    assert!(said.contains("12 triangles"), "{said}");
    assert_eq!(convert("a.vox", &["--mesh", "smooth"]), convert("a.vsc", &[]));
    // Kept on the way through a sculpture, and until someone says otherwise.
    succeed(path, &["convert", "a.vox", "kept.vsc"]);
    assert!(convert("kept.vsc", &[]).contains("12 triangles"));
    let cubes = bytes(path.join("b.stl"));
    std::fs::write(path.join("t.sculpt"), "open \"kept.vsc\"\nsurface smooth\n").unwrap();
    succeed(path, &["run", "t.sculpt", "--out", "smooth.vsc"]);
    assert_eq!(convert("smooth.vsc", &[]), convert("a.vsc", &[]));
    std::fs::write(path.join("u.sculpt"), "open \"kept.vsc\"\n").unwrap();
    succeed(path, &["run", "u.sculpt", "--out", "c.stl"]);
    assert!(bytes(path.join("c.stl")) == cubes, "the same surface");
    let render = |from: &str, out: &str, more: &[&str]| {
        let size = ["render", from, "--size", "120x90", "--out", out];
        succeed(path, &[&size[..], more].concat());
        bytes(path.join(out))
    };
    assert_eq!(render("a.vox", "m.png", &[]), render("a.vox", "v.png", &["--voxels"]));
    assert_ne!(render("smooth.vsc", "s.png", &[]), render("smooth.vsc", "w.png", &["--voxels"]));
    let last = ["--quality", "final", "--samples", "2", "--ground", "none"];
    let cubes = render("a.vox", "f.png", &last);
    assert_eq!(cubes, render("a.vox", "g.png", &[&last[..], &["--voxels"]].concat()));
}
