//! The page of each brick, and the bricks that remain to be computed, by leaf of 8^3 bricks: leaves without either take
//! 4 bytes, whatever they hold.
//!
//! Entries are numbered leaf by leaf, so that shaders find them without divisions. Knows no grid and no normals.

use glam::UVec3;

use super::NO_PAGE;
use crate::sculpture::Brick;
use crate::sculpture::brick::{local_coords, local_index};

/// The slot of leaves of which nothing has been computed.
const UNTOUCHED: u32 = 0;
/// The slot of leaves that have been computed and have no page.
const BARE: u32 = 1;

/// See the module text.
#[derive(Debug)]
pub struct PageTable {
    /// Size in bricks, and in leaves.
    brick_dims: UVec3,
    leaf_dims: UVec3,
    /// The slot of each leaf.
    slots: Vec<u32>,
    /// 512 pages for each slot.
    pages: Vec<u32>,
    /// The outstanding bricks of each slot.
    outstanding: Vec<Brick>,
}

impl Default for PageTable {
    fn default() -> PageTable {
        PageTable::new(UVec3::ZERO)
    }
}

impl PageTable {
    /// Returns the table of a sculpture of so many bricks, of which nothing has been computed.
    pub fn new(brick_dims: UVec3) -> PageTable {
        let leaf_dims = brick_dims.map(|edge| edge.div_ceil(8));
        PageTable {
            brick_dims,
            leaf_dims,
            slots: vec![UNTOUCHED; leaf_dims.as_u64vec3().element_product() as usize],
            pages: vec![NO_PAGE; 2 * 512],
            outstanding: vec![Brick::FULL, Brick::EMPTY],
        }
    }

    /// Returns the size in bricks.
    pub fn brick_dims(&self) -> UVec3 {
        self.brick_dims
    }

    /// Returns the size in leaves: factors by which shaders number entries.
    pub fn leaf_dims(&self) -> UVec3 {
        self.leaf_dims
    }

    /// Returns the memory in use, in bytes.
    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.slots) + size_of_val(&*self.pages) + size_of_val(&*self.outstanding)
    }

    /// Returns the page of the entry of a number: 512 times the linear index of its leaf, and its index in the leaf.
    #[inline(always)]
    pub fn page_of_entry(&self, entry: u32) -> u32 {
        let slot = self.slots.get((entry >> 9) as usize).copied().unwrap_or(BARE);
        self.pages.get(place(slot, entry)).copied().unwrap_or(NO_PAGE)
    }

    /// Returns the page of a brick, or [`NO_PAGE`].
    #[inline(always)]
    pub fn page(&self, b: UVec3) -> u32 {
        self.page_of_entry(self.entry(b))
    }

    /// Returns the page of each brick by linear index.
    pub fn linear(&self) -> Vec<u32> {
        let dims = self.brick_dims;
        let mut linear = vec![NO_PAGE; dims.as_u64vec3().element_product() as usize];
        for (leaf, &slot) in self.slots.iter().enumerate().filter(|(_, slot)| **slot > BARE) {
            let (leaf, size) = (leaf as u32, self.leaf_dims);
            let low = UVec3::new(leaf % size.x, leaf / size.x % size.y, leaf / (size.x * size.y));
            for index in 0..512 {
                let b = low * 8 + UVec3::from(local_coords(index));
                if b.cmplt(dims).all() {
                    let at = b.x as usize + dims.x as usize * (b.y + dims.y * b.z) as usize;
                    linear[at] = self.pages[place(slot, index)];
                }
            }
        }
        linear
    }

    /// Replaces the page of a brick and returns the former one.
    pub fn replace_page(&mut self, b: UVec3, page: u32) -> u32 {
        let entry = self.entry(b);
        if page == NO_PAGE && self.page_of_entry(entry) == NO_PAGE {
            return NO_PAGE;
        }
        let slot = self.own_slot(entry >> 9);
        std::mem::replace(&mut self.pages[place(slot, entry)], page)
    }

    /// Returns whether a brick remains to be computed.
    #[inline(always)]
    pub fn is_outstanding(&self, b: UVec3) -> bool {
        let entry = self.entry(b);
        let slot = self.slots.get((entry >> 9) as usize).copied().unwrap_or(BARE);
        let bricks = &self.outstanding[slot as usize];
        bricks.words[(entry >> 6 & 7) as usize] >> (entry & 63) & 1 != 0
    }

    /// Sets whether a brick remains to be computed. Returns whether that has changed.
    pub fn set_outstanding(&mut self, b: UVec3, is_outstanding: bool) -> bool {
        if self.is_outstanding(b) == is_outstanding {
            return false;
        }
        let entry = self.entry(b);
        let slot = self.own_slot(entry >> 9) as usize;
        self.outstanding[slot].words[(entry >> 6 & 7) as usize] ^= 1 << (entry & 63);
        true
    }

    /// Notes that nothing of the leaf at `leaf`, whose bricks have no surface, remains to be computed, unless something
    /// has been noted of it before.
    pub fn finish_untouched(&mut self, leaf: UVec3) {
        let index = self.leaf_index(leaf) as usize;
        if self.slots[index] == UNTOUCHED {
            self.slots[index] = BARE;
        }
    }

    /// Returns the bricks of the leaf at `leaf` that remain to be computed.
    pub fn outstanding_in(&self, leaf: UVec3) -> Brick {
        self.outstanding[self.slots[self.leaf_index(leaf) as usize] as usize]
    }

    #[inline(always)]
    fn leaf_index(&self, leaf: UVec3) -> u32 {
        leaf.x + self.leaf_dims.x * (leaf.y + self.leaf_dims.y * leaf.z)
    }

    #[inline(always)]
    fn entry(&self, b: UVec3) -> u32 {
        self.leaf_index(b >> 3) << 9 | local_index(b.x & 7, b.y & 7, b.z & 7)
    }

    /// Returns the slot of a leaf that no other leaf has.
    fn own_slot(&mut self, leaf: u32) -> u32 {
        let slot = self.slots[leaf as usize];
        if slot > BARE {
            return slot;
        }
        let new = self.outstanding.len() as u32;
        self.slots[leaf as usize] = new;
        self.outstanding.push(self.outstanding[slot as usize]);
        self.pages.resize(self.pages.len() + 512, NO_PAGE);
        new
    }
}

#[inline(always)]
fn place(slot: u32, entry: u32) -> usize {
    (slot as usize) << 9 | (entry & 511) as usize
}
