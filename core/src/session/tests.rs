//! Tests sessions with files and pictures.

use super::*;
use crate::sculpture::{ColourDepth, Rgb};

#[test]
fn a_picture_is_read_anew_with_every_stroke() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("colour.png");
    let write = |rgb: [u8; 3]| {
        image::RgbImage::from_pixel(2, 2, image::Rgb(rgb)).save(&path).unwrap();
    };
    let new = NewSculpture {
        dims: glam::UVec3::splat(16),
        voxel_size: glam::Vec3::ONE,
        colour_depth: ColourDepth::Bits24,
        base: Rgb([128; 3]),
        solid: true,
        room_vx: 0,
        grows: false,
    };
    let mut session = Session::new(&new, Limits::default()).unwrap();
    let paint = format!("texture \"{}\" cuboid at=8,8,8 half=4", path.display());
    for rgb in [[200, 10, 20], [30, 220, 40]] {
        write(rgb);
        for line in ["begin", &paint, "end"] {
            session.execute(&line.parse().unwrap(), &()).unwrap();
        }
        let contents = session.document().contents();
        assert_eq!(contents.rgb(glam::UVec3::splat(8)).0, rgb);
    }
    // An empty stroke forgets the picture, but not its use.
    for line in ["begin", "end", "array count=1 step=4,0,0"] {
        session.execute(&line.parse().unwrap(), &()).unwrap();
    }
    assert_eq!(session.document().contents().rgb(glam::UVec3::splat(11)).0, [30, 220, 40]);
    std::fs::remove_file(&path).unwrap();
    session.execute(&Command::Begin { label: String::new() }, &()).unwrap();
    let error = session.execute(&paint.parse().unwrap(), &()).unwrap_err();
    assert!(error.to_string().contains("colour.png"), "{error}");
}

fn execute(session: &mut Session, line: &str) -> Result<Applied, SessionError> {
    session.execute(&line.parse().unwrap(), &())
}

fn ball(voxels: u32) -> Session {
    let new = NewSculpture {
        dims: glam::UVec3::splat(voxels),
        voxel_size: glam::Vec3::ONE,
        colour_depth: ColourDepth::Bits24,
        base: Rgb([128; 3]),
        solid: true,
        room_vx: 0,
        grows: false,
    };
    Session::new(&new, Limits::default()).unwrap()
}

/// Opened and saved files behave alike, however the path is written.
#[test]
fn a_file_that_another_program_has_changed_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let save = format!("save {path:?}");
    execute(&mut ball(16), &save).unwrap();
    let foreign = std::fs::read(&path).unwrap();
    let round_about = folder.path().join(".").join("owl.vsc");

    let import = ImportOptions::default();
    let mut opened = Session::open(&path, &import, Limits::default(), &()).unwrap();
    let mut saved = ball(8);
    execute(&mut saved, &save).unwrap();
    let mine = std::fs::read(&path).unwrap();
    assert_ne!(mine, foreign);
    for save in [save.clone(), format!("save {round_about:?}")] {
        let error = execute(&mut opened, &save).unwrap_err();
        assert!(matches!(&error, SessionError::ChangedOnDisk { .. }), "{error}");
        assert!(error.to_string().contains("another program"), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), mine);
    }
    // The session that wrote it last may continue, and another name is free.
    execute(&mut saved, &save).unwrap();
    execute(&mut saved, &save).unwrap();
    let copy = folder.path().join("copy.vsc");
    execute(&mut opened, &format!("save {copy:?}")).unwrap();
    assert_eq!(std::fs::read(&copy).unwrap(), foreign);

    // One byte differs, and the time is the former one.
    let time = std::fs::metadata(&path).unwrap().modified().unwrap();
    let mut damaged = mine.clone();
    *damaged.last_mut().unwrap() ^= 1;
    std::fs::write(&path, &damaged).unwrap();
    std::fs::File::options().write(true).open(&path).unwrap().set_modified(time).unwrap();
    execute(&mut saved, &save).unwrap_err();
    assert_eq!(std::fs::read(&path).unwrap(), damaged);
    // The same bytes, written again later, are no change.
    std::fs::write(&path, &mine).unwrap();
    execute(&mut saved, &save).unwrap();
}

/// Returns the triangles of an .stl file in a normalised order.
fn triangles_in(path: &Path) -> Vec<Vec<u8>> {
    let bytes = std::fs::read(path).unwrap();
    let mut all: Vec<Vec<u8>> = bytes[84..].chunks(50).map(<[u8]>::to_vec).collect();
    all.sort_unstable();
    all
}

#[test]
fn a_mesh_that_is_written_again_is_that_of_the_sculpture_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let [again, anew] = ["again.stl", "anew.stl"].map(|name| folder.path().join(name));
    let mut session = ball(40);
    session.keep_meshes();
    for (command, kind) in [
        ("subtract ellipsoid at=20,20,38 half=9", "faces"),
        ("add cuboid at=4,4,4 half=2", "faces"),
        ("subtract ellipsoid at=3,20,20 half=6", "smooth"),
        ("undo", "smooth"),
        ("redo", "smooth"),
        ("new dims=24,30,20", "smooth"),
        ("subtract ellipsoid at=3,20,10 half=6", "greedy"),
    ] {
        execute(&mut session, command).unwrap();
        execute(&mut session, &format!("save {again:?} mesh={kind}")).unwrap();
        let export = format!("save {anew:?} mesh={kind}").parse().unwrap();
        let Command::Save { export, .. } = export else { panic!("{export:?}") };
        let contents = session.document().contents();
        let limits = Limits::default();
        crate::format::save_mesh(&anew, contents, &export.mesh, &limits, &()).unwrap();
        assert!(triangles_in(&again) == triangles_in(&anew), "{command} {kind}");
    }
}

#[test]
fn a_change_on_disk_that_is_accepted_is_overwritten_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let save = format!("save {path:?}");
    let mut session = ball(8);
    execute(&mut session, &save).unwrap();
    let mine = std::fs::read(&path).unwrap();
    let refused = |session: &mut Session| match execute(session, &save) {
        Err(SessionError::ChangedOnDisk { found, .. }) => found,
        other => panic!("{other:?}"),
    };
    std::fs::write(&path, "of another program").unwrap();
    let found = refused(&mut session);
    // The file changes once more while the person decides, and again before it is written.
    for change in ["while one thinks", "once more"] {
        session.accept_change_on_disk(&path, found);
        std::fs::write(&path, change).unwrap();
        refused(&mut session);
    }
    let found = refused(&mut session);
    session.accept_change_on_disk(&path, found);
    execute(&mut session, &save).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), mine);
    std::fs::write(&path, "again").unwrap();
    execute(&mut session, &save).unwrap_err();
    // A file that is gone is written again.
    std::fs::remove_file(&path).unwrap();
    execute(&mut session, &save).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), mine);
    // Opening the file again makes it known; undo leads back to the sculpture but not to its old file.
    execute(&mut ball(16), &save).unwrap();
    execute(&mut session, &format!("open {path:?}")).unwrap();
    execute(&mut session, &save).unwrap();
    execute(&mut session, "undo").unwrap();
    assert_eq!(session.path(), None);
}
