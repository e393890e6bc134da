//! Tests drawn solids: their voxels match their definition and equivalent solids, at any border, in empty and in full
//! grids, mirrored, and undone.

use std::fs;
use std::path::Path;

use glam::{EulerRot, IVec3, Quat, UVec3, Vec2, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Command, usage_of_drawn_solid};
use sculpture_core::document::{Document, Limits};
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::tools::drawn::region::PlacedDrawnSolid;
use sculpture_core::tools::drawn::{ControlPoint, DrawnSolid, FieldValue, SolidPose};
use sculpture_core::tools::symmetry::{Parity, Symmetry, SymmetryTransform};

use super::strategies::{new_sculpture, op, rotation};

/// Generates every drawn solid, with positions and directions of `place`, and lengths and other numbers of `number`.
pub fn drawn_solid(
    place: impl Strategy<Value = Vec3> + 'static,
    number: impl Strategy<Value = f32> + 'static,
) -> BoxedStrategy<DrawnSolid> {
    let (place, number) = (place.boxed(), number.boxed());
    let of_fields = move |mut solid: DrawnSolid| {
        let values: Vec<_> =
            solid.fields().iter().map(|field| given(&field.value, &place, &number)).collect();
        values.prop_map(move |values| {
            let mut solid = solid.clone();
            solid
                .fields()
                .into_iter()
                .zip(values)
                .for_each(|(field, given)| set(field.value, given));
            solid
        })
    };
    prop::sample::select(&DrawnSolid::ALL[..])
        .prop_map(|spec| (spec.example)(SolidPose::IDENTITY, 1.0))
        .prop_flat_map(of_fields)
        .boxed()
}

/// A value for a field.
#[derive(Clone, Debug)]
enum Given {
    Vector(Vec3),
    Rotation(Quat),
    Length(f32),
    Curve(Vec<ControlPoint>),
    Outline(Vec<Vec2>),
    Outlines(Vec<Vec<Vec2>>),
}

fn given(
    field: &FieldValue,
    place: &BoxedStrategy<Vec3>,
    number: &BoxedStrategy<f32>,
) -> BoxedStrategy<Given> {
    let outline = || {
        let point = (number.clone(), number.clone()).prop_map(|(x, y)| Vec2::new(x, y));
        prop::collection::vec(point, 1..6)
    };
    match field {
        FieldValue::Place(_) | FieldValue::Direction(_) => {
            place.clone().prop_map(Given::Vector).boxed()
        }
        FieldValue::Rotation(_) => rotation().prop_map(Given::Rotation).boxed(),
        FieldValue::Length(_) => number.clone().prop_map(Given::Length).boxed(),
        FieldValue::Curve(_) => {
            let point = (place.clone(), number.clone())
                .prop_map(|(at_vx, radius)| ControlPoint { at_vx, radius });
            prop::collection::vec(point, 1..5).prop_map(Given::Curve).boxed()
        }
        FieldValue::Outline(_) => outline().prop_map(Given::Outline).boxed(),
        FieldValue::Outlines(_) => {
            prop::collection::vec(outline(), 1..3).prop_map(Given::Outlines).boxed()
        }
    }
}

fn set(field: FieldValue, given: Given) {
    match (field, given) {
        (FieldValue::Place(value) | FieldValue::Direction(value), Given::Vector(given)) => {
            *value = given;
        }
        (FieldValue::Rotation(value), Given::Rotation(given)) => *value = given,
        (FieldValue::Length(value), Given::Length(given)) => *value = given,
        (FieldValue::Curve(value), Given::Curve(given)) => *value = given.into(),
        (FieldValue::Outline(value), Given::Outline(given)) => *value = given.into(),
        (FieldValue::Outlines(value), Given::Outlines(given)) => {
            *value = given.into_iter().map(Into::into).collect();
        }
        (field, given) => panic!("{given:?} for {field:?}"),
    }
}

/// Generates drawn solids that suit a sculpture of 24 voxels; some are refused.
pub fn small_drawn_solid() -> BoxedStrategy<DrawnSolid> {
    drawn_solid(prop::array::uniform3(-6f32..30.0).prop_map(Vec3::from), 0.2f32..14.0)
}

fn voxels(document: &Document) -> impl Iterator<Item = IVec3> {
    let dims = document.grid().dims().as_ivec3();
    let row = move |y, z| (0..dims.x).map(move |x| IVec3::new(x, y, z));
    (0..dims.z).flat_map(move |z| (0..dims.y).flat_map(move |y| row(y, z)))
}

fn empty() -> Document {
    let Ok(Command::New(new)) = "new dims=45,38,41 colour=24 fill=empty".parse() else { panic!() };
    Document::new(&new, Limits::default()).unwrap()
}

fn with(commands: &[&str]) -> Document {
    let mut document = empty();
    for command in commands {
        document.apply(&command.parse().unwrap()).unwrap();
    }
    document
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    /// Every voxel follows the definition, and mirrored images are exact; undo restores everything.
    #[test]
    fn voxels_are_those_of_the_definition(
        new in new_sculpture(24),
        solid in small_drawn_solid(),
        op in op(),
        mirrored in any::<[bool; 3]>(),
        odd in any::<bool>(),
    ) {
        let mut document = Document::new(&new, Limits::default()).unwrap();
        let parity = if odd { Parity::Odd } else { Parity::Even };
        let symmetry = Symmetry::of_axes(mirrored.map(|mirrored| mirrored.then_some(parity)));
        document.apply(&Command::Symmetry(symmetry)).unwrap();
        let before = document.contents().clone();
        let done = document.apply(&Command::DrawnSolid { op, drawn: solid.clone() });
        if let Err(reason) = solid.check() {
            prop_assert!(done.is_err_and(|error| error.to_string() == reason.to_string()));
            prop_assert_eq!(document.contents(), &before);
            return Ok(());
        }
        if done.is_err() {
            prop_assert!(matches!(op, EditOp::Recolour(_)), "no colours in this sculpture");
            return Ok(());
        }
        let placed = PlacedDrawnSolid::new(&solid, document.grid(), SymmetryTransform::of_planes([None; 3]));
        let planes = symmetry.planes(document.grid().dims());
        let images = document.images().len();
        for v in voxels(&document) {
            let inside = (0..8usize).filter(|image| {
                (0..3).all(|axis| image >> axis & 1 == 0 || planes[axis].is_some())
            }).any(|image| {
                let mut v = v;
                for axis in (0..3).filter(|axis| image >> axis & 1 == 1) {
                    v[axis] = (2.0 * planes[axis].unwrap()) as i32 - 1 - v[axis];
                }
                placed.contains_voxel(v)
            });
            let existed = before.grid.get(v);
            let exists = match op {
                EditOp::Add(_) => existed || inside,
                EditOp::Subtract => existed && !inside,
                EditOp::Recolour(_) => existed,
            };
            prop_assert_eq!(document.grid().get(v), exists, "{} of {} images", v, images);
            if let (EditOp::Recolour(colour), true) = (op, existed && inside) {
                let depth = document.contents().material.depth();
                prop_assert_eq!(document.contents().rgb(v.as_uvec3()), depth.quantise(colour));
            }
        }
        document.apply(&Command::Undo { steps: None }).unwrap();
        prop_assert_eq!(document.contents(), &before);
    }

    /// The voxels equal those of other solids and of other formulas.
    #[test]
    fn drawn_solids_are_like_the_solids_in_a_box_that_they_are_named_after(
        at in prop::array::uniform3(5f32..35.0),
        turn in prop::array::uniform3(-170i32..170),
        thick in 8u32..20,
        more in 1u32..40,
    ) {
        let (r, wide) = (thick as f32 / 4.0, (thick * 2 + more) as f32 / 4.0);
        let place = format!("at={},{},{} turn={},{},{}", at[0], at[1], at[2], turn[0], turn[1], turn[2]);
        let same = |drawn: &str, solids: &[&str]| {
            prop_assert!(with(&[drawn]).contents() == with(solids).contents(), "{} {:?}", drawn, solids);
            Ok(())
        };
        let outer = wide + r;
        same(
            &format!("add ring {place} radius={wide} tube={r}"),
            &[&format!("add torus {place} half={outer},{r},{outer}")],
        )?;
        same(
            &format!("add lathe {place} profile={wide},-{r};{wide},{r}"),
            &[&format!("add cylinder {place} half={wide},{r},{wide}")],
        )?;
        same(
            &format!("add lathe {place} profile={wide},-{r};0,{r}"),
            &[&format!("add cone {place} half={wide},{r},{wide}")],
        )?;
        let (a, b) = (wide, r);
        let square = |a: f32| format!("-{a},-{a};{a},-{a};{a},{a};-{a},{a}");
        same(
            &format!("add extrusion {place} depth={} outline={}/{}", 2.0 * b, square(a), square(b)),
            &[
                &format!("add cuboid {place} half={a},{a},{b}"),
                &format!("subtract cuboid {place} half={b},{b},{outer}"),
            ],
        )?;
        let turned = turn.map(|degrees| (degrees as f32).to_radians());
        let rotation = Quat::from_euler(EulerRot::XYZEx, turned[0], turned[1], turned[2]);
        let up = rotation.as_dquat() * glam::DVec3::Y * 0.5;
        let (low, high) = (Vec3::from(at) - up.as_vec3() * wide, Vec3::from(at) + up.as_vec3() * wide);
        let control_point = |p: Vec3| format!("{},{},{}", p.x, p.y, p.z);
        let tube = with(&[&format!("add tube points={};{} radius={r}", control_point(low), control_point(high))]);
        let half_space = with(&["fill", &format!("subtract half-space at={} normal={}", control_point(low), control_point(rotation * Vec3::Y))]);
        for v in voxels(&tube) {
            let p = v.as_dvec3() + 0.5;
            let (a, b) = (low.as_dvec3(), high.as_dvec3());
            let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let beyond = p.distance(a.lerp(b, share)) - f64::from(r);
            prop_assert!(tube.grid().get(v) == (beyond <= 0.0) || beyond.abs() < 1e-9, "{}", v);
            let height = (p - a).dot((rotation * Vec3::Y).as_dvec3());
            prop_assert!(half_space.grid().get(v) == (height < 0.0) || height.abs() < 1e-4, "{}", v);
        }
    }
}

#[test]
fn a_tube_goes_round_bends_and_grows_from_point_to_point() {
    let document = with(&["add tube points=6,8,20,3;22,8,20,3;30,20,20,3;22,32,20,5;6,32,20,6"]);
    for (v, exists) in [
        ([6, 8, 20], true),
        ([14, 8, 20], true),
        ([30, 20, 20], true),
        ([33, 20, 20], false),
        ([22, 20, 20], false),
        ([8, 36, 20], true),
        ([8, 12, 20], false),
    ] {
        assert_eq!(document.grid().get(v.into()), exists, "{v:?}");
    }
    // A single point is a ball.
    let ball = with(&["add tube points=20.25,19.5,21 radius=9.5"]);
    assert!(ball.contents() == with(&["add ellipsoid at=20.25,19.5,21 half=9.5"]).contents());
}

#[test]
fn full_and_empty_grids_stay_so_and_arrays_move_drawn_solids() {
    for solid in ["half-space at=-9,0,0 normal=1,0,0", "ring at=20,20,20 radius=9 tube=1e6"] {
        let full = with(&[&format!("add {solid}")]);
        assert!(full.contents() == with(&["fill"]).contents(), "{solid}");
        assert!(with(&["fill", &format!("subtract {solid}")]).contents() == empty().contents());
        assert!(with(&[&format!("subtract {solid}")]).contents() == empty().contents());
    }
    let array = with(&["add tube points=3,4,5,2;9,4,5,3", "array count=2 step=0,12,3"]);
    let each = with(&[
        "add tube points=3,4,5,2;9,4,5,3",
        "add tube points=3,16,8,2;9,16,8,3",
        "add tube points=3,28,11,2;9,28,11,3",
    ]);
    assert!(array.contents() == each.contents());
    assert!(array.grid().get(UVec3::new(9, 28, 11).as_ivec3()));
}

#[test]
fn an_invalid_drawn_solid_is_refused_with_a_reason() {
    let many = vec!["1,2,3"; 1025].join(";");
    for (solid, reason) in [
        ("half-space at=1,2,3 normal=0,0,0", "direction"),
        ("half-space at=1e7,2,3 normal=0,1,0", "a million"),
        ("ring at=1,2,3 radius=0 tube=3", "above zero"),
        ("ring at=1,2,3 radius=3 tube=1e7", "a million"),
        ("ring at=1,2,3 radius=3", "needs `tube=`"),
        ("tube points=1,2,3;4,5,6", "radius"),
        ("tube points=1,2,3,1;1,2,3,4", "same place"),
        ("tube points=1,2,3,-1", "above zero"),
        ("tube points=1,2,NaN,1", "not a valid number"),
        ("tube points=1,2,1e30,1", "a million"),
        (&format!("tube points={many} radius=1"), "1024"),
        ("lathe at=1,2,3 profile=1,2", "two points"),
        ("lathe at=1,2,3 profile=1,2;-1,2", "axis"),
        ("extrusion at=1,2,3 outline=1,2;2,2;2,3 depth=0", "above zero"),
        ("extrusion at=1,2,3 outline=1,2;2,2;2,3/ depth=1", "valid number"),
        ("extrusion at=1,2,3 outline=1,2/2,2;2,3 depth=1", "two points"),
        ("tubes points=1,2,3,1", "tube, lathe"),
    ] {
        let error = match format!("add {solid}").parse::<Command>() {
            Err(error) => error.to_string(),
            Ok(command) => empty().apply(&command).unwrap_err().to_string(),
        };
        assert!(error.contains(reason), "{solid}: {error}");
    }
}

/// The manual of scripts explains each drawn solid as its description does, except for the rotation argument.
#[test]
fn the_manual_has_a_row_for_every_drawn_solid() {
    let manual = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scripting.md");
    let manual = fs::read_to_string(manual).unwrap();
    for spec in DrawnSolid::ALL {
        let usage = usage_of_drawn_solid(spec).replace(" [turn=...]", "");
        let row = format!("| `{usage}` | {} |", spec.help);
        assert!(manual.lines().any(|line| line == row), "docs/scripting.md lacks\n{row}");
    }
}

#[test]
fn examples_are_written_and_read_to_the_same_bytes() {
    for spec in DrawnSolid::ALL {
        let drawn = (spec.example)(SolidPose::IDENTITY, 8.0);
        assert_eq!(drawn.check(), Ok(()), "{}", spec.name);
        let command = Command::DrawnSolid { op: EditOp::Subtract, drawn };
        let text = command.to_string();
        let read: Command = text.parse().unwrap();
        assert!(text.starts_with(&format!("subtract {} ", spec.name)), "{text}");
        assert_eq!((&read, read.to_string()), (&command, text));
    }
    for text in [
        "add half-space at=1,2,3 normal=0.5,1,0",
        "subtract ring at=1,2.5,3 turn=0,0,0,1 radius=7 tube=3",
        "add tube points=1,2,3,4;5,6,7,8 colour=#102030",
        "subtract lathe at=1,2,3 turn=0,1,0,0 profile=3,0;5,4;2,9",
        "recolour extrusion at=9,9,6 turn=0,0,0,1 depth=5 outline=-4,-4;5,-3;0,6/-1,-1;1,-1;0,1 colour=#806040",
    ] {
        assert_eq!(text.parse::<Command>().unwrap().to_string(), text);
    }
}
