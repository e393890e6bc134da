//! A picture of a lit ball, which shows a lighting at a glance: for buttons that select a lighting.
//!
//! From a [`Lighting`] to a small picture, by the formula of all shaders. Knows no grid.

use fearless_simd::{Level, Simd, dispatch, prelude::*};
use glam::{Affine3A, UVec2, Vec2, Vec3};

use super::illumination::{Illumination, LANES, SurfacePoints};
use super::{Lighting, Pixels};
use crate::sculpture::Rgb;

/// The distance of the eye from the centre of the ball, in radii.
const DISTANCE: f32 = 6.0;

/// Returns the ball in a picture of `edge_px` pixels a side, of which it touches the edges; transparent around it. With
/// true colours, the ball is colourful. Lamps with a position keep it, as around a sculpture of the size of the ball.
pub fn ball(lighting: &Lighting, edge_px: u32) -> Pixels {
    let eye_from_world = Affine3A::from_translation(Vec3::new(0.0, 0.0, -DISTANCE));
    let illumination = Illumination::new(lighting, &eye_from_world, &Affine3A::IDENTITY);
    let mut pixels = Pixels::new(UVec2::splat(edge_px));
    dispatch!(Level::new(), simd => draw(simd, &illumination, edge_px, &mut pixels));
    pixels
}

#[inline(always)]
fn draw<S: Simd>(simd: S, illumination: &Illumination, edge_px: u32, out: &mut Pixels) {
    let radius_px = 0.5 * edge_px as f32;
    let mut points = SurfacePoints::default();
    for (first, out) in out.rgba.chunks_mut(LANES).enumerate().map(|(i, out)| (i * LANES, out)) {
        let mut cover = [0.0; LANES];
        for (lane, cover) in cover.iter_mut().enumerate().take(out.len()) {
            let i = (first + lane) as u32;
            let at_px = Vec2::new((i % edge_px) as f32, (i / edge_px) as f32) + 0.5;
            let at = (at_px / radius_px - 1.0) * Vec2::new(1.0, -1.0);
            // The outline is antialiased over half a pixel on either side.
            *cover = (radius_px * (1.0 - at.length()) + 0.5).clamp(0.0, 1.0);
            let flat = at.clamp_length_max(1.0);
            let normal = flat.extend((1.0 - flat.length_squared()).max(0.0).sqrt());
            let colourful = Rgb(normal.to_array().map(|c| (c * 110.0 + 145.0) as u8));
            let Rgb([r, g, b]) = illumination.colour.unwrap_or(colourful);
            points.colour[lane] = u32::from_le_bytes([r, g, b, 0]);
            for axis in 0..3 {
                points.position[axis][lane] = normal[axis];
                points.gradient[axis][lane] = normal[axis];
            }
        }
        let colours = illumination.shade(simd, &points).to_array();
        for ((out, colour), cover) in out.iter_mut().zip(colours).zip(cover) {
            let [r, g, b, _] = colour.to_le_bytes();
            *out = [r, g, b, (cover * 255.0 + 0.5) as u8];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::{Look, Matcap, ToneMapping};

    #[test]
    fn each_look_has_its_own_ball_lit_from_the_upper_left() {
        let of =
            |look| ball(&Lighting { look, tone: ToneMapping::Filmic, ..Lighting::default() }, 40);
        let balls = Look::ALL.map(of);
        for (i, ball) in balls.iter().enumerate() {
            assert_eq!(ball.rgba[0][3], 0, "nothing in the corner");
            assert_eq!(ball.rgba[20 * 40 + 20][3], 255);
            let sum = |x: usize, y: usize| {
                ball.rgba[y * 40 + x][..3].iter().map(|c| u32::from(*c)).sum::<u32>()
            };
            assert!(sum(13, 11) > sum(27, 31) + 60, "ball {i}");
            assert!(balls[..i].iter().all(|other| other.rgba != ball.rgba));
        }
    }

    #[test]
    fn a_matcap_is_what_the_ball_shows() {
        let half = Matcap::from_fn(|at| {
            crate::sculpture::Rgb::new(if at.y > 0.0 { 200 } else { 30 }, 9, 9)
        });
        let lighting = Lighting { look: Look::Matcap, matcap: half, ..Lighting::default() };
        let ball = ball(&lighting, 32);
        assert_eq!(ball.rgba[6 * 32 + 16], [200, 9, 9, 255]);
        assert_eq!(ball.rgba[26 * 32 + 16], [30, 9, 9, 255]);
    }
}
