//! Grab: pulls the surface along with the pointer.

use super::change::{BrushChange, Site};
use super::dab::{Dab, DabPlace};
use super::kernel::grab::{self, Motion};
use super::keys::{FALLOFF, RADIUS, STRENGTH};
use super::limits::MAX_PULL_VX;
use super::spec::{BrushSpec, BrushStroke, ContactKind, Keeps, Script};
use super::{BrushDirection, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "grab",
    action: "grab",
    label: "Grab",
    help: "Grab: pulls the surface along with the pointer",
    effect: "Pulls the clay in a ball along with the pointer, in the plane of the view. The centre follows the pointer fully; the rim stays. During the drag, the clay always starts from its state at the press, so that dragging back restores it.",
    keeps: Keeps::of(
        "kept where the ball encloses a whole piece of clay, or drags along a face; grows when pulled out of a face, shrinks when pushed in",
        "goes along",
        "not kept",
    ),
    synonyms: "move pull push drag tweak deform hand",
    options: &[
        RADIUS.first(60.0).param,
        STRENGTH.help("How far the surface follows the pointer").param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Held { turns: false },
    dab,
    script: Script::of_clay(ContactKind::BallWithDisplacement, &[FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

fn dab(dab: &Dab) -> Option<BrushUse> {
    let DabPlace::Held { by_vx, .. } = dab.place else { return None };
    let by_vx = by_vx * dab.options.get(STRENGTH);
    let furthest = by_vx.abs().max_element();
    let share = if furthest > MAX_PULL_VX { MAX_PULL_VX / furthest } else { 1.0 };
    Some(dab.used(BrushDirection::Displacement(by_vx * share)))
}

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    grab::change(used, site, |by_vx| Motion::Pull { by_vx })
}
