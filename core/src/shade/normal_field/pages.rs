//! Storage of packed normals and depths: a page for each brick with surface voxels, blocks of 64 normals, and blocks
//! of 128 depths.
//!
//! A page has the mask of its surface voxels; a voxel's normal has the number of surface voxels before it. So
//! memory follows the surface: 128 bytes a brick and 3 to 6 a voxel. Pages and blocks are all 128 bytes, numbers
//! in one array that a device holds in the same form. What is freed is used again.

use bytemuck::{Pod, Zeroable};

use super::packed::{PackedDepth, PackedNormal};
use super::window::SurfaceMask;
use crate::sculpture::brick::BRICK_VOXELS;

/// Normals in a block.
const BLOCK_NORMALS: usize = 64;
/// Depths in a block.
const BLOCK_DEPTHS: usize = 128;
/// Most blocks of a page.
const PAGE_BLOCKS: usize = BRICK_VOXELS as usize / BLOCK_NORMALS;
const PAGE_DEPTH_BLOCKS: usize = BRICK_VOXELS as usize / BLOCK_DEPTHS;

/// The entry of a brick without a page.
pub const NO_PAGE: u32 = u32::MAX;

/// Where a normal is kept: its block, and its number in it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PlaceOfNormal {
    block: u32,
    i: u32,
}

impl PlaceOfNormal {
    /// No normal.
    pub const NONE: PlaceOfNormal = PlaceOfNormal { block: u32::MAX, i: 0 };
}

/// A page or a block.
#[repr(C, align(64))]
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Pod, Zeroable)]
pub struct Unit(pub [u32; 32]);

/// The normals of one brick.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Pod, Zeroable)]
struct Page {
    /// The surface voxels: a word per z, bit `x + 8 y`.
    layers: [u64; 8],
    /// Surface voxels before each layer.
    before: [u16; 8],
    /// The blocks of the normals, in order.
    blocks: [u32; PAGE_BLOCKS],
    /// Those of the depths.
    depths: [u32; PAGE_DEPTH_BLOCKS],
}

/// Packed normals of 64 voxels.
type Block = [PackedNormal; BLOCK_NORMALS];

/// Pages and blocks.
#[derive(Debug, Default)]
pub struct Pages {
    units: Vec<Unit>,
    free: Vec<u32>,
    /// The units that were written since they were last asked for.
    written: Vec<u32>,
}

impl Pages {
    /// All units, free ones included.
    pub fn units(&self) -> &[Unit] {
        &self.units
    }

    /// Moves the numbers of the units that were written since the last call to `target`: rising, each once.
    pub fn take_written(&mut self, target: &mut Vec<u32>) {
        target.clear();
        target.append(&mut self.written);
        target.sort_unstable();
        target.dedup();
    }

    fn page(&self, page: u32) -> &Page {
        bytemuck::cast_ref(&self.units[page as usize])
    }

    fn block(&self, block: u32) -> &Block {
        bytemuck::cast_ref(&self.units[block as usize])
    }

    /// Where the normal of the voxel at `bit` (`x + 8 y`) of layer `z` of a page is kept, for [`Pages::normal_at`]: in
    /// two steps, so that the memory that one voxel needs is waited for together with that of others. No block, if it
    /// is no surface voxel.
    #[inline(always)]
    pub fn place_of_normal(&self, page: u32, z: usize, bit: u32) -> PlaceOfNormal {
        let Some(unit) = self.units.get(page as usize) else { return PlaceOfNormal::NONE };
        let page: &Page = bytemuck::cast_ref(unit);
        match page.place(z, bit) {
            Some(i) => PlaceOfNormal {
                block: page.blocks[i / BLOCK_NORMALS],
                i: (i % BLOCK_NORMALS) as u32,
            },
            None => PlaceOfNormal::NONE,
        }
    }

    /// The normal at a place.
    #[inline(always)]
    pub fn normal_at(&self, place: PlaceOfNormal) -> PackedNormal {
        match self.units.get(place.block as usize) {
            Some(unit) => bytemuck::cast_ref::<Unit, Block>(unit)[place.i as usize % BLOCK_NORMALS],
            None => PackedNormal::NONE,
        }
    }

    /// The normal of the voxel at `bit` (`x + 8 y`) of layer `z` of a page.
    #[inline(always)]
    pub fn normal(&self, page: u32, z: usize, bit: u32) -> PackedNormal {
        let page = self.page(page);
        match page.place(z, bit) {
            Some(i) => self.block(page.blocks[i / BLOCK_NORMALS])[i % BLOCK_NORMALS],
            None => PackedNormal::NONE,
        }
    }

    /// The depth of the voxel at `bit` of layer `z` of a page; none if it is no surface voxel.
    #[inline(always)]
    pub fn depth(&self, page: u32, z: usize, bit: u32) -> Option<PackedDepth> {
        let page = self.page(page);
        let i = page.place(z, bit)?;
        let block = bytemuck::bytes_of(&self.units[page.depths[i / BLOCK_DEPTHS] as usize]);
        Some(PackedDepth(block[i % BLOCK_DEPTHS]))
    }

    /// The surface voxels of a page: a word per z, bit `x + 8 y`.
    pub fn layers(&self, page: u32) -> &[u64; 8] {
        &self.page(page).layers
    }

    /// Stores the normals and depths of a brick, in the order of `mask`, in place of those of `page`, which may be
    /// [`NO_PAGE`]. Returns the page, and whether it differs from what there was. Without surface voxels there is
    /// no page.
    pub fn store(
        &mut self,
        page: u32,
        mask: &SurfaceMask,
        (normals, depths): (&[PackedNormal], &[PackedDepth]),
    ) -> (u32, bool) {
        if normals.is_empty() {
            self.free(page);
            return (NO_PAGE, page != NO_PAGE);
        }
        let is_new = page == NO_PAGE;
        let page = if is_new { self.new_unit() } else { page };
        let former = if is_new { Page::default() } else { *self.page(page) };
        let mut content = Page { layers: mask.layers, ..former };
        let had = former.count();
        self.fit(&mut content.blocks, [had, normals.len()], BLOCK_NORMALS);
        self.fit(&mut content.depths, [had, normals.len()], BLOCK_DEPTHS);
        let mut before = 0;
        for (count, layer) in content.before.iter_mut().zip(mask.layers) {
            *count = before;
            before += layer.count_ones() as u16;
        }
        let mut differs = is_new || content != former;
        if differs {
            self.units[page as usize] = bytemuck::cast(content);
            self.written.push(page);
        }
        for (normals, block) in normals.chunks(BLOCK_NORMALS).zip(content.blocks) {
            differs |= self.write(block, bytemuck::cast_slice(normals));
        }
        for (depths, block) in depths.chunks(BLOCK_DEPTHS).zip(content.depths) {
            differs |= self.write(block, bytemuck::cast_slice(depths));
        }
        (page, differs)
    }

    /// Gives a page as many blocks as it needs, where it had those for another number of values.
    fn fit(&mut self, blocks: &mut [u32], [had, need]: [usize; 2], block_values: usize) {
        let [had, need] = [had, need].map(|values| values.div_ceil(block_values));
        self.free.extend_from_slice(&blocks[need.min(had)..had]);
        for block in &mut blocks[had.min(need)..need] {
            *block = self.new_unit();
        }
        blocks[need..].fill(0);
    }

    /// Writes the beginning of a block; returns whether it was different.
    fn write(&mut self, block: u32, bytes: &[u8]) -> bool {
        let stored = &mut bytemuck::bytes_of_mut(&mut self.units[block as usize])[..bytes.len()];
        let differs = stored != bytes;
        if differs {
            stored.copy_from_slice(bytes);
            self.written.push(block);
        }
        differs
    }

    /// Frees a page, which may be [`NO_PAGE`].
    pub fn free(&mut self, page: u32) {
        if page != NO_PAGE {
            let content = *self.page(page);
            let count = content.count();
            self.free.extend_from_slice(&content.blocks[..count.div_ceil(BLOCK_NORMALS)]);
            self.free.extend_from_slice(&content.depths[..count.div_ceil(BLOCK_DEPTHS)]);
            self.free.push(page);
        }
    }

    /// Frees everything.
    pub fn clear(&mut self) {
        *self = Pages::default();
    }

    fn new_unit(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.units.push(Unit::default());
            self.units.len() as u32 - 1
        })
    }
}

impl Page {
    /// The number of surface voxels before that at `bit` of layer `z`, if it is one.
    #[inline(always)]
    fn place(&self, z: usize, bit: u32) -> Option<usize> {
        let layer = self.layers[z];
        let before = (layer & ((1 << bit) - 1)).count_ones() as usize;
        (layer >> bit & 1 != 0).then_some(usize::from(self.before[z]) + before)
    }

    /// Number of surface voxels.
    fn count(&self) -> usize {
        usize::from(self.before[7]) + self.layers[7].count_ones() as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::Random;

    /// Random pages, replaced and freed, always give back what was stored last, and freed memory is used again. A
    /// copy that follows by what was written is the same.
    #[test]
    fn pages_keep_what_was_stored_last() {
        let mut random = Random(9);
        let mut pages = Pages::default();
        let (mut copy, mut written) = (Vec::<Unit>::new(), Vec::new());
        type Values = (Vec<PackedNormal>, Vec<PackedDepth>);
        let mut stored: Vec<(u32, SurfaceMask, Values)> = vec![Default::default(); 20];
        stored.iter_mut().for_each(|(page, ..)| *page = NO_PAGE);
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
            let normals: Vec<_> =
                (0..mask.count()).map(|_| PackedNormal(random.next_u64() as u16)).collect();
            let depths: Vec<_> =
                (0..mask.count()).map(|_| PackedDepth(random.next_u64() as u8)).collect();
            let (page, former_mask, former) = &mut stored[brick];
            let values = (normals, depths);
            let differs = (&*former_mask, &*former) != (&mask, &values);
            let slices = (values.0.as_slice(), values.1.as_slice());
            let (new_page, found) = pages.store(*page, &mask, slices);
            assert_eq!(found, differs, "round {round}");
            assert_eq!(pages.store(new_page, &mask, slices), (new_page, false));
            (*page, *former_mask, *former) = (new_page, mask, values);
            pages.take_written(&mut written);
            copy.resize(pages.units().len(), Unit::default());
            written.iter().for_each(|&i| copy[i as usize] = pages.units()[i as usize]);
            assert!(copy == pages.units(), "round {round}");
        }
        for (page, mask, (normals, depths)) in &stored {
            let mut expected = normals.iter().zip(depths);
            for (z, layer) in mask.layers.iter().enumerate().filter(|_| *page != NO_PAGE) {
                for bit in 0..64 {
                    let exists = layer >> bit & 1 != 0;
                    let value = exists.then(|| expected.next().unwrap());
                    let normal = value.map_or(PackedNormal::NONE, |value| *value.0);
                    assert_eq!(pages.normal(*page, z, bit), normal);
                    assert_eq!(pages.normal_at(pages.place_of_normal(*page, z, bit)), normal);
                    assert_eq!(pages.depth(*page, z, bit), value.map(|value| *value.1));
                }
            }
        }
        assert!(pages.units().len() <= 20 * 13);
    }
}
