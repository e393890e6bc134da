//! The four corners of an outline: roughly from its pixels, then from its edges with sub-pixel
//! accuracy.
//!
//! A lens bends edges in pixels but not in rays, so they are searched along straight lines of rays,
//! and fitted there.

use glam::DVec2;

use super::grey::Grey;
use crate::video::Intrinsics;

/// Shortest side of a marker in pixels: a little more than a pixel per cell.
pub const SHORTEST_SIDE_PX: f64 = 10.0;
/// Largest deviation of an outline from its sides, as a share of its length.
const SLACK: f64 = 0.02;
/// Number of searches for edges, each starting from the last result.
const ROUNDS: usize = 3;
/// Least change of brightness across an edge.
const LEAST_CONTRAST: f64 = 12.0;

/// Returns the corners of a convex outline with four sides, clockwise as seen, in pixels.
pub fn corners(outline: &[(i32, i32)]) -> Option<[DVec2; 4]> {
    let points: Vec<DVec2> =
        outline.iter().map(|&(x, y)| DVec2::new(f64::from(x), f64::from(y))).collect();
    let middle = points.iter().copied().sum::<DVec2>() / points.len() as f64;
    let farthest = |from: DVec2| {
        (0..points.len()).max_by(|&a, &b| {
            points[a].distance_squared(from).total_cmp(&points[b].distance_squared(from))
        })
    };
    // Both are corners, since the farthest points are.
    let first = farthest(middle)?;
    let second = farthest(points[first])?;
    if first == second {
        return None;
    }
    let tolerance = (SLACK * points.len() as f64).max(1.5);
    let mut found = Vec::with_capacity(6);
    for (from, to) in [(first, second), (second, first)] {
        found.push(from);
        split(&points, from, to, tolerance, &mut found);
        if found.len() > 4 {
            return None;
        }
    }
    let corners = <[usize; 4]>::try_from(found).ok()?.map(|index| points[index]);
    let sound = (0..4).all(|i| {
        let (a, b, c) = (corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]);
        a.distance(b) >= SHORTEST_SIDE_PX && (b - a).perp_dot(c - b) > 0.0
    });
    sound.then_some(corners)
}

/// Appends the corners between two positions of a closed outline, in order (D. Douglas, T. Peucker,
/// 1973). Stops after more than five.
fn split(points: &[DVec2], from: usize, to: usize, tolerance: f64, found: &mut Vec<usize>) {
    let count = points.len();
    let (a, b) = (points[from], points[to]);
    let normal = (b - a).perp().normalize_or_zero();
    let between = (to + count - from) % count;
    let far = (1..between)
        .map(|step| (from + step) % count)
        .map(|index| (index, normal.dot(points[index] - a).abs()))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((index, distance)) = far
        && distance > tolerance
        && found.len() <= 4
    {
        split(points, from, index, tolerance, found);
        found.push(index);
        split(points, index, to, tolerance, found);
    }
}

/// Returns the corners as rays, from the edges between dark inside and bright outside; `None` if an edge is not found.
pub fn refine(grey: &Grey, lens: &Intrinsics, corners_px: [DVec2; 4]) -> Option<[DVec2; 4]> {
    let mut rays = [DVec2::ZERO; 4];
    for (ray, pixel) in rays.iter_mut().zip(corners_px) {
        *ray = lens.ray_from_pixel(pixel)?;
    }
    let shortest =
        (0..4).map(|i| corners_px[i].distance(corners_px[(i + 1) % 4])).fold(f64::MAX, f64::min);
    // Within the rim, so that the search meets no edge of the code.
    let reach_px = (shortest / super::family::CELLS as f64 * 0.8).clamp(1.5, 4.0);
    for _ in 0..ROUNDS {
        let mut lines = [(DVec2::ZERO, DVec2::ZERO); 4];
        for (i, line) in lines.iter_mut().enumerate() {
            *line = edge(grey, lens, rays[i], rays[(i + 1) % 4], reach_px)?;
        }
        for i in 0..4 {
            rays[i] = crossing(lines[(i + 3) % 4], lines[i])?;
        }
    }
    let sound =
        (0..4).all(|i| lens.pixel_from_ray(rays[i]).distance(corners_px[i]) < 3.0 + 0.1 * shortest);
    sound.then_some(rays)
}

/// Returns the edge near the line from `a` to `b`: a point on it and its direction, as rays.
fn edge(
    grey: &Grey,
    lens: &Intrinsics,
    a: DVec2,
    b: DVec2,
    reach_px: f64,
) -> Option<(DVec2, DVec2)> {
    let length_px = lens.pixel_from_ray(a).distance(lens.pixel_from_ray(b));
    let count = (length_px as usize).clamp(8, 80);
    let mut points = Vec::with_capacity(count);
    for i in 0..count {
        // Without the corners, which blur rounds.
        let share = 0.08 + 0.84 * (i as f64 + 0.5) / count as f64;
        let at = lens.pixel_from_ray(a.lerp(b, share));
        let along = lens.pixel_from_ray(a.lerp(b, share + 0.02)) - at;
        // Clockwise with y down: outside is to the left.
        let outwards = -along.perp().normalize_or_zero();
        const STEP_PX: f64 = 0.25;
        let steps = (reach_px / STEP_PX) as i32;
        let (mut weight, mut moment) = (0.0, 0.0);
        for step in -steps..=steps {
            let t = f64::from(step) * STEP_PX;
            let slope = grey.at(at + outwards * (t + 0.5)) - grey.at(at + outwards * (t - 0.5));
            let slope = slope.max(0.0);
            weight += slope * STEP_PX;
            moment += slope * STEP_PX * t;
        }
        if weight >= LEAST_CONTRAST
            && let Some(ray) = lens.ray_from_pixel(at + outwards * (moment / weight))
        {
            points.push(ray);
        }
    }
    // Up to half of an edge may be hidden in glare.
    (points.len() * 2 >= count).then(|| fit(&points))
}

/// Returns the line with the least sum of squared distances: a point and a unit vector.
fn fit(points: &[DVec2]) -> (DVec2, DVec2) {
    let middle = points.iter().copied().sum::<DVec2>() / points.len() as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for point in points {
        let p = *point - middle;
        (xx, xy, yy) = (xx + p.x * p.x, xy + p.x * p.y, yy + p.y * p.y);
    }
    (middle, DVec2::from_angle(0.5 * (2.0 * xy).atan2(xx - yy)))
}

fn crossing((a, along_a): (DVec2, DVec2), (b, along_b): (DVec2, DVec2)) -> Option<DVec2> {
    let sine = along_a.perp_dot(along_b);
    (sine.abs() > 0.02).then(|| a + along_a * ((b - a).perp_dot(along_b) / sine))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(corners: &[(f64, f64)]) -> Vec<(i32, i32)> {
        let mut points = Vec::new();
        for i in 0..corners.len() {
            let (a, b) = (DVec2::from(corners[i]), DVec2::from(corners[(i + 1) % corners.len()]));
            let steps = a.distance(b).ceil() as usize;
            for step in 0..steps {
                let p = a.lerp(b, step as f64 / steps as f64).round();
                points.push((p.x as i32, p.y as i32));
            }
        }
        points
    }

    #[test]
    fn quads_are_found_also_with_one_long_side() {
        for quad in [
            [(10.0, 10.0), (60.0, 12.0), (55.0, 58.0), (12.0, 50.0)],
            // The longest distance is a side, not a diagonal.
            [(40.0, 10.0), (60.0, 10.0), (120.0, 40.0), (0.0, 40.0)],
        ] {
            let mut found = corners(&outline(&quad)).unwrap().to_vec();
            for (x, y) in quad {
                let near = found.iter().position(|c| c.distance(DVec2::new(x, y)) < 2.0);
                found.remove(near.unwrap());
            }
        }
    }

    #[test]
    fn other_shapes_are_not() {
        let triangle = outline(&[(10.0, 10.0), (90.0, 12.0), (40.0, 80.0)]);
        assert_eq!(corners(&triangle), None);
        let round: Vec<(f64, f64)> = (0..40)
            .map(|i| (f64::from(i) * std::f64::consts::TAU / 40.0).sin_cos())
            .map(|(s, c)| (50.0 + 40.0 * c, 50.0 + 40.0 * s))
            .collect();
        assert_eq!(corners(&outline(&round)), None);
        let arrow = outline(&[(10.0, 10.0), (80.0, 10.0), (30.0, 30.0), (10.0, 80.0)]);
        assert_eq!(corners(&arrow), None, "not convex");
        assert_eq!(corners(&[(1, 1)]), None);
    }
}
