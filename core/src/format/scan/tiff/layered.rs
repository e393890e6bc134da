//! Large TIFF stacks whose pixels stay in their files: those that lie in strips, not packed or packed with Deflate.
//!
//! Takes the tags of the pages; gives the places of their strips. All other stacks are read whole.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use tiff::ColorType;
use tiff::decoder::Decoder;
use tiff::tags::{ByteOrder, Tag};

use super::super::frame::AxisFrame;
use super::super::numbers::Number;
use super::super::reading::{Reading, Scan};
use super::{Page, TiffStack, page_of};
use crate::format::layered::{LayeredVolume, PartPacking, StoredNumbers, StoredVoxels, VoxelPart};
use crate::format::{FormatError, store};

/// The most strips whose places are kept.
const MOST_PARTS: usize = 1 << 20;

/// Values of [`Tag::Compression`], [`Tag::PhotometricInterpretation`], [`Tag::PlanarConfiguration`],
/// [`Tag::Predictor`] and [`Tag::FillOrder`] (TIFF 6.0; Deflate: TIFF Technical Note 2).
const NOT_PACKED: u32 = 1;
const DEFLATE: [u32; 2] = [8, 32946];
const BLACK_IS_ZERO: u32 = 1;
const RGB: u32 = 2;
const INTERLEAVED: u32 = 1;
const NO_PREDICTOR: u32 = 1;
const HIGH_BIT_FIRST: u32 = 1;

type PagesInFile = Decoder<BufReader<File>>;

/// The storage of the pixels of a page.
#[derive(Clone, Copy, PartialEq, Debug)]
struct PageCoding {
    number: Number,
    packing: PartPacking,
    is_big: bool,
}

/// Returns the scan of a large stack that stays in its files; `None` for one that must be read whole, also because it
/// cannot be read.
pub fn scan(path: &Path, reading: &Reading) -> Result<Option<Scan>, FormatError> {
    if !reading.in_layers {
        return Ok(None);
    }
    let Some((mut pages, stack, coding)) = first(path, reading) else { return Ok(None) };
    if !reading.is_large(coding.number.volume_bytes(stack.dims)) {
        return Ok(None);
    }
    let mut parts = Vec::new();
    if let Some(begin) = stack.behind {
        let bytes = coding.layer_bytes(stack.page);
        for &i in &stack.pages {
            let begin = begin.saturating_add(bytes.saturating_mul(i as u64));
            coding.add(&mut parts, VoxelPart { begin, ..coding.part(path, bytes) });
        }
    } else if stack.series.is_empty() {
        for &i in &stack.pages {
            let is_found = pages.seek_to_image(i).is_ok();
            if !is_found || !coding.add_page(&mut pages, stack.page, path, &mut parts) {
                return Ok(None);
            }
        }
    } else {
        for path in &stack.series {
            let mut file = pages_in(path)?;
            if page_of(&mut file)? != stack.page
                || !coding.add_page(&mut file, stack.page, path, &mut parts)
            {
                return Ok(None);
            }
        }
    }
    let kind = stack.kind();
    let TiffStack { dims, voxel_size, volumes, notes, .. } = stack;
    let PageCoding { number, is_big, .. } = coding;
    let stored = StoredVoxels {
        parts,
        skip: 0,
        numbers: StoredNumbers { number, is_big, scale: [1.0, 0.0] },
    };
    let volume = LayeredVolume::new(stored, dims, voxel_size, Vec::new(), reading.progress)?.into();
    let frame = AxisFrame::Unknown;
    Ok(Some(Scan { volume, frame, kind, is_label: false, volumes, notes }))
}

/// Returns the pages of the first file, the stack, and its storage; `None` if it must be read whole.
fn first(path: &Path, reading: &Reading) -> Option<(PagesInFile, TiffStack, PageCoding)> {
    let mut pages = pages_in(path).ok()?;
    let coding = PageCoding::of(&mut pages)?;
    let stack = TiffStack::of(&mut pages, path, reading).ok()?;
    Some((pages, stack, coding))
}

fn pages_in(path: &Path) -> Result<PagesInFile, FormatError> {
    Decoder::new(BufReader::new(store::open(path)?)).map_err(super::damaged)
}

impl PageCoding {
    /// Returns the storage of the current page; `None` if its strips are not its voxels in their order.
    fn of(pages: &mut PagesInFile) -> Option<PageCoding> {
        let is_big = pages.byte_order() == ByteOrder::BigEndian;
        let mut of = |tag: Tag, usual: u32| {
            pages.find_tag_unsigned(tag).ok().map(|own| own.unwrap_or(usual))
        };
        let packing = match of(Tag::Compression, NOT_PACKED)? {
            NOT_PACKED => PartPacking::Plain,
            packing if DEFLATE.contains(&packing) => PartPacking::Zlib,
            _ => return None,
        };
        let is_plain = of(Tag::Predictor, NO_PREDICTOR)? == NO_PREDICTOR
            && of(Tag::PlanarConfiguration, INTERLEAVED)? == INTERLEAVED
            && of(Tag::FillOrder, HIGH_BIT_FIRST)? == HIGH_BIT_FIRST
            && [BLACK_IS_ZERO, RGB].contains(&of(Tag::PhotometricInterpretation, u32::MAX)?);
        let formats: Option<Vec<u32>> = pages.find_tag_unsigned_vec(Tag::SampleFormat).ok()?;
        let format = formats.and_then(|formats| formats.first().copied()).unwrap_or(1);
        let number = match (pages.colortype().ok()?, format) {
            (ColorType::Gray(8), 1) => Number::U8,
            (ColorType::Gray(8), 2) => Number::I8,
            (ColorType::Gray(16), 1) => Number::U16,
            (ColorType::Gray(16), 2) => Number::I16,
            (ColorType::Gray(32), 1) => Number::U32,
            (ColorType::Gray(32), 2) => Number::I32,
            (ColorType::Gray(32), 3) => Number::F32,
            (ColorType::Gray(64), 1) => Number::U64,
            (ColorType::Gray(64), 2) => Number::I64,
            (ColorType::Gray(64), 3) => Number::F64,
            (ColorType::RGB(8), 1) => Number::Rgb,
            (ColorType::RGBA(8), 1) => Number::Rgba,
            _ => return None,
        };
        is_plain.then_some(PageCoding { number, packing, is_big })
    }

    fn layer_bytes(self, page: Page) -> u64 {
        u64::from(page.width) * u64::from(page.height) * self.number.bytes()
    }

    /// Returns a part at the start of a file.
    fn part(self, path: &Path, bytes: u64) -> VoxelPart {
        VoxelPart { path: path.to_path_buf(), packing: self.packing, packed_at: 0, begin: 0, bytes }
    }

    /// Adds the strips of the current page. Returns false if they are not all of its pixels in their order, or stored
    /// otherwise.
    fn add_page(
        self,
        pages: &mut PagesInFile,
        page: Page,
        path: &Path,
        parts: &mut Vec<VoxelPart>,
    ) -> bool {
        let (Ok(begins), Ok(lengths)) =
            (pages.get_tag_u64_vec(Tag::StripOffsets), pages.get_tag_u64_vec(Tag::StripByteCounts))
        else {
            return false;
        };
        if PageCoding::of(pages) != Some(self) {
            return false;
        }
        let rows = pages.find_tag_unsigned(Tag::RowsPerStrip).ok().flatten().unwrap_or(page.height);
        let rows = rows.clamp(1, page.height);
        let strips = page.height.div_ceil(rows) as usize;
        if begins.len() != strips || lengths.len() != strips || parts.len() + strips > MOST_PARTS {
            return false;
        }
        let row = u64::from(page.width) * self.number.bytes();
        for (i, (&begin, &length)) in (0..).zip(begins.iter().zip(&lengths)) {
            let bytes = row * u64::from(rows.min(page.height - i * rows));
            let part = self.part(path, bytes);
            match self.packing {
                PartPacking::Plain if length < bytes => return false,
                PartPacking::Plain => self.add(parts, VoxelPart { begin, ..part }),
                _ => self.add(parts, VoxelPart { packed_at: begin, ..part }),
            }
        }
        true
    }

    /// Adds a part, as one with the last where it follows that in the file.
    fn add(self, parts: &mut Vec<VoxelPart>, part: VoxelPart) {
        let is_plain = self.packing == PartPacking::Plain;
        match parts.last_mut() {
            Some(last)
                if is_plain
                    && last.path == part.path
                    && last.begin.checked_add(last.bytes) == Some(part.begin) =>
            {
                last.bytes += part.bytes;
            }
            _ => parts.push(part),
        }
    }
}
