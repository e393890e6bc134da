//! Tests solids against their analytic volumes, holes, shells, colours, and refused meshes.

use glam::{IVec3, UVec3, Vec2, Vec3};

use super::*;
use crate::sculpture::orientation::Up;
use crate::tools::texture::Texture;

/// Returns a sphere of radius 1: an octahedron whose triangles are divided `times` times.
fn ball(times: u32) -> InputMesh {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let mut faces = Vec::new();
    for octant in 0..8 {
        let signed = |axis: usize| axes[axis] * if octant >> axis & 1 != 0 { -1.0 } else { 1.0 };
        let [a, b, c] = [signed(0), signed(1), signed(2)];
        faces.push(if (octant as u32).count_ones().is_multiple_of(2) {
            [a, b, c]
        } else {
            [a, c, b]
        });
    }
    for _ in 0..times {
        let divide = |[a, b, c]: [Vec3; 3]| {
            let [d, e, f] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        faces = faces.into_iter().flat_map(divide).collect();
    }
    soup(&faces)
}

/// Returns a box with outward faces.
fn cuboid(low: Vec3, high: Vec3) -> Vec<[Vec3; 3]> {
    let corner = |i: usize| {
        Vec3::from_array(std::array::from_fn(|axis| {
            if i >> axis & 1 != 0 { high[axis] } else { low[axis] }
        }))
    };
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    halves.map(|t| t.map(corner)).collect()
}

fn soup(faces: &[[Vec3; 3]]) -> InputMesh {
    let positions = faces.iter().flatten().copied().collect();
    let triangles = (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    InputMesh { positions, triangles, ..InputMesh::default() }
}

fn voxelise(mesh: &InputMesh, longest_vx: u32, fill: Fill) -> (Contents, Findings) {
    let frame = MeshPlacement::around(mesh, MeshSize::LongestVx(longest_vx), Up::Y, 1.0).unwrap();
    to_contents(mesh, &frame, fill, ColourDepth::Bits24, &Limits::default(), &()).unwrap()
}

#[test]
fn balls_and_cubes_have_their_volume() {
    let (found, findings) = voxelise(&ball(5), 100, Fill::Auto);
    let expected = 4.0 / 3.0 * std::f64::consts::PI * 50f64.powi(3);
    let share = found.grid.opaque_count() as f64 / expected;
    assert!((share - 1.0).abs() < 0.005, "{share}");
    assert_eq!(findings, Findings { open_share: 0.0, is_shell: false });
    let cube = soup(&cuboid(Vec3::ZERO, Vec3::new(2.0, 1.0, 0.5)));
    let (found, _) = voxelise(&cube, 64, Fill::Auto);
    assert_eq!(found.grid.dims(), UVec3::new(64, 32, 16));
    assert_eq!(found.grid.opaque_count(), 64 * 32 * 16);
    assert!((found.grid.voxel_size() - 1.0 / 32.0).abs().max_element() < 1e-6);
}

#[test]
fn shells_within_solids_are_cavities_and_solids_that_overlap_are_one() {
    let mut faces = cuboid(Vec3::ZERO, Vec3::splat(8.0));
    // Turned inside out: a cavity.
    faces.extend(cuboid(Vec3::splat(2.0), Vec3::splat(6.0)).into_iter().map(|[a, b, c]| [a, c, b]));
    let (found, _) = voxelise(&soup(&faces), 8, Fill::Auto);
    assert_eq!(found.grid.opaque_count(), 8 * 8 * 8 - 4 * 4 * 4);
    let mut faces = cuboid(Vec3::ZERO, Vec3::new(6.0, 4.0, 4.0));
    faces.extend(cuboid(Vec3::new(2.0, 0.0, 0.0), Vec3::new(8.0, 4.0, 4.0)));
    let (found, _) = voxelise(&soup(&faces), 8, Fill::Auto);
    assert_eq!(found.grid.opaque_count(), 8 * 4 * 4);
    // One face with reversed winding does not matter.
    faces[3].swap(0, 1);
    let (found, findings) = voxelise(&soup(&faces[..12]), 6, Fill::Auto);
    assert_eq!((found.grid.opaque_count(), findings.open_share), (6 * 4 * 4, 0.0));
}

#[test]
fn small_holes_are_closed_and_open_meshes_are_shells() {
    let whole = ball(4);
    let (solid, _) = voxelise(&whole, 60, Fill::Auto);
    let mut holed = whole.clone();
    // Three triangles of 2048, on different sides.
    for at in [1900, 1000, 70] {
        holed.triangles.remove(at);
    }
    let (repaired, findings) = voxelise(&holed, 60, Fill::Auto);
    assert!(findings.open_share > 0.0 && !findings.is_shell, "{findings:?}");
    let (a, b) = (repaired.grid.opaque_count() as f64, solid.grid.opaque_count() as f64);
    assert!((a / b - 1.0).abs() < 0.002, "{a} {b}");
    // Without one side a box is a container.
    let open = soup(&cuboid(Vec3::ZERO, Vec3::splat(10.0))[2..]);
    let (shell, findings) = voxelise(&open, 20, Fill::Auto);
    assert!(findings.is_shell && findings.open_share > 0.1, "{findings:?}");
    assert!(!shell.grid.get(IVec3::splat(10)) && shell.grid.get(IVec3::new(0, 10, 10)));
    // Unless it is forced to be solid: two of three directions agree.
    let (filled, _) = voxelise(&open, 20, Fill::Solid);
    assert_eq!(filled.grid.opaque_count(), 20 * 20 * 20);
    let (shell, _) = voxelise(&whole, 60, Fill::Shell);
    assert!(!shell.grid.get(IVec3::splat(30)) && shell.grid.opaque_count() > 5000);
    // A single sheet has no inside at all.
    let sheet = soup(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    let (sheet, findings) = voxelise(&sheet, 32, Fill::Auto);
    assert!(findings.is_shell && sheet.grid.opaque_count() >= 480, "{findings:?}");
    let back_to_back = [[Vec3::ZERO, Vec3::X, Vec3::Y], [Vec3::ZERO, Vec3::Y, Vec3::X]];
    assert!(voxelise(&soup(&back_to_back), 32, Fill::Auto).1.is_shell);
}

#[test]
fn rays_through_shared_edges_cross_once() {
    // A fan around a point at the centre of a voxel, with edges through centres.
    for turn in 0..4 {
        let faces = cuboid(Vec3::ZERO, Vec3::splat(9.0));
        let faces: Vec<[Vec3; 3]> = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let middle = match turn {
                    0 => (a + b) / 2.0,
                    1 => ((a + b + c) / 3.0 * 2.0).round() / 2.0,
                    2 => ((a + b + c) / 3.0).floor() + 0.5,
                    _ => (a + c) / 2.0,
                };
                let on_face = |p: Vec3| {
                    let normal = (b - a).cross(c - a).normalize();
                    p - normal * (p - a).dot(normal)
                };
                let m = on_face(middle);
                [[a, b, m], [b, c, m], [c, a, m]]
            })
            .collect();
        let (found, findings) = voxelise(&soup(&faces), 9, Fill::Auto);
        assert_eq!((found.grid.opaque_count(), findings.open_share), (9 * 9 * 9, 0.0), "{turn}");
    }
}

#[test]
fn up_is_turned_and_millimetres_count() {
    let mesh = soup(&cuboid(Vec3::ZERO, Vec3::new(4.0, 6.0, 10.0)));
    let frame = MeshPlacement::around(&mesh, MeshSize::VoxelMm(0.5), Up::Z, 1.0).unwrap();
    assert_eq!((frame.dims, frame.voxel_size), (UVec3::new(8, 20, 12), Vec3::splat(0.5)));
    let metres = MeshPlacement::around(&mesh, MeshSize::VoxelMm(500.0), Up::Y, 1000.0).unwrap();
    assert_eq!(metres.dims, UVec3::new(8, 12, 20));
    for (text, size) in [("256", MeshSize::LongestVx(256)), ("0.5mm", MeshSize::VoxelMm(0.5))] {
        assert_eq!((text.parse(), size.to_string()), (Ok(size), text.to_string()));
    }
    for wrong in ["0", "9000", "-1mm", "nanmm", "", "x"] {
        assert!(wrong.parse::<MeshSize>().is_err(), "{wrong}");
    }
}

#[test]
fn each_side_has_its_colours() {
    let mut mesh = soup(&cuboid(Vec3::ZERO, Vec3::splat(4.0)));
    let texture = Texture::new(2, vec![Rgb::new(255, 0, 0), Rgb::new(0, 255, 0)]).unwrap();
    let plain = Skin { colour: Rgb::new(10, 20, 30), texture: None };
    let skin =
        Skin { colour: Rgb::new(255, 255, 255), texture: Some(std::sync::Arc::new(texture)) };
    mesh.skins = vec![plain, skin];
    // The last two triangles are the side x = 4, whose u goes along y.
    mesh.skin_of = (0..12).map(|i| u32::from(i >= 10)).collect();
    let uv = |p: &u32| Vec2::new(mesh.positions[*p as usize].y / 4.0, 0.5);
    mesh.corner_uvs = mesh.triangles.iter().map(|t| [uv(&t[0]), uv(&t[1]), uv(&t[2])]).collect();
    for fill in [Fill::Solid, Fill::Shell] {
        let (found, _) = voxelise(&mesh, 16, fill);
        assert_eq!(found.rgb(UVec3::new(0, 8, 8)), Rgb::new(10, 20, 30));
        assert_eq!(found.rgb(UVec3::new(15, 1, 8)), Rgb::new(255, 0, 0));
        assert_eq!(found.rgb(UVec3::new(15, 14, 8)), Rgb::new(0, 255, 0));
    }
    mesh.corner_colours =
        vec![[Rgb::new(255, 255, 255), Rgb::new(255, 255, 255), Rgb::new(0, 0, 0)]; 12];
    assert_eq!(mesh.colour(0, Vec3::new(0.5, 0.0, 0.5)), Rgb::new(5, 10, 15));
}

#[test]
fn the_nearest_point_of_a_triangle_is_found() {
    let corners = [Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0];
    let near = |p: Vec3| {
        let [a, b, c] = paint::nearest(p, corners).to_array();
        corners[0] * a + corners[1] * b + corners[2] * c
    };
    for (p, expected) in [
        ([1.0, 1.0, 3.0], [1.0, 1.0, 0.0]),
        ([-1.0, -1.0, 1.0], [0.0, 0.0, 0.0]),
        ([9.0, -1.0, 0.0], [4.0, 0.0, 0.0]),
        ([-1.0, 9.0, 0.0], [0.0, 4.0, 0.0]),
        ([2.0, -5.0, 1.0], [2.0, 0.0, 0.0]),
        ([-5.0, 2.0, 1.0], [0.0, 2.0, 0.0]),
        ([4.0, 4.0, 0.0], [2.0, 2.0, 0.0]),
    ] {
        assert!((near(p.into()) - Vec3::from(expected)).length() < 1e-5, "{p:?}");
    }
}

#[test]
fn impossible_meshes_and_sizes_are_refused_before_memory_is_taken() {
    let mesh = ball(3);
    let around = |mesh: &InputMesh, size| MeshPlacement::around(mesh, size, Up::Y, 1.0);
    let frame = around(&mesh, MeshSize::LongestVx(64)).unwrap();
    let run_within = |frame: &MeshPlacement, colour_bytes: u64| {
        let limits = Limits { grid_bytes: 1 << 12, colour_bytes, ..Limits::default() };
        to_contents(&mesh, frame, Fill::Auto, ColourDepth::None, &limits, &())
    };
    let run = |frame: &MeshPlacement| run_within(frame, 1 << 8);
    // The lists of its triangles, and its voxels.
    assert!(matches!(
        run(&frame),
        Err(VoxeliseError::OverBudget(OverBudget { budget: MemoryBudget::GridsAndColours, .. }))
    ));
    assert!(matches!(
        run_within(&frame, 1 << 24),
        Err(VoxeliseError::OverBudget(OverBudget { budget: MemoryBudget::Grids, .. }))
    ));
    let huge = around(&mesh, MeshSize::VoxelMm(1e-6)).unwrap();
    assert!(matches!(run(&huge), Err(VoxeliseError::Grid(_))));
    let nothing = soup(&[[Vec3::splat(f32::NAN); 3], [Vec3::X; 3]]);
    assert!(matches!(around(&nothing, MeshSize::default()), Err(VoxeliseError::Nothing)));
    // A triangle with a non-finite corner is left out; it leaves a hole, which is closed.
    let mut torn = ball(4);
    torn.positions[300].x = f32::INFINITY;
    let (found, findings) = voxelise(&torn, 40, Fill::Auto);
    assert!(findings.open_share > 0.0 && !findings.is_shell);
    assert!(found.grid.opaque_count() > 30_000);
    let report = crate::progress::ProgressReport::default();
    report.cancel();
    let frame = around(&mesh, MeshSize::LongestVx(16)).unwrap();
    let cancelled =
        to_contents(&mesh, &frame, Fill::Auto, ColourDepth::None, &Limits::default(), &report);
    assert!(matches!(cancelled, Err(VoxeliseError::Cancelled)));
}
