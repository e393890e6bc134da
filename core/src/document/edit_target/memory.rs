//! Checks the memory for existence bits before an edit: of the sculpture and its mask together.
//!
//! The bytes in use count, not the size of the box. Adding them up takes a walk over the tree, so an upper bound is kept:
//! the bytes once counted, and what all edits since may have added. Only where that exceeds the limit are they counted
//! again, and the growth by the edit computed closely.

use std::sync::atomic::{AtomicU64, Ordering};

use super::EditTarget;
use crate::document::CommandError;
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::Grid;
use crate::sculpture::bits_growth::bits_growth;
use crate::sculpture::edit::EditOp;
use crate::sculpture::edit_scope::ScopedRegion;
use crate::sculpture::region::Region;
use crate::sculpture::to_paint::PaintedWith;

/// An upper bound of the bytes in use; 0: unknown.
#[derive(Debug, Default)]
pub(super) struct BitsInUse(AtomicU64);

impl BitsInUse {
    /// Forgets the bound: the bits have changed otherwise than by edits.
    pub fn forget(&self) {
        self.0.store(0, Ordering::Relaxed);
    }
}

impl EditTarget {
    /// Returns an upper bound of the bytes by which an edit of a region, where tools may work, makes the sculpture's bits
    /// larger: a quick one, or a close one.
    pub fn bits_growth(&self, region: &impl Region, op: EditOp, is_close: bool) -> u64 {
        let adds = match op {
            EditOp::Add(_) => true,
            EditOp::Subtract => false,
            EditOp::Recolour(_) => return 0,
        };
        let (grid, scope) = (self.grid(), self.scope());
        match scope.is_everywhere() {
            true => bits_growth(grid, region, adds, is_close),
            false => bits_growth(grid, &ScopedRegion { region, scope }, adds, is_close),
        }
    }

    /// Returns an error if a change of these regions would need more memory than is allowed, for bits or for colours.
    pub fn check_memory<'a, R: Region + 'a>(
        &self,
        regions: impl Iterator<Item = &'a R> + Clone,
        painted: PaintedWith,
    ) -> Result<(), CommandError> {
        if let PaintedWith::Edit(op) = painted {
            let growth =
                |is_close| regions.clone().map(|r| self.bits_growth(r, op, is_close)).sum();
            self.check_bits_memory(growth)?;
        }
        self.check_colour_memory(|is_close| {
            regions.clone().map(|region| self.colour_growth(region, painted, is_close)).sum()
        })
    }

    /// Returns an error if a change would need more memory for bits than is allowed. `growth`: the bytes by which they
    /// become larger, as a quick upper bound (`false`) or a close one (`true`).
    pub fn check_bits_memory(&self, growth: impl Fn(bool) -> u64) -> Result<(), CommandError> {
        let budget = self.limits.grid_bytes;
        // The most for the sculpture and a mask.
        if Grid::bytes_for(self.grid().dims()).saturating_mul(2) <= budget {
            return Ok(());
        }
        let quick = growth(false);
        let bound = self.bits.0.load(Ordering::Relaxed);
        if bound > 0 && bound.saturating_add(quick) <= budget {
            self.bits.0.store(bound + quick, Ordering::Relaxed);
            return Ok(());
        }
        let used = self.grid().heap_bytes() + self.mask().map_or(0, Grid::heap_bytes);
        let close = if used.saturating_add(quick) <= budget { quick } else { growth(true) };
        // An edit that takes no more memory is always allowed.
        if close > 0 {
            let (what, purpose) = ("this may need", MemoryBudget::Grids);
            OverBudget::check(what, used.saturating_add(close), purpose, budget)?;
        }
        self.bits.0.store(used + close, Ordering::Relaxed);
        Ok(())
    }
}
