//! Random commands, for the tests of commands and of documents.

use std::path::PathBuf;

use glam::{EulerRot, IVec3, Quat, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Area, CanvasChange, Command, NewSculpture, SelectOp};
use sculpture_core::resample::Resolution;
use sculpture_core::sculpture::canvas_frame::CanvasSides;
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::history::SurfaceKind;
use sculpture_core::sculpture::orientation::Orientation;
use sculpture_core::sculpture::region::VoxelBox;
use sculpture_core::sculpture::{ColourDepth, Placement, Rgb};
use sculpture_core::tools::brush::Contact;
use sculpture_core::tools::repair::{Keep, Repair, Toward};
use sculpture_core::tools::solid::{Primitive, Solid};
use sculpture_core::tools::symmetry::{Parity, Symmetry};
use sculpture_core::tools::tint::Tint;

use super::brushes::{self, Parts, brush_use, stencil};
use super::drawn_solids::{drawn_solid, small_drawn_solid};
use super::file_options::{export, import};
use super::masks::mask;

/// Returns few colours, so that voxels are often painted with the colour that they have.
pub fn colour() -> impl Strategy<Value = Rgb> {
    prop_oneof![
        Just(Rgb::new(200, 190, 170)),
        Just(Rgb::new(255, 0, 0)),
        Just(Rgb::new(0, 90, 255)),
        any::<[u8; 3]>().prop_map(Rgb),
    ]
}

pub fn rotation() -> impl Strategy<Value = Quat> {
    let any = prop::array::uniform3(-3.2f32..3.2)
        .prop_map(|[x, y, z]| Quat::from_euler(EulerRot::XYZ, x, y, z));
    prop_oneof![Just(Quat::IDENTITY), any]
}

pub fn op() -> impl Strategy<Value = EditOp> {
    prop_oneof![
        colour().prop_map(|colour| EditOp::Add(Some(colour))),
        Just(EditOp::Add(None)),
        Just(EditOp::Subtract),
        colour().prop_map(EditOp::Recolour),
    ]
}

/// Returns solids with centre coordinates in `centre` and half extents in `half`.
pub fn primitive(
    centre: std::ops::Range<f32>,
    half: std::ops::Range<f32>,
) -> impl Strategy<Value = Primitive> {
    let solid = prop::sample::select(&Solid::ALL[..]);
    let centre = prop::array::uniform3(centre);
    (solid, centre, prop::array::uniform3(half), rotation()).prop_map(
        |(solid, centre, half, rotation)| Primitive {
            solid,
            centre_vx: centre.into(),
            half: half.into(),
            rotation,
        },
    )
}

pub fn new_sculpture(longest_vx: u32) -> impl Strategy<Value = NewSculpture> {
    (
        prop::array::uniform3(1..=longest_vx),
        prop::array::uniform3(prop_oneof![Just(1.0f32), 0.3f32..3.0]),
        prop::sample::select(&ColourDepth::ALL[..]),
        colour(),
        any::<bool>(),
    )
        .prop_map(|(dims, size, colour_depth, base, solid)| NewSculpture {
            dims: UVec3::from(dims),
            voxel_size: Vec3::from(size),
            colour_depth,
            base,
            solid,
            room_vx: 0,
            grows: false,
        })
}

pub fn placement() -> impl Strategy<Value = Placement> {
    (rotation(), prop::array::uniform3(-1e3f32..1e3), 1e-3f32..1e3).prop_map(
        |(rotation, translation, scale)| Placement {
            rotation,
            translation: translation.into(),
            scale,
        },
    )
}

/// Returns text that needs quotes or escapes in a script.
pub fn hostile_text() -> impl Strategy<Value = String> {
    prop_oneof![
        any::<String>(),
        "[ =#\"\\\\\\n\\r\\t,xné🗿]{0,12}",
        prop::sample::select(vec![
            "",
            " ",
            "#",
            "=",
            "a=b",
            "\"",
            "\\",
            "\\n",
            "\n# not a comment\n",
            "trailing \r",
            "C:\\dir\\new.vsc",
            "\\\\host\\x\\41",
            "all",
        ])
        .prop_map(String::from),
    ]
}

pub fn path() -> impl Strategy<Value = PathBuf> {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStringExt;
        let bytes = any::<Vec<u8>>().prop_map(|b| std::ffi::OsString::from_vec(b).into());
        prop_oneof![hostile_text().prop_map(PathBuf::from), bytes]
    }
    #[cfg(not(unix))]
    hostile_text().prop_map(PathBuf::from)
}

pub fn area() -> impl Strategy<Value = Area> {
    prop::sample::select(&Area::ALL[..])
}

pub fn symmetry() -> impl Strategy<Value = Symmetry> {
    let parity = || prop::option::of(prop::sample::select(&Parity::ALL[..]));
    [parity(), parity(), parity()].prop_map(Symmetry::of_axes)
}

pub fn orientation() -> impl Strategy<Value = Orientation> {
    let step = (0usize..3, any::<bool>()).prop_map(|(axis, turn)| match turn {
        true => Orientation::quarter_turn(axis),
        false => Orientation::mirroring(axis),
    });
    prop::collection::vec(step, 0..5)
        .prop_map(|steps| steps.into_iter().fold(Orientation::UPRIGHT, Orientation::then))
}

/// Returns boxes with corners in `corner` and lengths up to `longest`.
pub fn marker(corner: std::ops::Range<i32>, longest: i32) -> impl Strategy<Value = VoxelBox> {
    (prop::array::uniform3(corner), prop::array::uniform3(1..=longest)).prop_map(|(min, size)| {
        VoxelBox { min: min.into(), max: IVec3::from(min) + IVec3::from(size) }
    })
}

fn any_ivec3() -> impl Strategy<Value = IVec3> {
    any::<[i32; 3]>().prop_map(IVec3::from)
}

/// Returns a use of any brush that suits a sculpture of 24 voxels: those under an outline look at it.
pub fn brush_command() -> impl Strategy<Value = Command> {
    let vector = |range: std::ops::Range<f32>| prop::array::uniform3(range).prop_map(Vec3::from);
    let parts = Parts {
        ray: any_unit().boxed(),
        rays: (0f32..6.0).boxed(),
        centre: vector(-4.0..28.0).boxed(),
        radius: (0.5f32..12.0).boxed(),
        vector: vector(-9.0..9.0).boxed(),
        value: brushes::valid,
    };
    (brush_use(&parts), vector(0.0..24.0), vector(-1.0..1.0)).prop_map(
        |(mut used, target, from)| {
            if let Contact::Footprint(footprint) = &mut used.contact {
                footprint.eye_vx = target + from.normalize_or(Vec3::Y) * 60.0;
                footprint.aim = target - footprint.eye_vx;
            }
            Command::Brush(used)
        },
    )
}

/// Returns commands about areas and copies, with values that suit a sculpture of 24 voxels.
pub fn area_work() -> impl Strategy<Value = Command> {
    let near = || prop::array::uniform3(-12i32..24).prop_map(IVec3::from);
    prop_oneof![
        12 => brush_command(),
        4 => (op(), small_drawn_solid()).prop_map(|(op, drawn)| Command::DrawnSolid { op, drawn }),
        2 => (area(), prop::option::of(colour()))
            .prop_map(|(area, colour)| Command::Fill { area, colour }),
        2 => area().prop_map(|area| Command::Clear { area }),
        2 => (area(), colour()).prop_map(|(area, colour)| Command::Dye { area, colour }),
        3 => (area(), tint()).prop_map(|(area, tint)| Command::Tint { area, tint }),
        2 => (prop::array::uniform3(0i32..24), colour(), 0.0f32..1.0).prop_map(
            |(at, colour, tolerance)| Command::Flood { at: at.into(), colour, tolerance },
        ),
        4 => mask(small_drawn_solid(), 0..24, 0.0f32..1.0, 1..4).prop_map(Command::Mask),
        8 => marker(-6..24, 20).prop_map(Command::Mark),
        6 => prop::sample::select(&SelectOp::ALL[..]).prop_map(Command::Select),
        3 => any::<bool>().prop_map(Command::Limit),
        2 => symmetry().prop_map(Command::Symmetry),
        4 => Just(Command::Copy),
        4 => Just(Command::Cut),
        6 => (near(), orientation())
            .prop_map(|(at, orientation)| Command::Paste { at, orientation }),
        4 => (near(), orientation())
            .prop_map(|(by, orientation)| Command::Move { by, orientation }),
        1 => orientation().prop_map(Command::Orient),
        3 => (0u32..4, near()).prop_map(|(count, step)| Command::Array { count, step }),
        4 => repair(|| 0.5f32..6.0).prop_map(Command::Repair),
        2 => surface_kind().prop_map(Command::Surface),
    ]
}

/// Returns changes of colours that are possible.
fn tint() -> impl Strategy<Value = Tint> {
    let point = || prop::array::uniform3(-9.0f32..30.0).prop_map(Vec3::from);
    prop_oneof![
        (-360.0f32..360.0, 0.0f32..3.0, 0.0f32..3.0).prop_map(|(hue_deg, saturation, value)| {
            Tint::Adjust { hue_deg, saturation, value }
        }),
        (point(), point(), colour(), colour(), 0.0f32..1.0).prop_map(
            |(from_vx, to_vx, from, to, strength)| Tint::Gradient {
                from_vx,
                to_vx,
                colours: [from, to],
                strength,
            }
        ),
        (colour(), 1.0f32..40.0, 0.0f32..1.0, any::<u32>())
            .prop_map(|(colour, size, amount, seed)| Tint::Noise { colour, size, amount, seed }),
    ]
}

/// Returns changes of colours with any numbers.
fn any_tint() -> impl Strategy<Value = Tint> {
    (tint(), any_vec3()).prop_map(|(tint, any)| match tint {
        Tint::Adjust { .. } => Tint::Adjust { hue_deg: any.x, saturation: any.y, value: any.z },
        Tint::Gradient { to_vx, colours, .. } => {
            Tint::Gradient { from_vx: any, to_vx, colours, strength: any.x }
        }
        Tint::Noise { colour, seed, .. } => {
            Tint::Noise { colour, size: any.x, amount: any.y, seed }
        }
    })
}

/// Returns changes of the canvas of a small sculpture, which grows by numbers of voxels.
pub fn canvas_change(by_vx: impl Strategy<Value = u32>) -> impl Strategy<Value = CanvasChange> {
    let flags = || prop::array::uniform3(any::<bool>());
    let sides = (flags(), flags())
        .prop_map(|(low, high)| CanvasSides { low, high })
        .prop_filter("some side", |sides| sides.low != [false; 3] || sides.high != [false; 3]);
    prop_oneof![
        2 => prop::array::uniform3(1u32..40).prop_map(|dims| CanvasChange::Size(dims.into())),
        3 => (by_vx, sides).prop_map(|(by_vx, sides)| CanvasChange::Grow { by_vx, sides }),
        2 => Just(CanvasChange::Crop),
        2 => prop_oneof![3 => Just(true), 1 => Just(false)].prop_map(CanvasChange::Auto),
    ]
}

fn surface_kind() -> impl Strategy<Value = SurfaceKind> {
    prop::sample::select(&SurfaceKind::NAMED[..]).prop_map(|(kind, _)| kind)
}

/// Returns repairs with lengths in `length`.
fn repair<S: Strategy<Value = f32>>(length: impl Fn() -> S) -> impl Strategy<Value = Repair> {
    let smaller = || prop::option::of(any::<u32>());
    prop_oneof![
        (prop::sample::select(&Keep::ALL[..]), smaller())
            .prop_map(|(keep, smaller_vx)| Repair::RemoveIslands { keep, smaller_vx }),
        smaller().prop_map(|smaller_vx| Repair::FillCavities { smaller_vx }),
        length().prop_map(|to_vx| Repair::Thicken { to_vx }),
        (length(), prop::sample::select(&Toward::ALL[..]))
            .prop_map(|(diameter_vx, toward)| Repair::Drain { diameter_vx, toward }),
    ]
}

fn any_unit() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-1f32..1.0).prop_map(Vec3::from)
}

/// Returns every finite `f32`, not only those near 1.
pub fn any_number() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |v| v.is_finite())
}

fn any_vec3() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(any_number()).prop_map(Vec3::from)
}

/// Returns every command, with every value that its text form can express.
pub fn any_command() -> impl Strategy<Value = Command> {
    let steps = || prop::option::of(any::<u32>());
    let solid = prop::sample::select(&Solid::ALL[..]);
    let to = prop::option::of(any_vec3());
    let construct = (op(), solid, any_vec3(), any_vec3(), rotation(), to).prop_map(
        |(op, solid, centre_vx, half, rotation, to_vx)| Command::Construct {
            op,
            primitive: Primitive { solid, centre_vx, half, rotation },
            to_vx,
        },
    );
    let room = prop_oneof![Just(0), any::<u32>()];
    let new = (new_sculpture(9), any::<[u32; 3]>(), any_vec3(), room, any::<bool>()).prop_map(
        |(new, dims, voxel_size, room_vx, grows)| {
            let dims = dims.into();
            Command::New(NewSculpture { dims, voxel_size, room_vx, grows, ..new })
        },
    );
    let size = any::<[u32; 3]>().prop_map(|dims| CanvasChange::Size(dims.into()));
    let canvas = canvas_change(any::<u32>()).prop_map(Command::Canvas);
    let place =
        (rotation(), any_vec3(), any_number()).prop_map(|(rotation, translation, scale)| {
            Command::Place(Placement { rotation, translation, scale })
        });
    let any_solid = prop::sample::select(&Solid::ALL[..]);
    let texture = (path(), any_solid, any_vec3(), any_vec3(), rotation()).prop_map(
        |(picture, solid, centre_vx, half, rotation)| Command::Texture {
            picture,
            primitive: Primitive { solid, centre_vx, half, rotation },
        },
    );
    let mark = (any_ivec3(), any_ivec3())
        .prop_map(|(a, b)| VoxelBox { min: a.min(b), max: a.max(b) })
        .prop_filter("not empty", |marker| !marker.is_empty())
        .prop_map(Command::Mark);
    prop_oneof![
        new,
        brush_use(&anywhere()).prop_map(Command::Brush),
        stencil(&anywhere()).prop_map(Command::Brush),
        (path(), import()).prop_map(|(path, import)| Command::Open { path, import }),
        (path(), export()).prop_map(|(path, export)| Command::Save { path, export }),
        (path(), any::<Vec<u8>>())
            .prop_map(|(path, file)| Command::Embed { path, file: file.into() }),
        hostile_text().prop_map(|label| Command::Begin { label }),
        Just(Command::End),
        Just(Command::Cancel),
        construct,
        (op(), drawn_solid(any_vec3(), any_number()))
            .prop_map(|(op, drawn)| Command::DrawnSolid { op, drawn }),
        texture,
        (area(), prop::option::of(colour()))
            .prop_map(|(area, colour)| Command::Fill { area, colour }),
        area().prop_map(|area| Command::Clear { area }),
        (area(), colour()).prop_map(|(area, colour)| Command::Dye { area, colour }),
        (area(), any_tint()).prop_map(|(area, tint)| Command::Tint { area, tint }),
        mask(drawn_solid(any_vec3(), any_number()), i32::MIN..i32::MAX, -1e9f32..1e9, 0..u32::MAX)
            .prop_map(Command::Mask),
        (any::<[i32; 3]>(), colour(), any_number()).prop_map(|(at, colour, tolerance)| {
            Command::Flood { at: at.into(), colour, tolerance }
        }),
        mark,
        prop::sample::select(&SelectOp::ALL[..]).prop_map(Command::Select),
        any::<bool>().prop_map(Command::Limit),
        any::<bool>().prop_map(Command::Irreversible),
        symmetry().prop_map(Command::Symmetry),
        Just(Command::Copy),
        Just(Command::Cut),
        (any_ivec3(), orientation())
            .prop_map(|(at, orientation)| Command::Paste { at, orientation }),
        (any_ivec3(), orientation())
            .prop_map(|(by, orientation)| Command::Move { by, orientation }),
        (any::<u32>(), any_ivec3()).prop_map(|(count, step)| Command::Array { count, step }),
        orientation().prop_map(Command::Orient),
        any_number().prop_map(|factor| Command::Resample(Resolution::Factor(factor))),
        any::<[u32; 3]>().prop_map(|dims| Command::Resample(Resolution::Dims(dims.into()))),
        size.prop_map(Command::Canvas),
        canvas,
        repair(any_number).prop_map(Command::Repair),
        surface_kind().prop_map(Command::Surface),
        steps().prop_map(|steps| Command::Undo { steps }),
        steps().prop_map(|steps| Command::Redo { steps }),
        place,
    ]
}

/// Returns uses of brushes with vectors and radii that only the text form can express.
fn anywhere() -> Parts {
    Parts {
        ray: any_vec3().boxed(),
        rays: any_number().boxed(),
        centre: any_vec3().boxed(),
        radius: any_number().boxed(),
        vector: any_vec3().boxed(),
        value: brushes::valid,
    }
}

/// Returns commands of normal work on a small sculpture, in and out of strokes.
pub fn work() -> impl Strategy<Value = Command> {
    let steps = || prop_oneof![4 => (1u32..4).prop_map(Some), 1 => Just(None)];
    let to = prop::option::of(prop::array::uniform3(-4f32..28.0).prop_map(Vec3::from));
    let edit = (op(), primitive(-4.0..28.0, 0.3..14.0), to)
        .prop_map(|(op, primitive, to_vx)| Command::Construct { op, primitive, to_vx });
    prop_oneof![
        20 => edit,
        2 => prop::option::of(colour())
            .prop_map(|colour| Command::Fill { area: Area::Grid, colour }),
        1 => Just(Command::Clear { area: Area::Grid }),
        4 => Just(Command::Begin { label: "stroke".into() }),
        4 => Just(Command::End),
        1 => Just(Command::Cancel),
        3 => steps().prop_map(|steps| Command::Undo { steps }),
        3 => steps().prop_map(|steps| Command::Redo { steps }),
        1 => new_sculpture(24).prop_map(Command::New),
        1 => orientation().prop_map(Command::Orient),
        1 => placement().prop_map(Command::Place),
    ]
}
