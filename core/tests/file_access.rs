//! Tests two sessions with the same file: which of them may save it, and when.

use std::path::Path;

use sculpture_core::command::Command;
use sculpture_core::document::Limits;
use sculpture_core::session::{FileAccess, Session, SessionError};

use crate::journal::memory::Memory;
use crate::journal::{options, recovered};

/// Returns a session that locks its files, with a full sculpture of 16 voxels an edge.
fn session() -> Session {
    let Command::New(new) = "new dims=16,16,16".parse().unwrap() else { panic!() };
    let mut session = Session::new(&new, Limits::default()).unwrap();
    session.set_file_access(FileAccess::Locked);
    session
}

fn execute(session: &mut Session, line: &str) -> Result<(), SessionError> {
    session.execute(&line.parse().unwrap(), &()).map(|_| ())
}

fn is_locked(path: &Path) -> bool {
    let name = format!(".{}.lock", path.file_name().unwrap().to_string_lossy());
    path.with_file_name(name).exists()
}

#[test]
fn a_second_session_learns_who_has_the_file_and_cannot_save_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let mut first = session();
    execute(&mut first, &format!("save {path:?}")).unwrap();
    assert!(is_locked(&path) && first.take_foreign_holder().is_none());
    let bytes = std::fs::read(&path).unwrap();

    let mut second = session();
    execute(&mut second, &format!("open {path:?}")).unwrap();
    let holder = second.take_foreign_holder().expect("the first has it");
    assert_eq!(holder.process, Some(std::process::id()));
    assert!(second.take_foreign_holder().is_none(), "said once");
    execute(&mut second, "subtract cuboid at=8,8,8 half=2").unwrap();
    let refused = execute(&mut second, &format!("save {path:?}")).unwrap_err();
    assert!(matches!(refused, SessionError::InUse { .. }));
    let message = refused.to_string();
    assert!(message.contains("owl.vsc") && message.contains("another name"), "{message}");
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    // Neither can a session that locks nothing, or one that has never read the file.
    let mut third = session();
    third.set_file_access(FileAccess::Brief);
    assert!(execute(&mut third, &format!("save {path:?}")).is_err());
    // A volume for other programs has no lock.
    execute(&mut second, &format!("save {:?}", folder.path().join("owl.pvm"))).unwrap();

    // The first continues, and the second takes over once it is gone.
    execute(&mut first, &format!("save {path:?}")).unwrap();
    drop(first);
    assert!(!is_locked(&path));
    execute(&mut second, &format!("save {path:?}")).unwrap();
    assert!(is_locked(&path) && !second.modified());
    drop(second);
    assert!(!is_locked(&path));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "nothing else is left");
}

#[test]
fn the_lock_goes_with_the_sculpture() {
    let folder = tempfile::tempdir().unwrap();
    let [owl, cat] = ["owl.vsc", "cat.vsc"].map(|name| folder.path().join(name));
    let mut session = session();
    execute(&mut session, &format!("save {owl:?}")).unwrap();
    execute(&mut session, &format!("save {cat:?}")).unwrap();
    assert!(!is_locked(&owl) && is_locked(&cat), "save as");
    execute(&mut session, &format!("open {owl:?}")).unwrap();
    assert!(is_locked(&owl) && !is_locked(&cat), "open");
    execute(&mut session, &format!("open {owl:?}")).unwrap();
    assert!(is_locked(&owl) && session.take_foreign_holder().is_none(), "open once more");
    execute(&mut session, "undo 2").unwrap();
    assert!(!is_locked(&owl) && is_locked(&cat), "undo");
    execute(&mut session, "redo 1").unwrap();
    assert!(is_locked(&owl) && !is_locked(&cat), "redo");
    execute(&mut session, "new dims=8,8,8").unwrap();
    assert!(!is_locked(&owl) && !is_locked(&cat), "new");
    execute(&mut session, "undo 1").unwrap();
    session.set_file_access(FileAccess::Brief);
    assert!(!is_locked(&owl));
}

#[test]
fn a_file_that_is_read_only_is_saved_under_another_name() {
    let folder = tempfile::tempdir().unwrap();
    let [owl, cat] = ["owl.vsc", "cat.vsc"].map(|name| folder.path().join(name));
    let mut first = session();
    execute(&mut first, &format!("save {owl:?}")).unwrap();
    let bytes = std::fs::read(&owl).unwrap();

    let mut reader = session();
    reader.set_file_access(FileAccess::ReadOnly);
    assert!(!reader.is_read_only(), "it has no file");
    execute(&mut reader, &format!("open {owl:?}")).unwrap();
    assert!(reader.is_read_only() && reader.take_foreign_holder().is_none());
    drop(first);
    execute(&mut reader, "subtract cuboid at=8,8,8 half=2").unwrap();
    let refused = execute(&mut reader, &format!("save {owl:?}")).unwrap_err();
    assert!(matches!(refused, SessionError::ReadOnly { .. }), "{refused}");
    assert_eq!(std::fs::read(&owl).unwrap(), bytes);
    execute(&mut reader, &format!("save {cat:?}")).unwrap();
    assert!(!reader.is_read_only() && !reader.modified() && !is_locked(&cat));
    execute(&mut reader, "subtract cuboid at=4,8,8 half=1").unwrap();
    execute(&mut reader, &format!("save {cat:?}")).unwrap();
}

#[test]
fn a_copy_has_no_file_and_a_journal_knows_that() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let mut first = session();
    execute(&mut first, &format!("save {path:?}")).unwrap();
    let memory = Memory::default();
    let mut second = session();
    second.keep_journal(options(&memory)).unwrap();
    execute(&mut second, &format!("open {path:?}")).unwrap();
    assert!(second.take_foreign_holder().is_some());
    second.become_copy();
    assert!(second.path().is_none() && second.modified() && !second.is_read_only());
    second.sync_journal();
    drop(second);
    let again = recovered(&memory).expect("the copy is not saved").session;
    assert!(again.path().is_none() && again.modified());
    assert_eq!(again.document().contents(), first.document().contents());
}
