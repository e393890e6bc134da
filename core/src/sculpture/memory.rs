//! Allocations of about a grid's size, which may fail: memory is allocated before anything changes, so that a command
//! can be refused instead of the program being terminated.
//!
//! Knows no grid and no command.

use std::collections::TryReserveError;
use std::hint::black_box;

/// The system does not provide the memory.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct NoMemory {
    /// Bytes that were needed.
    pub bytes: u64,
}

impl NoMemory {
    /// Returns the MiB that were needed.
    pub fn mib(self) -> u64 {
        self.bytes.div_ceil(1 << 20)
    }
}

/// Returns a copy of a list of values whose own copies need no memory.
pub fn copied<T: Clone>(values: &[T]) -> Result<Vec<T>, TryReserveError> {
    let mut list = Vec::new();
    list.try_reserve_exact(values.len())?;
    list.extend_from_slice(values);
    Ok(list)
}

/// Fails if the system does not provide this many bytes at present. Takes none of them: for memory that is allocated in
/// small pieces afterwards.
pub fn probe(bytes: usize) -> Result<(), TryReserveError> {
    let mut memory: Vec<u8> = Vec::new();
    memory.try_reserve_exact(bytes)?;
    // Without this, the compiler may leave out an allocation that nothing uses.
    black_box(&memory);
    Ok(())
}
