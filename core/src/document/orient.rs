//! Reorients a sculpture. The step keeps the former contents only if the inverse orientation would not restore every
//! byte.
//!
//! Takes contents and an orientation; returns the reoriented contents, or puts them in place. Knows no history.

use super::CommandError;
use super::edit_target::EditTarget;
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::{Contents, StepChange};
use crate::sculpture::orient::Reorientation;
use crate::sculpture::orientation::Orientation;

/// Returns the reoriented contents, computed within `limits`. [`Document::put_oriented`](super::Document::put_oriented)
/// puts them in place.
pub fn orient_contents(
    contents: &Contents,
    orientation: Orientation,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Contents, CommandError> {
    Ok(Reorientation::new(contents, orientation).run(limits, progress)?)
}

/// Returns the size in bytes of a step that undoes an orientation of the contents.
pub(super) fn bytes_to_undo(contents: &Contents, orientation: Orientation) -> usize {
    if is_exact(contents, orientation) { 0 } else { contents.kept_bytes() }
}

fn is_exact(contents: &Contents, orientation: Orientation) -> bool {
    Reorientation::new(contents, orientation).is_exact()
}

/// Reorients the contents and returns the reverse change. `computed`: the reoriented contents, if they are known
/// already.
///
/// # Errors
/// If they must be computed or kept and memory does not suffice.
pub(super) fn lay(
    target: &mut EditTarget,
    orientation: Orientation,
    computed: Option<Contents>,
) -> Result<StepChange, CommandError> {
    let contents = match computed {
        Some(contents) => contents,
        None => orient_contents(&target.contents, orientation, &target.limits, &())?,
    };
    let is_exact = is_exact(&target.contents, orientation);
    Ok(target.swap_oriented(contents, orientation, is_exact))
}
