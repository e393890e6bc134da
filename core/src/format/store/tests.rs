//! Tests reading and writing: refused paths, replaced files, left-over files.

use super::*;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn writing_replaces_and_leaves_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pvm");
    write_atomically(&path, b"old").unwrap();
    write_atomically(&path, b"newer").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"newer");
    assert_eq!(names(folder.path()), ["a.pvm"]);
}

#[test]
fn a_failure_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    // A folder blocks the new name.
    let path = folder.path().join("taken.pvm");
    fs::create_dir(&path).unwrap();
    fs::write(path.join("inside"), b"kept").unwrap();
    assert!(write_atomically(&path, b"new").is_err());
    assert_eq!(fs::read(path.join("inside")).unwrap(), b"kept");
    assert_eq!(names(folder.path()), ["taken.pvm"]);
    assert!(write_atomically(&folder.path().join("missing/a.pvm"), b"new").is_err());
}

#[cfg(unix)]
#[test]
fn permissions_and_links_are_kept() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let (path, link) = (folder.path().join("a.pvm"), folder.path().join("link.pvm"));
    write_atomically(&path, b"old").unwrap();
    assert_ne!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    symlink(&path, &link).unwrap();
    write_atomically(&link, b"new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_gets_its_file_and_a_ring_of_links_is_refused() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("there")).unwrap();
    symlink("there/a.vsc", at("second")).unwrap();
    symlink(at("second"), at("first")).unwrap();
    write_atomically(&at("first"), b"made").unwrap();
    assert_eq!(fs::read(at("there/a.vsc")).unwrap(), b"made");
    assert!(fs::symlink_metadata(at("first")).unwrap().is_symlink());
    assert!(fs::symlink_metadata(at("second")).unwrap().is_symlink());
    symlink("missing/a.vsc", at("lost")).unwrap();
    let error = write_atomically(&at("lost"), b"made").unwrap_err().to_string();
    assert!(error.contains("no folder") && error.contains("missing"), "{error}");
    symlink(at("ring"), at("ring")).unwrap();
    assert!(write_atomically(&at("ring"), b"made").is_err());
    assert!(fs::symlink_metadata(at("ring")).unwrap().is_symlink());
}

#[test]
fn a_protected_file_is_not_replaced_and_no_temporary_name_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    write_atomically(&path, b"old").unwrap();
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    let error = write_atomically(&path, b"new").unwrap_err().to_string();
    assert!(error.contains("write-protected"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["a.vsc"]);
    for nowhere in ["missing/a.vsc", "a.vsc/b.vsc"] {
        let error = write_atomically(&folder.path().join(nowhere), b"new").unwrap_err();
        assert!(error.to_string().contains("folder"), "{error}");
        assert!(!error.to_string().contains(UNFINISHED[0]), "{error}");
    }
    #[cfg(target_os = "linux")]
    {
        let error = write_atomically(Path::new("/proc/a.vsc"), b"new").unwrap_err().to_string();
        assert!(error.contains("/proc") && !error.contains(UNFINISHED[0]), "{error}");
    }
}

#[test]
fn files_left_by_killed_programs_are_removed_and_files_being_written_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at(".virtual-sculpture-abc123.part"), b"half").unwrap();
    fs::write(at("other.part"), b"not ours").unwrap();
    let busy = File::create(at(".virtual-sculpture-def456.part")).unwrap();
    busy.try_lock().unwrap();
    (&busy).write_all(b"half").unwrap();
    write_atomically(&at("a.vsc"), b"whole").unwrap();
    assert_eq!(names(folder.path()), [".virtual-sculpture-def456.part", "a.vsc", "other.part"]);
}

#[test]
fn empty_files_of_killed_programs_go_and_those_just_made_stay() {
    let folder = tempfile::tempdir().unwrap();
    let made = |name: &str, age_s: u64, locked: bool| {
        let file = File::create(folder.path().join(name)).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(age_s)).unwrap();
        if locked {
            file.try_lock().unwrap();
        }
        file
    };
    drop(made(".virtual-sculpture-killed.part", 3600, false));
    drop(made(".virtual-sculpture-begun.part", 0, false));
    let _busy = made(".virtual-sculpture-waits.part", 3600, true);
    drop(made("empty.part", 3600, false));
    write_atomically(&folder.path().join("a.vsc"), b"whole").unwrap();
    let left = names(folder.path());
    assert_eq!(
        left,
        [".virtual-sculpture-begun.part", ".virtual-sculpture-waits.part", "a.vsc", "empty.part"]
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_pipe_and_an_endless_text_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.pvm");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    assert!(matches!(read(&pipe, 1 << 20, |_| Ok(()), &()), Err(FormatError::NotAFile)));
    let error = read_text_within(Path::new("/dev/zero"), 5 << 20).unwrap_err().to_string();
    assert!(error.contains("5 MiB"), "{error}");
}

#[test]
fn reading_is_bounded_and_refuses_folders() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.raw");
    write_atomically(&path, &[7; 2 << 20]).unwrap();
    assert_eq!(read(&path, 2 << 20, |_| Ok(()), &()).unwrap().len(), 2 << 20);
    let refused = read(&path, 1 << 20, |_| Ok(()), &());
    let Err(FormatError::OverBudget(over)) = refused else { panic!("{refused:?}") };
    assert_eq!((over.needed_mib, over.budget_mib), (2, 1));
    assert!(matches!(read(folder.path(), 1, |_| Ok(()), &()), Err(FormatError::NotAFile)));
}

#[test]
fn a_file_written_in_pieces_appears_when_it_is_finished_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.y4m");
    fs::write(&path, "old").unwrap();
    let begun = || {
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"first, ").unwrap();
        file.write_all(b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()).len(), 2);
        file
    };
    drop(begun());
    assert_eq!(names(folder.path()), ["a.y4m"]);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    begun().finish().unwrap();
    assert_eq!(names(folder.path()), ["a.y4m"]);
    assert_eq!(fs::read(&path).unwrap(), b"first, second");
    assert!(AtomicFile::create(&folder.path().join("none/a.y4m")).is_err());
}
