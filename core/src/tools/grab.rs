//! Grab: takes hold of a ball of clay and pulls it along, the more the nearer to the middle.
//!
//! From the contents and a [`Grab`] with its mirror images to the voxels that appear, vanish or change colour. Each
//! voxel looks up, once, where it comes from: the pull is followed backwards in steps that are short against the ball,
//! so that the map neither folds nor tears, whatever the length. There the smoothed existence bits are interpolated, so
//! that surfaces move by fractions of a voxel. Changes nothing itself.

use glam::{DVec3, IVec3, UVec3, Vec3};
use rayon::prelude::*;

use super::grab_field::{FINE, Field, MARGIN_VX};
use super::spray::Stamp;
use super::symmetry::Symmetry;
use crate::sculpture::Brick;
use crate::sculpture::Rgb;
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_VOXELS, local_coords, local_index};
use crate::sculpture::history::Contents;
use crate::sculpture::region::{ListedBricks, VoxelBox};

/// Smallest radius, in units of the smallest edge of a voxel: shorter steps would never end.
pub const MIN_RADIUS: f32 = 0.5;
/// Largest radius, in units of the smallest edge of a voxel: what is looked up stays below 200 MB.
pub const MAX_RADIUS: f32 = 96.0;
/// Furthest pull, in voxels along each axis.
pub const MAX_PULL_VX: f32 = 192.0;

/// How the pull falls off from the middle of the ball (0) to its rim (1).
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Falloff {
    /// (1 - r^2)^2
    #[default]
    Smooth,
    /// (1 - r)^2: a tip
    Sharp,
    /// 1 up to half the radius, then smoothly to 0: as if by a hand
    Flat,
}

impl Falloff {
    /// All of them, in the order in which interfaces offer them.
    pub const ALL: [Falloff; 3] = [Falloff::Smooth, Falloff::Sharp, Falloff::Flat];

    /// Its name in the text form and the interface.
    pub const fn name(self) -> &'static str {
        match self {
            Falloff::Smooth => "smooth",
            Falloff::Sharp => "sharp",
            Falloff::Flat => "flat",
        }
    }

    /// The share of the pull at `r`.
    fn at(self, r: f64) -> f64 {
        let left = (1.0 - r).max(0.0);
        match self {
            Falloff::Smooth => (left * (1.0 + r)).powi(2),
            Falloff::Sharp => left * left,
            Falloff::Flat => {
                let t = (2.0 * left).min(1.0);
                t * t * (3.0 - 2.0 * t)
            }
        }
    }

    /// Its steepest slope.
    fn steepest(self) -> f64 {
        match self {
            // At r = 1 / sqrt(3).
            Falloff::Smooth => 1.54,
            Falloff::Sharp => 2.0,
            Falloff::Flat => 3.0,
        }
    }
}

/// A pull at a ball of clay.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Grab {
    /// Middle of the ball, in voxel coordinates.
    pub centre_vx: Vec3,
    /// Its radius in units of the smallest edge of a voxel, from [`MIN_RADIUS`] to [`MAX_RADIUS`].
    pub radius: f32,
    /// How far the middle is pulled, in voxels; at most [`MAX_PULL_VX`] along each axis.
    pub by_vx: Vec3,
    /// How the pull falls off.
    pub falloff: Falloff,
}

/// Slope of the pull within one step: below 1 the step can be undone, far below it is followed exactly enough.
const STEP_SLOPE: f64 = 0.4;
/// Approximations of where a step comes from; each is [`STEP_SLOPE`] times as far off as the one before.
const ROUNDS: usize = 3;

impl Grab {
    /// An error that names the first invalid field, if there is one.
    pub fn check(&self) -> Result<(), &'static str> {
        if !self.centre_vx.is_finite() || self.centre_vx.abs().max_element() > 1e6 {
            return Err("the middle of the ball must lie near the grid");
        }
        if !(self.radius >= MIN_RADIUS && self.radius <= MAX_RADIUS) {
            return Err("the radius of the ball must be from 0.5 to 96 voxels");
        }
        if !(self.by_vx.is_finite() && self.by_vx.abs().max_element() <= MAX_PULL_VX) {
            return Err("the pull must be at most 192 voxels along each axis");
        }
        Ok(())
    }

    /// All that this and its mirror images change in `contents`.
    pub fn pulled(&self, contents: &Contents, symmetry: &Symmetry) -> Pulled {
        let (dims, size) = (contents.grid.dims(), contents.grid.voxel_size().as_dvec3());
        let stretch = size / size.min_element();
        let radius = f64::from(self.radius);
        let steepest = self.falloff.steepest() / radius;
        let by_vx = self.by_vx.as_dvec3();
        let steps = ((by_vx * stretch).length() * steepest / STEP_SLOPE).ceil() as usize;
        if steps == 0 {
            return Pulled::default();
        }
        let origin = DVec3::from(symmetry.planes(dims).map(|plane| plane.map_or(0.0, f64::from)));
        let pulls: Vec<Pull> = symmetry
            .images(dims)
            .iter()
            .map(|image| {
                let signs = image.vector(Vec3::ONE).as_dvec3();
                Pull {
                    centre: (self.centre_vx.as_dvec3() - origin) * signs,
                    step: by_vx / steps as f64 * signs,
                }
            })
            .collect();
        let flow = Flow { pulls: &pulls, origin, steps, stretch, radius, falloff: self.falloff };
        // What a pull moves stays within its reach, and so does where it comes from.
        let reach = |pull: &Pull| {
            let (start, half) = (pull.centre + origin, radius / stretch);
            let end = start + pull.step * steps as f64;
            VoxelBox {
                min: (start.min(end) - half).floor().as_ivec3(),
                max: (start.max(end) + half).ceil().as_ivec3(),
            }
        };
        let mut boxes: Vec<VoxelBox> = pulls.iter().map(reach).collect();
        let apart = (1..boxes.len())
            .all(|i| boxes[..i].iter().all(|other| other.intersect(boxes[i]).is_empty()));
        if !apart {
            let join = |a: VoxelBox, b: VoxelBox| VoxelBox {
                min: a.min.min(b.min),
                max: a.max.max(b.max),
            };
            boxes = boxes.into_iter().reduce(join).into_iter().collect();
        }
        let grid = VoxelBox::of_grid(&contents.grid);
        let part = |reach: VoxelBox| {
            let arrives = reach.intersect(grid);
            let margin = |bounds: VoxelBox| VoxelBox {
                min: bounds.min - MARGIN_VX,
                max: bounds.max + MARGIN_VX,
            };
            (!arrives.is_empty()).then(|| {
                let field = Field::new(&contents.grid, margin(reach).intersect(margin(grid)));
                flow.carry_out(contents, &field, arrives)
            })
        };
        Pulled::union(boxes.into_iter().filter_map(part).collect())
    }
}

/// One of several pulls at once, relative to the origin of the flow.
struct Pull {
    centre: DVec3,
    step: DVec3,
}

/// The motion of all pulls together.
///
/// Positions are relative to the mirror planes: what is mirrored differs in signs only and is rounded alike, so that the
/// result is symmetric to the voxel.
struct Flow<'a> {
    pulls: &'a [Pull],
    /// In voxel coordinates.
    origin: DVec3,
    steps: usize,
    stretch: DVec3,
    radius: f64,
    falloff: Falloff,
}

/// The colours that voxels of a brick come with, where its mask in the list has them.
type Colours = (UVec3, Box<[Rgb; BRICK_VOXELS as usize]>);

/// What a pull changes.
#[derive(Default)]
pub struct Pulled {
    /// Voxels to remove, to add and to recolour, among them those added.
    pub stamp: Stamp,
    /// In the order of the bricks of `stamp.paint`.
    colours: Vec<Colours>,
}

impl Pulled {
    /// The colour of a voxel of `stamp.paint`.
    pub fn colour(&self, v: UVec3) -> Option<Rgb> {
        let brick = v / BRICK_EDGE_VX;
        let key = |b: UVec3| (b.z, b.y, b.x);
        let place = self.colours.binary_search_by_key(&key(brick), |(b, _)| key(*b)).ok()?;
        let [x, y, z] = (v % BRICK_EDGE_VX).to_array();
        Some(self.colours[place].1[local_index(x, y, z) as usize])
    }

    /// Voxels in several parts come from the same place in each.
    fn union(parts: Vec<Pulled>) -> Pulled {
        let (stamps, colours): (Vec<_>, Vec<_>) =
            parts.into_iter().map(|part| (part.stamp, part.colours)).unzip();
        let masks: Vec<Vec<(UVec3, Brick)>> =
            stamps.iter().map(|stamp| stamp.paint.bricks().to_vec()).collect();
        let mut all: Vec<(Colours, Brick)> = colours
            .into_iter()
            .zip(masks)
            .flat_map(|(colours, masks)| colours.into_iter().zip(masks.into_iter().map(|m| m.1)))
            .collect();
        all.sort_by_key(|((b, _), _)| (b.z, b.y, b.x));
        let mut merged: Vec<Colours> = Vec::new();
        for ((brick, colours), mask) in all {
            match merged.last_mut() {
                Some((last, kept)) if *last == brick => {
                    mask.for_each(|i| kept[i as usize] = colours[i as usize]);
                }
                _ => merged.push((brick, colours)),
            }
        }
        Pulled { stamp: Stamp::union(stamps), colours: merged }
    }
}

impl Flow<'_> {
    /// How far what is at `at` moves in a step. Images are added as a mirror plane pairs them.
    fn shift(&self, at: DVec3, step: usize, pulls: &[Pull]) -> DVec3 {
        match pulls {
            [pull] => {
                let centre = pull.centre + pull.step * step as f64;
                let distance = ((at - centre) * self.stretch).length() / self.radius;
                if distance < 1.0 { pull.step * self.falloff.at(distance) } else { DVec3::ZERO }
            }
            _ => {
                let (first, second) = pulls.split_at(pulls.len() / 2);
                self.shift(at, step, first) + self.shift(at, step, second)
            }
        }
    }

    /// Whether anything within `beyond` of `p`, in units of the smallest edge, is ever reached by a ball.
    fn reaches(&self, p: DVec3, beyond: f64) -> bool {
        self.pulls.iter().any(|pull| {
            let from = (p - pull.centre) * self.stretch;
            let along = pull.step * self.stretch * self.steps as f64;
            let share = (from.dot(along) / along.length_squared()).clamp(0.0, 1.0);
            (from - along * share).length() < self.radius + beyond
        })
    }

    /// How far away what arrives at the middle of a voxel comes from, in units of 1 / [`FINE`] voxel.
    fn source(&self, v: UVec3) -> IVec3 {
        let p = v.as_dvec3() + 0.5 - self.origin;
        if !self.reaches(p, 0.0) {
            return IVec3::ZERO;
        }
        let mut arrived = p;
        for step in (0..self.steps).rev() {
            let mut from = arrived - self.shift(arrived, step + 1, self.pulls);
            for _ in 0..ROUNDS {
                from = arrived - self.shift(from, step, self.pulls);
            }
            arrived = from;
        }
        ((arrived - p) * f64::from(FINE)).round().as_ivec3()
    }

    fn carry_out(&self, contents: &Contents, field: &Field, arrives: VoxelBox) -> Pulled {
        let edge = BRICK_EDGE_VX as i32;
        let (low, high) = (arrives.min / edge, (arrives.max + edge - 1) / edge);
        let bricks: Vec<UVec3> = (low.z..high.z)
            .flat_map(|z| {
                (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| [x, y, z]))
            })
            .map(|b| IVec3::from(b).as_uvec3())
            .collect();
        let done: Vec<Option<Moved>> =
            bricks.par_iter().map(|b| self.move_brick(contents, field, *b, arrives)).collect();
        let list = |part: fn(&Moved) -> Brick| {
            let of = |(b, moved): (&UVec3, &Option<Moved>)| {
                let mask = part(moved.as_ref()?);
                (!mask.is_empty()).then_some((*b, mask))
            };
            ListedBricks::new(bricks.iter().zip(&done).filter_map(of).collect())
        };
        let stamp = Stamp {
            remove: list(|moved| moved.remove),
            add: list(|moved| moved.add),
            paint: list(|moved| moved.paint),
        };
        let colours = bricks.into_iter().zip(done).filter_map(|(b, moved)| {
            let moved = moved.filter(|moved| !moved.paint.is_empty())?;
            Some((b, moved.colours?))
        });
        let colours = colours.collect();
        Pulled { stamp, colours }
    }

    /// None if nothing changes in the brick.
    fn move_brick(
        &self,
        contents: &Contents,
        field: &Field,
        b: UVec3,
        arrives: VoxelBox,
    ) -> Option<Moved> {
        let half = DVec3::splat(0.5 * f64::from(BRICK_EDGE_VX));
        let middle = (b * BRICK_EDGE_VX).as_dvec3() + half - self.origin;
        if !self.reaches(middle, (half * self.stretch).length()) {
            return None;
        }
        let coloured = contents.material.depth().bytes() > 0;
        let before = *contents.grid.brick(b);
        let mut moved = Moved::default();
        for local in 0..BRICK_VOXELS {
            let [x, y, z] = local_coords(local);
            let v = b * BRICK_EDGE_VX + UVec3::new(x, y, z);
            // The field is known for these only.
            if !arrives.contains(v.as_ivec3()) {
                continue;
            }
            let offset = self.source(v);
            if offset == IVec3::ZERO {
                continue;
            }
            let (exists, nearest) = field.sample(v, offset);
            let existed = before.get(x, y, z);
            match (existed, exists) {
                (true, false) => moved.remove.set(x, y, z, true),
                (false, true) => moved.add.set(x, y, z, true),
                _ => {}
            }
            if coloured && exists {
                let colour = contents.rgb(nearest);
                let now = if existed { contents.rgb(v) } else { contents.material.base() };
                if colour != now {
                    moved.paint.set(x, y, z, true);
                    let none = || Box::new([Rgb::default(); BRICK_VOXELS as usize]);
                    moved.colours.get_or_insert_with(none)[local as usize] = colour;
                }
            }
        }
        let some = [moved.remove, moved.add, moved.paint].iter().any(|mask| !mask.is_empty());
        some.then_some(moved)
    }
}

/// What changes in one brick.
struct Moved {
    remove: Brick,
    add: Brick,
    paint: Brick,
    colours: Option<Box<[Rgb; BRICK_VOXELS as usize]>>,
}

impl Default for Moved {
    fn default() -> Moved {
        Moved { remove: Brick::EMPTY, add: Brick::EMPTY, paint: Brick::EMPTY, colours: None }
    }
}
