//! The floor grid: lines in the plane on which the sculpture stands, a round number of voxels apart.
//!
//! Takes the size of a grid and its up axis; gives lines in grid coordinates. Knows no view.

use glam::{UVec3, Vec3};

use crate::render::overlay::OverlayLine;
use crate::sculpture::Rgb;
use crate::shade::ground::line_spacing_vx;
use crate::ui::Theme;

/// One line in so many is stronger.
const MAJOR: i32 = 5;
/// Distance of the plane below the grid, in voxels. It keeps the plane out of the faces of the sculpture.
const BELOW_VX: f32 = 0.5;

/// Returns the lines below a grid of `dims` voxels with the up axis `up`. They extend beyond the grid by half its size,
/// and one passes through its lower corner.
pub fn lines(dims: UVec3, up: Vec3, theme: Theme) -> Vec<OverlayLine> {
    let axis = up.abs().max_position();
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let height = if up[axis] < 0.0 { dims[axis] as f32 + BELOW_VX } else { -BELOW_VX };
    let spacing = line_spacing_vx(dims) as i32;
    let beyond = dims.max_element() as i32 / 2;
    let range = |axis: usize| {
        let last = dims[axis] as i32 + beyond;
        (-beyond).div_euclid(spacing)..=(last + spacing - 1).div_euclid(spacing)
    };
    let point = |a: i32, b: i32| {
        let mut point = Vec3::ZERO;
        point[axis] = height;
        point[u] = (a * spacing) as f32;
        point[v] = (b * spacing) as f32;
        point
    };
    let colour = match theme {
        Theme::Dark => Rgb::new(0x9a, 0xa4, 0xb0),
        Theme::Light => Rgb::new(0x50, 0x58, 0x60),
    };
    let line = |at: i32, from, to| {
        let (width_px, opacity) = if at % MAJOR == 0 { (1.4, 0.55) } else { (1.0, 0.25) };
        OverlayLine { from, to, colour, width_px, opacity: [opacity, 0.0] }
    };
    let (across, along) = (range(u), range(v));
    let ends = |range: &std::ops::RangeInclusive<i32>| (*range.start(), *range.end());
    let ((u0, u1), (v0, v1)) = (ends(&across), ends(&along));
    across
        .map(|a| line(a, point(a, v0), point(a, v1)))
        .chain(along.map(|b| line(b, point(u0, b), point(u1, b))))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_floor_lies_below_whatever_points_up_and_beyond_the_grid() {
        let dims = UVec3::new(64, 48, 100);
        for (up, axis, height) in
            [(Vec3::Y, 1, -0.5), (Vec3::NEG_Y, 1, 48.5), (Vec3::Z, 2, -0.5), (Vec3::NEG_X, 0, 64.5)]
        {
            let lines = lines(dims, up, Theme::Dark);
            let points: Vec<Vec3> = lines.iter().flat_map(|line| [line.from, line.to]).collect();
            assert!(points.iter().all(|point| point[axis] == height), "{up}");
            for side in [(axis + 1) % 3, (axis + 2) % 3] {
                let low = points.iter().map(|p| p[side]).fold(f32::INFINITY, f32::min);
                let high = points.iter().map(|p| p[side]).fold(f32::NEG_INFINITY, f32::max);
                assert!((-60.0..=-50.0).contains(&low), "{up} {low}");
                let beyond = high - dims[side] as f32;
                assert!((50.0..=60.0).contains(&beyond), "{up} {beyond}");
                // A line at the lower corner, and every tenth voxel.
                let crossing = |line: &&OverlayLine| line.from[side] == line.to[side];
                let mut at: Vec<f32> =
                    lines.iter().filter(crossing).map(|line| line.from[side]).collect();
                at.sort_by(f32::total_cmp);
                assert!(at.contains(&0.0) && at.windows(2).all(|pair| pair[1] - pair[0] == 10.0));
            }
            let strong = lines.iter().filter(|line| line.width_px > 1.2).count();
            assert!((lines.len() / 6..lines.len() / 3).contains(&strong), "{strong}");
        }
    }
}
