//! How much memory painting may need: an upper bound, before anything is painted.
//!
//! Takes the bricks and cubes that would be painted, and what with; adds up bytes. Counts each node once that painting
//! would have to make. Knows no region.

use glam::UVec3;
use rustc_hash::FxHashSet;

use super::node::{CHILD_BYTES, CHILDREN, ColourCube, NODE_BYTES, PaintedChild};
use super::{Material, PackedColour, Page};
use crate::sculpture::colour::Rgb;

/// The growth of a sculpture's colours.
#[derive(Debug)]
pub(crate) struct ColourGrowth<'a> {
    material: &'a Material,
    /// The nodes that painting makes, and the cubes that it adds to the lists of nodes.
    nodes: FxHashSet<ColourCube>,
    listed: FxHashSet<ColourCube>,
    bytes: u64,
}

impl<'a> ColourGrowth<'a> {
    /// Returns the growth of colours to which nothing has been added.
    pub fn of(material: &'a Material) -> ColourGrowth<'a> {
        ColourGrowth {
            material,
            nodes: FxHashSet::default(),
            listed: FxHashSet::default(),
            bytes: 0,
        }
    }

    /// Returns the bytes so far.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Adds a brick that is painted in one colour: all of it, or parts.
    pub fn add_painted(&mut self, b: UVec3, colour: Rgb, is_whole: bool) {
        let depth = self.material.depth;
        let packed = PackedColour::new(colour, depth);
        let page = match self.material.page(b) {
            Some(page) => page.to_page(),
            None if depth.quantise(colour) == self.material.base => return,
            None => self.material.base_page(),
        };
        if page.packed() == Some(packed) {
            return;
        }
        self.make_nodes(ColourCube { low: b, level: 0 });
        self.bytes += if is_whole { 0 } else { page.growth(packed, depth) as u64 };
    }

    /// Adds a brick that is painted in any colours.
    pub fn add_coloured(&mut self, b: UVec3) {
        self.make_nodes(ColourCube { low: b, level: 0 });
        let now = self.material.page(b).map_or(0, |page| page.page.heap_bytes());
        self.bytes += (Page::bytes_for(CHILDREN, self.material.depth) - now) as u64;
    }

    /// Adds a cube that is painted in one colour, all of it.
    pub fn add_cube(&mut self, cube: ColourCube, colour: Rgb) {
        let depth = self.material.depth;
        let stays = match self.material.find(cube) {
            None => depth.quantise(colour) == self.material.base,
            Some(PaintedChild::Page(page)) => {
                page.packed() == Some(PackedColour::new(colour, depth))
            }
            Some(PaintedChild::Node(_)) => false,
        };
        if !stays {
            self.make_nodes(cube);
        }
    }

    /// Adds the nodes that must be made so that a cube can differ from what is around it.
    fn make_nodes(&mut self, cube: ColourCube) {
        let whole = self.material.whole();
        let (mut child, mut at) = (self.material.root.as_ref(), whole);
        while at.level > cube.level {
            let slot = at.slot_of(cube.low);
            let place = at.child(slot);
            let (inner, of_node, in_list) = match child {
                Some(PaintedChild::Node(node)) => {
                    let inner = node.child(slot);
                    (inner, 0, if inner.is_none() { CHILD_BYTES } else { 0 })
                }
                Some(PaintedChild::Page(_)) => (child, NODE_BYTES + CHILDREN * CHILD_BYTES, 0),
                None => (None, NODE_BYTES, CHILD_BYTES),
            };
            if of_node > 0 && self.nodes.insert(at) {
                self.bytes += of_node as u64;
            }
            if in_list > 0 && self.listed.insert(place) {
                self.bytes += in_list as u64;
            }
            (child, at) = (inner, place);
        }
    }
}
