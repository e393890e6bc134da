//! Checks memory against a budget before it is allocated, for the readers of all formats.
//!
//! Takes bytes needed and allowed; gives an error that says both in MiB. Knows no format and no file.

use super::FormatError;
use crate::sculpture::Limits;

/// Bytes that a file and its volume together may take.
pub(super) fn budget_bytes(limits: &Limits) -> u64 {
    limits.grid_bytes.saturating_add(limits.colour_bytes)
}

/// An error if more memory would be needed than allowed.
pub(super) fn check_budget(needed: u64, budget: u64) -> Result<(), FormatError> {
    if needed <= budget {
        return Ok(());
    }
    Err(FormatError::Memory { needed_mib: needed.div_ceil(1 << 20), budget_mib: budget >> 20 })
}
