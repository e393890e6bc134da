//! Tests that every tool does the same wherever it is used in a large canvas: across the borders of bricks, leaves and
//! nodes, at high coordinates, and at negative ones.

use glam::{IVec3, UVec3, Vec3};
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{Document, Limits};
use sculpture_core::sculpture::{ColourDepth, Rgb};
use sculpture_core::tools::texture::Texture;

use super::uses::{self, Place};

/// The middle of the scene in the small grid, and the edge of that.
const MIDDLE: i32 = 48;
const EDGE: u32 = 96;
/// All that tools change lies within this distance of the middle.
const REACH: i32 = 32;

/// The same scene somewhere in a canvas.
struct Site {
    document: Document,
    /// The middle of the scene, in the coordinates of commands and of the grid.
    middle: IVec3,
    middle_in_grid: IVec3,
}

impl Site {
    /// Makes the scene in a grid of its own, full or not, which `canvas` then changes.
    fn new(dims: u32, middle: IVec3, solid: bool, canvas: &[&str]) -> Site {
        let new = NewSculpture {
            dims: UVec3::splat(dims),
            voxel_size: Vec3::ONE,
            colour_depth: ColourDepth::Bits24,
            base: Rgb::STONE,
            solid,
            room_vx: 0,
            grows: false,
        };
        let mut document = Document::new(&new, Limits::default()).unwrap();
        let stripes = (0..64).map(|i| if i % 8 < 4 { Rgb::STONE } else { Rgb::new(1, 2, 3) });
        document.learn_picture(uses::PICTURE.as_ref(), Texture::new(8, stripes.collect()).unwrap());
        let at = |x: i32, y: i32, z: i32| {
            let IVec3 { x, y, z } = middle + IVec3::new(x, y, z);
            format!("{x},{y},{z}")
        };
        let lines = [
            format!("add cuboid at={} half=22,12,15 colour=#c08040", at(0, -12, 0)),
            format!("add ellipsoid at={} half=9", at(0, -2, 0)),
            format!("recolour ellipsoid at={} half=11 colour=#2040c0", at(-9, -6, 5)),
            format!("mask add cuboid at={} half=5", at(16, -4, 10)),
        ];
        for line in canvas.iter().map(|line| line.to_string()).chain(lines) {
            document.apply(&line.parse().unwrap()).unwrap_or_else(|e| panic!("{line}: {e}"));
        }
        let low = document.contents().canvas().bounds_vx().min;
        Site { document, middle, middle_in_grid: middle - low }
    }

    /// Returns what lies around the middle: for each voxel its colour, if it exists, and whether it is masked.
    fn around(&self) -> Vec<(Option<Rgb>, bool)> {
        let (contents, mask) = (self.document.contents(), self.document.mask());
        let edge = 2 * REACH;
        let at = |i: i32| IVec3::new(i % edge, i / edge % edge, i / (edge * edge)) - REACH;
        let voxels = (0..edge * edge * edge).map(|i| self.middle_in_grid + at(i));
        voxels.map(|v| (contents.colour(v), mask.is_some_and(|mask| mask.get(v)))).collect()
    }

    /// Returns the uses of every tool around the middle.
    fn uses(&self) -> Vec<Command> {
        let place = |at: Vec3| {
            let middle = self.middle.as_vec3();
            let (further_vx, aim) =
                (middle + Vec3::new(13.0, -9.0, -5.0), Vec3::new(0.5, -1.0, 0.25));
            let eye_vx = middle + Vec3::new(-4.0, 24.0, -3.0);
            Place { at_vx: middle + at, ball_vx: middle + at, further_vx, eye_vx, aim }
        };
        let places = [Vec3::ZERO, Vec3::new(3.5, 0.5, -2.5)];
        places.iter().flat_map(|at| uses::of_every_tool(&place(*at))).collect()
    }

    fn counts(&self) -> [u64; 2] {
        let masked = self.document.mask().map_or(0, |mask| mask.opaque_count());
        [self.document.grid().opaque_count(), masked]
    }
}

/// Checks that all uses change the same at each of the sites, and that undo restores it.
fn check(solid: bool, sites: Vec<Site>) {
    let mut small = Site::new(EDGE, IVec3::splat(MIDDLE), solid, &[]);
    let before = small.around();
    let start = small.counts();
    let mut sites: Vec<_> = sites
        .into_iter()
        .map(|site| (site.document.contents().clone(), site.counts(), site.uses(), site))
        .collect();
    for (_, _, _, site) in &sites {
        assert!(site.around() == before, "the same scene at {}", site.middle);
    }
    let mut changed = 0;
    for (i, command) in small.uses().iter().enumerate() {
        let stats =
            small.document.apply(command).unwrap_or_else(|e| panic!("{command}: {e}")).stats;
        let (after, counts) = (small.around(), small.counts());
        changed += usize::from(stats.voxels_changed() > 0);
        for (contents, first, uses, site) in &mut sites {
            let other = &uses[i];
            let there = site.document.apply(other).unwrap_or_else(|e| panic!("{other}: {e}")).stats;
            // Elsewhere, a half space changes more in a larger canvas.
            let is_bounded = !command.to_string().contains("half-space");
            if is_bounded {
                assert_eq!(there.voxels_changed(), stats.voxels_changed(), "{other}; {command}");
            }
            if stats.voxels_changed() == 0 {
                continue;
            }
            let same = site.around().iter().zip(&after).filter(|(a, b)| a != b).count();
            assert_eq!(same, 0, "{other}: voxels that differ from those after {command}");
            // Nothing else has changed.
            let differences = |now: [u64; 2], first: [u64; 2]| {
                [0, 1].map(|kind| now[kind].wrapping_sub(first[kind]))
            };
            if is_bounded {
                let expected = differences(counts, start);
                assert_eq!(differences(site.counts(), *first), expected, "{other}");
            }
            site.document.apply(&"undo".parse().unwrap()).unwrap();
            assert!(site.document.contents() == contents, "undo {other}");
        }
        if stats.voxels_changed() > 0 {
            small.document.apply(&"undo".parse().unwrap()).unwrap();
        }
    }
    assert!(changed > 100, "{changed} uses changed anything");
}

#[test]
fn every_tool_does_the_same_everywhere_in_a_large_canvas() {
    let at = |x, y, z| IVec3::new(x, y, z);
    check(
        false,
        vec![
            // Across the borders of leaves and of nodes, at the highest coordinates, and in the middle of bricks.
            Site::new(2048, at(64, 512, 128), false, &[]),
            Site::new(2048, at(1024, 1536, 1024 + 64), false, &[]),
            Site::new(2048, IVec3::splat(2048 - MIDDLE), false, &[]),
            Site::new(2048, at(1237, 331, 1803), false, &[]),
            // At negative coordinates.
            Site::new(96, at(-1024, -512, -64), false, &["canvas grow by=2000 sides=-x,-y,-z"]),
            Site::new(96, at(-3, 50, -1), false, &["canvas grow by=61 sides=-x,-z"]),
        ],
    );
}

#[test]
fn every_tool_does_the_same_everywhere_in_a_large_block() {
    check(
        true,
        vec![
            Site::new(2048, IVec3::new(512, 64, 1024), true, &[]),
            Site::new(2048, IVec3::new(1237, 331, 1803), true, &[]),
        ],
    );
}
