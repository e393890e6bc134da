//! The record of an undo step: the earlier bits and colours of some bricks.
//!
//! Bricks are named by leaf and word of 64 bricks. Empty and full bricks take one bit each, and leaves that were empty or
//! full as a whole 8 bytes: clearing a full 512^3 grid leaves a record of 4 KiB. Knows no document and no budget.

use std::collections::TryReserveError;
use std::iter::Sum;
use std::ops::{AddAssign, SubAssign};

use glam::UVec3;

use super::brick::{Brick, local_index};
use super::brick_set::{BrickSet, LeafKey};
use super::colour_record::ColourRecord;
use super::contents::Contents;
use super::grid::{Grid, LEAF_BYTES, OldLeaf};
use super::memory;

/// Earlier values of some bricks, each at most once.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct BrickRecord {
    /// The leaves of 512 bricks all of which were empty or all full.
    uniform: Vec<UniformLeaf>,
    /// All other recorded bricks.
    words: Vec<WordRecord>,
    /// The bits of the mixed bricks, in the order of `words` and their bits.
    mixed_bits: Vec<Brick>,
    /// Earlier colours.
    colours: Option<Box<ColourRecord>>,
    /// Earlier values of the mask.
    mask: Option<Box<BrickRecord>>,
}

/// The earlier kinds of bricks of one word of a leaf's masks: a bit per brick. Those in neither mask were empty.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WordRecord {
    /// The leaf, and the index of the word in its masks.
    pub leaf: LeafKey,
    /// Index of the word, 0..8.
    pub word: u8,
    /// The recorded bricks; not 0.
    pub bricks: u64,
    /// Those of them that were full, and those that were mixed.
    pub full: u64,
    /// See `full`.
    pub mixed: u64,
}

/// A leaf all 512 bricks of which were empty, or full.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct UniformLeaf {
    leaf: LeafKey,
    was_full: bool,
}

impl UniformLeaf {
    /// Returns its words.
    fn words(self) -> impl Iterator<Item = WordRecord> {
        let full = if self.was_full { u64::MAX } else { 0 };
        (0..8).map(move |word| WordRecord {
            leaf: self.leaf,
            word,
            bricks: u64::MAX,
            full,
            mixed: 0,
        })
    }
}

/// The size of a record: numbers of uniform leaves, words and mixed bricks.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(super) struct RecordSize {
    uniform: usize,
    words: usize,
    mixed: usize,
}

impl RecordSize {
    /// Returns the size of the record of bricks of a leaf.
    pub fn of_leaf(leaf: &OldLeaf, bricks: &Brick) -> RecordSize {
        match leaf.is_uniform() && bricks.is_full() {
            true => RecordSize { uniform: 1, ..RecordSize::default() },
            false => {
                RecordSize { uniform: 0, words: used_words(bricks), mixed: leaf.mixed(bricks) }
            }
        }
    }

    /// Returns the bytes that it takes.
    pub fn bytes(self) -> usize {
        self.uniform * size_of::<UniformLeaf>()
            + self.words * size_of::<WordRecord>()
            + self.mixed * size_of::<Brick>()
    }
}

impl AddAssign for RecordSize {
    fn add_assign(&mut self, other: RecordSize) {
        self.uniform += other.uniform;
        self.words += other.words;
        self.mixed += other.mixed;
    }
}

impl SubAssign for RecordSize {
    fn sub_assign(&mut self, other: RecordSize) {
        self.uniform -= other.uniform;
        self.words -= other.words;
        self.mixed -= other.mixed;
    }
}

impl Sum for RecordSize {
    fn sum<I: Iterator<Item = RecordSize>>(sizes: I) -> RecordSize {
        sizes.fold(RecordSize::default(), |mut sum, size| {
            sum += size;
            sum
        })
    }
}

impl BrickRecord {
    /// Records the bits of bricks of leaves, which rise by key.
    pub(super) fn of_leaves(leaves: &[(LeafKey, (OldLeaf, Brick))]) -> BrickRecord {
        let sizes = leaves.iter().map(|(_, (leaf, bricks))| RecordSize::of_leaf(leaf, bricks));
        let RecordSize { uniform, words, mixed } = sizes.sum();
        let mut record = BrickRecord {
            uniform: Vec::with_capacity(uniform),
            words: Vec::with_capacity(words),
            mixed_bits: Vec::with_capacity(mixed),
            ..BrickRecord::default()
        };
        for (key, (leaf, bricks)) in leaves {
            let bits = &mut record.mixed_bits;
            let kinds = leaf.kinds(*bricks, |brick| bits.push(*brick));
            record.keep_words(*key, bricks, kinds);
        }
        record
    }

    /// Returns a record of the bits of listed bricks, each listed once. `valid`: the bits that a brick may hold.
    pub(crate) fn of_bricks(
        mut bricks: Vec<(UVec3, Brick)>,
        valid: impl Fn(UVec3) -> Brick,
    ) -> BrickRecord {
        let place = |b: UVec3| {
            let index = local_index(b.x & 7, b.y & 7, b.z & 7);
            (LeafKey::of(b >> 3), (index >> 6) as u8, index & 63)
        };
        bricks.sort_unstable_by_key(|(b, _)| place(*b));
        let (mut words, mut mixed_bits): (Vec<WordRecord>, _) = (Vec::new(), Vec::new());
        for (b, brick) in bricks {
            let (leaf, word, bit) = place(b);
            if words.last().is_none_or(|last| (last.leaf, last.word) != (leaf, word)) {
                words.push(WordRecord { leaf, word, bricks: 0, full: 0, mixed: 0 });
            }
            let Some(named) = words.last_mut() else { continue };
            named.bricks |= 1 << bit;
            if brick == valid(b) {
                named.full |= 1 << bit;
            } else if !brick.is_empty() {
                named.mixed |= 1 << bit;
                mixed_bits.push(brick);
            }
        }
        BrickRecord::from_parts(words, mixed_bits)
    }

    /// Names the recorded bricks of a leaf; the bits of the mixed ones have been kept.
    #[inline(always)]
    fn keep_words(&mut self, leaf: LeafKey, bricks: &Brick, [empty, full, mixed]: [Brick; 3]) {
        if empty.is_full() || full.is_full() {
            self.uniform.push(UniformLeaf { leaf, was_full: full.is_full() });
            return;
        }
        for (word, &named) in bricks.words.iter().enumerate() {
            if named != 0 {
                let (full, mixed) = (full.words[word], mixed.words[word]);
                self.words.push(WordRecord { leaf, word: word as u8, bricks: named, full, mixed });
            }
        }
    }

    /// Returns the number of words that [`BrickRecord::words`] returns.
    pub fn word_count(&self) -> usize {
        self.uniform.len() * 8 + self.words.len()
    }

    /// Returns the recorded bricks by word, rising by leaf and word.
    pub fn words(&self) -> impl Iterator<Item = WordRecord> {
        let (mut words, mut uniform) = (&*self.words, &*self.uniform);
        let mut expanded = None;
        std::iter::from_fn(move || {
            loop {
                if let Some(word) = expanded.as_mut().and_then(Iterator::next) {
                    return Some(word);
                }
                match (words.split_first(), uniform.split_first()) {
                    (Some((word, rest)), next)
                        if next.is_none_or(|(next, _)| word.leaf < next.leaf) =>
                    {
                        words = rest;
                        return Some(*word);
                    }
                    (_, next) => {
                        let (leaf, rest) = next?;
                        uniform = rest;
                        expanded = Some(leaf.words());
                    }
                }
            }
        })
    }

    /// Returns the bits of the mixed bricks, in the order in which [`BrickRecord::words`] names them.
    pub fn mixed_bits(&self) -> &[Brick] {
        &self.mixed_bits
    }

    /// Returns the earlier colours, if any.
    pub fn colours(&self) -> Option<&ColourRecord> {
        self.colours.as_deref()
    }

    /// Adds earlier colours to a record without any.
    pub(crate) fn with_colours(self, colours: ColourRecord) -> BrickRecord {
        let colours = (!colours.is_empty()).then(|| Box::new(colours));
        BrickRecord { colours, ..self }
    }

    /// Returns the earlier bits of bricks of the mask, if any.
    pub fn mask(&self) -> Option<&BrickRecord> {
        self.mask.as_deref()
    }

    /// Takes the mask's part out of the record.
    pub(super) fn take_mask(&mut self) -> Option<BrickRecord> {
        self.mask.take().map(|mask| *mask)
    }

    /// Adds earlier bits of bricks of the mask.
    pub(crate) fn with_mask(self, mask: BrickRecord) -> BrickRecord {
        BrickRecord { mask: (!mask.is_empty()).then(|| Box::new(mask)), ..self }
    }

    /// Returns a record of the values of [`BrickRecord::words`] and [`BrickRecord::mixed_bits`]. The words must rise, each
    /// brick may be named only once, and there must be bits for each mixed brick.
    pub(crate) fn from_parts(mut words: Vec<WordRecord>, mixed_bits: Vec<Brick>) -> BrickRecord {
        let is_uniform = |leaf: &[WordRecord]| {
            let [first, ..] = leaf else { return false };
            let same = |word: &WordRecord| word.bricks == u64::MAX && word.full == first.full;
            leaf.len() == 8
                && leaf.iter().all(same)
                && matches!(first.full, 0 | u64::MAX)
                && leaf.iter().all(|word| word.mixed == 0)
        };
        let leaves = words.chunk_by(|a, b| a.leaf == b.leaf).filter(|leaf| is_uniform(leaf));
        let uniform: Vec<UniformLeaf> = leaves
            .map(|words| UniformLeaf { leaf: words[0].leaf, was_full: words[0].full != 0 })
            .collect();
        words.retain(|word| uniform.binary_search_by_key(&word.leaf, |leaf| leaf.leaf).is_err());
        let mut record = BrickRecord { uniform, words, mixed_bits, ..BrickRecord::default() };
        record.shrink_to_fit();
        record
    }

    /// Returns whether no earlier value is kept.
    pub fn is_empty(&self) -> bool {
        self.uniform.is_empty()
            && self.words.is_empty()
            && self.colours.is_none()
            && self.mask.is_none()
    }

    /// Returns the heap bytes in use.
    pub fn heap_bytes(&self) -> usize {
        let bits = RecordSize {
            uniform: self.uniform.capacity(),
            words: self.words.capacity(),
            mixed: self.mixed_bits.capacity(),
        };
        bits.bytes()
            + self.colours.as_ref().map_or(0, |kept| size_of::<ColourRecord>() + kept.heap_bytes())
            + self.mask.as_ref().map_or(0, |mask| size_of::<BrickRecord>() + mask.heap_bytes())
    }

    /// Returns an upper bound for the heap bytes of the reverse record ([`BrickRecord::swap`]).
    pub(crate) fn reverse_bytes(&self, contents: &Contents) -> usize {
        self.reverse_size(Some(&contents.grid)).bytes()
            + self.colours.as_ref().map_or(0, |kept| {
                size_of::<ColourRecord>() + kept.reverse_bytes(&contents.material)
            })
            + self.mask.as_ref().map_or(0, |mask| {
                size_of::<BrickRecord>() + mask.reverse_size(contents.mask.as_deref()).bytes()
            })
    }

    /// Returns the size of the bits of the reverse record, if those of a grid are exchanged; none: of an empty one.
    fn reverse_size(&self, grid: Option<&Grid>) -> RecordSize {
        let uniform = self.uniform.iter().map(|leaf| (leaf.leaf, Brick::FULL));
        let words = self.word_leaves().map(|words| (words[0].leaf, bricks_of(words)));
        let leaves = uniform.chain(words);
        leaves.map(|(leaf, bricks)| RecordSize::of_leaf(&bits_now(grid, leaf), &bricks)).sum()
    }

    /// Returns an upper bound for the heap bytes of the leaves of grid and mask once the kept bits are written.
    pub(crate) fn written_bytes(&self, contents: &Contents) -> usize {
        let mask = self.mask.as_ref().map(|kept| kept.leaf_bytes(contents.mask.as_deref()));
        self.leaf_bytes(Some(&contents.grid)) + mask.unwrap_or(0)
    }

    /// Returns an upper bound for the heap bytes of the leaves that the kept bits are written into: a leaf that is shared,
    /// or has no room, is copied.
    fn leaf_bytes(&self, grid: Option<&Grid>) -> usize {
        let leaves = self.word_leaves().map(|words| {
            let others = Brick::FULL.and_not(&bricks_of(words));
            bits_now(grid, words[0].leaf).mixed(&others) * size_of::<Brick>() + LEAF_BYTES as usize
        });
        self.mixed_bits.len() * size_of::<Brick>() + leaves.sum::<usize>()
    }

    /// Returns the words by leaf.
    fn word_leaves(&self) -> impl Iterator<Item = &[WordRecord]> {
        self.words.chunk_by(|a, b| a.leaf == b.leaf)
    }

    /// Returns a copy, unless the system lacks the memory for it.
    pub fn copied(&self) -> Result<BrickRecord, TryReserveError> {
        let mask = match &self.mask {
            Some(mask) => Some(Box::new(mask.copied()?)),
            None => None,
        };
        let colours = match &self.colours {
            Some(colours) => Some(Box::new(colours.copied()?)),
            None => None,
        };
        Ok(BrickRecord {
            uniform: memory::copied(&self.uniform)?,
            words: memory::copied(&self.words)?,
            mixed_bits: memory::copied(&self.mixed_bits)?,
            colours,
            mask,
        })
    }

    /// Writes the kept values into `contents` and returns the values they replace. Adds every brick that may have
    /// changed to `touched`.
    pub fn swap(self, contents: &mut Contents, touched: &mut BrickSet) -> BrickRecord {
        self.swap_into(BrickRecord::default(), contents, touched)
    }

    /// Performs [`BrickRecord::swap`], unless the system lacks the memory for it. Then nothing has changed, and the record
    /// is returned.
    pub(crate) fn try_swap(
        self,
        contents: &mut Contents,
        touched: &mut BrickSet,
    ) -> Result<BrickRecord, Box<BrickRecord>> {
        match self.room(contents) {
            Some(room) => Ok(self.swap_into(room, contents, touched)),
            None => Err(Box::new(self)),
        }
    }

    /// Returns an empty record with room for the reverse; `None` if the system lacks the memory for it, or for the bits
    /// that are written.
    fn room(&self, contents: &Contents) -> Option<BrickRecord> {
        let mut room = BrickRecord::default();
        room.reserve(self, Some(&contents.grid)).ok()?;
        if let Some(colours) = &self.colours {
            room.colours = Some(Box::new(colours.room(&contents.material).ok()?));
        }
        if let Some(mask) = &self.mask {
            let mut of_mask = BrickRecord::default();
            of_mask.reserve(mask, contents.mask.as_deref()).ok()?;
            room.mask = Some(Box::new(of_mask));
        }
        memory::probe(self.written_bytes(contents)).ok()?;
        Some(room)
    }

    /// Makes room for the reverse of a record in a grid.
    fn reserve(
        &mut self,
        record: &BrickRecord,
        grid: Option<&Grid>,
    ) -> Result<(), TryReserveError> {
        let size = record.reverse_size(grid);
        self.uniform.try_reserve_exact(size.uniform)?;
        self.words.try_reserve_exact(size.words)?;
        self.mixed_bits.try_reserve_exact(size.mixed)
    }

    /// Writes the values into `contents`. The reverse goes to `reverse`, which has room for it or is empty.
    fn swap_into(
        mut self,
        mut reverse: BrickRecord,
        contents: &mut Contents,
        touched: &mut BrickSet,
    ) -> BrickRecord {
        let of_mask = reverse.take_mask().unwrap_or_default();
        let mask = self.take_mask();
        if let Some(colours) = self.colours.take() {
            let mut room = reverse.colours.take().unwrap_or_default();
            colours.swap_into(&mut room, &mut contents.material, touched);
            reverse.colours = Some(room);
        }
        let mut reverse = self.swap_bits_into(reverse, &mut contents.grid, touched);
        if let Some(mask) = mask {
            let bits = contents.mask.take().map(|mask| *mask);
            let mut bits = bits.unwrap_or_else(|| contents.grid.emptied());
            reverse.mask = Some(Box::new(mask.swap_bits_into(of_mask, &mut bits, touched)));
            contents.mask = Some(Box::new(bits));
            contents.drop_empty_mask();
        }
        reverse
    }

    /// Writes the kept bits into a grid.
    fn swap_bits_into(
        &self,
        mut reverse: BrickRecord,
        grid: &mut Grid,
        touched: &mut BrickSet,
    ) -> BrickRecord {
        if reverse.words.capacity() + reverse.uniform.capacity() == 0 {
            // Exactly the room needed: growing would copy too much.
            let size = self.reverse_size(Some(grid));
            reverse.uniform.reserve_exact(size.uniform);
            reverse.words.reserve_exact(size.words);
            reverse.mixed_bits.reserve_exact(size.mixed);
        }
        self.write_bits(grid, &mut |leaf, bricks, kinds, mixed| {
            reverse.mixed_bits.extend_from_slice(mixed);
            reverse.keep_words(leaf, &bricks, kinds);
            touched.insert_in(leaf, &bricks);
        });
        reverse.shrink_to_fit();
        reverse
    }

    /// Writes the kept bits into a grid and returns the bricks that they belong to.
    pub(super) fn put_bits(&self, grid: &mut Grid) -> BrickSet {
        let mut bricks_set = BrickSet::default();
        self.write_bits(grid, &mut |leaf, bricks, _, _| {
            bricks_set.insert_in(leaf, &bricks);
        });
        bricks_set
    }

    /// Writes the kept bits into a grid. Calls `replaced` for each leaf.
    fn write_bits(&self, grid: &mut Grid, replaced: &mut LeafReplaced) {
        let mut scratch = [Brick::EMPTY; 512];
        let (mut bits, mut earlier) = (&*self.mixed_bits, Vec::with_capacity(512));
        let mut words = self.words().peekable();
        while let Some(leaf) = words.peek().map(|word| word.leaf) {
            let [mut bricks, mut full, mut mixed] = [Brick::EMPTY; 3];
            while let Some(word) = words.next_if(|word| word.leaf == leaf) {
                let at = usize::from(word.word) & 7;
                bricks.words[at] = word.bricks;
                full.words[at] = word.full;
                mixed.words[at] = word.mixed;
            }
            let (own, rest) = bits.split_at(usize::from(mixed.count()).min(bits.len()));
            bits = rest;
            earlier.clear();
            let kinds =
                grid.replace_in(leaf, [bricks, full, mixed], own, &mut scratch, &mut earlier);
            replaced(leaf, bricks, kinds, &earlier);
        }
    }

    pub(super) fn shrink_to_fit(&mut self) {
        self.uniform.shrink_to_fit();
        self.words.shrink_to_fit();
        self.mixed_bits.shrink_to_fit();
    }
}

/// Gets a leaf whose bricks have been replaced, these bricks, their kinds before (empty, full, mixed), and the bits of those
/// that were mixed.
type LeafReplaced<'a> = dyn FnMut(LeafKey, Brick, [Brick; 3], &[Brick]) + 'a;

/// Returns a leaf of a grid; none: of an empty one.
fn bits_now(grid: Option<&Grid>, leaf: LeafKey) -> OldLeaf {
    grid.map_or(OldLeaf::EMPTY, |grid| grid.leaf_bits(leaf))
}

/// Returns the bricks that words of one leaf name.
fn bricks_of(words: &[WordRecord]) -> Brick {
    let mut bricks = Brick::EMPTY;
    words.iter().for_each(|word| bricks.words[usize::from(word.word) & 7] = word.bricks);
    bricks
}

fn used_words(bricks: &Brick) -> usize {
    bricks.words.iter().filter(|word| **word != 0).count()
}
