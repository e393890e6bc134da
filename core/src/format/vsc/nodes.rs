//! The map of a large sculpture: which cubes of its tree are uniform, and which leaves are not.
//!
//! The map lists nodes, the root first and each before the nodes in it. A node has a byte for each of its children that
//! reaches into the box, x fastest: bits 0 and 1 say whether it is empty (0), full as far as it lies within the box (1) or
//! neither (2), bit 2 whether all its voxels have one colour that is not the base. Then follow these colours, as pages of
//! one colour ([`chunk`](super::chunk)), and then the nodes that are neither. A leaf, a cube of 8^3 bricks, that is neither
//! or has several colours, is the next one of the chunks. A node holds 8^3 children; the root is the smallest node that
//! holds the box, but larger than a leaf.
//!
//! Knows no file.

use glam::UVec3;
use rustc_hash::FxHashMap;

use super::chunk::{EMPTY, FULL, HAS_PAGE, MIXED, pack_page, unpack_page};
use crate::format::FormatError;
use crate::sculpture::ColourDepth;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::grid::uniform_in;
use crate::sculpture::history::Contents;
use crate::sculpture::material::{ColourCube, Page, PageView, levels_of};
use crate::sculpture::region::BrickBox;

/// Leaves of a chunk.
pub const CHUNK_LEAVES: usize = 8;

/// The logarithm of the edge of a node, in children.
const EDGE_LOG2: u32 = 3;
/// Greatest expansion of a byte by LZ4.
const MOST_PER_BYTE: u64 = 255;

/// The uniform cubes of a sculpture, and the leaves that are not uniform.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct NodeMap {
    bricks: UVec3,
    /// Whether cubes are full or empty.
    full: FxHashMap<ColourCube, bool>,
    /// Cubes of one colour.
    painted: Vec<(ColourCube, Page)>,
    leaves: Vec<UVec3>,
}

/// The class of a child, and its colour if it has one.
type Class = (u8, Option<Page>);

/// Gives the classes of the children of a node.
type Classes<'a> = dyn FnMut(&[ColourCube]) -> Result<Vec<Class>, FormatError> + 'a;

impl NodeMap {
    /// Returns the map of a sculpture, and its bytes in the file before they are packed.
    pub fn of(contents: &Contents) -> (NodeMap, Vec<u8>) {
        let Contents { grid, material, .. } = contents;
        let bricks = grid.brick_dims();
        let class = |cube: &ColourCube| {
            let within = within(bricks, *cube);
            let uniform = uniform_in(grid, within).zip(material.uniform_in(within));
            let Some((is_full, colour)) = uniform else { return (MIXED, None) };
            let class = if is_full { FULL } else { EMPTY };
            match colour {
                None => (class, None),
                Some(rgb) => (class | HAS_PAGE, Some(Page::uniform(rgb, material.depth()))),
            }
        };
        let mut map = NodeMap { bricks, ..NodeMap::default() };
        let mut plain = Vec::new();
        let added = map.add(root(bricks), &mut |cubes| {
            let classes: Vec<Class> = cubes.iter().map(class).collect();
            plain.extend(classes.iter().map(|(class, _)| *class));
            for page in classes.iter().filter_map(|(_, page)| page.as_ref()) {
                pack_page(PageView::of(page, material.depth()), &mut plain);
            }
            Ok(classes)
        });
        debug_assert!(added.is_ok(), "only files can be damaged");
        (map, plain)
    }

    /// Adds a node, whose children `classes` gives, and the nodes in it.
    fn add(&mut self, node: ColourCube, classes: &mut Classes) -> Result<(), FormatError> {
        let children: Vec<ColourCube> = children(self.bricks, node).collect();
        let classes_here = classes(&children)?;
        let mut mixed = Vec::new();
        for (cube, (class, page)) in children.into_iter().zip(classes_here) {
            match class & !HAS_PAGE {
                MIXED if cube.level == 1 => self.leaves.push(cube.low >> EDGE_LOG2),
                MIXED => mixed.push(cube),
                kind => drop(self.full.insert(cube, kind == FULL)),
            }
            self.painted.extend(page.map(|page| (cube, page)));
        }
        mixed.into_iter().try_for_each(|cube| self.add(cube, classes))
    }

    /// Unpacks the map of a sculpture of `dims` voxels.
    pub fn unpack(
        packed: &[u8],
        plain_bytes: u32,
        dims: UVec3,
        depth: ColourDepth,
    ) -> Result<NodeMap, FormatError> {
        if u64::from(plain_bytes) > MOST_PER_BYTE * packed.len() as u64 {
            return Err(FormatError::Damaged("its map asks for too much"));
        }
        let mut plain = vec![0; plain_bytes as usize];
        let unpacked = lz4_flex::block::decompress_into(packed, &mut plain);
        if unpacked.ok() != Some(plain.len()) {
            return Err(FormatError::Damaged("its map does not unpack"));
        }
        let mut rest = &plain[..];
        let bricks = dims.map(|edge| edge.div_ceil(BRICK_EDGE_VX));
        let mut map = NodeMap { bricks, ..NodeMap::default() };
        map.add(root(bricks), &mut |cubes| {
            let cut = FormatError::Damaged("its map ends too early");
            let (classes, after) = rest.split_at_checked(cubes.len()).ok_or(cut)?;
            rest = after;
            let mut read = Vec::with_capacity(classes.len());
            for &class in classes {
                let page = match class {
                    EMPTY | FULL | MIXED => None,
                    _ if class & !HAS_PAGE > FULL || depth == ColourDepth::None => {
                        return Err(FormatError::Damaged("a node is of no known kind"));
                    }
                    _ if rest.first() != Some(&1) => {
                        return Err(FormatError::Damaged("a node has several colours"));
                    }
                    _ => Some(unpack_page(depth, &mut rest)?),
                };
                read.push((class, page));
            }
            Ok(read)
        })?;
        match rest.is_empty() {
            true => Ok(map),
            false => Err(FormatError::Damaged("its map is longer than it says")),
        }
    }

    /// Returns the leaves that are not uniform, in their order: the coordinates of their lowest bricks divided by 8.
    pub fn leaves(&self) -> &[UVec3] {
        &self.leaves
    }

    /// Returns the numbers of bricks of the chunks.
    pub fn chunk_sizes(&self) -> Vec<usize> {
        let size = |leaf: &UVec3| bricks_of(self.bricks, *leaf).count();
        self.leaves.chunks(CHUNK_LEAVES).map(|leaves| leaves.iter().map(size).sum()).collect()
    }

    /// Returns whether a cube of the tree, as far as it lies within the box, is full (`true`) or empty; `None` if it is
    /// neither, or a leaf of the chunks.
    pub fn is_full(&self, cube: BrickBox) -> Option<bool> {
        // Where the border cuts cubes, one of them may be the only one in a larger one.
        (1..root(self.bricks).level).find_map(|level| {
            let listed = ColourCube::around(cube.min, level);
            let holds_all = within(self.bricks, listed).max.cmpge(cube.max).all();
            self.full.get(&listed).copied().filter(|_| holds_all)
        })
    }

    /// Returns the cubes of one colour.
    pub fn painted(&self) -> &[(ColourCube, Page)] {
        &self.painted
    }
}

/// Returns the smallest node that holds a box of bricks and is no leaf.
fn root(bricks: UVec3) -> ColourCube {
    ColourCube { low: UVec3::ZERO, level: levels_of(bricks).max(2) }
}

/// Returns the bricks of a cube that lie within the box.
fn within(bricks: UVec3, cube: ColourCube) -> BrickBox {
    BrickBox { min: cube.low, max: (cube.low + (1 << cube.log2())).min(bricks) }
}

/// Returns the children of a node that reach into a box of bricks, x fastest.
fn children(bricks: UVec3, node: ColourCube) -> impl Iterator<Item = ColourCube> {
    (0..1u32 << (3 * EDGE_LOG2))
        .map(move |index| node.child_at(index))
        .filter(move |cube| cube.low.cmplt(bricks).all())
}

/// Returns the coordinates of the bricks of a leaf that lie within a box of bricks, x fastest.
pub fn bricks_of(bricks: UVec3, leaf: UVec3) -> impl Iterator<Item = UVec3> {
    let BrickBox { min, max } = within(bricks, ColourCube { low: leaf << EDGE_LOG2, level: 1 });
    (min.z..max.z).flat_map(move |z| {
        (min.y..max.y).flat_map(move |y| (min.x..max.x).map(move |x| UVec3::new(x, y, z)))
    })
}
