//! Journals: bytes of the file, and payloads of records with correct checksums.

use sculpture_core::document::Limits;
use sculpture_core::persist::frame::{self, RecordBuffer};
use sculpture_core::persist::journal::AbandonedJournal;
use sculpture_core::session::{recover, summary};

use super::{fuzz, small};
use crate::journal::memory::Memory;
use crate::journal::{options, session};

const HEAD_BYTES: usize = 16;
const FRAME_BYTES: usize = 21;

/// Returns a journal with commands, strokes, an image, a file that was opened and one that was saved.
fn seed() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let [picture, saved] = ["a.png", "a.vsc"].map(|name| folder.path().join(name));
    image::RgbImage::from_pixel(2, 2, image::Rgb([9, 200, 30])).save(&picture).unwrap();
    let memory = Memory::default();
    let mut session = session(Limits::default());
    for line in ["subtract cuboid at=4,4,4 half=2", "copy", "undo"] {
        session.execute(&line.parse().unwrap(), &()).unwrap();
    }
    session.keep_journal(options(&memory)).unwrap();
    for line in [
        "redo".to_string(),
        "begin \"a stroke\"".to_string(),
        format!("texture {picture:?} cuboid at=8,8,8 half=4"),
        "end".to_string(),
        format!("save {saved:?}"),
        "new dims=9,9,9 colour=8".to_string(),
        format!("open {saved:?}"),
        "array count=2 step=1,0,0".to_string(),
        "orient upright=z".to_string(),
        "symmetry x=even".to_string(),
        "undo 2".to_string(),
        "paste at=1,1,1".to_string(),
    ] {
        let _ = session.execute(&line.parse().unwrap(), &());
    }
    session.wait_for_journal();
    memory.bytes("1.journal").unwrap()
}

/// Corrects the number and checksum of every record, and the head.
pub fn seal(bytes: &mut Vec<u8>) {
    let mut sealed = frame::head().to_vec();
    let mut at = HEAD_BYTES;
    let mut sequence = 0;
    while let Some(head) = bytes.get(at..at + FRAME_BYTES) {
        let mut length = [0; 8];
        length.copy_from_slice(&head[..8]);
        let payload = at + FRAME_BYTES;
        let end = usize::try_from(u64::from_le_bytes(length)).unwrap_or(usize::MAX);
        let end = payload.saturating_add(end).min(bytes.len());
        let mut record = RecordBuffer::new(head[16]);
        record.payload().extend_from_slice(&bytes[payload..end]);
        sealed.extend(record.sealed(sequence));
        sequence += 1;
        at = end;
    }
    *bytes = sealed;
}

#[test]
fn damaged_journals_do_no_harm() {
    if !trials::alone() {
        return;
    }
    fuzz("journal", 400, &[seed()], seal, |_, bytes| {
        let source = || match options(&Memory::with_journal(bytes)).journal_dir.open(1) {
            AbandonedJournal::Journal(source) => source,
            _ => panic!("it cannot be opened"),
        };
        let known = summary(source(), &small());
        let again = recover(source(), &small(), None, &());
        assert_eq!(known.is_ok(), again.is_ok(), "{known:?}");
        again.is_ok()
    });
}
