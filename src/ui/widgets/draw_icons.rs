//! The icons of the tools that draw, with lines like those of the other tools.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke};

use crate::input::DrawKind;
use crate::ui::widgets::icons::at;

/// Draws the icon of a drawing tool into `rect`: the drag, and its result.
pub fn draw(painter: &Painter, rect: Rect, kind: DrawKind, colour: Color32) {
    let line = Stroke::new(1.6, colour);
    let thin = Stroke::new(1.0, colour.gamma_multiply(0.6));
    let fill = colour.gamma_multiply(0.15);
    let points = |points: &[(f32, f32)]| -> Vec<Pos2> {
        points.iter().map(|(x, y)| at(rect, *x, *y)).collect()
    };
    let path = |corners: &[(f32, f32)], stroke: Stroke| {
        painter.line(points(corners), stroke);
    };
    let dashed = |corners: Vec<Pos2>| painter.extend(Shape::dashed_line(&corners, line, 4.0, 2.5));
    match kind {
        DrawKind::Lasso => {
            let rim = |i: i32| {
                let (sin, cos) = (i as f32 / 24.0 * std::f32::consts::TAU).sin_cos();
                at(rect, 0.5 + 0.48 * cos, 0.4 + 0.34 * sin)
            };
            dashed((0..=24).map(rim).collect());
            path(&[(0.3, 0.7), (0.24, 0.86), (0.34, 1.0)], line);
        }
        DrawKind::Rectangle => {
            dashed(points(&[(0.06, 0.16), (0.86, 0.16), (0.86, 0.84), (0.06, 0.84), (0.06, 0.16)]));
            path(&[(0.86, 0.66), (0.86, 1.0)], line);
            path(&[(0.69, 0.84), (1.0, 0.84)], line);
        }
        DrawKind::Plane => {
            path(&[(0.0, 0.78), (1.0, 0.22)], line);
            for i in 0..4 {
                let (x, y) = (0.2 + 0.22 * i as f32, 0.67 - 0.123 * i as f32);
                path(&[(x, y), (x, y + 0.26)], thin);
            }
        }
        DrawKind::Box => {
            let base = [(0.5, 0.52), (0.96, 0.72), (0.5, 0.94), (0.04, 0.72)];
            painter.add(Shape::convex_polygon(points(&base), fill, line));
            for (x, y) in [(0.96, 0.72), (0.5, 0.94), (0.04, 0.72)] {
                path(&[(x, y), (x, y - 0.4)], thin);
            }
            path(&[(0.04, 0.32), (0.5, 0.54), (0.96, 0.32), (0.5, 0.12), (0.04, 0.32)], thin);
        }
        DrawKind::Line => {
            painter.line(points(&[(0.14, 0.86), (0.86, 0.14)]), Stroke::new(6.0, fill));
            path(&[(0.14, 0.86), (0.86, 0.14)], line);
            for (x, y) in [(0.14, 0.86), (0.86, 0.14)] {
                painter.circle_filled(at(rect, x, y), 2.6, colour);
            }
        }
        DrawKind::Curve => {
            let wave = |i: i32| {
                let t = i as f32 / 20.0;
                at(rect, 0.08 + 0.84 * t, 0.5 - 0.36 * (t * std::f32::consts::TAU).sin())
            };
            let wave: Vec<Pos2> = (0..=20).map(wave).collect();
            painter.line(wave.clone(), Stroke::new(6.0, fill));
            painter.line(wave, line);
            for (x, y) in [(0.08, 0.5), (0.92, 0.5)] {
                painter.circle_filled(at(rect, x, y), 2.6, colour);
            }
        }
        DrawKind::Lathe => {
            let half = [(0.5, 0.94), (0.72, 0.94), (0.9, 0.6), (0.62, 0.34), (0.74, 0.06)];
            path(&half, line);
            path(&half.map(|(x, y)| (1.0 - x, y)), thin);
            path(&[(0.5, 0.0), (0.5, 1.0)], thin);
        }
        DrawKind::Text => {
            path(
                &[(0.08, 0.94), (0.46, 0.06), (0.54, 0.06), (0.92, 0.94)],
                Stroke::new(2.2, colour),
            );
            path(&[(0.23, 0.62), (0.77, 0.62)], line);
        }
    }
}
