//! Memory for changes. The contents become the document's own before they are changed. A change for which the system
//! lacks memory is refused before anything has changed.
//!
//! Takes the document; copies its contents where a snapshot shares them.

use std::sync::Arc;

use super::{CommandError, Document};
use crate::sculpture::GridError;
use crate::sculpture::memory::NoMemory;
use crate::sculpture::record::BrickRecord;

impl Document {
    /// Makes the contents the document's own, so that they can be changed: where a save or another snapshot shares them, by a
    /// copy. An error if the system lacks the memory for it.
    pub(super) fn own_contents(&mut self) -> Result<(), CommandError> {
        if Arc::get_mut(&mut self.contents).is_none() {
            let copy = self.contents.copied().map_err(|error| self.no_memory(error))?;
            self.contents = Arc::new(copy);
        }
        Ok(())
    }

    pub(super) fn no_memory(&self, error: NoMemory) -> CommandError {
        GridError::NoMemory { dims: self.grid().dims(), needed_mib: error.mib() }.into()
    }

    /// [`Document::swap_bricks`], unless the system lacks the memory for it: then nothing has changed, and the record is
    /// given back.
    pub(super) fn try_swap_bricks(
        &mut self,
        record: BrickRecord,
    ) -> Result<BrickRecord, Box<(BrickRecord, CommandError)>> {
        if let Err(error) = self.own_contents() {
            return Err(Box::new((record, error)));
        }
        let bytes = record.reverse_bytes(&self.contents) as u64;
        let changes = !record.is_empty();
        match record.try_swap(Arc::make_mut(&mut self.contents), &mut self.dirty) {
            Ok(reverse) => {
                self.revision += u64::from(changes);
                Ok(reverse)
            }
            Err(record) => Err(Box::new((*record, self.no_memory(NoMemory { bytes })))),
        }
    }
}
