//! Tests that a kept mesh that follows edits equals a newly built one.

use glam::{IVec3, UVec3, Vec3};

use super::check::check;
use super::surfaces::{contents, noise};
use crate::mesh::{ContentsVersion, KeptMesh, Mesh, MeshError, MeshKind, VertexColours};
use crate::progress::ProgressReport;
use crate::scenes::{Random, grid_of};
use crate::sculpture::history::Contents;
use crate::sculpture::{Brick, Limits, Rgb};

const KINDS: [MeshKind; 2] = [MeshKind::Faces, MeshKind::Smooth];

/// Returns the triangles by the bits of their corners' positions, and their colours; in an order of their own.
fn triangles(mesh: &Mesh) -> Vec<[([u32; 3], [u8; 3]); 3]> {
    let colours: Vec<[u8; 3]> = mesh.colours().map(|Rgb(colour)| colour).collect();
    let corner = |vertex: u32| {
        (mesh.position(vertex).to_array().map(f32::to_bits), colours[vertex as usize])
    };
    let mut all: Vec<_> = mesh
        .triangles()
        .map(|triangle| {
            let mut corners = triangle.map(corner);
            let first = (0..3).min_by_key(|&i| corners[i]).unwrap();
            corners.rotate_left(first);
            corners
        })
        .collect();
    all.sort_unstable();
    all
}

/// Versions of contents, distinguished by comparing every brick.
#[derive(Default)]
struct Versions {
    last: Option<Contents>,
    number: u64,
}

impl Versions {
    fn next(&mut self, contents: &Contents) -> ContentsVersion {
        let last = self.last.replace(contents.clone());
        let differs = |last: &Contents, brick: usize| {
            let b = contents.grid.brick_coords(brick);
            last.grid.brick_at(brick) != contents.grid.brick_at(brick)
                || last.material.page(b) != contents.material.page(b)
        };
        let last = last.filter(|last| last.grid.dims() == contents.grid.dims());
        let changed = last.map(|last| {
            let bricks = 0..contents.grid.brick_count();
            bricks.filter(|&brick| differs(&last, brick)).map(|brick| brick as u32).collect()
        });
        self.number += 1;
        ContentsVersion { number: self.number, changed }
    }
}

/// Updates a kept mesh and compares it with one that is built whole.
fn expect_same(kept: &mut KeptMesh, contents: &Contents, version: &ContentsVersion, when: &str) {
    kept.update(contents, version, &Limits::default(), &()).unwrap();
    let kind = KINDS.into_iter().find(|&kind| kept.is_of(kind, VertexColours::Voxels)).unwrap();
    let kept = kept.mesh().unwrap();
    let anew = Mesh::of(contents, kind, VertexColours::Voxels, &Limits::default(), &()).unwrap();
    assert_eq!(kept.vertex_count(), anew.vertex_count(), "{kind:?} {when}");
    assert!(triangles(&kept) == triangles(&anew), "{kind:?} {when}");
    let positions: Vec<Vec3> = kept.positions().collect();
    let faces: Vec<[u32; 3]> = kept.triangles().collect();
    check(&positions, &faces).unwrap_or_else(|error| panic!("{kind:?} {when}: {error:?}"));
}

#[test]
fn a_kept_mesh_is_that_which_is_made_at_once() {
    for dims in [[1, 1, 1], [47, 15, 17], [48, 16, 16], [49, 17, 15], [104, 20, 35]] {
        let dims = UVec3::from_array(dims);
        for share in [0.03, 0.5, 1.0] {
            let contents = contents(noise(dims, share, 5));
            for kind in KINDS {
                let mut kept = KeptMesh::new(kind, VertexColours::Voxels).unwrap();
                let version = Versions::default().next(&contents);
                expect_same(&mut kept, &contents, &version, &format!("{dims} {share}"));
            }
        }
    }
}

#[test]
fn a_kept_mesh_follows_edits_undo_and_other_sculptures() {
    let mut random = Random(17);
    for kind in KINDS {
        let mut kept = KeptMesh::new(kind, VertexColours::Voxels).unwrap();
        let mut versions = Versions::default();
        let mut follow = |contents: &Contents, when: &str| {
            let version = versions.next(contents);
            expect_same(&mut kept, contents, &version, when);
        };
        let mut now = contents(grid_of(72, |p| p.distance(Vec3::splat(36.0)) < 33.0));
        now.material.paint(now.grid.brick_coords(500), &Brick::FULL, Rgb::new(1, 200, 3));
        let start = now.clone();
        follow(&start, "start");
        for step in 0..6 {
            let centre = random.voxel(UVec3::splat(72)).as_vec3();
            let radius = 2.0 + step as f32 * 2.0;
            for i in 0..72 * 72 * 72 {
                let v = IVec3::new(i % 72, i / 72 % 72, i / (72 * 72));
                if (v.as_vec3() + 0.5).distance(centre) < radius {
                    now.grid.set(v, step % 3 == 2);
                }
            }
            let brick = random.next_u64() as usize % now.grid.brick_count();
            now.material.paint(now.grid.brick_coords(brick), &Brick::FULL, Rgb::new(step, 7, 7));
            follow(&now, &format!("step {step}"));
        }
        follow(&start, "undone");
        follow(&contents(noise(UVec3::new(40, 70, 20), 0.4, 3)), "other");
        // All voxels but those at the sides of some blocks, one at a time.
        let mut now = contents(grid_of(72, |_| true));
        follow(&now, "full");
        for v in [[47, 15, 31], [48, 16, 32], [71, 71, 71], [0, 0, 0], [48, 15, 16], [55, 24, 40]] {
            now.grid.set(IVec3::from(v), false);
            follow(&now, &format!("without {v:?}"));
        }
    }
}

#[test]
fn only_what_an_edit_may_change_is_made_anew() {
    let mut now = contents(grid_of(128, |_| true));
    for kind in KINDS {
        let mut kept = KeptMesh::new(kind, VertexColours::None).unwrap();
        assert_eq!(kept.mesh().unwrap().triangle_count(), 0);
        let mut versions = Versions::default();
        let mut update = |now: &Contents| {
            let version = versions.next(now);
            kept.update(now, &version, &Limits::default(), &()).unwrap()
        };
        // 3 x 9 x 9: one more corner than voxels along each axis.
        assert_eq!(update(&now), [243, 243]);
        assert_eq!(update(&now), [0, 243]);
        now.grid.set(IVec3::new(84, 24, 24), !now.grid.get(IVec3::new(84, 24, 24)));
        let [anew, _] = update(&now);
        assert!(anew > 0 && anew <= if kind == MeshKind::Faces { 4 } else { 27 }, "{anew}");
    }
    assert!(KeptMesh::new(MeshKind::Greedy, VertexColours::None).is_none());
}

#[test]
fn a_version_that_was_missed_or_given_up_is_made_up_for() {
    let before = contents(noise(UVec3::splat(40), 0.4, 8));
    let now = contents(noise(UVec3::splat(40), 0.4, 9));
    let unchanged = |number| ContentsVersion { number, changed: Some(Vec::new()) };
    for kind in KINDS {
        let mut kept = KeptMesh::new(kind, VertexColours::Voxels).unwrap();
        // The first version has no predecessor.
        expect_same(&mut kept, &before, &unchanged(1), "first");
        // Version 2 had the changes.
        expect_same(&mut kept, &now, &unchanged(3), "missed");
        let report = ProgressReport::default();
        report.cancel();
        let given_up = kept.update(&before, &unchanged(4), &Limits::default(), &report);
        assert!(matches!(given_up, Err(MeshError::Cancelled)));
        expect_same(&mut kept, &before, &unchanged(5), "given up");
        let little = Limits { grid_bytes: 200 << 10, colour_bytes: 0, ..Limits::default() };
        let all = ContentsVersion { number: 6, changed: None };
        let refused = kept.update(&now, &all, &little, &());
        assert!(matches!(refused, Err(MeshError::OverBudget(_) | MeshError::Grid(_))), "{kind:?}");
        expect_same(&mut kept, &now, &unchanged(7), "refused");
    }
}
