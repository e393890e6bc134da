//! The colours of one sculpture: a page of 512 packed colours for each painted brick, and one base
//! colour for all other voxels.
//!
//! Addressed by linear brick index ([`Grid::brick_index`]) and voxel index in the brick
//! ([`super::brick::local_index`]). Independent of existence: a page may hold a colour for a voxel that does not exist.

use std::collections::TryReserveError;
use std::ops::Range;

use rayon::prelude::*;

use super::brick::{BRICK_VOXELS, Brick};
use super::colour::{ColourDepth, Rgb};
use super::grid::Grid;
use super::memory;

/// The packed colours of one brick, in the order of [`super::brick::local_index`].
pub type Page = Box<[u8]>;

/// An edit of the pages of a band. Gets the linear index of its first brick, the pages, and the band's state; returns
/// the number of pages that it has made.
pub type BandEdit<'a, S> = dyn Fn(u32, &mut [Option<Page>], &mut S) -> usize + Sync + 'a;

/// Colour per voxel, stored only where painted.
#[derive(Clone, PartialEq, Debug)]
pub struct Material {
    depth: ColourDepth,
    base: Rgb,
    brick_count: usize,
    /// One entry per brick; empty until the first page is made.
    pages: Vec<Option<Page>>,
    page_count: usize,
}

impl Material {
    /// Returns a material without painted voxels, for a grid of `brick_count` bricks: all have `base`, quantised to
    /// `depth`.
    pub fn new(depth: ColourDepth, base: Rgb, brick_count: usize) -> Material {
        Material {
            depth,
            base: depth.quantise(base),
            brick_count,
            pages: Vec::new(),
            page_count: 0,
        }
    }

    /// Returns a material without painted voxels for `grid`: all have `base`, quantised to `depth`.
    pub fn for_grid(grid: &Grid, depth: ColourDepth, base: Rgb) -> Material {
        Material::new(depth, base, grid.brick_count())
    }

    /// Returns the bits of colour per voxel.
    pub fn depth(&self) -> ColourDepth {
        self.depth
    }

    /// Returns the colour of every voxel that has not been painted.
    pub fn base(&self) -> Rgb {
        self.base
    }

    /// Returns the bytes of one page.
    pub fn page_bytes(&self) -> usize {
        BRICK_VOXELS as usize * self.depth.bytes()
    }

    /// Returns the number of bricks that have a page.
    pub fn page_count(&self) -> usize {
        self.page_count
    }

    /// Returns the heap bytes in use.
    pub fn heap_bytes(&self) -> u64 {
        (self.pages.capacity() * size_of::<Option<Page>>() + self.page_count * self.page_bytes())
            as u64
    }

    /// Returns the heap bytes in use once `pages` more bricks are painted.
    pub fn bytes_with(&self, pages: u64) -> u64 {
        let table = self.pages.capacity().max(self.brick_count) * size_of::<Option<Page>>();
        table as u64 + (self.page_count as u64 + pages) * self.page_bytes() as u64
    }

    /// Returns the colour of voxel `local` (0..512) of brick `brick`.
    #[inline]
    pub fn rgb(&self, brick: usize, local: u32) -> Rgb {
        match self.page(brick) {
            Some(page) => {
                let at = local as usize * self.depth.bytes();
                self.depth.read(&page[at..])
            }
            None => self.base,
        }
    }

    /// Returns the page of a brick, if it has been painted.
    #[inline]
    pub fn page(&self, brick: usize) -> Option<&[u8]> {
        self.pages.get(brick).and_then(|p| p.as_deref())
    }

    /// Gives the voxels of `mask` in brick `brick` the colour `colour`. Does nothing without colour depth. Makes a page
    /// only if the colour of a voxel of `mask` changes.
    pub fn paint(&mut self, brick: usize, mask: &Brick, colour: Rgb) {
        let brush = self.brush(colour);
        let differing = brush.differing(self.page(brick), mask);
        if !differing.is_empty() {
            self.make_room();
            self.page_count += usize::from(brush.paint(&mut self.pages[brick], &differing));
        }
    }

    /// Returns a colour prepared for painting many bricks of this sculpture.
    pub fn brush(&self, colour: Rgb) -> Brush {
        Brush::new(self.depth, self.base, colour)
    }

    /// Calls `f` for each of the bands `bands` of `bricks_per_band` bricks, on all threads if `parallel`. `f` gets the
    /// linear index of the band's first brick, its pages, and its entry of `states` (one per band of the grid), and
    /// returns the number of pages it has added.
    pub(crate) fn edit_bands<S: Send>(
        &mut self,
        bricks_per_band: usize,
        bands: Range<usize>,
        parallel: bool,
        states: &mut [S],
        f: &BandEdit<'_, S>,
    ) {
        self.make_room();
        let end = (bands.end * bricks_per_band).min(self.pages.len());
        let pages = &mut self.pages[bands.start * bricks_per_band..end];
        let states = &mut states[bands.clone()];
        let work = |i: usize, pages: &mut [Option<Page>], state: &mut S| {
            f(((bands.start + i) * bricks_per_band) as u32, pages, state)
        };
        self.page_count += if parallel {
            let bands = pages.par_chunks_mut(bricks_per_band).zip(states).enumerate();
            bands.map(|(i, (pages, state))| work(i, pages, state)).sum::<usize>()
        } else {
            let bands = pages.chunks_mut(bricks_per_band).zip(states).enumerate();
            bands.map(|(i, (pages, state))| work(i, pages, state)).sum::<usize>()
        };
        self.drop_empty_table();
    }

    /// Gives each voxel of `mask` in brick `brick` the colour that `colour` returns for its local index.
    pub fn paint_each(&mut self, brick: usize, mask: &Brick, colour: impl Fn(u32) -> Rgb) {
        let (depth, bytes) = (self.depth, self.depth.bytes());
        if bytes == 0 || mask.is_empty() {
            return;
        }
        let page = self.page_mut(brick);
        mask.for_each(|i| depth.write(colour(i), &mut page[i as usize * bytes..]));
    }

    /// Replaces the page of a brick, or its absence, and returns the old one.
    pub(crate) fn swap_page(&mut self, brick: usize, page: Option<Page>) -> Option<Page> {
        if page.is_none() && self.pages.is_empty() {
            return None;
        }
        debug_assert!(page.as_ref().is_none_or(|p| p.len() == self.page_bytes()));
        self.make_room();
        self.page_count += usize::from(page.is_some());
        let before = std::mem::replace(&mut self.pages[brick], page);
        self.page_count -= usize::from(before.is_some());
        self.drop_empty_table();
        before
    }

    /// Returns a copy, unless the system lacks the memory for it.
    pub fn copied(&self) -> Result<Material, TryReserveError> {
        let page = |page: &Option<Page>| page.as_deref().map(copied_page).transpose();
        let pages = memory::copied_each(&self.pages, page)?;
        Ok(Material { pages, ..*self })
    }

    /// Allocates the table of pages, unless the system lacks the memory for it.
    pub(super) fn try_make_room(&mut self) -> Result<(), TryReserveError> {
        if self.pages.is_empty() {
            self.pages = memory::filled(None, self.brick_count)?;
        }
        Ok(())
    }

    /// Frees the table when no page is left, so that the material equals one never painted.
    fn drop_empty_table(&mut self) {
        if self.page_count == 0 {
            self.pages = Vec::new();
        }
    }

    fn make_room(&mut self) {
        if self.pages.is_empty() {
            // Exactly: the memory was checked before.
            self.pages.reserve_exact(self.brick_count);
            self.pages.resize(self.brick_count, None);
        }
    }

    fn page_mut(&mut self, brick: usize) -> &mut [u8] {
        self.make_room();
        let (depth, base, len) = (self.depth, self.base, self.page_bytes());
        let page_count = &mut self.page_count;
        self.pages[brick].get_or_insert_with(|| {
            *page_count += 1;
            let mut page = vec![0; len].into_boxed_slice();
            fill(&mut page, depth, base);
            page
        })
    }
}

/// Returns a copy of a page, unless the system lacks the memory for it.
pub(super) fn copied_page(page: &[u8]) -> Result<Page, TryReserveError> {
    memory::copied(page).map(Vec::into_boxed_slice)
}

/// Bytes of the largest page.
const MAX_PAGE_BYTES: usize = BRICK_VOXELS as usize * 3;

/// A colour prepared for painting: packed, with pages to copy from.
#[derive(Clone, Debug)]
pub struct Brush {
    packed: [u8; 3],
    bytes: usize,
    /// Whether it is the base colour.
    is_base: bool,
    base_page: [u8; MAX_PAGE_BYTES],
    full_page: [u8; MAX_PAGE_BYTES],
}

impl Brush {
    fn new(depth: ColourDepth, base: Rgb, colour: Rgb) -> Brush {
        let mut brush = Brush {
            packed: [0; 3],
            bytes: depth.bytes(),
            is_base: depth.quantise(colour) == base,
            base_page: [0; MAX_PAGE_BYTES],
            full_page: [0; MAX_PAGE_BYTES],
        };
        let len = BRICK_VOXELS as usize * depth.bytes();
        depth.write(colour, &mut brush.packed);
        fill(&mut brush.base_page[..len], depth, base);
        fill(&mut brush.full_page[..len], depth, colour);
        brush
    }

    /// Returns whether the colour is the base colour.
    pub(crate) fn is_base(&self) -> bool {
        self.is_base
    }

    /// Returns the voxels of `mask` that the brush would change on a page; none without colour depth.
    pub fn differing(&self, page: Option<&[u8]>, mask: &Brick) -> Brick {
        let Some(page) = page else {
            return if self.is_base || self.bytes == 0 { Brick::EMPTY } else { *mask };
        };
        let packed = &self.packed[..self.bytes];
        let mut differing = Brick::EMPTY;
        mask.for_each(|i| {
            let at = i as usize * self.bytes;
            let differs = page[at..at + self.bytes] != *packed;
            differing.words[i as usize / 64] |= u64::from(differs) << (i % 64);
        });
        differing
    }

    /// Gives the voxels of `mask` the colour. Adds a page if there is none, and returns whether it did. Only for a
    /// sculpture with colour depth.
    pub fn paint(&self, page: &mut Option<Page>, mask: &Brick) -> bool {
        let len = BRICK_VOXELS as usize * self.bytes;
        let made = page.is_none();
        if mask.is_full() {
            match page {
                Some(page) => page.copy_from_slice(&self.full_page[..len]),
                None => *page = Some(self.full_page[..len].into()),
            }
            return made;
        }
        let page = page.get_or_insert_with(|| self.base_page[..len].into());
        mask.for_each(|i| {
            let at = i as usize * self.bytes;
            page[at..at + self.bytes].copy_from_slice(&self.packed[..self.bytes]);
        });
        made
    }
}

/// Fills a page, or the start of one, with one colour.
fn fill(page: &mut [u8], depth: ColourDepth, colour: Rgb) {
    if depth.bytes() > 0 {
        page.chunks_exact_mut(depth.bytes()).for_each(|out| depth.write(colour, out));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb = Rgb::new(255, 0, 0);
    const GREY: Rgb = Rgb::new(180, 180, 180);

    #[test]
    fn only_painted_bricks_take_memory() {
        let mut material = Material::new(ColourDepth::Bits24, GREY, 1000);
        assert_eq!(material.heap_bytes(), 0);
        let mut mask = Brick::EMPTY;
        mask.set(3, 4, 5, true);
        material.paint(7, &mask, GREY);
        assert_eq!(material.heap_bytes(), 0, "painting the base colour needs no page");
        material.paint(7, &mask, RED);
        assert_eq!(material.page_count(), 1);
        assert_eq!(material.rgb(7, super::super::brick::local_index(3, 4, 5)), RED);
        assert_eq!(material.rgb(7, 0), GREY);
        assert_eq!(material.rgb(8, 0), GREY);
    }

    #[test]
    fn swapping_a_page_back_restores_identical_contents() {
        let mut material = Material::new(ColourDepth::Bits16, GREY, 10);
        material.paint(1, &Brick::FULL, RED);
        let before = material.clone();
        let old = material.swap_page(1, None);
        assert_eq!(material.page_count(), 0);
        assert_eq!(material.swap_page(1, old), None);
        assert_eq!(material, before);
    }

    #[test]
    fn a_sculpture_without_colours_never_makes_a_page() {
        let mut material = Material::new(ColourDepth::None, GREY, 10);
        material.paint(0, &Brick::FULL, RED);
        material.paint_each(0, &Brick::FULL, |_| RED);
        assert_eq!((material.heap_bytes(), material.rgb(0, 9)), (0, GREY));
    }
}
