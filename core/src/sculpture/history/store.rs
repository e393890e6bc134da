//! The interface of a store for steps that do not fit into memory. Knows no file; `spill` in the room `persist` is such
//! a store.

use std::fmt::Debug;
use std::sync::Arc;

use super::step::{Step, StoredChange};

/// Keeps steps outside the memory of a history.
pub trait StepStore: Debug + Send + Sync {
    /// Takes a step. Waits only while too many of the steps given to it before are still in memory. Gives the step back
    /// if it is full or has failed.
    fn keep(&self, step: Arc<Step>) -> Result<StoredChange, Arc<Step>>;
    /// Waits until a step of `bytes` can be made, or read, without exceeding the memory.
    fn make_room(&self, bytes: usize);
    /// Returns the most bytes that it takes; 0 if it has failed. A step that needs more memory than this is refused in
    /// advance.
    fn room_bytes(&self) -> u64;
}
