//! The file into which a session's history goes, as the few operations that it needs, behind traits so that
//! tests can let each of them fail. [`Folder`] is the real one.
//!
//! A file `N.history` in a folder, which only its owner can read, is locked while its session runs and removed
//! when that ends. What a killed session has left is removed by the next one.

use std::fmt::Debug;
use std::fs::{self, File, OpenOptions};
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
            let is_left = File::open(&path).is_ok_and(|file| file.try_lock().is_ok());
            if is_left && let Err(error) = fs::remove_file(&path) {
                tracing::warn!("cannot remove {}: {error}", path.display());
            }
        }
    }
}

impl Place for Folder {
    fn create(&self) -> Result<Box<dyn SpillFile>> {
        let mut builder = fs::DirBuilder::new();
        builder.recursive(true);
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
        builder.create(&self.0)?;
        let mut options = OpenOptions::new();
        options.read(true).write(true).create_new(true);
        // What somebody works on is nobody else's.
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        for number in 1..=u32::MAX {
            let path = self.0.join(format!("{number}.{ENDING}"));
            match options.open(&path) {
                Ok(file) => return DiskFile::locked(file, path),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(Error::from(ErrorKind::AlreadyExists))
    }
}

#[derive(Debug)]
struct DiskFile {
    file: File,
    path: PathBuf,
}

impl DiskFile {
    fn locked(file: File, path: PathBuf) -> Result<Box<dyn SpillFile>> {
        let made = DiskFile { file, path };
        // Between its creation and its lock another session may take it for one that was left. On systems that
        // let it remove an open file nothing is lost by that: the file lives as long as it is open.
        if let Err(error) = made.file.try_lock() {
            tracing::warn!("{} cannot be locked: {error}", made.path.display());
        }
        Ok(Box::new(made))
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
