//! Triangulates a rectangle with vertices on its sides.
//!
//! A triangle whose corners lie on one side would have no area. So a fan from the vertex before the lower right corner
//! covers the right side, and one from the vertex after the upper left corner the left side. The rest lies between
//! vertices of the lower and of the upper side, which are joined alternately.

use super::numbers::VertexNumbers;
use super::rectangles::Rectangle;
use crate::mesh::MeshPart;

/// The vertices of the sides, each from its first corner to before its last, counter-clockwise; each with its position
/// along the axis of the lower and upper side, in halves of a voxel.
type Sides = [Vec<(u32, u32)>; 4];

/// Adds the triangles of a rectangle.
pub(crate) fn put_rectangle(numbers: &VertexNumbers, rectangle: &Rectangle, part: &mut MeshPart) {
    let sides = sides(numbers, rectangle);
    let mut put = |[a, b, c]: [u32; 3]| {
        part.triangles.push(if rectangle.is_up { [a, b, c] } else { [a, c, b] });
    };
    if sides.iter().all(|side| side.len() == 1) {
        let [a, b, c, d] = std::array::from_fn(|i| sides[i][0].1);
        part.quads.push(if rectangle.is_up { [a, b, c, d] } else { [a, d, c, b] });
        return;
    }
    let [lower, right, upper, left] = &sides;
    let (Some(first), Some(&(_, before_right))) = (left.first(), lower.last()) else { return };
    // The right side with the corner after it.
    let ends = right.iter().chain(&upper[..1]).collect::<Vec<_>>();
    ends.windows(2).for_each(|pair| put([before_right, pair[0].1, pair[1].1]));
    // The upper side without the corner at its end goes from right to left.
    let after_left = upper[upper.len() - 1].1;
    let ends = left.iter().chain(&lower[..1]).collect::<Vec<_>>();
    ends.windows(2).for_each(|pair| put([after_left, pair[0].1, pair[1].1]));
    debug_assert!(first.1 != after_left);
    let (mut i, mut j) = (0, upper.len() - 1);
    while i + 1 < lower.len() || j > 0 {
        let is_lower = j == 0 || i + 1 < lower.len() && lower[i + 1].0 <= upper[j - 1].0;
        if is_lower {
            put([lower[i].1, lower[i + 1].1, upper[j].1]);
            i += 1;
        } else {
            put([lower[i].1, upper[j - 1].1, upper[j].1]);
            j -= 1;
        }
    }
}

/// Collects the vertices around the rectangle.
fn sides(numbers: &VertexNumbers, rectangle: &Rectangle) -> Sides {
    let axis = rectangle.axis as usize;
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let (low, high) = (rectangle.low.map(usize::from), rectangle.high.map(usize::from));
    // The position of existing voxels along the axis.
    let solid = low[axis] as i64 - i64::from(rectangle.is_up);
    let mut sides = Sides::default();
    let turns = [(u, true), (v, true), (u, false), (v, false)];
    let mut at = low;
    for (side, (along, is_rising)) in sides.iter_mut().zip(turns) {
        let end = if is_rising { high[along] } else { low[along] };
        while at[along] != end {
            let is_kept = numbers.is_kept(at);
            if is_kept {
                // A face of the rectangle at this corner.
                let face =
                    4 * axis + usize::from(at[u] < high[u]) + 2 * usize::from(at[v] < high[v]);
                side.push((2 * at[u] as u32, numbers.vertex(at, face)));
            }
            let mut next = at;
            next[along] = if is_rising { at[along] + 1 } else { at[along] - 1 };
            if is_kept && numbers.is_kept(next) {
                // The existing voxel beside this edge.
                let start = if is_rising { at } else { next };
                let across = (along + 2) % 3;
                let bit = match across == axis {
                    true => solid - start[axis] as i64 + 1,
                    // The other axis of the plane: the rectangle lies above its lower sides.
                    false => i64::from(start[across] < high[across]),
                };
                if let Some(middle) = numbers.middle(start, along, bit as usize) {
                    side.push(((at[u] + next[u]) as u32, middle));
                }
            }
            at = next;
        }
    }
    sides
}
