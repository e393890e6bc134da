//! Grab, twist and pinch: move the clay in a ball, the more the nearer to the centre.
//!
//! From the contents and a [`Grab`] with its mirror images to the voxels that appear, vanish or change colour. Each
//! voxel is mapped once to its source (semi-Lagrangian): the motion is traced backwards in steps that are short
//! relative to the ball, so that the map neither folds nor tears, whatever its length. The smoothed existence bits are
//! interpolated at the source, so that surfaces move by fractions of a voxel. Changes nothing itself.

mod field;
mod flow;
mod motion;
#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod tests;

use glam::Vec3;

use self::flow::Flow;
pub use self::motion::Motion;
use self::motion::Pull;
use crate::refusal::InvalidValue;
use crate::sculpture::history::Contents;
use crate::sculpture::region::VoxelBox;
use crate::tools::brush::BrushUse;
use crate::tools::brush::brush_use::{BrushDirection, OWNER};
use crate::tools::brush::change::{BrushChange, NewClay, Paint, Site};
pub use crate::tools::brush::falloff::Falloff;
use crate::tools::brush::kernel::pulled::Pulled;
use crate::tools::brush::kernel::stamp::Stamp;
use crate::tools::brush::keys::FALLOFF;
pub use crate::tools::brush::limits::{MAX_RADIUS, MIN_RADIUS};
use crate::tools::symmetry::{Symmetry, origin_of};

/// A ball of clay that is moved.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Grab {
    /// Centre of the ball, in voxel coordinates.
    pub centre_vx: Vec3,
    /// Its radius in units of the smallest voxel edge, from [`MIN_RADIUS`] to [`MAX_RADIUS`].
    pub radius: f32,
    /// The motion of the clay.
    pub motion: Motion,
    /// The falloff of the motion.
    pub falloff: Falloff,
}

/// Slope of the motion within one step. Below 1 the step is invertible; far below, the trace is exact enough.
const STEP_SLOPE: f64 = 0.4;

/// Greatest number of steps of a pull: more than the longest pull with the smallest ball of cubic voxels takes.
const MOST_STEPS: usize = 8192;

/// Returns the change of a use that moves a ball of clay. `motion`: maps the direction of the brush to the motion of
/// the clay.
pub fn change(
    used: &BrushUse,
    site: &Site,
    motion: impl Fn(Vec3) -> Motion,
) -> Result<BrushChange, InvalidValue> {
    let Some(ball) = used.ball() else { return Ok(BrushChange::default()) };
    let direction = match ball.frame {
        BrushDirection::Normal(direction) | BrushDirection::Displacement(direction) => direction,
        BrushDirection::None => Vec3::ZERO,
    };
    let motion = motion(direction);
    let falloff = used.get(FALLOFF);
    let grab = Grab { centre_vx: ball.centre_vx, radius: ball.radius, motion, falloff };
    grab.check_steps(site.contents.grid.voxel_size(), direction)?;
    let mut pulled = grab.pulled(site.contents, site.symmetry);
    let Stamp { add, remove, paint } = std::mem::take(&mut pulled.stamp);
    let paint = vec![(paint, Paint::Carried(pulled))];
    Ok(BrushChange { add, remove, new_clay: NewClay::Base, paint })
}

impl Grab {
    /// Returns an error if the motion would take too many steps in voxels of this size, as it does far along the
    /// longest edge of thin voxels.
    fn check_steps(&self, voxel_size: Vec3, direction: Vec3) -> Result<(), InvalidValue> {
        let rule =
            "is too long for so small a ball of such long voxels; enlarge it or pull in parts";
        match self.steps(voxel_size) <= MOST_STEPS {
            true => Ok(()),
            false => Err(InvalidValue::new("pull", rule, direction).of(OWNER)),
        }
    }

    /// Returns the number of steps in which the motion is traced.
    fn steps(&self, voxel_size: Vec3) -> usize {
        let size = voxel_size.as_dvec3();
        if self.motion.is_still() {
            return 0;
        }
        let stretch = size / size.min_element();
        let slope = self.motion.slope(stretch, f64::from(self.radius), self.falloff);
        (slope / STEP_SLOPE).ceil().max(1.0) as usize
    }

    /// Returns all changes that this and its mirror images make in `contents`.
    pub fn pulled(&self, contents: &Contents, symmetry: &Symmetry) -> Pulled {
        let size = contents.grid.voxel_size().as_dvec3();
        let stretch = size / size.min_element();
        let radius = f64::from(self.radius);
        let steps = self.steps(contents.grid.voxel_size());
        if steps == 0 {
            return Pulled::default();
        }
        let images = symmetry.images_in(&contents.frame, contents.grid.voxel_size());
        let origin = origin_of(&images);
        let pulls: Vec<Pull> = images
            .iter()
            .map(|image| Pull {
                centre: image.relative(self.centre_vx.as_dvec3(), origin),
                step: self.motion.step(steps, image),
            })
            .collect();
        // Moved clay stays within the reach of a pull, and so does its source.
        let reach = |pull: &Pull| {
            let (start, half) = (pull.centre + origin, radius / stretch);
            let end = start + pull.displacement() * steps as f64;
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
        // Pulls that do not meet are computed separately.
        let parts = boxes.into_iter().enumerate().filter_map(|(i, reach)| {
            let pulls = if apart { &pulls[i..=i] } else { &pulls[..] };
            flow(pulls).carry_out(contents, reach)
        });
        Pulled::union(parts.collect())
    }
}
