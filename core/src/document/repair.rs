//! How a document is made fit for printing: a plan of voxels to remove and to add, as one undo step.

use crate::command::Command;
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::edit::EditOp;
use crate::sculpture::history::Contents;
use crate::sculpture::inherit::Inherited;
use crate::tools::repair::{Repair, RepairPlan};

use super::{Applied, CommandError, Document};

/// The voxels that `repair` changes, found within `limits`. [`Document::put_repaired`] applies them.
pub fn plan_repair(
    contents: &Contents,
    repair: &Repair,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<RepairPlan, CommandError> {
    Ok(repair.plan(&contents.grid, limits.grid_bytes, progress)?)
}

impl Document {
    pub(super) fn repair(
        &mut self,
        repair: &Repair,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        let plan = plan_repair(&self.contents, repair, &self.limits, &())?;
        self.put_repaired(&plan, repair, command)
    }

    /// Removes and adds the voxels of a plan that was made of the present contents. Thickened walls take the colours
    /// around them, fillings of cavities the base colour.
    pub fn put_repaired(
        &mut self,
        plan: &RepairPlan,
        repair: &Repair,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        let inherited = match repair {
            Repair::Thicken { .. } => {
                let scope = self.scope();
                Inherited::colours(&self.contents, &plan.add, |v| scope.allows(v))
            }
            _ => Inherited::default(),
        };
        let add = EditOp::Add(None);
        self.check_colour_memory(|document, exact| {
            document.new_pages(&plan.add, add, exact) + inherited.new_pages(document.contents())
        })?;
        let mut stats = self.edit(&plan.remove, EditOp::Subtract);
        stats += self.edit(&plan.add, add);
        if !inherited.is_empty() {
            self.paint(&plan.add, |v, now| inherited.colour(v).unwrap_or(now));
        }
        self.applied(stats, command)
    }
}
