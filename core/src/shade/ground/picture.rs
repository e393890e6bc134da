//! The colours of the ground in the picture of one eye: the point of the ground at each pixel, its light, its lines,
//! and its fading. `shaders/ground.wgsl` is the twin of [`GroundPicture::pixel`].

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::light_map::MAP_EDGE;
use super::{Ground, GroundLight, GroundPlane, LightMap, Openness, across, line_spacing_vx};
use crate::sculpture::Grid;
use crate::shade::{Lighting, Pixels, ShadePose};
use crate::view::PixelRays;

/// Every fifth line is stronger.
const MAJOR: f32 = 5.0;
/// Half widths of lines in pixels, and the share of light that they absorb.
const MINOR_LINE: [f32; 2] = [0.5, 0.2];
const MAJOR_LINE: [f32; 2] = [0.7, 0.4];
/// Lines are drawn in full up to `1 / DENSE` lines per pixel, and vanish at `2 / DENSE`.
const DENSE: f32 = 6.0;

/// The ground in the picture of one eye, as numbers, in the form that a device takes, too.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct GroundPicture {
    /// The first two over the third, each times (x, y, 1) in pixels, is the position on the plane, from (-1, -1) to (1,
    /// 1); the third is positive where the plane is visible. Then 0; 1 if only the shadow is drawn; 0.
    pub rows: [[f32; 4]; 3],
    /// [`GroundLight`]'s ambient light, others and direct light; then the floor of the tone curve, 0, 0.
    pub light: [[f32; 4]; 3],
    /// The factors of the tone curve.
    pub tone: [f32; 4],
    /// Positions on the plane times the first two, plus the others, count lines.
    pub lines: [f32; 4],
}

impl GroundPicture {
    /// Returns the ground with lines `spacing_vx` apart; `None` if the eye is not above the plane.
    pub fn new(
        ground: &Ground,
        plane: &GroundPlane,
        light: &GroundLight,
        rays: &PixelRays,
        spacing_vx: u32,
    ) -> Option<GroundPicture> {
        let GroundPlane { axis, height, centre, half, .. } = *plane;
        let sign = plane.up()[axis];
        let above = f64::from((rays.origin[axis] - height) * sign);
        if above.is_nan() || above <= 0.0 {
            return None;
        }
        let columns = [rays.step_x, rays.step_y, rays.corner];
        let falling = DVec3::from_array(columns.map(|ray| f64::from(-sign * ray[axis])));
        let from_centre = across(axis, rays.origin) - centre;
        let row = |i: usize| {
            let sideways = DVec3::from_array(columns.map(|ray| f64::from(across(axis, ray)[i])));
            let row = falling * f64::from(from_centre[i]) + sideways * above;
            (row / f64::from(half[i])).as_vec3()
        };
        let w = |v: Vec3, w: f32| v.extend(w).to_array();
        let per_cell = half / spacing_vx as f32;
        let first = centre / spacing_vx as f32;
        Some(GroundPicture {
            rows: [
                w(row(0), 0.0),
                w(row(1), f32::from(u8::from(ground.shadow_only))),
                w(falling.as_vec3(), 0.0),
            ],
            light: [w(light.ambient, light.tone.floor), w(light.others, 0.0), w(light.direct, 0.0)],
            tone: light.tone.factors,
            lines: [per_cell.x, per_cell.y, first.x, first.y],
        })
    }

    /// Returns the colour, sRGB, and the opacity of the ground at a point of the picture, in pixels from its upper left
    /// corner.
    pub fn pixel(&self, at: Vec2, map: &LightMap) -> [f32; 4] {
        let [across, along, falling] = self.rows.map(|row| Vec3::from_slice(&row[..3]));
        let at = at.extend(1.0);
        let falls = falling.dot(at);
        if falls <= 0.0 {
            return [0.0; 4];
        }
        let place = Vec2::new(across.dot(at), along.dot(at)) / falls;
        let inside = 1.0 - place.length_squared();
        if inside <= 0.0 {
            return [0.0; 4];
        }
        let fade = inside * inside * (3.0 - 2.0 * inside);
        let [sunlit, open] = sample(map, place);
        let [ambient, others, direct] = self.light.map(|light| Vec3::from_slice(&light[..3]));
        let light = ambient * open + others + direct * sunlit;
        let full = ambient + others + direct;
        if self.rows[1][3] != 0.0 {
            let share = light.element_sum() / full.element_sum().max(1e-6);
            return [0.0, 0.0, 0.0, fade * (1.0 - share.sqrt())];
        }
        // The change of the position from pixel to pixel.
        let step = |i: usize| (Vec2::new(across[i], along[i]) - place * falling[i]).abs() / falls;
        let cells = Vec2::new(self.lines[0], self.lines[1]);
        let width = (step(0).max(step(1)) * cells).max(Vec2::splat(1e-9));
        let cell = place * cells + Vec2::new(self.lines[2], self.lines[3]);
        let ink = grid_lines(cell, width, MINOR_LINE).max(grid_lines(
            cell / MAJOR,
            width / MAJOR,
            MAJOR_LINE,
        ));
        let [a, b, c, d] = self.tone;
        let mapped = light * (light * a + b) / (light * (light * c + d) + self.light[0][3]);
        let colour = mapped.clamp(Vec3::ZERO, Vec3::ONE).powf(0.5) * (1.0 - ink);
        colour.extend(fade).to_array()
    }
}

/// Returns the share of light that the lines at whole numbers absorb at `cell`, for a pixel that is `width` wide.
fn grid_lines(cell: Vec2, width: Vec2, [half_px, ink]: [f32; 2]) -> f32 {
    let away = (cell - (cell + 0.5).floor()).abs();
    let cover = (half_px + 0.5 - away / width).clamp(Vec2::ZERO, Vec2::ONE);
    let sparse = (2.0 - width * DENSE).clamp(Vec2::ZERO, Vec2::ONE);
    (cover * sparse).max_element() * ink
}

/// Returns the shares of light at a place, interpolated, 0 to 1.
fn sample(map: &LightMap, place: Vec2) -> [f32; 2] {
    let edge = MAP_EDGE as f32;
    let at = ((place * 0.5 + 0.5) * edge - 0.5).clamp(Vec2::ZERO, Vec2::splat(edge - 1.0));
    let low = at.floor().min(Vec2::splat(edge - 2.0));
    let share = at - low;
    let first = low.x as usize + MAP_EDGE * low.y as usize;
    let texel = |i: usize| Vec2::from(map.texels[i].map(|share| f32::from(share) / 255.0));
    let row = |first: usize| texel(first).lerp(texel(first + 1), share.x);
    row(first).lerp(row(first + MAP_EDGE), share.y).to_array()
}

/// Draws the ground below a grid into pictures in memory.
pub struct GroundShader<'a> {
    grid: &'a Grid,
    plane: GroundPlane,
    openness: Openness,
    map: LightMap,
}

impl<'a> GroundShader<'a> {
    /// Returns a shader of the ground below `grid` whose axis `up` points up; `None` below an empty grid.
    pub fn new(grid: &'a Grid, up: Vec3) -> Option<GroundShader<'a>> {
        let plane = GroundPlane::below(grid, up)?;
        let openness = Openness::new(grid, &plane);
        Some(GroundShader { grid, plane, openness, map: LightMap::default() })
    }

    /// Draws the ground where `pixels`, of an eye with these rays, show nothing of the grid.
    pub fn put_behind(
        &mut self,
        ground: &Ground,
        lighting: &Lighting,
        pose: &ShadePose,
        rays: &PixelRays,
        pixels: &mut Pixels,
    ) {
        let GroundShader { grid, plane, openness, map } = self;
        let (eye_from_world, world_from_grid) = (&pose.eye_from_world, &pose.world_from_grid);
        let light = GroundLight::new(ground, plane, lighting, eye_from_world, world_from_grid);
        let spacing_vx = line_spacing_vx(grid.dims());
        let Some(picture) = GroundPicture::new(ground, plane, &light, rays, spacing_vx) else {
            return;
        };
        map.update(grid, plane, openness, light.sun.as_ref());
        let width = pixels.size.x.max(1) as usize;
        pixels.rgba.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate().filter(|(_, pixel)| pixel[3] == 0) {
                let at = Vec2::new(x as f32, y as f32) + 0.5;
                *pixel = picture.pixel(at, map).map(|value| (value * 255.0 + 0.5) as u8);
            }
        });
    }
}
