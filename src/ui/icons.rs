//! Owns the small pictures on the tool buttons, drawn with lines so that they are sharp at any
//! scale and take the theme's colours.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};

use crate::input::ToolMode;
use crate::tools::brush::deform::DeformKind;
use crate::tools::brush::spray::SprayKind;
use crate::tools::solid::Solid;

/// Draws a window with an arrow out of it, or into it for one that can be put back.
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

/// Points of an ellipse, by angles in degrees: clockwise on the screen from the right.
fn arc(centre: Pos2, half: egui::Vec2, degrees: std::ops::RangeInclusive<f32>) -> Vec<Pos2> {
    let (from, to) = (*degrees.start(), *degrees.end());
    (0..=12)
        .map(|i| {
            let turn = (from + (to - from) * i as f32 / 12.0).to_radians();
            centre + half * vec2(turn.cos(), turn.sin())
        })
        .collect()
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

/// Draws a spray tool into `rect`: what it leaves of a surface.
pub fn spray(painter: &Painter, rect: Rect, kind: SprayKind, colour: Color32) {
    let line = Stroke::new(1.6, colour);
    let thin = Stroke::new(1.0, colour.gamma_multiply(0.6));
    let at = |x: f32, y: f32| at(rect, x, y);
    let path = |points: &[(f32, f32)], stroke: Stroke| {
        painter.line(points.iter().map(|(x, y)| at(*x, *y)).collect(), stroke);
    };
    // Half a turn around (x, y), upwards or downwards.
    let arc = |x: f32, y: f32, radius: f32, up: bool| -> Vec<(f32, f32)> {
        let turn = |i: usize| std::f32::consts::PI * (1.0 - i as f32 / 12.0);
        let sense = if up { -radius } else { radius };
        (0..=12).map(|i| (x + radius * turn(i).cos(), y + sense * turn(i).sin())).collect()
    };
    let ground = |middle: Vec<(f32, f32)>| {
        let mut points = vec![(0.02, 0.62)];
        points.extend(middle);
        points.push((0.98, 0.62));
        path(&points, line);
    };
    match kind {
        SprayKind::Paintbrush => {
            path(&[(0.92, 0.06), (0.46, 0.56)], Stroke::new(2.4, colour));
            let tip = [(0.56, 0.62), (0.38, 0.48), (0.22, 0.62), (0.1, 0.94), (0.42, 0.84)];
            let tip = tip.map(|(x, y)| at(x, y)).to_vec();
            painter.add(Shape::convex_polygon(tip, colour.gamma_multiply(0.3), line));
        }
        SprayKind::Devourer => ground(arc(0.5, 0.62, 0.28, false)),
        SprayKind::Clay => ground(arc(0.5, 0.62, 0.28, true)),
        SprayKind::Erosion => {
            path(&[(0.06, 0.94), (0.06, 0.42), (0.3, 0.14), (0.94, 0.14)], line);
            path(&[(0.06, 0.42), (0.06, 0.14), (0.3, 0.14)], thin);
        }
        SprayKind::Dilation => {
            path(&[(0.06, 0.94), (0.06, 0.06), (0.94, 0.06)], line);
            path(&[(0.3, 0.94), (0.3, 0.3), (0.94, 0.3)], thin);
        }
        SprayKind::Growth => {
            path(&[(0.1, 0.06), (0.1, 0.56), (0.44, 0.9), (0.94, 0.9)], line);
            path(&[(0.1, 0.56), (0.1, 0.9), (0.44, 0.9)], thin);
        }
        // A hatched patch of the surface.
        SprayKind::Mask | SprayKind::Unmask => {
            path(&[(0.02, 0.62), (0.98, 0.62)], line);
            for x in [0.22, 0.38, 0.54, 0.7] {
                path(&[(x, 0.62), (x + 0.16, 0.34)], thin);
            }
            path(&[(0.18, 0.62), (0.34, 0.3), (0.9, 0.3), (0.74, 0.62)], line);
        }
        SprayKind::Smooth => {
            path(&[(0.04, 0.4), (0.2, 0.22), (0.36, 0.4), (0.52, 0.22), (0.68, 0.4)], thin);
            path(&[(0.04, 0.72), (0.3, 0.64), (0.62, 0.74), (0.96, 0.66)], line);
        }
    }
}

/// Draws a tool that deforms into `rect`: the surface before and after, and where it goes.
pub fn deform(painter: &Painter, rect: Rect, kind: DeformKind, colour: Color32) {
    let line = Stroke::new(1.6, colour);
    let thin = Stroke::new(1.0, colour.gamma_multiply(0.6));
    let path = |points: &[(f32, f32)], stroke: Stroke| {
        painter.line(points.iter().map(|(x, y)| at(rect, *x, *y)).collect(), stroke);
    };
    match kind {
        DeformKind::Grab => {
            path(&[(0.02, 0.86), (0.98, 0.86)], thin);
            // Drawn out to the right, with the arrow of the pull at its tip.
            let side = |i: usize, base: f32| {
                let t = i as f32 / 10.0;
                let rise = t * t * (3.0 - 2.0 * t);
                (base + (0.62 - base) * t + 0.06 * rise, 0.86 - 0.5 * rise)
            };
            let mut points = vec![(0.02, 0.86)];
            points.extend((0..=10).map(|i| side(i, 0.14)));
            points.extend((0..=10).rev().map(|i| side(i, 0.86)));
            points.push((0.98, 0.86));
            path(&points, line);
            path(&[(0.72, 0.28), (0.94, 0.06)], line);
            path(&[(0.76, 0.06), (0.94, 0.06), (0.94, 0.24)], line);
        }
        DeformKind::Inflate => {
            path(&[(0.02, 0.8), (0.98, 0.8)], thin);
            let mut points = vec![(0.02, 0.8)];
            points.extend((0..=16).map(|i| {
                let turn = std::f32::consts::PI * (1.0 - i as f32 / 16.0);
                (0.5 + 0.36 * turn.cos(), 0.8 - 0.4 * turn.sin())
            }));
            points.push((0.98, 0.8));
            path(&points, line);
            path(&[(0.5, 0.3), (0.5, 0.04)], line);
            path(&[(0.38, 0.16), (0.5, 0.04), (0.62, 0.16)], line);
        }
        DeformKind::Flatten => {
            path(&[(0.02, 0.6), (0.98, 0.6)], line);
            path(&[(0.06, 0.6), (0.18, 0.32), (0.34, 0.32), (0.46, 0.6)], thin);
            path(&[(0.54, 0.6), (0.66, 0.88), (0.82, 0.88), (0.94, 0.6)], thin);
        }
        DeformKind::Scrape => {
            path(&[(0.02, 0.8), (0.98, 0.8)], line);
            path(&[(0.2, 0.8), (0.32, 0.46), (0.6, 0.46), (0.72, 0.8)], thin);
            path(&[(0.56, 0.8), (0.9, 0.2)], line);
        }
        DeformKind::Fill => {
            path(&[(0.02, 0.4), (0.98, 0.4)], line);
            path(&[(0.16, 0.4), (0.3, 0.84), (0.7, 0.84), (0.84, 0.4)], thin);
            path(&[(0.3, 0.62), (0.7, 0.62)], thin);
        }
        DeformKind::Draw => {
            path(&[(0.02, 0.8), (0.98, 0.8)], thin);
            // The face goes up as a whole.
            path(
                &[(0.02, 0.8), (0.26, 0.74), (0.36, 0.46), (0.64, 0.46), (0.74, 0.74), (0.98, 0.8)],
                line,
            );
            path(&[(0.5, 0.38), (0.5, 0.06)], line);
            path(&[(0.38, 0.18), (0.5, 0.06), (0.62, 0.18)], line);
        }
        DeformKind::Crease => {
            path(&[(0.02, 0.4), (0.98, 0.4)], thin);
            path(&[(0.02, 0.4), (0.36, 0.46), (0.5, 0.92), (0.64, 0.46), (0.98, 0.4)], line);
            path(&[(0.5, 0.04), (0.5, 0.3)], line);
        }
        DeformKind::Pinch => {
            path(&[(0.02, 0.84), (0.36, 0.72), (0.5, 0.3), (0.64, 0.72), (0.98, 0.84)], line);
            path(&[(0.04, 0.4), (0.32, 0.4)], line);
            path(&[(0.22, 0.28), (0.34, 0.4), (0.22, 0.52)], line);
            path(&[(0.96, 0.4), (0.68, 0.4)], line);
            path(&[(0.78, 0.28), (0.66, 0.4), (0.78, 0.52)], line);
        }
        DeformKind::Twist => {
            let round = |i: usize| {
                let turn = std::f32::consts::TAU * (0.1 + 0.75 * i as f32 / 16.0);
                (0.5 + 0.38 * turn.cos(), 0.5 + 0.38 * turn.sin())
            };
            path(&(0..=16).map(round).collect::<Vec<_>>(), line);
            path(&[(0.72, 0.02), (0.74, 0.2), (0.56, 0.26)], line);
            path(&[(0.5, 0.42), (0.5, 0.58)], thin);
        }
        DeformKind::Smear => {
            path(
                &[(0.02, 0.84), (0.2, 0.8), (0.5, 0.4), (0.76, 0.5), (0.7, 0.8), (0.98, 0.84)],
                line,
            );
            path(&[(0.2, 0.2), (0.8, 0.2)], line);
            path(&[(0.66, 0.06), (0.8, 0.2), (0.66, 0.34)], line);
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

/// A place in `rect` by shares of its sides.
pub fn at(rect: Rect, x: f32, y: f32) -> Pos2 {
    pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height())
}
