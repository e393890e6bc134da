//! A page: the packed colours of the 512 voxels of a brick, in as little memory as they need.
//!
//! One colour for all voxels takes none beside the page itself. Up to 16 colours are a palette, and the place of each
//! voxel's colour in it takes as many bits as the palette needs: bit `i` of the places of all voxels is a plane, laid
//! out as a brick, so that painting and comparing work on 64 voxels at a time. More colours are listed voxel by voxel.
//!
//! Pages are canonical: the same colours give the same bytes, and the colours of a palette rise. Takes colours and
//! masks of voxels; gives new pages, since pages are shared and never change. Knows no sculpture.

use std::sync::Arc;

use super::palette::{MAX_COLOURS, PagePalette, PaletteDraft};
use crate::sculpture::brick::{BRICK_VOXELS, Brick};
use crate::sculpture::colour::{ColourDepth, Rgb};

const VOXELS: usize = BRICK_VOXELS as usize;

/// Bytes of the largest page, with a colour for each voxel.
pub const MAX_PAGE_BYTES: usize = VOXELS * 3;

/// Bytes that shared memory takes beside its contents: two counters.
pub(super) const SHARED_BYTES: usize = 2 * size_of::<usize>();

/// A colour as it is stored, in the lowest bytes, the first one lowest.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug, Default)]
pub struct PackedColour(pub(super) u32);

impl PackedColour {
    /// Packs a colour.
    pub fn new(colour: Rgb, depth: ColourDepth) -> PackedColour {
        let mut bytes = [0; 4];
        depth.write(colour, &mut bytes);
        PackedColour(u32::from_le_bytes(bytes))
    }

    /// Returns the colour.
    #[inline(always)]
    pub fn rgb(self, depth: ColourDepth) -> Rgb {
        depth.read(&self.0.to_le_bytes())
    }

    /// Returns the bytes, of which only as many count as the colour depth has.
    #[inline(always)]
    pub fn bytes(self) -> [u8; 4] {
        self.0.to_le_bytes()
    }
}

/// The colours of a brick.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Page(pub(super) PageForm);

/// The forms of a page.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum PageForm {
    Uniform(PackedColour),
    /// Two to 16 colours.
    Palette(PagePalette),
    /// The packed colours of all voxels.
    Raw(Arc<[u8]>),
}

impl Page {
    /// Returns a page of one colour.
    pub fn uniform(colour: Rgb, depth: ColourDepth) -> Page {
        Page::of_packed(PackedColour::new(colour, depth))
    }

    /// Returns a page of one packed colour.
    pub(crate) fn of_packed(colour: PackedColour) -> Page {
        Page(PageForm::Uniform(colour))
    }

    /// Returns a page of the packed colours of 512 voxels, in the order of [`crate::sculpture::brick::local_index`].
    ///
    /// # Panics
    /// If there are more or fewer bytes than 512 colours have, or no colour depth.
    pub fn of_bytes(colours: &[u8], depth: ColourDepth) -> Page {
        assert_eq!(colours.len(), VOXELS * depth.bytes(), "a page has 512 colours");
        match depth.bytes() {
            1 => of_bytes::<1>(colours),
            2 => of_bytes::<2>(colours),
            3 => of_bytes::<3>(colours),
            _ => panic!("a sculpture without colours has no pages"),
        }
    }

    /// Returns the heap bytes of the page, shared or not.
    pub fn heap_bytes(&self) -> usize {
        match &self.0 {
            PageForm::Uniform(_) => 0,
            PageForm::Palette(palette) => palette.heap_bytes(),
            PageForm::Raw(bytes) => SHARED_BYTES + bytes.len(),
        }
    }

    /// Returns the only colour, if there is one.
    #[inline(always)]
    pub(crate) fn packed(&self) -> Option<PackedColour> {
        match self.0 {
            PageForm::Uniform(colour) => Some(colour),
            _ => None,
        }
    }

    /// Returns the voxels of `mask` that have another colour.
    pub(crate) fn differing(&self, mask: &Brick, colour: PackedColour) -> Brick {
        match &self.0 {
            PageForm::Uniform(now) if *now == colour => Brick::EMPTY,
            PageForm::Uniform(_) => *mask,
            PageForm::Palette(palette) => match palette.place_of(colour) {
                Some(place) => mask.and_not(&palette.voxels_of(place)),
                None => *mask,
            },
            PageForm::Raw(bytes) => {
                let (size, packed) = (bytes.len() / VOXELS, colour.bytes());
                let mut differing = Brick::EMPTY;
                mask.for_each(|i| {
                    let at = i as usize * size;
                    let differs = bytes[at..at + size] != packed[..size];
                    differing.words[i as usize / 64] |= u64::from(differs) << (i % 64);
                });
                differing
            }
        }
    }

    /// Returns the page after painting the voxels of `mask`.
    pub(crate) fn painted(&self, mask: &Brick, colour: PackedColour, depth: ColourDepth) -> Page {
        if mask.is_full() {
            return Page::of_packed(colour);
        }
        let mut draft = match &self.0 {
            PageForm::Uniform(now) => PaletteDraft::uniform(*now),
            PageForm::Palette(palette) => palette.draft(),
            PageForm::Raw(bytes) => {
                let (size, packed) = (bytes.len() / VOXELS, colour.bytes());
                let mut buffer = [0; MAX_PAGE_BYTES];
                let buffer = &mut buffer[..bytes.len()];
                buffer.copy_from_slice(bytes);
                mask.for_each(|i| {
                    let at = i as usize * size;
                    buffer[at..at + size].copy_from_slice(&packed[..size]);
                });
                return Page::of_bytes(buffer, depth);
            }
        };
        draft.paint(mask, colour);
        draft.finish(depth)
    }

    /// Returns an upper bound of the bytes by which painting one more colour makes the page larger.
    pub(crate) fn growth(&self, colour: PackedColour, depth: ColourDepth) -> usize {
        let colours = match &self.0 {
            PageForm::Uniform(now) if *now == colour => return 0,
            PageForm::Uniform(_) => 1,
            PageForm::Palette(palette) if palette.place_of(colour).is_some() => return 0,
            PageForm::Palette(palette) => palette.len(),
            PageForm::Raw(_) => return 0,
        };
        Page::bytes_for(colours + 1, depth).saturating_sub(self.heap_bytes())
    }

    /// Returns the most heap bytes of a page of so many colours.
    pub(crate) fn bytes_for(colours: usize, depth: ColourDepth) -> usize {
        match colours {
            0 | 1 => 0,
            2..=MAX_COLOURS => PagePalette::bytes_for(colours),
            _ => SHARED_BYTES + VOXELS * depth.bytes(),
        }
    }

    /// Writes the packed colours of all voxels.
    fn write_to(&self, out: &mut [u8]) {
        match out.len() / VOXELS {
            1 => write::<1>(&self.0, out),
            2 => write::<2>(&self.0, out),
            3 => write::<3>(&self.0, out),
            _ => {}
        }
    }
}

/// Writes the colours of a page, of `B` bytes each.
fn write<const B: usize>(page: &PageForm, out: &mut [u8]) {
    match page {
        PageForm::Uniform(colour) => fill::<B>(*colour, out),
        PageForm::Raw(bytes) => out.copy_from_slice(bytes),
        PageForm::Palette(palette) => palette.write::<B>(out),
    }
}

/// Fills a list of packed colours.
fn fill<const B: usize>(colour: PackedColour, out: &mut [u8]) {
    let packed: [u8; B] = packed(colour);
    out.as_chunks_mut::<B>().0.iter_mut().for_each(|out| *out = packed);
}

/// Returns the bytes of a colour that count.
#[inline(always)]
pub(super) fn packed<const B: usize>(colour: PackedColour) -> [u8; B] {
    let bytes = colour.bytes();
    std::array::from_fn(|i| bytes[i])
}

/// Returns the page of packed colours of `B` bytes.
fn of_bytes<const B: usize>(colours: &[u8]) -> Page {
    let packed = |colour: &[u8; B]| {
        let mut bytes = [0; 4];
        bytes[..B].copy_from_slice(colour);
        PackedColour(u32::from_le_bytes(bytes))
    };
    let voxels = colours.as_chunks::<B>().0;
    // All are alike if each is like the next.
    if colours[B..] == colours[..colours.len() - B] {
        return Page::of_packed(packed(&voxels[0]));
    }
    match PaletteDraft::of(voxels.iter().map(packed)) {
        Some(draft) => draft.finish_known(),
        None => Page(PageForm::Raw(colours.into())),
    }
}

/// Read access to a page, or to the one colour of a larger cube that holds the brick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PageView<'a> {
    pub(super) page: &'a Page,
    pub(super) depth: ColourDepth,
}

impl<'a> PageView<'a> {
    /// Returns read access to a page of a sculpture of this colour depth.
    pub fn of(page: &'a Page, depth: ColourDepth) -> PageView<'a> {
        PageView { page, depth }
    }

    /// Returns the bits of colour per voxel.
    pub fn depth(&self) -> ColourDepth {
        self.depth
    }

    /// Returns the colour of voxel `local` (0..512).
    #[inline(always)]
    pub fn rgb(&self, local: u32) -> Rgb {
        match &self.page.0 {
            PageForm::Uniform(colour) => colour.rgb(self.depth),
            PageForm::Palette(palette) => palette.colour(palette.place(local)).rgb(self.depth),
            PageForm::Raw(bytes) => self.depth.read(&bytes[local as usize * self.depth.bytes()..]),
        }
    }

    /// Returns the colour of all voxels, if they have the same.
    #[inline(always)]
    pub fn uniform(&self) -> Option<Rgb> {
        self.page.packed().map(|colour| colour.rgb(self.depth))
    }

    /// Returns the packed colour of all voxels, if they have the same.
    #[inline(always)]
    pub(crate) fn packed(&self) -> Option<PackedColour> {
        self.page.packed()
    }

    /// Writes the packed colours of all voxels, in the order of [`crate::sculpture::brick::local_index`], to the first
    /// [`super::Material::page_bytes`] bytes of `out`, and returns these.
    ///
    /// # Panics
    /// If `out` is shorter; [`MAX_PAGE_BYTES`] are always enough.
    pub fn write_to<'b>(&self, out: &'b mut [u8]) -> &'b [u8] {
        let out = &mut out[..VOXELS * self.depth.bytes()];
        self.page.write_to(out);
        out
    }

    /// Returns the page, which costs no copy.
    pub fn to_page(&self) -> Page {
        self.page.clone()
    }
}
