//! Undo and redo steps on disk: the store of a history that exceeds its memory limit.
//!
//! A separate thread packs the steps (`format::history`) and writes them to one file; until then they stay in memory,
//! within a limit. Packing and unpacking work in parts, each with a CRC-32. If the disk is full or fails, a message
//! reports it, steps are refused, and every further step tries again. `file` is the file, `parts` are the parts of
//! steps in it, `part_writer` writes them, `space` tracks which parts of the file are in use, and `spilled_step` is the
//! placeholder of a step. Knows no document.

mod file;
mod part_writer;
mod parts;
mod space;
mod spilled_step;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::io::Result;
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::JoinHandle;

use file::{Folder, SpillFile, SpillPlace};
use part_writer::{PartWriter, Stop};
use parts::SpillPart;
use space::FileSpace;
use spilled_step::SpilledStep;

use crate::format::history::write_step_to;
use crate::sculpture::history::{Step, StepStore, StoredChange};

/// Greatest number of packed bytes of a step in memory at a time.
const PART_BYTES: usize = 1 << 22;

/// Stores steps in a file that is removed when this and the last step are dropped.
#[derive(Debug)]
pub struct Spill {
    shared: Arc<SharedSpill>,
    writer: Option<JoinHandle<()>>,
}

/// The state that the thread, the steps and the session share. Locks are taken in this order: a spilled step's, `file`,
/// `state`.
#[derive(Debug)]
struct SharedSpill {
    place: Box<dyn PlaceSync>,
    file: Mutex<Option<Box<dyn SpillFile>>>,
    state: Mutex<SpillState>,
    /// Signals that the state has changed.
    changed: Condvar,
    /// Greatest size of the file in bytes.
    max_bytes: u64,
    /// Greatest size in bytes of the steps waiting to be written, if there is more than one.
    max_waiting_bytes: usize,
    /// Number of packed bytes of a step that are written at a time.
    part_bytes: usize,
}

trait PlaceSync: SpillPlace + Sync {}
impl<P: SpillPlace + Sync> PlaceSync for P {}

#[derive(Debug, Default)]
struct SpillState {
    queue: VecDeque<Weak<SpilledStep>>,
    waiting_bytes: usize,
    space: FileSpace,
    /// The reason why the first step of the queue could not be written. It stays there.
    blocked: Option<Blocked>,
    /// Whether the write is to be retried.
    retry: bool,
    /// Whether the thread is writing.
    is_busy: bool,
    /// Whether the user was told that nothing can be written.
    told: bool,
    /// The message that has not been shown to the user yet.
    message: Option<String>,
    has_ended: bool,
}

#[derive(Clone, Copy, Debug)]
enum Blocked {
    /// The file has reached its limit.
    Full,
    /// The system's reason.
    Failed,
}

impl SpillState {
    /// Requests a retry; called when there may be more space than before.
    fn try_again_if_full(&mut self) {
        if matches!(self.blocked, Some(Blocked::Full)) {
            self.blocked = None;
        }
    }
}

impl Spill {
    /// Creates a store in a folder that takes up to `max_bytes` of the disk, and keeps up to `max_waiting_bytes` in
    /// memory until they are written. Removes the files of killed sessions in the folder; its own file is created with
    /// the first step.
    ///
    /// # Errors
    /// If no thread can be created.
    pub fn new(folder: &Path, max_bytes: u64, max_waiting_bytes: usize) -> Result<Spill> {
        let folder = Folder(folder.to_path_buf());
        folder.remove_left();
        Spill::with_place(Box::new(folder), max_bytes, max_waiting_bytes, PART_BYTES)
    }

    fn with_place(
        place: Box<dyn PlaceSync>,
        max_bytes: u64,
        max_waiting_bytes: usize,
        part_bytes: usize,
    ) -> Result<Spill> {
        let (file, state, changed) = Default::default();
        let shared =
            SharedSpill { place, file, state, changed, max_bytes, max_waiting_bytes, part_bytes };
        let shared = Arc::new(shared);
        let writer = shared.clone();
        let builder = std::thread::Builder::new().name("history".to_string());
        let writer = builder.spawn(move || writer.write_all())?;
        Ok(Spill { shared, writer: Some(writer) })
    }

    /// Returns the message for the user, once: that nothing can be written, or that it can again.
    pub(crate) fn take_message(&self) -> Option<String> {
        self.shared.state().message.take()
    }

    /// Returns the greatest size of the file in bytes.
    pub fn max_bytes(&self) -> u64 {
        self.shared.max_bytes
    }

    /// Waits until the given steps are written, or cannot be.
    pub fn wait(&self) {
        let goes_on = |state: &mut SpillState| {
            let wants = !state.queue.is_empty() && (state.blocked.is_none() || state.retry);
            wants || state.is_busy
        };
        drop(self.shared.changed.wait_while(self.shared.state(), goes_on));
    }
}

impl StepStore for Spill {
    fn keep(&self, step: Arc<Step>) -> std::result::Result<StoredChange, Arc<Step>> {
        let shared = &self.shared;
        let bytes = step.heap_bytes();
        let mut state = shared.make_room(bytes);
        if state.blocked.is_some() {
            state.retry = true;
            shared.changed.notify_all();
            return Err(step);
        }
        let spilled = Arc::new(SpilledStep::new(step, shared.clone()));
        state.waiting_bytes += bytes;
        state.queue.push_back(Arc::downgrade(&spilled));
        shared.changed.notify_all();
        Ok(StoredChange(spilled))
    }

    fn make_room(&self, bytes: usize) {
        drop(self.shared.make_room(bytes));
    }

    fn room_bytes(&self) -> u64 {
        let mut state = self.shared.state();
        if matches!(state.blocked, Some(Blocked::Failed)) {
            // Steps refused now may fit the next time.
            state.retry = true;
            self.shared.changed.notify_all();
            return 0;
        }
        self.shared.max_bytes
    }
}

impl Drop for Spill {
    fn drop(&mut self) {
        self.shared.state().has_ended = true;
        self.shared.changed.notify_all();
        if let Some(writer) = self.writer.take() {
            // The thread returns nothing: its errors have already been reported.
            let _ = writer.join();
        }
    }
}

impl SharedSpill {
    fn state(&self) -> MutexGuard<'_, SpillState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn file(&self) -> MutexGuard<'_, Option<Box<dyn SpillFile>>> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits while `bytes` more would exceed the memory limit, unless writing is blocked.
    fn make_room(&self, bytes: usize) -> MutexGuard<'_, SpillState> {
        let too_much = |state: &mut SpillState| {
            let waiting = state.waiting_bytes;
            let sum = waiting.saturating_add(bytes);
            state.blocked.is_none() && waiting > 0 && sum > self.max_waiting_bytes
        };
        let waited = self.changed.wait_while(self.state(), too_much);
        waited.unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the thread has released a step that is no longer to be written.
    fn wait_for_release(&self, step: &Arc<Step>) {
        let is_held = |state: &mut SpillState| state.is_busy && Arc::strong_count(step) > 1;
        drop(self.changed.wait_while(self.state(), is_held));
    }

    /// Runs the thread: writes waiting steps until the session ends.
    fn write_all(&self) {
        loop {
            let idle = |state: &mut SpillState| {
                let nothing = state.queue.is_empty() || (state.blocked.is_some() && !state.retry);
                nothing && !state.has_ended
            };
            let woken = self.changed.wait_while(self.state(), idle);
            let mut state = woken.unwrap_or_else(PoisonError::into_inner);
            if state.has_ended {
                return;
            }
            (state.retry, state.is_busy) = (false, true);
            let first = state.queue.front().cloned();
            drop(state);
            // A step that is no longer needed takes no space.
            let spilled = first.and_then(|first| first.upgrade());
            let written = spilled.map_or(Ok(false), |spilled| self.write(&spilled));
            self.note(written);
        }
    }

    /// Records the result of writing the first step of the queue.
    fn note(&self, written: std::result::Result<bool, (Blocked, String)>) {
        let mut state = self.state();
        state.is_busy = false;
        match written {
            Ok(has_written) => {
                state.queue.pop_front();
                // The next step, if there is one, shows whether writing works.
                state.blocked = None;
                if has_written && std::mem::take(&mut state.told) {
                    state.message = Some("the history goes to the disk again".to_string());
                }
            }
            Err((reason, why)) => {
                if matches!(reason, Blocked::Failed) && !std::mem::replace(&mut state.told, true) {
                    state.message = Some(format!(
                        "the history cannot be written to the disk ({why}); work goes on, and the oldest steps \
                         are dropped once they exceed the memory that is allowed for them"
                    ));
                }
                state.blocked = Some(reason);
            }
        }
        self.changed.notify_all();
    }

    /// Writes a step. Returns false if it is no longer needed.
    fn write(&self, spilled: &SpilledStep) -> std::result::Result<bool, (Blocked, String)> {
        let Some(step) = spilled.waiting() else { return Ok(false) };
        let mut writer = PartWriter::new(self, spilled);
        if let Err(error) = write_step_to(&step, &mut writer) {
            writer.fail(&error);
        }
        drop(step);
        let written = writer.finish();
        let result = match written {
            Ok(parts) => {
                if let Some(parts) = spilled.written(parts) {
                    self.give_back(&parts);
                }
                Ok(true)
            }
            Err(Stop::NotNeeded) => Ok(false),
            Err(Stop::Full) => Err((Blocked::Full, String::new())),
            Err(Stop::Failed(why)) => Err((Blocked::Failed, why)),
        };
        self.shrink();
        result
    }

    /// Writes bytes at a position of the file, which is created if there is none.
    fn write_at(&self, at: u64, bytes: &[u8]) -> Result<()> {
        let mut file = self.file();
        if file.is_none() {
            *file = Some(self.place.create()?);
        }
        match file.as_mut() {
            Some(file) => file.write_at(at, bytes),
            None => Err(std::io::ErrorKind::NotFound.into()),
        }
    }

    /// Reads bytes from a position of the file.
    fn read_at(&self, at: u64, bytes: &mut [u8]) -> Result<()> {
        match self.file().as_mut() {
            Some(file) => file.read_at(at, bytes),
            None => Err(std::io::ErrorKind::NotFound.into()),
        }
    }

    /// Frees parts of the file.
    fn give_back(&self, parts: &[SpillPart]) {
        let mut state = self.state();
        parts.iter().for_each(|part| state.space.give_back(part.at));
        state.try_again_if_full();
        self.changed.notify_all();
    }

    /// Truncates the unused end of the file. If that fails, the file stays longer for a while.
    fn shrink(&self) {
        let end = self.state().space.end();
        if let Some(file) = self.file().as_mut() {
            let _ = file.cut(end);
        }
    }

    /// Notes that a step of `bytes` no longer waits.
    fn waits_no_more(&self, bytes: usize) {
        let mut state = self.state();
        state.waiting_bytes -= bytes;
        state.try_again_if_full();
        self.changed.notify_all();
    }
}
