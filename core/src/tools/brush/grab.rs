//! Grab: pulls the surface along with the pointer.

use super::change::{Change, Site};
use super::kernel::grab::{self, Motion};
use super::keys::{FALLOFF, RADIUS, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, ContactKind, Script};
use super::{BrushError, BrushUse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "grab",
    action: "grab",
    label: "Grab",
    help: "Grab: pulls the surface along with the pointer",
    synonyms: "move pull push drag tweak deform hand",
    options: &[
        RADIUS.first(60.0).param,
        STRENGTH.help("How far the surface goes along with the pointer").param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Held { turns: false },
    script: Script::of_clay(ContactKind::BallWithDisplacement, &[FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

fn apply(used: &BrushUse, site: &Site) -> Result<Change, BrushError> {
    grab::change(used, site, |by_vx| Motion::Pull { by_vx })
}
