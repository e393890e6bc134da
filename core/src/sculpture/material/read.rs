//! Reads the pages of a sculpture one after the other: remembers where the last one was.
//!
//! Takes brick coordinates, gives views of pages.

use glam::UVec3;

use super::node::{ColourCube, PaintedChild};
use super::{Material, PageView};
use crate::sculpture::colour::Rgb;
use crate::sculpture::grid::Slot;

/// Reads pages, quickly where neighbours follow each other.
#[derive(Clone, Debug)]
pub struct PageReader<'a> {
    material: &'a Material,
    /// The coordinates of the last leaf, and its part of the tree.
    leaf: UVec3,
    found: Option<&'a PaintedChild>,
}

impl<'a> PageReader<'a> {
    pub(super) fn new(material: &'a Material) -> PageReader<'a> {
        PageReader { material, leaf: UVec3::MAX, found: None }
    }

    /// Returns the page of the brick at `b`, if it has been painted.
    #[inline(always)]
    pub fn page(&mut self, b: UVec3) -> Option<PageView<'a>> {
        if b >> 3 != self.leaf {
            self.leaf = b >> 3;
            self.found = self.material.find(ColourCube::around(b, 1));
        }
        let page = match self.found? {
            PaintedChild::Page(page) => page,
            PaintedChild::Node(leaf) => match leaf.child(Slot::of(b))? {
                PaintedChild::Page(page) => page,
                PaintedChild::Node(_) => return None,
            },
        };
        Some(PageView { page, depth: self.material.depth })
    }

    /// Returns the colour of voxel `local` (0..512) of the brick at `b`.
    #[inline(always)]
    pub fn rgb(&mut self, b: UVec3, local: u32) -> Rgb {
        self.page(b).map_or(self.material.base, |page| page.rgb(local))
    }
}
