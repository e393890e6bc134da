//! Smooth: evens out bumps and pits.

use super::change::{BrushChange, Site};
use super::dab::{Dab, DabPlace};
use super::kernel::filter;
use super::kernel::level::Level;
use super::kernel::rays::{self, Filtered};
use super::keys::{AROUND, OUTLINE, RADIUS, REACH, ROUNDING, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, Keeps, OutlineColour, Script};
use super::{BrushDirection, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "smooth",
    action: "smooth",
    label: "Smooth",
    help: "Smooth: evens out bumps and pits",
    effect: "Reduces bumps and pits that are smaller than the brush, in proportion to the strength, and repeats while the button is held. Large forms, flat faces and thin walls stay.",
    keeps: Keeps::of("kept within 1 % for forms five times as large as the brush; smaller ones go", Keeps::AROUND, "kept, but for their edges"),
    synonyms: "soften relax blur polish",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        STRENGTH.range(0.01, 1.0).first(0.5).help("How much each use reduces details smaller than the brush; it repeats while the button is held").param,
    ],
    stroke: BrushStroke::Picture { repeats: true },
    pressure: Some(STRENGTH),
    tint: OutlineColour::Neutral,
    idle: "Nothing changed: it is smooth here",
    dab,
    script: Script::under(
        &[REACH.param, AROUND.param, STRENGTH.optional().param, ROUNDING.param],
        apply,
    ),
    ..BrushSpec::SURFACE
};

/// Multiples of the golden ratio are spread evenly modulo 1.
const GOLDEN: f32 = 0.618_034;

/// Makes a use with reach 0 and a different rounding for each use of a stroke.
fn dab(dab: &Dab) -> Option<BrushUse> {
    let DabPlace::Picture { uses, .. } = dab.place else { return None };
    let rounding = (Level::NEAREST + uses as f32 * GOLDEN).fract();
    Some(dab.used(BrushDirection::None).with(REACH, 0.0).with(ROUNDING, rounding))
}

/// With a strength, smooths by a level set at the scale of the footprint, and ignores the reach. Without one, smooths
/// by the majority, as the first versions did.
fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let stamp = rays::under(used, site, |footprint| match used.find(STRENGTH) {
        // All uses work on one surface: overlapping uses on that of a stroke's start do not add up.
        Some(strength) => {
            let level = Level { strength, rounding: used.get(ROUNDING) };
            level.stamp(footprint, site.surface)
        }
        None => {
            let around_vx = used.get(AROUND);
            rays::filtered(footprint, site, used.get(REACH), around_vx, |near| {
                let (add, remove) = filter::majority(&near.solid, &near.may, around_vx, 1.0);
                Filtered { add: Some(add), remove: Some(remove) }
            })
        }
    });
    Ok(BrushChange::of_clay(stamp))
}
