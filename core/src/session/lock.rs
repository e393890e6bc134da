//! Locks the files of sculptures, so that two programs do not save to the same file unnoticed.
//!
//! While a program has `owl.vsc` open, `.owl.vsc.lock` lies beside it. The program holds a lock of the operating system
//! on it, which ends with the program in any case, and writes its identity into it. The lock file stays in place when a
//! save replaces the sculpture's own file. A lock file that nobody has locked was left by a killed program, and is
//! taken over. Where no lock is possible, such as in a read-only folder, work continues without one.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

/// Maximum number of bytes read of a lock file.
const MOST_BYTES: u64 = 4096;
/// Number of attempts to recreate a lock file that was removed meanwhile.
const TRIES: usize = 8;

/// The program that has a sculpture's file open, as far as known.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub struct Holder {
    /// Its process number.
    pub process: Option<u32>,
    /// The name of its computer.
    pub host: Option<String>,
    /// When it opened the file, in seconds since 1970.
    pub since_unix_s: Option<u64>,
}

impl Holder {
    fn this_program() -> Holder {
        let host = gethostname::gethostname().to_string_lossy().into_owned();
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        Holder {
            process: Some(std::process::id()),
            host: Some(host),
            since_unix_s: now.ok().map(|now| now.as_secs()),
        }
    }

    /// Reads the lock file at `path`. Returns an empty holder if the system does not let a locked file be read.
    fn read(path: &Path) -> Holder {
        let read = || -> io::Result<Holder> {
            let mut text = String::new();
            File::open(path)?.take(MOST_BYTES).read_to_string(&mut text)?;
            let mut holder: Holder = serde_json::from_str(&text)?;
            // Anyone who can write to the folder may have written this.
            holder.host =
                holder.host.map(|host| host.chars().filter(|c| !c.is_control()).take(64).collect());
            Ok(holder)
        };
        read().unwrap_or_default()
    }
}

impl std::fmt::Display for Holder {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match (self.process, &self.host) {
            (Some(process), Some(host)) => write!(f, "process {process} on {host}"),
            (Some(process), None) => write!(f, "process {process}"),
            (None, _) => f.write_str("another program"),
        }
    }
}

/// A lock that this program holds. Dropping it releases the lock.
#[derive(Debug)]
pub(super) struct FileLock {
    path: PathBuf,
    /// Locked as long as it is open.
    file: File,
}

impl FileLock {
    /// Writes who holds the lock, for other programs.
    fn write_holder(&mut self) -> io::Result<()> {
        self.file.set_len(0)?;
        self.file.write_all(&serde_json::to_vec(&Holder::this_program())?)
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        // The next program takes over a lock file that cannot be removed.
        if let Err(error) = fs::remove_file(&self.path) {
            tracing::debug!("cannot remove {}: {error}", self.path.display());
        }
    }
}

/// The result of taking a lock.
#[derive(Debug)]
pub(super) enum LockResult {
    Ours(FileLock),
    /// Another program holds the lock.
    Foreign(Holder),
    /// No lock is possible; the reason was logged.
    Without,
}

/// Takes the lock of the sculpture at `path`, without waiting.
pub(super) fn take(path: &Path) -> LockResult {
    let Some(name) = path.file_name() else { return LockResult::Without };
    let mut lock_name = std::ffi::OsString::from(".");
    lock_name.push(name);
    lock_name.push(".lock");
    let lock = path.with_file_name(lock_name);
    match try_take(&lock) {
        Ok(taken) => taken,
        Err(error) => {
            tracing::info!("no lock for {}: {}: {error}", path.display(), lock.display());
            LockResult::Without
        }
    }
}

fn try_take(path: &Path) -> io::Result<LockResult> {
    for _ in 0..TRIES {
        // Opening a link would reach another person's file, and opening a pipe would block.
        let former = match fs::symlink_metadata(path) {
            Ok(found) if !found.is_file() => return Err(io::Error::other("it is no file")),
            Ok(_) => true,
            Err(_) => false,
        };
        let opened =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let (file, may_write) = match opened {
            Ok(file) => (file, true),
            // It may belong to another person, but its lock can still be tested.
            Err(error) if former && error.kind() == io::ErrorKind::PermissionDenied => {
                (File::open(path)?, false)
            }
            Err(error) => return Err(error),
        };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Ok(LockResult::Foreign(Holder::read(path))),
            Err(TryLockError::Error(error)) => {
                if !former {
                    // Best effort: the returned error is the one that matters.
                    fs::remove_file(path).ok();
                }
                return Err(error);
            }
        }
        if !is_at(&file, path) {
            // The program that held it has removed it meanwhile.
            continue;
        }
        if !may_write {
            return Err(io::Error::from(io::ErrorKind::PermissionDenied));
        }
        if former {
            tracing::info!("the lock {} is taken over: nobody holds it", path.display());
        }
        let mut lock = FileLock { path: path.to_path_buf(), file };
        if let Err(error) = lock.write_holder() {
            tracing::info!("{} does not say who holds it: {error}", path.display());
        }
        return Ok(LockResult::Ours(lock));
    }
    Err(io::Error::other("it is made and removed again and again"))
}

/// Returns whether the open file is still the one at `path`.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::symlink_metadata(path)) {
        (Ok(open), Ok(there)) => (open.dev(), open.ino()) == (there.dev(), there.ino()),
        _ => false,
    }
}

/// Returns whether the open file is still the one at `path`: no other can be created there before it is closed.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lock_of(folder: &Path) -> PathBuf {
        folder.join(".owl.vsc.lock")
    }

    #[test]
    fn one_has_the_lock_and_the_others_learn_who() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("owl.vsc");
        let LockResult::Ours(lock) = take(&path) else { panic!("the lock is free") };
        assert!(lock_of(folder.path()).exists());
        for _ in 0..2 {
            let LockResult::Foreign(holder) = take(&path) else { panic!("the lock is taken") };
            assert_eq!(holder.process, Some(std::process::id()));
            assert!(holder.since_unix_s > Some(1_700_000_000) && holder.host.is_some());
            assert!(holder.to_string().starts_with(&format!("process {}", std::process::id())));
        }
        drop(lock);
        assert!(!lock_of(folder.path()).exists());
        assert!(matches!(take(&path), LockResult::Ours(_)));
    }

    #[test]
    fn a_lock_file_that_nobody_has_locked_is_taken_over() {
        let folder = tempfile::tempdir().unwrap();
        let lock = lock_of(folder.path());
        for left in ["", "{", r#"{"process":1,"host":"atlas","since_unix_s":5}"#, "\0\u{fffd}"] {
            std::fs::write(&lock, left).unwrap();
            let LockResult::Ours(_lock) = take(&folder.path().join("owl.vsc")) else {
                panic!("nobody holds {left:?}")
            };
            let told = Holder::read(&lock);
            assert_eq!(told.process, Some(std::process::id()), "{left:?}");
        }
    }

    #[test]
    fn work_goes_on_without_a_lock_that_cannot_be_taken() {
        let folder = tempfile::tempdir().unwrap();
        for path in [PathBuf::new(), "/".into(), folder.path().join("gone/owl.vsc")] {
            assert!(matches!(take(&path), LockResult::Without), "{path:?}");
        }
        std::fs::create_dir(lock_of(folder.path())).unwrap();
        assert!(matches!(take(&folder.path().join("owl.vsc")), LockResult::Without));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_the_place_of_the_lock_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let other = folder.path().join("letter.txt");
        std::fs::write(&other, "dear").unwrap();
        std::os::unix::fs::symlink(&other, lock_of(folder.path())).unwrap();
        assert!(matches!(take(&folder.path().join("owl.vsc")), LockResult::Without));
        assert_eq!(std::fs::read_to_string(&other).unwrap(), "dear");
    }

    #[test]
    fn of_many_threads_one_at_a_time_has_the_lock() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("owl.vsc");
        let holders = std::sync::atomic::AtomicU32::new(0);
        let taken = std::sync::atomic::AtomicU32::new(0);
        let order = std::sync::atomic::Ordering::SeqCst;
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..200 {
                        if let LockResult::Ours(lock) = take(&path) {
                            assert_eq!(holders.fetch_add(1, order), 0);
                            taken.fetch_add(1, order);
                            holders.fetch_sub(1, order);
                            drop(lock);
                        }
                    }
                });
            }
        });
        assert!(taken.load(order) > 0);
        assert!(!lock_of(folder.path()).exists());
    }
}
