//! Tests round trips, against a decoder that follows the description literally.

use proptest::prelude::*;

use super::*;

/// Decodes sample by sample according to the description. An independent second opinion.
fn naive_decode(file: &[u8]) -> Vec<u8> {
    let bit = |i: usize| file.get(8 + i / 8).map_or(0, |b| usize::from(b >> (7 - i % 8) & 1));
    let mut at = 0;
    let mut take = |n: usize| {
        (0..n).fold(0, |v, _| {
            at += 1;
            v << 1 | bit(at - 1)
        })
    };
    let (skip, strip) = (take(2) + 1, take(16) + 1);
    let mut x: Vec<u8> = Vec::new();
    loop {
        let (n, c) = (take(7), take(3));
        if n == 0 {
            break;
        }
        for _ in 0..n {
            let w = if c == 0 { 0 } else { c + 1 };
            let r = if w == 0 { 0 } else { take(w) as i32 - (1 << (w - 1)) };
            let i = x.len();
            let left = if i == 0 { 0 } else { i32::from(x[i - 1]) };
            let above = if strip == 1 || i <= strip {
                0
            } else {
                i32::from(x[i - strip]) - i32::from(x[i - strip - 1])
            };
            x.push((r + left + above) as u8);
        }
    }
    let block = if &file[..8] == ID_V3E { skip << 24 } else { x.len().max(1) };
    let mut out = vec![0; x.len()];
    for (x, out) in x.chunks(block).zip(out.chunks_mut(block)) {
        let mut x = x.iter();
        for plane in 0..skip {
            out.iter_mut().skip(plane).step_by(skip).zip(&mut x).for_each(|(o, v)| *o = *v);
        }
    }
    out
}

/// Generates bytes with smooth, noisy and constant stretches.
fn samples() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec((0u32..9, 0usize..700, any::<u64>()), 0..12).prop_map(|parts| {
        let mut out: Vec<u8> = Vec::new();
        for (shift, count, seed) in parts {
            let mut state = seed | 1;
            for _ in 0..count {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                let noise = (state >> 56) as u8;
                let last = out.last().copied().unwrap_or(0);
                out.push(last.wrapping_add(noise.checked_shr(shift).unwrap_or(0)));
            }
        }
        out
    })
}

proptest! {
    #[test]
    fn decoding_inverts_encoding(
        plain in samples(),
        skip in 1usize..=4,
        strip in prop_oneof![1usize..40, 1usize..=600, Just(MAX_STRIP)],
        prefix in 0usize..500,
    ) {
        let file = encode(&plain, skip, strip, &());
        prop_assert_eq!(&naive_decode(&file), &plain);
        let stream = Stream::open(&file).unwrap().unwrap();
        prop_assert_eq!(stream.decoded_bytes(), plain.len() as u64);
        prop_assert_eq!(&stream.prefix(prefix)[..], &plain[..prefix.min(plain.len())]);
        prop_assert_eq!(stream.decode(&()), plain);
    }

    #[test]
    fn any_payload_decodes_as_described(
        payload in prop::collection::vec(any::<u8>(), 0..2000),
        v3e: bool,
    ) {
        let file = [if v3e { &ID_V3E[..] } else { &ID_V3D[..] }, &payload].concat();
        let stream = Stream::open(&file).unwrap().unwrap();
        prop_assert_eq!(stream.decode(&()), naive_decode(&file));
    }
}

/// Returns bytes that are smooth in places and noisy in others, quickly made.
fn landscape(len: usize) -> Vec<u8> {
    let mut state = 1u32;
    (0..len)
        .map(|i| {
            state = state.wrapping_mul(1664525).wrapping_add(1013904223);
            let noise = if i >> 12 & 7 == 3 { state >> 29 } else { 0 };
            ((i >> 6) as u32 + noise) as u8
        })
        .collect()
}

#[test]
fn blocks_meet_at_their_edges() {
    for skip in 1..=4 {
        // Just beyond one block; the last block ends within a plane.
        let plain = landscape(skip * PLANE_BLOCK + 2 * skip + 1);
        let file = encode(&plain, skip, 264, &());
        assert!(file.starts_with(ID_V3E));
        let stream = Stream::open(&file).unwrap().unwrap();
        assert_eq!(stream.prefix(1000), &plain[..1000]);
        assert!(stream.decode(&()) == plain, "skip {skip}");
    }
    let file = encode(&landscape(PLANE_BLOCK), 1, 264, &());
    assert!(file.starts_with(ID_V3D), "2^24 bytes are the most of v3d");
}

#[test]
fn the_smallest_volume_is_as_described() {
    // The worked example of the description: a 1x1x1 volume of value 7.
    let file: Vec<u8> = (0..25)
        .map(|i| {
            let hex = "444453207633640a000006fd086773da76f916f9159a7597d0";
            u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap()
        })
        .collect();
    let stream = Stream::open(&file).unwrap().unwrap();
    assert_eq!(stream.decode(&()), b"PVM\n1 1 1\n1\n\x07");
}

#[test]
fn other_files_and_versions_are_told_apart() {
    assert!(Stream::open(b"PVM\n1 1 1\n1\n\x07").unwrap().is_none());
    assert!(Stream::open(b"DDS v").unwrap().is_none());
    let error = Stream::open(b"DDS v9z\n____").unwrap_err().to_string();
    assert!(error.contains("v9z"), "{error}");
}
