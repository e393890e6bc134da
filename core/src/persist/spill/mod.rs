//! Undo and redo steps on disk: the store of a history that takes more than memory is allowed.
//!
//! A thread of its own packs the steps (`format::history`) and writes them to one file; until then they stay in
//! memory, and their size is bounded. Packing and unpacking go in parts, each with a CRC-32. Where the disk is
//! full or fails, a message says so, steps are refused, and every further step tries again.
//! `file` is the file, `parts` are the parts of steps in it, `part_writer` writes them, `space` tracks which parts of
//! the file are in use, and `spilled_step` stands for a step. Knows no document.

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

use file::{Folder, Place, SpillFile};
use part_writer::{PartWriter, Stop};
use parts::Part;
use space::Space;
use spilled_step::SpilledStep;

use crate::format::history::write_step_to;
use crate::sculpture::history::{Step, StepStore, Stored};

/// Most packed bytes of a step that are in memory at a time.
const PART_BYTES: usize = 1 << 22;

/// Keeps steps in a file that is removed when this and the last step are gone.
#[derive(Debug)]
pub struct Spill {
    shared: Arc<Shared>,
    writer: Option<JoinHandle<()>>,
}

/// The state that the thread, the steps and the session share. Locks are taken in this order: a spilled step's, `file`,
/// `state`.
#[derive(Debug)]
struct Shared {
    place: Box<dyn PlaceSync>,
    file: Mutex<Option<Box<dyn SpillFile>>>,
    state: Mutex<State>,
    /// The state has changed.
    changed: Condvar,
    /// Most bytes of the file.
    max_bytes: u64,
    /// Most bytes of steps that wait to be written, if it is more than one.
    max_waiting_bytes: usize,
    /// Packed bytes of a step that are written at a time.
    part_bytes: usize,
}

trait PlaceSync: Place + Sync {}
impl<P: Place + Sync> PlaceSync for P {}

#[derive(Debug, Default)]
struct State {
    queue: VecDeque<Weak<SpilledStep>>,
    waiting_bytes: usize,
    space: Space,
    /// Why the first of the queue could not be written. It stays there.
    blocked: Option<Blocked>,
    /// Whether that is to be tried again.
    retry: bool,
    /// Whether the thread is writing.
    is_busy: bool,
    /// Whether the person was told that nothing can be written.
    told: bool,
    /// The message that the user has not been given yet.
    message: Option<String>,
    has_ended: bool,
}

#[derive(Clone, Copy, Debug)]
enum Blocked {
    /// There is no room within the bound.
    Full,
    /// The system's reason.
    Failed,
}

impl State {
    /// To be called when there may be more room than there was.
    fn try_again_if_full(&mut self) {
        if matches!(self.blocked, Some(Blocked::Full)) {
            self.blocked = None;
        }
    }
}

impl Spill {
    /// Returns a store in a folder that takes up to `max_bytes` of the disk, and keeps up to `max_waiting_bytes` in
    /// memory until they are written. Removes what killed sessions have left in the folder; its own file is made with
    /// the first step.
    ///
    /// # Errors
    /// If no thread can be made.
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
            Shared { place, file, state, changed, max_bytes, max_waiting_bytes, part_bytes };
        let shared = Arc::new(shared);
        let writer = shared.clone();
        let builder = std::thread::Builder::new().name("history".to_string());
        let writer = builder.spawn(move || writer.write_all())?;
        Ok(Spill { shared, writer: Some(writer) })
    }

    /// Returns the message for the user, once: that nothing can be written, or that it can again.
    pub fn take_message(&self) -> Option<String> {
        self.shared.state().message.take()
    }

    /// Most bytes of the file.
    pub fn max_bytes(&self) -> u64 {
        self.shared.max_bytes
    }

    /// Waits until what was given is written, or cannot be.
    pub fn wait(&self) {
        let goes_on = |state: &mut State| {
            let wants = !state.queue.is_empty() && (state.blocked.is_none() || state.retry);
            wants || state.is_busy
        };
        drop(self.shared.changed.wait_while(self.shared.state(), goes_on));
    }
}

impl StepStore for Spill {
    fn keep(&self, step: Arc<Step>) -> std::result::Result<Stored, Arc<Step>> {
        let shared = &self.shared;
        let bytes = step.heap_bytes();
        let mut state = shared.make_way(bytes);
        if state.blocked.is_some() {
            state.retry = true;
            shared.changed.notify_all();
            return Err(step);
        }
        let spilled = Arc::new(SpilledStep::new(step, shared.clone()));
        state.waiting_bytes += bytes;
        state.queue.push_back(Arc::downgrade(&spilled));
        shared.changed.notify_all();
        Ok(Stored(spilled))
    }

    fn make_way(&self, bytes: usize) {
        drop(self.shared.make_way(bytes));
    }

    fn room_bytes(&self) -> u64 {
        let mut state = self.shared.state();
        if matches!(state.blocked, Some(Blocked::Failed)) {
            // Steps that are refused now may find room the next time.
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
            // The thread has nothing to return: its errors have already been reported.
            let _ = writer.join();
        }
    }
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn file(&self) -> MutexGuard<'_, Option<Box<dyn SpillFile>>> {
        self.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits while so many bytes more would be too much in memory, if nothing keeps what waits from being written.
    fn make_way(&self, bytes: usize) -> MutexGuard<'_, State> {
        let too_much = |state: &mut State| {
            let waiting = state.waiting_bytes;
            let sum = waiting.saturating_add(bytes);
            state.blocked.is_none() && waiting > 0 && sum > self.max_waiting_bytes
        };
        let waited = self.changed.wait_while(self.state(), too_much);
        waited.unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the thread has let a step go that is not to be written any more.
    fn wait_for_release(&self, step: &Arc<Step>) {
        let is_held = |state: &mut State| state.is_busy && Arc::strong_count(step) > 1;
        drop(self.changed.wait_while(self.state(), is_held));
    }

    /// The thread: writes what waits until the session ends.
    fn write_all(&self) {
        loop {
            let idle = |state: &mut State| {
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
            // A step that nobody has any more needs no room.
            let spilled = first.and_then(|first| first.upgrade());
            let written = spilled.map_or(Ok(false), |spilled| self.write(&spilled));
            self.note(written);
        }
    }

    /// Notes how the first of the queue was written.
    fn note(&self, written: std::result::Result<bool, (Blocked, String)>) {
        let mut state = self.state();
        state.is_busy = false;
        match written {
            Ok(has_written) => {
                state.queue.pop_front();
                // The next one shows how it stands, if there is one.
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

    /// Writes a step. False if it is not needed any more.
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

    /// Writes bytes at a place of the file, which it makes if there is none.
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

    /// Reads bytes from a place of the file.
    fn read_at(&self, at: u64, bytes: &mut [u8]) -> Result<()> {
        match self.file().as_mut() {
            Some(file) => file.read_at(at, bytes),
            None => Err(std::io::ErrorKind::NotFound.into()),
        }
    }

    /// Makes parts of the file free.
    fn give_back(&self, parts: &[Part]) {
        let mut state = self.state();
        parts.iter().for_each(|part| state.space.give_back(part.at));
        state.try_again_if_full();
        self.changed.notify_all();
    }

    /// Cuts off the end of the file that is not in use. Should that fail, the file stays longer for a while.
    fn shrink(&self) {
        let end = self.state().space.end();
        if let Some(file) = self.file().as_mut() {
            let _ = file.cut(end);
        }
    }

    /// Notes that a step of so many bytes waits no more.
    fn waits_no_more(&self, bytes: usize) {
        let mut state = self.state();
        state.waiting_bytes -= bytes;
        state.try_again_if_full();
        self.changed.notify_all();
    }
}
