//! A refused command changes nothing (invariant 4), whatever its arguments: the largest and smallest
//! numbers, negative ones, zero, and NaN.

use glam::{IVec3, Quat, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{Document, Limits};
use sculpture_core::sculpture::clip::Clip;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::region::VoxelBox;
use sculpture_core::sculpture::selection::Selection;
use sculpture_core::sculpture::{ColourDepth, Placement, Rgb};
use sculpture_core::tools::solid::{Primitive, Solid};
use sculpture_core::tools::symmetry::Symmetry;

use super::brushes::{self, Parts, brush_use};
use super::drawn_solids::drawn_solid;
use super::strategies::{
    any_command, area_work, canvas_change, new_sculpture, op, orientation, work,
};

/// Everything that a command can change.
#[derive(PartialEq, Debug)]
struct State {
    contents: Contents,
    undo: Vec<String>,
    redo: Vec<String>,
    history_bytes: usize,
    dropped: u64,
    selection: Selection,
    symmetry: Symmetry,
    clip: Option<Clip>,
    placement: Placement,
    stroke_open: bool,
    can_repeat: bool,
    revision: u64,
}

impl State {
    fn of(document: &Document) -> State {
        let history = document.history();
        State {
            contents: document.contents().clone(),
            undo: history.undo_labels().map(str::to_string).collect(),
            redo: history.redo_labels().map(str::to_string).collect(),
            history_bytes: history.bytes(),
            dropped: history.dropped(),
            selection: document.selection().clone(),
            symmetry: document.symmetry(),
            clip: document.clip().cloned(),
            placement: *document.placement(),
            stroke_open: document.stroke_open(),
            can_repeat: document.can_repeat(),
            revision: document.revision(),
        }
    }
}

/// Returns numbers including extremes, denormals and NaN.
pub fn number() -> impl Strategy<Value = f32> {
    let odd = [
        0.0,
        -0.0,
        -1.0,
        8.0,
        0.5,
        1e-45,
        f32::MIN_POSITIVE,
        1e9,
        -3e9,
        1e30,
        f32::MAX,
        f32::MIN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    prop_oneof![3 => -4f32..20.0, 4 => prop::sample::select(odd.to_vec())]
}

fn vector() -> impl Strategy<Value = Vec3> {
    prop_oneof![
        3 => prop::array::uniform3(0.5f32..16.0).prop_map(Vec3::from),
        1 => prop::array::uniform3(number()).prop_map(Vec3::from),
    ]
}

fn whole() -> impl Strategy<Value = i32> {
    let odd = [0, -1, 1, 1 << 20, (1 << 20) - 6, -(1 << 20), i32::MAX, i32::MIN, i32::MAX - 7];
    prop_oneof![3 => -8i32..16, 2 => prop::sample::select(odd.to_vec())]
}

fn whole_vector() -> impl Strategy<Value = IVec3> {
    prop::array::uniform3(whole()).prop_map(IVec3::from)
}

fn rotation() -> impl Strategy<Value = Quat> {
    prop_oneof![
        2 => Just(Quat::IDENTITY),
        1 => Just(Quat::from_xyzw(0.0, 1.0, 0.0, 0.0)),
        1 => prop::array::uniform4(number()).prop_map(Quat::from_array),
    ]
}

fn solid() -> impl Strategy<Value = Primitive> {
    (prop::sample::select(&Solid::ALL[..]), vector(), vector(), rotation()).prop_map(
        |(solid, centre_vx, half, rotation)| Primitive { solid, centre_vx, half, rotation },
    )
}

fn brush() -> impl Strategy<Value = Command> {
    let parts = Parts {
        ray: vector().boxed(),
        // Few enough rays for the duration of the test.
        rays: number().prop_map(|r| if r > 12.0 && r <= 256.0 { 12.0 } else { r }).boxed(),
        centre: vector().boxed(),
        radius: number().boxed(),
        vector: vector().boxed(),
        value: brushes::hostile,
    };
    brush_use(&parts).prop_map(Command::Brush)
}

fn hostile() -> impl Strategy<Value = Command> {
    let counts = || prop::sample::select(vec![0u32, 1, 3, 1024, 1025, u32::MAX]);
    let new = (
        prop::array::uniform3(prop::sample::select(vec![0u32, 1, 9, 8192, 8193, u32::MAX])),
        vector(),
    )
        .prop_map(|(dims, voxel_size)| {
            Command::New(NewSculpture {
                dims: UVec3::from(dims),
                voxel_size,
                colour_depth: ColourDepth::Bits16,
                base: Rgb::STONE,
                solid: true,
                room_vx: 0,
                grows: false,
            })
        });
    prop_oneof![
        1 => new,
        3 => (op(), solid(), prop::option::of(vector()))
            .prop_map(|(op, primitive, to_vx)| Command::Construct { op, primitive, to_vx }),
        3 => (op(), drawn_solid(vector(), number()))
            .prop_map(|(op, drawn)| Command::DrawnSolid { op, drawn }),
        1 => solid().prop_map(|primitive| Command::Texture { primitive, picture: "none.png".into() }),
        6 => brush(),
        2 => (whole_vector(), whole_vector())
            .prop_map(|(min, max)| Command::Mark(VoxelBox { min, max })),
        2 => (whole_vector(), orientation())
            .prop_map(|(at, orientation)| Command::Paste { at, orientation }),
        3 => (whole_vector(), orientation())
            .prop_map(|(by, orientation)| Command::Move { by, orientation }),
        3 => (counts(), whole_vector()).prop_map(|(count, step)| Command::Array { count, step }),
        1 => (rotation(), vector(), number()).prop_map(|(rotation, translation, scale)| {
            Command::Place(Placement { rotation, translation, scale })
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn a_refused_command_changes_nothing_and_undo_restores(
        new in new_sculpture(16),
        commands in prop::collection::vec(
            prop_oneof![
                2 => work(),
                4 => area_work(),
                5 => hostile(),
                2 => any_command(),
                2 => canvas_change(0u32..9).prop_map(Command::Canvas),
            ],
            1..40,
        ),
        tight in any::<bool>(),
    ) {
        let colour_bytes = if tight { 6000 } else { 1 << 24 };
        let limits = Limits { grid_bytes: 1 << 20, colour_bytes, ..Limits::default() };
        let mut document = Document::new(&new, limits).unwrap();
        let original = document.contents().clone();
        for command in &commands {
            let before = State::of(&document);
            if document.apply(command).is_err() {
                prop_assert_eq!(State::of(&document), before, "{}", command);
            }
        }
        if document.stroke_open() {
            document.apply(&Command::End).unwrap();
        }
        document.apply(&Command::Redo { steps: None }).unwrap();
        let last = document.contents().clone();
        document.apply(&Command::Undo { steps: None }).unwrap();
        prop_assert_eq!(document.contents(), &original);
        document.apply(&Command::Redo { steps: None }).unwrap();
        prop_assert_eq!(document.contents(), &last);
    }
}

#[test]
fn a_move_too_far_is_refused_before_it_begins() {
    let new: Command = "new dims=64,64,64".parse().unwrap();
    let Command::New(new) = new else { panic!("not new") };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    document.apply(&"mark at=0,0,0 size=64,64,16".parse().unwrap()).unwrap();
    for by in ["1048570,0,0", "0,-1048577,0", "0,0,2147483647", "-2147483648,0,0"] {
        let before = State::of(&document);
        let error = document.apply(&format!("move by={by}").parse().unwrap()).unwrap_err();
        assert!(error.to_string().contains("too far from the grid"), "{error}");
        assert_eq!(State::of(&document), before, "{by}");
    }
    assert_eq!(document.apply(&Command::Undo { steps: None }).unwrap().steps, 0);
    assert_eq!(document.grid().opaque_count(), 64 * 64 * 64);
    // At the largest distance everything leaves the grid, and undo brings it back.
    document.apply(&"move by=1048512,0,0".parse().unwrap()).unwrap();
    assert_eq!(document.grid().opaque_count(), 64 * 64 * 48);
    document.apply(&Command::Undo { steps: Some(1) }).unwrap();
    assert_eq!(document.grid().opaque_count(), 64 * 64 * 64);
}

#[test]
fn an_array_that_cannot_be_finished_leaves_nothing() {
    let new: Command = "new dims=32,32,32 fill=empty".parse().unwrap();
    let Command::New(new) = new else { panic!("not new") };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    for line in [
        "add cuboid at=4,4,4 half=2 colour=#ff0000",
        "mark at=2,2,2 size=4,4,4",
        "copy",
        "paste at=8,2,2",
    ] {
        document.apply(&line.parse().unwrap()).unwrap();
    }
    // The last copies would be too far away.
    let before = State::of(&document);
    document.apply(&"array count=40 step=30000,0,0".parse().unwrap()).unwrap_err();
    assert_eq!(State::of(&document), before);
    document.apply(&"array count=2 step=0,8,0".parse().unwrap()).unwrap();
    assert_eq!(document.grid().opaque_count(), 64 * 4);
}

#[test]
fn solids_beyond_a_million_voxels_are_refused_as_those_that_are_drawn_are() {
    let new = NewSculpture {
        dims: UVec3::splat(16),
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::Bits24,
        base: Rgb::STONE,
        solid: true,
        room_vx: 0,
        grows: false,
    };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    let before = State::of(&document);
    for far in ["3e38", "-1e30", "1000001"] {
        for solid in ["ellipsoid", "torus", "cone", "rounded-cuboid"] {
            for verb in ["subtract", "add", "mask add"] {
                for place in [
                    format!("at={far},8,8 half=4"),
                    format!("at=8,8,8 half=4 to=8,{far},8"),
                    format!("at=8,8,{far} half=4 to=8,8,8"),
                ] {
                    let text = format!("{verb} {solid} {place}");
                    let command: Command = text.parse().unwrap();
                    let said = document.apply(&command).unwrap_err().to_string();
                    assert!(said.contains("million voxels"), "{text}: {said}");
                }
            }
        }
    }
    assert_eq!(State::of(&document), before);
    let command: Command = "subtract cone at=8,8,8 half=4 to=8,8,1000000".parse().unwrap();
    assert!(document.apply(&command).is_ok());
}
