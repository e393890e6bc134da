//! Simplifies paths of a hand: fewer points within a tolerance, and less tremor.
//!
//! Pure geometry, in the unit of the points.

use glam::{Vec2, Vec3};

/// Most passes of smoothing.
const MOST_PASSES: u32 = 64;

/// Returns the ends of a path and as few points between them as keep all others within `tolerance` of the lines that join
/// them (Ramer 1972; Douglas and Peucker 1973).
pub fn thinned(points: &[Vec3], tolerance: f32) -> Vec<Vec3> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; points.len()];
    (kept[0], kept[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let off = |i: &usize| distance(points[*i], points[from], points[to]);
        let furthest = (from + 1..to).max_by(|a, b| off(a).total_cmp(&off(b)));
        if let Some(i) = furthest.filter(|i| off(i) > tolerance) {
            kept[i] = true;
            open.extend([(from, i), (i, to)]);
        }
    }
    points.iter().zip(kept).filter_map(|(p, keep)| keep.then_some(*p)).collect()
}

/// Like [`thinned`], with at most `most` points (at least two): raises the tolerance as needed.
pub fn thinned_to(points: &[Vec3], tolerance: f32, most: usize) -> Vec<Vec3> {
    let mut tolerance = tolerance;
    loop {
        let thin = thinned(points, tolerance);
        if thin.len() <= most.max(2) || !tolerance.is_finite() {
            return thin;
        }
        tolerance = (tolerance * 1.5).max(1e-3);
    }
}

/// Like [`thinned_to`], in the plane.
pub fn thinned_flat(points: &[Vec2], tolerance: f32, most: usize) -> Vec<Vec2> {
    let points: Vec<Vec3> = points.iter().map(|p| p.extend(0.0)).collect();
    thinned_to(&points, tolerance, most).into_iter().map(Vec3::truncate).collect()
}

/// Returns the distance of `p` from the line between `a` and `b`.
fn distance(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    let (line, offset) = (b - a, p - a);
    let length_squared = line.length_squared();
    let share = if length_squared > 0.0 { offset.dot(line) / length_squared } else { 0.0 };
    (offset - line * share.clamp(0.0, 1.0)).length()
}

/// Returns the length of a path.
pub fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// Returns a path in even steps of about `step` with the same ends, without tremor of about the length `over`.
pub fn evened(points: &[Vec3], step: f32, over: f32) -> Vec<Vec3> {
    let total = length(points);
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let count = (total / step).ceil().clamp(1.0, 1024.0) as usize;
    let mut even = vec![*first];
    let mut gone = 0.0;
    for pair in points.windows(2) {
        let length = pair[0].distance(pair[1]);
        while even.len() < count {
            let due = total * even.len() as f32 / count as f32;
            if due > gone + length {
                break;
            }
            even.push(pair[0].lerp(pair[1], ((due - gone) / length).clamp(0.0, 1.0)));
        }
        gone += length;
    }
    even.push(*last);
    // Repeated means of three: the squares of their widths add up.
    let passes = (2.0 * (over * count as f32 / total.max(f32::MIN_POSITIVE)).powi(2)).round();
    for _ in 0..(passes as u32).min(MOST_PASSES) {
        let before = even.clone();
        for i in 1..even.len() - 1 {
            even[i] = (before[i - 1] + before[i] * 2.0 + before[i + 1]) * 0.25;
        }
    }
    even
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_straight_path_keeps_its_ends_and_a_corner_stays() {
        let line: Vec<Vec3> = (0..50).map(|i| Vec3::X * i as f32).collect();
        assert_eq!(thinned(&line, 0.1), [Vec3::ZERO, Vec3::X * 49.0]);
        let corner: Vec<Vec3> = line.iter().copied().chain([Vec3::new(49.0, 30.0, 0.0)]).collect();
        assert_eq!(thinned(&corner, 0.1).len(), 3);
        assert_eq!(thinned(&[], 1.0), []);
        assert_eq!(thinned(&[Vec3::ONE], 1.0), [Vec3::ONE]);
        let zigzag: Vec<Vec3> =
            (0..500).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect();
        assert!(thinned_to(&zigzag, 0.1, 40).len() <= 40);
    }

    #[test]
    fn trembling_goes_and_the_ends_stay() {
        let hand: Vec<Vec3> = (0..=100)
            .map(|i| Vec3::new(i as f32, if i % 2 == 0 { 0.4 } else { -0.4 }, 0.0))
            .collect();
        let even = evened(&hand, 1.0, 3.0);
        assert_eq!((even[0], even[even.len() - 1]), (hand[0], hand[100]));
        let inner = &even[10..even.len() - 10];
        assert!(inner.iter().all(|p| p.y.abs() < 0.1), "{inner:?}");
        assert_eq!(evened(&[Vec3::ONE], 1.0, 1.0), [Vec3::ONE, Vec3::ONE]);
    }

    proptest! {
        #[test]
        fn no_point_is_further_off_than_is_asked(
            points in prop::collection::vec(prop::array::uniform3(-50f32..50.0), 2..60),
            tolerance in 0.1f32..20.0,
        ) {
            let points: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
            let thin = thinned(&points, tolerance);
            for p in &points {
                let off = thin.windows(2).map(|w| distance(*p, w[0], w[1])).fold(f32::MAX, f32::min);
                prop_assert!(off <= tolerance * 1.001, "{off}");
            }
            prop_assert!(evened(&points, 1.0, 2.0).iter().all(|p| p.is_finite()));
        }
    }
}
