//! Reorienting the whole sculpture: undo restores identical bytes, marker, selection and symmetry follow, and refusals
//! change nothing.

use glam::{IVec3, UVec3};
use sculpture_core::command::Command;
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::sculpture::orientation::Orientation;
use sculpture_core::session::Session;

/// Sizes of whole bricks, and sizes whose bricks are divided differently when reversed.
const DIMS: [[u32; 3]; 3] = [[16, 24, 8], [13, 24, 9], [1, 7, 17]];

fn document(dims: [u32; 3], limits: Limits) -> Document {
    let [x, y, z] = dims;
    let new: Command = format!("new dims={x},{y},{z} size=1,2,0.5 colour=24").parse().unwrap();
    let Command::New(new) = new else { panic!() };
    let mut document = Document::new(&new, limits).unwrap();
    run(
        &mut document,
        "subtract ellipsoid at=4,9,3 half=5
         recolour cuboid at=9,12,4 half=4,9,9 colour=#ff0000
         recolour ellipsoid at=3,20,7 half=6 colour=#0050ff
         subtract pyramid at=10,20,2 half=5",
    );
    document
}

fn run(document: &mut Document, script: &str) {
    for line in script.lines().map(str::trim) {
        let command: Command = line.parse().unwrap();
        document.apply(&command).unwrap_or_else(|error| panic!("{line}: {error}"));
    }
}

#[test]
fn undo_restores_identical_bytes_in_all_48_ways_and_redo_does_it_again() {
    for dims in DIMS {
        let mut document = document(dims, Limits::default());
        let before = document.contents().clone();
        let (steps, state) = (document.history().undo_count(), document.state());
        for orientation in Orientation::all() {
            let revision = document.revision();
            document.apply(&Command::Orient(orientation)).unwrap();
            assert_eq!(document.grid().dims(), orientation.size(UVec3::from(dims)));
            if orientation == Orientation::UPRIGHT {
                assert_eq!(document.history().undo_count(), steps, "nothing was done");
                assert_eq!(document.revision(), revision);
                continue;
            }
            assert_eq!(document.history().undo_count(), steps + 1);
            assert_eq!(document.history().undo_labels().last(), Some("orient"));
            assert_ne!(document.state(), state);
            assert_eq!(document.state().sculpture, state.sculpture, "its file is the same");
            document.drain_changes(|_, dirty| assert!(dirty.is_none()));
            let after = document.contents().clone();
            // Later steps go through the same history.
            run(&mut document, "dye colour=#102030\nundo 2");
            assert_eq!(document.contents(), &before, "{dims:?} {orientation}");
            assert_eq!(document.state(), state);
            run(&mut document, "redo");
            assert_eq!(document.contents(), &after, "{dims:?} {orientation}");
            run(&mut document, "undo");
            assert_eq!(document.contents(), &before, "{dims:?} {orientation}");
        }
    }
}

#[test]
fn marker_selection_and_symmetry_follow_there_and_back() {
    let mut document = document([13, 24, 9], Limits::default());
    run(
        &mut document,
        "mark at=1,2,3 size=4,5,6
         select add
         mark at=-2,0,1 size=3,30,2
         limit on
         symmetry x=odd z=even",
    );
    let (selection, symmetry) = (document.selection().clone(), document.symmetry());
    run(&mut document, "orient axes=y,-z,x");
    // x becomes y, y becomes z reversed, z becomes x.
    let marker = document.selection().marker();
    assert_eq!((marker.min, marker.max), (IVec3::new(1, -2, -6), IVec3::new(3, 1, 24)));
    let selected = document.selection().boxes()[0].bounds;
    assert_eq!((selected.min, selected.max), (IVec3::new(3, 1, 17), IVec3::new(9, 5, 22)));
    assert!(document.selection().limits());
    assert_eq!(Command::Symmetry(document.symmetry()).to_string(), "symmetry x=even y=odd z=off");
    run(&mut document, "undo");
    assert_eq!((document.selection(), document.symmetry()), (&selection, symmetry));
    assert_eq!(document.grid().voxel_size().to_array(), [1.0, 2.0, 0.5]);
    run(&mut document, "redo");
    assert_eq!(document.grid().voxel_size().to_array(), [0.5, 1.0, 2.0]);
}

#[test]
fn contents_are_kept_only_where_reversing_is_not_exact() {
    // Whole bricks, or no colours: only the inverse orientation.
    let mut whole = document([16, 24, 8], Limits::default());
    let mut plain = document([13, 24, 9], Limits::default());
    run(&mut plain, "new dims=13,24,9 colour=24\nsubtract ellipsoid at=4,9,3 half=5");
    for document in [&mut whole, &mut plain] {
        let bytes = document.history().bytes();
        run(document, "orient axes=-x,-y,-z");
        assert!(document.history().bytes() < bytes + 200, "{}", document.history().bytes());
    }
    // Pages of colours that would be divided differently are kept.
    let mut divided = document([13, 24, 9], Limits::default());
    let (bytes, kept) = (divided.history().bytes(), divided.contents().kept_bytes());
    run(&mut divided, "orient axes=-x,y,z");
    assert!(divided.history().bytes() >= bytes + kept);
    run(&mut divided, "undo");
    assert!(divided.history().bytes() < bytes + 200, "the second step can be reversed exactly");
    // Along the axis of whole bricks, nothing is divided differently.
    run(&mut divided, "orient axes=x,-y,z");
    assert!(divided.history().bytes() < bytes + 200);
}

#[test]
fn a_refusal_changes_nothing() {
    // One brick of three is painted; after mirroring, its voxels lie in two.
    let painted = |limits| {
        let new: Command = "new dims=20,8,8 colour=24".parse().unwrap();
        let Command::New(new) = new else { panic!() };
        let mut document = Document::new(&new, limits).unwrap();
        run(&mut document, "recolour cuboid at=12,4,4 half=4 colour=#ff0000");
        document
    };
    let free = painted(Limits::default());
    let (colours, history) = (free.material().heap_bytes(), free.history().bytes());
    let tight = [
        (Limits { colour_bytes: colours, ..Limits::default() }, "for colours"),
        (Limits { history_bytes: history + 500, ..Limits::default() }, "irreversible on"),
    ];
    for (limits, what) in tight {
        let mut document = painted(limits);
        let (before, bytes) = (document.contents().clone(), document.history().bytes());
        let (state, revision) = (document.state(), document.revision());
        let selection = document.selection().clone();
        document.drain_changes(|_, _| ());
        let error = document.apply(&"orient axes=-x,y,-z".parse().unwrap()).unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
        assert_eq!(document.contents(), &before);
        assert_eq!((document.history().bytes(), document.state()), (bytes, state));
        assert_eq!((document.revision(), document.selection()), (revision, &selection));
        document.drain_changes(|_, dirty| assert_eq!(dirty, Some(&[][..])));
        // Orientations that divide no brick are still accepted.
        run(&mut document, "orient axes=x,-z,y");
    }
    let mut document = painted(Limits::default());
    run(&mut document, "begin");
    let error = document.apply(&"orient upright=z".parse().unwrap()).unwrap_err();
    assert!(matches!(error, CommandError::StrokeOpen("orient")), "{error}");
}

/// As in a window: the long part runs without the session.
#[test]
fn the_long_part_runs_without_the_session_or_is_cancelled() {
    let new: Command = "new dims=13,24,9 colour=8".parse().unwrap();
    let Command::New(new) = new else { panic!() };
    let mut session = Session::new(&new, Limits::default()).unwrap();
    let execute = |session: &mut Session, line: &str| {
        session.execute(&line.parse().unwrap(), &()).unwrap();
    };
    execute(&mut session, "recolour ellipsoid at=5,9,3 half=6 colour=#ff0000");
    let orient: Command = "orient upright=-z".parse().unwrap();
    let before = session.document().contents().clone();

    let cancelled = sculpture_core::progress::ProgressReport::default();
    cancelled.cancel();
    let work = session.prepare(&orient).unwrap().unwrap();
    assert!(work.run(&cancelled).unwrap_err().is_cancelled());
    assert_eq!(session.document().contents(), &before);

    let work = session.prepare(&orient).unwrap().unwrap();
    let done = work.run(&()).unwrap();
    // Changed meanwhile: the present contents are reoriented.
    execute(&mut session, "subtract ellipsoid at=5,9,3 half=3");
    session.complete(done).unwrap();
    let turned = session.document().contents().clone();
    assert_eq!(turned.grid.dims(), UVec3::new(13, 9, 24));
    execute(&mut session, "undo");
    execute(&mut session, "orient upright=-z");
    assert_eq!(session.document().contents(), &turned);
    execute(&mut session, "undo 2");
    assert_eq!(session.document().contents(), &before);
}
