//! Grab, twist and pinch: take hold of a ball of clay and move it, the more the nearer to the middle.
//!
//! From the contents and a [`Grab`] with its mirror images to the voxels that appear, vanish or change colour. Each
//! voxel looks up, once, where it comes from: the motion is followed backwards in steps that are short against the ball,
//! so that the map neither folds nor tears, whatever the length. There the smoothed existence bits are interpolated, so
//! that surfaces move by fractions of a voxel. Changes nothing itself.

mod field;
mod flow;
mod motion;
#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod tests;

use glam::{UVec3, Vec3};

use self::flow::Flow;
pub use self::motion::Motion;
use self::motion::Pull;
use crate::sculpture::Brick;
use crate::sculpture::Rgb;
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_VOXELS, local_index};
use crate::sculpture::history::Contents;
use crate::sculpture::region::VoxelBox;
use crate::tools::brush::brush_use::Frame;
use crate::tools::brush::change::{Change, NewClay, Paint, Site};
use crate::tools::brush::kernel::stamp::Stamp;
use crate::tools::brush::keys::FALLOFF;
use crate::tools::brush::{BrushError, BrushUse};
use crate::tools::symmetry::{Symmetry, origin_of};

/// Smallest radius, in units of the smallest edge of a voxel: shorter steps would never end.
pub const MIN_RADIUS: f32 = 0.5;
/// Largest radius, in units of the smallest edge of a voxel: what is looked up stays below 200 MB.
pub const MAX_RADIUS: f32 = 96.0;
/// Furthest pull, in voxels along each axis.
pub const MAX_PULL_VX: f32 = 192.0;

/// Furthest twist, in degrees either way.
pub const MAX_TWIST_DEG: f32 = 360.0;

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

    /// The share of the pull at `r`, from its square. 0 from 1 on.
    #[inline(always)]
    pub(super) fn at(self, squared: f32) -> f32 {
        match self {
            Falloff::Smooth => {
                let left = (1.0 - squared).max(0.0);
                left * left
            }
            Falloff::Sharp => {
                let left = (1.0 - squared.sqrt()).max(0.0);
                left * left
            }
            Falloff::Flat => {
                let t = (2.0 * (1.0 - squared.sqrt()).max(0.0)).min(1.0);
                t * t * (3.0 - 2.0 * t)
            }
        }
    }

    /// The same, and its slope against the square of `r`.
    #[inline(always)]
    pub(super) fn at_with_slope(self, squared: f32) -> (f32, f32) {
        // In the middle the slope of a tip has no bound; what it is multiplied with there is 0.
        let r = squared.sqrt().max(1e-6);
        let slope = match self {
            Falloff::Smooth => -2.0 * (1.0 - squared).max(0.0),
            Falloff::Sharp => -(1.0 - r).max(0.0) / r,
            Falloff::Flat => {
                let t = (2.0 * (1.0 - r).max(0.0)).min(1.0);
                -6.0 * t * (1.0 - t) / r
            }
        };
        (self.at(squared), slope)
    }

    /// Greatest product of the share and the distance from the middle.
    pub(super) fn widest_twist(self) -> f64 {
        match self {
            Falloff::Smooth => 0.287,
            Falloff::Sharp => 0.149,
            Falloff::Flat => 0.541,
        }
    }

    /// Steepest slope of a twist by 1.
    pub(super) fn steepest_twist(self) -> f64 {
        match self {
            Falloff::Smooth | Falloff::Sharp => 1.0,
            Falloff::Flat => 2.0,
        }
    }

    /// Steepest slope of a pinch of strength 1.
    pub(super) fn steepest_pinch(self) -> f64 {
        match self {
            Falloff::Smooth => 4.0,
            Falloff::Sharp => 2.0,
            Falloff::Flat => 12.0,
        }
    }

    /// Its steepest slope.
    pub(super) fn steepest(self) -> f64 {
        match self {
            // At r = 1 / sqrt(3).
            Falloff::Smooth => 1.54,
            Falloff::Sharp => 2.0,
            Falloff::Flat => 3.0,
        }
    }
}

/// A ball of clay that is moved.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Grab {
    /// Middle of the ball, in voxel coordinates.
    pub centre_vx: Vec3,
    /// Its radius in units of the smallest edge of a voxel, from [`MIN_RADIUS`] to [`MAX_RADIUS`].
    pub radius: f32,
    /// Where the clay in it goes.
    pub motion: Motion,
    /// How the motion falls off.
    pub falloff: Falloff,
}

/// Slope of the motion within one step: below 1 the step can be undone, far below it is followed exactly enough.
const STEP_SLOPE: f64 = 0.4;

/// Most steps of a pull: more than the longest pull at the smallest ball of cubic voxels takes.
const MOST_STEPS: usize = 8192;

/// The change of a use that moves a ball of clay. `motion`: of the clay, from the direction in which the brush works.
pub fn change(
    used: &BrushUse,
    site: &Site,
    motion: impl Fn(Vec3) -> Motion,
) -> Result<Change, BrushError> {
    let Some(ball) = used.ball() else { return Ok(Change::default()) };
    let motion = match ball.frame {
        Frame::Normal(way) | Frame::Displacement(way) => motion(way),
        Frame::None => motion(Vec3::ZERO),
    };
    let falloff = used.get(FALLOFF);
    let grab = Grab { centre_vx: ball.centre_vx, radius: ball.radius, motion, falloff };
    grab.check_steps(site.contents.grid.voxel_size())?;
    let mut pulled = grab.pulled(site.contents, site.symmetry);
    let Stamp { add, remove, paint } = std::mem::take(&mut pulled.stamp);
    let paint = vec![(paint, Paint::Carried(pulled))];
    Ok(Change { add, remove, new_clay: NewClay::Base, paint })
}

impl Grab {
    /// An error if the motion would take too many steps in voxels of this size: if it leads far along the longest edge of
    /// thin voxels.
    fn check_steps(&self, voxel_size: Vec3) -> Result<(), BrushError> {
        let rule =
            "is too long for so small a ball of such long voxels; enlarge it or pull in parts";
        match self.steps(voxel_size) <= MOST_STEPS {
            true => Ok(()),
            false => Err(BrushError::new("pull", rule)),
        }
    }

    /// In how many steps the motion is followed.
    fn steps(&self, voxel_size: Vec3) -> usize {
        let size = voxel_size.as_dvec3();
        if self.motion.is_still() {
            return 0;
        }
        let stretch = size / size.min_element();
        let slope = self.motion.slope(stretch, f64::from(self.radius), self.falloff);
        (slope / STEP_SLOPE).ceil().max(1.0) as usize
    }

    /// All that this and its mirror images change in `contents`.
    pub fn pulled(&self, contents: &Contents, symmetry: &Symmetry) -> Pulled {
        let (dims, size) = (contents.grid.dims(), contents.grid.voxel_size().as_dvec3());
        let stretch = size / size.min_element();
        let radius = f64::from(self.radius);
        let steps = self.steps(contents.grid.voxel_size());
        if steps == 0 {
            return Pulled::default();
        }
        let images = symmetry.images(dims, contents.grid.voxel_size());
        let origin = origin_of(&images);
        let pulls: Vec<Pull> = images
            .iter()
            .map(|image| Pull {
                centre: image.relative(self.centre_vx.as_dvec3(), origin),
                step: self.motion.step(steps, image),
            })
            .collect();
        // Moved clay stays within the reach of a pull, and so does the place from which it comes.
        let reach = |pull: &Pull| {
            let (start, half) = (pull.centre + origin, radius / stretch);
            let end = start + pull.way() * steps as f64;
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
        let falloff = self.falloff;
        let flow = |pulls| Flow { pulls, origin, steps, stretch, radius, falloff };
        // Pulls that do not meet move clay one by one.
        let parts = boxes.into_iter().enumerate().filter_map(|(i, reach)| {
            let pulls = if apart { &pulls[i..=i] } else { &pulls[..] };
            flow(pulls).carry_out(contents, reach)
        });
        Pulled::union(parts.collect())
    }
}

/// The colours that voxels of a brick come with, where its mask in the list has them.
pub(super) type Colours = (UVec3, Box<[Rgb; BRICK_VOXELS as usize]>);

/// The change that a pull makes.
#[derive(Default)]
pub struct Pulled {
    /// Voxels to remove, to add and to recolour, among them those added.
    pub stamp: Stamp,
    /// In the order of the bricks of `stamp.paint`.
    pub(super) colours: Vec<Colours>,
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
