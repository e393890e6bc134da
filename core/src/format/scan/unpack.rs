//! Unpacks compressed scans, never more than their header requests.

use std::io::Read;

use crate::format::{FormatError, go_on};
use crate::progress::Progress;

/// Bytes between two reports of progress.
const PORTION_BYTES: usize = 1 << 20;

/// Skips `skip` bytes and reads exactly `bytes`; the rest is not examined.
pub fn exactly(
    reader: &mut dyn Read,
    skip: u64,
    bytes: u64,
    progress: &dyn Progress,
) -> Result<Vec<u8>, FormatError> {
    progress.begin("unpacking");
    let read = read_exactly(reader, skip, bytes, progress);
    progress.end();
    read
}

fn read_exactly(
    reader: &mut dyn Read,
    skip: u64,
    bytes: u64,
    progress: &dyn Progress,
) -> Result<Vec<u8>, FormatError> {
    let damaged = |error: std::io::Error| malformed("the compressed voxels", error.to_string());
    let skipped = std::io::copy(&mut reader.take(skip), &mut std::io::sink()).map_err(damaged)?;
    // Grows with the data: a stream may hold less than it should.
    let mut data = Vec::new();
    while skipped == skip && (data.len() as u64) < bytes {
        let portion = (bytes - data.len() as u64).min(PORTION_BYTES as u64);
        let got = reader.take(portion).read_to_end(&mut data).map_err(damaged)?;
        if got == 0 {
            break;
        }
        progress.advance(data.len() as f32 / bytes as f32);
        go_on(progress)?;
    }
    if data.len() as u64 != bytes {
        return Err(cut(bytes, data.len() as u64));
    }
    Ok(data)
}

/// Returns the error of a file that ends before its voxels do.
pub fn cut(expected: u64, found: u64) -> FormatError {
    malformed("the voxels", format!("{expected} bytes were expected, but there are {found}"))
}

/// Returns the error of invalid data in the file.
pub fn malformed(place: &str, what: impl Into<String>) -> FormatError {
    FormatError::Malformed { place: place.to_string(), what: what.into() }
}
