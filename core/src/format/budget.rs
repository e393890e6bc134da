//! Checks memory against a budget before it is allocated, for the readers of all formats.
//!
//! Takes bytes needed and allowed; gives an error that says both in MiB. Knows no format and no file.

use super::FormatError;
use super::error::FEWER_BITS;
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::Limits;

/// Returns the memory that a file and its volume together may take, in bytes.
pub(super) fn budget_bytes(limits: &Limits) -> u64 {
    limits.grid_bytes.saturating_add(limits.colour_bytes)
}

/// Returns an error if more memory would be needed than allowed.
pub(super) fn check_budget(needed: u64, budget: u64) -> Result<(), FormatError> {
    let what = "reading this file needs";
    Ok(OverBudget::check(what, needed, MemoryBudget::GridsAndColours, budget)?)
}

/// An error if the colours of a file would need more memory than allowed.
pub(super) fn check_colour_budget(needed: u64, budget: u64) -> Result<(), FormatError> {
    let what = "reading this file needs";
    let checked = OverBudget::check(what, needed, MemoryBudget::Colours, budget);
    Ok(checked.map_err(|over| over.advise(FEWER_BITS))?)
}
