//! A packed step in the file, in parts: neither packing nor unpacking has more than one of them in memory.
//!
//! Each part has its own position, and a checksum that is verified before any of it is used. The file holds packed
//! bytes alone, without record frames: it ends with the session, which keeps positions, lengths and checksums in
//! memory. `part_writer` writes the parts.
//! memory. `part_writer` writes them.

use std::io::{BufRead, Error, Read, Result};

use super::SharedSpill;
use crate::persist::frame::checksum;

/// A part of a step in the file.
#[derive(Clone, Copy, Debug)]
pub struct SpillPart {
    /// Position of its first byte.
    pub at: u64,
    /// Number of bytes.
    pub bytes: usize,
    /// Their CRC-32.
    pub checksum: u32,
}

/// Reads the parts of a step in order.
#[derive(Debug)]
pub struct PartReader<'a> {
    shared: &'a SharedSpill,
    parts: std::slice::Iter<'a, SpillPart>,
    buffer: Vec<u8>,
    /// Number of bytes of the buffer that have been read.
    read: usize,
}

impl<'a> PartReader<'a> {
    pub fn new(shared: &'a SharedSpill, parts: &'a [SpillPart]) -> PartReader<'a> {
        PartReader { shared, parts: parts.iter(), buffer: Vec::new(), read: 0 }
    }
}

impl BufRead for PartReader<'_> {
    fn fill_buf(&mut self) -> Result<&[u8]> {
        if self.read == self.buffer.len()
            && let Some(part) = self.parts.next()
        {
            self.buffer.resize(part.bytes, 0);
            self.read = 0;
            self.shared.read_at(part.at, &mut self.buffer)?;
            if checksum(&[&self.buffer]) != part.checksum {
                return Err(Error::other("the file has been changed or damaged"));
            }
        }
        Ok(&self.buffer[self.read..])
    }

    fn consume(&mut self, count: usize) {
        self.read += count;
    }
}

impl Read for PartReader<'_> {
    fn read(&mut self, out: &mut [u8]) -> Result<usize> {
        let count = self.fill_buf()?.read(out)?;
        self.consume(count);
        Ok(count)
    }
}
