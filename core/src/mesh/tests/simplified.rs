//! Tests that simplified meshes stay closed manifolds of the same topology, near the original surface.

use glam::{UVec3, Vec3};

use super::check::{Sound, check, welded};
use super::surfaces::{contents, mesh, noise};
use crate::mesh::{Mesh, MeshError, MeshKind, simplified};
use crate::progress::ProgressReport;
use crate::scenes::{self, grid_of};
use crate::sculpture::{Brick, Limits, Rgb};

fn sound(name: &str, mesh: &Mesh) -> Sound {
    let positions: Vec<Vec3> = mesh.positions().collect();
    let triangles: Vec<[u32; 3]> = mesh.triangles().collect();
    let sound = check(&positions, &triangles).unwrap_or_else(|fault| panic!("{name}: {fault}"));
    let (positions, triangles) = welded(&positions, &triangles);
    check(&positions, &triangles).unwrap_or_else(|fault| panic!("{name}, welded: {fault}"));
    sound
}

#[test]
fn simplified_meshes_have_the_topology_and_volume_of_the_original() {
    let middle = Vec3::splat(20.0);
    let ring = |p: Vec3| ((p.x - 20.0).hypot(p.y - 20.0) - 12.0).hypot(p.z - 20.0) < 6.0;
    for (name, grid) in [
        ("ball", grid_of(40, |p| p.distance(middle) < 18.0)),
        ("ring", grid_of(40, ring)),
        ("engine", scenes::engine_like(56).unwrap()),
    ] {
        let contents = contents(grid);
        for (kind, fewer) in [(MeshKind::Faces, 6), (MeshKind::Greedy, 2), (MeshKind::Smooth, 6)] {
            let all = mesh(&contents, kind);
            let before = sound(name, &all);
            let wanted = all.triangle_count() / fewer;
            let fewer = simplified(all, wanted, &Limits::default(), &()).unwrap();
            let after = sound(&format!("{name} {kind:?}"), &fewer);
            assert!(fewer.triangle_count() <= wanted, "{name} {kind:?}");
            assert_eq!((after.surfaces, after.handles), (before.surfaces, before.handles));
            let share = after.volume / before.volume;
            assert!((share - 1.0).abs() < 0.01, "{name} {kind:?}: {share}");
        }
    }
}

#[test]
fn a_cube_is_simplified_to_twelve_triangles_in_its_corners() {
    let contents = contents(grid_of(24, |p| (p - 12.0).abs().max_element() < 9.0));
    let fewer = simplified(mesh(&contents, MeshKind::Faces), 12, &Limits::default(), &()).unwrap();
    assert_eq!((fewer.triangle_count(), fewer.vertex_count()), (12, 8));
    assert!((sound("cube", &fewer).volume - 18f64.powi(3)).abs() < 1e-3);
}

#[test]
fn a_simplified_ball_stays_near_its_surface() {
    let (middle, radius) = (Vec3::splat(24.0), 20.0);
    let contents = contents(grid_of(48, |p| p.distance(middle) < radius));
    let fewer =
        simplified(mesh(&contents, MeshKind::Smooth), 1000, &Limits::default(), &()).unwrap();
    let worst = fewer.positions().map(|p| (p.distance(middle) - radius).abs()).fold(0.0, f32::max);
    assert!(fewer.triangle_count() <= 1000 && worst < 0.35, "{worst}");
}

#[test]
fn a_mesh_that_cannot_be_simplified_further_stays_closed() {
    // Pieces keep at least four triangles, and their handles.
    let contents = contents(noise(UVec3::splat(13), 0.4, 5));
    for kind in [MeshKind::Faces, MeshKind::Greedy, MeshKind::Smooth] {
        let all = mesh(&contents, kind);
        let before = sound("noise", &all);
        let fewer = simplified(all, 0, &Limits::default(), &()).unwrap();
        let after = sound(&format!("noise {kind:?}"), &fewer);
        assert_eq!((after.surfaces, after.handles), (before.surfaces, before.handles));
        assert!(fewer.triangle_count() >= 4 * before.surfaces as u64);
    }
}

#[test]
fn a_mesh_with_few_triangles_stays_as_it_is_and_any_other_is_the_same_each_time() {
    let contents = contents(scenes::engine_like(40).unwrap());
    let all = mesh(&contents, MeshKind::Smooth);
    let count = all.triangle_count();
    assert!(simplified(all.clone(), count, &Limits::default(), &()).unwrap() == all);
    let made = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| simplified(all.clone(), count / 3, &Limits::default(), &()).unwrap())
    });
    assert!(made[0] == made[1]);
}

#[test]
fn colours_keep_their_places() {
    let mut contents = contents(grid_of(32, |p| p.distance(Vec3::splat(16.0)) < 14.0));
    let red = Rgb::new(255, 0, 0);
    for index in 0..contents.grid.brick_count() {
        if contents.grid.brick_coords(index).x < 2 {
            contents.material.paint(contents.grid.brick_coords(index), &Brick::FULL, red);
        }
    }
    let fewer =
        simplified(mesh(&contents, MeshKind::Smooth), 500, &Limits::default(), &()).unwrap();
    for (position, colour) in fewer.positions().zip(fewer.colours()) {
        if position.x < 13.0 {
            assert_eq!(colour, red, "{position}");
        } else if position.x > 19.0 {
            assert_eq!(colour, Rgb::STONE, "{position}");
        }
    }
}

#[test]
fn simplifying_can_be_cancelled() {
    let contents = contents(scenes::cheese(96, 40, 3).unwrap());
    let all = mesh(&contents, MeshKind::Faces);
    let report = ProgressReport::default();
    report.cancel();
    assert!(matches!(simplified(all, 100, &Limits::default(), &report), Err(MeshError::Cancelled)));
}

#[test]
fn too_much_memory_is_refused_before_it_is_taken() {
    let contents = contents(grid_of(24, |p| p.distance(Vec3::splat(12.0)) < 10.0));
    let all = mesh(&contents, MeshKind::Faces);
    let (count, own) = (all.triangle_count(), all.heap_bytes());
    let limits = |bytes| Limits { grid_bytes: bytes, colour_bytes: 0, ..Limits::default() };
    // A mesh that just fits leaves no memory to work in.
    let error = simplified(all.clone(), count / 2, &limits(own), &()).unwrap_err();
    let MeshError::OverBudget(over) = &error else { panic!("{error}") };
    assert_eq!(over.what, format!("simplifying {count} triangles needs"));
    assert!(error.to_string().contains("allowed for grids and colours"), "{error}");
    assert!(simplified(all.clone(), count / 2, &limits(8 * own), &()).is_ok());
    // There is nothing to do.
    assert!(simplified(all.clone(), count, &limits(0), &()).unwrap() == all);
}
