//! Tests that recordings replay and overwrite nothing.

use std::fs;

use super::*;
use crate::document::Limits;
use crate::session::Session;

fn session() -> Session {
    let Command::New(new) = "new dims=12,10,8 colour=24".parse().unwrap() else { panic!() };
    Session::new(&new, Limits::default()).unwrap()
}

fn execute(session: &mut Session, line: &str) {
    session.execute(&line.parse().unwrap(), &()).unwrap_or_else(|e| panic!("{line}: {e}"));
}

/// Executes a script as `run` does, over another sculpture.
fn replay(script: &str) -> Session {
    let Command::New(new) = "new dims=3,3,3".parse().unwrap() else { panic!() };
    let mut session = Session::new(&new, Limits::default()).unwrap();
    script.lines().filter(|line| !line.starts_with('#')).for_each(|line| {
        execute(&mut session, line);
    });
    session
}

#[test]
fn a_file_that_holds_something_is_refused_and_stays() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own.vsc");
    execute(&mut session(), &format!("save {own:?}"));
    let sculpture = fs::read(&own).unwrap();
    let error = session().record_to(&own).unwrap_err().to_string();
    assert!(error.contains("own.vsc") && error.contains("is no recording"), "{error}");
    assert_eq!(fs::read(&own).unwrap(), sculpture);

    // A second recording under the same name.
    let path = folder.path().join("first.sculpt");
    let mut first = session();
    first.record_to(&path).unwrap();
    execute(&mut first, "clear");
    let recorded = fs::read(&path).unwrap();
    let error = session().record_to(&path).unwrap_err().to_string();
    assert!(error.contains("holds a recording") && error.contains("another name"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), recorded);
    assert!(matches!(first.record_to(&path), Err(SessionError::JournalLate)));

    // An empty file may be used; a folder may not.
    fs::write(folder.path().join("empty"), "").unwrap();
    session().record_to(&folder.path().join("empty")).unwrap();
    assert!(session().record_to(folder.path()).is_err());
}

#[test]
fn a_replay_begins_with_the_same_sculpture_and_writes_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let [start, saved, script] =
        ["start.vsc", "saved.vsc", "made.sculpt"].map(|name| folder.path().join(name));
    execute(&mut session(), &format!("save {start:?}"));
    let limits = Limits::default();
    let mut opened = Session::open(&start, &Default::default(), limits, &()).unwrap();
    opened.record_to(&script).unwrap();
    execute(&mut opened, "subtract cuboid at=4,4,4 half=2");
    execute(&mut opened, &format!("save {saved:?}"));
    execute(&mut opened, "subtract cuboid at=8,4,4 half=2");
    // More steps than there are: a replay has one more, the opening.
    execute(&mut opened, "undo all");
    execute(&mut opened, "undo all");
    execute(&mut opened, "redo 1");
    let text = fs::read_to_string(&script).unwrap();
    let embedding = format!("embed {start:?} data=");
    assert!(text.lines().nth(1).is_some_and(|line| line.starts_with(&embedding)), "{text}");
    let opening = format!("open {start:?}");
    assert_eq!(text.lines().nth(2), Some(opening.as_str()), "{text}");
    fs::remove_file(&start).unwrap();
    assert!(text.contains(&format!("# save {saved:?}")), "{text}");
    fs::write(&saved, "another's work").unwrap();
    let again = replay(&text);
    assert_eq!(again.document().contents(), opened.document().contents());
    assert_eq!(fs::read(&saved).unwrap(), b"another's work");
}

#[test]
fn images_are_embedded_as_they_were_and_needed_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let [picture, script] = ["p.png", "made.sculpt"].map(|name| folder.path().join(name));
    let paint = |rgb: [u8; 3]| {
        image::RgbImage::from_pixel(2, 2, image::Rgb(rgb)).save(&picture).unwrap();
    };
    let mut made = session();
    made.record_to(&script).unwrap();
    let texture = format!("texture {picture:?} cuboid at=4,4,4 half=3");
    for rgb in [[200, 10, 20], [200, 10, 20], [30, 220, 40]] {
        paint(rgb);
        for line in ["begin", &texture, "end", "array count=1 step=3,0,0"] {
            execute(&mut made, line);
        }
    }
    let text = fs::read_to_string(&script).unwrap();
    assert_eq!(text.matches("embed ").count(), 2, "the same image is embedded once: {text}");
    drop(folder);
    let again = replay(&text);
    assert_eq!(again.document().contents(), made.document().contents());
    // A recording of the replay is the same script except for its beginning.
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("copy.sculpt");
    let mut second = session();
    second.record_to(&copy).unwrap();
    text.lines().skip(2).for_each(|line| execute(&mut second, line));
    let copied = replay(&fs::read_to_string(&copy).unwrap());
    assert_eq!(copied.document().contents(), made.document().contents());
}

#[test]
fn embedded_data_must_be_a_sculpture_or_an_image() {
    let mut session = session();
    execute(&mut session, "embed \"a.vsc\" data=AAAA");
    let error = session.execute(&"open \"a.vsc\"".parse().unwrap(), &()).unwrap_err();
    assert!(error.to_string().contains("a.vsc"), "{error}");
    let line = "texture \"a.vsc\" cuboid at=4,4,4 half=3";
    let error = session.execute(&line.parse().unwrap(), &()).unwrap_err();
    assert!(error.to_string().contains("a.vsc"), "{error}");
    assert!("embed \"a\" data=?".parse::<Command>().is_err());
    assert!("embed \"a\"".parse::<Command>().is_err());
}

#[test]
fn undo_past_orientations_is_recorded_and_replays() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("made.sculpt");
    let mut made = session();
    made.record_to(&script).unwrap();
    let lines = [
        "recolour cuboid at=4,4,4 half=3 colour=#2040ff",
        "orient upright=z",
        "subtract cuboid at=4,4,4 half=2",
        "orient axes=-x,y,z",
        "orient axes=y,z,x",
        "clear",
    ];
    let mut states = vec![made.document().contents().clone()];
    for line in lines {
        execute(&mut made, line);
        states.push(made.document().contents().clone());
    }
    // In either direction, and wherever it ends.
    for (line, at) in [
        ("undo 2", 4),
        ("undo 3", 1),
        ("redo 4", 5),
        ("undo all", 0),
        ("undo all", 0),
        ("redo all", 6),
        ("undo 5", 1),
    ] {
        let before = made.document().history().undo_count();
        let applied = made.execute(&line.parse().unwrap(), &()).unwrap();
        assert_eq!(applied.steps as usize, before.abs_diff(at), "{line}");
        assert_eq!(made.document().contents(), &states[at], "{line}");
    }
    let again = replay(&fs::read_to_string(&script).unwrap());
    assert_eq!(again.document().contents(), made.document().contents());
}

#[test]
fn the_first_sculpture_of_a_session_without_a_file_is_recorded_too() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("made.sculpt");
    let mut made = session();
    made.record_to(&script).unwrap();
    execute(&mut made, "subtract cuboid at=4,4,4 half=2");
    let again = replay(&fs::read_to_string(&script).unwrap());
    assert_eq!(again.document().contents(), made.document().contents());
}

/// A pipe whose reader is gone accepts no more data, like a full disk.
#[cfg(unix)]
#[test]
fn a_recording_that_cannot_be_written_stops_no_work() {
    use std::io::{BufRead, BufReader};

    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reading = pipe.clone();
    let reader = std::thread::spawn(move || {
        // Reads until the beginning has arrived.
        let mut lines = BufReader::new(File::open(&reading).unwrap()).lines();
        lines.by_ref().take(2).collect::<Result<Vec<String>, _>>().unwrap()
    });
    let mut session = session();
    session.record_to(&pipe).unwrap();
    assert!(reader.join().unwrap()[0].starts_with(TITLE));
    for line in ["begin", "subtract cuboid at=4,4,4 half=2", "end", "clear"] {
        execute(&mut session, line);
    }
    assert!(!session.document().stroke_open());
    assert_eq!(session.document().history().undo_count(), 2);
    let error = session.take_journal_error().unwrap().to_string();
    assert!(error.contains("pipe"), "{error}");
    assert!(session.take_journal_error().is_none(), "it is said once");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_at_the_start_is_said() {
    let error = session().record_to(Path::new("/dev/full")).unwrap_err().to_string();
    assert!(error.contains("/dev/full") && error.contains("space"), "{error}");
}

#[test]
fn an_array_of_what_was_used_since_a_checkpoint_needs_no_other_one() {
    let ray = "eye=6,40,4 aim=0,-1,0 across=0.1,0,0 down=0,0,0.1 radius=2";
    let uses = [
        "subtract ellipsoid at=4,8,4 half=2",
        "add ring at=6,5,4 radius=3 tube=1",
        "texture \"p.png\" cuboid at=4,8,4 half=3",
        &format!("stencil \"p.png\" {ray}"),
        &format!("spray devourer {ray} reach=2"),
        "grab at=5,8,4 radius=3 by=0,-2,0",
        "deform twist at=5,8,4 radius=3 normal=0,1,0 angle=40",
        "deform inflate at=5,8,4 radius=3 height=-2",
        "paste at=3,3,3",
    ];
    for used in uses {
        for stroke in [false, true] {
            let folder = tempfile::tempdir().unwrap();
            let script = folder.path().join("made.sculpt");
            let mut first = session();
            first.record_to(&script).unwrap();
            let mut made = session();
            let picture = image::RgbImage::from_pixel(2, 2, image::Rgb([9, 8, 7]));
            let mut png = std::io::Cursor::new(Vec::new());
            picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
            execute(&mut made, "fill");
            let embed = Command::Embed { path: "p.png".into(), file: png.into_inner().into() };
            made.execute(&embed, &()).unwrap();
            execute(&mut made, "copy");
            execute(&mut made, "subtract cuboid at=4,9,4 half=2");
            // Writes a checkpoint. Its replay does not know the cuboid to repeat.
            made.continue_recording(&mut first);
            let checkpoints = || {
                let text = fs::read_to_string(&script).unwrap();
                text.lines().filter(|line| line.starts_with("open ")).count()
            };
            let before = checkpoints();
            let mut lines = vec![used, "array count=2 step=1,0,1"];
            if stroke {
                lines.insert(0, "begin");
                lines.insert(2, "end");
            }
            lines.iter().for_each(|line| execute(&mut made, line));
            assert_eq!(checkpoints(), before, "{used}");
            let again = replay(&fs::read_to_string(&script).unwrap());
            assert_eq!(again.document().contents(), made.document().contents(), "{used}");
        }
    }
}
