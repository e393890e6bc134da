//! Records in a file, framed so that truncation or damage leaves the longest valid prefix readable.
//!
//! A file begins with a header of 16 bytes: `89 56 53 4A 0D 0A 1A 0A`, a version (u32) and the CRC-32 of both. Then
//! come records: length of the payload (u64), number of the record (u64, counted from 0), kind (u8), CRC-32 of these
//! and the payload (u32), payload. All numbers are little-endian. Reading ends at the first record that is incomplete,
//! has a wrong checksum, or has another number than expected.
//!
//! Journals and saved histories are such files. The file of [`spill`](super::spill) is not: no other process reads it,
//! so the lengths and checksums of its parts stay in memory, and it takes only `checksum` from here. Knows no meaning
//! of records.

use std::io::{Error, ErrorKind, Read, Result};

use super::files::{Appender, Syncer};

/// First bytes of a journal.
const MAGIC: [u8; 8] = [0x89, b'V', b'S', b'J', b'\r', b'\n', 0x1A, b'\n'];
/// Version of the framing and of the meaning of records.
pub const VERSION: u32 = 1;

const HEAD_BYTES: usize = 16;
const FRAME_BYTES: usize = 21;
/// Position of the checksum in the frame.
const CHECKSUM_AT: usize = 17;

/// Returns the header of a file.
pub fn head() -> [u8; HEAD_BYTES] {
    let mut head = [0; HEAD_BYTES];
    head[..8].copy_from_slice(&MAGIC);
    head[8..12].copy_from_slice(&VERSION.to_le_bytes());
    let checksum = checksum(&[&head[..12]]);
    head[12..].copy_from_slice(&checksum.to_le_bytes());
    head
}

/// A record to write: the payload is appended to `bytes`, then it is sealed.
#[derive(Debug)]
pub struct RecordBuffer {
    /// Frame and payload.
    bytes: Vec<u8>,
}

impl RecordBuffer {
    /// Creates a record without payload yet.
    pub fn new(kind: u8) -> RecordBuffer {
        let mut bytes = vec![0; FRAME_BYTES];
        bytes[16] = kind;
        RecordBuffer { bytes }
    }

    /// Creates a record with this payload.
    pub(crate) fn with_payload(kind: u8, payload: &[u8]) -> RecordBuffer {
        let mut record = RecordBuffer::new(kind);
        record.payload().extend_from_slice(payload);
        record
    }

    /// Returns the payload, to append to.
    pub fn payload(&mut self) -> &mut Vec<u8> {
        &mut self.bytes
    }

    /// Returns the complete record as number `sequence` of its file.
    pub fn sealed(mut self, sequence: u64) -> Vec<u8> {
        let length = (self.bytes.len() - FRAME_BYTES) as u64;
        self.bytes[..8].copy_from_slice(&length.to_le_bytes());
        self.bytes[8..16].copy_from_slice(&sequence.to_le_bytes());
        let (frame, payload) = self.bytes.split_at(FRAME_BYTES);
        let checksum = checksum(&[&frame[..CHECKSUM_AT], payload]);
        self.bytes[CHECKSUM_AT..FRAME_BYTES].copy_from_slice(&checksum.to_le_bytes());
        self.bytes
    }
}

/// Returns the CRC-32 of consecutive byte strings.
pub(super) fn checksum(parts: &[&[u8]]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    parts.iter().for_each(|part| crc.update(part));
    crc.finalize()
}

/// Appends records to a file that is being written, and numbers them.
#[derive(Debug)]
pub(super) struct RecordAppender {
    file: Box<dyn Appender>,
    /// Number of the next record.
    sequence: u64,
}

impl RecordAppender {
    /// Starts with an empty file.
    pub fn new(file: Box<dyn Appender>) -> RecordAppender {
        RecordAppender { file, sequence: 0 }
    }

    /// Appends the header, which precedes all records.
    pub(crate) fn append_head(&mut self) -> Result<()> {
        self.file.append(&head())
    }

    /// Appends a record in one write. Returns its size in bytes.
    pub fn append(&mut self, record: RecordBuffer) -> Result<u64> {
        let bytes = record.sealed(self.sequence);
        self.file.append(&bytes)?;
        self.sequence += 1;
        Ok(bytes.len() as u64)
    }

    /// Waits until the appended data is on disk: [`Appender::sync`].
    pub fn sync(&mut self) -> Result<()> {
        self.file.sync()
    }

    /// Returns a closure that syncs on another thread: [`Appender::syncer`].
    pub fn syncer(&self) -> Option<Syncer> {
        self.file.syncer()
    }

    /// Returns whether the file still has a name.
    pub fn is_there(&self) -> bool {
        self.file.is_there()
    }
}

/// A record as read.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Record {
    /// The kind of the payload.
    pub kind: u8,
    /// The payload.
    pub payload: Vec<u8>,
}

/// The reason why a file has no further record.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Ending {
    /// It ends after a record.
    Whole,
    /// It ends within a record, as when the power fails.
    Cut,
    /// The following bytes are no record that fits here.
    Damaged,
}

/// Reads the records of a file, as far as they are valid.
pub struct FileRecords {
    reader: Box<dyn Read + Send>,
    /// Number of bytes of the file that are left.
    left: u64,
    sequence: u64,
    ending: Option<Ending>,
}

impl FileRecords {
    /// Reads the header of a file of `bytes`.
    ///
    /// # Errors
    /// If it is no journal, or one of a version that this program does not read.
    pub fn new(mut reader: Box<dyn Read + Send>, bytes: u64) -> Result<FileRecords> {
        let mut first = [0; HEAD_BYTES];
        let refused = |what: &str| Error::new(ErrorKind::InvalidData, what);
        if reader.read_exact(&mut first).is_err() || !first.starts_with(&MAGIC) {
            return Err(refused("this is no journal, or its beginning is damaged"));
        }
        let [.., a, b, c, d] = first;
        if checksum(&[&first[..12]]) != u32::from_le_bytes([a, b, c, d]) {
            return Err(refused("the beginning of the journal is damaged"));
        }
        if first[8..12] != VERSION.to_le_bytes() {
            return Err(refused("the journal was written by another version of the program"));
        }
        let left = bytes.saturating_sub(HEAD_BYTES as u64);
        Ok(FileRecords { reader, left, sequence: 0, ending: None })
    }

    /// Returns the number of unread bytes of the file.
    pub(crate) fn bytes_left(&self) -> u64 {
        self.left
    }

    /// Returns why there was no further record; `None` while there may be one.
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    fn read(&mut self) -> std::result::Result<Record, Ending> {
        let mut frame = [0; FRAME_BYTES];
        match self.left {
            0 => return Err(Ending::Whole),
            left if left < FRAME_BYTES as u64 => return Err(Ending::Cut),
            _ => self.reader.read_exact(&mut frame).map_err(|_| Ending::Cut)?,
        }
        self.left -= FRAME_BYTES as u64;
        let number = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| frame[at + i]));
        let (length, sequence, kind) = (number(0), number(8), frame[16]);
        if sequence != self.sequence {
            return Err(Ending::Damaged);
        }
        // Never allocates more than the file has.
        if length > self.left {
            return Err(Ending::Cut);
        }
        let mut payload = Vec::new();
        let read = (&mut self.reader).take(length).read_to_end(&mut payload);
        if read.ok() != usize::try_from(length).ok() {
            return Err(Ending::Cut);
        }
        self.left -= length;
        let expected: [u8; 4] = std::array::from_fn(|i| frame[CHECKSUM_AT + i]);
        if checksum(&[&frame[..CHECKSUM_AT], &payload]) != u32::from_le_bytes(expected) {
            return Err(Ending::Damaged);
        }
        self.sequence += 1;
        Ok(Record { kind, payload })
    }
}

impl Iterator for FileRecords {
    type Item = Record;

    fn next(&mut self) -> Option<Record> {
        if self.ending.is_some() {
            return None;
        }
        self.read().map_err(|ending| self.ending = Some(ending)).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(payloads: &[&[u8]]) -> (Vec<u8>, Vec<usize>) {
        let (mut file, mut ends) = (head().to_vec(), vec![]);
        for (i, payload) in payloads.iter().enumerate() {
            let mut record = RecordBuffer::new(i as u8 + 3);
            record.payload().extend_from_slice(payload);
            file.extend(record.sealed(i as u64));
            ends.push(file.len());
        }
        (file, ends)
    }

    fn read(file: &[u8]) -> Option<(Vec<Record>, Ending)> {
        let bytes = file.len() as u64;
        let mut records =
            FileRecords::new(Box::new(std::io::Cursor::new(file.to_vec())), bytes).ok()?;
        let read: Vec<Record> = records.by_ref().collect();
        Some((read, records.ending().unwrap()))
    }

    const PAYLOADS: [&[u8]; 4] =
        [b"first", b"", b"\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", b"x"];

    #[test]
    fn cut_anywhere_all_whole_records_are_read() {
        let (file, ends) = file(&PAYLOADS);
        let (all, ending) = read(&file).unwrap();
        assert_eq!(all.iter().map(|r| &r.payload[..]).collect::<Vec<_>>(), PAYLOADS);
        assert_eq!(ending, Ending::Whole);
        for cut in 0..file.len() {
            let whole = ends.iter().filter(|end| **end <= cut).count();
            match read(&file[..cut]) {
                None => assert!(cut < HEAD_BYTES),
                Some((records, ending)) => {
                    assert_eq!(records, all[..whole]);
                    let at_end = cut == HEAD_BYTES || ends.contains(&cut);
                    assert_eq!(ending == Ending::Whole, at_end, "{cut}");
                }
            }
        }
    }

    #[test]
    fn with_any_byte_changed_the_records_before_it_are_read() {
        let (file, ends) = file(&PAYLOADS);
        let (all, _) = read(&file).unwrap();
        for at in 0..file.len() {
            for flip in [1, 0x80, 0xff] {
                let mut damaged = file.clone();
                damaged[at] ^= flip;
                let whole = ends.iter().filter(|end| **end <= at).count();
                match read(&damaged) {
                    None => assert!(at < HEAD_BYTES),
                    Some((records, ending)) => {
                        assert_eq!(records, all[..whole], "{at}");
                        assert_ne!(ending, Ending::Whole);
                    }
                }
            }
        }
    }

    #[test]
    fn records_that_are_lost_or_doubled_end_the_reading() {
        let (file, ends) = file(&PAYLOADS);
        let lost = [&file[..ends[0]], &file[ends[1]..]].concat();
        let doubled = [&file[..ends[1]], &file[ends[0]..]].concat();
        let zeros = [&file[..ends[1]], &[0; 400]].concat();
        for (file, left) in [(lost, 1), (doubled, 2), (zeros, 2)] {
            let (records, ending) = read(&file).unwrap();
            assert_eq!((records.len(), ending), (left, Ending::Damaged));
        }
        // A length that exceeds any memory.
        let mut vast = file[..ends[0]].to_vec();
        vast.extend([0xff; 8]);
        vast.extend(1u64.to_le_bytes());
        vast.extend([0; 5]);
        assert_eq!(read(&vast).unwrap().1, Ending::Cut);
    }
}
