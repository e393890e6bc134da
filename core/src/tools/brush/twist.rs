//! Twist: turns the clay like a knob; drag to the right or left.

use super::BrushUse;
use super::change::{BrushChange, Site};
use super::dab::{Dab, DabPlace};
use super::kernel::grab::{self, Motion};
use super::keys::{ANGLE, FALLOFF, RADIUS, STRENGTH};
use super::limits::MAX_TWIST_DEG;
use super::spec::{BrushSpec, BrushStroke, ContactKind, Keeps, Script};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "twist",
    action: "twist",
    label: "Twist",
    help: "Twist: turns the clay like a knob; drag to the right or left",
    effect: "Turns the clay in a ball about the normal of the surface, like a knob. Dragging to the right turns it clockwise, by 57° for the length of the radius. As with grab, the clay always starts from its state at the press.",
    keeps: Keeps::of("kept within 1 %", "goes along", "not kept"),
    synonyms: "rotate turn swirl screw deform",
    options: &[
        RADIUS.first(60.0).param,
        STRENGTH.help("How far the clay turns with the pointer").param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Held { turns: true },
    dab,
    script: Script::of_clay(ContactKind::BallWithNormal, &[ANGLE.param, FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

/// Turns clockwise when dragged to the right, by one radian per radius.
fn dab(dab: &Dab) -> Option<BrushUse> {
    let DabPlace::Held { by_vx, right, edges, .. } = dab.place else { return None };
    let led = (by_vx * dab.options.get(STRENGTH) * edges).dot(right);
    let angle_deg = (-led / dab.options.get(RADIUS)).to_degrees();
    Some(dab.along_normal().with(ANGLE, angle_deg.clamp(-MAX_TWIST_DEG, MAX_TWIST_DEG)))
}

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let angle_deg = used.get(ANGLE);
    grab::change(used, site, |normal| Motion::Twist { normal, angle_deg })
}
