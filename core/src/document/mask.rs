//! Changes the mask, which protects voxels from all tools. Mirror planes and the limit to the selection apply to it as
//! to tools. Each change can be undone like any other.
//!
//! Takes the target and a change of the mask; returns counts of changes.

use super::CommandError;
use super::edit_target::EditTarget;
use super::lookup;
use crate::command::{Area, MaskArea, MaskChange};
use crate::refusal::InvalidValue;
use crate::sculpture::edit::EditStats;
use crate::sculpture::edit_scope::{EditScope, ScopedRegion};
use crate::sculpture::grid_region::GridRegion;
use crate::sculpture::region::Everywhere;
use crate::tools::drawn::region::PlacedDrawnSolid;
use crate::tools::mask::{self, MAX_GROWTH_VX, MAX_REACH_VX};
use crate::tools::solid::check_sweep_end;

/// Changes the mask.
pub(super) fn change_mask(
    target: &mut EditTarget,
    change: &MaskChange,
) -> Result<EditStats, CommandError> {
    let check = |field, by: u32, most, rule| {
        let checked = InvalidValue::check((1..=most).contains(&by), field, rule, by);
        checked.map_err(|error| error.of("mask"))
    };
    Ok(match change {
        MaskChange::Clear => target.edit_mask(&Everywhere, false)?,
        MaskChange::Invert => invert_mask(target)?,
        MaskChange::Grow(by) | MaskChange::Shrink(by) => {
            let is_growth = matches!(change, MaskChange::Grow(_));
            let field = if is_growth { "growth" } else { "shrinking" };
            check(field, *by, MAX_GROWTH_VX, "must be by 1 to 64 voxels at a time")?;
            let Some(now) = target.mask() else { return Ok(EditStats::default()) };
            match is_growth {
                true => {
                    let added = mask::grown(now, *by);
                    target.edit_mask(&added, true)?
                }
                false => {
                    let removed = mask::shrunk(now, *by);
                    target.edit_mask(&removed, false)?
                }
            }
        }
        MaskChange::Smooth(around) => {
            check("evening", *around, 8, "must be within 1 to 8 voxels")?;
            let Some(now) = target.mask() else { return Ok(EditStats::default()) };
            let (added, removed) = mask::evened(now, *around);
            let mut stats = target.edit_mask(&added, true)?;
            stats += target.edit_mask(&removed, false)?;
            stats
        }
        MaskChange::Put { adds, what } => put_in_mask(target, what, *adds)?,
    })
}

fn invert_mask(target: &mut EditTarget) -> Result<EditStats, CommandError> {
    let Some(before) = target.contents.mask.clone() else {
        return target.edit_mask(&Everywhere, true);
    };
    let scope = EditScope { stack: None, mask: Some(&before) };
    let mut stats = target.edit_mask(&ScopedRegion { region: &Everywhere, scope }, true)?;
    stats += target.edit_mask(&GridRegion(&before), false)?;
    Ok(stats)
}

fn put_in_mask(
    target: &mut EditTarget,
    what: &MaskArea,
    adds: bool,
) -> Result<EditStats, CommandError> {
    let images = target.images();
    let mut stats = EditStats::default();
    match what {
        MaskArea::Area(Area::Grid) => stats += target.edit_mask(&Everywhere, adds)?,
        MaskArea::Area(Area::Marker) => {
            stats += target.edit_mask(&target.selection.marker(), adds)?;
        }
        MaskArea::Area(Area::Selection) => {
            stats += target.edit_mask(&target.selected()?, adds)?;
        }
        MaskArea::Solid { primitive, to_vx } => {
            primitive.check().and_then(|()| check_sweep_end(*to_vx))?;
            let voxel_size = target.grid().voxel_size();
            for image in images {
                stats +=
                    target.edit_mask(&primitive.image_in_grid(*to_vx, voxel_size, &image), adds)?;
            }
        }
        MaskArea::DrawnSolid(drawn) => {
            drawn.check()?;
            for image in images {
                let placed = PlacedDrawnSolid::new(drawn, target.grid(), image);
                stats += target.edit_mask(&placed, adds)?;
            }
        }
        MaskArea::Colour { colour, tolerance } => {
            let voxels = lookup::voxels_of_colour(target, *colour, *tolerance)?;
            stats += target.edit_mask(&GridRegion(&voxels), adds)?;
        }
        MaskArea::Cavities { reach_vx, depth_vx } => {
            let rule = "within which cavities are looked for must be 1 to 4 voxels";
            let is_reach = (1..=MAX_REACH_VX).contains(reach_vx);
            InvalidValue::check(is_reach, "reach", rule, reach_vx)?;
            let found = mask::cavities(target.grid(), *reach_vx);
            stats += target.edit_mask(&lookup::thickened(target, &found, *depth_vx)?, adds)?;
        }
        MaskArea::Patch { at, by, depth_vx } => {
            let patch = lookup::patch(target, *at, *by)?;
            stats += target.edit_mask(&lookup::thickened(target, &patch, *depth_vx)?, adds)?;
        }
        MaskArea::Piece { at } => {
            let voxels = lookup::piece_at(target, *at)?;
            stats += target.edit_mask(&voxels, adds)?;
        }
    }
    Ok(stats)
}
