//! Chooses runs: divides a sequence of residuals so that it takes the fewest bits.
//!
//! A run costs 10 bits plus its width for each sample. The best division is a shortest path, found backwards. For each
//! of the eight widths, the cost from a sample in a run of that width to the end is the width plus the lesser of two
//! costs: that of continuing the run, and that of starting a new run of the best width there. Only whether a run
//! continues and which width is best need be stored. (The limit of 127 samples is left out of the search; longer runs
//! are split afterwards.)
//!
//! Parts of equal length are searched in parallel, one in each byte of the vector registers. Costs matter only relative
//! to the best, and none exceeds it by more than 18 bits, so cost and width code fit one byte. At the ends of the parts
//! the continuation is unknown and assumed to cost nothing for every width.
//!
//! Takes residuals as [`super::predict`] produces them and writes runs as [`super::runs`] defines them.

use fearless_simd::{Level, dispatch};

use super::bits::BitSink;
use super::runs::{HEAD_BITS, RUN_SAMPLES, WIDTHS, encode_run};

/// Number of stretches. Below 32, compilers tend to unroll the loops over them instead of vectorising.
pub const LANES: usize = 32;
type Lanes = [u8; LANES];

/// Shift of a cost above the three bits of its width code.
const COST: u8 = 8;
const NEW_RUN: u8 = HEAD_BITS as u8 * COST;

/// Reusable buffers of the search.
#[derive(Clone, Debug, Default)]
pub struct Splitter {
    /// Residuals, followed by zeros up to a whole number of stretches.
    padded: Vec<u8>,
    /// For each sample, one bit per width code: a run of that width should end before it.
    stops: Vec<u8>,
    /// For each sample, the width code of the run that should begin there.
    best: Vec<u8>,
}

impl Splitter {
    /// Appends `residuals` to `sink` as runs. The last one ends with the residuals.
    pub fn encode(&mut self, residuals: &[u8], sink: &mut BitSink) {
        // Plain loops, compiled once for each generation of vector instructions.
        dispatch!(Level::new(), _simd => self.encode_here(residuals, sink));
    }

    #[inline(always)]
    fn encode_here(&mut self, residuals: &[u8], sink: &mut BitSink) {
        self.search(residuals);
        let mut at = 0;
        while at < residuals.len() {
            let code = usize::from(self.best[at] & 7);
            let limit = residuals.len().min(at + RUN_SAMPLES);
            let end = run_end(&self.stops[..limit], at + 1, code);
            encode_run(sink, code, &residuals[at..end]);
            at = end;
        }
    }

    #[inline(always)]
    fn search(&mut self, residuals: &[u8]) {
        // Whole groups of eight samples in each stretch.
        let stretch = residuals.len().div_ceil(8 * LANES) * 8;
        let padded = stretch * LANES;
        self.padded.clear();
        self.padded.extend_from_slice(residuals);
        self.padded.resize(padded, 0);
        self.stops.resize(padded, 0);
        self.best.resize(padded, 0);
        // Nothing is known about the continuation: every width continues for free.
        let mut costs: [Lanes; 8] = std::array::from_fn(|code| [code as u8; LANES]);
        for group in (0..stretch).step_by(8).rev() {
            let mut samples = [[0; LANES]; 8];
            gather(&self.padded, stretch, group, &mut samples);
            let mut stops = [[0; LANES]; 8];
            let mut best = [[0; LANES]; 8];
            for i in (0..8).rev() {
                (stops[i], best[i]) = step(&mut costs, &samples[i]);
            }
            scatter(&stops, &mut self.stops, stretch, group);
            scatter(&best, &mut self.best, stretch, group);
        }
    }
}

/// Steps one sample back: takes the costs after it and replaces them with the costs before it, both relative to that of
/// the best width. Returns the widths whose run should not continue into this sample, one bit each, and the best width
/// to begin here in the lowest three bits.
#[inline(always)]
fn step(costs: &mut [Lanes; 8], residuals: &Lanes) -> (Lanes, Lanes) {
    // Folds -128..128 to 0..128, with 1 for all non-zero values of at most two bits: a width holds a value if it lies
    // below half the width's range.
    let folded = lanes(|i| {
        let r = residuals[i] as i8;
        ((r ^ (r >> 7)) as u8).max(u8::from(r != 0))
    });
    let [a, b, c, d, e, f, g, h] = costs;
    go_back::<0>(a, &folded);
    go_back::<1>(b, &folded);
    go_back::<2>(c, &folded);
    go_back::<3>(d, &folded);
    go_back::<4>(e, &folded);
    go_back::<5>(f, &folded);
    go_back::<6>(g, &folded);
    go_back::<7>(h, &folded);
    let least = |x: &Lanes, y: &Lanes| lanes(|i| x[i].min(y[i]));
    let best = least(&least(&least(a, b), &least(c, d)), &least(&least(e, f), &least(g, h)));
    let mut stops = [0; LANES];
    compare::<0>(a, &best, &mut stops);
    compare::<1>(b, &best, &mut stops);
    compare::<2>(c, &best, &mut stops);
    compare::<3>(d, &best, &mut stops);
    compare::<4>(e, &best, &mut stops);
    compare::<5>(f, &best, &mut stops);
    compare::<6>(g, &best, &mut stops);
    compare::<7>(h, &best, &mut stops);
    (stops, best)
}

/// Updates the costs of a width from after a sample to before it.
#[inline(always)]
fn go_back<const CODE: usize>(cost: &mut Lanes, folded: &Lanes) {
    let width = WIDTHS[CODE] as u8;
    let limit = if CODE == 0 { 1 } else { 1 << (width - 1) };
    *cost = lanes(|i| {
        let ahead = cost[i].min(NEW_RUN | CODE as u8).wrapping_add(width * COST);
        ahead | all_if(folded[i] >= limit)
    });
}

/// Makes the costs of a width relative to the best, and notes where they end a run.
#[inline(always)]
fn compare<const CODE: usize>(cost: &mut Lanes, best: &Lanes, stops: &mut Lanes) {
    // A width that does not fit stays at least 13 bits behind: 255/8 - 10 - 8.
    *cost = lanes(|i| cost[i].wrapping_sub(best[i] & !7));
    *stops = lanes(|i| stops[i] | all_if(cost[i] >= NEW_RUN) & 1 << CODE);
}

#[inline(always)]
fn lanes(f: impl Fn(usize) -> u8) -> Lanes {
    let mut out = [0; LANES];
    for (i, lane) in out.iter_mut().enumerate() {
        *lane = f(i);
    }
    out
}

/// Returns all bits set or none, without a branch.
#[inline(always)]
fn all_if(condition: bool) -> u8 {
    0u8.wrapping_sub(u8::from(condition))
}

/// Reads eight samples of each stretch from `group` on, transposed so that each row has one sample of every stretch.
#[inline(always)]
fn gather(from: &[u8], stretch: usize, group: usize, rows: &mut [Lanes; 8]) {
    for eight in 0..LANES / 8 {
        let words = std::array::from_fn(|lane| {
            let at = (eight * 8 + lane) * stretch + group;
            from[at..].first_chunk().map_or(0, |c| u64::from_le_bytes(*c))
        });
        for (row, word) in rows.iter_mut().zip(transpose(words)) {
            row[eight * 8..eight * 8 + 8].copy_from_slice(&word.to_le_bytes());
        }
    }
}

/// Inverts [`gather`].
#[inline(always)]
fn scatter(rows: &[Lanes; 8], to: &mut [u8], stretch: usize, group: usize) {
    for eight in 0..LANES / 8 {
        let words = std::array::from_fn(|i| {
            rows[i][eight * 8..].first_chunk().map_or(0, |c| u64::from_le_bytes(*c))
        });
        for (lane, word) in transpose(words).into_iter().enumerate() {
            let at = (eight * 8 + lane) * stretch + group;
            to[at..at + 8].copy_from_slice(&word.to_le_bytes());
        }
    }
}

/// Transposes 8 x 8 bytes, by halves, quarters and eighths.
#[inline(always)]
fn transpose(mut rows: [u64; 8]) -> [u64; 8] {
    for (step, mask) in
        [(4, 0x0000_0000_FFFF_FFFF), (2, 0x0000_FFFF_0000_FFFF), (1, 0x00FF_00FF_00FF_00FF)]
    {
        let shift = 8 * step as u32;
        for i in 0..8 {
            if i & step == 0 {
                let swap = (rows[i] >> shift ^ rows[i + step]) & mask;
                rows[i] ^= swap << shift;
                rows[i + step] ^= swap;
            }
        }
    }
    rows
}

/// Returns the first index from `from` on at which a run of `code` should end, or the length of `stops`.
#[inline(always)]
fn run_end(stops: &[u8], from: usize, code: usize) -> usize {
    let each_byte = 0x0101_0101_0101_0101u64;
    let mut at = from;
    while let Some(chunk) = stops[at..].first_chunk::<8>() {
        let found = u64::from_le_bytes(*chunk) >> code & each_byte;
        if found != 0 {
            return at + found.trailing_zeros() as usize / 8;
        }
        at += 8;
    }
    stops[at..].iter().position(|s| s >> code & 1 != 0).map_or(stops.len(), |n| at + n)
}

#[cfg(test)]
mod tests {
    use super::super::bits::BitSource;
    use super::super::runs::{RunHead, decode_runs};
    use super::*;
    use proptest::prelude::*;

    /// Generates residuals whose size changes occasionally, like those of a volume.
    fn bursts() -> impl Strategy<Value = Vec<u8>> {
        prop::collection::vec((0u32..8, 1usize..60, any::<u64>()), 0..40).prop_map(|bursts| {
            let mut out = Vec::new();
            for (shift, count, seed) in bursts {
                let mut state = seed | 1;
                out.extend((0..count).map(|_| {
                    state =
                        state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                    ((state >> 56) as i8 >> shift) as u8
                }));
            }
            out
        })
    }

    /// Returns the bits of the best division by the plain recurrence, with runs of any length.
    fn least_bits(residuals: &[u8]) -> u32 {
        let mut costs = [0u32; 8];
        let mut best = 0;
        for &r in residuals.iter().rev() {
            for (cost, &width) in costs.iter_mut().zip(&WIDTHS) {
                let half = 1i32 << width >> 1;
                let fits = (-half..half.max(1)).contains(&i32::from(r as i8));
                *cost = if fits { width + (*cost).min(best + HEAD_BITS) } else { 1 << 30 };
            }
            best = costs.into_iter().min().unwrap_or(0);
        }
        if residuals.is_empty() { 0 } else { best + HEAD_BITS }
    }

    proptest! {
        #[test]
        fn runs_hold_the_residuals_at_least_cost(residuals in bursts()) {
            let mut sink = BitSink::default();
            Splitter::default().encode(&residuals, &mut sink);
            let bytes = sink.into_bytes();
            let source = BitSource::new(&bytes);
            let mut back = vec![0xAA; residuals.len()];
            let bits = decode_runs(source, 0, &mut back);
            prop_assert_eq!(&back, &residuals);
            // The excess over the best: a head for each cut at 127 samples, and for each end of a stretch at most a
            // head and one width per sample of the run that was chosen blindly.
            let mut runs = 0;
            let mut position = 0;
            while position < bits {
                let head = RunHead::at(source, position);
                runs += u64::from(head.count == RUN_SAMPLES);
                position += head.total_bits();
            }
            let allowed = u64::from(least_bits(&residuals)) + 10 * runs + LANES as u64 * 20;
            prop_assert!(bits <= allowed, "{bits} bits, allowed {allowed}");
        }

        #[test]
        fn one_stretch_is_cut_as_the_plain_recurrence_does(residuals in bursts()) {
            // All stretches alike, with no end of a stretch inside.
            let mut costs: [Lanes; 8] = std::array::from_fn(|code| [code as u8; LANES]);
            let mut total = 0u32;
            for &r in residuals.iter().rev() {
                let (_, best) = step(&mut costs, &[r; LANES]);
                total += u32::from(best[0] >> 3);
            }
            let head = if residuals.is_empty() { 0 } else { HEAD_BITS };
            prop_assert_eq!(total + head, least_bits(&residuals));
        }

        #[test]
        fn transposing_twice_changes_nothing(rows: [u64; 8]) {
            let turned = transpose(rows);
            for (i, row) in rows.iter().enumerate() {
                for (j, other) in turned.iter().enumerate() {
                    prop_assert_eq!(row >> (8 * j) & 255, other >> (8 * i) & 255);
                }
            }
            prop_assert_eq!(transpose(turned), rows);
        }
    }
}
