//! Owns the icons of the tool buttons, drawn with lines so that they are sharp at any scale and take the theme's
//! colours.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};

use crate::input::ToolMode;
use crate::tools::solid::Solid;

/// Draws a window with an arrow out of it, or into it with `back`.
pub fn detach(painter: &Painter, rect: Rect, back: bool, colour: Color32) {
    let line = Stroke::new(1.2, colour);
    let at = |x: f32, y: f32| at(rect, x, y);
    let frame = vec![at(0.45, 0.1), at(0.0, 0.1), at(0.0, 1.0), at(0.9, 1.0), at(0.9, 0.55)];
    painter.add(Shape::line(frame, line));
    let (inner, outer) = (at(0.4, 0.6), at(1.0, 0.0));
    painter.line_segment([inner, outer], line);
    let tip = if back {
        [at(0.4, 0.2), inner, at(0.8, 0.6)]
    } else {
        [at(0.6, 0.0), outer, at(1.0, 0.4)]
    };
    painter.add(Shape::line(tip.to_vec(), line));
}

/// Draws a solid into `rect`.
pub fn solid(painter: &Painter, rect: Rect, solid: Solid, colour: Color32) {
    let line = Stroke::new(1.6, colour);
    let thin = Stroke::new(1.0, colour.gamma_multiply(0.6));
    let fill = colour.gamma_multiply(0.15);
    let at = |x: f32, y: f32| at(rect, x, y);
    match solid {
        Solid::Ellipsoid => {
            let radius = rect.width().min(rect.height()) * 0.46;
            painter.circle(rect.center(), radius, fill, line);
            let bulge = vec2(radius, radius * 0.35);
            painter.add(Shape::ellipse_stroke(rect.center(), bulge, thin));
        }
        Solid::Cuboid => {
            let (top, right, left) = (at(0.5, 0.04), at(0.94, 0.27), at(0.06, 0.27));
            let (middle, low) = (at(0.5, 0.5), at(0.5, 0.96));
            let (low_right, low_left) = (at(0.94, 0.73), at(0.06, 0.73));
            let hull = vec![top, right, low_right, low, low_left, left];
            painter.add(Shape::convex_polygon(hull, fill, line));
            for to in [left, right, low] {
                painter.line_segment([middle, to], thin);
            }
        }
        Solid::Pyramid => {
            let (apex, left, right) = (at(0.5, 0.04), at(0.04, 0.8), at(0.96, 0.8));
            let front = at(0.6, 0.97);
            let hull = vec![apex, right, front, left];
            painter.add(Shape::convex_polygon(hull, fill, line));
            painter.line_segment([apex, front], thin);
        }
        Solid::Cylinder => {
            let lid = vec2(rect.width() * 0.38, rect.height() * 0.15);
            let mut hull = arc(at(0.5, 0.2), lid, 180.0..=360.0);
            hull.extend(arc(at(0.5, 0.8), lid, 0.0..=180.0));
            painter.add(Shape::convex_polygon(hull, fill, line));
            painter.add(Shape::line(arc(at(0.5, 0.2), lid, 0.0..=180.0), thin));
        }
        Solid::Cone => {
            let mut hull = vec![at(0.5, 0.04)];
            let base = vec2(rect.width() * 0.42, rect.height() * 0.16);
            hull.extend(arc(at(0.5, 0.8), base, 0.0..=180.0));
            painter.add(Shape::convex_polygon(hull, fill, line));
        }
        Solid::Torus => {
            let (outer, inner) = (rect.size() * vec2(0.47, 0.34), rect.size() * vec2(0.2, 0.1));
            painter.add(Shape::ellipse_filled(rect.center(), outer, fill));
            painter.add(Shape::ellipse_stroke(rect.center(), outer, line));
            painter.add(Shape::ellipse_stroke(rect.center(), inner, line));
        }
        Solid::Capsule => {
            let cap = egui::Vec2::splat(rect.width().min(rect.height()) * 0.25);
            let mut hull = arc(at(0.5, 0.28), cap, 180.0..=360.0);
            hull.extend(arc(at(0.5, 0.72), cap, 0.0..=180.0));
            painter.add(Shape::convex_polygon(hull, fill, line));
            let waist = cap * vec2(1.0, 0.35);
            painter.add(Shape::line(arc(at(0.5, 0.28), waist, 0.0..=180.0), thin));
        }
        Solid::RoundedCuboid => {
            let hull =
                [(0.5, 0.04), (0.94, 0.27), (0.94, 0.73), (0.5, 0.96), (0.06, 0.73), (0.06, 0.27)];
            // Each corner is cut off halfway to where its neighbours are cut.
            let corner = |i: usize| {
                let (from, over, to) = (hull[(i + 5) % 6], hull[i], hull[(i + 1) % 6]);
                let near =
                    |p: (f32, f32)| at(over.0 * 0.75 + p.0 * 0.25, over.1 * 0.75 + p.1 * 0.25);
                [near(from), near(to)]
            };
            let hull: Vec<Pos2> = (0..6).flat_map(corner).collect();
            painter.add(Shape::convex_polygon(hull, fill, line));
            for to in [at(0.14, 0.31), at(0.86, 0.31), at(0.5, 0.88)] {
                painter.line_segment([at(0.5, 0.5), to], thin);
            }
        }
    }
}

/// Returns points of an ellipse, by angles in degrees: clockwise on the screen from the right.
fn arc(centre: Pos2, half: egui::Vec2, degrees: std::ops::RangeInclusive<f32>) -> Vec<Pos2> {
    let (from, to) = (*degrees.start(), *degrees.end());
    (0..=12)
        .map(|i| {
            let turn = (from + (to - from) * i as f32 / 12.0).to_radians();
            centre + half * vec2(turn.cos(), turn.sin())
        })
        .collect()
}

/// Draws the effect of a tool into `rect`: a plus, a minus, a drop.
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
        // A padlock.
        ToolMode::Protect | ToolMode::Release => {
            let body = [at(0.16, 0.44), at(0.84, 0.44), at(0.84, 0.96), at(0.16, 0.96)];
            let fill = colour.gamma_multiply(0.3);
            painter.add(Shape::convex_polygon(body.to_vec(), fill, Stroke::new(1.6, colour)));
            let shackle = (0..=12).map(|i| {
                let turn = std::f32::consts::PI * (1.0 - i as f32 / 12.0);
                at(0.5 + 0.22 * turn.cos(), 0.3 - 0.24 * turn.sin())
            });
            let shackle = [at(0.28, 0.44)].into_iter().chain(shackle).chain([at(0.72, 0.44)]);
            painter.line(shackle.collect(), Stroke::new(1.6, colour));
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

/// Draws the marker into `rect`: a dashed box.
pub fn marker(painter: &Painter, rect: Rect, colour: Color32) {
    let line = Stroke::new(1.6, colour);
    let corners = [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom()];
    let rim: Vec<Pos2> = corners.into_iter().chain([corners[0]]).collect();
    painter.extend(Shape::dashed_line(&rim, line, 4.0, 2.5));
}

/// Returns a point of `rect` by shares of its sides.
pub fn at(rect: Rect, x: f32, y: f32) -> Pos2 {
    pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height())
}
