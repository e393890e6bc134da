//! The framing of VRPN traffic (version 07.xx): the cookie, messages on streams and in datagrams, and descriptions
//! of names. Takes and gives bytes; opens no sockets and does not interpret messages.
//!
//! A message is a header of six big-endian 32-bit words (length of header and payload, seconds,
//! microseconds, sender, type, sequence), the payload, and zeros up to a multiple of 8.

use std::time::Duration;

use thiserror::Error;

/// The message that each peer sends first: version and log mode, five NULs.
pub const COOKIE: [u8; 24] = *b"vrpn: ver. 07.38  0\0\0\0\0\0";
const COOKIE_FAMILY: &[u8] = b"vrpn: ver. 07.";

pub const HEADER_BYTES: usize = 24;
/// Longest payload on a stream.
pub const MAX_PAYLOAD_BYTES: usize = 64_000;
/// Longest datagram.
pub const MAX_DATAGRAM_BYTES: usize = 1472;
/// Upper bound for the ids of senders and types.
pub const MAX_IDS: usize = 2000;
/// Longest name of a sender or type.
pub const MAX_NAME_BYTES: usize = 95;

/// Message types with a fixed meaning; all others are described by the peer.
pub const SENDER_DESCRIPTION: i32 = -1;
pub const TYPE_DESCRIPTION: i32 = -2;
pub const UDP_DESCRIPTION: i32 = -3;

/// The reason why bytes are not valid VRPN.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Error)]
pub enum WireError {
    #[error("the peer is not VRPN 07.xx")]
    Cookie,
    #[error("a message claims to be {0} bytes, less than its header")]
    Short(u32),
    #[error("a message claims to be {0} bytes, more than is allowed")]
    Oversized(u32),
    #[error("a datagram ends within a message")]
    Truncated,
}

/// Checks whether the first 24 bytes of a peer are those of a supported version. Any existing mode of remote
/// logging (0 to 3) is accepted.
pub fn check_cookie(cookie: &[u8; 24]) -> Result<(), WireError> {
    let sound = cookie.starts_with(COOKIE_FAMILY) && (b'0'..=b'3').contains(&cookie[18]);
    if sound { Ok(()) } else { Err(WireError::Cookie) }
}

/// The sender's wall clock. All zero if the sender sets none.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Stamp {
    pub sec: u32,
    pub usec: u32,
}

impl Stamp {
    /// Returns the time since 1970; `None` if the sender set none or the microseconds are out of range.
    pub fn since_1970(self) -> Option<Duration> {
        (self != Self::default() && self.usec < 1_000_000)
            .then(|| Duration::new(u64::from(self.sec), self.usec * 1000))
    }
}

impl From<Duration> for Stamp {
    /// Stores seconds since 1970, modulo 2^32.
    fn from(since_1970: Duration) -> Self {
        Self { sec: since_1970.as_secs() as u32, usec: since_1970.subsec_micros() }
    }
}

/// One message, borrowed from the received bytes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Frame<'a> {
    pub stamp: Stamp,
    pub sender: i32,
    pub kind: i32,
    pub payload: &'a [u8],
}

/// Returns the first message of `bytes` and its length, padding included. Ok(None) if more bytes are needed.
pub fn split_frame(bytes: &[u8]) -> Result<Option<(Frame<'_>, usize)>, WireError> {
    let Some((header, rest)) = bytes.split_first_chunk::<HEADER_BYTES>() else {
        return Ok(None);
    };
    let word = |i: usize| {
        u32::from_be_bytes([header[4 * i], header[4 * i + 1], header[4 * i + 2], header[4 * i + 3]])
    };
    let claimed = word(0);
    let payload_bytes =
        (claimed as usize).checked_sub(HEADER_BYTES).ok_or(WireError::Short(claimed))?;
    if payload_bytes > MAX_PAYLOAD_BYTES {
        return Err(WireError::Oversized(claimed));
    }
    let padded_bytes = payload_bytes.next_multiple_of(8);
    if rest.len() < padded_bytes {
        return Ok(None);
    }
    let frame = Frame {
        stamp: Stamp { sec: word(1), usec: word(2) },
        sender: word(3) as i32,
        kind: word(4) as i32,
        payload: &rest[..payload_bytes],
    };
    Ok(Some((frame, HEADER_BYTES + padded_bytes)))
}

/// Returns the messages of a datagram; ends after the first error.
pub fn datagram_frames(datagram: &[u8]) -> impl Iterator<Item = Result<Frame<'_>, WireError>> {
    let mut rest = datagram;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        match split_frame(rest) {
            Ok(Some((frame, taken))) => {
                rest = &rest[taken..];
                Some(Ok(frame))
            }
            Ok(None) => {
                rest = &[];
                Some(Err(WireError::Truncated))
            }
            Err(error) => {
                rest = &[];
                Some(Err(error))
            }
        }
    })
}

/// Splits a stream into messages. Holds at most one unfinished message beyond the last push.
#[derive(Default, Debug)]
pub struct StreamReader {
    buffer: Vec<u8>,
    start: usize,
}

impl StreamReader {
    pub fn push(&mut self, bytes: &[u8]) {
        self.buffer.drain(..self.start);
        self.start = 0;
        self.buffer.extend_from_slice(bytes);
    }

    /// Returns the next complete message. After an error the stream is unusable.
    pub fn next_frame(&mut self) -> Result<Option<Frame<'_>>, WireError> {
        let Some((frame, taken)) = split_frame(&self.buffer[self.start..])? else {
            return Ok(None);
        };
        self.start += taken;
        Ok(Some(frame))
    }

    /// Returns the bytes allocated for the stream.
    pub fn capacity(&self) -> usize {
        self.buffer.capacity()
    }
}

/// Appends a message with its padding. `payload` is at most [`MAX_PAYLOAD_BYTES`].
pub fn write_frame(
    out: &mut Vec<u8>,
    stamp: Stamp,
    sender: i32,
    kind: i32,
    sequence: u32,
    payload: &[u8],
) {
    debug_assert!(payload.len() <= MAX_PAYLOAD_BYTES);
    let length = (HEADER_BYTES + payload.len()) as u32;
    for word in [length, stamp.sec, stamp.usec, sender as u32, kind as u32, sequence] {
        out.extend_from_slice(&word.to_be_bytes());
    }
    out.extend_from_slice(payload);
    out.resize(out.len() + payload.len().next_multiple_of(8) - payload.len(), 0);
}

/// Returns the payload that describes a name.
pub fn describe_name(name: &str) -> Vec<u8> {
    let bytes = &name.as_bytes()[..name.len().min(MAX_NAME_BYTES)];
    let mut payload = Vec::with_capacity(bytes.len() + 5);
    payload.extend_from_slice(&(bytes.len() as u32 + 1).to_be_bytes());
    payload.extend_from_slice(bytes);
    payload.push(0);
    payload
}

/// Returns the name described by a payload; `None` if it does not have that form.
pub fn described_name(payload: &[u8]) -> Option<&str> {
    let (length, text) = payload.split_first_chunk::<4>()?;
    let text = text.get(..usize::try_from(u32::from_be_bytes(*length)).ok()?)?;
    let name = text.strip_suffix(b"\0")?;
    if name.len() > MAX_NAME_BYTES || name.contains(&0) {
        return None;
    }
    std::str::from_utf8(name).ok()
}

/// The names of a peer's ids. Ids out of range are refused, so that the table is bounded.
#[derive(Clone, Debug)]
pub struct IdTable<T> {
    entries: Vec<Option<T>>,
}

impl<T> Default for IdTable<T> {
    fn default() -> Self {
        Self { entries: Vec::new() }
    }
}

impl<T> IdTable<T> {
    /// Adds an id. Returns false if it is out of range.
    pub fn describe(&mut self, id: i32, entry: T) -> bool {
        let Some(index) = usize::try_from(id).ok().filter(|index| *index < MAX_IDS) else {
            return false;
        };
        if self.entries.len() <= index {
            self.entries.resize_with(index + 1, || None);
        }
        self.entries[index] = Some(entry);
        true
    }

    pub fn get(&self, id: i32) -> Option<&T> {
        self.entries.get(usize::try_from(id).ok()?)?.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn frames_survive_any_cutting_of_the_stream(
            payloads in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..200), 0..12),
            cut in 1usize..97,
        ) {
            let mut bytes = Vec::new();
            for (i, payload) in payloads.iter().enumerate() {
                let stamp = Stamp { sec: i as u32, usec: 7 };
                write_frame(&mut bytes, stamp, i as i32, -4, i as u32, payload);
            }
            prop_assert_eq!(bytes.len() % 8, 0);
            let mut reader = StreamReader::default();
            let mut seen = 0;
            for chunk in bytes.chunks(cut) {
                reader.push(chunk);
                while let Some(frame) = reader.next_frame().unwrap() {
                    prop_assert_eq!(frame.payload, &payloads[seen][..]);
                    prop_assert_eq!((frame.sender, frame.kind, frame.stamp.sec), (seen as i32, -4, seen as u32));
                    seen += 1;
                }
            }
            prop_assert_eq!(seen, payloads.len());
            let whole: Result<Vec<_>, _> = datagram_frames(&bytes).collect();
            prop_assert_eq!(whole.unwrap().len(), payloads.len());
        }

        #[test]
        fn names_come_back(name in "[ -~]{0,95}") {
            let payload = describe_name(&name);
            prop_assert_eq!(described_name(&payload), Some(name.as_str()));
        }
    }

    #[test]
    fn lengths_are_not_believed() {
        let with_length = |length: u32| {
            let mut bytes = vec![0; 64];
            bytes[..4].copy_from_slice(&length.to_be_bytes());
            bytes
        };
        assert_eq!(split_frame(&with_length(0)), Err(WireError::Short(0)));
        assert_eq!(split_frame(&with_length(23)), Err(WireError::Short(23)));
        assert_eq!(split_frame(&with_length(u32::MAX)), Err(WireError::Oversized(u32::MAX)));
        assert_eq!(split_frame(&with_length(64_025)), Err(WireError::Oversized(64_025)));
        assert_eq!(split_frame(&with_length(64_024)), Ok(None));
        assert_eq!(split_frame(&with_length(64)).map(|f| f.map(|f| f.1)), Ok(Some(64)));
        assert_eq!(split_frame(&[0; 23]), Ok(None));
    }

    #[test]
    fn bad_names_and_ids_are_refused() {
        assert_eq!(described_name(b""), None);
        assert_eq!(described_name(b"\0\0\0\x05abcd"), None);
        assert_eq!(described_name(b"\xff\xff\xff\xffab\0"), None);
        assert_eq!(described_name(b"\0\0\0\0"), None);
        assert_eq!(described_name(b"\0\0\0\x03a\0\0"), None);
        assert_eq!(described_name(b"\0\0\0\x03\xff\xfe\0"), None);
        assert_eq!(described_name(b"\0\0\0\x03ab\0rest"), Some("ab"));
        let mut table = IdTable::default();
        assert!(
            !table.describe(-1, ()) && !table.describe(2000, ()) && !table.describe(i32::MIN, ())
        );
        assert!(table.describe(1999, ()));
        assert!(table.get(1999).is_some() && table.get(0).is_none() && table.get(-5).is_none());
    }

    #[test]
    fn cookies() {
        assert!(check_cookie(&COOKIE).is_ok());
        assert!(check_cookie(b"vrpn: ver. 07.12  2\0\0\0\0\0").is_ok());
        assert!(check_cookie(b"vrpn: ver. 06.38  0\0\0\0\0\0").is_err());
        assert!(check_cookie(b"vrpn: ver. 07.38  7\0\0\0\0\0").is_err());
        assert!(check_cookie(b"GET / HTTP/1.1\r\nHost: lo").is_err());
    }
}
