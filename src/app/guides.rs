//! Owns what the overlay shows and how: the tool with its outline, the red line from the grid's
//! centre, the edges of the grid.

use std::f32::consts::TAU;

use glam::{Mat3, UVec3, Vec3};

use crate::config::Theme;
use crate::input::ToolMode;
use crate::render::overlay::{Ghost, Line};
use crate::sculpture::{Grid, Rgb};
use crate::tools::construct::Solid;
use crate::ui::{Hand, ViewState};

const CUT: Rgb = Rgb::new(0xff, 0x6b, 0x57);
const RED: Rgb = Rgb::new(0xf0, 0x30, 0x28);
/// Segments of a circle around the ellipsoid.
const SEGMENTS: usize = 40;

/// The tool as a shell of the colour that it gives, or red where it cuts.
pub fn ghost(hand: &Hand, grid: &Grid) -> Ghost {
    Ghost {
        primitive: hand.primitive(),
        voxel_size: grid.voxel_size(),
        colour: colour_of(hand),
        opacity: [0.38, 0.12],
    }
}

/// The lines of a picture, as far as `view` shows them.
pub fn lines(hand: &Hand, grid: &Grid, view: &ViewState, theme: Theme) -> Vec<Line> {
    let mut lines = Vec::new();
    if view.bounds {
        let colour = match theme {
            Theme::Dark => Rgb::new(0x9a, 0xa4, 0xb0),
            Theme::Light => Rgb::new(0x60, 0x68, 0x70),
        };
        let edge = |from, to| Line { from, to, colour, width_px: 1.2, opacity: [0.6, 0.15] };
        lines.extend(box_edges(Vec3::ZERO, grid.dims().as_vec3()).map(|(a, b)| edge(a, b)));
    }
    if view.line {
        lines.push(Line {
            from: centre_vx(grid.dims()),
            to: hand.centre_vx,
            colour: RED,
            width_px: 1.8,
            opacity: [0.95, 0.4],
        });
    }
    if view.tool {
        let colour = colour_of(hand);
        let outline = |(from, to)| Line { from, to, colour, width_px: 1.4, opacity: [0.9, 0.3] };
        lines.extend(outline_of(hand, grid).into_iter().map(outline));
    }
    lines
}

fn centre_vx(dims: UVec3) -> Vec3 {
    dims.as_vec3() * 0.5
}

fn colour_of(hand: &Hand) -> Rgb {
    match hand.mode {
        ToolMode::Add | ToolMode::Recolour => hand.colour,
        ToolMode::Subtract => CUT,
    }
}

/// The edges of the tool, or three circles around the ellipsoid, in voxel coordinates.
fn outline_of(hand: &Hand, grid: &Grid) -> Vec<(Vec3, Vec3)> {
    let primitive = hand.primitive();
    let shrink = grid.voxel_size().min_element() / grid.voxel_size();
    let linear = Mat3::from_diagonal(shrink)
        * Mat3::from_quat(primitive.rotation)
        * Mat3::from_diagonal(primitive.half);
    let place = |p: Vec3| primitive.centre_vx + linear * p;
    let edges: Vec<(Vec3, Vec3)> = match primitive.solid {
        Solid::Cuboid => box_edges(Vec3::NEG_ONE, Vec3::ONE).collect(),
        Solid::Pyramid => {
            let base = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
                .map(|(x, z)| Vec3::new(x, -1.0, z));
            (0..4).flat_map(|i| [(base[i], base[(i + 1) % 4]), (base[i], Vec3::Y)]).collect()
        }
        Solid::Ellipsoid => (0..3)
            .flat_map(|axis| {
                let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
                let at = move |i: usize| {
                    let turn = TAU * i as f32 / SEGMENTS as f32;
                    u * turn.cos() + v * turn.sin()
                };
                (0..SEGMENTS).map(move |i| (at(i), at(i + 1)))
            })
            .collect(),
    };
    edges.into_iter().map(|(a, b)| (place(a), place(b))).collect()
}

/// The twelve edges of a box.
fn box_edges(min: Vec3, max: Vec3) -> impl Iterator<Item = (Vec3, Vec3)> {
    (0..3).flat_map(move |axis| {
        (0..4).map(move |corner| {
            let mut from = min;
            from[(axis + 1) % 3] = if corner & 1 == 0 { min } else { max }[(axis + 1) % 3];
            from[(axis + 2) % 3] = if corner & 2 == 0 { min } else { max }[(axis + 2) % 3];
            let mut to = from;
            to[axis] = max[axis];
            (from, to)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::ui::UiState;

    #[test]
    fn a_box_has_twelve_different_edges() {
        let edges: Vec<_> = box_edges(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)).collect();
        assert_eq!(edges.len(), 12);
        let total: f32 = edges.iter().map(|(a, b)| a.distance(*b)).sum();
        assert_eq!(total, 24.0);
        for (i, a) in edges.iter().enumerate() {
            assert!(edges[..i].iter().all(|b| a != b));
        }
    }

    #[test]
    fn what_is_switched_off_is_not_shown() {
        let grid = Grid::new(UVec3::splat(8), Vec3::ONE, 1 << 20).unwrap();
        let state = UiState::new(&Config::default(), grid.dims());
        let mut view = state.view;
        let count = |view: &ViewState| lines(&state.hand, &grid, view, Theme::Dark).len();
        assert_eq!(count(&view), 12 + 1 + 3 * SEGMENTS);
        view.bounds = false;
        view.tool = false;
        assert_eq!(count(&view), 1);
        view.line = false;
        assert_eq!(count(&view), 0);
    }
}
