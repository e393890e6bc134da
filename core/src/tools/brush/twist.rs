//! Twist: turns the clay like a knob; drag to the right or left.

use super::change::{Change, Site};
use super::kernel::grab::{self, Motion};
use super::keys::{ANGLE, FALLOFF, RADIUS, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, ContactKind, Script};
use super::{BrushError, BrushUse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "twist",
    action: "twist",
    label: "Twist",
    help: "Twist: turns the clay like a knob; drag to the right or left",
    synonyms: "rotate turn swirl screw deform",
    options: &[
        RADIUS.first(60.0).param,
        STRENGTH.help("How far the clay turns with the pointer").param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Held { turns: true },
    script: Script::of_clay(ContactKind::BallWithNormal, &[ANGLE.param, FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

fn apply(used: &BrushUse, site: &Site) -> Result<Change, BrushError> {
    let angle_deg = used.get(ANGLE);
    grab::change(used, site, |normal| Motion::Twist { normal, angle_deg })
}
