//! The ground of a picture: a plane below the sculpture that receives the sun's shadow, is darker where the sculpture
//! blocks the light of the sky, has lines a round number of voxels apart, and fades with distance.
//!
//! The light that arrives is computed for the points of a [`LightMap`], independent of the eye and the render mode; the
//! [`GroundPicture`] of an eye derives colours from it. The plane is aligned with the grid, at the lowest face of a
//! voxel: final pictures have their ground there, too.

mod light_map;
mod picture;
#[cfg(test)]
mod tests;

use glam::{Affine3A, UVec3, Vec2, Vec3};

use super::illumination::Illumination;
use super::light::{LightSource, Lighting, Shadow};
use super::look::Look;
use super::shadow::ShadowSun;
use super::tone::ToneCurve;
use crate::sculpture::{Grid, Rgb};

pub use light_map::{LightMap, MAP_EDGE, Openness};
pub use picture::{GroundPicture, GroundShader};

/// The colour of the ground; final pictures have the same.
pub const GROUND_COLOUR: Rgb = Rgb::new(200, 198, 194);

/// The distance from the centre of the sculpture at which the ground has faded, in the sculpture's radii.
const REACH_RADII: f32 = 2.6;

/// The most lines that cross the longest side of the grid.
const MOST_ACROSS: u32 = 16;

/// How the ground of a picture looks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ground {
    /// The axis of the grid that points up.
    pub up: Vec3,
    /// The colour under white light.
    pub colour: Rgb,
    /// Draws only the shadow over the background: for the picture of a camera.
    pub shadow_only: bool,
    /// The angular diameter of the sun's disc.
    pub sun_deg: f32,
    /// The index of the sample in an antialiased picture.
    pub sample: u32,
}

impl Ground {
    /// Returns this ground in one of the samples of an antialiased picture.
    pub fn of_sample(self, sample: u32) -> Ground {
        Ground { sample, ..self }
    }
}

/// Returns the distance between two lines: 1, 2 or 5 voxels, times a power of ten.
pub fn line_spacing_vx(dims: UVec3) -> u32 {
    let least = dims.max_element().div_ceil(MOST_ACROSS);
    let decades = (0..).map(|power| 10u32.pow(power));
    decades
        .flat_map(|ten| [ten, 2 * ten, 5 * ten])
        .find(|spacing| *spacing >= least)
        .unwrap_or(least)
}

/// The plane of the ground, in grid coordinates. Of the axes across, the first is the one after the upright axis.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GroundPlane {
    /// The axis perpendicular to the plane.
    pub axis: usize,
    /// Whether that axis points up; otherwise down.
    pub upwards: bool,
    /// Its position on that axis.
    pub height: f32,
    /// The point below the centre of the sculpture, on the axes across.
    pub centre: Vec2,
    /// The half extents from there.
    pub half: Vec2,
    /// The box around the voxels.
    bounds: [Vec3; 2],
    /// The edges of a voxel.
    voxel_size: Vec3,
}

impl GroundPlane {
    /// Returns the plane below the voxels of `grid` when its axis `up` points up; `None` below an empty grid.
    pub fn below(grid: &Grid, up: Vec3) -> Option<GroundPlane> {
        let (low, high) = grid.opaque_bounds()?;
        let (low, high) = (low.as_vec3(), high.as_vec3());
        let axis = up.abs().max_position();
        let upwards = up[axis] >= 0.0;
        let middle = (low + high) * 0.5;
        let voxel_size = grid.voxel_size();
        let reach = REACH_RADII * 0.5 * ((high - low) * voxel_size).length();
        Some(GroundPlane {
            axis,
            upwards,
            height: if upwards { low[axis] } else { high[axis] },
            centre: across(axis, middle),
            half: Vec2::splat(reach) / across(axis, voxel_size),
            bounds: [low, high],
            voxel_size,
        })
    }

    /// Returns a unit vector upwards, in grid coordinates.
    pub fn up(&self) -> Vec3 {
        Vec3::AXES[self.axis] * if self.upwards { 1.0 } else { -1.0 }
    }

    /// Returns the point at `place`, from (-1, -1) to (1, 1), in grid coordinates.
    pub fn point(&self, place: Vec2) -> Vec3 {
        let at = self.centre + place * self.half;
        let mut point = Vec3::ZERO;
        point[self.axis] = self.height;
        point[(self.axis + 1) % 3] = at.x;
        point[(self.axis + 2) % 3] = at.y;
        point
    }
}

/// Returns the coordinates of `v` on the axes across `axis`.
fn across(axis: usize, v: Vec3) -> Vec2 {
    Vec2::new(v[(axis + 1) % 3], v[(axis + 2) % 3])
}

/// The linear light that an open point of the ground sends to the eye.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GroundLight {
    /// From ambient light.
    pub ambient: Vec3,
    /// From the lights that cast no shadow.
    pub others: Vec3,
    /// From the sun.
    pub direct: Vec3,
    /// Maps this light to that of the picture.
    pub tone: ToneCurve,
    /// The sun, if it is above the ground.
    pub sun: Option<ShadowSun>,
}

impl GroundLight {
    /// Returns the light of `ground` at `plane` with this lighting. The first distant light casts shadows on it,
    /// whether it does so on the sculpture or not.
    pub fn new(
        ground: &Ground,
        plane: &GroundPlane,
        lighting: &Lighting,
        eye_from_world: &Affine3A,
        world_from_grid: &Affine3A,
    ) -> GroundLight {
        let shadow = Some(Shadow { sun_deg: ground.sun_deg, sample: ground.sample });
        let lighting = Lighting { shadow, look: Look::Colours, ..*lighting };
        let light = Illumination::new(&lighting, eye_from_world, world_from_grid);
        let normal = (light.normal_from_gradient * plane.up()).normalize_or(Vec3::Y);
        let centre = light.eye_from_grid.transform_point3(plane.point(Vec2::ZERO));
        let albedo = Vec3::from(ground.colour.0.map(|c| f32::from(c) / 255.0)).powf(2.0);
        let (mut others, mut direct) = (Vec3::ZERO, Vec3::ZERO);
        for (i, source) in light.lights.iter().flatten().enumerate() {
            let towards = match source.source {
                LightSource::Direction(direction) => direction,
                LightSource::Position(place) => (place - centre).normalize_or_zero(),
            };
            let arrives = source.radiance * towards.dot(normal).max(0.0);
            match light.sun.is_some_and(|sun| sun.light == i) {
                true => direct += arrives,
                false => others += arrives,
            }
        }
        let ambient = (light.ambient + light.ambient_slope * normal.dot(light.up)).max(Vec3::ZERO);
        GroundLight {
            ambient: albedo * ambient,
            others: albedo * others,
            direct: albedo * direct,
            tone: light.tone,
            sun: light.sun.filter(|sun| sun.towards.dot(plane.up()) > 0.0),
        }
    }
}
