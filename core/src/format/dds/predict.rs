//! The predictor of DDS streams: sample i is predicted as left + above - above left, where "above" is
//! `strip` samples back; all arithmetic is modulo 256.
//!
//! Equivalently, with d the difference between a sample and the previous one: rows of `strip` samples starting at
//! sample 1 hold residuals whose column sums are d, and a running sum of d yields the samples. Both sums are linear, so
//! that parts of a stream can be undone in parallel from zero and corrected afterwards: a [`Shift`] adds the
//! contribution of the preceding parts. Works on bytes; knows no bit stream.

/// Undoes the predictor for consecutive stretches of one stream.
#[derive(Clone, Debug)]
pub struct Unpredictor {
    /// Sums of each column so far; empty where the strip is 1 and nothing lies above.
    columns: Vec<u8>,
    /// Column of the next sample.
    column: usize,
    /// The previous sample.
    last: u8,
    /// Whether the next sample is the first of all, which belongs to no row.
    at_start: bool,
}

impl Unpredictor {
    /// Starts at sample `index`, as if only zeros preceded it.
    pub fn at(strip: usize, index: u64) -> Unpredictor {
        let width = if strip == 1 { 0 } else { strip };
        Unpredictor {
            columns: vec![0; width],
            column: (index.saturating_sub(1) % strip as u64) as usize,
            last: 0,
            at_start: index == 0,
        }
    }

    /// Turns the next residuals into samples.
    #[inline(always)]
    pub fn undo(&mut self, residuals: &mut [u8]) {
        let mut rest = residuals;
        if self.at_start && !rest.is_empty() {
            self.last = rest[0];
            self.at_start = false;
            rest = &mut rest[1..];
        }
        if self.columns.is_empty() {
            self.last = running_sum(rest, self.last);
            return;
        }
        while !rest.is_empty() {
            let count = rest.len().min(self.columns.len() - self.column);
            let (part, behind) = rest.split_at_mut(count);
            for (r, sum) in part.iter_mut().zip(&mut self.columns[self.column..]) {
                *sum = sum.wrapping_add(*r);
                *r = *sum;
            }
            self.last = running_sum(part, self.last);
            self.column += count;
            if self.column == self.columns.len() {
                self.column = 0;
            }
            rest = behind;
        }
    }
}

/// Replaces each byte by the sum of itself, all preceding ones and `start`; returns the last sum.
#[inline(always)]
fn running_sum(bytes: &mut [u8], start: u8) -> u8 {
    let mut carry = start;
    let (blocks, rest) = bytes.as_chunks_mut::<16>();
    for block in blocks {
        // Four doublings; each is one shift and one add of a 16-byte register.
        let sums = shifted_add::<8>(shifted_add::<4>(shifted_add::<2>(shifted_add::<1>(*block))));
        for (out, sum) in block.iter_mut().zip(sums) {
            *out = sum.wrapping_add(carry);
        }
        carry = carry.wrapping_add(sums[15]);
    }
    for byte in rest {
        carry = carry.wrapping_add(*byte);
        *byte = carry;
    }
    carry
}

#[inline(always)]
fn shifted_add<const BY: usize>(bytes: [u8; 16]) -> [u8; 16] {
    std::array::from_fn(|i| if i < BY { bytes[i] } else { bytes[i].wrapping_add(bytes[i - BY]) })
}

/// The contribution of the preceding samples to a stretch that was undone from zero.
#[derive(Debug)]
pub struct Shift {
    /// Added within one period of whole rows.
    within: Vec<u8>,
    /// Added once more with every period.
    per_period: u8,
    /// Added to all.
    base: u8,
}

/// The state of a stream between two stretches.
#[derive(Debug)]
pub struct Carry {
    columns: Vec<u8>,
    last: u8,
}

impl Carry {
    /// Returns the state at the start of a stream.
    pub fn new(strip: usize) -> Carry {
        Carry { columns: vec![0; if strip == 1 { 0 } else { strip }], last: 0 }
    }

    /// Returns the shift for the stretch that starts at sample `index`, and advances the carry past the stretch.
    /// `undone` is its unpredictor after its `count` samples, `sum` its last sample.
    pub fn pass(&mut self, undone: &Unpredictor, index: u64, count: usize, sum: u8) -> Shift {
        let base = self.last;
        if self.columns.is_empty() {
            self.last = base.wrapping_add(sum);
            return Shift { within: vec![0; 256], per_period: 0, base };
        }
        let first = (index.saturating_sub(1) % self.columns.len() as u64) as usize;
        let (before, after) = self.columns.split_at(first);
        let row = [after, before].concat();
        // Short rows are combined, so that a period is long enough for a loop.
        let mut within = row.repeat((256 / row.len()).max(1));
        let per_period = running_sum(&mut within, 0);
        let (periods, rest) = (count / within.len(), count % within.len());
        let partial = if rest > 0 { within[rest - 1] } else { 0 };
        let added = per_period.wrapping_mul(periods as u8).wrapping_add(partial);
        self.last = base.wrapping_add(added).wrapping_add(sum);
        for (column, more) in self.columns.iter_mut().zip(&undone.columns) {
            *column = column.wrapping_add(*more);
        }
        Shift { within, per_period, base }
    }
}

impl Shift {
    /// Corrects the samples of the stretch.
    pub fn apply(&self, samples: &mut [u8]) {
        let mut base = self.base;
        for period in samples.chunks_mut(self.within.len()) {
            for (sample, more) in period.iter_mut().zip(&self.within) {
                *sample = sample.wrapping_add(*more).wrapping_add(base);
            }
            base = base.wrapping_add(self.per_period);
        }
    }
}

/// Writes the residuals of the samples from index `from` on to `out`.
pub fn residuals(samples: &[u8], strip: usize, from: usize, out: &mut [u8]) {
    let to = from + out.len();
    // Up to and including index `strip` nothing lies above.
    let top_end = if strip == 1 { to } else { to.min(strip + 1) };
    let mut at = from;
    while at < top_end {
        let left = if at == 0 { 0 } else { samples[at - 1] };
        out[at - from] = samples[at].wrapping_sub(left);
        at += 1;
    }
    let here = &samples[at..to];
    if here.is_empty() {
        return;
    }
    let (left, above) = (&samples[at - 1..to - 1], &samples[at - strip..to - strip]);
    let above_left = &samples[at - strip - 1..to - strip - 1];
    for ((((out, x), l), a), al) in
        out[at - from..].iter_mut().zip(here).zip(left).zip(above).zip(above_left)
    {
        *out = x.wrapping_sub(*l).wrapping_sub(*a).wrapping_add(*al);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Undoes the predictor by the formula of the description, sample by sample.
    fn naive_undo(residuals: &[u8], strip: usize) -> Vec<u8> {
        let mut x: Vec<u8> = Vec::new();
        for (i, &r) in residuals.iter().enumerate() {
            let guess = if i == 0 {
                0
            } else if strip == 1 || i <= strip {
                x[i - 1]
            } else {
                x[i - 1].wrapping_add(x[i - strip]).wrapping_sub(x[i - strip - 1])
            };
            x.push(r.wrapping_add(guess));
        }
        x
    }

    proptest! {
        #[test]
        fn undoing_follows_the_formula_in_one_piece_or_several(
            r in prop::collection::vec(any::<u8>(), 1..3000),
            strip in prop_oneof![1usize..20, 1usize..400, Just(65536)],
            cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..6),
        ) {
            let expected = naive_undo(&r, strip);
            let mut back = vec![0; r.len()];
            residuals(&expected, strip, 0, &mut back);
            prop_assert_eq!(&back, &r);

            let mut cuts: Vec<usize> = cuts.iter().map(|c| c.index(r.len())).collect();
            cuts.extend([0, r.len()]);
            cuts.sort_unstable();
            let mut stream = Unpredictor::at(strip, 0);
            let mut carry = Carry::new(strip);
            let (mut in_turn, mut apart) = (r.clone(), r.clone());
            for ends in cuts.windows(2) {
                let (from, to) = (ends[0], ends[1]);
                residuals(&expected, strip, from, &mut back[from..to]);
                stream.undo(&mut in_turn[from..to]);
                let stretch = &mut apart[from..to];
                if stretch.is_empty() { continue; }
                let mut alone = Unpredictor::at(strip, from as u64);
                alone.undo(stretch);
                let sum = stretch[stretch.len() - 1];
                carry.pass(&alone, from as u64, stretch.len(), sum).apply(stretch);
            }
            prop_assert_eq!(&back, &r);
            prop_assert_eq!(&in_turn, &expected);
            prop_assert_eq!(&apart, &expected);
        }
    }
}
