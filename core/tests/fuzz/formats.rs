//! Every file that can be opened: sculptures, volumes, scans, models, meshes and pictures.

use std::collections::BTreeSet;
use std::path::PathBuf;

use sculpture_core::format::options::{ImportOptions, MeshSize};
use sculpture_core::format::{self, READ_ENDINGS};

use super::{fuzz, small};
use crate::conversions;

/// Corrects the checksums of a sculpture's header and chunks, as far as they can be found.
fn seal_sculpture(bytes: &mut [u8]) {
    const HEADER: usize = 56;
    let number = |bytes: &[u8], at: usize| {
        u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]) as usize
    };
    if bytes.len() < HEADER {
        return;
    }
    let (chunks, texts) = (number(bytes, 44), number(bytes, 48));
    let Some(table) = chunks.checked_mul(16).filter(|table| *table <= bytes.len() - HEADER) else {
        return;
    };
    let Some(tail) = (HEADER + table).checked_add(texts).filter(|tail| *tail <= bytes.len()) else {
        return;
    };
    let mut at = tail;
    for entry in (HEADER..HEADER + table).step_by(16) {
        let end = (at + number(bytes, entry)).min(bytes.len());
        let checksum = crc32fast::hash(&bytes[at..end]);
        if end > at {
            bytes[entry + 12..entry + 16].copy_from_slice(&checksum.to_le_bytes());
        }
        at = end;
    }
    let mut crc = crc32fast::Hasher::new();
    crc.update(&bytes[..HEADER - 4]);
    crc.update(&bytes[HEADER..tail]);
    bytes[HEADER - 4..HEADER].copy_from_slice(&crc.finalize().to_le_bytes());
}

/// Corrects the checksums of the chunks of the first PNG image, which may lie within another file.
fn seal_png(bytes: &mut [u8]) {
    let Some(start) = bytes.windows(4).position(|four| four == b"\x89PNG") else { return };
    let mut at = start + 8;
    while let Some(head) = bytes.get(at..at + 8) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let Some(end) = at.checked_add(8 + length).filter(|end| end + 4 <= bytes.len()) else {
            return;
        };
        let checksum = crc32fast::hash(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&checksum.to_be_bytes());
        at = end + 4;
    }
}

#[test]
fn damaged_files_of_every_format_do_no_harm() {
    if !trials::alone() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let sources = conversions::sources(&folder);
    let name = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
    let mut unreadable = BTreeSet::new();
    for ending in READ_ENDINGS {
        let found = sources.iter().find(|path| name(path).split_once('.').unwrap().1 == ending);
        let path = found.unwrap_or_else(|| panic!("no file with {ending}"));
        let options =
            ImportOptions { mesh_size: MeshSize::LongestVx(12), ..conversions::options(path) };
        let seeds = [std::fs::read(path).unwrap()];
        let seal = |bytes: &mut Vec<u8>| match ending {
            "vsc" => seal_sculpture(bytes),
            "gox" => seal_png(bytes),
            _ => {}
        };
        let runs = if ending == "vsc" { 300 } else { 60 };
        fuzz(ending, runs, &seeds, seal, |_, bytes| {
            std::fs::write(path, bytes).unwrap();
            let loaded = format::load(path, &options, &small(), &());
            // The study that a dialog shows first.
            let studied = format::study(path, &options, &small(), &());
            for error in [loaded.as_ref().err(), studied.as_ref().err()].into_iter().flatten() {
                let text = error.to_string();
                if text.chars().any(char::is_control) {
                    unreadable.insert(format!("{ending}: {text:?}"));
                }
            }
            loaded.is_ok()
        });
        std::fs::write(path, &seeds[0]).unwrap();
    }
    assert!(unreadable.is_empty(), "{unreadable:#?}");
}

#[test]
fn damaged_sculptures_in_memory_and_pictures_do_no_harm() {
    if !trials::alone() {
        return;
    }
    let contents = conversions::shape();
    let file = format::write_sculpture(&contents, &Default::default()).unwrap();
    fuzz(
        "sculpture",
        400,
        &[file],
        |bytes| seal_sculpture(bytes),
        |_, bytes| format::read_sculpture(bytes, &small()).is_ok(),
    );
    let image =
        image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([(x * 20) as u8, (y * 30) as u8, 9]));
    let coded = |form| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, form).unwrap();
        bytes.into_inner()
    };
    let seeds = [coded(image::ImageFormat::Png)];
    fuzz("png", 400, &seeds, |bytes| seal_png(bytes), |_, bytes| format::picture_of(bytes).is_ok());
    let text = format::base64::encode(&seeds[0]).into_bytes();
    fuzz(
        "base64",
        1000,
        &[text],
        |_| {},
        |_, bytes| {
            format!("embed \"a\" data={}", String::from_utf8_lossy(bytes))
                .parse::<sculpture_core::command::Command>()
                .is_ok()
        },
    );
}
