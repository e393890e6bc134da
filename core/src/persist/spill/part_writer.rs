//! Writes a packed step to the file, part by part, as long as it is needed.
//!
//! Takes the packed bytes of a step; gives its parts, or the reason why it was not written completely. Knows no
//! packing.

use std::io::{Error, Result, Write};

use super::SharedSpill;
use super::parts::SpillPart;
use super::spilled_step::SpilledStep;
use crate::persist::frame::checksum;

/// The reason why a step was not written completely.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Stop {
    /// The session has ended, or the step is no longer needed.
    NotNeeded,
    /// The file has reached its limit.
    Full,
    /// The system's reason.
    Failed(String),
}

/// Writes the packed bytes of a step. Its parts are freed if it is dropped before [`PartWriter::finish`].
#[derive(Debug)]
pub struct PartWriter<'a> {
    shared: &'a SharedSpill,
    spilled: &'a SpilledStep,
    /// Bytes that are not in a part yet.
    buffer: Vec<u8>,
    parts: Vec<SpillPart>,
    stop: Option<Stop>,
}

impl<'a> PartWriter<'a> {
    pub fn new(shared: &'a SharedSpill, spilled: &'a SpilledStep) -> PartWriter<'a> {
        PartWriter { shared, spilled, buffer: Vec::new(), parts: Vec::new(), stop: None }
    }

    /// Writes the last part. Returns the reason if this or an earlier write has failed.
    pub fn finish(mut self) -> std::result::Result<Vec<SpillPart>, Stop> {
        // A failure is recorded in `stop`.
        let _ = self.write_part();
        match self.stop.take() {
            None => Ok(std::mem::take(&mut self.parts)),
            Some(stop) => Err(stop),
        }
    }

    /// Notes that packing has failed, unless the cause was a failed write.
    pub fn fail(&mut self, why: &dyn std::fmt::Display) {
        self.stop.get_or_insert_with(|| Stop::Failed(why.to_string()));
    }

    fn stop(&mut self, stop: Stop) -> Error {
        self.stop.get_or_insert(stop);
        Error::other("nothing more is written")
    }

    fn write_part(&mut self) -> Result<()> {
        if self.stop.is_some() || self.buffer.is_empty() {
            return Ok(());
        }
        let (shared, bytes) = (self.shared, self.buffer.len());
        let Some(at) = shared.state().space.take(bytes as u64, shared.max_bytes) else {
            return Err(self.stop(Stop::Full));
        };
        self.parts.push(SpillPart { at, bytes, checksum: checksum(&[&self.buffer]) });
        if let Err(error) = shared.write_at(at, &self.buffer) {
            return Err(self.stop(Stop::Failed(error.to_string())));
        }
        self.buffer.clear();
        Ok(())
    }
}

impl Write for PartWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        if self.shared.state().has_ended || !self.spilled.is_waiting() {
            return Err(self.stop(Stop::NotNeeded));
        }
        let room = self.shared.part_bytes - self.buffer.len();
        let count = room.min(bytes.len());
        self.buffer.extend_from_slice(&bytes[..count]);
        if self.buffer.len() == self.shared.part_bytes {
            self.write_part()?;
        }
        Ok(count)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

impl Drop for PartWriter<'_> {
    fn drop(&mut self) {
        self.shared.give_back(&self.parts);
    }
}
