//! A byte stream in blocks of LZ4 (Collet, "LZ4 Block Format Description"). Data passes through one block when it is
//! packed and unpacked, so that neither needs a second copy of everything.
//!
//! A block is its unpacked length in four bytes, its packed length in four bytes, and the packed bytes; all numbers are
//! little-endian.

use std::io::{BufRead, Error, ErrorKind, Write};

use crate::format::FormatError;

type Result<T, E = Error> = std::result::Result<T, E>;

/// Unpacked bytes of a block.
const BLOCK_BYTES: usize = 1 << 20;

const CUT: FormatError = FormatError::Damaged("an undo step ends too early");

/// Packs bytes to a writer.
pub struct BlockWriter<'a> {
    out: &'a mut dyn Write,
    block: Vec<u8>,
}

impl<'a> BlockWriter<'a> {
    pub fn new(out: &'a mut dyn Write) -> BlockWriter<'a> {
        BlockWriter { out, block: Vec::new() }
    }

    pub fn bytes(&mut self, mut bytes: &[u8]) -> Result<()> {
        while self.block.len() + bytes.len() >= BLOCK_BYTES {
            let (fits, rest) = bytes.split_at(BLOCK_BYTES - self.block.len());
            self.block.extend_from_slice(fits);
            self.flush()?;
            bytes = rest;
        }
        self.block.extend_from_slice(bytes);
        Ok(())
    }

    pub fn u32(&mut self, value: u32) -> Result<()> {
        self.bytes(&value.to_le_bytes())
    }

    pub fn u64(&mut self, value: u64) -> Result<()> {
        self.bytes(&value.to_le_bytes())
    }

    /// Packs the last block.
    pub fn finish(mut self) -> Result<()> {
        self.flush()
    }

    fn flush(&mut self) -> Result<()> {
        if !self.block.is_empty() {
            let packed = lz4_flex::block::compress(&self.block);
            self.out.write_all(&(self.block.len() as u32).to_le_bytes())?;
            self.out.write_all(&(packed.len() as u32).to_le_bytes())?;
            self.out.write_all(&packed)?;
            self.block.clear();
        }
        Ok(())
    }
}

/// Unpacks the output of a [`BlockWriter`].
pub struct BlockReader<'a> {
    source: &'a mut dyn BufRead,
    packed: Vec<u8>,
    block: Vec<u8>,
    /// Number of bytes of the block that have been read.
    at: usize,
}

impl<'a> BlockReader<'a> {
    pub fn new(source: &'a mut dyn BufRead) -> BlockReader<'a> {
        BlockReader { source, packed: Vec::new(), block: Vec::new(), at: 0 }
    }

    /// Returns whether nothing is left.
    pub fn is_empty(&mut self) -> Result<bool> {
        Ok(self.at == self.block.len() && self.source.fill_buf()?.is_empty())
    }

    /// Fills `out`.
    pub fn fill(&mut self, mut out: &mut [u8]) -> Result<(), FormatError> {
        while !out.is_empty() {
            if self.at == self.block.len() {
                self.next_block()?;
            }
            let count = out.len().min(self.block.len() - self.at);
            let (now, later) = out.split_at_mut(count);
            now.copy_from_slice(&self.block[self.at..self.at + count]);
            self.at += count;
            out = later;
        }
        Ok(())
    }

    pub fn u32(&mut self) -> Result<u32, FormatError> {
        let mut bytes = [0; 4];
        self.fill(&mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }

    pub fn u64(&mut self) -> Result<u64, FormatError> {
        let mut bytes = [0; 8];
        self.fill(&mut bytes)?;
        Ok(u64::from_le_bytes(bytes))
    }

    fn next_block(&mut self) -> Result<(), FormatError> {
        let mut number = || -> Result<usize, FormatError> {
            let mut bytes = [0; 4];
            self.source.read_exact(&mut bytes).map_err(cut)?;
            Ok(u32::from_le_bytes(bytes) as usize)
        };
        let (plain, packed) = (number()?, number()?);
        let most = lz4_flex::block::get_maximum_output_size(BLOCK_BYTES);
        if plain == 0 || plain > BLOCK_BYTES || packed > most {
            return Err(FormatError::Damaged("a block has an impossible length"));
        }
        self.packed.resize(packed, 0);
        self.source.read_exact(&mut self.packed).map_err(cut)?;
        self.block.resize(plain, 0);
        let unpacked = lz4_flex::block::decompress_into(&self.packed, &mut self.block);
        if unpacked.ok() != Some(plain) {
            return Err(FormatError::Damaged("a part does not unpack"));
        }
        self.at = 0;
        Ok(())
    }
}

/// Converts the error of a reader that ends too early to that of damage.
pub(super) fn cut(error: Error) -> FormatError {
    match error.kind() {
        ErrorKind::UnexpectedEof => CUT,
        _ => FormatError::Io(error),
    }
}
