//! Tracks which parts of a file are in use: parts are allocated first-fit.

use std::collections::BTreeMap;

/// The parts of a file that are in use.
#[derive(Debug, Default)]
pub struct FileSpace {
    /// The start of each part and its size in bytes.
    parts: BTreeMap<u64, u64>,
}

impl FileSpace {
    /// Allocates a part of `bytes` that ends within the first `end` bytes. `None` if there is no room.
    pub fn take(&mut self, bytes: u64, end: u64) -> Option<u64> {
        let bytes = bytes.max(1);
        let mut free_from = 0;
        for (&at, &length) in &self.parts {
            if at - free_from >= bytes {
                break;
            }
            free_from = at + length;
        }
        let fits = free_from.checked_add(bytes).is_some_and(|after| after <= end);
        fits.then(|| self.parts.insert(free_from, bytes));
        fits.then_some(free_from)
    }

    /// Frees the part that begins at `at`.
    pub fn give_back(&mut self, at: u64) {
        self.parts.remove(&at);
    }

    /// Returns the end of the last part.
    pub fn end(&self) -> u64 {
        self.parts.last_key_value().map_or(0, |(at, length)| at + length)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Parts never overlap, none extends beyond the end, and none is refused if there is a gap for it.
        #[test]
        fn parts_do_not_overlap(
            moves in prop::collection::vec((1u64..9, any::<prop::sample::Index>(), any::<bool>()), 0..60),
            end in 1u64..64,
        ) {
            let mut space = FileSpace::default();
            let mut used = vec![false; end as usize];
            let mut parts: Vec<(u64, u64)> = Vec::new();
            for (bytes, place, takes) in moves {
                if !takes && !parts.is_empty() {
                    let (at, bytes) = parts.swap_remove(place.index(parts.len()));
                    space.give_back(at);
                    used[at as usize..(at + bytes) as usize].fill(false);
                    continue;
                }
                let gap = used.windows(bytes as usize).position(|w| w.iter().all(|used| !used));
                let taken = space.take(bytes, end);
                prop_assert_eq!(taken, gap.map(|at| at as u64));
                if let Some(at) = taken {
                    used[at as usize..(at + bytes) as usize].fill(true);
                    parts.push((at, bytes));
                }
                let last = used.iter().rposition(|used| *used).map_or(0, |at| at as u64 + 1);
                prop_assert_eq!(space.end(), last);
            }
        }
    }
}
