//! Random uses of brushes, generated from their descriptions: every brush that has a command is among them.

use glam::Vec3;
use proptest::prelude::*;
use sculpture_core::sculpture::Rgb;
use sculpture_core::tools::brush::footprint::{Coverage, Footprint, Outline};
use sculpture_core::tools::brush::param::{Domain, Omitted, OptionValue, Param, Unit};
use sculpture_core::tools::brush::spec::{ContactKind, Script};
use sculpture_core::tools::brush::{
    BrushBall, BrushDirection, BrushId, BrushSurface, BrushUse, Contact,
};

use super::strategies::{colour, path};

/// A range of numbers in voxels that suits a small sculpture.
const FAR_VX: f32 = 6.0;

/// The strategies for the parts of a use.
#[derive(Clone)]
pub struct Parts {
    /// Vectors of footprints.
    pub ray: BoxedStrategy<Vec3>,
    /// Radii of footprints.
    pub rays: BoxedStrategy<f32>,
    /// Centres of balls.
    pub centre: BoxedStrategy<Vec3>,
    /// Their radii.
    pub radius: BoxedStrategy<f32>,
    /// Normals and displacements.
    pub vector: BoxedStrategy<Vec3>,
    /// Values of parameters.
    pub value: fn(&Param) -> BoxedStrategy<OptionValue>,
}

/// Returns a use of any brush, without an image.
pub fn brush_use(parts: &Parts) -> impl Strategy<Value = BrushUse> + use<> {
    let all = BrushId::ALL.iter().filter_map(|brush| Some((*brush, brush.spec().script?)));
    let all: Vec<(BrushId, Script)> = all.collect();
    let parts = parts.clone();
    prop::sample::select(all).prop_flat_map(move |(brush, script)| {
        let values: Vec<_> =
            script.params.iter().map(|param| maybe_absent(param, parts.value)).collect();
        (contact(script.contact, &parts), values, any::<bool>()).prop_map(
            move |(contact, values, stroke)| {
                let surface = if stroke { BrushSurface::Stroke } else { BrushSurface::Now };
                let mut used = BrushUse::new(brush, contact).on(surface);
                for (param, value) in script.params.iter().zip(values) {
                    used.set_value(param.key, value);
                }
                for param in script.params {
                    let instead = |other: &str| {
                        used.iter().any(|(p, value)| p.key == other && value != OptionValue::Absent)
                    };
                    if matches!(param.omitted, Omitted::InsteadOf(other, _) if instead(other)) {
                        used.set_value(param.key, OptionValue::Absent);
                    }
                }
                used
            },
        )
    })
}

/// Returns a use of the brush with an image.
pub fn stencil(parts: &Parts) -> impl Strategy<Value = BrushUse> + use<> {
    let params = BrushId::Paint.spec().params();
    let cover = params.iter().find(|param| param.key == "cover").unwrap();
    let colour = prop_oneof![Just(OptionValue::Absent), colour().prop_map(OptionValue::Colour)];
    let contact = contact(ContactKind::Footprint, parts);
    (path(), contact, colour, (parts.value)(cover)).prop_map(|(picture, contact, colour, cover)| {
        let mut used = BrushUse::new(BrushId::Paint, contact);
        if let Contact::Footprint(footprint) = &mut used.contact {
            footprint.outline = Outline::Square;
        }
        used.picture = Some(picture);
        used.set_value("colour", colour);
        used.set_value("cover", cover);
        used
    })
}

fn contact(kind: ContactKind, parts: &Parts) -> BoxedStrategy<Contact> {
    let ball = (parts.centre.clone(), parts.radius.clone());
    let framed = |frame: fn(Vec3) -> BrushDirection| {
        (ball.clone(), parts.vector.clone())
            .prop_map(move |((centre_vx, radius), vector)| {
                Contact::Ball(BrushBall { centre_vx, radius, frame: frame(vector) })
            })
            .boxed()
    };
    match kind {
        ContactKind::Footprint => {
            let ray = || parts.ray.clone();
            let outline = prop::sample::select(&Outline::ALL[..]);
            let coverage = prop::sample::select(&Coverage::ALL[..]);
            (ray(), ray(), ray(), ray(), parts.rays.clone(), outline, coverage)
                .prop_map(|(eye_vx, aim, across, down, radius, outline, coverage)| {
                    Contact::Footprint(Footprint {
                        eye_vx,
                        aim,
                        across,
                        down,
                        radius,
                        outline,
                        coverage,
                    })
                })
                .boxed()
        }
        ContactKind::Ball => framed(|_| BrushDirection::None),
        ContactKind::BallWithNormal => framed(BrushDirection::Normal),
        ContactKind::BallWithDisplacement => framed(BrushDirection::Displacement),
    }
}

fn maybe_absent(
    param: &Param,
    value: fn(&Param) -> BoxedStrategy<OptionValue>,
) -> BoxedStrategy<OptionValue> {
    match param.omitted {
        Omitted::Unwritten(OptionValue::Absent) => {
            prop_oneof![Just(OptionValue::Absent), value(param)].boxed()
        }
        _ => value(param),
    }
}

/// Returns the values that a parameter can have, with lengths that suit a small sculpture.
pub fn valid(param: &Param) -> BoxedStrategy<OptionValue> {
    match param.domain {
        Domain::Number([least, most]) if param.unit == Unit::Voxels => {
            (least.max(-FAR_VX)..=most.min(FAR_VX)).prop_map(OptionValue::Number).boxed()
        }
        Domain::Number([least, most]) => (least..=most).prop_map(OptionValue::Number).boxed(),
        Domain::Whole([least, most]) if param.unit == Unit::Voxels => {
            (least..=most.min(3)).prop_map(OptionValue::Whole).boxed()
        }
        Domain::Whole([least, most]) => (least..=most).prop_map(OptionValue::Whole).boxed(),
        Domain::Switch => any::<bool>().prop_map(OptionValue::On).boxed(),
        Domain::Choice(choices) => (0..choices.len() as u8).prop_map(OptionValue::Choice).boxed(),
        Domain::Colour => colour().prop_map(OptionValue::Colour).boxed(),
        Domain::Radius => panic!("{} is no parameter of a command", param.key),
    }
}

/// Returns values of the type of a parameter, most of which it does not allow.
pub fn hostile(param: &Param) -> BoxedStrategy<OptionValue> {
    match param.domain {
        Domain::Number(_) => super::refusals::number().prop_map(OptionValue::Number).boxed(),
        Domain::Whole(_) => prop::sample::select(vec![0u32, 1, 8, 9, 26, 27, u32::MAX])
            .prop_map(OptionValue::Whole)
            .boxed(),
        Domain::Choice(_) => (0..4u8).prop_map(OptionValue::Choice).boxed(),
        Domain::Switch => any::<bool>().prop_map(OptionValue::On).boxed(),
        Domain::Colour => Just(OptionValue::Colour(Rgb::STONE)).boxed(),
        Domain::Radius => panic!("{} is no parameter of a command", param.key),
    }
}
