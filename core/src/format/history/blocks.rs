//! A stream of bytes in blocks of LZ4 (Collet, "LZ4 Block Format Description"): what is packed and unpacked
//! passes through one block, so that neither needs a second copy of everything.
//!
//! A block is four bytes with its length unpacked, four with its length packed, and the packed bytes; all
//! numbers are little-endian.

use crate::format::FormatError;

/// Plain bytes of a block.
const BLOCK_BYTES: usize = 1 << 20;

const CUT: FormatError = FormatError::Damaged("a part ends too early");

/// Packs bytes to the end of a buffer.
#[derive(Debug)]
pub struct BlockWriter<'a> {
    out: &'a mut Vec<u8>,
    block: Vec<u8>,
}

impl<'a> BlockWriter<'a> {
    pub fn new(out: &'a mut Vec<u8>) -> BlockWriter<'a> {
        BlockWriter { out, block: Vec::new() }
    }

    pub fn bytes(&mut self, mut bytes: &[u8]) {
        while self.block.len() + bytes.len() >= BLOCK_BYTES {
            let (fits, rest) = bytes.split_at(BLOCK_BYTES - self.block.len());
            self.block.extend_from_slice(fits);
            self.flush();
            bytes = rest;
        }
        self.block.extend_from_slice(bytes);
    }

    pub fn u32(&mut self, value: u32) {
        self.bytes(&value.to_le_bytes());
    }

    pub fn u64(&mut self, value: u64) {
        self.bytes(&value.to_le_bytes());
    }

    /// Packs the last block.
    pub fn finish(mut self) {
        self.flush();
    }

    fn flush(&mut self) {
        if !self.block.is_empty() {
            let packed = lz4_flex::block::compress(&self.block);
            self.out.extend_from_slice(&(self.block.len() as u32).to_le_bytes());
            self.out.extend_from_slice(&(packed.len() as u32).to_le_bytes());
            self.out.extend_from_slice(&packed);
            self.block.clear();
        }
    }
}

/// Unpacks what a [`BlockWriter`] has packed.
#[derive(Debug)]
pub struct BlockReader<'a> {
    packed: &'a [u8],
    block: Vec<u8>,
    /// Bytes of the block that have been read.
    at: usize,
}

impl<'a> BlockReader<'a> {
    pub fn new(packed: &'a [u8]) -> BlockReader<'a> {
        BlockReader { packed, block: Vec::new(), at: 0 }
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.at == self.block.len() && self.packed.is_empty()
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
        let number = |bytes: [u8; 4]| u32::from_le_bytes(bytes) as usize;
        let (plain, rest) = self.packed.split_first_chunk().ok_or(CUT)?;
        let (packed, rest) = rest.split_first_chunk().ok_or(CUT)?;
        let (plain, packed) = (number(*plain), number(*packed));
        let (packed, rest) = rest.split_at_checked(packed).ok_or(CUT)?;
        if plain == 0 || plain > BLOCK_BYTES {
            return Err(FormatError::Damaged("a block has an impossible length"));
        }
        self.block.resize(plain, 0);
        let unpacked = lz4_flex::block::decompress_into(packed, &mut self.block);
        if unpacked.ok() != Some(plain) {
            return Err(FormatError::Damaged("a part does not unpack"));
        }
        (self.packed, self.at) = (rest, 0);
        Ok(())
    }
}
