//! Owns the small pictures on the tool buttons, drawn with lines so that they are sharp at any
//! scale and take the theme's colours.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, pos2};

use crate::input::ToolMode;
use crate::tools::construct::Solid;

/// Draws a solid into `rect`.
pub fn solid(painter: &Painter, rect: Rect, solid: Solid, colour: Color32) {
    let line = Stroke::new(1.6, colour);
    let thin = Stroke::new(1.0, colour.gamma_multiply(0.6));
    let at = |x: f32, y: f32| at(rect, x, y);
    match solid {
        Solid::Ellipsoid => {
            let radius = rect.width().min(rect.height()) * 0.46;
            painter.circle(rect.center(), radius, colour.gamma_multiply(0.15), line);
            let bulge = egui::vec2(radius, radius * 0.35);
            painter.add(Shape::ellipse_stroke(rect.center(), bulge, thin));
        }
        Solid::Cuboid => {
            let (top, right, left) = (at(0.5, 0.04), at(0.94, 0.27), at(0.06, 0.27));
            let (middle, low) = (at(0.5, 0.5), at(0.5, 0.96));
            let (low_right, low_left) = (at(0.94, 0.73), at(0.06, 0.73));
            let hull = vec![top, right, low_right, low, low_left, left];
            painter.add(Shape::convex_polygon(hull, colour.gamma_multiply(0.15), line));
            for to in [left, right, low] {
                painter.line_segment([middle, to], thin);
            }
        }
        Solid::Pyramid => {
            let (apex, left, right) = (at(0.5, 0.04), at(0.04, 0.8), at(0.96, 0.8));
            let front = at(0.6, 0.97);
            let hull = vec![apex, right, front, left];
            painter.add(Shape::convex_polygon(hull, colour.gamma_multiply(0.15), line));
            painter.line_segment([apex, front], thin);
        }
    }
}

/// Draws what a tool does into `rect`: a plus, a minus, a drop.
pub fn mode(painter: &Painter, rect: Rect, mode: ToolMode, colour: Color32) {
    let line = Stroke::new(2.4, colour);
    let at = |x: f32, y: f32| at(rect, x, y);
    match mode {
        ToolMode::Add => {
            painter.line_segment([at(0.5, 0.1), at(0.5, 0.9)], line);
            painter.line_segment([at(0.1, 0.5), at(0.9, 0.5)], line);
        }
        ToolMode::Subtract => {
            painter.line_segment([at(0.1, 0.5), at(0.9, 0.5)], line);
        }
        ToolMode::Recolour => {
            let mut drop = vec![at(0.5, 0.02)];
            // The round lower part, from where the flanks touch it on the right to the left.
            drop.extend((0..=16).map(|i| {
                let turn = (-30.0 + 240.0 * i as f32 / 16.0).to_radians();
                at(0.5 + 0.34 * turn.cos(), 0.62 + 0.34 * turn.sin())
            }));
            let fill = colour.gamma_multiply(0.3);
            painter.add(Shape::convex_polygon(drop, fill, Stroke::new(1.6, colour)));
        }
    }
}

fn at(rect: Rect, x: f32, y: f32) -> Pos2 {
    pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height())
}
