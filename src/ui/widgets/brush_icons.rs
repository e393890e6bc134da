//! The icons of the brushes. They show the effect of a brush on a surface, as lines, so that they are sharp at any
//! scale and take the theme's colours. One row per brush.

use std::f32::consts::{PI, TAU};

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke};

use crate::tools::brush::BrushId;
use crate::ui::widgets::icons::at;

/// Points of a line, by shares of the sides of the picture.
type Points = Vec<(f32, f32)>;

/// A line of a picture.
enum IconLine {
    /// The surface afterwards.
    Bold(Points),
    /// The surface before, and shading.
    Thin(Points),
    /// A handle.
    Thick(Points),
    /// A closed outline with a light fill.
    Filled(Points),
}

/// Draws the picture of a brush into `rect`.
pub fn draw(painter: &Painter, rect: Rect, brush: BrushId, colour: Color32) {
    let places =
        |points: Points| -> Vec<Pos2> { points.into_iter().map(|(x, y)| at(rect, x, y)).collect() };
    let bold = Stroke::new(1.6, colour);
    for line in lines(brush) {
        painter.add(match line {
            IconLine::Bold(points) => Shape::line(places(points), bold),
            IconLine::Thin(points) => {
                Shape::line(places(points), Stroke::new(1.0, colour.gamma_multiply(0.6)))
            }
            IconLine::Thick(points) => Shape::line(places(points), Stroke::new(2.4, colour)),
            IconLine::Filled(points) => {
                Shape::convex_polygon(places(points), colour.gamma_multiply(0.3), bold)
            }
        });
    }
}

fn bold(points: &[(f32, f32)]) -> IconLine {
    IconLine::Bold(points.to_vec())
}

fn thin(points: &[(f32, f32)]) -> IconLine {
    IconLine::Thin(points.to_vec())
}

/// Returns the ground with something in its middle.
fn ground(y: f32, middle: impl IntoIterator<Item = (f32, f32)>) -> IconLine {
    let ends = [(0.02, y), (0.98, y)];
    let points = std::iter::once(ends[0]).chain(middle).chain(std::iter::once(ends[1]));
    IconLine::Bold(points.collect())
}

/// Returns half an ellipse around the middle of the ground, upwards with a negative height.
fn bow(y: f32, half_width: f32, height: f32) -> impl Iterator<Item = (f32, f32)> {
    (0..=16).map(move |i| {
        let (sin, cos) = (PI * (1.0 - i as f32 / 16.0)).sin_cos();
        (0.5 + half_width * cos, y + height * sin)
    })
}

/// Returns a point of clay drawn out to the right, by its share of the path on one side.
fn drawn_out(i: usize, base: f32) -> (f32, f32) {
    let t = i as f32 / 10.0;
    let rise = t * t * (3.0 - 2.0 * t);
    (base + (0.62 - base) * t + 0.06 * rise, 0.86 - 0.5 * rise)
}

#[expect(clippy::too_many_lines, reason = "a table")]
fn lines(brush: BrushId) -> Vec<IconLine> {
    match brush {
        BrushId::Paint => vec![
            IconLine::Thick(vec![(0.92, 0.06), (0.46, 0.56)]),
            IconLine::Filled(vec![
                (0.56, 0.62),
                (0.38, 0.48),
                (0.22, 0.62),
                (0.1, 0.94),
                (0.42, 0.84),
            ]),
        ],
        BrushId::Devour => vec![ground(0.62, bow(0.62, 0.28, 0.28))],
        BrushId::Clay => vec![ground(0.62, bow(0.62, 0.28, -0.28))],
        BrushId::Erode => vec![
            bold(&[(0.06, 0.94), (0.06, 0.42), (0.3, 0.14), (0.94, 0.14)]),
            thin(&[(0.06, 0.42), (0.06, 0.14), (0.3, 0.14)]),
        ],
        BrushId::Dilate => vec![
            bold(&[(0.06, 0.94), (0.06, 0.06), (0.94, 0.06)]),
            thin(&[(0.3, 0.94), (0.3, 0.3), (0.94, 0.3)]),
        ],
        BrushId::Grow => vec![
            bold(&[(0.1, 0.06), (0.1, 0.56), (0.44, 0.9), (0.94, 0.9)]),
            thin(&[(0.1, 0.56), (0.1, 0.9), (0.44, 0.9)]),
        ],
        // A hatched patch of the surface.
        BrushId::Mask | BrushId::Unmask => {
            let hatching = [0.22, 0.38, 0.54, 0.7].map(|x| thin(&[(x, 0.62), (x + 0.16, 0.34)]));
            let patch = bold(&[(0.18, 0.62), (0.34, 0.3), (0.9, 0.3), (0.74, 0.62)]);
            [ground(0.62, [])].into_iter().chain(hatching).chain([patch]).collect()
        }
        BrushId::Smooth => vec![
            thin(&[(0.04, 0.4), (0.2, 0.22), (0.36, 0.4), (0.52, 0.22), (0.68, 0.4)]),
            bold(&[(0.04, 0.72), (0.3, 0.64), (0.62, 0.74), (0.96, 0.66)]),
        ],
        BrushId::Grab => {
            let left = (0..=10).map(|i| drawn_out(i, 0.14));
            let right = (0..=10).rev().map(|i| drawn_out(i, 0.86));
            vec![
                thin(&[(0.02, 0.86), (0.98, 0.86)]),
                ground(0.86, left.chain(right)),
                // The arrow of the pull at its tip.
                bold(&[(0.72, 0.28), (0.94, 0.06)]),
                bold(&[(0.76, 0.06), (0.94, 0.06), (0.94, 0.24)]),
            ]
        }
        BrushId::Inflate => vec![
            thin(&[(0.02, 0.8), (0.98, 0.8)]),
            ground(0.8, bow(0.8, 0.36, -0.4)),
            bold(&[(0.5, 0.3), (0.5, 0.04)]),
            bold(&[(0.38, 0.16), (0.5, 0.04), (0.62, 0.16)]),
        ],
        BrushId::Flatten => vec![
            ground(0.6, []),
            thin(&[(0.06, 0.6), (0.18, 0.32), (0.34, 0.32), (0.46, 0.6)]),
            thin(&[(0.54, 0.6), (0.66, 0.88), (0.82, 0.88), (0.94, 0.6)]),
        ],
        BrushId::Scrape => vec![
            ground(0.8, []),
            thin(&[(0.2, 0.8), (0.32, 0.46), (0.6, 0.46), (0.72, 0.8)]),
            bold(&[(0.56, 0.8), (0.9, 0.2)]),
        ],
        BrushId::Fill => vec![
            ground(0.4, []),
            thin(&[(0.16, 0.4), (0.3, 0.84), (0.7, 0.84), (0.84, 0.4)]),
            thin(&[(0.3, 0.62), (0.7, 0.62)]),
        ],
        // A smooth face, and a gleam on it.
        BrushId::Polish => vec![
            ground(0.7, []),
            thin(&[(0.06, 0.7), (0.14, 0.56), (0.22, 0.7), (0.32, 0.56), (0.42, 0.7)]),
            bold(&[(0.7, 0.06), (0.7, 0.5)]),
            bold(&[(0.48, 0.28), (0.92, 0.28)]),
        ],
        BrushId::Draw => vec![
            thin(&[(0.02, 0.8), (0.98, 0.8)]),
            // The face rises as a whole.
            ground(0.8, [(0.26, 0.74), (0.36, 0.46), (0.64, 0.46), (0.74, 0.74)]),
            bold(&[(0.5, 0.38), (0.5, 0.06)]),
            bold(&[(0.38, 0.18), (0.5, 0.06), (0.62, 0.18)]),
        ],
        BrushId::Crease => vec![
            thin(&[(0.02, 0.4), (0.98, 0.4)]),
            ground(0.4, [(0.36, 0.46), (0.5, 0.92), (0.64, 0.46)]),
            bold(&[(0.5, 0.04), (0.5, 0.3)]),
        ],
        BrushId::Pinch => vec![
            ground(0.84, [(0.36, 0.72), (0.5, 0.3), (0.64, 0.72)]),
            bold(&[(0.04, 0.4), (0.32, 0.4)]),
            bold(&[(0.22, 0.28), (0.34, 0.4), (0.22, 0.52)]),
            bold(&[(0.96, 0.4), (0.68, 0.4)]),
            bold(&[(0.78, 0.28), (0.66, 0.4), (0.78, 0.52)]),
        ],
        BrushId::Twist => {
            let round = |i: usize| {
                let (sin, cos) = (TAU * (0.1 + 0.75 * i as f32 / 16.0)).sin_cos();
                (0.5 + 0.38 * cos, 0.5 + 0.38 * sin)
            };
            vec![
                IconLine::Bold((0..=16).map(round).collect()),
                bold(&[(0.72, 0.02), (0.74, 0.2), (0.56, 0.26)]),
                thin(&[(0.5, 0.42), (0.5, 0.58)]),
            ]
        }
        BrushId::Smear => vec![
            ground(0.84, [(0.2, 0.8), (0.5, 0.4), (0.76, 0.5), (0.7, 0.8)]),
            bold(&[(0.2, 0.2), (0.8, 0.2)]),
            bold(&[(0.66, 0.06), (0.8, 0.2), (0.66, 0.34)]),
        ],
    }
}
