//! The colours of one sculpture: a page of 512 packed colours for each painted brick, and one base colour for all other
//! voxels.
//!
//! Pages lie under a tree of nodes of 8^3 children each (`material/node.rs`), and take as little memory as their colours
//! need (`material/page.rs`): cubes of one colour take no more than a word, whatever their size, and a copy of the
//! colours shares everything until one of the two changes. Addressed by brick coordinates and voxel index in the brick
//! ([`super::brick::local_index`]). Independent of existence: a page may hold a colour for a voxel that does not exist.
//!
//! A brick whose voxels have all been painted in the base colour keeps its page: it is not the same as an unpainted one.

use glam::UVec3;

use self::node::{CHILD_BYTES, CHILDREN, NODE_BYTES};
use self::page::SHARED_BYTES;
use super::brick::{BRICK_VOXELS, Brick};
use super::colour::{ColourDepth, Rgb};
use super::grid::{Extent, Grid, NODE_EDGE_LOG2};
use super::region::BrickBox;

mod growth;
mod node;
mod page;
mod paint;
mod palette;
mod read;
mod reframe;
mod replace;
#[cfg(test)]
mod tests;

pub(crate) use growth::ColourGrowth;
pub use node::ColourCube;
pub(crate) use node::PaintedChild;
pub use page::{MAX_PAGE_BYTES, PackedColour, Page, PageView};
pub(in crate::sculpture) use paint::Painted;
pub use read::PageReader;
pub(in crate::sculpture) use reframe::reframed;
pub(crate) use replace::KeptLeaf;

/// Colour per voxel, stored only where painted.
#[derive(Clone, Debug)]
pub struct Material {
    depth: ColourDepth,
    base: Rgb,
    extent: Extent,
    /// The level of the root: a cube of that level holds all bricks.
    levels: u32,
    root: Option<PaintedChild>,
}

impl PartialEq for Material {
    fn eq(&self, other: &Material) -> bool {
        // The root last, since only it takes time.
        (self.depth, self.base, self.extent.bricks)
            == (other.depth, other.base, other.extent.bricks)
            && self.root == other.root
    }
}

impl Material {
    /// Returns a material without painted voxels, for a grid of `dims` voxels: all have `base`, quantised to `depth`.
    pub fn new(depth: ColourDepth, base: Rgb, dims: UVec3) -> Material {
        let extent = Extent::new(dims);
        Material {
            depth,
            base: depth.quantise(base),
            levels: levels_of(extent.bricks),
            extent,
            root: None,
        }
    }

    /// Returns a material without painted voxels for `grid`: all have `base`, quantised to `depth`.
    pub fn for_grid(grid: &Grid, depth: ColourDepth, base: Rgb) -> Material {
        Material::new(depth, base, grid.dims())
    }

    /// Returns the bits of colour per voxel.
    pub fn depth(&self) -> ColourDepth {
        self.depth
    }

    /// Returns the colour of every voxel that has not been painted.
    pub fn base(&self) -> Rgb {
        self.base
    }

    /// Returns the bytes of the colours of a brick, one by one.
    pub fn page_bytes(&self) -> usize {
        BRICK_VOXELS as usize * self.depth.bytes()
    }

    /// Returns the number of bricks that have a page.
    pub fn page_count(&self) -> usize {
        self.root.as_ref().map_or(0, |root| root.pages(self.whole(), &self.extent)) as usize
    }

    /// Returns the heap bytes of the colours, shared or not.
    pub fn heap_bytes(&self) -> u64 {
        self.root.as_ref().map_or(0, |root| root.heap_bytes() as u64)
    }

    /// Returns an upper bound of the heap bytes that `pages` pages of `page_bytes` heap bytes take in colours without
    /// others. No page takes more than a colour for each voxel.
    pub(crate) fn bytes_for_pages(&self, pages: u64, page_bytes: u64) -> u64 {
        self.most_for_pages(pages).min(page_bytes).saturating_add(self.node_bytes(pages))
    }

    /// Returns the most heap bytes of `pages` pages, without their nodes.
    fn most_for_pages(&self, pages: u64) -> u64 {
        pages.saturating_mul((self.page_bytes() + SHARED_BYTES) as u64)
    }

    /// Returns the page of an unpainted brick, once it is painted in the base colour.
    pub fn base_page(&self) -> Page {
        Page::uniform(self.base, self.depth)
    }

    /// Returns the part of the tree that is a cube; if it lies within a larger cube of one colour, the page of that.
    pub(in crate::sculpture) fn find(&self, cube: ColourCube) -> Option<&PaintedChild> {
        let (mut child, mut at) = (self.root.as_ref()?, self.whole());
        while at.level > cube.level {
            let PaintedChild::Node(node) = child else { return Some(child) };
            let slot = at.slot_of(cube.low);
            (child, at) = (node.child(slot)?, at.child(slot));
        }
        Some(child)
    }

    /// Returns the page of the brick at `b`, if it has been painted.
    #[inline]
    pub fn page(&self, b: UVec3) -> Option<PageView<'_>> {
        match self.find(ColourCube { low: b, level: 0 }) {
            Some(PaintedChild::Page(page)) => Some(PageView { page, depth: self.depth }),
            _ => None,
        }
    }

    /// Returns the colour of voxel `local` (0..512) of the brick at `b`.
    #[inline]
    pub fn rgb(&self, b: UVec3, local: u32) -> Rgb {
        self.page(b).map_or(self.base, |page| page.rgb(local))
    }

    /// Returns the colour of all bricks of a box, cut to the sculpture: `Some(None)` if none is painted, `None` if they
    /// differ.
    pub(crate) fn uniform_in(&self, bricks: BrickBox) -> Option<Option<Rgb>> {
        Some(read::uniform_in(self, bricks)?.map(|colour| colour.rgb(self.depth)))
    }

    /// Returns whether a brick of a box, cut to the sculpture, is painted.
    pub(crate) fn is_painted_in(&self, bricks: BrickBox) -> bool {
        read::uniform_in(self, bricks) != Some(None)
    }

    /// Returns a reader of pages.
    pub fn reader(&self) -> PageReader<'_> {
        PageReader::new(self)
    }

    /// Returns an upper bound of the bytes by which painting `bricks` bricks, wherever they are and in whatever colours,
    /// makes the colours larger.
    pub(crate) fn most_growth(&self, bricks: u64) -> u64 {
        // Opened cubes of one colour have all children.
        let opened = self.nodes_for(bricks) * (CHILDREN * CHILD_BYTES) as u64;
        self.most_for_pages(bricks).saturating_add(self.node_bytes(bricks)).saturating_add(opened)
    }

    /// Returns an upper bound of the bytes of nodes over `bricks` new pages.
    fn node_bytes(&self, bricks: u64) -> u64 {
        // Each page and each node but the root is in one list.
        let nodes = self.nodes_for(bricks);
        let listed = (nodes + bricks).saturating_sub(1);
        nodes * NODE_BYTES as u64 + listed.saturating_mul(CHILD_BYTES as u64)
    }

    /// Returns the most nodes that hold some of `bricks` bricks.
    fn nodes_for(&self, bricks: u64) -> u64 {
        let of_level = |level: u32| {
            let edge = 1 << (NODE_EDGE_LOG2 * level);
            let all = ((self.extent.bricks + (edge - 1)) / edge).as_u64vec3().element_product();
            all.min(bricks)
        };
        (1..=self.levels).map(of_level).sum()
    }

    /// Returns the cube of the whole tree.
    pub(in crate::sculpture) fn whole(&self) -> ColourCube {
        ColourCube { low: UVec3::ZERO, level: self.levels }
    }

    /// Gives the voxels of `mask` in the brick at `b` the colour `colour`. Does nothing without colour depth. Makes a
    /// page only if the colour of a voxel of `mask` changes.
    pub fn paint(&mut self, b: UVec3, mask: &Brick, colour: Rgb) {
        self.paint_bricks(&[(b, *mask)], colour);
    }

    /// Gives each voxel of `mask` in the brick at `b` the colour that `colour` returns for its local index. Makes a page
    /// unless the mask is empty.
    pub fn paint_each(&mut self, b: UVec3, mask: &Brick, colour: impl Fn(u32) -> Rgb) {
        let (depth, size) = (self.depth, self.depth.bytes());
        if size == 0 || mask.is_empty() {
            return;
        }
        let mut bytes = [0; MAX_PAGE_BYTES];
        let bytes = &mut bytes[..self.page_bytes()];
        match self.page(b) {
            Some(page) => _ = page.write_to(bytes),
            None => bytes.chunks_exact_mut(size).for_each(|out| depth.write(self.base, out)),
        }
        mask.for_each(|i| depth.write(colour(i), &mut bytes[i as usize * size..]));
        self.set_page(b, Some(Page::of_bytes(bytes, depth)));
    }
}

/// Returns the level of the cube of the whole tree, of so many bricks along each axis.
pub(crate) fn levels_of(bricks: UVec3) -> u32 {
    let edge = bricks.max_element();
    (1..).find(|&level| edge <= 1 << (NODE_EDGE_LOG2 * level)).unwrap_or(1)
}
