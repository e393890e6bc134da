//! The record of an undo step: the earlier bits and colours of some bricks.
//!
//! Empty and full bricks take one bit each, in words of 64 bricks: clearing a full 512^3 grid leaves a
//! record of 64 KiB. Knows no document and no budget.

use std::collections::TryReserveError;

use super::brick::{BRICK_VOXELS, Brick};
use super::brick_set::{BrickMask, BrickSet};
use super::contents::Contents;
use super::grid::{Grid, WordKinds, count_mixed, swap_word};
use super::material::{Page, copied_page};
use super::memory;
use super::vectors::vectorised;

/// Earlier values of some bricks, each at most once.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct BrickRecord {
    empty: Vec<BrickMask>,
    full: Vec<BrickMask>,
    mixed: Vec<BrickMask>,
    /// The bits of the bricks that `mixed` names, in its order.
    mixed_bits: Vec<Brick>,
    pages: Vec<(u32, Option<Page>)>,
    page_bytes: usize,
    /// Earlier values of the mask.
    mask: Option<Box<BrickRecord>>,
}

impl BrickRecord {
    /// Keeps the bits of a brick that is neither empty nor full. Bricks of one word come in ascending order, and are
    /// named by the next [`BrickRecord::keep_word`].
    #[inline(always)]
    pub fn keep_mixed(&mut self, bits: &Brick) {
        self.mixed_bits.push(*bits);
    }

    /// Names the kept bricks of a word. The bits of the mixed ones have been given to [`BrickRecord::keep_mixed`].
    #[inline(always)]
    pub fn keep_word(&mut self, word: u32, kept: WordKinds) {
        let lists = [&mut self.empty, &mut self.full, &mut self.mixed];
        for (list, mask) in lists.into_iter().zip([kept.empty, kept.full, kept.mixed]) {
            if mask != 0 {
                list.push(BrickMask { word, mask });
            }
        }
    }

    /// Keeps the colour page of a brick, or its absence.
    pub(crate) fn keep_page(&mut self, index: u32, page: Option<Page>) {
        self.page_bytes += page.as_ref().map_or(0, |p| p.len());
        self.pages.push((index, page));
    }

    /// Returns the bricks that were empty, full and mixed.
    pub fn kinds(&self) -> [&[BrickMask]; 3] {
        [&self.empty, &self.full, &self.mixed]
    }

    /// Returns the bits of the mixed bricks, in the order in which [`BrickRecord::kinds`] names them.
    pub fn mixed_bits(&self) -> &[Brick] {
        &self.mixed_bits
    }

    /// Returns the kept colour pages with the linear indices of their bricks; `None` for a brick without a page.
    pub fn pages(&self) -> &[(u32, Option<Page>)] {
        &self.pages
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

    /// Returns a record of the values of [`BrickRecord::kinds`], [`BrickRecord::mixed_bits`] and
    /// [`BrickRecord::pages`]. There must be bits for each mixed brick, and each brick may be named only once.
    pub(crate) fn from_parts(
        [empty, full, mixed]: [Vec<BrickMask>; 3],
        mixed_bits: Vec<Brick>,
        pages: Vec<(u32, Option<Page>)>,
    ) -> BrickRecord {
        let page_bytes = pages.iter().flat_map(|(_, page)| page).map(|page| page.len()).sum();
        BrickRecord { empty, full, mixed, mixed_bits, pages, page_bytes, mask: None }
    }

    /// Returns whether no earlier value is kept.
    pub fn is_empty(&self) -> bool {
        self.empty.is_empty()
            && self.full.is_empty()
            && self.mixed.is_empty()
            && self.pages.is_empty()
            && self.mask.is_none()
    }

    /// Returns the heap bytes in use.
    pub fn heap_bytes(&self) -> usize {
        let masks = self.empty.capacity() + self.full.capacity() + self.mixed.capacity();
        masks * size_of::<BrickMask>()
            + self.mixed_bits.capacity() * size_of::<Brick>()
            + self.pages.capacity() * size_of::<(u32, Option<Page>)>()
            + self.page_bytes
            + self.mask.as_ref().map_or(0, |mask| size_of::<BrickRecord>() + mask.heap_bytes())
    }

    /// Returns the heap bytes after [`BrickRecord::gather`].
    pub(crate) fn gathered_bytes(&self) -> usize {
        let masks = self.empty.len() + self.full.len() + self.mixed.len();
        masks * size_of::<BrickMask>()
            + self.mixed_bits.len() * size_of::<Brick>()
            + self.pages.len() * size_of::<(u32, Option<Page>)>()
            + self.page_bytes
    }

    /// Returns an upper bound for the heap bytes of the reverse record ([`BrickRecord::swap`]).
    pub(crate) fn reverse_bytes(&self, contents: &Contents) -> usize {
        let lists = [&self.empty, &self.full, &self.mixed];
        let masks: usize = lists.iter().map(|list| list.len()).sum();
        let mixed: usize =
            lists.into_iter().flatten().map(|bricks| count_mixed(&contents.grid, *bricks)).sum();
        let page = |(index, _): &(u32, Option<Page>)| {
            contents.material.page(*index as usize).map_or(0, |page| page.len())
        };
        // Bricks of one kind may be of all three kinds in the reverse.
        lists.len() * masks * size_of::<BrickMask>()
            + mixed * size_of::<Brick>()
            + self.pages.len() * size_of::<(u32, Option<Page>)>()
            + self.pages.iter().map(page).sum::<usize>()
            + self.mask.as_ref().map_or(0, |mask| mask.reverse_bytes_in(contents.mask.as_deref()))
    }

    /// Returns the same bound for the record of a mask; there may be none yet.
    fn reverse_bytes_in(&self, mask: Option<&Grid>) -> usize {
        let lists = [&self.empty, &self.full, &self.mixed];
        let masks: usize = lists.iter().map(|list| list.len()).sum();
        let mixed = |mask: &Grid| -> usize {
            lists.into_iter().flatten().map(|bricks| count_mixed(mask, *bricks)).sum()
        };
        size_of::<BrickRecord>()
            + lists.len() * masks * size_of::<BrickMask>()
            + mask.map_or(0, mixed) * size_of::<Brick>()
    }

    /// Moves the values of `parts` into one record without spare capacity. The parts are left empty and keep their
    /// memory unless it is large.
    pub fn gather<P: AsMut<BrickRecord>>(parts: &mut [P]) -> BrickRecord {
        BrickRecord {
            empty: gather(parts, |part| &mut part.empty),
            full: gather(parts, |part| &mut part.full),
            mixed: gather(parts, |part| &mut part.mixed),
            mixed_bits: gather(parts, |part| &mut part.mixed_bits),
            pages: gather(parts, |part| &mut part.pages),
            page_bytes: parts.iter_mut().map(|p| std::mem::take(&mut p.as_mut().page_bytes)).sum(),
            mask: None,
        }
    }

    /// Returns a copy, unless the system lacks the memory for it.
    pub fn copied(&self) -> Result<BrickRecord, TryReserveError> {
        let mask = match &self.mask {
            Some(mask) => Some(Box::new(mask.copied()?)),
            None => None,
        };
        let page = |(index, page): &(u32, Option<Page>)| {
            Ok((*index, page.as_deref().map(copied_page).transpose()?))
        };
        Ok(BrickRecord {
            empty: memory::copied(&self.empty)?,
            full: memory::copied(&self.full)?,
            mixed: memory::copied(&self.mixed)?,
            mixed_bits: memory::copied(&self.mixed_bits)?,
            pages: memory::copied_each(&self.pages, page)?,
            page_bytes: self.page_bytes,
            mask,
        })
    }

    /// Writes the kept values into `contents` and returns the values they replace. Adds every brick that may have
    /// changed to `touched`.
    pub fn swap(self, contents: &mut Contents, touched: &mut BrickSet) -> BrickRecord {
        self.swap_into(SwapScratch::default(), contents, touched)
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

    /// Returns the memory that a swap needs; `None` if the system does not provide it.
    fn room(&self, contents: &mut Contents) -> Option<SwapScratch> {
        let reverse = self.reverse_room(&contents.grid).ok()?;
        let mut room = SwapScratch { reverse, ..SwapScratch::default() };
        if let Some(mask) = &self.mask {
            room.of_mask = match &contents.mask {
                Some(bits) => mask.reverse_room(bits).ok()?,
                None => {
                    let bits = room.mask.insert(contents.grid.try_emptied().ok()?);
                    mask.reverse_room(bits).ok()?
                }
            };
        }
        if self.pages.iter().any(|(_, page)| page.is_some()) {
            contents.material.try_make_room().ok()?;
        }
        Some(room)
    }

    /// Returns an empty record with room for the reverse in a grid.
    fn reverse_room(&self, grid: &Grid) -> Result<BrickRecord, TryReserveError> {
        let lists = [&self.empty, &self.full, &self.mixed];
        let masks = lists.iter().map(|list| list.len()).sum();
        let mixed = lists.into_iter().flatten().map(|bricks| count_mixed(grid, *bricks)).sum();
        let mut room = BrickRecord::default();
        for list in [&mut room.empty, &mut room.full, &mut room.mixed] {
            list.try_reserve_exact(masks)?;
        }
        room.mixed_bits.try_reserve_exact(mixed)?;
        room.pages.try_reserve_exact(self.pages.len())?;
        Ok(room)
    }

    fn swap_into(
        mut self,
        room: SwapScratch,
        contents: &mut Contents,
        touched: &mut BrickSet,
    ) -> BrickRecord {
        let SwapScratch { reverse, of_mask, mask: bits } = room;
        let mask = self.take_mask();
        let mut reverse = vectorised(
            #[inline(always)]
            || self.swap_all(reverse, contents, touched),
        );
        if let Some(mask) = mask {
            reverse.mask = Some(Box::new(mask.swap_mask(of_mask, bits, contents, touched)));
        }
        reverse
    }

    #[inline(always)]
    fn swap_all(
        self,
        mut reverse: BrickRecord,
        contents: &mut Contents,
        touched: &mut BrickSet,
    ) -> BrickRecord {
        // Exactly the room needed: growing would copy too much.
        let mut mixed = 0;
        for list in [&self.empty, &self.full, &self.mixed] {
            for bricks in list {
                mixed += count_mixed(&contents.grid, *bricks);
                touched.insert_mask(*bricks);
            }
        }
        reverse.mixed_bits.reserve_exact(mixed);
        for bricks in self.empty {
            reverse.swap_word(
                bricks,
                contents,
                #[inline(always)]
                || (Brick::EMPTY, 0),
            );
        }
        for bricks in self.full {
            reverse.swap_word(
                bricks,
                contents,
                #[inline(always)]
                || (Brick::FULL, BRICK_VOXELS as u16),
            );
        }
        let mut mixed_bits = self.mixed_bits.iter();
        for bricks in self.mixed {
            reverse.swap_word(
                bricks,
                contents,
                #[inline(always)]
                || {
                    let bits = mixed_bits.next().unwrap_or(&Brick::EMPTY);
                    (*bits, bits.count())
                },
            );
        }
        for (index, page) in self.pages {
            reverse.keep_page(index, contents.material.swap_page(index as usize, page));
            touched.insert(index);
        }
        reverse.shrink_to_fit();
        reverse
    }

    /// Writes the kept values into the mask of `contents`, which is created or dropped as needed.
    fn swap_mask(
        self,
        reverse: BrickRecord,
        new: Option<Grid>,
        contents: &mut Contents,
        touched: &mut BrickSet,
    ) -> BrickRecord {
        let bits = contents.mask.take().map(|mask| *mask).or(new);
        let mut mask = Contents::of_bits(bits.unwrap_or_else(|| contents.grid.emptied()));
        let room = SwapScratch { reverse, ..SwapScratch::default() };
        let reverse = self.swap_into(room, &mut mask, touched);
        contents.mask = Some(Box::new(mask.grid));
        contents.drop_empty_mask();
        reverse
    }

    /// Sets the bricks of one word to successive values of `bits`, with their counts, and keeps the old ones.
    #[inline(always)]
    fn swap_word(
        &mut self,
        bricks: BrickMask,
        contents: &mut Contents,
        bits: impl FnMut() -> (Brick, u16),
    ) {
        let kept = swap_word(
            &mut contents.grid,
            bricks,
            bits,
            #[inline(always)]
            |earlier| self.keep_mixed(earlier),
        );
        self.keep_word(bricks.word, kept);
    }

    fn shrink_to_fit(&mut self) {
        self.empty.shrink_to_fit();
        self.full.shrink_to_fit();
        self.mixed.shrink_to_fit();
        self.mixed_bits.shrink_to_fit();
        self.pages.shrink_to_fit();
    }
}

/// Memory for a swap.
#[derive(Default)]
struct SwapScratch {
    /// An empty record, and one for the mask.
    reverse: BrickRecord,
    of_mask: BrickRecord,
    /// A mask, if there is none yet.
    mask: Option<Grid>,
}

/// Memory that each list of a part keeps for the next stroke.
const SPARE_BYTES: usize = 64 << 10;

fn gather<P: AsMut<BrickRecord>, T>(
    parts: &mut [P],
    list: impl Fn(&mut BrickRecord) -> &mut Vec<T>,
) -> Vec<T> {
    let len = parts.iter_mut().map(|part| list(part.as_mut()).len()).sum();
    let mut whole = Vec::with_capacity(len);
    if len > 0 {
        for part in parts {
            let part = list(part.as_mut());
            whole.append(part);
            part.shrink_to(SPARE_BYTES / size_of::<T>());
        }
    }
    whole
}
