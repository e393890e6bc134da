//! Makes the grid and the colours of a volume, by a rule that says which voxels exist and which colours they have.
//!
//! Works by bricks, in parallel. Memory for colours is allocated only for bricks in which an existing voxel differs from
//! the base colour. A volume in memory is read at any place, and its colours are counted before they are allocated. One
//! in its files is read layer by layer, once for the grid and once for the colours, and bits and colours are counted as
//! they come.

use std::sync::atomic::{AtomicU32, Ordering};

use fearless_simd::{Level, dispatch};
use glam::UVec3;
use rayon::prelude::*;

use super::VolumeImport;
use super::view::Voxels;
use crate::format::budget::{budget_bytes, check_budget, check_colour_budget};
use crate::format::layered::{LayeredVolume, Portions};
use crate::format::{FormatError, go_on};
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::sculpture::grid::{GridLayers, LEAF_EDGE_VX};
use crate::sculpture::history::Contents;
use crate::sculpture::material::{MAX_PAGE_BYTES, Page, PageView};
use crate::sculpture::{Brick, ColourDepth, Grid, Material, Rgb};
use crate::tools::pieces;

/// Number of bricks painted between two reports of progress.
const PAINT_BATCH: usize = 1 << 13;

/// Writes the colours of the voxels of a brick, given by its lowest corner, to the packed ones of all its voxels. Called
/// through a pointer once per brick, so that the parallel loops are compiled once and not per voxel type.
type FillPage<'a> = &'a (dyn Fn(UVec3, &Brick, &mut [u8]) + Sync);
/// The same from the layers of a row of bricks, and the z of the first of them.
type FillFromLayers<'a> = &'a (dyn Fn(&[u8], u32, UVec3, &Brick, &mut [u8]) + Sync);

impl VolumeImport<'_> {
    /// Makes a sculpture of the voxels for which `exists` holds, in the colours that `colour` gives them.
    pub(super) fn build<const B: usize>(
        &self,
        depth: ColourDepth,
        exists: impl Fn(&[u8; B]) -> bool + Sync,
        colour: impl Fn(&[u8; B]) -> Rgb + Sync,
    ) -> Result<Contents, FormatError> {
        let dims = self.volume.dims;
        self.progress.begin("filling the grid");
        let grid = match self.volume.voxels {
            Voxels::Held(data) => self.held_grid(data.as_chunks().0, &exists),
            Voxels::Layered(volume) => self.layered_grid(volume, &exists),
        };
        self.progress.end();
        let mut grid = grid?;
        go_on(self.progress)?;
        if self.options.largest_piece {
            pieces::keep_largest(&mut grid, self.limits.grid_bytes, self.progress)?;
        }
        if self.options.fill_holes {
            pieces::fill_holes(&mut grid, self.limits.grid_bytes, self.progress)?;
        }
        let base = self.signature.map_or(Rgb::STONE, |s| s.base);
        let blank = Material::for_grid(&grid, depth, base);
        if depth == ColourDepth::None {
            return Ok(Contents::new(grid, blank));
        }
        // Fills a page from voxels that begin with layer `first`.
        let fill =
            |voxels: &[[u8; B]], first: u32, corner: UVec3, brick: &Brick, page: &mut [u8]| {
                let low = corner - UVec3::Z * first;
                brick.for_each(|local| {
                    let voxel = &voxels[index(low + UVec3::from(local_coords(local)), dims)];
                    // A filled hole has the base colour.
                    if exists(voxel) {
                        depth.write(colour(voxel), &mut page[local as usize * depth.bytes()..]);
                    }
                });
            };
        self.progress.begin("colouring");
        let material = match self.volume.voxels {
            Voxels::Held(data) => {
                let voxels = data.as_chunks().0;
                self.held_colours(&grid, blank, &|corner, brick, page| {
                    fill(voxels, 0, corner, brick, page);
                })
            }
            Voxels::Layered(volume) => {
                let fill =
                    |data: &[u8], first: u32, corner: UVec3, brick: &Brick, page: &mut [u8]| {
                        fill(data.as_chunks().0, first, corner, brick, page);
                    };
                self.layered_colours(volume, &grid, blank, &fill)
            }
        };
        self.progress.end();
        Ok(Contents::new(grid, material?))
    }

    /// Returns the grid of a volume in memory.
    fn held_grid<const B: usize>(
        &self,
        voxels: &[[u8; B]],
        exists: &(impl Fn(&[u8; B]) -> bool + Sync),
    ) -> Result<Grid, FormatError> {
        let (dims, voxel_size) = (self.volume.dims, self.volume.voxel_size);
        let mut grid = Grid::new(dims, voxel_size, self.limits.grid_bytes)?;
        let layers = dims.z.div_ceil(BRICK_EDGE_VX);
        let begun = AtomicU32::new(0);
        grid.fill_bricks(|brick| {
            if self.progress.is_cancelled() {
                return Brick::EMPTY;
            }
            // Reported once per layer of bricks; layers are filled in parallel.
            if brick.x == 0 && brick.y == 0 {
                let before = begun.fetch_add(1, Ordering::Relaxed);
                self.progress.advance(before as f32 / layers as f32);
            }
            let corner = brick * BRICK_EDGE_VX;
            let room = (dims - corner).min(UVec3::splat(BRICK_EDGE_VX));
            let mut rows = [0u64; 8];
            // Plain loops, compiled once for each generation of vector instructions.
            dispatch!(Level::new(), _simd => for z in 0..room.z {
                for y in 0..room.y {
                    let start = index(corner + UVec3::new(0, y, z), dims);
                    let row = &voxels[start..start + room.x as usize];
                    rows[z as usize] |= row_bits(row, exists) << (8 * y);
                }
            });
            Brick::from_rows(&rows)
        });
        Ok(grid)
    }

    /// Returns the grid of a volume in its files.
    fn layered_grid<const B: usize>(
        &self,
        volume: &LayeredVolume,
        exists: &(impl Fn(&[u8; B]) -> bool + Sync),
    ) -> Result<Grid, FormatError> {
        let (dims, voxel_size) = (self.volume.dims, self.volume.voxel_size);
        let mut layers = GridLayers::new(Grid::of_size(dims, voxel_size)?);
        let (width, height) = (dims.x.div_ceil(LEAF_EDGE_VX) as usize, dims.y as usize);
        let plane = width * height;
        let bits_bytes = (plane * LEAF_EDGE_VX as usize * size_of::<u64>()) as u64;
        let needed = bits_bytes + volume.portion_bytes(Portions::Any);
        check_budget(needed, budget_bytes(self.limits))?;
        let mut bits = vec![0u64; plane * LEAF_EDGE_VX as usize];
        volume.for_each(Portions::Any, self.progress, &mut |z, data| {
            let voxels: &[[u8; B]] = data.as_chunks().0;
            let own = &mut bits[(z % LEAF_EDGE_VX) as usize * plane..];
            let row_of = |i: usize| &voxels[i * dims.x as usize..][..dims.x as usize];
            let own = &mut own[..voxels.len() / dims.x as usize * width];
            for_each_row(own, width, &|i, words| {
                dispatch!(Level::new(), _simd => pack_row(row_of(i), words, exists));
            });
            let next = z + (voxels.len() / (dims.x as usize * height)) as u32;
            if next.is_multiple_of(LEAF_EDGE_VX) || next == dims.z {
                let bytes = layers.add(&|leaves| {
                    let rows = LEAF_EDGE_VX.min(dims.y - leaves.y);
                    for (z, y) in (0..LEAF_EDGE_VX).flat_map(|z| (0..rows).map(move |y| (z, y))) {
                        let from = ((leaves.y + y) as usize + height * z as usize) * width;
                        leaves.row(y, z).copy_from_slice(&bits[from..from + width]);
                    }
                });
                bits.fill(0);
                self.check_bits(bytes, next)?;
            }
            Ok(())
        })?;
        Ok(layers.finish())
    }

    /// Returns an error if the bits of the first `layers` layers take more memory than allowed.
    fn check_bits(&self, bytes: u64, layers: u32) -> Result<(), FormatError> {
        let allowed = self.limits.grid_bytes;
        if bytes <= allowed {
            return Ok(());
        }
        // As the others may turn out.
        let all = bytes / u64::from(layers) * u64::from(self.volume.dims.z);
        let what = "the voxels of this volume need about";
        let over = OverBudget::new(what, all.max(bytes), MemoryBudget::Grids, allowed);
        Err(over.advise("choose a region, or a threshold for a smoother surface").into())
    }

    /// Returns the colours of a volume in memory.
    fn held_colours(
        &self,
        grid: &Grid,
        mut painted: Material,
        fill: FillPage,
    ) -> Result<Material, FormatError> {
        let blank = painted.base_page();
        let (depth, page_bytes) = (painted.depth(), painted.page_bytes());
        let page_of = |b: &UVec3| {
            page(&blank, depth, page_bytes, |colours| {
                fill(*b * BRICK_EDGE_VX, grid.brick(*b), colours)
            })
        };
        let filled: Vec<UVec3> = grid.nonempty_bricks().map(|(b, _)| b).collect();
        let budget = self.limits.colour_bytes;
        if painted.bytes_for_pages(filled.len() as u64, u64::MAX) > budget {
            // It may still fit, since bricks may have few colours, or none but the base colour.
            let bytes = |b: &UVec3| page_of(b).map_or((0, 0), |page| (1, page.heap_bytes() as u64));
            let add = |(a, b): (u64, u64), (c, d): (u64, u64)| (a + c, b + d);
            let (pages, bytes) = filled.par_iter().map(bytes).reduce(|| (0, 0), add);
            check_colour_budget(painted.bytes_for_pages(pages, bytes), budget)?;
        }
        for (i, batch) in filled.chunks(PAINT_BATCH).enumerate() {
            go_on(self.progress)?;
            let page = |b: &UVec3| page_of(b).map(|page| (*b, page));
            painted.set_pages(batch.par_iter().filter_map(page).collect());
            self.progress.advance((i * PAINT_BATCH) as f32 / filled.len() as f32);
        }
        Ok(painted)
    }

    /// Returns the colours of a volume in its files.
    fn layered_colours(
        &self,
        volume: &LayeredVolume,
        grid: &Grid,
        mut painted: Material,
        fill: FillFromLayers,
    ) -> Result<Material, FormatError> {
        let blank = painted.base_page();
        let (depth, page_bytes) = (painted.depth(), painted.page_bytes());
        check_budget(volume.portion_bytes(Portions::Bricks), budget_bytes(self.limits))?;
        volume.for_each(Portions::Bricks, self.progress, &mut |first, data| {
            let z = first / BRICK_EDGE_VX;
            let rows = (0..grid.brick_dims().y).into_par_iter();
            let pages = rows.flat_map_iter(|y| {
                let (blank, page_bytes) = (&blank, page_bytes);
                grid.nonempty_in_row(y, z).filter_map(move |(x, brick)| {
                    let b = UVec3::new(x, y, z);
                    let page = page(blank, depth, page_bytes, |colours| {
                        fill(data, first, b * BRICK_EDGE_VX, brick, colours);
                    });
                    page.map(|page| (b, page))
                })
            });
            let pages: Vec<(UVec3, Page)> = pages.collect();
            let bytes = pages.iter().map(|(_, page)| page.heap_bytes() as u64).sum();
            let more = painted.bytes_for_pages(pages.len() as u64, bytes);
            check_colour_budget(painted.heap_bytes() + more, self.limits.colour_bytes)?;
            painted.set_pages(pages);
            Ok(())
        })?;
        Ok(painted)
    }
}

/// Calls `f` with each row of words and its number, on all threads. Calls through a pointer, so that it is compiled once for
/// all kinds of voxels.
fn for_each_row(words: &mut [u64], width: usize, f: &(dyn Fn(usize, &mut [u64]) + Sync)) {
    words.par_chunks_mut(width).enumerate().for_each(|(i, row)| f(i, row));
}

/// Returns the page of a brick that `fill` colours; `None` if it has the base colour everywhere, as `blank` has.
fn page(
    blank: &Page,
    depth: ColourDepth,
    page_bytes: usize,
    fill: impl FnOnce(&mut [u8]),
) -> Option<Page> {
    let mut buffer = [0; MAX_PAGE_BYTES];
    let colours = &mut buffer[..page_bytes];
    PageView::of(blank, depth).write_to(colours);
    fill(colours);
    let page = Page::of_bytes(colours, depth);
    (page != *blank).then_some(page)
}

/// Returns the index of a voxel.
#[inline(always)]
fn index(v: UVec3, dims: UVec3) -> usize {
    v.x as usize + dims.x as usize * (v.y as usize + dims.y as usize * v.z as usize)
}

/// Sets the bits of a row of voxels, the lowest for the first.
#[inline(always)]
fn pack_row<const B: usize>(
    row: &[[u8; B]],
    words: &mut [u64],
    exists: &impl Fn(&[u8; B]) -> bool,
) {
    for (word, voxels) in words.iter_mut().zip(row.chunks(64)) {
        let bytes = voxels.chunks(8).enumerate();
        *word = bytes.fold(0, |word, (i, voxels)| word | row_bits(voxels, exists) << (8 * i));
    }
}

/// Returns one bit for each of up to eight voxels, the lowest for the first.
#[inline(always)]
fn row_bits<const B: usize>(row: &[[u8; B]], exists: &impl Fn(&[u8; B]) -> bool) -> u64 {
    let mut bytes = [0u8; 8];
    match row.first_chunk::<8>() {
        Some(row) => bytes = row.each_ref().map(|v| u8::from(exists(v))),
        None => row.iter().zip(&mut bytes).for_each(|(v, byte)| *byte = u8::from(exists(v))),
    }
    // The factor moves the lowest bit of byte i to bit 56 + i, and nothing else there.
    u64::from_le_bytes(bytes).wrapping_mul(0x0102_0408_1020_4080) >> 56
}
