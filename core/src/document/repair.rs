//! Makes a sculpture fit for printing: plans the voxels to remove and to add, and applies the plan.
//!
//! Takes contents and a repair, and returns the plan; takes the target and a plan, and returns counts of changes.

use super::CommandError;
use super::edit_target::EditTarget;
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::history::Contents;
use crate::sculpture::inherit::Inherited;
use crate::sculpture::to_paint::PaintedWith;
use crate::tools::repair::{Repair, RepairPlan};

/// Returns the voxels that `repair` changes, found within `limits`.
/// [`Document::put_repaired`](super::Document::put_repaired) applies them.
pub fn plan_repair(
    contents: &Contents,
    repair: &Repair,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<RepairPlan, CommandError> {
    Ok(repair.plan(&contents.grid, limits.grid_bytes, progress)?)
}

/// Removes and adds the voxels of a plan made from the present contents. Thickened walls take the colours around them,
/// filled cavities the base colour.
pub(super) fn carry_out(
    target: &mut EditTarget,
    plan: &RepairPlan,
    repair: &Repair,
) -> Result<EditStats, CommandError> {
    let inherited = match repair {
        Repair::Thicken { .. } => {
            let scope = target.scope();
            Inherited::colours(&target.contents, &plan.add, |v| scope.allows(v))
        }
        _ => Inherited::default(),
    };
    let add = EditOp::Add(None);
    target.check_bits_memory(|is_close| {
        target.bits_growth(&plan.remove, EditOp::Subtract, is_close)
            + target.bits_growth(&plan.add, add, is_close)
    })?;
    target.check_colour_memory(|is_close| {
        target.colour_growth(&plan.add, PaintedWith::Edit(add), is_close)
            + inherited.growth(&target.contents)
    })?;
    let mut stats = target.edit(&plan.remove, EditOp::Subtract);
    stats += target.edit(&plan.add, add);
    if !inherited.is_empty() {
        target.paint(&plan.add, |v, now| inherited.colour(v).unwrap_or(now));
    }
    Ok(stats)
}
