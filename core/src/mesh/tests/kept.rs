//! A mesh that is kept and follows edits is the one that is made anew.

use std::sync::Arc;

use glam::{IVec3, UVec3, Vec3};

use super::check::check;
use super::surfaces::{contents, noise};
use crate::mesh::{KeptMesh, Mesh, MeshError, MeshKind, VertexColours};
use crate::progress::Report;
use crate::scenes::{Random, grid_of};
use crate::sculpture::history::Contents;
use crate::sculpture::{Brick, Limits, Rgb};

const KINDS: [MeshKind; 2] = [MeshKind::Faces, MeshKind::Smooth];

/// The triangles by the bits of their corners' places, and their colours; in an order of their own.
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

fn expect_same(kept: &mut KeptMesh, kind: MeshKind, contents: &Arc<Contents>, when: &str) {
    kept.update(contents, &Limits::default(), &()).unwrap();
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
            let contents = Arc::new(contents(noise(dims, share, 5)));
            for kind in KINDS {
                let mut kept = KeptMesh::new(kind, VertexColours::Voxels).unwrap();
                expect_same(&mut kept, kind, &contents, &format!("{dims} {share}"));
            }
        }
    }
}

#[test]
fn a_kept_mesh_follows_edits_undo_and_other_sculptures() {
    let mut random = Random(17);
    for kind in KINDS {
        let mut kept = KeptMesh::new(kind, VertexColours::Voxels).unwrap();
        let mut now = contents(grid_of(72, |p| p.distance(Vec3::splat(36.0)) < 33.0));
        now.material.paint(500, &Brick::FULL, Rgb::new(1, 200, 3));
        let start = Arc::new(now.clone());
        expect_same(&mut kept, kind, &start, "start");
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
            now.material.paint(brick, &Brick::FULL, Rgb::new(step, 7, 7));
            expect_same(&mut kept, kind, &Arc::new(now.clone()), &format!("step {step}"));
        }
        expect_same(&mut kept, kind, &start, "undone");
        let other = Arc::new(contents(noise(UVec3::new(40, 70, 20), 0.4, 3)));
        expect_same(&mut kept, kind, &other, "other");
    }
}

#[test]
fn only_what_an_edit_may_change_is_made_anew() {
    let mut now = contents(grid_of(128, |_| true));
    for kind in KINDS {
        let mut kept = KeptMesh::new(kind, VertexColours::None).unwrap();
        assert_eq!(kept.mesh().unwrap().triangle_count(), 0);
        let limits = Limits::default();
        // 3 x 9 x 9: one corner more than voxels along each axis.
        assert_eq!(kept.update(&Arc::new(now.clone()), &limits, &()).unwrap(), [243, 243]);
        assert_eq!(kept.update(&Arc::new(now.clone()), &limits, &()).unwrap(), [0, 243]);
        now.material.paint(0, &Brick::FULL, Rgb::new(9, 9, 9));
        assert_eq!(kept.update(&Arc::new(now.clone()), &limits, &()).unwrap(), [0, 243]);
        now.grid.set(IVec3::new(84, 24, 24), !now.grid.get(IVec3::new(84, 24, 24)));
        let [anew, _] = kept.update(&Arc::new(now.clone()), &limits, &()).unwrap();
        assert!(anew > 0 && anew <= if kind == MeshKind::Faces { 4 } else { 27 }, "{anew}");
    }
    assert!(KeptMesh::new(MeshKind::Greedy, VertexColours::None).is_none());
}

#[test]
fn after_work_that_was_given_up_all_is_made_anew() {
    let now = Arc::new(contents(noise(UVec3::splat(40), 0.4, 8)));
    for kind in KINDS {
        let mut kept = KeptMesh::new(kind, VertexColours::Voxels).unwrap();
        kept.update(&now, &Limits::default(), &()).unwrap();
        let report = Report::default();
        report.cancel();
        let given_up = kept.update(&now, &Limits::default(), &report);
        assert!(matches!(given_up, Err(MeshError::Cancelled)));
        let little = Limits { grid_bytes: 200 << 10, colour_bytes: 0, ..Limits::default() };
        let refused = kept.update(&now, &little, &());
        assert!(matches!(refused, Err(MeshError::Memory { .. } | MeshError::Grid(_))), "{kind:?}");
        expect_same(&mut kept, kind, &now, "after that");
    }
}
