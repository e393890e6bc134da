//! Brushes that move the surface: inflate, flatten, scrape, fill, draw and crease.
//!
//! From a grid and a brush to the voxels that appear and vanish. Clay is added where the nearest clay is nearer than
//! the height by which the brush raises the surface there, and removed where the nearest empty space is nearer than the
//! depth by which it is lowered. Draw and crease search for the surface along the one direction in which they move it.
//! Distances are those between voxels less half of one, where the surface is. Changes nothing itself.

use glam::{IVec3, Vec3};

use super::ball::BallImage;
use super::distance::Distances;
use crate::sculpture::Grid;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::brick::{BRICK_EDGE_VX, BrickKind};
use crate::sculpture::region::{ListedBricks, VoxelBox};
use crate::tools::brush::BrushUse;
use crate::tools::brush::brush_use::BrushDirection;
use crate::tools::brush::change::{BrushChange, Site};
use crate::tools::brush::falloff::Falloff;
use crate::tools::brush::kernel::ball_filter;
use crate::tools::brush::kernel::rays::{Filtered, Near};
use crate::tools::brush::kernel::stamp::Stamp;
use crate::tools::brush::keys::{FALLOFF, HEIGHT, STRENGTH};
use crate::tools::symmetry::{Symmetry, SymmetryTransform, origin_of};

/// Greatest distance from the surface at which clay is added or removed to reach a plane, in the same units.
const PLANE_REACH: f32 = 12.0;

/// The target of the surface's motion.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum OffsetTarget {
    /// Along its own normals, by this distance; positive outwards.
    Along(f32),
    /// Towards a plane, from one side or both.
    Plane {
        /// The outward normal.
        normal: Vec3,
        /// Share of the distance to the plane, 0 to 1.
        strength: f32,
        /// Whether clay in front of the plane is removed.
        lowers: bool,
        /// Whether space behind the plane is filled.
        raises: bool,
    },
    /// Along one direction, by a height.
    Drawn {
        /// The outward normal.
        normal: Vec3,
        /// The height along the normal.
        height: f32,
        /// The profile of the height over the ball.
        profile: OffsetProfile,
    },
}

/// The profile of a displacement over the ball.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum OffsetProfile {
    /// The falloff.
    Falloff,
    /// The square of the falloff.
    Squared,
}

/// A movement of the surface along one direction.
#[derive(Clone, Copy)]
struct Pull {
    /// The unit vector from a voxel that may change to the surface that moves onto it.
    direction: Vec3,
    /// The displacement of the centre.
    height: f32,
    profile: OffsetProfile,
}

/// Shortest step of the search for the surface along a direction, in units of the smallest edge.
const LOOK: f32 = 0.25;
/// Largest rounding error of a distance.
const ROUNDING: f32 = 1e-3;

/// A brush placed in a grid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Offset {
    /// Centre of the ball, in voxel coordinates.
    pub centre_vx: Vec3,
    /// Radius in units of the smallest edge.
    pub radius: f32,
    /// The falloff of the effect from the centre to the rim.
    pub falloff: Falloff,
    /// The target of the surface's motion.
    pub target: OffsetTarget,
}

impl BallImage {
    /// Returns whether the pull draws a surface point to `v` or beyond: the first one along `pull.direction`, at least
    /// `min_distance` away, from which `distances` are counted.
    fn is_drawn_from(
        &self,
        distances: &Distances,
        v: IVec3,
        min_distance: f32,
        pull: Pull,
    ) -> bool {
        let Pull { direction, height, profile } = pull;
        let p = self.relative(v);
        let share = |p: Vec3| match profile {
            OffsetProfile::Falloff => self.share(p),
            OffsetProfile::Squared => self.share(p) * self.share(p),
        };
        // On the line through `v`, the point nearest to the centre moves farthest.
        let along = p.x * direction.x + p.y * direction.y + p.z * direction.z;
        let furthest = height * share(p - direction * along) + ROUNDING;
        if min_distance > furthest || p.length_squared() > self.radius * self.radius {
            return false;
        }
        let mut distance = min_distance;
        loop {
            let left = distances.at(v, direction * distance / self.edges.as_vec3());
            if left <= ROUNDING {
                return distance <= height * share(p + direction * distance) + ROUNDING;
            }
            if distance >= furthest {
                return false;
            }
            distance = (distance + left.max(LOOK)).min(furthest);
        }
    }
}

/// Returns the change of a use in a ball. `target`: maps the outward normal to the target of the surface.
pub fn change(used: &BrushUse, site: &Site, target: impl Fn(Vec3) -> OffsetTarget) -> BrushChange {
    let Some(offset) = Offset::of(used, target) else { return BrushChange::default() };
    BrushChange::of_clay(offset.stamp(site.surface, site.symmetry))
}

/// Returns the change of a use that moves the surface to the plane through the centre of the ball, by its strength.
pub(crate) fn to_plane(used: &BrushUse, site: &Site, lowers: bool, raises: bool) -> BrushChange {
    let strength = used.get(STRENGTH);
    change(used, site, |normal| OffsetTarget::Plane { normal, strength, lowers, raises })
}

/// Moves the surface to the plane from both sides, and then applies a filter to the voxels where the brush has at least
/// half of its effect at the centre. `margin_vx`: how far around a voxel the filter reads.
pub(crate) fn to_plane_then(
    used: &BrushUse,
    site: &Site,
    margin_vx: u32,
    filter: impl Fn(&Near) -> Filtered,
) -> BrushChange {
    let strength = used.get(STRENGTH);
    let plane = |normal| OffsetTarget::Plane { normal, strength, lowers: true, raises: true };
    let Some(offset) = Offset::of(used, plane) else { return BrushChange::default() };
    let levelled = offset.stamp(site.surface, site.symmetry);
    let balls = offset.balls(site.surface, site.symmetry);
    BrushChange::of_clay(ball_filter::after(&levelled, &balls, site.surface, margin_vx, filter))
}

/// Returns the change of a use that moves the surface along the normal, by its height.
pub(crate) fn along_normal(used: &BrushUse, site: &Site, profile: OffsetProfile) -> BrushChange {
    let height = used.get(HEIGHT);
    change(used, site, |normal| OffsetTarget::Drawn { normal, height, profile })
}

impl Offset {
    /// Returns the brush of a use in a ball. `target`: maps the outward normal to the target of the surface.
    fn of(used: &BrushUse, target: impl Fn(Vec3) -> OffsetTarget) -> Option<Offset> {
        let ball = used.ball()?;
        let target = match ball.frame {
            BrushDirection::Normal(normal) => target(normal.normalize_or(Vec3::Y)),
            _ => target(Vec3::Y),
        };
        let falloff = used.get(FALLOFF);
        Some(Offset { centre_vx: ball.centre_vx, radius: ball.radius, falloff, target })
    }

    /// Returns the changes that this and its mirror images make in `grid`.
    pub fn stamp(&self, grid: &Grid, symmetry: &Symmetry) -> Stamp {
        Stamp::union(self.balls(grid, symmetry).iter().map(|ball| self.one(grid, ball)))
    }

    /// Returns the ball and its mirror images.
    fn balls(&self, grid: &Grid, symmetry: &Symmetry) -> Vec<BallImage> {
        let dims = grid.dims();
        let size = grid.voxel_size().as_dvec3();
        let edges = size / size.min_element();
        let images = symmetry.images(dims, grid.voxel_size());
        let origin = origin_of(&images);
        let normal = match self.target {
            OffsetTarget::Plane { normal, .. } | OffsetTarget::Drawn { normal, .. } => normal,
            OffsetTarget::Along(_) => Vec3::Y,
        };
        let ball = |image: &SymmetryTransform| BallImage {
            origin,
            centre: image.relative(self.centre_vx.as_dvec3(), origin),
            edges,
            radius: self.radius,
            falloff: self.falloff,
            normal: image.normal(normal.as_dvec3()).as_vec3(),
        };
        images.iter().map(ball).collect()
    }

    fn one(&self, grid: &Grid, ball: &BallImage) -> Stamp {
        let reach = match self.target {
            OffsetTarget::Along(height) | OffsetTarget::Drawn { height, .. } => height.abs() + 1.0,
            OffsetTarget::Plane { .. } => PLANE_REACH + 1.0,
        };
        let edges = ball.edges.as_vec3();
        let around = (Vec3::splat(reach) / edges).ceil().as_ivec3();
        let Some(bounds) = self.bounds(grid, ball, around) else { return Stamp::default() };
        let block = BitBlock::of_grid(grid, bounds.min - around - 1, bounds.max + around + 1);
        let (raises, lowers) = match self.target {
            OffsetTarget::Along(height) | OffsetTarget::Drawn { height, .. } => {
                (height > 0.0, height < 0.0)
            }
            OffsetTarget::Plane { raises, lowers, strength, .. } => {
                (raises && strength > 0.0, lowers && strength > 0.0)
            }
        };
        // Beyond the grid's border there is empty space, which counts.
        let wide = VoxelBox { min: bounds.min - 1, max: bounds.max + 1 };
        let bricks = |block: BitBlock| ListedBricks::new(block.bricks(grid.brick_dims()));
        let mut stamp = Stamp::default();
        if raises {
            let to_clay = Distances::new(&block, true, wide, reach, edges);
            let added = changed(bounds, &to_clay, |v, away| self.adds(ball, &to_clay, v, away));
            stamp.add = bricks(added);
        }
        if lowers {
            let to_room = Distances::new(&block, false, wide, reach, edges);
            let removed =
                changed(bounds, &to_room, |v, away| self.removes(ball, &to_room, v, away));
            stamp.remove = bricks(removed);
        }
        stamp
    }

    /// Returns the box of the voxels that may change: those of the ball near a surface. `None` if there are none.
    fn bounds(&self, grid: &Grid, ball: &BallImage, around: IVec3) -> Option<VoxelBox> {
        let reached = ball.bounds(grid);
        if reached.is_empty() {
            return None;
        }
        let edge = BRICK_EDGE_VX as i32;
        let low = (reached.min - around).div_euclid(IVec3::splat(edge));
        let high = (reached.max + around - 1).div_euclid(IVec3::splat(edge));
        let dims = grid.brick_dims().as_ivec3();
        let kind = |b: IVec3| {
            let inside = b.cmpge(IVec3::ZERO).all() && b.cmplt(dims).all();
            inside.then(|| grid.brick_kind(grid.brick_index(b.as_uvec3())))
        };
        let mut near = VoxelBox { min: IVec3::MAX, max: IVec3::MIN };
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for b in (low.x..=high.x).map(|x| IVec3::new(x, y, z)) {
                    let here = kind(b).unwrap_or(BrickKind::Empty);
                    let beside = |axis: IVec3| {
                        [b - axis, b + axis]
                            .into_iter()
                            .any(|b| kind(b) == Some(BrickKind::Empty) || kind(b).is_none())
                    };
                    let surface = here == BrickKind::Mixed
                        || here == BrickKind::Full && IVec3::AXES.into_iter().any(beside);
                    if surface {
                        near.min = near.min.min(b * edge - around);
                        near.max = near.max.max((b + 1) * edge + around);
                    }
                }
            }
        }
        let bounds = if near.min.x == i32::MAX { return None } else { reached.intersect(near) };
        (!bounds.is_empty()).then_some(bounds)
    }

    /// Returns whether clay is added at an empty voxel; `away`: its distance from the nearest clay.
    #[inline(always)]
    fn adds(&self, ball: &BallImage, to_clay: &Distances, v: IVec3, away: f32) -> bool {
        let p = ball.relative(v);
        let share = ball.share(p);
        match self.target {
            OffsetTarget::Along(height) => away < height * share,
            OffsetTarget::Plane { strength, .. } => {
                let share = share * strength;
                away < PLANE_REACH
                    && (share - 1.0) * away - share * ball.height(p) > 0.0
                    && faces(to_clay, v, ball.normal)
            }
            OffsetTarget::Drawn { height, profile, .. } => {
                let pull = Pull { direction: -ball.normal, height, profile };
                ball.is_drawn_from(to_clay, v, away, pull)
            }
        }
    }

    /// Returns whether a voxel of clay is removed; `away`: its distance from the nearest empty space.
    #[inline(always)]
    fn removes(&self, ball: &BallImage, to_room: &Distances, v: IVec3, away: f32) -> bool {
        let p = ball.relative(v);
        let share = ball.share(p);
        match self.target {
            OffsetTarget::Along(height) => away < -height * share,
            OffsetTarget::Plane { strength, .. } => {
                let share = share * strength;
                (1.0 - share) * away.min(PLANE_REACH) - share * ball.height(p) <= 0.0
            }
            OffsetTarget::Drawn { height, profile, .. } => {
                let pull = Pull { direction: ball.normal, height: -height, profile };
                ball.is_drawn_from(to_room, v, away, pull)
            }
        }
    }
}

/// Returns whether the nearest clay lies on the near side. False where it lies on the far side, as behind a wall.
fn faces(to_clay: &Distances, v: IVec3, normal: Vec3) -> bool {
    let away = |v: IVec3| to_clay.near(v).sqrt();
    let mut outwards = 0.0;
    for (axis, step) in IVec3::AXES.into_iter().enumerate() {
        outwards += normal[axis] * (away(v + step) - away(v - step));
    }
    outwards >= -0.5
}

/// Returns the voxels of a box for which `is` holds, given each voxel and its distance from the surface. Voxels at the
/// distance 0 are on the other side.
fn changed(
    bounds: VoxelBox,
    distances: &Distances,
    is: impl Fn(IVec3, f32) -> bool + Sync,
) -> BitBlock {
    let empty = BitBlock::empty(bounds.min, bounds.max);
    let origin = empty.origin();
    empty.map_rows_in_parallel(|y, z, row| {
        let start = origin + IVec3::new(0, y, z);
        let inside = bounds.min.y <= start.y && start.y < bounds.max.y;
        if !inside || start.z < bounds.min.z || start.z >= bounds.max.z {
            return;
        }
        let squared = distances.row_from(IVec3::new(bounds.min.x, start.y, start.z));
        for (x, squared) in (bounds.min.x..bounds.max.x).zip(squared) {
            if *squared > 0.0 && is(IVec3::new(x, start.y, start.z), squared.sqrt() - 0.5) {
                let place = (x - origin.x) as usize;
                row[place / 64] |= 1 << (place % 64);
            }
        }
    })
}
