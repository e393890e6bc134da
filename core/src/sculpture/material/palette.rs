//! The palette of a page with few colours: its colours, and the place of each voxel's colour among them in bit planes.
//!
//! Takes masks of voxels and packed colours; gives pages. Knows no sculpture.

use std::sync::Arc;

use super::page::{MAX_PAGE_BYTES, PackedColour, Page, PageForm, SHARED_BYTES, packed};
use crate::sculpture::brick::{BRICK_VOXELS, Brick};
use crate::sculpture::colour::ColourDepth;

/// Most colours of a palette.
pub(super) const MAX_COLOURS: usize = 16;
/// Planes that name them, and one more while a colour too many is being painted.
const MAX_PLANES: usize = 5;
/// Words of a plane.
const PLANE_WORDS: usize = 8;
/// Stands for the last colour where their number is odd.
const NO_COLOUR: u32 = u32::MAX;

/// Two to 16 colours: the planes, eight words each, then the colours in rising order, two in a word.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct PagePalette(Arc<[u64]>);

impl PagePalette {
    /// Returns the number of planes.
    #[inline(always)]
    fn planes(&self) -> usize {
        // The colours take one to eight words.
        (self.0.len() - 1) / PLANE_WORDS
    }

    /// Returns the number of colours.
    pub fn len(&self) -> usize {
        let words = self.0.len() - self.planes() * PLANE_WORDS;
        2 * words - usize::from(self.colour(2 * words - 1).0 == NO_COLOUR)
    }

    /// Returns a colour by its place.
    #[inline(always)]
    pub fn colour(&self, place: usize) -> PackedColour {
        let word = self.0[self.planes() * PLANE_WORDS + place / 2];
        PackedColour((word >> (32 * (place & 1))) as u32)
    }

    /// Returns the place of the colour of voxel `local`.
    #[inline(always)]
    pub fn place(&self, local: u32) -> usize {
        let (word, bit) = (local as usize >> 6, local & 63);
        let mut place = 0;
        for plane in 0..self.planes() {
            place |= (self.0[plane * PLANE_WORDS + word] >> bit & 1) << plane;
        }
        place as usize
    }

    /// Returns the place of a colour, if it has one.
    pub fn place_of(&self, colour: PackedColour) -> Option<usize> {
        (0..self.len()).find(|&place| self.colour(place) == colour)
    }

    /// Returns the voxels that have the colour at a place.
    pub fn voxels_of(&self, place: usize) -> Brick {
        let mut voxels = Brick::FULL;
        for (plane, words) in
            self.0.as_chunks::<PLANE_WORDS>().0[..self.planes()].iter().enumerate()
        {
            voxels = select(&voxels, &Brick { words: *words }, place >> plane & 1 != 0);
        }
        voxels
    }

    /// Returns the heap bytes, shared or not.
    pub fn heap_bytes(&self) -> usize {
        SHARED_BYTES + size_of_val(&*self.0)
    }

    /// Returns the heap bytes of a palette of so many colours.
    pub fn bytes_for(colours: usize) -> usize {
        let words = planes_for(colours) * PLANE_WORDS + colours.div_ceil(2);
        SHARED_BYTES + words * size_of::<u64>()
    }

    /// Returns a copy for changes.
    pub fn draft(&self) -> PaletteDraft {
        let mut draft = PaletteDraft::uniform(self.colour(0));
        draft.count = self.len();
        for place in 1..draft.count {
            draft.colours[place] = self.colour(place);
        }
        let planes = &self.0.as_chunks::<PLANE_WORDS>().0[..self.planes()];
        for (plane, words) in draft.planes.iter_mut().zip(planes) {
            plane.words = *words;
        }
        draft
    }

    /// Writes the packed colours of all voxels, `B` bytes each.
    pub fn write<const B: usize>(&self, out: &mut [u8]) {
        let mut colours = [[0; B]; MAX_COLOURS];
        for (place, colour) in colours.iter_mut().enumerate().take(self.len()) {
            *colour = packed(self.colour(place));
        }
        let planes = &self.0.as_chunks::<PLANE_WORDS>().0[..self.planes()];
        for (word, out) in out.as_chunks_mut::<B>().0.chunks_mut(64).enumerate() {
            let mut bits = [0; MAX_COLOURS.ilog2() as usize];
            bits.iter_mut().zip(planes).for_each(|(bits, plane)| *bits = plane[word]);
            for out in out {
                let place = bits.iter().rev().fold(0, |place, bits| place << 1 | bits & 1);
                *out = colours[place as usize & (MAX_COLOURS - 1)];
                bits.iter_mut().for_each(|bits| *bits >>= 1);
            }
        }
    }
}

/// Returns the planes that name so many colours.
fn planes_for(colours: usize) -> usize {
    colours.next_power_of_two().ilog2() as usize
}

/// Returns the voxels that are set in a plane, or not, among some.
#[inline(always)]
fn select(voxels: &Brick, plane: &Brick, is_set: bool) -> Brick {
    if is_set { voxels.and(plane) } else { voxels.and_not(plane) }
}

/// A page of few colours in work: the colours in any order, some perhaps of no voxel.
pub(super) struct PaletteDraft {
    colours: [PackedColour; MAX_COLOURS + 1],
    count: usize,
    planes: [Brick; MAX_PLANES],
}

impl PaletteDraft {
    /// Returns a page of one colour.
    pub fn uniform(colour: PackedColour) -> PaletteDraft {
        PaletteDraft {
            colours: [colour; MAX_COLOURS + 1],
            count: 1,
            planes: [Brick::EMPTY; MAX_PLANES],
        }
    }

    /// Takes the colours of all voxels; `None` if they are too many.
    pub fn of(voxels: impl Iterator<Item = PackedColour>) -> Option<PaletteDraft> {
        let mut draft = PaletteDraft::uniform(PackedColour::default());
        draft.count = 0;
        let mut last = (PackedColour(NO_COLOUR), 0);
        for (local, colour) in voxels.enumerate() {
            if colour != last.0 {
                let known = draft.colours[..draft.count].iter().position(|known| *known == colour);
                let place = match known {
                    Some(place) => place,
                    None if draft.count == MAX_COLOURS => return None,
                    None => draft.add(colour),
                };
                last = (colour, place);
            }
            let (word, bit) = (local >> 6 & 7, local & 63);
            for (plane, bits) in draft.planes.iter_mut().enumerate().take(4) {
                bits.words[word] |= (last.1 as u64 >> plane & 1) << bit;
            }
        }
        Some(draft)
    }

    /// Adds a colour and returns its place.
    fn add(&mut self, colour: PackedColour) -> usize {
        let place = self.count.min(MAX_COLOURS);
        self.colours[place] = colour;
        self.count = place + 1;
        place
    }

    /// Gives voxels a colour.
    pub fn paint(&mut self, mask: &Brick, colour: PackedColour) {
        let known = self.colours[..self.count].iter().position(|known| *known == colour);
        let place = known.unwrap_or_else(|| self.add(colour));
        for (plane, bits) in self.planes.iter_mut().enumerate() {
            *bits = match place >> plane & 1 {
                0 => bits.and_not(mask),
                _ => bits.or(mask),
            };
        }
    }

    fn voxels_of(&self, place: usize) -> Brick {
        let all = self.planes.iter().enumerate();
        all.fold(Brick::FULL, |voxels, (plane, bits)| {
            select(&voxels, bits, place >> plane & 1 != 0)
        })
    }

    /// Returns the colours that voxels have, in rising order, with these voxels.
    fn used(&self) -> ([(PackedColour, Brick); MAX_COLOURS + 1], usize) {
        let mut used = [(PackedColour::default(), Brick::EMPTY); MAX_COLOURS + 1];
        let mut count = 0;
        for (place, colour) in self.colours[..self.count].iter().enumerate() {
            let voxels = self.voxels_of(place);
            if !voxels.is_empty() {
                used[count] = (*colour, voxels);
                count += 1;
            }
        }
        used[..count].sort_unstable_by_key(|(colour, _)| *colour);
        (used, count)
    }

    /// Returns the page.
    pub fn finish(&self, depth: ColourDepth) -> Page {
        let (used, count) = self.used();
        if count > MAX_COLOURS {
            return raw(&used[..count], depth);
        }
        page_of(&used[..count])
    }

    /// Returns the page of a draft that has not got a colour too many.
    pub fn finish_known(&self) -> Page {
        let (used, count) = self.used();
        page_of(&used[..count.min(MAX_COLOURS)])
    }
}

/// Returns the page of one to 16 colours in rising order.
fn page_of(used: &[(PackedColour, Brick)]) -> Page {
    if let [(colour, _)] = used {
        return Page::of_packed(*colour);
    }
    let planes = planes_for(used.len());
    let mut words = [0; (MAX_PLANES - 1) * PLANE_WORDS + MAX_COLOURS / 2];
    for (place, (_, voxels)) in used.iter().enumerate() {
        for plane in (0..planes).filter(|plane| place >> plane & 1 != 0) {
            let words = &mut words[plane * PLANE_WORDS..(plane + 1) * PLANE_WORDS];
            words.iter_mut().zip(voxels.words).for_each(|(word, bits)| *word |= bits);
        }
    }
    let first = planes * PLANE_WORDS;
    for (at, pair) in used.chunks(2).enumerate() {
        let high = pair.get(1).map_or(NO_COLOUR, |(colour, _)| colour.0);
        words[first + at] = u64::from(pair[0].0.0) | u64::from(high) << 32;
    }
    let words = &words[..first + used.len().div_ceil(2)];
    Page(PageForm::Palette(PagePalette(words.into())))
}

/// Returns a page of more colours than a palette has.
fn raw(used: &[(PackedColour, Brick)], depth: ColourDepth) -> Page {
    let size = depth.bytes();
    let mut bytes = [0; MAX_PAGE_BYTES];
    for (colour, voxels) in used {
        let packed = colour.bytes();
        voxels.for_each(|local| {
            let at = local as usize * size;
            bytes[at..at + size].copy_from_slice(&packed[..size]);
        });
    }
    Page(PageForm::Raw(bytes[..BRICK_VOXELS as usize * size].into()))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::page::PageView;
    use super::*;
    use crate::sculpture::colour::Rgb;

    fn plain(page: &Page, depth: ColourDepth) -> Vec<u8> {
        let mut bytes = [0; MAX_PAGE_BYTES];
        PageView { page, depth }.write_to(&mut bytes).to_vec()
    }

    proptest! {
        /// Pages keep their colours, are canonical, and painting equals painting of plain bytes.
        #[test]
        fn pages_agree_with_plain_bytes(
            depth in prop::sample::select(&ColourDepth::ALL[1..]),
            colours in 1u32..24,
            seed: u64,
            strokes in prop::collection::vec((any::<[u64; 8]>(), 0u32..30, 0u32..4), 0..30),
        ) {
            let size = depth.bytes();
            let colour = |i: u32| Rgb::new((i * 37) as u8, (i * 91) as u8, (i * 53) as u8);
            let mut state = seed;
            let mut expected = Vec::new();
            for _ in 0..512 {
                state = state.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(1);
                let packed = PackedColour::new(colour((state >> 40) as u32 % colours), depth);
                expected.extend_from_slice(&packed.bytes()[..size]);
            }
            let mut page = Page::of_bytes(&expected, depth);
            for (words, number, rough) in strokes {
                // Whole words now and then, so that colours vanish.
                let words = match rough {
                    0 => words,
                    1 => words.map(|word| if word & 1 == 0 { 0 } else { u64::MAX }),
                    2 => [u64::MAX; 8],
                    _ => words.map(|word| word | word >> 1 | word << 3),
                };
                let (mask, painted) = (Brick { words }, PackedColour::new(colour(number), depth));
                let mut differing = Brick::EMPTY;
                mask.for_each(|i| {
                    let at = i as usize * size;
                    let here = &mut expected[at..at + size];
                    if *here != painted.bytes()[..size] {
                        differing.words[i as usize / 64] |= 1 << (i % 64);
                    }
                    here.copy_from_slice(&painted.bytes()[..size]);
                });
                prop_assert_eq!(page.differing(&mask, painted), differing);
                let most = page.heap_bytes() + page.growth(painted, depth);
                if !mask.is_empty() {
                    page = page.painted(&mask, painted, depth);
                }
                prop_assert!(page.heap_bytes() <= most);
                prop_assert_eq!(plain(&page, depth), expected.clone());
                prop_assert_eq!(&page, &Page::of_bytes(&expected, depth), "canonical");
                let mut distinct: Vec<&[u8]> = expected.chunks(size).collect();
                distinct.sort_unstable();
                distinct.dedup();
                prop_assert_eq!(page.heap_bytes(), Page::bytes_for(distinct.len(), depth));
                prop_assert_eq!(page.packed().is_some(), distinct.len() == 1);
                let view = PageView { page: &page, depth };
                for local in 0..512 {
                    let packed = &expected[local as usize * size..];
                    prop_assert_eq!(view.rgb(local), depth.read(packed));
                }
            }
        }
    }
}
