//! The tree of colours against a list of plain pages.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;

use super::node::{ColourNode, PaintedChild};
use super::*;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::sculpture::brick_set::BrickSet;
use crate::sculpture::contents::Contents;
use crate::sculpture::edit::{EditOp, edit};
use crate::sculpture::edit_stats::EditStats;
use crate::sculpture::grid::Slot;
use crate::sculpture::paint::paint_each;
use crate::sculpture::record::BrickRecord;
use crate::sculpture::region::{Everywhere, VoxelBox};
use crate::sculpture::stroke::StrokeRecorder;
use crate::sculpture::to_paint::{PaintedWith, growth};

const RED: Rgb = Rgb::new(255, 0, 0);
const GREY: Rgb = Rgb::new(180, 180, 180);

/// Checks that a tree is canonical and counted.
fn check(material: &Material) {
    if let Some(root) = &material.root {
        check_child(root, material.whole(), &material.extent);
    }
}

fn check_child(child: &PaintedChild, cube: ColourCube, extent: &Extent) {
    let node = match child {
        PaintedChild::Page(page) => {
            assert!(cube.level == 0 || page.packed().is_some(), "a cube of one colour");
            return;
        }
        PaintedChild::Node(node) => node,
    };
    assert!(cube.level > 0 && !node.painted.is_empty());
    assert_eq!(node.painted.and_not(&cube.children(extent)), Brick::EMPTY, "beyond the border");
    let mut again = (**node).clone();
    again.recount(cube, extent);
    assert_eq!(again.counts(), node.counts());
    assert_eq!(ColourNode::closed(node.clone(), cube, extent).as_ref(), Some(child), "canonical");
    node.painted.for_each(|index| {
        let slot = Slot::at(index);
        check_child(node.child(slot).unwrap(), cube.child(slot), extent);
    });
}

/// The colours as a list, by linear index of the brick.
#[derive(Clone, PartialEq, Debug)]
struct Naive(Vec<Option<Vec<u8>>>);

impl Naive {
    /// Paints a voxel, and returns whether its colour differs.
    fn paint(&mut self, at: usize, local: u32, colour: Rgb, material: &Material) -> bool {
        let (depth, base) = (material.depth(), material.base());
        let size = depth.bytes();
        let now =
            self.0[at].as_ref().map_or(base, |page| depth.read(&page[local as usize * size..]));
        if now == depth.quantise(colour) {
            return false;
        }
        let page = self.0[at].get_or_insert_with(|| {
            let mut page = vec![0; 512 * size];
            page.chunks_exact_mut(size).for_each(|out| depth.write(base, out));
            page
        });
        depth.write(colour, &mut page[local as usize * size..]);
        true
    }

    fn compare(&self, contents: &Contents) {
        let Contents { grid, material, .. } = contents;
        check(material);
        let (mut reader, mut buffer) = (material.reader(), [0; MAX_PAGE_BYTES]);
        for (at, expected) in self.0.iter().enumerate() {
            let b = grid.brick_coords(at);
            let view = reader.page(b);
            assert_eq!(view, material.page(b));
            let found = view.map(|view| view.write_to(&mut buffer).to_vec());
            assert!(found == *expected, "brick {b}: {found:?} for {expected:?}");
        }
        assert_eq!(material.page_count(), self.0.iter().flatten().count());
    }

    /// Returns the colours as they are when they are written at once.
    fn built(&self, contents: &Contents) -> Material {
        let Contents { grid, material, .. } = contents;
        let mut built = Material::for_grid(grid, material.depth(), material.base());
        let page = |(at, page): (usize, &Option<Vec<u8>>)| {
            let page = Page::of_bytes(page.as_ref()?, material.depth());
            Some((grid.brick_coords(at), page))
        };
        built.set_pages(self.0.iter().enumerate().filter_map(page).collect());
        built
    }
}

/// Returns a grid of a kind: empty, full, a checkerboard, of one voxel, or of whole and partial cubes.
fn grid_of(dims: UVec3, kind: u32) -> Grid {
    let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
    grid.fill_bricks(|b| match kind {
        0 => Brick::EMPTY,
        1 => Brick::FULL,
        2 => Brick { words: [0xa5a5_5a5a_a5a5_5a5a; 8] },
        3 if b == UVec3::ZERO => Brick { words: [1 << 13, 0, 0, 0, 0, 0, 0, 0] },
        3 => Brick::EMPTY,
        _ => match b.element_sum() % 9 {
            0 => Brick { words: [u64::from(b.x) << 7 | 0xff00; 8] },
            1 => Brick::EMPTY,
            _ => Brick::FULL,
        },
    });
    grid
}

fn colour(number: u32) -> Rgb {
    if number == 0 { GREY } else { Rgb::new((number * 40) as u8, 200, (number * 90) as u8) }
}

/// Returns colours that few, or many, voxels of a brick share.
fn own_colour(v: UVec3, now: Rgb, kind: u32) -> Rgb {
    match kind % 3 {
        0 => Rgb::new((v.x % 3) as u8 * 80, 17, 250),
        1 => Rgb::new((v.x * 7) as u8, (v.y * 11) as u8, now.0[2] ^ v.z as u8),
        _ => now,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn painting_agrees_with_a_list_of_pages(
        dims in prop::array::uniform3(1u32..50),
        long in 0usize..6,
        depth in prop::sample::select(&ColourDepth::ALL[1..]),
        kind in 0u32..5,
        edits in prop::collection::vec(
            (prop::array::uniform2(prop::array::uniform3(-20i32..200)), 0u32..8, 0u32..5, 0u32..4),
            1..7,
        ),
        strokes in 1usize..4,
    ) {
        let mut dims = UVec3::from(dims);
        if long < 3 {
            // Several leaves; now and then whole bricks throughout.
            dims[long] = (dims[long] * 8).min(180);
        } else if long == 3 {
            dims = (dims + 7) / 8 * 8;
        }
        let grid = grid_of(dims, kind);
        let mut naive = Naive(vec![None; grid.brick_count()]);
        let material = Material::for_grid(&grid, depth, GREY);
        let mut contents = Contents::new(grid, material);
        let (mut recorder, mut records) = (StrokeRecorder::default(), Vec::new());
        for edits in edits.chunks(edits.len().div_ceil(strokes)) {
            let start = contents.clone();
            for (corners, aligned, number, op) in edits {
                let [a, b] = corners.map(|v| IVec3::from(v) >> *aligned << *aligned);
                let region = VoxelBox { min: a.min(b), max: a.max(b) + (1 << aligned) };
                let before = contents.clone();
                let (mut dirty, mut stats) = (BrickSet::default(), EditStats::default());
                let new = colour(*number);
                let op = match op {
                    0 => Some(EditOp::Add(Some(new))),
                    1 => Some(EditOp::Subtract),
                    2 => Some(EditOp::Recolour(new)),
                    _ => None,
                };
                let with = op.map_or(PaintedWith::AnyColours { keeps_base: false }, PaintedWith::Edit);
                let most = [false, true].map(|close| growth(&contents, &region, with, close));
                match op {
                    Some(op) => stats += edit(&mut contents, &region, op, &mut recorder, &mut dirty),
                    None => {
                        let own = |v, now| own_colour(v, now, *number);
                        stats += paint_each(&mut contents, &region, own, &mut recorder, &mut dirty);
                    }
                }
                let heap = [&contents, &before].map(|c| c.material.heap_bytes());
                prop_assert!(heap[0] <= heap[1] + most[1], "{:?} {:?} {:?}", heap, most, with);
                prop_assert!(most[1] <= most[0] || most[0] == 0, "{:?} {:?}", most, with);
                let mut recoloured = 0;
                for at in 0..naive.0.len() {
                    let b = before.grid.brick_coords(at);
                    let mut changed = contents.grid.brick(b) != before.grid.brick(b);
                    for local in 0..512 {
                        let v = b * BRICK_EDGE_VX + UVec3::from(local_coords(local));
                        let signed = v.as_ivec3();
                        let inside = before.grid.contains(signed) && region.contains(signed);
                        let (exists, now) = (before.grid.get(signed), contents.grid.get(signed));
                        let next = match op {
                            Some(EditOp::Add(_)) if inside && !exists && now => new,
                            Some(EditOp::Recolour(_)) if inside && exists => new,
                            None if inside && exists => {
                                own_colour(v, before.material.rgb(b, local), *number)
                            }
                            _ => continue,
                        };
                        if naive.paint(at, local, next, &before.material) {
                            changed = true;
                            recoloured += u64::from(exists);
                        }
                    }
                    prop_assert_eq!(dirty.contains(b), changed, "{} {:?}", b, op);
                }
                prop_assert_eq!(stats.voxels_recoloured, recoloured);
                naive.compare(&contents);
                prop_assert!(contents.material == naive.built(&contents));
            }
            let taken = recorder.bytes();
            let record = recorder.finish();
            prop_assert_eq!(taken, record.heap_bytes());
            records.push((start, record));
        }
        // Back, forth and back again; the last stroke is resumed, too.
        let ended = contents.clone();
        if let Some((start, record)) = records.last().cloned() {
            recorder.resume(record, &contents);
            let record = recorder.finish();
            let mut copy = contents.clone();
            record.swap(&mut copy, &mut BrickSet::default());
            prop_assert_eq!(copy, start);
        }
        let mut forth: Vec<BrickRecord> = Vec::new();
        for (start, record) in records.into_iter().rev() {
            let most = record.reverse_bytes(&contents);
            let mut touched = BrickSet::default();
            let before = contents.clone();
            let reverse = record.swap(&mut contents, &mut touched);
            prop_assert!(reverse.heap_bytes() <= most);
            check(&contents.material);
            prop_assert_eq!(&contents, &start);
            for at in 0..naive.0.len() {
                let b = contents.grid.brick_coords(at);
                let same = contents.material.page(b) == before.material.page(b);
                prop_assert!(same || touched.contains(b));
            }
            forth.push(reverse);
        }
        for record in forth.into_iter().rev() {
            record.swap(&mut contents, &mut BrickSet::default());
        }
        check(&contents.material);
        prop_assert_eq!(contents, ended);
    }
}

#[test]
fn only_painted_bricks_take_memory() {
    let mut material = Material::new(ColourDepth::Bits24, GREY, UVec3::new(800, 8, 80));
    assert_eq!(material.heap_bytes(), 0);
    let (b, mut mask) = (UVec3::new(7, 0, 3), Brick::EMPTY);
    mask.set(3, 4, 5, true);
    material.paint(b, &mask, GREY);
    assert_eq!(material.heap_bytes(), 0, "painting the base colour needs no page");
    material.paint(b, &mask, RED);
    assert_eq!(material.page_count(), 1);
    assert!(material.heap_bytes() < 1000, "{}", material.heap_bytes());
    assert_eq!(material.rgb(b, super::super::brick::local_index(3, 4, 5)), RED);
    assert_eq!(material.rgb(b, 0), GREY);
    assert_eq!(material.rgb(b + UVec3::X, 0), GREY);
    material.paint(b, &mask, GREY);
    assert_eq!(material.page_count(), 1, "a painted brick stays painted");
}

#[test]
fn replacing_a_page_and_putting_it_back_restores_identical_contents() {
    let mut material = Material::new(ColourDepth::Bits16, GREY, UVec3::new(80, 8, 8));
    let b = UVec3::new(1, 0, 0);
    material.paint(b, &Brick::FULL, RED);
    let before = material.clone();
    let old = material.set_page(b, None);
    assert_eq!((material.page_count(), material.heap_bytes()), (0, 0));
    assert_eq!(material.set_page(b, old), None);
    assert_eq!(material, before);
}

#[test]
fn a_sculpture_without_colours_never_makes_a_page() {
    let mut material = Material::new(ColourDepth::None, GREY, UVec3::splat(20));
    material.paint(UVec3::ZERO, &Brick::FULL, RED);
    material.paint_each(UVec3::ZERO, &Brick::FULL, |_| RED);
    assert_eq!((material.heap_bytes(), material.rgb(UVec3::ZERO, 9)), (0, GREY));
}

/// Neither the colours nor the record of a step depend on the number of bricks that get one colour.
#[test]
fn a_dyed_sculpture_takes_hardly_any_memory() {
    let grid = grid_of(UVec3::splat(1024), 1);
    let material = Material::for_grid(&grid, ColourDepth::Bits24, GREY);
    let mut contents = Contents::new(grid, material);
    let start = contents.clone();
    let (mut recorder, mut dirty) = (StrokeRecorder::default(), BrickSet::default());
    let begun = std::time::Instant::now();
    let dye = EditOp::Recolour(RED);
    let stats = edit(&mut contents, &Everywhere, dye, &mut recorder, &mut dirty);
    let record = recorder.finish();
    println!("dyed in {:.2} ms", begun.elapsed().as_secs_f64() * 1e3);
    assert_eq!((stats.voxels_recoloured, stats.bricks_changed), (1 << 30, 1 << 21));
    assert_eq!((contents.material.page_count(), dirty.len()), (1 << 21, 1 << 21));
    let bytes = contents.material.heap_bytes() as usize + record.heap_bytes();
    assert!(bytes < 4096, "{bytes} bytes");
    // Part of it in another colour, and all of it again: the step keeps the part.
    let part = VoxelBox { min: IVec3::splat(100), max: IVec3::splat(300) };
    edit(&mut contents, &part, EditOp::Recolour(GREY), &mut recorder, &mut dirty);
    let of_part = recorder.finish();
    // A word or two for each of 26^3 bricks, most of them not even that.
    let (bytes, kept) = (contents.material.heap_bytes(), of_part.heap_bytes());
    assert!(kept < 400_000 && bytes < 1_200_000, "{kept} {bytes}");
    edit(&mut contents, &Everywhere, dye, &mut recorder, &mut dirty);
    let again = recorder.finish();
    assert!((again.heap_bytes() as u64) < bytes + 4096);
    for record in [again, of_part, record] {
        record.swap(&mut contents, &mut dirty);
    }
    assert_eq!(contents, start);
}
