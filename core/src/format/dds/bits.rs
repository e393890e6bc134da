//! Bit fields at any position in a byte string, most significant bit first: a random-access reader for
//! decoding, and an appending writer for encoding.
//!
//! Positions count bits from the start. Knows no meaning of the fields.

/// The bits of `bytes`, followed by infinitely many zeros.
#[derive(Clone, Copy, Debug)]
pub struct BitSource<'a> {
    bytes: &'a [u8],
}

impl<'a> BitSource<'a> {
    pub fn new(bytes: &'a [u8]) -> BitSource<'a> {
        BitSource { bytes }
    }

    /// Returns the bits from `position` on, the first one highest. At least the first 57 are those of the source; the
    /// rest may be zero instead.
    #[inline(always)]
    pub(crate) fn peek57(&self, position: u64) -> u64 {
        let at = (position >> 3) as usize;
        let word = match self.bytes.get(at..).and_then(|rest| rest.first_chunk::<8>()) {
            Some(chunk) => u64::from_be_bytes(*chunk),
            None => self.last_word(at),
        };
        word << (position & 7)
    }

    /// Returns the next `bits` (1 to 57) bits from `position` on, as a number.
    #[inline(always)]
    pub fn field(&self, position: u64, bits: u32) -> u64 {
        self.peek57(position) >> (64 - bits)
    }

    #[cold]
    fn last_word(&self, at: usize) -> u64 {
        let mut chunk = [0u8; 8];
        if let Some(rest) = self.bytes.get(at..) {
            chunk[..rest.len()].copy_from_slice(rest);
        }
        u64::from_be_bytes(chunk)
    }
}

/// Bits appended one field after another.
#[derive(Clone, Debug, Default)]
pub struct BitSink {
    /// The complete bytes up to the end position, followed by spare room.
    bytes: Vec<u8>,
    end: End,
}

/// The end position of a sink. Kept apart from the bytes so that a loop of pushes keeps it in registers.
#[derive(Clone, Copy, Debug, Default)]
struct End {
    /// Number of complete bytes.
    filled: usize,
    /// Bits that do not fill a byte yet, highest first, and their number (0..8).
    pending: u64,
    pending_bits: u32,
}

impl End {
    /// Appends the lowest `bits` (0 to 56) bits of `value`, whose other bits must be zero.
    #[inline(always)]
    fn push(&mut self, bytes: &mut [u8], value: u64, bits: u32) {
        debug_assert!(bits <= 56 && value >> bits == 0);
        // In two steps, since pushing nothing with nothing pending would shift by 64.
        self.pending |= (value << (56 - bits)) << (8 - self.pending_bits);
        self.pending_bits += bits;
        bytes[self.filled..self.filled + 8].copy_from_slice(&self.pending.to_be_bytes());
        let whole = self.pending_bits >> 3;
        self.filled += whole as usize;
        // 63 bits may be pending, so at most 7 complete bytes: the shift stays below 64.
        self.pending <<= whole * 8;
        self.pending_bits &= 7;
    }
}

impl BitSink {
    /// Reserves room for `bytes` more bytes to be appended by [`BitSink::push`].
    #[inline]
    pub fn reserve(&mut self, bytes: usize) {
        let wanted = self.end.filled + bytes + 8;
        if self.bytes.len() < wanted {
            self.bytes.resize(wanted.max(2 * self.bytes.len()), 0);
        }
    }

    /// Appends the lowest `bits` (0 to 56) bits of `value`, whose other bits must be zero. Room must have been reserved
    /// with [`BitSink::reserve`].
    #[inline(always)]
    pub fn push(&mut self, value: u64, bits: u32) {
        self.end.push(&mut self.bytes, value, bits);
    }

    /// Appends many fields of `bits` bits as [`BitSink::push`] does.
    #[inline(always)]
    pub(crate) fn push_all(&mut self, values: impl Iterator<Item = u64>, bits: u32) {
        let mut end = self.end;
        values.for_each(|value| end.push(&mut self.bytes, value, bits));
        self.end = end;
    }

    /// Appends all bits of `other`.
    pub fn append(&mut self, other: &BitSink) {
        self.reserve(other.end.filled + 1);
        let (words, rest) = other.bytes[..other.end.filled].as_chunks::<7>();
        let word =
            |[a, b, c, d, e, f, g]: &[u8; 7]| u64::from_be_bytes([0, *a, *b, *c, *d, *e, *f, *g]);
        self.push_all(words.iter().map(word), 56);
        self.push_all(rest.iter().map(|&byte| u64::from(byte)), 8);
        if other.end.pending_bits > 0 {
            self.push(other.end.pending >> (64 - other.end.pending_bits), other.end.pending_bits);
        }
    }

    /// Returns all bits as bytes, the last one padded with zeros.
    pub fn into_bytes(mut self) -> Vec<u8> {
        if self.end.pending_bits > 0 {
            self.reserve(1);
            self.push(0, 8 - self.end.pending_bits);
        }
        self.bytes.truncate(self.end.filled);
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn pushed_bits_are_read_back(
            fields in prop::collection::vec((any::<u64>(), 0u32..=56), 0..200),
            cut in 0usize..200,
        ) {
            let fields: Vec<(u64, u32)> =
                fields.into_iter().map(|(v, bits)| (v & ((1 << bits) - 1), bits)).collect();
            let cut = cut.min(fields.len());
            let sink_of = |fields: &[(u64, u32)]| {
                let mut sink = BitSink::default();
                for &(value, bits) in fields {
                    sink.reserve(7);
                    sink.push(value, bits);
                }
                sink
            };
            let mut sink = sink_of(&fields[..cut]);
            sink.append(&sink_of(&fields[cut..]));
            let bytes = sink.into_bytes();
            let total: u64 = fields.iter().map(|f| u64::from(f.1)).sum();
            prop_assert_eq!(bytes.len() as u64, total.div_ceil(8));
            let source = BitSource::new(&bytes);
            let mut at = 0;
            for (value, bits) in fields {
                if bits > 0 { prop_assert_eq!(source.field(at, bits), value); }
                at += u64::from(bits);
            }
            prop_assert_eq!(source.field(at, 57), 0, "zeros follow");
        }
    }
}
