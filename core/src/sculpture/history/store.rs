//! The place for steps that memory has no room for: the interface that a history needs. Knows no file;
//! `spill` in the room `persist` is such a store.

use std::fmt::Debug;
use std::sync::Arc;

use super::step::{Step, Stored};

/// Keeps steps outside the memory of a history.
pub trait StepStore: Debug + Send + Sync {
    /// Takes a step. Waits only while too much of the steps given to it before is still in memory. Gives the step back
    /// where it has no room or does not work.
    fn keep(&self, step: Arc<Step>) -> Result<Stored, Arc<Step>>;
    /// Waits until a step of so many bytes can be made, or read, without too much in memory.
    fn make_way(&self, bytes: usize);
    /// Most bytes that it takes; 0 while it does not work. A step that needs more memory than this is refused in
    /// advance.
    fn room_bytes(&self) -> u64;
}
