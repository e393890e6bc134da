//! Uses of every tool, made from the descriptions. A solid, drawn solid or brush that is added to its list is included
//! automatically.

use glam::{EulerRot, Quat, UVec3, Vec3};
use sculpture_core::command::{Command, MaskArea, MaskChange, NewSculpture};
use sculpture_core::document::{Document, Limits};
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::{ColourDepth, Rgb};
use sculpture_core::tools::brush::footprint::{Coverage, Footprint, Outline};
use sculpture_core::tools::brush::param::{Domain, Omitted, OptionValue, Param};
use sculpture_core::tools::brush::spec::{BrushGroup, ContactKind};
use sculpture_core::tools::brush::{BrushBall, BrushDirection, BrushId, BrushUse, Contact};
use sculpture_core::tools::drawn::{DrawnSolid, FURTHEST_VX, SolidPose};
use sculpture_core::tools::solid::{Primitive, Solid};
use sculpture_core::tools::texture::Texture;

/// Half extents of solids, in voxels.
const HALF_VX: Vec3 = Vec3::new(7.0, 5.0, 6.0);
const SIZE_VX: f32 = 8.0;
/// Radius of brushes that work in a ball, in voxels, and of brushes with rays, in rays.
const RADIUS: f32 = 9.0;
/// Distance between rays at the end of the aim vector.
const RAY: f32 = 0.1;
const OUT: Vec3 = Vec3::new(1.0, 3.0, 2.0);
/// The name of the picture that some uses need.
pub const PICTURE: &str = "stripes";
const BY_VX: Vec3 = Vec3::new(5.0, -4.0, 3.0);

/// Each operation on voxels.
pub const OPS: [EditOp; 4] = [
    EditOp::Add(Some(Rgb::new(255, 0, 0))),
    EditOp::Add(None),
    EditOp::Subtract,
    EditOp::Recolour(Rgb::new(0, 255, 0)),
];

/// A place where tools are used.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The centre of solids.
    pub at_vx: Vec3,
    /// The centre of the balls of brushes.
    pub ball_vx: Vec3,
    /// The point where sweeps end.
    pub further_vx: Vec3,
    /// The point where the rays of brushes start.
    pub eye_vx: Vec3,
    /// The direction of the rays.
    pub aim: Vec3,
}

/// Returns a document, full or empty, that knows the picture.
pub fn document(dims: UVec3, solid: bool) -> Document {
    document_within(dims, solid, Limits::default())
}

/// Returns the same within limits.
pub fn document_within(dims: UVec3, solid: bool, limits: Limits) -> Document {
    let new = NewSculpture {
        dims,
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::Bits24,
        base: Rgb::STONE,
        solid,
        room_vx: 0,
        grows: false,
    };
    let mut document = Document::new(&new, limits).unwrap();
    let stripes = (0..64).map(|i| if i % 8 < 4 { Rgb::STONE } else { Rgb::new(1, 2, 3) });
    document.learn_picture(PICTURE.as_ref(), Texture::new(8, stripes.collect()).unwrap());
    document
}

/// Returns the uses of all tools that may change voxels or the mask.
pub fn of_every_tool(place: &Place) -> Vec<Command> {
    let mut uses = of_solids(place);
    uses.extend(of_drawn_solids(place.at_vx));
    uses.extend(BrushId::ALL.iter().flat_map(|brush| of_brush(*brush, place)));
    uses
}

/// Returns every solid, in place and swept, with every operation, on the mask, and with a picture.
fn of_solids(place: &Place) -> Vec<Command> {
    let Place { at_vx, further_vx, .. } = *place;
    let of = |solid: Solid| {
        let primitive = Primitive { solid, centre_vx: at_vx, half: HALF_VX, rotation: turn() };
        let ways = [None, Some(further_vx)].into_iter();
        let edits =
            ways.flat_map(move |to_vx| OPS.map(|op| Command::Construct { op, primitive, to_vx }));
        let what = MaskArea::Solid { primitive, to_vx: Some(further_vx) };
        let texture = Command::Texture { primitive, picture: PICTURE.into() };
        edits.chain([mask(what), texture])
    };
    Solid::ALL.into_iter().flat_map(of).collect()
}

/// Returns every drawn solid, with every operation and on the mask.
fn of_drawn_solids(at_vx: Vec3) -> Vec<Command> {
    let of = |drawn: DrawnSolid| {
        let edits = OPS.map(|op| Command::DrawnSolid { op, drawn: drawn.clone() });
        edits.into_iter().chain([mask(MaskArea::DrawnSolid(drawn))])
    };
    drawn_solids(at_vx, SIZE_VX).flat_map(of).collect()
}

/// Returns the example of every drawn solid. Its points must not be further away than solids may be.
pub fn drawn_solids(at_vx: Vec3, size: f32) -> impl Iterator<Item = DrawnSolid> {
    let furthest = Vec3::splat(FURTHEST_VX - 2.0 * size);
    let pose = SolidPose { at_vx: at_vx.clamp(-furthest, furthest), rotation: turn() };
    DrawnSolid::ALL.into_iter().map(move |spec| (spec.example)(pose, size))
}

fn mask(what: MaskArea) -> Command {
    Command::Mask(MaskChange::Put { adds: true, what })
}

fn turn() -> Quat {
    Quat::from_euler(EulerRot::XYZEx, 0.2, 0.4, 0.6)
}

/// Returns a brush with the arguments that a script requires; in both senses if it has two.
fn of_brush(brush: BrushId, place: &Place) -> Vec<Command> {
    let spec = brush.spec();
    let has_sense = spec.params().iter().any(has_sense);
    let senses = if has_sense { &[1.0, -1.0][..] } else { &[1.0] };
    let used = |sense: &f32| {
        let mut used = BrushUse::new(brush, contact(spec.script?.contact, place));
        for param in spec.params().iter().filter(|param| param.omitted == Omitted::Required) {
            used.set_value(param.key, value(param, *sense));
        }
        // Read as from a script, which fills in the defaults.
        Some(Command::Brush(used).to_string().parse().unwrap())
    };
    senses.iter().filter_map(used).collect()
}

/// Returns whether a use of a brush changes only the mask.
pub fn is_of_mask(command: &Command) -> bool {
    match command {
        Command::Mask(_) => true,
        Command::Brush(used) => used.brush().spec().group == BrushGroup::Mask,
        _ => false,
    }
}

/// Returns every brush that has a measure of its effect, with that measure at 0.
pub fn without_strength(place: &Place) -> Vec<Command> {
    let none = |brush: &BrushId| {
        let spec = brush.spec();
        let measure = spec.params().iter().find(|param| MEASURES.contains(&param.key))?;
        let contact = contact(spec.script?.contact, place);
        let mut used = BrushUse::new(*brush, contact);
        for param in spec.params().iter().filter(|param| param.omitted == Omitted::Required) {
            used.set_value(param.key, value(param, 1.0));
        }
        used.set_value(measure.key, OptionValue::Number(0.0));
        Some(Command::Brush(used))
    };
    BrushId::ALL.iter().filter_map(none).collect()
}

/// Parameters that measure the effect; 0 means none.
const MEASURES: &[&str] = &["strength", "cover", "height", "angle"];

fn contact(kind: ContactKind, place: &Place) -> Contact {
    let Place { ball_vx, eye_vx, aim, .. } = *place;
    let in_ball = |frame| Contact::Ball(BrushBall { centre_vx: ball_vx, radius: RADIUS, frame });
    match kind {
        ContactKind::Footprint => Contact::Footprint(Footprint {
            eye_vx,
            aim,
            across: Vec3::X * RAY,
            down: Vec3::Z * RAY,
            radius: RADIUS,
            outline: Outline::Round,
            coverage: Coverage::Rays,
        }),
        ContactKind::Ball => in_ball(BrushDirection::None),
        ContactKind::BallWithNormal => in_ball(BrushDirection::Normal(OUT)),
        ContactKind::BallWithDisplacement => in_ball(BrushDirection::Displacement(BY_VX)),
    }
}

fn has_sense(param: &Param) -> bool {
    matches!(param.domain, Domain::Number([least, _]) if least < 0.0)
}

fn value(param: &Param, sense: f32) -> OptionValue {
    match param.domain {
        Domain::Number([_, most]) if has_sense(param) => OptionValue::Number(0.25 * sense * most),
        Domain::Number([_, most]) => OptionValue::Number(most),
        Domain::Whole([_, most]) => OptionValue::Whole(most),
        Domain::Choice(_) => OptionValue::Choice(0),
        Domain::Switch => OptionValue::On(true),
        Domain::Colour => OptionValue::Colour(Rgb::new(255, 255, 0)),
        Domain::Radius => panic!("{} is no parameter of a command", param.key),
    }
}
