//! Tests that every kind of mesh of every kind of grid is a closed manifold around its voxels.

use std::collections::BTreeMap;

use glam::{IVec3, UVec3, Vec3};

use super::check::{Sound, check, welded};
use crate::mesh::{Mesh, MeshError, MeshKind, VertexColours};
use crate::progress::{Progress, ProgressReport};
use crate::refusal::{MemoryBudget, OverBudget};
use crate::scenes::{self, Random, grid_of};
use crate::sculpture::brick::{Brick, local_index};
use crate::sculpture::history::Contents;
use crate::sculpture::region::VoxelBox;
use crate::sculpture::{ColourDepth, Grid, Limits, Material, Rgb};

const KINDS: [MeshKind; 3] = [MeshKind::Faces, MeshKind::Greedy, MeshKind::Smooth];

pub fn contents(grid: Grid) -> Contents {
    let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
    Contents::new(grid, material)
}

pub fn mesh(contents: &Contents, kind: MeshKind) -> Mesh {
    Mesh::of(contents, kind, VertexColours::Voxels, &Limits::default(), &()).unwrap()
}

/// Checks a mesh, and also its positions alone.
fn sound(name: &str, mesh: &Mesh) -> Sound {
    let positions: Vec<Vec3> = mesh.positions().collect();
    let triangles: Vec<[u32; 3]> = mesh.triangles().collect();
    assert_eq!(triangles.len() as u64, mesh.triangle_count());
    assert_eq!(positions.len() as u64, mesh.vertex_count());
    let sound = check(&positions, &triangles).unwrap_or_else(|fault| panic!("{name}: {fault}"));
    let (positions, triangles) = welded(&positions, &triangles);
    let alone =
        check(&positions, &triangles).unwrap_or_else(|fault| panic!("{name}, welded: {fault}"));
    assert_eq!((alone.surfaces, alone.handles), (sound.surfaces, sound.handles), "{name}");
    assert!((mesh.volume_vx() - sound.volume).abs() <= 1e-6 * sound.volume.abs(), "{name}");
    assert!(sound.least_area > 1e-6, "{name}: a triangle of area {}", sound.least_area);
    sound
}

fn of_bits(dims: UVec3, mut exists: impl FnMut(IVec3) -> bool) -> Grid {
    let mut grid = Grid::new(dims, Vec3::ONE, 1 << 24).unwrap();
    grid.fill_bricks(|_| Brick::EMPTY);
    for z in 0..dims.z as i32 {
        for y in 0..dims.y as i32 {
            for x in 0..dims.x as i32 {
                let v = IVec3::new(x, y, z);
                if exists(v) {
                    grid.set(v, true);
                }
            }
        }
    }
    grid
}

pub fn noise(dims: UVec3, share: f32, seed: u64) -> Grid {
    let mut random = Random(seed);
    of_bits(dims, |_| random.unit() < share)
}

/// Returns the number of pieces; voxels that share a face belong to one piece.
fn pieces(grid: &Grid) -> usize {
    let (dims, mut seen) = (grid.dims(), std::collections::HashSet::new());
    let mut count = 0;
    for index in 0..dims.element_product() {
        let mut open = vec![grid.voxel_coords(index).as_ivec3()];
        if !grid.get(open[0]) || !seen.insert(open[0]) {
            continue;
        }
        count += 1;
        while let Some(v) = open.pop() {
            for step in [IVec3::X, IVec3::Y, IVec3::Z] {
                for next in [v + step, v - step] {
                    if grid.get(next) && seen.insert(next) {
                        open.push(next);
                    }
                }
            }
        }
    }
    count
}

#[test]
fn simple_solids_have_the_topology_that_they_should() {
    let ball = |p: Vec3| p.distance(Vec3::splat(10.0)) < 7.0;
    let ring = |p: Vec3| ((p.x - 10.0).hypot(p.y - 10.0) - 6.0).hypot(p.z - 10.0) < 3.0;
    let cases: [(&str, Grid, [i64; 2]); 6] = [
        ("one voxel", of_bits(UVec3::ONE, |_| true), [1, 0]),
        ("full", of_bits(UVec3::new(9, 16, 17), |_| true), [1, 0]),
        ("ball", grid_of(20, ball), [1, 0]),
        ("hollow", grid_of(20, |p| ball(p) && p.distance(Vec3::splat(10.0)) > 4.0), [2, 0]),
        ("ring", grid_of(20, ring), [1, 1]),
        ("two voxels across an edge", of_bits(UVec3::new(2, 2, 1), |v| v.x == v.y), [2, 0]),
    ];
    for (name, grid, [surfaces, handles]) in cases {
        let contents = contents(grid);
        for kind in KINDS {
            let sound = sound(name, &mesh(&contents, kind));
            assert_eq!((sound.surfaces as i64, sound.handles), (surfaces, handles), "{name}");
            assert!(sound.volume > 0.0);
        }
    }
}

#[test]
fn meshes_of_voxels_enclose_exactly_their_volume() {
    for (name, grid) in [
        ("full", of_bits(UVec3::new(65, 8, 33), |_| true)),
        ("engine", scenes::engine_like(48).unwrap()),
    ] {
        let contents = contents(grid);
        let sound = sound(name, &mesh(&contents, MeshKind::Faces));
        let voxels = contents.grid.opaque_count() as f64;
        // Only where voxels touch in an edge or a corner is a little missing.
        assert!(
            (sound.volume - voxels).abs() <= 1e-3 * voxels,
            "{name}: {} {voxels}",
            sound.volume
        );
    }
}

#[test]
fn any_contact_of_voxels_is_a_manifold() {
    // Two, three and four voxels per axis: all contacts, also at borders of words and parts.
    for pattern in 0..256u32 {
        let grid = of_bits(UVec3::splat(2), |v| pattern >> (v.x + 2 * v.y + 4 * v.z) & 1 != 0);
        let contents = contents(grid);
        for kind in KINDS {
            let sound = sound(&format!("{pattern:08b} {kind:?}"), &mesh(&contents, kind));
            assert_eq!(sound.surfaces, pieces(&contents.grid), "{pattern:08b}");
        }
    }
    for seed in 0..12 {
        let share = [0.1, 0.3, 0.5, 0.6, 0.8, 0.95][seed as usize % 6];
        let dims = [UVec3::new(67, 9, 18), UVec3::splat(17)][seed as usize % 2];
        let contents = contents(noise(dims, share, seed));
        for kind in KINDS {
            let sound = sound(&format!("noise {seed} {kind:?}"), &mesh(&contents, kind));
            assert!(sound.surfaces >= pieces(&contents.grid));
        }
    }
    for parity in [0, 1] {
        let contents = contents(of_bits(UVec3::splat(9), |v| v.element_sum() & 1 == parity));
        for kind in KINDS {
            let sound = sound("checkerboard", &mesh(&contents, kind));
            assert_eq!((sound.surfaces as u64, sound.handles), (contents.grid.opaque_count(), 0));
        }
    }
}

#[test]
fn the_smooth_mesh_keeps_the_volume_within_a_hundredth() {
    // The smooth surface rounds sharp edges by about a voxel, so solids must not be too small.
    let middle = Vec3::splat(32.0);
    let box_of = |p: Vec3| (p - middle).abs().cmplt(Vec3::new(29.0, 22.0, 18.0)).all();
    let tilted = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.5, 0.3, 0.2);
    let cases = [
        ("ball", grid_of(64, |p| p.distance(middle) < 20.0)),
        ("box", grid_of(64, box_of)),
        ("tilted box", grid_of(64, |p| box_of(tilted * (p - middle) + middle))),
        ("full", of_bits(UVec3::splat(48), |_| true)),
        ("cheese", scenes::cheese(64, 12, 5).unwrap()),
    ];
    for (name, grid) in cases {
        let contents = contents(grid);
        let sound = sound(name, &mesh(&contents, MeshKind::Smooth));
        let share = sound.volume / contents.grid.opaque_count() as f64;
        assert!((share - 1.0).abs() < 0.01, "{name}: {share}");
    }
}

#[test]
fn smooth_vertices_lie_on_the_shape() {
    let (middle, radius) = (Vec3::splat(24.3), 18.6);
    let contents = contents(grid_of(48, |p| p.distance(middle) < radius));
    let errors: Vec<f32> = mesh(&contents, MeshKind::Smooth)
        .positions()
        .map(|position| position.distance(middle) - radius)
        .collect();
    let mean = errors.iter().sum::<f32>() / errors.len() as f32;
    let square = errors.iter().map(|error| error * error).sum::<f32>() / errors.len() as f32;
    assert!(mean.abs() < 0.05 && square.sqrt() < 0.08, "mean {mean}, deviation {}", square.sqrt());
}

#[test]
fn a_grid_without_voxels_has_a_mesh_without_faces() {
    let contents = contents(of_bits(UVec3::new(9, 4, 3), |_| false));
    for kind in KINDS {
        let mesh = mesh(&contents, kind);
        assert_eq!((mesh.vertex_count(), mesh.triangle_count()), (0, 0));
    }
}

#[test]
fn any_number_of_threads_makes_the_same_mesh() {
    let contents = contents(noise(UVec3::new(70, 20, 61), 0.5, 9));
    for kind in KINDS {
        let made = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| mesh(&contents, kind))
        });
        assert!(made[0] == made[1] && made[0] == made[2], "{kind:?}");
    }
}

#[test]
fn vertices_have_the_mean_colour_of_their_voxels() {
    let mut contents = contents(of_bits(UVec3::new(2, 1, 1), |_| true));
    let red = Rgb::new(255, 0, 0);
    let mut first = Brick::EMPTY;
    first.set(0, 0, 0, true);
    contents.material.paint(UVec3::ZERO, &first, red);
    assert_eq!(contents.material.rgb(UVec3::ZERO, local_index(0, 0, 0)), red);
    for kind in KINDS {
        let mesh = mesh(&contents, kind);
        assert!(mesh.is_coloured());
        let mut count: BTreeMap<[u8; 3], usize> = BTreeMap::new();
        for (position, colour) in mesh.positions().zip(mesh.colours()) {
            *count.entry(colour.0).or_default() += 1;
            if position.x < 0.9 {
                assert_eq!(colour, red);
            }
        }
        let Rgb([r, g, b]) = Rgb::STONE;
        let mixed = [(255 + u32::from(r)).div_ceil(2) as u8, g.div_ceil(2), b.div_ceil(2)];
        assert_eq!(count, BTreeMap::from([(red.0, 4), (Rgb::STONE.0, 4), (mixed, 4)]));
    }
}

#[test]
fn faces_are_not_merged_where_colours_change() {
    let mut contents = contents(of_bits(UVec3::new(16, 16, 8), |_| true));
    contents.material.paint(UVec3::ZERO, &Brick::FULL, Rgb::new(0, 0, 255));
    let colours = |kind| {
        let mesh = mesh(&contents, kind);
        let all = mesh.positions().zip(mesh.colours());
        all.map(|(position, colour)| (position.to_array().map(f32::to_bits), colour.0))
            .collect::<BTreeMap<_, _>>()
    };
    let (merged, faces) = (colours(MeshKind::Greedy), colours(MeshKind::Faces));
    assert!(merged.len() * 2 < faces.len(), "{} of {}", merged.len(), faces.len());
    assert!(merged.iter().all(|(position, colour)| faces[position] == *colour));
    // Every mixed colour is preserved.
    let mixed = |all: &BTreeMap<[u32; 3], [u8; 3]>| {
        all.values().filter(|colour| ![[0, 0, 255], Rgb::STONE.0].contains(colour)).count()
    };
    assert_eq!(mixed(&merged), mixed(&faces));
}

#[test]
fn a_cancelled_mesh_is_an_error() {
    let contents = contents(of_bits(UVec3::splat(8), |_| true));
    let report = ProgressReport::default();
    report.cancel();
    assert!(report.is_cancelled());
    for kind in KINDS {
        let made = Mesh::of(&contents, kind, VertexColours::Voxels, &Limits::default(), &report);
        assert!(matches!(made, Err(MeshError::Cancelled)));
    }
}

#[test]
fn a_mesh_that_takes_too_much_memory_is_refused() {
    let contents = contents(noise(UVec3::splat(40), 0.5, 3));
    for kind in KINDS {
        let limits = Limits { grid_bytes: 100 << 10, colour_bytes: 0, ..Limits::default() };
        let error = Mesh::of(&contents, kind, VertexColours::Voxels, &limits, &()).unwrap_err();
        let MeshError::OverBudget(over) = &error else { panic!("{kind:?}: {error}") };
        assert!((1..8).contains(&over.needed_mib), "{kind:?}: {error}");
        assert_eq!(over.budget_mib, 0, "{kind:?}: {error}");
    }
    // Every mesh takes at most its counted bytes.
    for kind in KINDS {
        let mesh = mesh(&contents, kind);
        let limits =
            Limits { grid_bytes: mesh.heap_bytes() - 1, colour_bytes: 0, ..Limits::default() };
        let made = Mesh::of(&contents, kind, VertexColours::Voxels, &limits, &());
        assert!(
            matches!(
                made,
                Err(MeshError::OverBudget(OverBudget {
                    budget: MemoryBudget::GridsAndColours,
                    ..
                }))
            ),
            "{kind:?}"
        );
    }
}

#[test]
fn the_longest_grids_have_a_smooth_mesh() {
    for axis in 0..3 {
        let volume = |length: u32| {
            let mut dims = UVec3::splat(7);
            dims[axis] = length;
            let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
            let (mut min, mut max) = (IVec3::splat(2), IVec3::splat(5));
            (min[axis], max[axis]) = (0, length as i32);
            grid.fill_box(VoxelBox { min, max });
            let mesh = mesh(&contents(grid), MeshKind::Smooth);
            assert_eq!(sound("a beam", &mesh).surfaces, 1);
            mesh.volume_vx()
        };
        let a_brick = (volume(8176) - volume(8000)) / 22.0;
        assert!((volume(8192) - volume(8176) - 2.0 * a_brick).abs() < 0.1, "along axis {axis}");
    }
}
