//! How a document is made fit for printing: a plan of voxels to remove and to add, as one undo step.

use crate::command::Command;
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::edit::EditOp;
use crate::sculpture::history::Contents;
use crate::sculpture::inherit::Inherited;
use crate::tools::repair::{Mend, MendPlan};

use super::{Applied, CommandError, Document};

/// The voxels that `mend` changes, found within `limits`. [`Document::put_mended`] applies them.
pub fn plan_mend(
    contents: &Contents,
    mend: &Mend,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<MendPlan, CommandError> {
    Ok(mend.plan(&contents.grid, limits.grid_bytes, progress)?)
}

impl Document {
    pub(super) fn mend(&mut self, mend: &Mend, command: &Command) -> Result<Applied, CommandError> {
        let plan = plan_mend(&self.contents, mend, &self.limits, &())?;
        self.put_mended(&plan, mend, command)
    }

    /// Removes and adds the voxels of a plan that was made of the present contents. Thickened walls take the colours
    /// around them, fillings of cavities the base colour.
    pub fn put_mended(
        &mut self,
        plan: &MendPlan,
        mend: &Mend,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        let inherited = match mend {
            Mend::Thicken { .. } => {
                let permit = self.permit();
                Inherited::colours(&self.contents, &plan.add, |v| permit.allows(v))
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
