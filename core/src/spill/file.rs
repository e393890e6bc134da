//! The file into which a session's history goes, as the few operations that it needs, behind traits so that
//! tests can let each of them fail. [`Folder`] is the real one.
//!
//! A file `N.history` in a folder, which only its owner can read, is locked while its session runs and removed
//! when that ends. A file that a killed session has left is removed by the next one.

use std::fmt::Debug;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

const ENDING: &str = "history";

/// Makes the file once it is needed.
pub trait Place: Debug + Send {
    /// Creates it, empty.
    fn create(&self) -> Result<Box<dyn SpillFile>>;
}

/// A file in which bytes are written and read anywhere. It is removed when it is dropped.
pub trait SpillFile: Debug + Send {
    /// Writes bytes at a place.
    fn write_at(&mut self, at: u64, bytes: &[u8]) -> Result<()>;
    /// Fills `bytes` from a place.
    fn read_at(&mut self, at: u64, bytes: &mut [u8]) -> Result<()>;
    /// Cuts the file off.
    fn cut(&mut self, bytes: u64) -> Result<()>;
}

/// A folder of the disk.
#[derive(Clone, Debug)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// Removes the files that killed sessions have left. Those of living sessions are locked.
    pub fn remove_left(&self) {
        let Ok(entries) = fs::read_dir(&self.0) else { return };
        let files = entries.filter_map(|entry| Some(entry.ok()?.path()));
        for path in files.filter(|path| path.extension().is_some_and(|ending| ending == ENDING)) {
            // Held until it is removed: who holds it is the only one who may remove it. It may be gone since it was
            // opened, and its name be another's.
            let Ok(file) = File::open(&path) else { continue };
            let is_left = file.try_lock().is_ok() && is_named(&file);
            if is_left && let Err(error) = fs::remove_file(&path) {
                tracing::warn!("cannot remove {}: {error}", path.display());
            }
        }
    }
}

impl Place for Folder {
    fn create(&self) -> Result<Box<dyn SpillFile>> {
        Ok(Box::new(self.make()?))
    }
}

impl Folder {
    /// Makes a file of a number that there is not, and locks it.
    fn make(&self) -> Result<DiskFile> {
        let mut builder = fs::DirBuilder::new();
        builder.recursive(true);
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
        builder.create(&self.0)?;
        let mut options = OpenOptions::new();
        options.read(true).write(true).create_new(true);
        // Nobody else may read or write what a user works on.
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        for number in 1..=u32::MAX {
            let path = self.0.join(format!("{number}.{ENDING}"));
            match options.open(&path) {
                Ok(file) => {
                    if let Some(made) = DiskFile::locked(file, path) {
                        return Ok(made);
                    }
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(Error::from(ErrorKind::AlreadyExists))
    }
}

/// Whether an open file still has a name.
fn is_named(file: &File) -> bool {
    #[cfg(unix)]
    let is_named = |found: fs::Metadata| std::os::unix::fs::MetadataExt::nlink(&found) > 0;
    // Elsewhere a file cannot go while it is open.
    #[cfg(not(unix))]
    let is_named = |_| true;
    file.metadata().is_ok_and(is_named)
}

#[derive(Debug)]
struct DiskFile {
    file: File,
    path: PathBuf,
}

impl DiskFile {
    /// Locks a file that has just been made. None if another session took it for one that was left, before it was
    /// locked: that session removes it.
    fn locked(file: File, path: PathBuf) -> Option<DiskFile> {
        match file.try_lock() {
            Ok(()) => is_named(&file).then_some(DiskFile { file, path }),
            Err(TryLockError::WouldBlock) => None,
            Err(TryLockError::Error(error)) => {
                // Without locks it lives as long as it is open, where open files can be removed.
                tracing::warn!("{} cannot be locked: {error}", path.display());
                Some(DiskFile { file, path })
            }
        }
    }

    fn seek(&mut self, at: u64) -> Result<&mut File> {
        self.file.seek(SeekFrom::Start(at))?;
        Ok(&mut self.file)
    }

    fn path(&self) -> &Path {
        &self.path
    }
}

impl SpillFile for DiskFile {
    fn write_at(&mut self, at: u64, bytes: &[u8]) -> Result<()> {
        self.seek(at)?.write_all(bytes)
    }

    fn read_at(&mut self, at: u64, bytes: &mut [u8]) -> Result<()> {
        self.seek(at)?.read_exact(bytes)
    }

    fn cut(&mut self, bytes: u64) -> Result<()> {
        self.file.set_len(bytes)
    }
}

impl Drop for DiskFile {
    fn drop(&mut self) {
        // The next session removes it where this does not work, as where open files cannot be removed.
        let _ = fs::remove_file(self.path());
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;

    #[test]
    fn a_file_in_use_is_never_taken_for_one_that_was_left() {
        let folder = std::env::temp_dir().join(format!("vs-spill-race-{}", std::process::id()));
        let folder = Folder(folder);
        let has_ended = AtomicBool::new(false);
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| {
                    while !has_ended.load(Ordering::Relaxed) {
                        folder.remove_left();
                    }
                });
            }
            let lost = (0..500).filter(|_| {
                let mut made = folder.make().unwrap();
                made.write_at(0, b"a step").unwrap();
                std::thread::yield_now();
                !is_named(&made.file) || !made.path.exists()
            });
            let lost = lost.count();
            has_ended.store(true, Ordering::Relaxed);
            assert_eq!(lost, 0);
        });
        folder.remove_left();
        assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 0);
        fs::remove_dir_all(&folder.0).unwrap();
    }
}
