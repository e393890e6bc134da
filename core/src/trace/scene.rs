//! The scene that rays of a final picture meet: the sculpture and the ground.
//!
//! Maps rays to the nearest surface: the origin of further rays on it, its normal and its colour. Points are in grid
//! coordinates, directions and normals in the world, so that voxels may have edges of different lengths and angles are
//! true.
//!
//! A surface of voxels has terraces. Light should fall on the surface that they approximate, whose normal is that of
//! the [`crate::shade::NormalField`]; rays to and from terraces would darken them by each other. So further rays start
//! above the steps: along the normal by up to [`CLEARANCE_VX`], less where the surface is aligned with the grid and has
//! no steps. Shadows of details that are smaller than that are lost. With a [`LevelSet`], rays meet the smooth surface
//! itself ([`super::smooth`]) and none of this is needed.
//!
//! Knows no light.

use glam::{Affine3A, IVec3, Mat3, UVec3, Vec3};

use super::TraceGround;
use super::linear::linear_colour;
use super::prepared::PreparedGround;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_index};
use crate::shade::level_set::{BEYOND_VOXELS_VX, CellCache};
use crate::shade::{LevelSet, ShadeSource};
use crate::surface::raycast::cast;

/// The height above a sloping surface at which rays start: above the highest corner of its steps.
const CLEARANCE_VX: f32 = 1.5;
/// Points of a face stay this far from its edges.
const EDGE_VX: f32 = 0.01;
/// The clearance if there is no room for more, and on surfaces along the grid.
const LEAST_CLEARANCE_VX: f32 = 0.02;
/// Clearance per slope against the grid.
const CLEARANCE_PER_SLOPE: f32 = 30.0;
/// A normal that points away from the visible face by more than this belongs to another side: a thin wall.
pub(super) const OTHER_SIDE: f32 = -0.2;
/// Distance from the sculpture, in its radii, beyond which indirect light treats the ground as lit by the whole sky.
const OPEN_GROUND_RADII: f32 = 4.0;

/// A surface on a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathVertex {
    /// The origin of further rays, in grid coordinates.
    pub start: Vec3,
    /// Unit vector out of the surface, in the world.
    pub normal: Vec3,
    /// Share of light that it reflects.
    pub albedo: Vec3,
}

/// The surface that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(super) enum Met {
    Nothing,
    Sculpture(PathVertex),
    Ground(PathVertex),
    /// Ground outside the sculpture's shadow.
    OpenGround,
}

/// See the module text.
pub(super) struct PathScene<'a> {
    pub source: ShadeSource<'a>,
    /// The smooth surface, unless voxels are shown.
    pub levels: Option<&'a LevelSet>,
    pub world_from_grid: Affine3A,
    pub grid_from_world: Mat3,
    pub world_from_normal: Mat3,
    /// The box around all voxels.
    pub bounds: (Vec3, Vec3),
    pub middle: Vec3,
    pub radius: f32,
    pub up: Vec3,
    pub ground: Option<PreparedGround>,
}

impl PreparedGround {
    fn height_of(&self, point: Vec3) -> f32 {
        self.height.dot(point) + self.offset
    }
}

impl<'a> PathScene<'a> {
    /// Returns the scene. `lowest`: the least height of the sculpture along `up`.
    pub fn new(
        (source, levels): (ShadeSource<'a>, Option<&'a LevelSet>),
        world_from_grid: Affine3A,
        up: Vec3,
        bounds: (Vec3, Vec3),
        lowest: f32,
        ground: Option<TraceGround>,
    ) -> PathScene<'a> {
        let linear = Mat3::from(world_from_grid.matrix3);
        let grid_from_world = linear.inverse();
        let plane = |ground: TraceGround| PreparedGround {
            height: linear.transpose() * up,
            offset: up.dot(world_from_grid.translation.into()) - lowest,
            albedo: linear_colour(ground.colour),
        };
        let middle = (bounds.0 + bounds.1) * 0.5;
        let radius = (linear * ((bounds.1 - bounds.0) * 0.5)).length().max(f32::MIN_POSITIVE);
        PathScene {
            source,
            levels,
            world_from_grid,
            grid_from_world,
            world_from_normal: grid_from_world.transpose(),
            bounds,
            middle,
            radius,
            up,
            ground: ground.map(plane),
        }
    }

    pub fn ground_albedo(&self) -> Vec3 {
        self.ground.map_or(Vec3::ZERO, |ground| ground.albedo)
    }

    /// Returns the distance of a point from the sculpture's centre, in its radii.
    pub(crate) fn distance_radii(&self, point: Vec3) -> f32 {
        let away = self.world_from_grid.transform_vector3(point - self.middle);
        away.length() / self.radius
    }

    /// Finds the surface that a ray from a surface meets; `direction` is in the world.
    pub(crate) fn meet(&self, origin: Vec3, direction: Vec3, cache: &mut CellCache) -> Met {
        let along = self.grid_from_world * direction;
        let sculpture = match self.levels {
            Some(levels) => self
                .smooth_on(levels, (origin, along), f32::INFINITY, cache)
                .map(|hit| self.smooth_surface(levels, &hit, origin + along * hit.t, cache)),
            None => self
                .voxel_on(origin, along, f32::INFINITY)
                .map(|(voxel, face, t)| self.surface(voxel, face, origin + along * t)),
        };
        if let Some(surface) = sculpture {
            return Met::Sculpture(surface);
        }
        match self.ground_on(origin, direction.dot(self.up)) {
            None => Met::Nothing,
            Some((_, t)) if self.distance_radii(origin + along * t) > OPEN_GROUND_RADII => {
                Met::OpenGround
            }
            Some((ground, t)) => Met::Ground(self.on_ground(ground, origin + along * t)),
        }
    }

    /// Returns whether something lies between `origin` and `origin + direction * reach`.
    pub(crate) fn is_blocked(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        cache: &mut CellCache,
    ) -> bool {
        let along = self.grid_from_world * direction;
        let by_sculpture = match self.levels {
            Some(levels) => self.smooth_on(levels, (origin, along), reach, cache).is_some(),
            None => self.voxel_on(origin, along, reach).is_some(),
        };
        by_sculpture
            || self.ground_on(origin, direction.dot(self.up)).is_some_and(|(_, t)| t < reach)
    }

    /// Finds the surface that the eye sees along a ray of a picture, and its distance. `first` is the result of
    /// [`PathScene::first`] for the ray.
    pub fn seen(
        &self,
        origin: Vec3,
        along: Vec3,
        first: Option<UVec3>,
        cache: &mut CellCache,
    ) -> (Met, f32) {
        let sculpture = first.and_then(|first| match self.levels {
            Some(levels) => {
                let ShadeSource { grid, normals, .. } = self.source;
                let hit = levels.hit((grid, normals), (origin, along), first, cache)?;
                Some((self.smooth_surface(levels, &hit, origin + along * hit.t, cache), hit.t))
            }
            None => {
                let (t, face) = self.entry(origin, along, first);
                Some((self.surface(first, face, origin + along * t), t))
            }
        });
        if let Some((surface, t)) = sculpture {
            return (Met::Sculpture(surface), t);
        }
        let climb = self.ground.map_or(0.0, |ground| ground.height.dot(along));
        let above = self.ground.is_some_and(|ground| ground.height_of(origin) > 0.0);
        match self.ground_on(origin, climb).filter(|_| above) {
            Some((ground, t)) => (Met::Ground(self.on_ground(ground, origin + along * t)), t),
            None => (Met::Nothing, f32::INFINITY),
        }
    }

    /// Returns the first voxel on any ray of a picture, or the first cell of the smooth surface.
    pub fn first(&self, origin: Vec3, along: Vec3) -> Option<UVec3> {
        match self.levels {
            Some(levels) => levels.first_cell(origin, along),
            None => self.voxel_on(origin, along, f32::INFINITY).map(|(voxel, _, _)| voxel),
        }
    }

    /// Returns whether a ray passes through the box around the sculpture. Most rays that leave the sculpture do.
    pub(crate) fn passes_box(&self, origin: Vec3, along: Vec3, reach: f32) -> bool {
        let beyond = if self.levels.is_some() { BEYOND_VOXELS_VX } else { 0.0 };
        let (low, high) = (self.bounds.0 - beyond, self.bounds.1 + beyond);
        let per_t = 1.0 / along;
        let (a, b) = ((low - origin) * per_t, (high - origin) * per_t);
        let (first, last) = (a.min(b).max_element(), a.max(b).min_element());
        first > last.min(reach) || last < 0.0
    }

    fn voxel_on(&self, origin: Vec3, along: Vec3, reach: f32) -> Option<(UVec3, IVec3, f32)> {
        if self.passes_box(origin, along, reach) {
            return None;
        }
        let hit = cast(self.source.grid, origin, along)?;
        (hit.t < reach).then_some((hit.voxel, hit.face, hit.t))
    }

    fn ground_on(&self, origin: Vec3, climb: f32) -> Option<(PreparedGround, f32)> {
        let ground = self.ground?;
        (climb < 0.0).then(|| (ground, (ground.height_of(origin) / -climb).max(0.0)))
    }

    fn on_ground(&self, ground: PreparedGround, point: Vec3) -> PathVertex {
        let start = point + self.grid_from_world * self.up * (1e-4 * self.radius);
        PathVertex { start, normal: self.up, albedo: ground.albedo }
    }

    /// Returns the entry of a ray into the voxel that it is known to meet first, and the face: one without a voxel in
    /// front of it, regardless of rounding at an edge.
    fn entry(&self, origin: Vec3, along: Vec3, voxel: UVec3) -> (f32, IVec3) {
        let near = voxel.as_vec3() + Vec3::select(along.cmplt(Vec3::ZERO), Vec3::ONE, Vec3::ZERO);
        let (mut t, mut face, mut found) = (0.0, -along.signum().as_ivec3(), false);
        for axis in (0..3).filter(|axis| along[*axis] != 0.0) {
            let crossing = (near[axis] - origin[axis]) / along[axis];
            let mut outwards = IVec3::ZERO;
            outwards[axis] = if along[axis] < 0.0 { 1 } else { -1 };
            let is_later = !found || crossing > t;
            if is_later && !self.source.grid.get(voxel.as_ivec3() + outwards) {
                (t, face, found) = (crossing.max(0.0), outwards, true);
            }
        }
        (t, face)
    }

    /// Returns the surface at a point of a face of a voxel.
    fn surface(&self, voxel: UVec3, face: IVec3, point: Vec3) -> PathVertex {
        // Rounding must neither move it off the face nor in front of the adjacent voxel.
        let low = voxel.as_vec3();
        let plane = low + face.max(IVec3::ZERO).as_vec3();
        let within = point.clamp(low + EDGE_VX, low + (1.0 - EDGE_VX));
        let point = Vec3::select(face.cmpeq(IVec3::ZERO), within, plane);
        let face = face.as_vec3();
        let smooth = self.source.normals.normal(voxel);
        let normal = smooth.filter(|normal| normal.dot(face) >= OTHER_SIDE).unwrap_or(face);
        let start = self.clear_of_steps(point, face, normal);
        let normal = (self.world_from_normal * normal).normalize_or(self.up);
        PathVertex { start, normal, albedo: self.albedo(voxel) }
    }

    /// Returns the share of light that a voxel reflects.
    pub fn albedo(&self, voxel: UVec3) -> Vec3 {
        let local = voxel % BRICK_EDGE_VX;
        let material = self.source.material;
        linear_colour(material.rgb(voxel / BRICK_EDGE_VX, local_index(local.x, local.y, local.z)))
    }

    fn clear_of_steps(&self, point: Vec3, face: Vec3, normal: Vec3) -> Vec3 {
        let size = normal.abs();
        let slope = size.x.max(size.y).min(size.x.min(size.y).max(size.z));
        let clearance = CLEARANCE_VX.min(CLEARANCE_PER_SLOPE * slope);
        let near = point + face * LEAST_CLEARANCE_VX;
        if clearance <= LEAST_CLEARANCE_VX {
            return near;
        }
        let free = self.free_distance(near, normal, clearance);
        near + normal * if free < clearance { 0.5 * free } else { clearance }
    }

    /// Returns the distance from `origin` that is free of voxels, up to `reach`. Visits few voxels, so it skips none.
    fn free_distance(&self, origin: Vec3, direction: Vec3, reach: f32) -> f32 {
        let mut cell = origin.floor();
        let step = Vec3::select(direction.cmplt(Vec3::ZERO), Vec3::NEG_ONE, Vec3::ONE);
        let per_t = 1.0 / direction;
        let mut next = (cell + step.max(Vec3::ZERO) - origin) * per_t;
        // A ray parallel to an axis plane never crosses planes of that axis.
        next = Vec3::select(direction.cmpeq(Vec3::ZERO), Vec3::INFINITY, next);
        loop {
            let axis = next.min_position();
            let t = next[axis];
            if t >= reach {
                return reach;
            }
            cell[axis] += step[axis];
            next[axis] += per_t[axis].abs();
            if self.source.grid.get(cell.as_ivec3()) {
                return t;
            }
        }
    }
}
