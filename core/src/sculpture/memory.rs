//! Allocations of about a grid's size, which may fail: memory is allocated before anything changes, so that a command
//! can be refused instead of the program being terminated.
//!
//! Knows no grid and no command.

use std::collections::TryReserveError;

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

/// Returns an error unless the system provides so many bytes now. They are not kept.
pub fn probe(bytes: usize) -> Result<(), TryReserveError> {
    let mut room = Vec::<u8>::new();
    room.try_reserve_exact(bytes)?;
    // Otherwise the allocation could be optimised away.
    std::hint::black_box(&room);
    Ok(())
}

/// Returns a list of `count` equal values.
pub fn filled<T: Clone>(value: T, count: usize) -> Result<Vec<T>, TryReserveError> {
    let mut list = Vec::new();
    list.try_reserve_exact(count)?;
    list.resize(count, value);
    Ok(list)
}

/// Returns a copy of a list of plain values.
pub fn copied<T: Copy>(values: &[T]) -> Result<Vec<T>, TryReserveError> {
    let mut list = Vec::new();
    list.try_reserve_exact(values.len())?;
    list.extend_from_slice(values);
    Ok(list)
}

/// Returns a list of copies that may need memory themselves.
pub(crate) fn copied_each<T>(
    values: &[T],
    copy: impl Fn(&T) -> Result<T, TryReserveError>,
) -> Result<Vec<T>, TryReserveError> {
    let mut list = Vec::new();
    list.try_reserve_exact(values.len())?;
    for value in values {
        list.push(copy(value)?);
    }
    Ok(list)
}
