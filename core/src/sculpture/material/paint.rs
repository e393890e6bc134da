//! Paints voxels: listed ones, leaf by leaf on all threads, and whole cubes at once.
//!
//! Takes masks of voxels by brick, and a colour or a function that gives each voxel its own; returns which bricks have
//! changed and the counts of voxels. Voxels that have their colour already do not count, and unpainted bricks get no page
//! for the base colour. Knows no region and no record.

use std::sync::Arc;

use glam::UVec3;
use rayon::prelude::*;

use super::node::{ColourCube, ColourNode, PaintedChild, part};
use super::replace::brick_of;
use super::{MAX_PAGE_BYTES, Material, PackedColour, Page, PageView};
use crate::sculpture::brick::{BRICK_VOXELS, Brick};
use crate::sculpture::brick_set::LeafKey;
use crate::sculpture::colour::Rgb;
use crate::sculpture::grid::{Extent, Slot};

/// Fewer bricks than this are painted on one thread: waking others would cost more than it gains.
const PARALLEL_BRICKS: usize = 256;

/// The changes of painting.
#[derive(Default, Debug)]
pub(in crate::sculpture) struct Painted {
    /// The leaves with bricks that were painted one by one and have changed.
    pub leaves: Vec<(LeafKey, Brick)>,
    /// The cubes that were painted at once and have changed, and their bricks that have.
    pub cubes: Vec<ColourCube>,
    pub in_cubes: Vec<(LeafKey, Brick)>,
    /// The number of voxels with another colour than before, and of their bricks.
    pub voxels: u64,
    pub bricks: u64,
}

/// The change of the page of a brick: the new page, and the voxels that differ; `None` if none does.
type NewPage = Option<(Page, Brick)>;

/// A leaf to be painted, outside of the tree.
struct LentPages<'a> {
    leaf: UVec3,
    child: Option<PaintedChild>,
    voxels: &'a [(UVec3, Brick)],
    changed: Brick,
    voxels_changed: u64,
}

impl Material {
    /// Gives the listed voxels a colour. The list must have the bricks of a leaf beside each other, each at most once.
    pub(in crate::sculpture) fn paint_bricks(
        &mut self,
        voxels: &[(UVec3, Brick)],
        colour: Rgb,
    ) -> Painted {
        let (depth, base) = (self.depth, self.base_page());
        let is_base = depth.quantise(colour) == self.base;
        let packed = PackedColour::new(colour, depth);
        self.paint_leaves(voxels, &|_, mask, page| {
            if page.is_none() && is_base {
                return None;
            }
            let page = page.unwrap_or(&base);
            let differing = page.differing(mask, packed);
            (!differing.is_empty()).then(|| (page.painted(&differing, packed, depth), differing))
        })
    }

    /// Gives each listed voxel the colour that `colour` returns for its brick, its index there, and its present colour.
    /// The list must be as for [`Material::paint_bricks`].
    pub(in crate::sculpture) fn paint_bricks_by(
        &mut self,
        voxels: &[(UVec3, Brick)],
        colour: &(dyn Fn(UVec3, u32, Rgb) -> Rgb + Sync),
    ) -> Painted {
        let (depth, base, bytes) = (self.depth, self.base_page(), self.page_bytes());
        let size = depth.bytes();
        self.paint_leaves(voxels, &|b, mask, page| {
            let page = page.unwrap_or(&base);
            let (mut buffer, mut differing) = ([0; MAX_PAGE_BYTES], Brick::EMPTY);
            let buffer = &mut buffer[..bytes];
            PageView { page, depth }.write_to(buffer);
            mask.for_each(|i| {
                let at = i as usize * size;
                let now = depth.read(&buffer[at..]);
                let next = depth.quantise(colour(b, i, now));
                if next != now {
                    depth.write(next, &mut buffer[at..]);
                    differing.words[i as usize / 64] |= 1 << (i % 64);
                }
            });
            (!differing.is_empty()).then(|| (Page::of_bytes(buffer, depth), differing))
        })
    }

    /// Replaces pages of listed bricks, leaf by leaf, by those that `page` returns for brick, mask and present page.
    fn paint_leaves(
        &mut self,
        voxels: &[(UVec3, Brick)],
        page: &(dyn Fn(UVec3, &Brick, Option<&Page>) -> NewPage + Sync),
    ) -> Painted {
        let mut painted = Painted::default();
        if self.depth.bytes() == 0 {
            return painted;
        }
        let of_leaves = voxels.chunk_by(|(a, _), (b, _)| a.map(|c| c >> 3) == b.map(|c| c >> 3));
        let mut lent: Vec<LentPages> = of_leaves
            .map(|voxels| {
                let leaf = voxels[0].0 >> 3;
                let child = self.lend_leaf(leaf);
                LentPages { leaf, child, voxels, changed: Brick::EMPTY, voxels_changed: 0 }
            })
            .collect();
        let extent = self.extent;
        if voxels.len() >= PARALLEL_BRICKS && lent.len() > 1 {
            lent.par_iter_mut().for_each(|leaf| leaf.paint(page, &extent));
        } else {
            lent.iter_mut().for_each(|leaf| leaf.paint(page, &extent));
        }
        for LentPages { leaf, child, changed, voxels_changed, .. } in lent {
            self.replace(ColourCube { low: leaf << 3, level: 1 }, child);
            if !changed.is_empty() {
                painted.leaves.push((LeafKey::of(leaf), changed));
                painted.voxels += voxels_changed;
                painted.bricks += u64::from(changed.count());
            }
        }
        painted
    }

    /// Gives all voxels of cubes a colour. The cubes must not be bricks, nor hold bricks that the border of the grid
    /// cuts.
    pub(in crate::sculpture) fn paint_cubes(
        &mut self,
        cubes: &[ColourCube],
        colour: Rgb,
    ) -> Painted {
        let mut painted = Painted::default();
        if self.depth.bytes() == 0 {
            return painted;
        }
        let is_base = self.depth.quantise(colour) == self.base;
        let packed = PackedColour::new(colour, self.depth);
        for cube in cubes {
            let old = self.find(*cube).cloned();
            let new = match (&old, is_base) {
                (None, true) => continue,
                (Some(child), true) => repainted(child, packed, *cube, &self.extent),
                (_, false) => Some(PaintedChild::Page(Page::of_packed(packed))),
            };
            let before = painted.bricks;
            let mut counter = CubeCounter { packed, is_base, extent: self.extent, painted };
            counter.count(old.as_ref(), *cube);
            painted = counter.painted;
            if painted.bricks > before {
                self.replace(*cube, new);
                painted.cubes.push(*cube);
            }
        }
        painted
    }
}

impl LentPages<'_> {
    fn paint(
        &mut self,
        page: &(dyn Fn(UVec3, &Brick, Option<&Page>) -> NewPage + Sync),
        extent: &Extent,
    ) {
        let mut new = Vec::new();
        for (b, mask) in self.voxels {
            let slot = Slot::of(*b);
            let now = match part(self.child.as_ref(), slot) {
                Some(PaintedChild::Page(page)) => Some(page),
                _ => None,
            };
            if let Some((page, differing)) = page(*b, mask, now) {
                new.push((slot, Some(PaintedChild::Page(page))));
                slot.put(&mut self.changed, true);
                self.voxels_changed += u64::from(differing.count());
            }
        }
        if new.is_empty() {
            return;
        }
        new.sort_unstable_by_key(|(slot, _)| slot.index());
        let cube = ColourCube { low: self.leaf << 3, level: 1 };
        let mut node = ColourNode::opened(self.child.take(), cube, extent);
        Arc::make_mut(&mut node).put_all(new, cube, extent);
        self.child = ColourNode::closed(node, cube, extent);
    }
}

/// Returns a child whose painted bricks all have one colour, and whose other bricks are as they were.
fn repainted(
    child: &PaintedChild,
    colour: PackedColour,
    cube: ColourCube,
    extent: &Extent,
) -> Option<PaintedChild> {
    let one = || PaintedChild::Page(Page::of_packed(colour));
    let PaintedChild::Node(node) = child else { return Some(one()) };
    let mut children = Vec::with_capacity(node.painted_children().len());
    node.painted.for_each(|index| {
        let slot = Slot::at(index);
        children.extend(match node.child(slot) {
            Some(child) if cube.level > 1 => repainted(child, colour, cube.child(slot), extent),
            _ => Some(one()),
        });
    });
    let node = ColourNode::new(node.painted, children, cube, extent);
    ColourNode::closed(Arc::new(node), cube, extent)
}

/// Counts the voxels of cubes that have another colour than they shall get, and lists their bricks.
struct CubeCounter {
    packed: PackedColour,
    is_base: bool,
    extent: Extent,
    painted: Painted,
}

impl CubeCounter {
    fn count(&mut self, child: Option<&PaintedChild>, cube: ColourCube) {
        let has_colour = match child {
            None => self.is_base,
            Some(PaintedChild::Page(page)) => page.packed() == Some(self.packed),
            Some(PaintedChild::Node(_)) => false,
        };
        if has_colour {
            return;
        }
        let inside = cube.children(&self.extent);
        if cube.level > 1 {
            inside.for_each(|index| {
                let slot = Slot::at(index);
                self.count(part(child, slot), cube.child(slot));
            });
            return;
        }
        let mut bricks = Brick::EMPTY;
        inside.for_each(|index| {
            let slot = Slot::at(index);
            let voxels = match part(child, slot) {
                Some(PaintedChild::Page(page)) => page.differing(&Brick::FULL, self.packed).count(),
                _ if self.is_base => 0,
                _ => BRICK_VOXELS as u16,
            };
            if voxels > 0 {
                debug_assert!(self.extent.holds_brick(brick_of(cube.low >> 3, index)));
                slot.put(&mut bricks, true);
                self.painted.voxels += u64::from(voxels);
            }
        });
        if !bricks.is_empty() {
            self.painted.bricks += u64::from(bricks.count());
            self.painted.in_cubes.push((LeafKey::of(cube.low >> 3), bricks));
        }
    }
}
