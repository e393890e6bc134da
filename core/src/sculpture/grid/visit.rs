//! Visits the cubes of a grid's tree that hold bricks of a box, the large ones first, without changing them.
//!
//! Takes the choice for each cube: leave it alone, or look into it; returns the leaves that were chosen. Knows no region.

use glam::UVec3;

use super::lend::{Cube, slot_in};
use super::node::{NODE_EDGE, NODE_EDGE_LOG2, Slot, TreeNode};
use crate::sculpture::region::BrickBox;

/// Lets `opens` decide for each cube that holds bricks of `bounds` whether to look into it, and returns the coordinates of
/// the leaves for which it was true.
pub(super) fn leaves_in(
    root: &TreeNode,
    levels: u32,
    bounds: BrickBox,
    opens: &mut dyn FnMut(Cube) -> bool,
) -> Vec<UVec3> {
    let mut leaves = Vec::new();
    visit(Inside::Node(root), UVec3::ZERO, levels, bounds, opens, &mut leaves);
    leaves
}

/// The contents of a cube.
#[derive(Clone, Copy)]
enum Inside<'a> {
    Uniform(bool),
    Node(&'a TreeNode),
}

/// Visits the children of a cube of `level` (2 or more) whose lowest brick is `low`.
fn visit(
    inside: Inside,
    low: UVec3,
    level: u32,
    bounds: BrickBox,
    opens: &mut dyn FnMut(Cube) -> bool,
    leaves: &mut Vec<UVec3>,
) {
    let log2 = NODE_EDGE_LOG2 * (level - 1);
    let within = |b: UVec3| (b.saturating_sub(low) >> log2).min(UVec3::splat(NODE_EDGE - 1));
    let (first, last) = (within(bounds.min), within(bounds.max - 1));
    for z in first.z..=last.z {
        for y in first.y..=last.y {
            for x in first.x..=last.x {
                let low = low + (UVec3::new(x, y, z) << log2);
                let child = match inside {
                    Inside::Node(node) => child_of(node, slot_in(low, level)),
                    uniform => uniform,
                };
                let (is_empty, is_full) = (
                    matches!(child, Inside::Uniform(false)),
                    matches!(child, Inside::Uniform(true)),
                );
                if !opens(Cube { low, log2, is_empty, is_full }) {
                    continue;
                }
                match level {
                    2 => leaves.push(low >> NODE_EDGE_LOG2),
                    _ => visit(child, low, level - 1, bounds, opens, leaves),
                }
            }
        }
    }
}

fn child_of(node: &TreeNode, slot: Slot) -> Inside<'_> {
    match node.nodes().get(node.rank(slot)).filter(|_| slot.is_in(&node.mixed)) {
        Some(child) => Inside::Node(child),
        None => Inside::Uniform(slot.is_in(&node.full)),
    }
}
