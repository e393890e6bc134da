//! The file that stores a session's history, as the few operations that it needs, behind traits so that tests can make
//! each of them fail. [`Folder`] is the real one. The traits are not those of [`files`](crate::persist::files): bytes
//! are written and read anywhere, nothing is synced, and nothing outlives the session.
//!
//! A file `N.history` in a folder, readable by its owner only, is locked while its session runs and removed when the
//! session ends. A file left by a killed session is removed by the next one.

use std::fmt::Debug;
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Result, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::persist::dir::{create_numbered, has_ending, path_in};
use crate::persist::files::{has_name, lock, make_private_folder, paths_in, private_new_file};

const ENDING: &str = "history";

/// Creates the file once it is needed.
pub trait SpillPlace: Debug + Send {
    /// Creates an empty file.
    fn create(&self) -> Result<Box<dyn SpillFile>>;
}

/// A file in which bytes are written and read anywhere. It is removed when dropped.
pub trait SpillFile: Debug + Send {
    /// Writes bytes at a position.
    fn write_at(&mut self, at: u64, bytes: &[u8]) -> Result<()>;
    /// Fills `bytes` from a position.
    fn read_at(&mut self, at: u64, bytes: &mut [u8]) -> Result<()>;
    /// Truncates the file to a length.
    fn cut(&mut self, bytes: u64) -> Result<()>;
}

/// A folder on the disk.
#[derive(Clone, Debug)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// Removes the files left by killed sessions. Those of living sessions are locked.
    pub(crate) fn remove_left(&self) {
        let Ok(paths) = paths_in(&self.0) else { return };
        for path in paths.filter_map(Result::ok).filter(|path| has_ending(path, ENDING)) {
            // The lock is held until the file is removed, so that only its holder removes it. The file may have been
            // removed since it was opened, and another may have taken its name.
            let Ok(file) = File::open(&path) else { continue };
            let is_left = lock(&file).is_ok() && has_name(&file);
            if is_left && let Err(error) = fs::remove_file(&path) {
                tracing::warn!("cannot remove {}: {error}", path.display());
            }
        }
    }
}

impl SpillPlace for Folder {
    fn create(&self) -> Result<Box<dyn SpillFile>> {
        Ok(Box::new(self.make()?))
    }
}

impl Folder {
    /// Creates a file with a free number, and locks it.
    fn make(&self) -> Result<DiskFile> {
        make_private_folder(&self.0)?;
        let mut options = private_new_file();
        options.read(true).write(true);
        let (_, made) = create_numbered(1, &[ErrorKind::AlreadyExists], |number| {
            let path = path_in(&self.0, number, ENDING);
            let file = options.open(&path)?;
            DiskFile::locked(file, path).ok_or_else(|| ErrorKind::AlreadyExists.into())
        })?;
        Ok(made)
    }
}

#[derive(Debug)]
struct DiskFile {
    file: File,
    path: PathBuf,
}

impl DiskFile {
    /// Locks a newly created file. `None` if another session took it for an abandoned one before it was locked; that
    /// session removes it.
    fn locked(file: File, path: PathBuf) -> Option<DiskFile> {
        match lock(&file) {
            Ok(()) => has_name(&file).then_some(DiskFile { file, path }),
            Err(error) if error.kind() == ErrorKind::WouldBlock => None,
            Err(error) => {
                // Without locks, it lives as long as it is open, where open files can be removed.
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
        // If this fails, as where open files cannot be removed, the next session removes it.
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
                !has_name(&made.file) || !made.path.exists()
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
