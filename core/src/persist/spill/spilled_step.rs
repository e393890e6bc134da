//! The placeholder of a step: it holds the step in memory until it is written, then its position in the file.

use std::io::Read;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::SharedSpill;
use super::parts::{PartReader, SpillPart};
use crate::format::history::{ContentsShape, read_step_from, write_step};
use crate::sculpture::Limits;
use crate::sculpture::history::{Contents, Step, StepChange, StoredStep};

/// A step in the store.
#[derive(Debug)]
pub struct SpilledStep {
    held: Mutex<Held>,
    whole_bytes: usize,
    shared: Arc<SharedSpill>,
}

/// The location of a step.
#[derive(Debug)]
pub enum Held {
    /// In memory, waiting to be written.
    Waiting(Arc<Step>),
    /// In the file.
    Written(Vec<SpillPart>),
    /// Taken by its last loader.
    Taken,
}

impl SpilledStep {
    pub fn new(step: Arc<Step>, shared: Arc<SharedSpill>) -> SpilledStep {
        let whole_bytes = step.heap_bytes();
        SpilledStep { held: Mutex::new(Held::Waiting(step)), whole_bytes, shared }
    }

    fn held(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the step, if it is waiting to be written.
    pub fn waiting(&self) -> Option<Arc<Step>> {
        match &*self.held() {
            Held::Waiting(step) => Some(step.clone()),
            _ => None,
        }
    }

    /// Returns whether it is waiting to be written.
    pub fn is_waiting(&self) -> bool {
        matches!(*self.held(), Held::Waiting(_))
    }

    /// Replaces the step in memory by its parts in the file. Returns the parts if it has been taken in the meantime.
    pub fn written(&self, parts: Vec<SpillPart>) -> Option<Vec<SpillPart>> {
        let mut held = self.held();
        if !matches!(*held, Held::Waiting(_)) {
            return Some(parts);
        }
        *held = Held::Written(parts);
        drop(held);
        self.shared.waits_no_more(self.whole_bytes);
        None
    }
}

impl StoredStep for SpilledStep {
    fn load(&self, contents: &Contents, is_last: bool) -> Result<StepChange, String> {
        let mut held = self.held();
        match &*held {
            Held::Waiting(_) if is_last => {
                let Held::Waiting(step) = std::mem::replace(&mut *held, Held::Taken) else {
                    return Err("it is not there".to_string());
                };
                drop(held);
                self.shared.waits_no_more(self.whole_bytes);
                if matches!(step.change, StepChange::Bricks(_)) {
                    // The thread notices soon, except for a whole sculpture, which it packs to the end; that one is
                    // copied instead.
                    self.shared.wait_for_release(&step);
                }
                Ok(Arc::unwrap_or_clone(step).change)
            }
            Held::Waiting(step) => Ok(step.change.clone()),
            Held::Written(parts) => {
                // Both in memory would be too much.
                drop(self.shared.make_room(self.whole_bytes));
                let mut packed = PartReader::new(&self.shared, parts);
                let step = read_step_from(&mut packed, ContentsShape::of(contents), &Limits::NONE);
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
            Held::Written(parts) => {
                let mut packed = Vec::new();
                let read = PartReader::new(&self.shared, parts).read_to_end(&mut packed);
                read.map(|_| packed).map_err(|error| error.to_string())
            }
            Held::Taken => Err("it is not there".to_string()),
        }
    }

    fn whole_bytes(&self) -> usize {
        self.whole_bytes
    }
}

impl Drop for SpilledStep {
    fn drop(&mut self) {
        match std::mem::replace(&mut *self.held(), Held::Taken) {
            Held::Waiting(_) => self.shared.waits_no_more(self.whole_bytes),
            Held::Written(parts) => self.shared.give_back(&parts),
            Held::Taken => {}
        }
    }
}
