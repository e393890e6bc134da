//! The page of each brick, and the bricks that remain to be computed, by leaf of 8^3 bricks: leaves without either take
//! 8 bytes, whatever they hold.
//!
//! Knows no grid and no normals.

use glam::UVec3;

use super::NO_PAGE;
use crate::sculpture::Brick;
use crate::sculpture::brick::local_coords;
use crate::shade::per_leaf::{PerBrick, PerLeaf};

/// The index of the common value of leaves whose outstanding bricks are all or none.
const ALL: u32 = 0;
const NONE: u32 = 1;

/// See the module text.
#[derive(Debug)]
pub struct PageTable {
    pages: PerBrick,
    outstanding: PerLeaf<Brick>,
}

impl Default for PageTable {
    fn default() -> PageTable {
        PageTable::new(UVec3::ZERO)
    }
}

impl PageTable {
    /// Returns the table of a sculpture of so many bricks, of which nothing has been computed.
    pub fn new(brick_dims: UVec3) -> PageTable {
        PageTable {
            pages: PerLeaf::new(brick_dims, &[[NO_PAGE; 512]]),
            outstanding: PerLeaf::new(brick_dims, &[Brick::FULL, Brick::EMPTY]),
        }
    }

    /// Returns the size in bricks.
    pub fn brick_dims(&self) -> UVec3 {
        self.pages.brick_dims()
    }

    /// Returns the size in leaves: factors by which shaders number entries.
    pub fn leaf_dims(&self) -> UVec3 {
        self.pages.leaf_dims()
    }

    /// Returns the memory in use, in bytes.
    pub fn heap_bytes(&self) -> usize {
        self.pages.heap_bytes() + self.outstanding.heap_bytes()
    }

    /// Returns the memory of leaves with pages, in bytes.
    pub fn page_bytes(&self) -> usize {
        self.pages.value_bytes()
    }

    /// Returns the page of the entry of a number: 512 times the linear index of its leaf, and its index in the leaf.
    #[inline(always)]
    pub fn page_of_entry(&self, entry: u32) -> u32 {
        self.pages.at_entry(entry).unwrap_or(NO_PAGE)
    }

    /// Returns the page of a brick, or [`NO_PAGE`].
    #[inline(always)]
    pub fn page(&self, b: UVec3) -> u32 {
        self.page_of_entry(self.pages.entry(b))
    }

    /// Returns the page of each brick by linear index.
    pub fn linear(&self) -> Vec<u32> {
        let dims = self.brick_dims();
        let mut linear = vec![NO_PAGE; dims.as_u64vec3().element_product() as usize];
        self.pages.for_each_own(|b, page| {
            linear[b.x as usize + dims.x as usize * (b.y + dims.y * b.z) as usize] = page;
        });
        linear
    }

    /// Replaces the page of a brick and returns the former one.
    pub fn replace_page(&mut self, b: UVec3, page: u32) -> u32 {
        match self.page(b) {
            NO_PAGE if page == NO_PAGE => NO_PAGE,
            _ => std::mem::replace(self.pages.own_at(b), page),
        }
    }

    /// Removes the pages of the leaf at `leaf`, whose bricks remain to be computed from now on. Calls `f` with each brick
    /// that had one, and its page.
    pub fn take_pages(&mut self, leaf: UVec3, mut f: impl FnMut(UVec3, u32)) {
        let number = self.pages.number(leaf);
        if self.pages.common_index(number).is_some() {
            return;
        }
        let bricks = self.outstanding.own(number);
        for (index, &page) in (0..).zip(self.pages.get(number).into_iter().flatten()) {
            if page != NO_PAGE {
                let [x, y, z] = local_coords(index);
                bricks.set(x, y, z, true);
                f(leaf * 8 + UVec3::new(x, y, z), page);
            }
        }
        self.pages.set_common(number, 0);
    }

    /// Returns whether a brick remains to be computed.
    #[inline(always)]
    pub fn is_outstanding(&self, b: UVec3) -> bool {
        let bricks = self.outstanding.get(self.outstanding.number(b >> 3));
        bricks.is_some_and(|bricks| bricks.get(b.x & 7, b.y & 7, b.z & 7))
    }

    /// Sets whether a brick remains to be computed. Returns whether that has changed.
    pub fn set_outstanding(&mut self, b: UVec3, is_outstanding: bool) -> bool {
        if self.is_outstanding(b) == is_outstanding {
            return false;
        }
        let number = self.outstanding.number(b >> 3);
        self.outstanding.own(number).set(b.x & 7, b.y & 7, b.z & 7, is_outstanding);
        true
    }

    /// Notes that nothing of the leaf at `leaf`, whose bricks have no surface, remains to be computed, unless something
    /// has been noted of it before.
    pub fn finish_untouched(&mut self, leaf: UVec3) {
        let number = self.outstanding.number(leaf);
        if self.outstanding.common_index(number) == Some(ALL) {
            self.outstanding.set_common(number, NONE);
        }
    }

    /// Returns the bricks of the leaf at `leaf` that remain to be computed.
    pub fn outstanding_in(&self, leaf: UVec3) -> Brick {
        let bricks = self.outstanding.get(self.outstanding.number(leaf));
        bricks.copied().unwrap_or_default()
    }
}
