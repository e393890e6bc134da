//! In-memory files for journals, which can fail at any operation, write only a part, fill up, lose their folder or lose
//! unsynced data.

use std::collections::BTreeMap;
use std::io::{Cursor, Error, ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard};

use sculpture_core::persist::files::{Appender, FileSystem, InputFile, Syncer};

/// The way in which an operation fails.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fault {
    /// Nothing is done.
    Refused,
    /// Half of the bytes are written; an operation that writes no bytes does nothing.
    Short,
    /// It is done, but an error is returned.
    DoneAndRefused,
}

#[derive(Clone, Debug, Default)]
struct File {
    bytes: Vec<u8>,
    /// The number of bytes that a power cut leaves.
    synced: usize,
    locked: bool,
    /// Whether it has a name.
    linked: bool,
}

#[derive(Debug, Default)]
struct Disk {
    files: Vec<File>,
    names: BTreeMap<PathBuf, usize>,
    /// The names that a power cut leaves.
    synced_names: BTreeMap<PathBuf, usize>,
    calls: u64,
    fault: Option<(u64, Fault)>,
    /// The most bytes that all files together may have.
    room: Option<usize>,
    folder_gone: bool,
}

/// Shared by all users of these files.
#[derive(Clone, Debug, Default)]
pub struct Memory(Arc<Mutex<Disk>>);

#[derive(Debug)]
struct Handle {
    disk: Memory,
    file: usize,
}

impl Memory {
    pub fn files(&self) -> Arc<dyn FileSystem> {
        Arc::new(self.clone())
    }

    fn disk(&self) -> MutexGuard<'_, Disk> {
        self.0.lock().unwrap()
    }

    /// Returns the number of operations so far.
    pub fn calls(&self) -> u64 {
        self.disk().calls
    }

    /// Makes the operation fail that comes after `calls` others.
    pub fn fail_after(&self, calls: u64, fault: Fault) {
        self.disk().fault = Some((calls, fault));
    }

    pub fn set_room(&self, bytes: Option<usize>) {
        self.disk().room = bytes;
    }

    /// Removes the folder with all its contents, for good or until it is created again.
    pub fn remove_folder(&self) {
        let mut disk = self.disk();
        disk.folder_gone = true;
        for at in std::mem::take(&mut disk.names).into_values() {
            disk.files[at].linked = false;
        }
    }

    pub fn count(&self) -> usize {
        self.disk().names.len()
    }

    /// Returns the bytes of the file whose name ends with `name`.
    pub fn bytes(&self, name: &str) -> Option<Vec<u8>> {
        let disk = self.disk();
        let found = disk.names.iter().find(|(path, _)| path.ends_with(name));
        found.map(|(_, at)| disk.files[*at].bytes.clone())
    }

    /// Returns the files that remain if the process ends now; after a power cut, only synced ones.
    pub fn left(&self, power_cut: bool) -> Memory {
        let disk = self.disk();
        let names = if power_cut { &disk.synced_names } else { &disk.names };
        let mut left = Disk { names: names.clone(), files: disk.files.clone(), ..Disk::default() };
        for file in &mut left.files {
            file.locked = false;
            if power_cut {
                file.bytes.truncate(file.synced);
            }
        }
        Memory(Arc::new(Mutex::new(left)))
    }

    /// Returns a disk with one journal.
    pub fn with_journal(bytes: &[u8]) -> Memory {
        Memory::with_file("/state/journals/1.journal".as_ref(), bytes)
    }

    /// Returns the only existing file.
    pub fn only_file(&self) -> (PathBuf, Vec<u8>) {
        let disk = self.disk();
        assert_eq!(disk.names.len(), 1);
        let (path, at) = disk.names.first_key_value().unwrap();
        (path.clone(), disk.files[*at].bytes.clone())
    }

    /// Returns a disk with one file.
    pub fn with_file(path: &Path, bytes: &[u8]) -> Memory {
        let file = File { bytes: bytes.to_vec(), linked: true, ..File::default() };
        let names = BTreeMap::from([(path.to_path_buf(), 0)]);
        Memory(Arc::new(Mutex::new(Disk { files: vec![file], names, ..Disk::default() })))
    }

    /// Counts an operation. Returns the fault if it is to fail.
    fn called(&self) -> Option<Fault> {
        let mut disk = self.disk();
        disk.calls += 1;
        let (calls, fault) = disk.fault?;
        (disk.calls == calls + 1).then_some(fault)
    }

    /// Performs an operation that writes no bytes, or fails.
    fn operate<T>(&self, operation: impl FnOnce(&mut Disk) -> Result<T>) -> Result<T> {
        match self.called() {
            None => operation(&mut self.disk()),
            Some(Fault::DoneAndRefused) => operation(&mut self.disk()).and(Err(failure())),
            Some(Fault::Refused | Fault::Short) => Err(failure()),
        }
    }
}

fn failure() -> Error {
    Error::other("the test lets this fail")
}

impl FileSystem for Memory {
    fn make_folder(&self, _: &Path) -> Result<()> {
        self.operate(|disk| {
            disk.folder_gone = false;
            Ok(())
        })
    }

    fn create(&self, path: &Path) -> Result<Box<dyn Appender>> {
        self.operate(|disk| {
            if disk.folder_gone {
                return Err(ErrorKind::NotFound.into());
            }
            if disk.names.contains_key(path) {
                return Err(ErrorKind::AlreadyExists.into());
            }
            disk.files.push(File { locked: true, linked: true, ..File::default() });
            let file = disk.files.len() - 1;
            disk.names.insert(path.to_path_buf(), file);
            Ok(file)
        })
        .map(|file| -> Box<dyn Appender> { Box::new(Handle { disk: self.clone(), file }) })
    }

    fn rename(&self, from: &Path, to: &Path) -> Result<()> {
        self.operate(|disk| {
            let file = disk.names.remove(from).ok_or(ErrorKind::NotFound)?;
            if let Some(old) = disk.names.insert(to.to_path_buf(), file) {
                disk.files[old].linked = false;
            }
            disk.synced_names = disk.names.clone();
            Ok(())
        })
    }

    fn remove(&self, path: &Path) -> Result<()> {
        self.operate(|disk| {
            let file = disk.names.remove(path).ok_or(ErrorKind::NotFound)?;
            disk.files[file].linked = false;
            Ok(())
        })
    }

    fn list(&self, _: &Path) -> Result<Vec<PathBuf>> {
        self.operate(|disk| Ok(disk.names.keys().cloned().collect()))
    }

    fn open(&self, path: &Path) -> Result<InputFile> {
        self.operate(|disk| {
            let file = &disk.files[*disk.names.get(path).ok_or(ErrorKind::NotFound)?];
            if file.locked {
                return Err(ErrorKind::WouldBlock.into());
            }
            let bytes = file.bytes.len() as u64;
            let reader = Box::new(Cursor::new(file.bytes.clone()));
            Ok(InputFile { reader, bytes, changed_unix_s: None })
        })
    }
}

impl Appender for Handle {
    fn append(&mut self, bytes: &[u8]) -> Result<()> {
        let fault = self.disk.called();
        let mut disk = self.disk.disk();
        let used: usize = disk.files.iter().filter(|file| file.linked).map(|f| f.bytes.len()).sum();
        let left = disk.room.map_or(usize::MAX, |room| room.saturating_sub(used));
        let (written, result) = match fault {
            None if bytes.len() > left => (left, Err(Error::from(ErrorKind::StorageFull))),
            None => (bytes.len(), Ok(())),
            Some(Fault::Refused) => (0, Err(failure())),
            Some(Fault::Short) => (bytes.len() / 2, Err(failure())),
            Some(Fault::DoneAndRefused) => (bytes.len(), Err(failure())),
        };
        disk.files[self.file].bytes.extend_from_slice(&bytes[..written]);
        result
    }

    fn sync(&mut self) -> Result<()> {
        let file = self.file;
        self.disk.operate(|disk| {
            disk.files[file].synced = disk.files[file].bytes.len();
            if disk.files[file].linked { Ok(()) } else { Err(ErrorKind::NotFound.into()) }
        })
    }

    fn syncer(&self) -> Option<Syncer> {
        // At once, so that operations have an order.
        None
    }

    fn is_there(&self) -> bool {
        self.disk.disk().files[self.file].linked
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        if let Ok(mut disk) = self.disk.0.lock() {
            disk.files[self.file].locked = false;
        }
    }
}
