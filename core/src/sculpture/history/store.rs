//! The place for steps that memory has no room for: the interface that a history needs, and the placeholder of a stored
//! step. Knows no file; the room `spill` is such a store.

use std::fmt::Debug;
use std::sync::Arc;

use super::step::{Change, Contents, Step};

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

/// A step in a store. Its place there is free again once the last owner is gone.
pub trait StoredStep: Debug + Send + Sync {
    /// The change, to be reversed from `contents`, equal to the stored one to the byte. `is_last`: nobody will want it
    /// again. After an error the step is still there.
    ///
    /// # Errors
    /// If it cannot be read or is damaged: why, as a part of a sentence.
    fn load(&self, contents: &Contents, is_last: bool) -> Result<Change, String>;
    /// The step as `format::history` writes it.
    ///
    /// # Errors
    /// As [`StoredStep::load`].
    fn packed(&self) -> Result<Vec<u8>, String>;
    /// Bytes that the step takes in memory.
    fn whole_bytes(&self) -> usize;
}

/// The placeholder of a step in a store. Equal to itself alone.
#[derive(Clone, Debug)]
pub struct Stored(pub Arc<dyn StoredStep>);

impl Stored {
    /// Whether no snapshot shares it.
    pub fn is_only(&self) -> bool {
        Arc::strong_count(&self.0) == 1
    }
}

impl PartialEq for Stored {
    fn eq(&self, other: &Stored) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
