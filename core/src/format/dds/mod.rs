//! The DDS stream, the lossless compression of .pvm files (from Stefan Roettger's V^3; unrelated to
//! DirectDraw textures): bytes -> bytes.
//!
//! A stream is an id, two parameters and runs of residuals, with no length, index or checksum. It is
//! processed in parallel as follows:
//! - Runs must be found sequentially, from head to head; [`Stream::open`] does only that, once. It
//!   yields the exact decoded length before anything is allocated, and the starts of segments.
//! - Segments are decoded in parallel, and the predictor is undone in each as if nothing came before;
//!   [`predict::Shift`] then corrects them. Planes are merged in pieces.
//! - Encoding knows all samples, so that its chunks are independent; their bits are concatenated.
//!
//! Works on whole byte strings, whatever they contain.

mod bits;
mod planes;
mod predict;
mod runs;
mod split;

use std::ops::Range;

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

use self::bits::{BitSink, BitSource};
use self::planes::StreamLayout;
use self::predict::{Carry, Unpredictor};
use self::runs::RunHead;
use self::split::Splitter;
use super::FormatError;
use crate::progress::Progress;

const ID_V3D: &[u8; 8] = b"DDS v3d\n";
const ID_V3E: &[u8; 8] = b"DDS v3e\n";
/// Bytes of each plane of a v3e block; longer streams are written as v3e.
const PLANE_BLOCK: usize = 1 << 24;
/// Bits of the parameters before the first run.
const PARAMETER_BITS: u64 = 18;
/// Longest distance of the predictor.
pub const MAX_STRIP: usize = 1 << 16;
/// Greatest number of planes.
pub const MAX_SKIP: usize = 4;
/// Number of samples after which the next run begins a new segment.
const SEGMENT_SAMPLES: u64 = 1 << 17;
/// Number of samples encoded by one worker at a time. Not a power of two: otherwise all stretches that are searched in
/// parallel would map to the same cache lines.
const CHUNK_SAMPLES: usize = split::LANES * 64 * 97;

/// A DDS stream whose runs have been found, not yet decoded.
#[derive(Debug)]
pub struct Stream<'a> {
    source: BitSource<'a>,
    version: &'static str,
    strip: usize,
    layout: StreamLayout,
    segments: Vec<Segment>,
    total: u64,
}

/// A position where decoding can begin.
#[derive(Clone, Copy, Debug)]
struct Segment {
    /// Position of the head of a run, in bits.
    bit: u64,
    /// Index of its first sample.
    sample: u64,
}

impl<'a> Stream<'a> {
    /// Finds the runs of a stream. `None` if `file` is something else; an error if it is a DDS stream of another
    /// version.
    pub fn open(file: &'a [u8]) -> Result<Option<Stream<'a>>, FormatError> {
        let Some((id, payload)) = file.split_first_chunk::<8>() else { return Ok(None) };
        let version = match id {
            ID_V3D => "DDS v3d",
            ID_V3E => "DDS v3e",
            _ if id.starts_with(b"DDS ") => {
                return Err(FormatError::DdsVersion(String::from_utf8_lossy(id).into_owned()));
            }
            _ => return Ok(None),
        };
        let source = BitSource::new(payload);
        let skip = source.field(0, 2) as usize + 1;
        let strip = source.field(2, 16) as usize + 1;
        let block_bytes = (id == ID_V3E).then_some(skip * PLANE_BLOCK);
        let mut stream = Stream {
            source,
            version,
            strip,
            layout: StreamLayout { skip, block_bytes },
            segments: Vec::new(),
            total: 0,
        };
        stream.find_segments();
        Ok(Some(stream))
    }

    fn find_segments(&mut self) {
        let (mut bit, mut sample, mut next) = (PARAMETER_BITS, 0, 0);
        loop {
            let head = RunHead::at(self.source, bit);
            if head.count == 0 {
                break;
            }
            if sample >= next {
                self.segments.push(Segment { bit, sample });
                next = sample + SEGMENT_SAMPLES;
            }
            sample += head.count as u64;
            bit += head.total_bits();
        }
        self.total = sample;
    }

    /// Returns the name of the kind of stream.
    pub fn version(&self) -> &'static str {
        self.version
    }

    /// Returns the decoded size in bytes.
    pub fn decoded_bytes(&self) -> u64 {
        self.total
    }

    /// Returns whether [`Stream::prefix`] has to scan much of the stream, and decoding takes twice the memory.
    pub(crate) fn header_is_scattered(&self) -> bool {
        self.layout.skip > 1
    }

    /// Returns the first `count` decoded bytes, or all if there are fewer, using little memory.
    pub fn prefix(&self, count: usize) -> Vec<u8> {
        let count = self.total.min(count as u64);
        // The prefix must not reach into the second block, which is far beyond any header.
        let count = count.min(self.layout.block_bytes.map_or(count, |b| b as u64));
        let ranges = self.layout.prefix_ranges(self.total, count);
        let end = ranges.last().map_or(0, |r| r.end);
        let mut unpredictor = Unpredictor::at(self.strip, 0);
        let mut planar = Vec::with_capacity(count as usize);
        let mut samples = Vec::new();
        for (segment, range) in self.segment_ranges() {
            if segment.sample >= end {
                break;
            }
            samples.resize((range.end - range.start) as usize, 0);
            runs::decode_runs(self.source, segment.bit, &mut samples);
            unpredictor.undo(&mut samples);
            for wanted in &ranges {
                let from = wanted.start.max(range.start);
                let to = wanted.end.min(range.end);
                if from < to {
                    let part = (from - range.start) as usize..(to - range.start) as usize;
                    planar.extend_from_slice(&samples[part]);
                }
            }
        }
        let mut natural = vec![0; planar.len()];
        StreamLayout { skip: self.layout.skip, block_bytes: None }.merge(&planar, &mut natural);
        natural
    }

    /// Decodes everything. Takes [`Stream::decoded_bytes`] of memory, twice that with several planes. Stops early once
    /// `progress` is cancelled; the result is then meaningless.
    pub fn decode(&self, progress: &dyn Progress) -> Vec<u8> {
        let mut samples = vec![0; self.total as usize];
        progress.begin("unpacking");
        self.decode_samples(&mut samples, progress);
        progress.end();
        if self.layout.skip == 1 {
            return samples;
        }
        let mut natural = vec![0; samples.len()];
        self.layout.merge(&samples, &mut natural);
        natural
    }

    fn decode_samples(&self, mut samples: &mut [u8], progress: &dyn Progress) {
        let mut segments = self.segment_ranges();
        let mut carry = Carry::new(self.strip);
        let batch_len = 8 * rayon::current_num_threads();
        let mut done = 0;
        while !samples.is_empty() && !progress.is_cancelled() {
            let mut batch = Vec::with_capacity(batch_len);
            for (segment, range) in segments.by_ref().take(batch_len) {
                let (part, rest) =
                    std::mem::take(&mut samples).split_at_mut((range.end - range.start) as usize);
                samples = rest;
                done = range.end;
                batch.push((segment, part));
            }
            let undone: Vec<Unpredictor> = batch
                .par_iter_mut()
                .map(|(segment, part)| self.decode_alone(*segment, part))
                .collect();
            let shifts: Vec<_> = batch
                .iter()
                .zip(&undone)
                .map(|((segment, part), undone)| {
                    let sum = part.last().copied().unwrap_or(0);
                    carry.pass(undone, segment.sample, part.len(), sum)
                })
                .collect();
            batch.par_iter_mut().zip(shifts).for_each(|((_, part), shift)| shift.apply(part));
            progress.advance(done as f32 / self.total as f32);
        }
    }

    /// Decodes a segment and undoes the predictor as if only zeros preceded it.
    fn decode_alone(&self, segment: Segment, out: &mut [u8]) -> Unpredictor {
        let mut unpredictor = Unpredictor::at(self.strip, segment.sample);
        // Plain loops, compiled once for each generation of vector instructions.
        dispatch!(Level::new(), _simd => {
            runs::decode_runs(self.source, segment.bit, out);
            unpredictor.undo(out);
        });
        unpredictor
    }

    /// Returns the segments with the ranges of their samples.
    fn segment_ranges(&self) -> impl Iterator<Item = (Segment, Range<u64>)> {
        let ends = self.segments.iter().skip(1).map(|s| s.sample).chain([self.total]);
        self.segments.iter().zip(ends).map(|(segment, end)| (*segment, segment.sample..end))
    }
}

/// Packs `plain` with `skip` planes (1 to [`MAX_SKIP`]) and the predictor distance `strip` (1 to [`MAX_STRIP`]). Takes
/// the same memory again with several planes. Stops early once `progress` is cancelled; the result is then meaningless.
pub fn encode(plain: &[u8], skip: usize, strip: usize, progress: &dyn Progress) -> Vec<u8> {
    debug_assert!((1..=MAX_SKIP).contains(&skip) && (1..=MAX_STRIP).contains(&strip));
    progress.begin("packing");
    let long = plain.len() > PLANE_BLOCK;
    let split = (skip > 1).then(|| {
        let mut samples = vec![0; plain.len()];
        StreamLayout { skip, block_bytes: long.then_some(skip * PLANE_BLOCK) }
            .split(plain, &mut samples);
        samples
    });
    let samples = split.as_deref().unwrap_or(plain);

    let mut all = BitSink::default();
    all.reserve(16);
    for &byte in if long { ID_V3E } else { ID_V3D } {
        all.push(u64::from(byte), 8);
    }
    all.push((skip as u64 - 1) << 16 | (strip as u64 - 1), PARAMETER_BITS as u32);
    let chunks: Vec<Range<usize>> = (0..samples.len())
        .step_by(CHUNK_SAMPLES)
        .map(|from| from..samples.len().min(from + CHUNK_SAMPLES))
        .collect();
    for batch in chunks.chunks(8 * rayon::current_num_threads()) {
        if progress.is_cancelled() {
            break;
        }
        let sinks: Vec<BitSink> = batch
            .par_iter()
            .map_init(
                || (Splitter::default(), Vec::new()),
                |(splitter, residuals), chunk| {
                    residuals.resize(chunk.len(), 0);
                    predict::residuals(samples, strip, chunk.start, residuals);
                    let mut sink = BitSink::default();
                    splitter.encode(residuals, &mut sink);
                    sink
                },
            )
            .collect();
        sinks.iter().for_each(|sink| all.append(sink));
        progress.advance(batch.last().map_or(0, |c| c.end) as f32 / samples.len() as f32);
    }
    progress.end();
    all.into_bytes()
}

#[cfg(test)]
mod tests;
