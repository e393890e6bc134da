//! Tests the splitting of streams and the decoding of pictures, valid and damaged.

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use proptest::prelude::*;

use super::frame::VideoFrame;
use super::jpeg::{Splitter, decode};
use super::reader::Decoded;

/// Returns a soft picture, different for each `seed`, that compresses with little loss.
fn pixels(width: u16, height: u16, seed: u8) -> Vec<u8> {
    let mut rgb = Vec::new();
    for y in 0..u32::from(height) {
        for x in 0..u32::from(width) {
            let (x, y, seed) =
                (x * 255 / u32::from(width), y * 255 / u32::from(height), u32::from(seed));
            rgb.extend([x / 2 + 20 + seed * 10, y / 2 + 60, (255 - x) / 2 + 60].map(|v| v as u8));
        }
    }
    rgb
}

fn encoded(
    width: u16,
    height: u16,
    seed: u8,
    change: impl Fn(&mut Encoder<&mut Vec<u8>>),
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, 95);
    change(&mut encoder);
    encoder.encode(&pixels(width, height, seed), width, height, ColorType::Rgb).unwrap();
    bytes
}

fn plain(seed: u8) -> Vec<u8> {
    encoded(48, 32, seed, |_| ())
}

/// Returns the picture without its Huffman tables, as webcams send it.
fn without_tables(jpeg: &[u8]) -> Vec<u8> {
    let (mut out, mut at) = (jpeg[..2].to_vec(), 2);
    while jpeg[at + 1] != 0xDA {
        let length = 2 + usize::from(u16::from_be_bytes([jpeg[at + 2], jpeg[at + 3]]));
        if jpeg[at + 1] != 0xC4 {
            out.extend_from_slice(&jpeg[at..at + length]);
        }
        at += length;
    }
    out.extend_from_slice(&jpeg[at..]);
    out
}

/// Returns everything that a splitter finds in bytes delivered in pieces.
fn cut(bytes: &[u8], piece: usize) -> (Vec<Vec<u8>>, u64) {
    let (mut splitter, mut found) = (Splitter::new(), Vec::new());
    for mut bytes in bytes.chunks(piece.max(1)) {
        while !bytes.is_empty() {
            let (used, whole) = splitter.feed(bytes);
            assert!(used > 0 && used <= bytes.len());
            bytes = &bytes[used..];
            if whole {
                let mut picture = Vec::new();
                splitter.swap_picture(&mut picture);
                found.push(picture);
            }
        }
    }
    splitter.reset();
    (found, splitter.take_broken())
}

fn worst_difference(jpeg: &[u8], rgb: &[u8]) -> u8 {
    let mut frame = VideoFrame::empty();
    match decode(jpeg, "test", &mut frame) {
        Decoded::Whole => {}
        Decoded::Broken(error) => panic!("{error}"),
    }
    let expected = rgb.as_chunks::<3>().0;
    let got = frame.pixels.as_chunks::<4>().0;
    assert_eq!(got.len(), expected.len());
    assert!(got.iter().all(|pixel| pixel[3] == 255));
    let differences =
        got.iter().zip(expected).flat_map(|(got, rgb)| (0..3).map(|c| got[c].abs_diff(rgb[c])));
    differences.max().unwrap()
}

#[test]
fn the_kinds_that_cameras_send() {
    let kinds: [(&str, Vec<u8>); 7] = [
        ("4:2:0", encoded(50, 38, 1, |e| e.set_sampling_factor(SamplingFactor::F_2_2))),
        ("4:2:2", encoded(50, 38, 1, |e| e.set_sampling_factor(SamplingFactor::F_2_1))),
        ("4:4:4", encoded(50, 38, 1, |e| e.set_sampling_factor(SamplingFactor::F_1_1))),
        ("4:4:0", encoded(50, 38, 1, |e| e.set_sampling_factor(SamplingFactor::F_1_2))),
        ("own tables", encoded(50, 38, 1, |e| e.set_optimized_huffman_tables(true))),
        ("restarts", encoded(50, 38, 1, |e| e.set_restart_interval(2))),
        ("progressive", encoded(50, 38, 1, |e| e.set_progressive(true))),
    ];
    let rgb = pixels(50, 38, 1);
    for (kind, jpeg) in kinds {
        // Twice, with noise between and after, like cameras that pad their buffers.
        let stream = [&jpeg[..], &[0, 0xFF, 0, 7], &jpeg[..], &[0; 9]].concat();
        for piece in [1, 7, stream.len()] {
            let (found, broken) = cut(&stream, piece);
            assert_eq!((found.len(), broken), (2, 0), "{kind} in pieces of {piece}");
            assert!(found.iter().all(|picture| *picture == jpeg), "{kind}");
        }
        let worst = worst_difference(&jpeg, &rgb);
        assert!(worst < 12, "{kind}: {worst}");
    }
    let mut grey = Vec::new();
    let luma: Vec<u8> = (0..64 * 16).map(|i| (i % 64 * 4) as u8).collect();
    Encoder::new(&mut grey, 95).encode(&luma, 64, 16, ColorType::Luma).unwrap();
    let rgb: Vec<u8> = luma.iter().flat_map(|&y| [y; 3]).collect();
    assert!(worst_difference(&grey, &rgb) < 12);
}

#[test]
fn tables_that_a_webcam_leaves_out_are_the_standard_ones() {
    let whole = plain(3);
    let bare = without_tables(&whole);
    assert!(bare.len() < whole.len() - 300);
    let (found, broken) = cut(&bare, 1000);
    assert_eq!((found.len(), broken), (1, 0));
    let (mut with, mut without) = (VideoFrame::empty(), VideoFrame::empty());
    assert!(matches!(decode(&whole, "a", &mut with), Decoded::Whole));
    assert!(matches!(decode(&found[0], "b", &mut without), Decoded::Whole));
    assert_eq!(with.pixels, without.pixels);
}

#[test]
fn a_thumbnail_inside_is_not_a_picture() {
    let (inner, outer) = (plain(1), plain(2));
    let mut nested = outer[..2].to_vec();
    nested.extend([0xFF, 0xE1]);
    nested.extend((inner.len() as u16 + 2).to_be_bytes());
    nested.extend(&inner);
    nested.extend(&outer[2..]);
    let (found, broken) = cut(&nested, 11);
    assert_eq!((found, broken), (vec![nested], 0));
}

#[test]
fn a_picture_that_breaks_off_costs_only_itself() {
    let jpeg = plain(1);
    for at in [3, 20, 200, jpeg.len() / 2, jpeg.len() - 3, jpeg.len() - 1] {
        let (found, broken) = cut(&[&jpeg[..at], &jpeg[..], &jpeg[..at]].concat(), 64);
        // After a cut in a segment, the following picture counts as its content.
        assert!(found.len() <= 1 && broken >= 1, "{at}: {} {broken}", found.len());
        let (found, _) = cut(&[&jpeg[..at], &jpeg[..], &jpeg[..], &jpeg[..]].concat(), 64);
        assert!(found.len() >= 2 && found.last() == Some(&jpeg), "{at}");
    }
}

#[test]
fn nonsense_is_broken_and_bounded() {
    let mut frame = VideoFrame::empty();
    let jpeg = plain(1);
    let huge = {
        // The size in the frame header: 0xFFC0, length, precision, height, width.
        let at = jpeg.windows(2).position(|w| w == [0xFF, 0xC0]).unwrap();
        let mut huge = jpeg.clone();
        huge[at + 5..at + 9].fill(0xFF);
        huge
    };
    for bad in [&b""[..], b"\xFF\xD8", b"hello", &jpeg[..300], &huge] {
        assert!(matches!(decode(bad, "x", &mut frame), Decoded::Broken(_)), "{}", bad.len());
    }
    assert!(frame.pixels.len() < 1 << 20);
    // 40 MiB of coded data without an end are dropped, not kept.
    let mut splitter = Splitter::new();
    splitter.feed(&jpeg[..jpeg.len() - 2]);
    let block = vec![1; 1 << 20];
    for _ in 0..40 {
        assert!(!splitter.feed(&block).1);
    }
    assert_eq!(splitter.take_broken(), 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn mutated_streams_never_panic_the_caller(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12),
        kind in 0usize..3,
        piece in 1usize..500,
    ) {
        let jpeg = match kind {
            0 => plain(1),
            1 => encoded(40, 24, 2, |e| e.set_progressive(true)),
            _ => without_tables(&encoded(40, 24, 2, |e| e.set_restart_interval(1))),
        };
        let mut stream = [&jpeg[..], &jpeg[..]].concat();
        for (at, value) in changes {
            let at = at.index(stream.len());
            stream[at] = value;
        }
        let (found, _) = cut(&stream, piece);
        prop_assert!(found.len() <= 3);
        let mut frame = VideoFrame::empty();
        for picture in found {
            let _ = decode(&picture, "fuzz", &mut frame);
        }
    }

    #[test]
    fn noise_never_panics_the_splitter(bytes in prop::collection::vec(
        prop_oneof![Just(0xFFu8), Just(0xD8), Just(0xD9), Just(0xDA), Just(0), any::<u8>()], 0..600,
    ), piece in 1usize..50) {
        let (found, _) = cut(&bytes, piece);
        prop_assert!(found.iter().map(Vec::len).sum::<usize>() <= bytes.len() + 9 * found.len());
        prop_assert_eq!(found, cut(&bytes, 1).0);
    }
}
