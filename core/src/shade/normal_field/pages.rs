//! Storage of the records of surface voxels: a page for each brick that has any.
//!
//! A page has the mask of its surface voxels, then a record for each; the index of a voxel's record is the number of
//! surface voxels before it. So memory is proportional to the surface: 80 bytes per brick and 4 per voxel, rounded up
//! to units of 128 bytes. All pages are numbers in one array that a device holds in the same form. Freed memory is
//! reused.

use bytemuck::{Pod, Zeroable};

use super::packed::{PackedDepth, PackedNormal};
use super::window::SurfaceMask;

/// Numbers of 4 bytes in a unit.
const UNIT_NUMBERS: usize = 32;
/// Numbers of a page before its records: two for the mask of each layer, then the 16-bit counts before each layer.
const HEAD_NUMBERS: usize = 20;
/// The most units of a page: one of a brick of surface voxels only.
const MOST_UNITS: usize = (HEAD_NUMBERS + 512_usize).div_ceil(UNIT_NUMBERS);

/// Numbers in a cache line.
const LINE_NUMBERS: usize = 16;
/// Cache lines that hold the head and the records of most pages: of up to 108 surface voxels.
const FETCHED_LINES: usize = 8;

/// The entry of a brick without a page: that of a page without surface voxels, so that look-ups need no branch.
pub const NO_PAGE: u32 = 0;

/// The unit that pages consist of.
#[repr(C, align(64))]
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Pod, Zeroable)]
pub struct PageUnit(pub [u32; UNIT_NUMBERS]);

/// The record of a surface voxel: its normal in the lower half, then its depth and its openness in a byte each.
#[repr(transparent)]
#[derive(Clone, Copy, PartialEq, Eq, Debug, Pod, Zeroable)]
pub struct SurfaceRecord(pub u32);

impl SurfaceRecord {
    /// The record of a voxel that is not a surface voxel, or whose brick has not been computed yet: without a normal.
    pub const NONE: SurfaceRecord = SurfaceRecord(PackedNormal::NONE.0 as u32);

    /// Returns a record. `openness`: the share of ambient light that arrives, 255 for all of it.
    #[inline(always)]
    pub fn new(normal: PackedNormal, depth: PackedDepth, openness: u8) -> SurfaceRecord {
        SurfaceRecord(
            u32::from(normal.0) | u32::from(depth.0) << 16 | u32::from(openness) << Self::OPENNESS,
        )
    }

    /// The first bit of the openness.
    pub const OPENNESS: u32 = 24;

    /// Returns its normal, if it has one.
    #[inline(always)]
    pub fn normal(self) -> PackedNormal {
        PackedNormal(self.0 as u16)
    }

    /// Returns the depth of the voxel's centre.
    #[inline(always)]
    pub fn depth(self) -> PackedDepth {
        PackedDepth((self.0 >> 16) as u8)
    }

    /// Returns the share of ambient light that arrives, 255 for all of it.
    #[inline(always)]
    pub fn openness(self) -> u8 {
        (self.0 >> Self::OPENNESS) as u8
    }

    /// Returns all but the openness.
    fn shape(self) -> u32 {
        self.0 & ((1 << Self::OPENNESS) - 1)
    }
}

/// The beginning of a page. Its records follow.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Pod, Zeroable)]
struct PageHeader {
    /// The surface voxels: a word per z, bit `x + 8 y`.
    layers: [u64; 8],
    /// Surface voxels before each layer.
    before: [u16; 8],
}

impl PageHeader {
    fn of(mask: &SurfaceMask) -> PageHeader {
        let mut head = PageHeader { layers: mask.layers, before: [0; 8] };
        let mut before = 0;
        for (count, layer) in head.before.iter_mut().zip(mask.layers) {
            *count = before;
            before += layer.count_ones() as u16;
        }
        head
    }

    /// Returns the number of surface voxels.
    fn count(&self) -> usize {
        usize::from(self.before[7]) + self.layers[7].count_ones() as usize
    }
}

/// Returns the number of units of a page with `records` records.
fn units_for(records: usize) -> usize {
    (HEAD_NUMBERS + records).div_ceil(UNIT_NUMBERS)
}

/// The pages of one grid.
#[derive(Debug)]
pub struct Pages {
    /// The first one is [`NO_PAGE`].
    units: Vec<PageUnit>,
    /// Free runs of units, by their length less 1: the first unit of each.
    free: [Vec<u32>; MOST_UNITS],
    free_units: usize,
    /// The units written since the last query.
    written: Vec<u32>,
}

impl Default for Pages {
    fn default() -> Pages {
        Pages {
            units: vec![PageUnit::default()],
            free: Default::default(),
            free_units: 0,
            written: vec![0],
        }
    }
}

impl Pages {
    /// Returns all units, free ones included.
    pub fn units(&self) -> &[PageUnit] {
        &self.units
    }

    /// Returns the memory of all pages, without that of free units, in bytes.
    pub fn used_bytes(&self) -> usize {
        (self.units.len() - self.free_units) * size_of::<PageUnit>()
    }

    /// Moves the indices of the units that were written since the last call to `target`: in ascending order, each once.
    pub fn take_written(&mut self, target: &mut Vec<u32>) {
        target.clear();
        target.append(&mut self.written);
        target.sort_unstable();
        target.dedup();
    }

    /// Returns a view for looking up many records.
    #[inline(always)]
    pub fn records(&self) -> PageRecords<'_> {
        PageRecords { units: &self.units, numbers: bytemuck::cast_slice(&self.units) }
    }

    /// Returns the record of the voxel `local` (`x + 8 y + 64 z`) of a page; `None` if it is not a surface voxel.
    #[inline(always)]
    pub fn record(&self, page: u32, local: u32) -> Option<SurfaceRecord> {
        let layer = self.layers(page)[local as usize / 64 % 8];
        (layer >> (local % 64) & 1 != 0).then(|| self.records().at(page, local))
    }

    /// Returns the surface voxels of a page: a word per z, bit `x + 8 y`.
    pub fn layers(&self, page: u32) -> &[u64; 8] {
        &self.head(page).layers
    }

    /// Reads part of the first cache lines of `pages`, so that their memory accesses overlap. The result has no
    /// meaning, but must be used.
    #[inline(always)]
    pub fn fetch(&self, pages: &[u32]) -> u32 {
        let numbers = self.records().numbers;
        let mut sum = 0;
        for page in pages {
            // The page after a short one usually belongs to an adjacent brick.
            let first = UNIT_NUMBERS * *page as usize;
            for line in 0..FETCHED_LINES {
                sum ^= numbers.get(first + LINE_NUMBERS * line).copied().unwrap_or(0);
            }
        }
        sum
    }

    fn head(&self, page: u32) -> &PageHeader {
        let numbers = &self.units[page as usize].0[..HEAD_NUMBERS];
        bytemuck::from_bytes(bytemuck::cast_slice(numbers))
    }

    /// Stores the records of a brick, in the order of `mask`, in place of those of `page`, which may be [`NO_PAGE`].
    /// Returns the page, and whether anything but openness differs from before. Without surface voxels there is no
    /// page.
    pub fn store(
        &mut self,
        page: u32,
        mask: &SurfaceMask,
        records: &[SurfaceRecord],
    ) -> (u32, bool) {
        if records.is_empty() {
            self.free(page);
            return (NO_PAGE, page != NO_PAGE);
        }
        let former = *self.head(page);
        let head = PageHeader::of(mask);
        let units = units_for(records.len());
        let fits = page != NO_PAGE && units_for(former.count()) == units;
        if !fits {
            self.free(page);
        }
        let new_page = if fits { page } else { self.new_run(units) };
        let first = UNIT_NUMBERS * new_page as usize;
        let numbers: &mut [u32] = bytemuck::cast_slice_mut(&mut self.units);
        let (old_head, old) =
            numbers[first..first + HEAD_NUMBERS + records.len()].split_at_mut(HEAD_NUMBERS);
        let mut differs = !fits || head != former;
        let new_head: [u32; HEAD_NUMBERS] = bytemuck::cast(head);
        if !fits || old_head != new_head {
            old_head.copy_from_slice(&new_head);
            self.written.push(new_page);
        }
        // Unit by unit, so that only those that differ are written.
        let mut at = 0;
        for unit in 0..units {
            let end = (UNIT_NUMBERS * (unit + 1) - HEAD_NUMBERS).min(records.len());
            let (old, new) = (&mut old[at..end], &records[at..end]);
            let new_numbers: &[u32] = bytemuck::cast_slice(new);
            if !fits || old != new_numbers {
                differs = differs
                    || old
                        .iter()
                        .zip(new)
                        .any(|(old, new)| SurfaceRecord(*old).shape() != new.shape());
                old.copy_from_slice(new_numbers);
                self.written.push(new_page + unit as u32);
            }
            at = end;
        }
        (new_page, differs)
    }

    /// Frees a page, which may be [`NO_PAGE`].
    pub fn free(&mut self, page: u32) {
        if page != NO_PAGE {
            let units = units_for(self.head(page).count());
            self.free[units - 1].push(page);
            self.free_units += units;
        }
    }

    /// Frees everything.
    pub fn clear(&mut self) {
        *self = Pages::default();
    }

    /// Returns a run of units: the shortest free one that is long enough, or a part of it, or a new one.
    fn new_run(&mut self, units: usize) -> u32 {
        let found =
            (units..=MOST_UNITS).find_map(|length| Some((length, self.free[length - 1].pop()?)));
        match found {
            Some((length, run)) => {
                self.free_units -= units;
                if length > units {
                    self.free[length - units - 1].push(run + units as u32);
                }
                run
            }
            None => {
                let run = self.units.len();
                self.units.resize(run + units, PageUnit::default());
                run as u32
            }
        }
    }
}

/// The records of all pages, as a shader looks them up.
#[derive(Clone, Copy)]
pub struct PageRecords<'a> {
    units: &'a [PageUnit],
    numbers: &'a [u32],
}

impl PageRecords<'_> {
    /// Returns the record of the voxel `local` (`x + 8 y + 64 z`) of a page, which may be [`NO_PAGE`]. Has no branches,
    /// so that memory accesses of successive voxels overlap.
    #[inline(always)]
    pub fn at(&self, page: u32, local: u32) -> SurfaceRecord {
        let z = local as usize / 64 % 8;
        let Some(unit) = self.units.get(page as usize) else { return SurfaceRecord::NONE };
        let (layers, counts): (&[u64; 16], &[u16; 64]) =
            (bytemuck::must_cast_ref(unit), bytemuck::must_cast_ref(unit));
        let layer = layers[z];
        let below = layer & ((1 << (local % 64)) - 1);
        let place = usize::from(counts[32 + z]) + below.count_ones() as usize;
        let number = self.numbers.get(UNIT_NUMBERS * page as usize + HEAD_NUMBERS + place);
        let exists = layer >> (local % 64) & 1 != 0;
        let number = number.copied().unwrap_or(0);
        SurfaceRecord(if exists { number } else { SurfaceRecord::NONE.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::Random;

    fn units_in_use(mask: &SurfaceMask) -> usize {
        if mask.count() == 0 { 0 } else { units_for(mask.count()) }
    }

    /// Random pages, replaced and freed, always return the values stored last, and freed memory is reused. A copy that
    /// follows the written units is the same.
    #[test]
    fn pages_keep_what_was_stored_last() {
        let mut random = Random(9);
        let mut pages = Pages::default();
        let (mut copy, mut written) = (Vec::<PageUnit>::new(), Vec::new());
        let mut stored: Vec<(u32, SurfaceMask, Vec<SurfaceRecord>)> = vec![Default::default(); 20];
        for round in 0..2000 {
            let brick = random.next_u64() as usize % stored.len();
            let density = random.next_u64() % 5;
            let layers = std::array::from_fn(|_| match density {
                0 => 0,
                1 => u64::MAX,
                2 => random.next_u64() & random.next_u64() & random.next_u64(),
                _ => random.next_u64(),
            });
            let mask = SurfaceMask { layers };
            let records: Vec<_> =
                (0..mask.count()).map(|_| SurfaceRecord(random.next_u64() as u32)).collect();
            let (page, former_mask, former) = &mut stored[brick];
            let shapes = |records: &[SurfaceRecord]| -> Vec<u32> {
                records.iter().map(|record| record.shape()).collect()
            };
            let differs = *former_mask != mask || shapes(former) != shapes(&records);
            let (new_page, found) = pages.store(*page, &mask, &records);
            assert_eq!(found, differs, "round {round}");
            assert_eq!(pages.store(new_page, &mask, &records), (new_page, false));
            // A change of openness alone is written, but does not count as a difference.
            let lit: Vec<_> =
                records.iter().map(|record| SurfaceRecord(record.0 ^ 3 << 24)).collect();
            assert_eq!(pages.store(new_page, &mask, &lit), (new_page, false));
            (*page, *former_mask, *former) = (new_page, mask, lit);
            pages.take_written(&mut written);
            copy.resize(pages.units().len(), PageUnit::default());
            written.iter().for_each(|&i| copy[i as usize] = pages.units()[i as usize]);
            assert!(copy == pages.units(), "round {round}");
        }
        for (page, mask, records) in &stored {
            let mut expected = records.iter();
            for local in 0..512 {
                let exists = mask.layers[local as usize / 64] >> (local % 64) & 1 != 0;
                let record = exists.then(|| *expected.next().unwrap());
                assert_eq!(pages.record(*page, local), record);
                assert_eq!(pages.records().at(*page, local), record.unwrap_or(SurfaceRecord::NONE));
            }
        }
        assert!(pages.units().len() <= 30 * MOST_UNITS, "{}", pages.units().len());
        let used: usize = stored.iter().map(|(_, mask, _)| units_in_use(mask)).sum();
        assert_eq!(pages.used_bytes(), (1 + used) * size_of::<PageUnit>());
        assert!(pages.units()[0] == PageUnit::default());
    }

    #[test]
    fn a_record_gives_back_what_it_was_made_of() {
        let record = SurfaceRecord::new(PackedNormal(0xABCD), PackedDepth(0x12), 0x34);
        let parts = (record.normal(), record.depth(), record.openness());
        assert_eq!(parts, (PackedNormal(0xABCD), PackedDepth(0x12), 0x34));
        assert_eq!(SurfaceRecord::NONE.normal(), PackedNormal::NONE);
    }
}
