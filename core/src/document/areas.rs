//! Edits areas: fills, clears, dyes and tints them, and floods patches of one colour.
//!
//! Takes the target and an area; returns counts of changes. Memory is checked before the first change.

use glam::IVec3;

use super::CommandError;
use super::edit_target::EditTarget;
use super::lookup;
use crate::command::Area;
use crate::refusal::InvalidValue;
use crate::sculpture::Rgb;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::region::{Everywhere, Region};
use crate::sculpture::to_paint::PaintedWith;
use crate::tools::flood;
use crate::tools::tint::{Tint, Tinter};

/// Edits all voxels of an area.
pub(super) fn edit(
    target: &mut EditTarget,
    area: Area,
    op: EditOp,
) -> Result<EditStats, CommandError> {
    target.require_colours_for(op)?;
    match area {
        Area::Grid => edit_region(target, &Everywhere, op),
        Area::Marker => edit_region(target, &target.selection.marker(), op),
        Area::Selection => edit_region(target, &target.selected()?, op),
    }
}

fn edit_region(
    target: &mut EditTarget,
    region: &impl Region,
    op: EditOp,
) -> Result<EditStats, CommandError> {
    target.check_memory([region].into_iter(), PaintedWith::Edit(op))?;
    Ok(target.edit(region, op))
}

/// Changes the colours of an area.
pub(super) fn tint(
    target: &mut EditTarget,
    area: Area,
    tint: &Tint,
) -> Result<EditStats, CommandError> {
    tint.check()?;
    target.require_colours()?;
    match area {
        Area::Grid => tint_region(target, &Everywhere, tint),
        Area::Marker => tint_region(target, &target.selection.marker(), tint),
        Area::Selection => tint_region(target, &target.selected()?, tint),
    }
}

fn tint_region(
    target: &mut EditTarget,
    region: &impl Region,
    tint: &Tint,
) -> Result<EditStats, CommandError> {
    let (voxel_size, base) = (target.grid().voxel_size(), target.material().base());
    let tinter = Tinter::new(tint, voxel_size, base).shifted_by(target.origin());
    let painted = PaintedWith::AnyColours { keeps_base: tinter.keeps_base() };
    target.check_colour_memory(|is_close| target.colour_growth(region, painted, is_close))?;
    Ok(target.paint(region, |v, now| tinter.colour(v, now)))
}

/// Recolours the patch of one colour on the surface around a voxel, and the patches around its mirror images.
pub(super) fn flood(
    target: &mut EditTarget,
    at: IVec3,
    colour: Rgb,
    tolerance: f32,
) -> Result<EditStats, CommandError> {
    InvalidValue::check_share("tolerance", tolerance)?;
    target.require_colours()?;
    let starts = lookup::surface_images(target, at)?;
    let patch = flood::patch(&target.contents, &starts, tolerance);
    edit_region(target, &patch, EditOp::Recolour(colour))
}
