//! Paints each voxel with a colour of its own, for images, translucent brushes and clips, where
//! [`edit`](super::edit::edit) gives all voxels one colour.
//!
//! Takes the contents, a [`Region`] and a function of voxel and present colour; stores the earlier
//! colours in the recorder and marks bricks dirty. Changes no existence bits.

use fearless_simd::{Level, dispatch};
use glam::UVec3;

use super::brick::{BRICK_EDGE_VX, BRICK_VOXELS, Brick, BrickKind, local_coords};
use super::brick_set::BrickSet;
use super::colour::{ColourDepth, Rgb};
use super::contents::Contents;
use super::edit::BrickRow;
use super::edit_stats::EditStats;
use super::material::{Brush, Page};
use super::region::{BrickBox, Region};
use super::stroke::{ColourBands, PageRecord, StrokeRecorder};

/// Regions of fewer bricks than this stay on one thread: waking others would cost more than it gains.
const PARALLEL_BRICKS: u64 = 256;

/// Gives every existing voxel of `region` the colour that `colour` returns for its coordinates and its present colour.
/// Does nothing without colour depth.
pub fn paint_each(
    contents: &mut Contents,
    region: &impl Region,
    colour: impl Fn(UVec3, Rgb) -> Rgb + Sync,
    recorder: &mut StrokeRecorder,
    dirty: &mut BrickSet,
) -> EditStats {
    let Contents { grid, material, .. } = contents;
    let (depth, base) = (material.depth(), material.base());
    let Some(bricks) = BrickBox::around(region, grid).filter(|_| depth.bytes() > 0) else {
        return EditStats::default();
    };
    let palette = PageFormat { depth, base, blank: material.brush(base) };
    let parallel = bricks.brick_count() >= PARALLEL_BRICKS;
    let (bands, pages_kept) = recorder.pages();
    let per_band = ColourBands::of(grid).bricks;
    let touched = ColourBands::of_slabs(bricks.min.z..bricks.max.z);
    let per_slab = grid.brick_dims().x * grid.brick_dims().y;
    let level = Level::new();
    material.edit_bands(per_band, touched, parallel, bands, &|first, pages, record| {
        let first_slab = first / per_slab;
        let slabs = first_slab.max(bricks.min.z)
            ..(first_slab + (per_band as u32).div_ceil(per_slab)).min(bricks.max.z);
        let mut cut = Default::default();
        let mut made = 0;
        let mut paint = |b: UVec3, mask: &Brick| {
            let index = grid.brick_index(b);
            let mask = grid.brick_at(index).and(mask);
            let page = BrickPage {
                index: index as u32,
                page: &mut pages[index - first as usize],
                kept: pages_kept.contains(index as u32),
            };
            let origin = b * BRICK_EDGE_VX;
            let one = |local: u32, now: Rgb| colour(origin + UVec3::from(local_coords(local)), now);
            made += palette.paint(page, &mask, one, record);
        };
        for z in slabs {
            for y in bricks.min.y..bricks.max.y {
                let row = BrickRow { x: bricks.min.x..bricks.max.x, y, z };
                // Only the computation of masks gains from vector instructions.
                dispatch!(level, simd => row.walk(
                    simd,
                    region,
                    &mut cut,
                    #[inline(always)]
                    |piece| piece.each(
                        #[inline(always)]
                        |b| {
                            if grid.brick_kind(grid.brick_index(b)) != BrickKind::Empty {
                                paint(b, &piece.mask(b));
                            }
                        },
                    ),
                ));
            }
        }
        made
    });
    recorder.close_edit(grid, Vec::new(), EditStats::default(), dirty)
}

/// How colours are stored on a page.
struct PageFormat {
    depth: ColourDepth,
    base: Rgb,
    /// Makes pages of the base colour.
    blank: Brush,
}

/// The page of a brick.
struct BrickPage<'a> {
    /// Linear index of the brick.
    index: u32,
    page: &'a mut Option<Page>,
    /// Whether the stroke already has its earlier state.
    kept: bool,
}

impl PageFormat {
    /// Paints the voxels of `mask` and returns the number of new pages, 0 or 1.
    fn paint(
        &self,
        BrickPage { index, page, kept }: BrickPage,
        mask: &Brick,
        colour: impl Fn(u32, Rgb) -> Rgb,
        record: &mut PageRecord,
    ) -> usize {
        let bytes = self.depth.bytes();
        let mut colours = [Rgb::new(0, 0, 0); BRICK_VOXELS as usize];
        let mut differing = Brick::EMPTY;
        mask.for_each(|i| {
            let now = match page {
                Some(page) => self.depth.read(&page[i as usize * bytes..]),
                None => self.base,
            };
            let next = self.depth.quantise(colour(i, now));
            colours[i as usize] = next;
            differing.words[i as usize / 64] |= u64::from(next != now) << (i % 64);
        });
        if differing.is_empty() {
            return 0;
        }
        if !kept {
            record.earlier.push((index, page.clone()));
        }
        record.changed.push(index);
        record.stats.voxels_recoloured += u64::from(differing.count());
        record.stats.bricks_changed += 1;
        let made = usize::from(self.blank.paint(page, &Brick::EMPTY));
        if let Some(page) = page {
            differing.for_each(|i| {
                self.depth.write(colours[i as usize], &mut page[i as usize * bytes..]);
            });
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use glam::{IVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::sculpture::region::VoxelBox;
    use crate::sculpture::{Grid, Material};

    fn colour_at(v: UVec3, now: Rgb) -> Rgb {
        let [r, g, b] = now.0;
        Rgb::new(r.wrapping_add((v.x * 7) as u8), g.wrapping_add((v.y * 11) as u8), b ^ v.z as u8)
    }

    proptest! {
        #[test]
        fn each_voxel_gets_its_colour_and_the_record_takes_it_back(
            dims in prop::array::uniform3(1u32..70),
            from in prop::array::uniform3(-5i32..60),
            size in prop::array::uniform3(1i32..60),
            depth in prop::sample::select(&ColourDepth::ALL[..]),
            sparse in 1u32..5,
        ) {
            let dims = UVec3::from(dims);
            let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
            grid.fill_bricks(|b| if (b.x + b.y + b.z) % sparse == 0 {
                Brick { words: [0x5a5a_ffff_1234_8001 ^ u64::from(b.x); 8] }
            } else {
                Brick::EMPTY
            });
            let material = Material::for_grid(&grid, depth, Rgb::STONE);
            let mut contents = Contents::new(grid, material);
            let start = contents.clone();
            let mut recorder = StrokeRecorder::new(&contents.grid);
            let mut dirty = BrickSet::default();
            let min = IVec3::from(from);
            let region = VoxelBox { min, max: min + IVec3::from(size) };
            // Twice, so that the second time finds pages.
            for _ in 0..2 {
                let before = contents.clone();
                let stats =
                    paint_each(&mut contents, &region, colour_at, &mut recorder, &mut dirty);
                let mut painted = 0;
                for index in 0..before.grid.brick_count() {
                    for local in 0..BRICK_VOXELS {
                        let [x, y, z] = local_coords(local);
                        let v = before.grid.brick_coords(index) * BRICK_EDGE_VX
                            + UVec3::new(x, y, z);
                        let was = before.material.rgb(index, local);
                        let meant = before.grid.get(v.as_ivec3()) && region.contains(v.as_ivec3());
                        let wanted = match meant && depth != ColourDepth::None {
                            true => depth.quantise(colour_at(v, was)),
                            false => was,
                        };
                        painted += u64::from(wanted != was);
                        prop_assert_eq!(contents.material.rgb(index, local), wanted);
                    }
                }
                prop_assert_eq!(stats.voxels_recoloured, painted);
                prop_assert_eq!(&contents.grid, &before.grid);
            }
            recorder.finish().swap(&mut contents, &mut dirty);
            prop_assert_eq!(contents, start);
        }
    }
}
