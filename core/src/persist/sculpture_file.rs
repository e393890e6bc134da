//! The file of a sculpture in a session, and the record that holds it in journals and saved histories.

use std::path::PathBuf;

use super::frame::RecordBuffer;
use super::payload::{put_bytes, put_text, take_bytes, take_text, take_u64};
use crate::command::text::{parse_path, path_text};
use crate::format::{FormatError, Texts};
use crate::sculpture::orientation::Up;

const DAMAGED: FormatError =
    FormatError::Damaged("the checkpoint of the journal has no known form");

/// The file of a sculpture in a session.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SculptureFile {
    /// The sculpture: [`State::sculpture`](crate::sculpture::history::State::sculpture).
    pub sculpture: u64,
    /// Its path.
    pub path: Option<PathBuf>,
    /// Texts of the file, which are saved with it.
    pub texts: Texts,
    /// Number of the state that the file contains.
    pub saved: Option<u64>,
    /// The number of the state in which it was read, and the axis that was assumed to point up.
    pub assumed_up: Option<(u64, Up)>,
}

impl SculptureFile {
    /// Returns a record of the given kind that holds it.
    pub(super) fn to_record_of(&self, kind: u8) -> RecordBuffer {
        let mut record = RecordBuffer::new(kind);
        let out = record.payload();
        out.extend_from_slice(&self.sculpture.to_le_bytes());
        put_text(&self.path.as_deref().map(path_text).unwrap_or_default(), out);
        let number = |value: Option<u64>| value.map(|n| n.to_string()).unwrap_or_default();
        put_text(&number(self.saved), out);
        put_text(&number(self.assumed_up.map(|(number, _)| number)), out);
        put_text(&self.assumed_up.map(|(_, up)| up.to_string()).unwrap_or_default(), out);
        for (_, text) in self.texts.named() {
            put_bytes(text, out);
        }
        record
    }

    /// Reads the payload of such a record.
    pub(super) fn from_payload(payload: &[u8]) -> Result<SculptureFile, FormatError> {
        let rest = &mut &payload[..];
        let sculpture = take_u64(rest)?;
        let path = match take_text(rest)? {
            "" => None,
            text => Some(parse_path(text).map_err(|_| DAMAGED)?),
        };
        let number = |text: &str| match text {
            "" => Ok(None),
            text => text.parse::<u64>().map(Some).map_err(|_| DAMAGED),
        };
        let saved = number(take_text(rest)?)?;
        let read_at = number(take_text(rest)?)?;
        let up = take_text(rest)?;
        let assumed_up = match read_at {
            Some(number) => Some((number, up.parse().map_err(|_| DAMAGED)?)),
            None => None,
        };
        let mut texts = Texts::default();
        let Texts { description, courtesy, parameter, comment } = &mut texts;
        for text in [description, courtesy, parameter, comment] {
            *text = take_bytes(rest)?.to_vec();
        }
        Ok(SculptureFile { sculpture, path, texts, saved, assumed_up })
    }
}
