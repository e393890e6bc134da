//! Covers changed bricks by boxes to copy to the device. Exact copies would take one per row of neighbouring bricks,
//! thousands for a scattered edit, and a copy costs more than the bytes of a brick. Boxes may therefore contain
//! unchanged bricks.
//!
//! Takes linear indices in a grid of bricks. Knows no device.

use glam::UVec3;

/// The cost of a copy, in bricks: 4 KiB, which a bus transfers in about the time that a device
/// takes to start a copy.
const COPY_COST_BRICKS: usize = 64;

/// A box of `size` bricks with the lowest at `min`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct BrickBox {
    pub min: UVec3,
    pub size: UVec3,
}

impl BrickBox {
    pub fn bricks(self) -> usize {
        self.size.as_usizevec3().element_product()
    }

    fn around(bricks: &[UVec3]) -> BrickBox {
        let min = bricks.iter().copied().reduce(UVec3::min).unwrap_or_default();
        let max = bricks.iter().copied().reduce(UVec3::max).unwrap_or_default();
        BrickBox { min, size: max - min + 1 }
    }

    /// Splits this box into boxes of at most `most` bricks and calls `f` with each.
    pub fn split(self, most: usize, f: &mut impl FnMut(BrickBox)) {
        if self.bricks() <= most.max(1) {
            return f(self);
        }
        // Keeps rows and layers whole as long as possible.
        let axis = (0..3).rev().find(|&axis| self.size[axis] > 1).unwrap_or(0);
        let (mut low, mut high) = (self, self);
        low.size[axis] /= 2;
        high.min[axis] += low.size[axis];
        high.size[axis] -= low.size[axis];
        low.split(most, f);
        high.split(most, f);
    }
}

/// Adds disjoint boxes to `boxes` that contain all of `bricks`. Reorders `bricks`.
pub(super) fn cover(bricks: &mut [UVec3], boxes: &mut Vec<BrickBox>) {
    if !bricks.is_empty() {
        cover_some(bricks, boxes);
    }
}

/// Covers at least one brick. Returns the cost.
fn cover_some(bricks: &mut [UVec3], boxes: &mut Vec<BrickBox>) -> usize {
    let around = BrickBox::around(bricks);
    let cost = around.bricks() + COPY_COST_BRICKS;
    let at_least_of_two = bricks.len() + 2 * COPY_COST_BRICKS;
    let before = boxes.len();
    if cost > at_least_of_two {
        // Split in the middle of the longest side: there are bricks at both ends of it.
        let axis = (0..3).max_by_key(|&axis| around.size[axis]).unwrap_or(0);
        let middle = around.min[axis] + around.size[axis] / 2;
        let mut low = 0;
        for i in 0..bricks.len() {
            if bricks[i][axis] < middle {
                bricks.swap(i, low);
                low += 1;
            }
        }
        let (low, high) = bricks.split_at_mut(low);
        let cost_of_two = cover_some(low, boxes) + cover_some(high, boxes);
        if cost_of_two < cost {
            return cost_of_two;
        }
    }
    boxes.truncate(before);
    boxes.push(around);
    cost
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn covered(bricks: &[UVec3]) -> Vec<BrickBox> {
        let mut boxes = Vec::new();
        cover(&mut bricks.to_vec(), &mut boxes);
        boxes
    }

    fn box_at(min: [u32; 3], size: [u32; 3]) -> BrickBox {
        BrickBox { min: min.into(), size: size.into() }
    }

    fn all_of(of: BrickBox) -> impl Iterator<Item = UVec3> {
        let UVec3 { x, y, z } = of.size;
        (0..x * y * z).map(move |i| of.min + UVec3::new(i % x, i / x % y, i / (x * y)))
    }

    #[test]
    fn a_full_box_is_one_and_what_is_far_apart_stays_apart() {
        assert_eq!(covered(&[]), []);
        assert_eq!(covered(&[UVec3::new(3, 1, 4)]), [box_at([3, 1, 4], [1, 1, 1])]);
        let block = box_at([2, 3, 4], [20, 10, 30]);
        assert_eq!(covered(&all_of(block).collect::<Vec<_>>()), [block]);
        let ends = [UVec3::ZERO, UVec3::splat(127)];
        assert_eq!(covered(&ends).len(), 2);
    }

    #[test]
    fn thousands_of_scattered_bricks_are_few_copies() {
        // Every fourth brick along each axis of 64^3.
        let scattered: Vec<_> = all_of(box_at([0; 3], [16; 3])).map(|b| b * 4).collect();
        assert_eq!(scattered.len(), 4096);
        let boxes = covered(&scattered);
        let bricks: usize = boxes.iter().map(|b| b.bricks()).sum();
        let cost = |boxes: usize, bricks: usize| boxes * COPY_COST_BRICKS + bricks;
        assert!(cost(boxes.len(), bricks) < cost(4096, 4096), "{} boxes, {bricks}", boxes.len());
        // The shell of a ball.
        let shell = |b: &UVec3| (b.as_vec3() - 32.0).length_squared().sqrt() as u32 == 24;
        let shell: Vec<_> = all_of(box_at([0; 3], [64; 3])).filter(shell).collect();
        let boxes = covered(&shell);
        let bricks: usize = boxes.iter().map(|b| b.bricks()).sum();
        // There are 3730 rows.
        assert!(shell.len() > 7000 && boxes.len() < 400 && bricks < 5 * shell.len());
    }

    proptest! {
        #[test]
        fn boxes_hold_all_bricks_and_do_not_overlap(
            bricks in prop::collection::vec((0u32..40, 0u32..9, 0u32..70), 0..300),
            most in 1usize..5000,
        ) {
            let bricks: Vec<UVec3> = bricks.into_iter().map(UVec3::from).collect();
            let mut pieces = Vec::new();
            for of in covered(&bricks) {
                of.split(most, &mut |piece| pieces.push(piece));
            }
            prop_assert!(pieces.iter().all(|piece| piece.bricks() <= most));
            let mut found: Vec<_> = pieces.into_iter().flat_map(all_of).collect();
            let count = found.len();
            found.sort_by_key(|b| b.to_array());
            found.dedup();
            prop_assert_eq!(found.len(), count);
            for brick in bricks {
                prop_assert!(found.binary_search_by_key(&brick.to_array(), |b| b.to_array()).is_ok());
            }
        }
    }
}
