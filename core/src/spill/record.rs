//! What stands for a step: in memory until it is written, then its place in the file.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::Shared;
use crate::format::history::{Shape, read_step, write_step};
use crate::sculpture::Limits;
use crate::sculpture::history::{Change, Contents, Step, StoredStep};

/// Contents of any size: what is read has been in memory before.
const ANY_SIZE: Limits = Limits {
    grid_bytes: u64::MAX,
    colour_bytes: u64::MAX,
    history_bytes: usize::MAX,
    history_disk_bytes: u64::MAX,
};

/// A step in the store.
#[derive(Debug)]
pub struct Record {
    held: Mutex<Held>,
    whole_bytes: usize,
    shared: Arc<Shared>,
}

/// Where a step is.
#[derive(Debug)]
pub enum Held {
    /// In memory; it is to be written.
    Waiting(Arc<Step>),
    /// In the file.
    Written {
        /// Its first byte.
        at: u64,
        /// How many there are.
        bytes: usize,
        /// Their CRC-32.
        checksum: u32,
    },
    /// With the one who has loaded it last.
    Taken,
}

impl Record {
    pub fn new(step: Arc<Step>, shared: Arc<Shared>) -> Record {
        let whole_bytes = step.heap_bytes();
        Record { held: Mutex::new(Held::Waiting(step)), whole_bytes, shared }
    }

    fn held(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The step, if it is to be written.
    pub fn waiting(&self) -> Option<Arc<Step>> {
        match &*self.held() {
            Held::Waiting(step) => Some(step.clone()),
            _ => None,
        }
    }

    /// Puts the place in the file for the step in memory. False if it has been taken meanwhile.
    pub fn written(&self, place: Held) -> bool {
        let mut held = self.held();
        let waits = matches!(*held, Held::Waiting(_));
        if waits {
            *held = place;
            drop(held);
            self.shared.waits_no_more(self.whole_bytes);
        }
        waits
    }

    fn read(&self, at: u64, bytes: usize, checksum: u32) -> Result<Vec<u8>, String> {
        let mut packed = vec![0; bytes];
        self.shared.read_at(at, &mut packed).map_err(|error| error.to_string())?;
        match crc32fast::hash(&packed) == checksum {
            true => Ok(packed),
            false => Err("the file has been changed or damaged".to_string()),
        }
    }
}

impl StoredStep for Record {
    fn load(&self, contents: &Contents, is_last: bool) -> Result<Change, String> {
        let mut held = self.held();
        match &*held {
            Held::Waiting(_) if is_last => {
                let Held::Waiting(step) = std::mem::replace(&mut *held, Held::Taken) else {
                    return Err("it is not there".to_string());
                };
                drop(held);
                self.shared.waits_no_more(self.whole_bytes);
                Ok(Arc::unwrap_or_clone(step).change)
            }
            Held::Waiting(step) => Ok(step.change.clone()),
            Held::Written { at, bytes, checksum } => {
                let packed = self.read(*at, *bytes, *checksum)?;
                let step = read_step(&packed, Shape::of(contents), &ANY_SIZE);
                step.map(|step| step.change).map_err(|error| error.to_string())
            }
            Held::Taken => Err("it is not there".to_string()),
        }
    }

    fn packed(&self) -> Result<Vec<u8>, String> {
        let held = self.held();
        match &*held {
            Held::Waiting(step) => {
                let step = step.clone();
                drop(held);
                write_step(&step).map_err(|error| error.to_string())
            }
            Held::Written { at, bytes, checksum } => self.read(*at, *bytes, *checksum),
            Held::Taken => Err("it is not there".to_string()),
        }
    }

    fn whole_bytes(&self) -> usize {
        self.whole_bytes
    }
}

impl Drop for Record {
    fn drop(&mut self) {
        match std::mem::replace(&mut *self.held(), Held::Taken) {
            Held::Waiting(_) => self.shared.waits_no_more(self.whole_bytes),
            Held::Written { at, .. } => self.shared.give_back(at),
            Held::Taken => {}
        }
    }
}
