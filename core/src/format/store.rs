//! Owns the way to and from the disk: reading within a bound, and writing such that a crash or a
//! full disk leaves the old file as it was.
//!
//! Knows no format.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use super::pvm::check_budget;
use super::{FormatError, go_on};
use crate::progress::Progress;

/// So much is read or written between two words about how far it is.
const PORTION_BYTES: u64 = 4 << 20;

/// Reads a whole file of at most `budget_bytes`. `admit` sees its length before memory is taken.
pub(super) fn read(
    path: &Path,
    budget_bytes: u64,
    admit: impl Fn(u64) -> Result<(), FormatError>,
    progress: &dyn Progress,
) -> Result<Vec<u8>, FormatError> {
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    if !metadata.is_file() {
        return Err(FormatError::NotAFile);
    }
    if metadata.len() == 0 {
        return Err(FormatError::Empty);
    }
    admit(metadata.len())?;
    check_budget(metadata.len(), budget_bytes)?;
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    progress.begin("reading");
    // A file that grows meanwhile does not take more.
    let mut file = file.take(budget_bytes);
    while (&mut file).take(PORTION_BYTES).read_to_end(&mut bytes)? > 0 {
        progress.advance(bytes.len() as f32 / metadata.len() as f32);
        go_on(progress)?;
    }
    progress.end();
    Ok(bytes)
}

/// Writes a file so that at any time either the old or the new one is there, whole: to a
/// temporary name in the same folder, synced, renamed, and the folder synced. Permissions of an
/// old file are kept; where `path` is a symbolic link, the file it leads to is replaced.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    write_with(path, bytes, &())
}

/// [`write_atomically`], saying how far it is. It cannot be stopped.
pub(super) fn write_with(
    path: &Path,
    bytes: &[u8],
    progress: &dyn Progress,
) -> std::io::Result<()> {
    let target = match fs::canonicalize(path) {
        Ok(target) => target,
        // Nothing there yet.
        Err(error) if error.kind() == ErrorKind::NotFound => path.to_path_buf(),
        Err(error) => return Err(error),
    };
    let old = fs::metadata(&target).ok();
    if old.as_ref().is_some_and(|m| !m.is_file()) {
        let message = "there is a folder or a device of that name; choose another";
        return Err(Error::new(ErrorKind::AlreadyExists, message));
    }
    let folder = match target.parent() {
        Some(parent) if parent != Path::new("") => parent.to_path_buf(),
        _ => PathBuf::from("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".virtual-sculpture-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any new file; the process's mask is taken off.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(&folder)?;
    let mut written = 0;
    for portion in bytes.chunks(PORTION_BYTES as usize) {
        file.write_all(portion)?;
        written += portion.len();
        progress.advance(written as f32 / bytes.len() as f32);
    }
    if let Some(old) = old {
        file.as_file().set_permissions(old.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(&target).map_err(|error| error.error)?;
    // Only now is the new name sure to survive a crash. Other systems cannot sync folders.
    #[cfg(unix)]
    File::open(&folder)?.sync_all()?;
    Ok(())
}

#[cfg(test)]
mod tests {
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
        // A folder in the way of the new name.
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

    #[test]
    fn reading_is_bounded_and_refuses_folders() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.raw");
        write_atomically(&path, &[7; 2 << 20]).unwrap();
        assert_eq!(read(&path, 2 << 20, |_| Ok(()), &()).unwrap().len(), 2 << 20);
        assert!(matches!(
            read(&path, 1 << 20, |_| Ok(()), &()),
            Err(FormatError::Memory { needed_mib: 2, budget_mib: 1 })
        ));
        assert!(matches!(read(folder.path(), 1, |_| Ok(()), &()), Err(FormatError::NotAFile)));
    }
}
