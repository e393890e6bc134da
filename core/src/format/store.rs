//! Disk access: bounded reading, and atomic writing, so that a crash or a full disk leaves the old file intact.
//!
//! Knows no format.

use std::fs::{self, File, OpenOptions};
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use tempfile::NamedTempFile;

use super::budget::check_budget;
use super::{FormatError, go_on};
use crate::progress::Progress;

/// Number of bytes read or written between two reports of progress.
const PORTION_BYTES: u64 = 4 << 20;
/// Greatest size of a text in bytes.
const TEXT_LIMIT_BYTES: u64 = 512 << 20;
/// Prefix and suffix of temporary files.
const UNFINISHED: [&str; 2] = [".virtual-sculpture-", ".part"];
/// Time within which a living program locks a file that it has created.
const LOCKED_WITHIN: Duration = Duration::from_secs(60);
/// Longest chain of symbolic links that is followed, as on Linux.
const LINKS: usize = 40;

/// Opens a file for reading. Anything but a regular file, such as a pipe without a writer, is refused before it is
/// opened.
pub(super) fn open(path: &Path) -> std::result::Result<File, FormatError> {
    if !fs::metadata(path)?.is_file() {
        return Err(FormatError::NotAFile);
    }
    Ok(File::open(path)?)
}

/// Reads a whole file of at most `budget_bytes`. `admit` gets its length before memory is allocated.
pub(super) fn read(
    path: &Path,
    budget_bytes: u64,
    admit: impl Fn(u64) -> std::result::Result<(), FormatError>,
    progress: &dyn Progress,
) -> std::result::Result<Vec<u8>, FormatError> {
    let file = open(path)?;
    let length = file.metadata()?.len();
    if length == 0 {
        return Err(FormatError::Empty);
    }
    admit(length)?;
    check_budget(length, budget_bytes)?;
    let mut bytes = Vec::with_capacity(length as usize);
    progress.begin("reading");
    // A file that grows during reading does not take more.
    let mut file = file.take(budget_bytes);
    while (&mut file).take(PORTION_BYTES).read_to_end(&mut bytes)? > 0 {
        progress.advance(bytes.len() as f32 / length as f32);
        go_on(progress)?;
    }
    progress.end();
    Ok(bytes)
}

/// Reads a text, such as a script, from a file or a pipe, up to a limit.
pub fn read_text(path: &Path) -> Result<String> {
    read_text_within(path, TEXT_LIMIT_BYTES)
}

fn read_text_within(path: &Path, limit_bytes: u64) -> Result<String> {
    let mut text = String::new();
    let read = File::open(path)?.take(limit_bytes + 1).read_to_string(&mut text)? as u64;
    if read > limit_bytes {
        let limit_mib = limit_bytes >> 20;
        let message = format!("it is longer than the {limit_mib} MiB that a text may have");
        return Err(Error::new(ErrorKind::FileTooLarge, message));
    }
    Ok(text)
}

/// Writes a file so that at any time either the old or the new one exists completely: to a temporary name in the same
/// folder, synced, renamed, and the folder synced. Permissions of an old file are kept, and a file without write
/// permission is not replaced. If `path` is a symbolic link, the file to which it leads is replaced, or created.
/// Unfinished files of killed programs are removed from the folder.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    write_with(path, bytes, &())
}

/// Writes as [`write_atomically`] does, with progress. Cannot be cancelled.
pub(super) fn write_with(path: &Path, bytes: &[u8], progress: &dyn Progress) -> Result<()> {
    let mut file = AtomicFile::create(path)?;
    let mut written = 0;
    for portion in bytes.chunks(PORTION_BYTES as usize) {
        file.write_all(portion)?;
        written += portion.len();
        progress.advance(written as f32 / bytes.len() as f32);
    }
    file.finish()
}

/// A file that is written piece by piece and appears under its name when it is finished, as in [`write_atomically`]. If
/// dropped before, it leaves nothing behind and the old file unchanged.
#[derive(Debug)]
pub struct AtomicFile {
    temporary: NamedTempFile,
    folder: PathBuf,
    target: PathBuf,
    old: Option<fs::Metadata>,
}

impl AtomicFile {
    /// Creates the temporary file of `path`.
    pub fn create(path: &Path) -> Result<AtomicFile> {
        let target = followed(path)?;
        let old = replaceable(&target)?;
        let folder = match target.parent() {
            Some(parent) if parent != Path::new("") => parent.to_path_buf(),
            _ => PathBuf::from("."),
        };
        let temporary = unfinished_in(&folder)?;
        // A lock distinguishes a file that is being written from an abandoned one. Where there are no locks, none is
        // taken for abandoned.
        let _ = temporary.as_file().try_lock();
        Ok(AtomicFile { temporary, folder, target, old })
    }

    /// Gives the file its name.
    pub fn finish(self) -> Result<()> {
        let AtomicFile { temporary, folder, target, old } = self;
        let file = temporary.as_file();
        if let Some(old) = old {
            file.set_permissions(old.permissions())?;
        }
        file.sync_all().map_err(explained)?;
        rename(temporary, &target)?;
        // Only now is the new name certain to survive a crash. Other systems cannot sync folders.
        #[cfg(unix)]
        File::open(&folder)?.sync_all()?;
        remove_abandoned(&folder, fs::metadata(&target).and_then(|new| new.modified()).ok());
        Ok(())
    }
}

/// Writes to the file itself, since errors of the named one contain the temporary name.
impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.temporary.as_file_mut().write(bytes).map_err(explained)
    }

    fn flush(&mut self) -> Result<()> {
        self.temporary.as_file_mut().flush().map_err(explained)
    }
}

/// For formats that store lengths before the data.
impl Seek for AtomicFile {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        self.temporary.as_file_mut().seek(to)
    }
}

/// Returns the error of a disk with a remedy.
pub(crate) fn explained(error: Error) -> Error {
    let message = match error.kind() {
        ErrorKind::StorageFull => {
            "no space is left on the disk; make room there, or choose another"
        }
        ErrorKind::QuotaExceeded => {
            "your quota of the disk is used up; make room, or choose another"
        }
        ErrorKind::FileTooLarge => "the disk takes no file that is so large; choose another",
        ErrorKind::ReadOnlyFilesystem => "the disk is write-protected; choose another",
        _ => return error,
    };
    Error::new(error.kind(), message)
}

/// Returns the file to which `path` resolves, which need not exist.
fn followed(path: &Path) -> Result<PathBuf> {
    let mut path = path.to_path_buf();
    for _ in 0..LINKS {
        match fs::canonicalize(&path) {
            Err(error)
                if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {}
            found => return found,
        }
        // The path does not exist, or the link is broken.
        let Ok(next) = fs::read_link(&path) else { return Ok(path) };
        path = path.parent().unwrap_or(Path::new("")).join(next);
    }
    Err(Error::other("the link leads to itself"))
}

/// Returns the metadata of the file at `target`, if it exists; an error if it must not be replaced.
fn replaceable(target: &Path) -> Result<Option<fs::Metadata>> {
    let Ok(old) = fs::metadata(target) else { return Ok(None) };
    if !old.is_file() {
        let message = "there is a folder or a device of that name; choose another";
        return Err(Error::new(ErrorKind::AlreadyExists, message));
    }
    // A rename needs only the folder's permission, but write protection of a file is meant for the file.
    let protected = || {
        let message = "the file is write-protected; choose another name, or allow writing to it";
        Error::new(ErrorKind::PermissionDenied, message)
    };
    if old.permissions().readonly() {
        return Err(protected());
    }
    #[cfg(unix)]
    if let Err(error) = OpenOptions::new().write(true).open(target) {
        return Err(match error.kind() {
            ErrorKind::PermissionDenied => protected(),
            _ => explained(error),
        });
    }
    Ok(Some(old))
}

fn unfinished_in(folder: &Path) -> Result<NamedTempFile> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create_new(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        // As for any new file; the process's umask applies.
        options.mode(0o666);
    }
    let [prefix, suffix] = UNFINISHED;
    let mut builder = tempfile::Builder::new();
    let made = builder.prefix(prefix).suffix(suffix).make_in(folder, |path| options.open(path));
    made.map_err(|error| {
        let folder = folder.display();
        let message = match error.kind() {
            ErrorKind::NotFound => format!("there is no folder {folder}"),
            ErrorKind::NotADirectory => format!("{folder} is no folder"),
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
                format!("no files can be made in the folder {folder}; choose another")
            }
            _ => return error,
        };
        Error::new(error.kind(), message)
    })
}

/// Renames the finished file. Windows cannot replace a file that another program has open, such as a virus scanner or a
/// preview for a moment, so the rename is retried for a while.
fn rename(mut temporary: NamedTempFile, target: &Path) -> Result<()> {
    const TRIES: usize = 50;
    const PAUSE: Duration = Duration::from_millis(60);
    for _ in 0..TRIES {
        match temporary.persist(target) {
            Ok(_) => return Ok(()),
            Err(failed) if is_held(&failed.error) => temporary = failed.file,
            Err(failed) => return Err(failed.error),
        }
        std::thread::sleep(PAUSE);
    }
    let message = "another program has the file open; close it there, or choose another name";
    Err(Error::new(ErrorKind::ResourceBusy, message))
}

/// Returns whether an error of Windows means that another program has the file open: access denied, sharing or lock
/// violation.
fn is_held(error: &Error) -> bool {
    cfg!(windows) && matches!(error.raw_os_error(), Some(5 | 32 | 33))
}

/// Removes the unfinished files of programs that were killed while they wrote. Those of living programs are locked soon
/// after creation and before their first byte. An empty file without a lock is abandoned if it is older than that, by
/// the time of the file system `now`, taken from a new file.
fn remove_abandoned(folder: &Path, now: Option<SystemTime>) {
    let [prefix, suffix] = UNFINISHED;
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_unfinished = |name: &str| name.starts_with(prefix) && name.ends_with(suffix);
        if !entry.file_name().to_str().is_some_and(is_unfinished) {
            continue;
        }
        let is_old = |found: &fs::Metadata| {
            let age = now.zip(found.modified().ok()).map(|(now, made)| now.duration_since(made));
            age.is_some_and(|age| age.is_ok_and(|age| age > LOCKED_WITHIN))
        };
        let Ok(found) = entry.metadata() else { continue };
        let is_left = found.is_file() && (found.len() > 0 || is_old(&found));
        let is_free = || File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
        if is_left && is_free() {
            // If this fails, the next save tries again.
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests;
