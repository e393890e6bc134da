//! Reads binary files piece by piece: little-endian numbers, and errors that name the position.
//!
//! Never reads beyond the end, however long a file claims to be, and allocates nothing.

use super::FormatError;

/// The rest of a file, or of a part of it.
#[derive(Clone, Copy, Debug)]
pub struct Bytes<'a> {
    rest: &'a [u8],
    /// Position of `rest` in the file, in bytes.
    at: usize,
}

impl<'a> Bytes<'a> {
    /// Creates a reader of a whole file.
    pub fn new(file: &'a [u8]) -> Bytes<'a> {
        Bytes { rest: file, at: 0 }
    }

    /// Returns whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// Returns the bytes that are left.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Returns an error at the present position.
    pub fn fault(&self, what: impl Into<String>) -> FormatError {
        FormatError::Malformed { place: format!("byte {}", self.at), what: what.into() }
    }

    /// Returns the next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], FormatError> {
        let Some((taken, rest)) = self.rest.split_at_checked(count) else {
            let left = self.rest.len();
            return Err(self.fault(format!("{count} bytes should follow, but only {left} do")));
        };
        self.at += count;
        self.rest = rest;
        Ok(taken)
    }

    /// Returns a reader of the next `count` bytes.
    pub fn part(&mut self, count: usize) -> Result<Bytes<'a>, FormatError> {
        let at = self.at;
        Ok(Bytes { rest: self.take(count)?, at })
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], FormatError> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N)?);
        Ok(bytes)
    }

    /// Returns a byte.
    pub fn u8(&mut self) -> Result<u8, FormatError> {
        Ok(self.array::<1>()?[0])
    }

    /// Returns a number of 32 bits.
    pub fn u32(&mut self) -> Result<u32, FormatError> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    /// Returns a signed number of 32 bits.
    pub fn i32(&mut self) -> Result<i32, FormatError> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    /// Returns a signed number of 32 bits that is a count.
    pub fn count(&mut self, what: &str) -> Result<usize, FormatError> {
        let before = *self;
        let count = self.i32()?;
        usize::try_from(count).map_err(|_| before.fault(format!("{count} {what} cannot be")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_those_of_the_file_and_nothing_is_read_beyond_the_end() {
        let file = [1, 2, 0, 0, 0, 255, 255, 255, 255, 7];
        let mut bytes = Bytes::new(&file);
        assert_eq!(bytes.u8().unwrap(), 1);
        let mut part = bytes.part(8).unwrap();
        assert_eq!((part.u32().unwrap(), bytes.u8().unwrap()), (2, 7));
        let error = part.count("voxels").unwrap_err().to_string();
        assert!(error.contains("byte 5") && error.contains("-1 voxels"), "{error}");
        assert!(part.is_empty() && bytes.is_empty());
        let error = bytes.take(usize::MAX).unwrap_err().to_string();
        assert!(error.contains("byte 10") && error.contains("only 0"), "{error}");
    }
}
