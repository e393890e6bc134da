//! The form in which nearby voxels are shown: an undo step that changes no voxel, and that files, orientations and
//! other sculptures preserve.

use std::path::Path;

use sculpture_core::command::Command;
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::format::options::ImportOptions;
use sculpture_core::format::{self, Texts, load, read_sculpture, write_sculpture};
use sculpture_core::sculpture::history::SurfaceKind;

fn document() -> Document {
    let new: Command = "new dims=20,16,12 fill=solid".parse().unwrap();
    let Command::New(new) = new else { panic!() };
    Document::new(&new, Limits::default()).unwrap()
}

fn run(document: &mut Document, script: &str) -> Result<(), CommandError> {
    script.lines().try_for_each(|line| document.apply(&line.trim().parse().unwrap()).map(drop))
}

#[test]
fn a_kind_of_surface_is_undone_and_redone_and_changes_no_voxel() {
    let mut document = document();
    let before = document.contents().clone();
    assert_eq!(before.surface, SurfaceKind::Smooth);
    let state = document.state();
    run(&mut document, "surface smooth").unwrap();
    assert_eq!((document.state(), document.history().undo_count()), (state, 0), "nothing was done");
    document.drain_changes(|_, _| ());
    run(&mut document, "surface cubes").unwrap();
    document.drain_changes(|_, dirty| assert_eq!(dirty, Some(&[][..])));
    let shown = document.contents().clone();
    assert_eq!(shown.surface, SurfaceKind::Cubes);
    assert!(shown.grid == before.grid && shown.material == before.material);
    assert_ne!(document.state(), state, "there is something to save");
    assert_eq!(document.state().sculpture, state.sculpture, "its file is the same");
    assert_eq!(document.history().undo_labels().last(), Some("surface cubes"));
    // Later steps use the same history.
    run(&mut document, "subtract ellipsoid at=4,9,3 half=5\nundo 2").unwrap();
    assert!(document.contents() == &before && document.state() == state);
    run(&mut document, "redo").unwrap();
    assert!(document.contents() == &shown);
    let within_a_stroke = run(&mut document, "begin \"a\"\nsurface smooth");
    assert!(matches!(within_a_stroke, Err(CommandError::StrokeOpen("surface"))));
}

#[test]
fn it_stays_with_the_sculpture() {
    let mut document = document();
    run(&mut document, "surface cubes\norient upright=z").unwrap();
    assert_eq!(document.contents().surface, SurfaceKind::Cubes, "reoriented");
    let file = write_sculpture(document.contents(), &Texts::default()).unwrap();
    let (read, _) = read_sculpture(&file, &Limits::default()).unwrap();
    assert!(&read == document.contents());
    run(&mut document, "new dims=8,8,8").unwrap();
    assert_eq!(document.contents().surface, SurfaceKind::Smooth, "a new one has its own");
    run(&mut document, "undo").unwrap();
    assert!(document.contents() == &read);
}

/// Models of cubes stay cubes; meshes and scans are smooth, as are files that the program has written otherwise.
#[test]
fn models_of_voxel_editors_keep_their_cubes() {
    let folder = tempfile::tempdir().unwrap();
    let document = document();
    for (name, surface) in [
        ("a.vox", SurfaceKind::Cubes),
        ("a.qb", SurfaceKind::Cubes),
        ("a.vsc", SurfaceKind::Smooth),
        ("a.pvm", SurfaceKind::Smooth),
        ("a.stl", SurfaceKind::Smooth),
    ] {
        let path = folder.path().join(name);
        format::save(&path, document.contents(), Default::default(), &()).unwrap();
        let read = |path: &Path| load(path, &ImportOptions::default(), &Limits::default(), &());
        assert_eq!(read(&path).unwrap().contents.surface, surface, "{name}");
    }
}
