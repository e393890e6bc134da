//! The file operations of journals and saved histories, behind a trait, so that tests can make each of them fail; and
//! the few system calls that they share with [`spill`](super::spill), which writes anywhere in its file and so has a
//! trait of its own.
//!
//! [`Disk`] is the real one. A file that is being written is locked (a system lock on the open file, which ends with
//! the process, however that ends), so that remains of a crash can be told from files that a living session writes.
//! Knows neither names nor contents of files.

use std::fmt::Debug;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Error, ErrorKind, Read, Result, Write};
use std::path::{Path, PathBuf};

/// The file operations that journals and saved histories need.
pub trait FileSystem: Debug + Send + Sync {
    /// Creates a folder and its parents; does nothing if it exists.
    fn make_folder(&self, folder: &Path) -> Result<()>;
    /// Creates an empty file, which must not exist, and locks it. It stays locked while it is open.
    fn create(&self, path: &Path) -> Result<Box<dyn Appender>>;
    /// Renames a file over another, durably: after this no crash restores the old one.
    fn rename(&self, from: &Path, to: &Path) -> Result<()>;
    /// Removes a file.
    fn remove(&self, path: &Path) -> Result<()>;
    /// Returns the files of a folder; none if it does not exist.
    fn list(&self, folder: &Path) -> Result<Vec<PathBuf>>;
    /// Opens a file for reading and locks it; [`ErrorKind::WouldBlock`] if it is locked.
    fn open(&self, path: &Path) -> Result<InputFile>;
    /// Opens for reading a file that is complete and never written again. Does not lock it.
    fn open_shared(&self, path: &Path) -> Result<InputFile> {
        self.open(path)
    }
}

/// Waits until all data appended before is on disk.
pub type Syncer = Box<dyn FnOnce() -> Result<()> + Send>;

/// A file that grows.
pub trait Appender: Debug + Send {
    /// Appends bytes, in one system write where the system accepts them all.
    fn append(&mut self, bytes: &[u8]) -> Result<()>;
    /// Waits until the appended data is on disk. Returns an error of kind [`ErrorKind::NotFound`] if the file has been
    /// removed in the meantime.
    fn sync(&mut self) -> Result<()>;
    /// Returns a closure that syncs on another thread while more is appended; `None` where that is not possible.
    fn syncer(&self) -> Option<Syncer>;
    /// Returns whether the file still has a name.
    fn is_there(&self) -> bool;
}

/// A file to read.
pub struct InputFile {
    /// Its bytes.
    pub reader: Box<dyn Read + Send>,
    /// Their number.
    pub bytes: u64,
    /// When it was last changed, in seconds since 1970, by the system's clock.
    pub changed_unix_s: Option<u64>,
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

#[derive(Debug)]
struct DiskFile(File);

impl FileSystem for Disk {
    fn make_folder(&self, folder: &Path) -> Result<()> {
        make_private_folder(folder)
    }

    fn create(&self, path: &Path) -> Result<Box<dyn Appender>> {
        let file = private_new_file().append(true).open(path)?;
        if let Err(error) = lock(&file) {
            // Without locks, others would take it for an abandoned one.
            let _ = fs::remove_file(path);
            return Err(error);
        }
        Ok(Box::new(DiskFile(file)))
    }

    fn rename(&self, from: &Path, to: &Path) -> Result<()> {
        fs::rename(from, to)?;
        #[cfg(unix)]
        if let Some(folder) = to.parent() {
            File::open(folder)?.sync_all()?;
        }
        Ok(())
    }

    fn remove(&self, path: &Path) -> Result<()> {
        fs::remove_file(path)
    }

    fn list(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        match paths_in(folder) {
            Ok(paths) => paths.collect(),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }

    fn open(&self, path: &Path) -> Result<InputFile> {
        let file = File::open(path)?;
        lock(&file)?;
        source(file)
    }

    fn open_shared(&self, path: &Path) -> Result<InputFile> {
        source(File::open(path)?)
    }
}

/// Creates a folder and its parents, accessible to its owner only.
pub(super) fn make_private_folder(folder: &Path) -> Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

/// Returns the options to create a file that must not exist yet, readable and writable by its owner only.
pub(super) fn private_new_file() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options
}

/// Returns the entries of a folder.
pub(super) fn paths_in(folder: &Path) -> Result<impl Iterator<Item = Result<PathBuf>>> {
    Ok(fs::read_dir(folder)?.map(|entry| Ok(entry?.path())))
}

/// Locks an open file; [`ErrorKind::WouldBlock`] if another has locked it.
pub(super) fn lock(file: &File) -> Result<()> {
    file.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => Error::from(ErrorKind::WouldBlock),
        TryLockError::Error(error) => error,
    })
}

/// Returns whether an open file still has a name.
pub(super) fn has_name(file: &File) -> bool {
    #[cfg(unix)]
    let has_name = |found: fs::Metadata| std::os::unix::fs::MetadataExt::nlink(&found) > 0;
    // On other systems a file cannot be removed while it is open.
    #[cfg(not(unix))]
    let has_name = |_| true;
    file.metadata().is_ok_and(has_name)
}

fn source(file: File) -> Result<InputFile> {
    let found = file.metadata()?;
    if !found.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "this is no file"));
    }
    let since_1970 = |time: std::time::SystemTime| time.duration_since(std::time::UNIX_EPOCH);
    let changed_unix_s =
        found.modified().ok().and_then(|time| since_1970(time).ok()).map(|age| age.as_secs());
    let reader = Box::new(std::io::BufReader::with_capacity(1 << 16, file));
    Ok(InputFile { reader, bytes: found.len(), changed_unix_s })
}

impl Appender for DiskFile {
    fn append(&mut self, bytes: &[u8]) -> Result<()> {
        self.0.write_all(bytes)
    }

    fn sync(&mut self) -> Result<()> {
        self.0.sync_data()?;
        if self.is_there() {
            return Ok(());
        }
        Err(Error::new(ErrorKind::NotFound, "the file or its folder has been removed"))
    }

    fn syncer(&self) -> Option<Syncer> {
        let mut file = DiskFile(self.0.try_clone().ok()?);
        Some(Box::new(move || file.sync()))
    }

    fn is_there(&self) -> bool {
        has_name(&self.0)
    }
}
