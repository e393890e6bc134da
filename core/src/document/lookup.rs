//! Finds voxels that commands name by one voxel or by a property: voxels of a colour, patches of the surface, and
//! pieces, each with those around its mirror images.
//!
//! Takes the target without changing it. Returns voxels, or the reason why a number or a place is refused.

use glam::{IVec3, UVec3};

use super::CommandError;
use super::edit_target::EditTarget;
use crate::command::PatchRule;
use crate::refusal::InvalidValue;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::{Grid, Rgb};
use crate::tools::flood;
use crate::tools::mask::{self, MAX_REACH_VX};
use crate::tools::pieces::{PiecesOf, pieces};
use crate::tools::repair::RepairError;

/// Returns the voxels of a colour or of similar colours.
pub(super) fn voxels_of_colour(
    target: &EditTarget,
    colour: Rgb,
    tolerance: f32,
) -> Result<Grid, CommandError> {
    InvalidValue::check_share("tolerance", tolerance)?;
    target.require_colours()?;
    Ok(flood::of_colour(&target.contents, colour, tolerance))
}

/// Returns the patch of the surface around a voxel, and the patches around its mirror images.
pub(super) fn patch(
    target: &EditTarget,
    at: IVec3,
    by: PatchRule,
) -> Result<ListedBricks, CommandError> {
    match by {
        PatchRule::Colour(tolerance) => InvalidValue::check_share("tolerance", tolerance)?,
        PatchRule::Flat(angle_deg) => {
            let is_angle = (0.0..=180.0).contains(&angle_deg);
            let rule = "must be from 0 to 180 degrees";
            InvalidValue::check(is_angle, "angle of a patch", rule, angle_deg)?;
        }
    }
    let starts = surface_images(target, at)?;
    Ok(match by {
        PatchRule::Colour(tolerance) => flood::patch(&target.contents, &starts, tolerance),
        PatchRule::Flat(angle_deg) => ListedBricks::union(
            starts.iter().map(|start| mask::flat_patch(target.grid(), *start, angle_deg)),
        ),
    })
}

/// Returns the pieces of a voxel and of its mirror images.
pub(super) fn piece_at(target: &EditTarget, at: IVec3) -> Result<ListedBricks, CommandError> {
    let grid = target.grid();
    let starts = surface_images(target, at)?;
    let found =
        pieces(grid, PiecesOf::Solid, target.limits.grid_bytes, &()).map_err(RepairError::from)?;
    let wanted: Vec<u32> = starts.iter().filter_map(|v| found.at(v.as_ivec3())).collect();
    Ok(found.voxels_of(&|piece| wanted.contains(&piece)))
}

/// Returns a voxel of the surface, and its mirror images that belong to the surface.
pub(super) fn surface_images(target: &EditTarget, at: IVec3) -> Result<Vec<UVec3>, CommandError> {
    let grid = target.grid();
    if !grid.contains(at) || !flood::is_on_surface(grid, at) {
        return Err(CommandError::NotOnSurface(at.saturating_add(target.origin())));
    }
    let centre = at.as_vec3() + 0.5;
    let images = target.images().into_iter();
    let voxels = images.map(|image| image.point(centre).floor().as_ivec3());
    Ok(voxels.filter(|v| flood::is_on_surface(grid, *v)).map(|v| v.as_uvec3()).collect())
}

/// Returns a patch of the surface with all voxels below it to a depth of `by` voxels.
pub(super) fn thickened(
    target: &EditTarget,
    voxels: &ListedBricks,
    by: u32,
) -> Result<ListedBricks, CommandError> {
    let rule = "reaches up to 4 voxels from the surface";
    InvalidValue::check(by <= MAX_REACH_VX, "depth of a patch", rule, by)?;
    Ok(mask::thickened(voxels, target.grid().brick_dims(), by))
}
