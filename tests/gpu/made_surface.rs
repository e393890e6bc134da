//! The preview of a solid over the surface that it has just made: it is shown evenly, however the steps of the voxels lie
//! about its faces, from everywhere, in every mode; and what lies a few voxels behind a surface stays hidden.

use std::f32::consts::PI;

use glam::{EulerRot, Quat, UVec3, Vec3};
use virtual_sculpture::command::Command;
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::render::overlay::ToolPreview;
use virtual_sculpture::render::{RenderMode, SmoothSurface};
use virtual_sculpture::sculpture::edit::EditOp;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material};
use virtual_sculpture::shade::Pixels;
use virtual_sculpture::tools::solid::{Primitive, Solid};
use virtual_sculpture::view::{Camera, Eye};

use super::coplanar::{FACE, Painter, SIZE, STONE, painter};
use super::fixture::with_device;

/// The preview alone is asked about where it covers this many pixels to each side.
const INSIDE_PX: u32 = 1;

fn turned() -> Quat {
    Quat::from_euler(EulerRot::XYZ, 0.4, 0.7, 1.1)
}

fn empty(edge: u32, voxel_size: Vec3) -> Document {
    let grid = Grid::new(UVec3::splat(edge), voxel_size, 1 << 30).unwrap();
    let material = Material::for_grid(&grid, ColourDepth::None, STONE);
    Document::from_contents(Contents::new(grid, material), Limits::default())
}

fn apply(document: &mut Document, op: EditOp, primitive: Primitive) {
    document.apply(&Command::Construct { op, primitive, to_vx: None }).unwrap();
}

/// Shown before the sculpture only.
fn preview(primitive: Primitive, voxel_size: Vec3) -> ToolPreview {
    ToolPreview { primitive, voxel_size, colour: FACE, opacity: [1.0, 0.0] }
}

/// Eyes about a solid: near, aslant, far, parallel, and low over one of its faces.
fn eyes(primitive: &Primitive) -> Vec<(String, Eye)> {
    let Primitive { centre_vx: target, half, rotation, .. } = *primitive;
    let reach = half.max_element();
    let camera = |towards: Vec3, distance: f32, fov_y_deg: f32| Camera {
        eye: target + towards.normalize() * distance * reach,
        target,
        up: Vec3::new(0.1, 1.0, 0.05),
        fov_y_rad: fov_y_deg * PI / 180.0,
        near: 0.01 * reach,
    };
    let aslant = camera(Vec3::new(0.8, 1.1, 1.3), 4.0, 35.0);
    let mut eyes = vec![
        ("near".to_string(), camera(Vec3::new(0.3, 0.5, 1.0), 2.0, 70.0)),
        ("aslant".to_string(), aslant),
        ("in front".to_string(), camera(Vec3::new(0.02, 0.01, 1.0), 3.5, 40.0)),
        ("far".to_string(), camera(Vec3::new(-1.0, 0.4, 0.7), 60.0, 2.3)),
        ("parallel".to_string(), aslant.orthographic(4.0 * reach, 4.0 * reach)),
    ];
    for degrees in [0.5f32, 2.0, 6.0, 15.0] {
        let up = half.y + 2.5 * reach * degrees.to_radians().tan();
        let from_middle = rotation * Vec3::new(0.4 * reach, up, 2.5 * reach);
        let low = camera(from_middle, from_middle.length() / reach, 50.0);
        eyes.push((format!("{degrees} degrees"), low));
    }
    eyes.into_iter().map(|(name, camera)| (name, camera.eye(SIZE))).collect()
}

fn shows_face(pixels: &Pixels, x: u32, y: u32) -> bool {
    let [r, g, ..] = pixels.rgba[(x + y * SIZE.x) as usize];
    r > 100 && g < 60
}

/// Pixels of the middle of the picture.
fn inner() -> impl Iterator<Item = (u32, u32)> {
    let (columns, rows) = (INSIDE_PX..SIZE.x - INSIDE_PX, INSIDE_PX..SIZE.y - INSIDE_PX);
    rows.flat_map(move |y| columns.clone().map(move |x| (x, y)))
}

/// How many pixels lie wholly on the face that `alone` shows, and how many of them `over` does not show.
fn lacking(alone: &Pixels, over: &Pixels) -> (usize, Vec<(u32, u32)>) {
    let side = 2 * INSIDE_PX + 1;
    let asked: Vec<(u32, u32)> = inner()
        .filter(|&(x, y)| {
            (0..side * side)
                .map(|i| (x + i % side - INSIDE_PX, y + i / side - INSIDE_PX))
                .all(|(x, y)| shows_face(alone, x, y))
        })
        .collect();
    let lacking = asked.iter().copied().filter(|&(x, y)| !shows_face(over, x, y)).collect();
    (asked.len(), lacking)
}

/// Pixels that differ from those on both sides, in a row or in a column.
fn alternating(pixels: &Pixels) -> usize {
    inner()
        .filter(|&(x, y)| {
            let own = shows_face(pixels, x, y);
            let other = |x, y| shows_face(pixels, x, y) != own;
            (other(x - 1, y) && other(x + 1, y)) || (other(x, y - 1) && other(x, y + 1))
        })
        .count()
}

struct Subject {
    primitive: Primitive,
    voxel_size: Vec3,
    edge: u32,
}

fn subject(solid: Solid, rotation: Quat, half: Vec3) -> Subject {
    let edge = (half.max_element() * 3.6) as u32 / 8 * 8;
    let centre_vx = Vec3::splat(edge as f32 * 0.5) + Vec3::new(-0.2, 0.3, 0.1);
    let primitive = Primitive { solid, centre_vx, half, rotation };
    Subject { primitive, voxel_size: Vec3::ONE, edge }
}

/// Adds the solid, and asks about its preview from all sides, and about one three voxels within the surface. Each painter
/// follows one document.
fn ask(painters: &mut [Painter; 2], subject: &Subject, modes: &[(RenderMode, SmoothSurface)]) {
    let [of_bare, of_made] = painters;
    let Subject { primitive, voxel_size, edge } = *subject;
    let solid = primitive.solid;
    let mut bare = empty(edge, voxel_size);
    let mut made = empty(edge, voxel_size);
    apply(&mut made, EditOp::Add(None), primitive);
    let shown = [preview(primitive, voxel_size)];
    let sunk = Primitive {
        half: primitive.half - 3.0 * voxel_size.max_element() / voxel_size.min_element(),
        ..primitive
    };
    for (name, eye) in eyes(&primitive) {
        for &(mode, smooth) in modes {
            of_bare.smooth_surface = smooth;
            of_made.smooth_surface = smooth;
            let about =
                format!("{solid:?} {} {edge} {name} {mode:?} {smooth:?}", primitive.rotation);
            let alone = of_bare.paint(&mut bare, &eye, mode, &shown);
            let over = of_made.paint(&mut made, &eye, mode, &shown);
            let (asked, lacking) = lacking(&alone, &over);
            assert!(asked > 2000, "{about}: {asked} pixels");
            // Quickstep draws larger steps. A torus is hollow towards its hole.
            let few = match (mode, solid) {
                (RenderMode::Quickstep, _) => 50,
                (_, Solid::Torus) => 100,
                _ => 5000,
            };
            assert!(
                lacking.len() * few <= asked,
                "{about}: {} of {asked} pixels show stone, {:?} ...",
                lacking.len(),
                &lacking[..lacking.len().min(6)],
            );
            // Others are not everywhere as deep within as their halves are smaller.
            let sinks = !matches!(solid, Solid::Torus | Solid::Cone | Solid::Capsule);
            if sinks && solid != Solid::RoundedCuboid {
                let within = of_made.paint(&mut made, &eye, mode, &[preview(sunk, voxel_size)]);
                let shining = inner().filter(|&(x, y)| shows_face(&within, x, y)).count();
                assert!(
                    shining * 50 <= asked,
                    "{about}: {shining} of {asked} pixels show what is within"
                );
            }
        }
    }
}

const MARCH: [(RenderMode, SmoothSurface); 1] = [(RenderMode::MarchGpu, SmoothSurface::Never)];

#[test]
fn a_solid_shows_evenly_over_the_surface_that_it_has_just_made() {
    with_device(|device| {
        let mut painters = [painter(device), painter(device)];
        for (solid, rotation) in [
            (Solid::Ellipsoid, Quat::IDENTITY),
            (Solid::Cuboid, Quat::IDENTITY),
            (Solid::Cuboid, turned()),
            (Solid::Cylinder, Quat::IDENTITY),
            (Solid::Cylinder, turned()),
            (Solid::Cone, turned()),
            (Solid::Torus, turned()),
            (Solid::Capsule, turned()),
            (Solid::RoundedCuboid, turned()),
        ] {
            ask(&mut painters, &subject(solid, rotation, Vec3::splat(50.0)), &MARCH);
        }
        ask(
            &mut painters,
            &subject(Solid::Ellipsoid, turned(), Vec3::new(70.0, 20.0, 40.0)),
            &MARCH,
        );
        ask(&mut painters, &subject(Solid::Cuboid, turned(), Vec3::new(80.0, 30.0, 50.0)), &MARCH);
        ask(&mut painters, &subject(Solid::Ellipsoid, Quat::IDENTITY, Vec3::splat(170.0)), &MARCH);
        let thick = subject(Solid::Ellipsoid, Quat::IDENTITY, Vec3::splat(60.0));
        ask(&mut painters, &Subject { voxel_size: Vec3::new(1.0, 1.0, 2.0), ..thick }, &MARCH);
    });
}

#[test]
fn a_solid_shows_evenly_over_what_it_made_in_every_mode() {
    with_device(|device| {
        let mut painters = [painter(device), painter(device)];
        let smooth =
            |mode: &RenderMode| [(*mode, SmoothSurface::Never), (*mode, SmoothSurface::Always)];
        let modes: Vec<_> = RenderMode::ALL.iter().flat_map(smooth).collect();
        for (solid, rotation) in [(Solid::Ellipsoid, Quat::IDENTITY), (Solid::Cuboid, turned())] {
            ask(&mut painters, &subject(solid, rotation, Vec3::splat(40.0)), &modes);
        }
    });
}

#[test]
fn a_solid_two_voxels_behind_a_wall_is_hidden_and_one_before_it_is_shown() {
    with_device(|device| {
        let mut painter = painter(device);
        for (solid, rotation) in [
            (Solid::Ellipsoid, Quat::IDENTITY),
            (Solid::Cuboid, Quat::IDENTITY),
            (Solid::Cylinder, Quat::from_rotation_x(0.5 * PI)),
            (Solid::Torus, Quat::from_rotation_x(0.5 * PI)),
        ] {
            let Subject { primitive, edge, voxel_size } =
                subject(solid, rotation, Vec3::splat(40.0));
            let thick = if solid == Solid::Torus { 40.0 / 3.0 } else { 40.0 };
            let front = (primitive.centre_vx.z + thick).floor();
            let middle = 0.5 * edge as f32;
            let wall = |low: f32| Primitive {
                solid: Solid::Cuboid,
                centre_vx: Vec3::new(middle, middle, low + 2.0),
                half: Vec3::new(middle, middle, 2.0),
                rotation: Quat::IDENTITY,
            };
            let eye = Camera {
                eye: Vec3::new(middle + 5.0, middle + 8.0, 3.0 * edge as f32),
                target: Vec3::splat(middle),
                up: Vec3::Y,
                fov_y_rad: 35f32.to_radians(),
                near: 1.0,
            }
            .eye(SIZE);
            let [mode, shown] =
                [RenderMode::MarchGpu; 2].map(|mode| (mode, preview(primitive, voxel_size)));
            let alone = painter.paint(&mut empty(edge, voxel_size), &eye, mode.0, &[shown.1]);
            let mut behind = empty(edge, voxel_size);
            apply(&mut behind, EditOp::Add(None), primitive);
            apply(&mut behind, EditOp::Add(None), wall(front + 3.0));
            let hidden = painter.paint(&mut behind, &eye, mode.0, &[shown.1]);
            let shining = inner().filter(|&(x, y)| shows_face(&hidden, x, y)).count();
            assert_eq!(shining, 0, "{solid:?}: pixels that show what is behind the wall");
            // The wall that it was made on.
            let mut before = empty(edge, voxel_size);
            apply(&mut before, EditOp::Add(None), wall(front - 60.0));
            let over = painter.paint(&mut before, &eye, mode.0, &[shown.1]);
            let (asked, lacking) = lacking(&alone, &over);
            assert!(asked > 2000 && lacking.is_empty(), "{solid:?}: {} of {asked}", lacking.len());
        }
    });
}

/// Seen from above the hole the shell of the tool fills it up.
#[test]
fn a_solid_shows_evenly_over_the_hole_that_it_has_just_cut() {
    with_device(|device| {
        let mut painter = painter(device);
        for (solid, rotation) in [
            (Solid::Ellipsoid, Quat::IDENTITY),
            (Solid::Cuboid, Quat::IDENTITY),
            (Solid::Cuboid, Quat::from_rotation_y(0.5)),
            (Solid::Cuboid, turned()),
            (Solid::Cylinder, Quat::IDENTITY),
            (Solid::Cone, Quat::IDENTITY),
            (Solid::Torus, Quat::from_rotation_z(0.2)),
        ] {
            let Subject { primitive, edge, voxel_size } =
                subject(solid, rotation, Vec3::splat(40.0));
            let middle = 0.5 * edge as f32;
            // The upper face of a flush cuboid lies in the surface.
            for up in [0.0, middle.floor() - primitive.centre_vx.y - 40.0] {
                let moved = primitive.centre_vx + Vec3::Y * up;
                let tool = Primitive { centre_vx: moved, ..primitive };
                let mut document = empty(edge, voxel_size);
                let block = Primitive {
                    solid: Solid::Cuboid,
                    centre_vx: Vec3::new(middle, 0.5 * middle, middle),
                    half: Vec3::new(middle, 0.5 * middle, middle),
                    rotation: Quat::IDENTITY,
                };
                apply(&mut document, EditOp::Add(None), block);
                apply(&mut document, EditOp::Subtract, tool);
                for (name, eye) in eyes(&Primitive { rotation: Quat::IDENTITY, ..tool }) {
                    let shown = [preview(tool, voxel_size)];
                    let over = painter.paint(&mut document, &eye, RenderMode::MarchGpu, &shown);
                    let found = alternating(&over);
                    // Seen from half a degree above, the face is a line of single pixels.
                    assert!(
                        found < 100,
                        "{solid:?} {rotation} {up} {name}: {found} pixels alternate"
                    );
                }
            }
        }
    });
}
