//! Copies, cuts and moves the marker's contents, and pastes a clip.
//!
//! Takes the target and a clip. Memory is checked before the first change. The document owns the clipboard itself.

use glam::{IVec3, UVec3};

use super::CommandError;
use super::edit_target::EditTarget;
use crate::refusal::InvalidValue;
use crate::sculpture::Brick;
use crate::sculpture::bits_growth::bits_growth_of;
use crate::sculpture::clip::Clip;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::edit_scope::EditScope;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::selection::{MARKER_LIMIT_VX, Selection};

/// Returns a copy of the marker's contents.
pub(super) fn copied(target: &EditTarget) -> Result<Clip, CommandError> {
    // Copying leaves masked voxels as they are, so the mask does not limit it.
    marked(target, EditScope { mask: None, ..target.scope() })
}

/// Cuts the marker's contents.
pub(super) fn cut(target: &mut EditTarget) -> Result<(EditStats, Clip), CommandError> {
    let clip = marked(target, target.scope())?;
    let marker = target.selection.marker();
    target.check_bits_memory(|is_close| target.bits_growth(&marker, EditOp::Subtract, is_close))?;
    let stats = target.edit(&marker, EditOp::Subtract);
    Ok((stats, clip))
}

/// Pastes a clip: its voxels exist afterwards, in its colours.
pub(super) fn paste(
    target: &mut EditTarget,
    clip: &Clip,
    at: IVec3,
    orientation: Orientation,
) -> Result<EditStats, CommandError> {
    let voxels = pasted(target, clip, at, orientation)?;
    let (existing, new) = parted(target, &voxels);
    let colour = |v: UVec3, _| clip.colour(at, orientation, v);
    let mut stats = target.paint(&existing, colour);
    stats += target.edit(&new, EditOp::Add(None));
    target.paint(&new, colour);
    Ok(stats)
}

/// Rotates the marker's contents about their centre and moves them, with the marker.
pub(super) fn move_marked(
    target: &mut EditTarget,
    by: IVec3,
    orientation: Orientation,
) -> Result<EditStats, CommandError> {
    let clip = marked(target, target.scope())?;
    let from = target.selection.marker().min.max(IVec3::ZERO);
    let (size, turned) = (clip.size().as_ivec3(), orientation.size(clip.size()).as_ivec3());
    // Rounded towards zero, so that a rotation and its inverse lead back.
    let to = from.saturating_add(by).saturating_add((size - turned) / 2);
    pasted(target, &clip, to, orientation)?;
    let marker = clip.bounds(to, orientation);
    Selection::check_marker(marker)?;
    let upright = clip.voxels(from, Orientation::UPRIGHT, target.grid().brick_dims());
    target
        .check_bits_memory(|is_close| target.bits_growth(&upright, EditOp::Subtract, is_close))?;
    let mut stats = target.edit(&upright, EditOp::Subtract);
    stats += paste(target, &clip, to, orientation)?;
    target.selection.set_marker(marker)?;
    Ok(stats)
}

/// Returns the marker's contents that may be changed or copied.
fn marked(target: &EditTarget, scope: EditScope<'_>) -> Result<Clip, CommandError> {
    let clip = Clip::cut(
        &target.contents,
        target.selection.marker(),
        |v| scope.allows(v),
        target.limits.grid_bytes,
    )?;
    let why = match scope {
        EditScope { mask: Some(_), .. } => " that may be changed: the rest is masked",
        EditScope { stack: Some(_), .. } => " that are selected",
        _ => "",
    };
    clip.filter(|clip| clip.voxel_count() > 0).ok_or(CommandError::NothingMarked(why))
}

/// Returns the voxels that a clip would fill; an error if memory does not suffice for them.
fn pasted(
    target: &EditTarget,
    clip: &Clip,
    at: IVec3,
    orientation: Orientation,
) -> Result<ListedBricks, CommandError> {
    let far = IVec3::splat(MARKER_LIMIT_VX);
    if at.cmplt(-far).any() || at.cmpgt(far).any() {
        return Err(InvalidValue::new("place to paste at", "is too far from the grid", at).into());
    }
    let voxels = clip.voxels(at, orientation, target.grid().brick_dims());
    target.check_bits_memory(|_| bits_growth_of(target.grid(), &voxels))?;
    if target.has_colour() {
        let growth = target.growth_of_bricks(&voxels);
        target.check_colour_memory(|_| growth)?;
    }
    Ok(voxels)
}

/// Splits voxels into existing and missing ones.
fn parted(target: &EditTarget, voxels: &ListedBricks) -> (ListedBricks, ListedBricks) {
    let grid = target.grid();
    let part = |keep: fn(&Brick, &Brick) -> Brick| {
        let bricks = voxels.bricks().iter().map(|(b, mask)| (*b, keep(mask, grid.brick(*b))));
        ListedBricks::new(bricks.collect())
    };
    (part(|mask, bits| mask.and(bits)), part(|mask, bits| mask.and_not(bits)))
}
