//! Smear: drags clay along with the brush.

use glam::Vec3;

use super::dab::{Dab, DabPlace};
use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, Keeps, SurfaceNormal};
use super::{BrushBall, BrushDirection, BrushId, BrushUse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "smear",
    action: "smear",
    label: "Smear",
    help: "Smear: drags clay along with the brush",
    effect: "Drags the clay in a ball along with the brush. Uses add up.",
    keeps: Keeps::of(
        "kept where it drags along a face",
        "goes along",
        "kept where it drags along them",
    ),
    synonyms: "nudge smudge drag rub thumb deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.help("How far the clay follows the brush").param,
        STEADY.param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfPress { on_plane: false } },
    dab,
    ..BrushSpec::DEFORM
};

/// Longest displacement of one use, as a share of the radius: beyond that the brush has jumped.
const LONGEST: f32 = 0.5;

/// Pulls the clay from the previous position of the brush to the present one. Small brushes are used once per voxel.
fn dab(dab: &Dab) -> Option<BrushUse> {
    let DabPlace::Surface { at_vx, from_vx, edges, .. } = dab.place else { return None };
    let (delta_vx, radius) = (at_vx - from_vx, dab.options.get(RADIUS));
    let by_vx = delta_vx * dab.options.get(STRENGTH);
    if (delta_vx * edges).length() > (LONGEST * radius).max(2.0) || by_vx == Vec3::ZERO {
        return None;
    }
    let ball = BrushBall { centre_vx: from_vx, radius, frame: BrushDirection::Displacement(by_vx) };
    Some(BrushUse::in_ball(BrushId::Grab, ball).with(FALLOFF, dab.options.get(FALLOFF)))
}
