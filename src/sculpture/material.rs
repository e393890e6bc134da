//! Owns the colours of one sculpture: a page of 512 packed colours for each brick that has
//! been painted, and one base colour for all other voxels.
//!
//! Takes brick and local voxel indices as [`super::grid`] and [`super::brick`] give them.
//! Knows nothing of existence: a page may hold a colour for a voxel that is not there.

use super::brick::{BRICK_VOXELS, Brick};
use super::colour::{ColourDepth, Rgb};

/// The packed colours of one brick, in the order of [`super::brick::local_index`].
pub type Page = Box<[u8]>;

/// Colour per voxel, stored only where painted.
#[derive(Clone, PartialEq, Debug)]
pub struct Material {
    depth: ColourDepth,
    base: Rgb,
    brick_count: usize,
    /// One entry a brick; empty until the first page is made.
    pages: Vec<Option<Page>>,
    page_count: usize,
}

impl Material {
    /// No voxel painted yet: all have `base`, quantised to `depth`.
    pub fn new(depth: ColourDepth, base: Rgb, brick_count: usize) -> Material {
        Material {
            depth,
            base: depth.quantise(base),
            brick_count,
            pages: Vec::new(),
            page_count: 0,
        }
    }

    pub fn depth(&self) -> ColourDepth {
        self.depth
    }

    /// Colour of every voxel that has not been painted.
    pub fn base(&self) -> Rgb {
        self.base
    }

    /// Bytes of one page.
    pub fn page_bytes(&self) -> usize {
        BRICK_VOXELS as usize * self.depth.bytes()
    }

    /// Number of bricks that have a page.
    pub fn page_count(&self) -> usize {
        self.page_count
    }

    /// Heap bytes in use.
    pub fn heap_bytes(&self) -> u64 {
        (self.pages.capacity() * size_of::<Option<Page>>() + self.page_count * self.page_bytes())
            as u64
    }

    /// Colour of voxel `local` (0..512) of brick `brick`.
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

    /// The page of a brick, if it has been painted.
    #[inline]
    pub fn page(&self, brick: usize) -> Option<&[u8]> {
        self.pages.get(brick).and_then(|p| p.as_deref())
    }

    /// Gives the voxels of `mask` in brick `brick` the colour `colour`. Does nothing without
    /// colour depth. A page is made only if a voxel of `mask` would otherwise look different.
    pub fn paint(&mut self, brick: usize, mask: &Brick, colour: Rgb) {
        let bytes = self.depth.bytes();
        if bytes == 0 || mask.is_empty() {
            return;
        }
        if self.page(brick).is_none() && self.depth.quantise(colour) == self.base {
            return;
        }
        let mut packed = [0u8; 3];
        self.depth.write(colour, &mut packed);
        let page = self.page_mut(brick);
        mask.for_each(|i| {
            let at = i as usize * bytes;
            page[at..at + bytes].copy_from_slice(&packed[..bytes]);
        });
    }

    /// Gives each voxel of `mask` in brick `brick` the colour that `colour` names for its
    /// local index.
    pub fn paint_each(&mut self, brick: usize, mask: &Brick, colour: impl Fn(u32) -> Rgb) {
        let (depth, bytes) = (self.depth, self.depth.bytes());
        if bytes == 0 || mask.is_empty() {
            return;
        }
        let page = self.page_mut(brick);
        mask.for_each(|i| depth.write(colour(i), &mut page[i as usize * bytes..]));
    }

    /// Puts back a page (or the absence of one) and returns what was there.
    pub fn swap_page(&mut self, brick: usize, page: Option<Page>) -> Option<Page> {
        if page.is_none() && self.pages.is_empty() {
            return None;
        }
        debug_assert!(page.as_ref().is_none_or(|p| p.len() == self.page_bytes()));
        self.make_room();
        self.page_count += usize::from(page.is_some());
        let before = std::mem::replace(&mut self.pages[brick], page);
        self.page_count -= usize::from(before.is_some());
        before
    }

    fn make_room(&mut self) {
        if self.pages.is_empty() {
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
            for colour in page.chunks_exact_mut(depth.bytes()) {
                depth.write(base, colour);
            }
            page
        })
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
