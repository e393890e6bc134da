//! Solids along the grid's axes in each of the 48 orientations (24 rotations and their mirror images), compared with
//! integer maps of axes and directions.

use glam::{DVec3, IVec3, Quat, UVec3, Vec3};
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{Document, Limits};
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::{ColourDepth, Grid, Rgb};
use sculpture_core::tools::solid::{Primitive, Solid};
use sculpture_core::tools::symmetry::{Parity, Symmetry};

/// The grid's axis and the sign for each axis of a tool.
type AxisMap = [(usize, f64); 3];

/// Returns the 24 rotations, with the quaternion of each computed from its matrix.
fn turns() -> Vec<(AxisMap, Quat)> {
    let mut all = Vec::new();
    for [x, y, z] in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]] {
        for signs in 0..8 {
            let sign = |i: usize| if signs >> i & 1 == 0 { 1.0 } else { -1.0 };
            let map = [(x, sign(0)), (y, sign(1)), (z, sign(2))];
            let column = |(axis, sign): (usize, f64)| {
                let mut column = Vec3::ZERO;
                column[axis] = sign as f32;
                column
            };
            let matrix = glam::Mat3::from_cols(column(map[0]), column(map[1]), column(map[2]));
            if matrix.determinant() > 0.0 {
                all.push((map, Quat::from_mat3(&matrix)));
            }
        }
    }
    assert_eq!(all.len(), 24);
    all
}

/// Returns whether `p` in tool space, where the solid fills [-1, 1], is inside.
fn inside(solid: Solid, p: [f64; 3], half: [f64; 3]) -> bool {
    let [x, y, z] = p.map(f64::abs);
    let around = (x * x + z * z).sqrt();
    // Radius of a tube, a cap, an edge in voxels.
    let width = half[0].min(half[2]);
    let beyond = |radius: f64, i: usize| ([x, y, z][i] * half[i] - half[i] + radius).max(0.0);
    match solid {
        Solid::Cylinder => around <= 1.0 && y <= 1.0,
        Solid::Cone => y <= 1.0 && 2.0 * around <= 1.0 - p[1],
        Solid::Torus => {
            let tube = half[1].min(width / 3.0);
            (around * width - width + tube).hypot(y * half[1]) <= tube
        }
        Solid::Capsule => {
            let cap = width.min(half[1]);
            around.hypot(beyond(cap, 1) / cap) <= 1.0
        }
        Solid::RoundedCuboid => {
            let edge = width.min(half[1]) / 3.0;
            beyond(edge, 0).hypot(beyond(edge, 1)).hypot(beyond(edge, 2)) <= edge
        }
        Solid::Ellipsoid => x * x + y * y + z * z <= 1.0,
        Solid::Cuboid => x <= 1.0 && y <= 1.0 && z <= 1.0,
        Solid::Pyramid => y <= 1.0 && 2.0 * x <= 1.0 - p[1] && 2.0 * z <= 1.0 - p[1],
    }
}

/// Returns whether the solid covers the point `v` (voxels).
fn covers(primitive: &Primitive, map: &AxisMap, voxel_size: Vec3, v: DVec3) -> bool {
    let stretch = voxel_size.as_dvec3() / f64::from(voxel_size.min_element());
    let offset = (v - primitive.centre_vx.as_dvec3()) * stretch;
    let p = [0, 1, 2].map(|i| map[i].1 * offset[map[i].0] / f64::from(primitive.half[i]));
    inside(primitive.solid, p, primitive.half.as_dvec3().to_array())
}

fn grid_with(new: &NewSculpture, symmetry: Symmetry, op: EditOp, primitive: Primitive) -> Grid {
    let mut document = Document::new(new, Limits::default()).unwrap();
    document.apply(&Command::Symmetry(symmetry)).unwrap();
    document.apply(&Command::Construct { op, primitive, to_vx: None }).unwrap();
    document.grid().clone()
}

/// The voxels around a grid among which the images of its voxels lie.
const MARGIN: i32 = 2;

#[test]
fn solids_and_their_mirror_images_equal_whole_numbers_in_all_48_orientations() {
    let dims = UVec3::new(21, 24, 19);
    let table_dims = dims + 2 * MARGIN as u32;
    let symmetries = (0..27).map(|i| {
        let parity = |i: u32| [None, Some(Parity::Even), Some(Parity::Odd)][i as usize % 3];
        Symmetry::of_axes([parity(i), parity(i / 3), parity(i / 9)])
    });
    let symmetries: Vec<Symmetry> = symmetries.collect();
    for (i, (map, rotation)) in turns().into_iter().enumerate() {
        let voxel_size = [Vec3::ONE, Vec3::new(1.0, 1.5, 2.0)][i % 2];
        for solid in Solid::ALL {
            let primitive = Primitive {
                solid,
                centre_vx: Vec3::new(7.13, 9.31, 6.22),
                half: Vec3::new(3.3, 5.21, 7.47),
                rotation,
            };
            let (filled, op) = match i % 3 {
                0 => (true, EditOp::Subtract),
                _ => (false, EditOp::Add(None)),
            };
            let new = NewSculpture {
                dims,
                voxel_size,
                colour_depth: ColourDepth::None,
                base: Rgb::STONE,
                solid: filled,
                room_vx: 0,
                grows: false,
            };
            let covered = (0..table_dims.element_product()).map(|index| {
                let v = UVec3::new(
                    index % table_dims.x,
                    index / table_dims.x % table_dims.y,
                    index / (table_dims.x * table_dims.y),
                );
                covers(&primitive, &map, voxel_size, v.as_dvec3() + 0.5 - f64::from(MARGIN))
            });
            let covered: Vec<bool> = covered.collect();
            let is_covered = |v: IVec3| {
                let [x, y, z] = (v + MARGIN).as_uvec3().to_array();
                covered[(x + table_dims.x * (y + table_dims.y * z)) as usize]
            };
            for symmetry in &symmetries {
                let grid = grid_with(&new, *symmetry, op, primitive);
                assert_voxels(&grid, symmetry, filled, &is_covered, &primitive);
            }
        }
    }
}

/// Asserts that the voxels are those which differ from `filled` where they or one of their mirror images are covered.
fn assert_voxels(
    grid: &Grid,
    symmetry: &Symmetry,
    filled: bool,
    is_covered: &dyn Fn(IVec3) -> bool,
    primitive: &Primitive,
) {
    // The place of each plane, times two.
    let planes = [0, 1, 2].map(|axis| {
        let odd = i32::from(symmetry.axes[axis] == Some(Parity::Odd));
        2 * (grid.dims()[axis] as i32 / 2) + odd
    });
    let has_image =
        |image: &u32| (0..3).all(|axis| image >> axis & 1 == 0 || symmetry.axes[axis].is_some());
    let images: Vec<u32> = (0..8).filter(has_image).collect();
    for voxel in 0..grid.dims().element_product() {
        let v = grid.voxel_coords(voxel).as_ivec3();
        let covered = images.iter().any(|image| {
            let mirrored = |axis: usize| match image >> axis & 1 {
                0 => v[axis],
                _ => planes[axis] - 1 - v[axis],
            };
            is_covered(IVec3::from([0, 1, 2].map(mirrored)))
        });
        assert_eq!(grid.get(v), covered != filled, "{v} {symmetry:?} {primitive:?}");
    }
}

#[test]
fn a_cuboid_and_its_image_across_any_axis_have_all_their_voxels() {
    for axis in ["x", "y", "z", "x=even y", "y=even z", "x=even z", "x=odd y=even z"] {
        for turn in ["0,0,0,1", "1,0,0,0", "0,1,0,0", "0,0,1,0", "0,90,0", "180,0,90"] {
            let new = "new dims=64,64,64 fill=empty".parse().unwrap();
            let Command::New(new) = new else { panic!("not new") };
            let mut document = Document::new(&new, Limits::default()).unwrap();
            let add = format!("add cuboid at=16,16,16 half=8 turn={turn} colour=#808080");
            document.apply(&format!("symmetry {axis}=even").parse().unwrap()).unwrap();
            document.apply(&add.parse().unwrap()).unwrap();
            let images = 1 << axis.split(' ').count();
            // The odd plane passes through a voxel, but the images still do not touch.
            assert_eq!(document.grid().opaque_count(), 4096 * images, "{axis} {turn}");
            assert!(document.grid().get(IVec3::splat(8)));
        }
    }
}

/// Also where faces pass through the centres of voxels, in any orientation.
#[test]
fn edits_with_a_mirror_plane_are_symmetric_to_the_voxel() {
    let turns = ["0,90,0", "0,45,0", "30,0,0", "0,0,180", "10,20,30", "45,45,45"];
    for (turn, solid) in turns.iter().flat_map(|t| Solid::ALL.map(|solid| (t, solid))) {
        for axis in 0..3 {
            let Ok(Command::New(new)) = "new dims=40,40,40 fill=empty".parse() else {
                panic!("not new")
            };
            let mut document = Document::new(&new, Limits::default()).unwrap();
            let name = ["x", "y", "z"][axis];
            document.apply(&format!("symmetry {name}=even").parse().unwrap()).unwrap();
            let add = format!(
                "add {} at=16.5,14.5,18.5 half=8,6,7 turn={turn} colour=#808080",
                solid.name()
            );
            document.apply(&add.parse().unwrap()).unwrap();
            let grid = document.grid();
            for voxel in 0..40u32.pow(3) {
                let v = grid.voxel_coords(voxel).as_ivec3();
                let mut other = v;
                other[axis] = 39 - v[axis];
                assert_eq!(grid.get(v), grid.get(other), "{v} {turn} {solid:?} {name}");
            }
        }
    }
}
