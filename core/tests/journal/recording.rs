//! A recording always replays: whatever was done or refused, whichever files are missing by then, and even if the
//! session continued after a crash. Replaying writes no file.

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use sculpture_core::command::Command;
use sculpture_core::document::Limits;
use sculpture_core::persist::journal::AbandonedJournal;
use sculpture_core::session::{Session, recover};

use super::memory::Memory;
use super::{all_of, options};
use crate::commands::strategies::{area_work, canvas_change, new_sculpture, primitive, work};

/// An event in a session that records.
#[derive(Clone, Debug)]
enum Event {
    Execute(Command),
    /// One of two files is opened.
    Open(bool),
    /// Saved as one of these two files, which changes what the next opening finds.
    Save(bool),
    /// The image is replaced by another one.
    Repaint([u8; 3]),
    /// The session is killed, recovered, and the recording continues.
    Killed,
}

fn event(folder: PathBuf) -> impl Strategy<Value = Event> {
    let texture = primitive(-4.0..28.0, 2.0..14.0).prop_map(move |primitive| {
        Event::Execute(Command::Texture { primitive, picture: folder.join("picture.png") })
    });
    let stroke = prop_oneof![Just(Command::Begin { label: String::new() }), Just(Command::End),];
    prop_oneof![
        10 => work().prop_map(Event::Execute),
        6 => area_work().prop_map(Event::Execute),
        2 => canvas_change(0u32..9).prop_map(|change| Event::Execute(Command::Canvas(change))),
        4 => texture,
        4 => stroke.prop_map(Event::Execute),
        2 => any::<bool>().prop_map(Event::Open),
        1 => any::<bool>().prop_map(Event::Save),
        1 => any::<[u8; 3]>().prop_map(Event::Repaint),
        1 => Just(Event::Killed),
    ]
}

fn repaint(folder: &Path, [r, g, b]: [u8; 3]) {
    let picture = image::RgbImage::from_fn(3, 2, |x, y| {
        image::Rgb([r ^ (x * 90) as u8, g ^ (y * 70) as u8, b])
    });
    picture.save(folder.join("picture.png")).unwrap();
}

fn file(folder: &Path, first: bool) -> PathBuf {
    folder.join(if first { "first.vsc" } else { "second.vsc" })
}

/// Returns the session after it was killed and recovered.
fn killed(session: &mut Session, memory: &Memory) -> (Session, Memory) {
    session.wait_for_journal();
    let left = memory.left(false);
    let AbandonedJournal::Journal(source) = options(&left).journal_dir.open(1) else { panic!() };
    let again = recover(source, &Limits::default(), None, &()).unwrap();
    assert_eq!(again.report.difference, None);
    let mut again = again.session;
    again.continue_recording(session);
    let memory = Memory::default();
    again.keep_journal(options(&memory)).unwrap();
    (again, memory)
}

fn replay(script: &str) -> Session {
    let Command::New(new) = "new dims=3,3,3".parse().unwrap() else { panic!() };
    let mut session = Session::new(&new, Limits::default()).unwrap();
    for (i, line) in script.lines().enumerate().filter(|(_, line)| !line.starts_with('#')) {
        let command = line.parse().unwrap();
        session.execute(&command, &()).unwrap_or_else(|e| panic!("line {i}: {e}: {script}"));
    }
    session
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn whatever_was_recorded_replays_without_the_files(
        new in new_sculpture(20),
        begins_with_file in any::<bool>(),
        events in prop::collection::vec(event(PathBuf::from("/FOLDER")), 1..40),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let at = &folder.path().to_path_buf();
        repaint(at, [200, 10, 20]);
        let limits = Limits::default();
        let mut session = Session::new(&new, limits).unwrap();
        for first in [true, false] {
            let command = format!("save {:?}", file(at, first));
            session.execute(&command.parse().unwrap(), &()).unwrap();
            session.execute(&"subtract ellipsoid at=5,5,5 half=4".parse().unwrap(), &()).unwrap();
        }
        let mut session = match begins_with_file {
            true => Session::open(&file(at, true), &Default::default(), limits, &()).unwrap(),
            false => Session::new(&new, limits).unwrap(),
        };
        let script = at.join("made.sculpt");
        session.record_to(&script).unwrap();
        let mut memory = Memory::default();
        session.keep_journal(options(&memory)).unwrap();
        for event in events {
            match event {
                Event::Execute(Command::Texture { primitive, .. }) => {
                    let picture = at.join("picture.png");
                    let _ = session.execute(&Command::Texture { primitive, picture }, &());
                }
                Event::Execute(command) => drop(session.execute(&command, &())),
                Event::Open(first) => {
                    let command = format!("open {:?}", file(at, first));
                    let _ = session.execute(&command.parse().unwrap(), &());
                }
                Event::Save(first) => {
                    let command = format!("save {:?}", file(at, first));
                    session.execute(&command.parse().unwrap(), &()).unwrap();
                }
                Event::Repaint(rgb) => repaint(at, rgb),
                Event::Killed => (session, memory) = killed(&mut session, &memory),
            }
        }
        // Without an end, an open stroke is in the script as far as it went.
        let _ = session.execute(&Command::End, &());
        prop_assert!(session.take_journal_error().is_none());
        let script = fs::read_to_string(&script).unwrap();
        drop(folder);
        let again = replay(&script);
        prop_assert!(!at.exists(), "a replay writes no file");
        let (again, made) = (all_of(&again), all_of(&session));
        prop_assert!(again.contents == made.contents, "{script}");
        prop_assert_eq!(&again.settings, &made.settings);
        prop_assert_eq!(&again.clip, &made.clip);
    }
}

/// The journal was begun anew after a stroke that did not use the image: it must hold the image nevertheless.
#[test]
fn an_image_from_before_a_checkpoint_is_kept_again() {
    let folder = tempfile::tempdir().unwrap();
    repaint(folder.path(), [9, 99, 199]);
    let line = format!("texture {:?} cuboid at=4,4,4 half=3", folder.path().join("picture.png"));
    let memory = Memory::default();
    let mut session = super::session(Limits::default());
    for line in [&line, "begin", "end"] {
        session.execute(&line.parse().unwrap(), &()).unwrap();
    }
    session.keep_journal(options(&memory)).unwrap();
    session.execute(&line.parse().unwrap(), &()).unwrap();
    session.wait_for_journal();
    let AbandonedJournal::Journal(source) = options(&memory.left(false)).journal_dir.open(1) else {
        panic!()
    };
    let again = recover(source, &Limits::default(), None, &()).unwrap();
    assert_eq!(again.report.difference, None);
    assert!(again.session.document().contents() == session.document().contents());
}
