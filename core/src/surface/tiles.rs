//! Divides an index map into tiles that are sampled in parallel, without allocating.

use glam::UVec2;
use rayon::prelude::*;

use super::IndexMap;
use super::index_map::PixelRect;
use super::numbering::VoxelNumbering;

/// Largest width and height of a tile, in pixels: a row of a tile is a 64-bit mask.
pub(super) const TILE_EDGE_PX: u32 = 64;

const ROWS: usize = TILE_EDGE_PX as usize;

/// A rectangle of an index map, at most [`TILE_EDGE_PX`] wide and high.
pub(super) struct Tile<'a> {
    pub rect: PixelRect,
    rows: [&'a mut [u32]; ROWS],
}

impl Tile<'_> {
    /// Returns the row of pixels at `y`, counted from the top of the tile.
    #[inline(always)]
    pub fn row(&mut self, y: u32) -> &mut [u32] {
        self.rows[y as usize]
    }
}

/// Calls `f` for tiles that cover `rect` (cut to the picture), in parallel, each with the numbering of the map.
pub(super) fn for_each_tile(
    map: &mut IndexMap,
    rect: PixelRect,
    f: impl Fn(Tile, &VoxelNumbering) + Sync,
) {
    let PixelRect { min, max } = rect.intersect(PixelRect::of_picture(map.rays.size));
    if !min.cmplt(max).all() {
        return;
    }
    let width = map.rays.size.x as usize;
    let columns = min.x as usize..max.x as usize;
    let numbering = &map.numbering;
    let f = |tile: Tile| f(tile, numbering);
    map.voxels[min.y as usize * width..max.y as usize * width]
        .par_chunks_mut(width * ROWS)
        .zip((min.y..max.y).into_par_iter().step_by(ROWS))
        .for_each(|(band, top)| {
            let bottom = max.y.min(top + TILE_EDGE_PX);
            let mut rows = empty_rows();
            for (row, pixels) in rows.iter_mut().zip(band.chunks_exact_mut(width)) {
                *row = &mut pixels[columns.clone()];
            }
            let rect = PixelRect { min: UVec2::new(min.x, top), max: UVec2::new(max.x, bottom) };
            halve(Tile { rect, rows }, &f);
        });
}

/// Splits a band of tiles in two until single tiles are left.
fn halve(tile: Tile, f: &(impl Fn(Tile) + Sync)) {
    let PixelRect { min, max } = tile.rect;
    let tiles = (max.x - min.x).div_ceil(TILE_EDGE_PX);
    if tiles <= 1 {
        return f(tile);
    }
    let middle = min.x + tiles / 2 * TILE_EDGE_PX;
    let (mut left, mut right) = (empty_rows(), empty_rows());
    for (i, row) in tile.rows.into_iter().enumerate() {
        (left[i], right[i]) = row.split_at_mut(row.len().min((middle - min.x) as usize));
    }
    let left_rect = PixelRect { min, max: UVec2::new(middle, max.y) };
    let right_rect = PixelRect { min: UVec2::new(middle, min.y), max };
    rayon::join(
        || halve(Tile { rect: left_rect, rows: left }, f),
        || halve(Tile { rect: right_rect, rows: right }, f),
    );
}

fn empty_rows<'a>() -> [&'a mut [u32]; ROWS] {
    std::array::from_fn(|_| Default::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::PixelRays;
    use glam::Vec3;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn tiles_cover_each_pixel_of_the_rectangle_once(
            size in prop::array::uniform2(1u32..300),
            a in prop::array::uniform2(0u32..320),
            b in prop::array::uniform2(0u32..320),
        ) {
            let size = UVec2::from(size);
            let rays = PixelRays {
                origin: Vec3::ZERO, corner: Vec3::Z, step_x: Vec3::X, step_y: Vec3::Y, size,
            };
            let mut map = IndexMap::new(rays);
            map.voxels.fill(7);
            let rect = PixelRect { min: UVec2::from(a), max: UVec2::from(b) };
            for_each_tile(&mut map, rect, |mut tile, _| {
                let PixelRect { min, max } = tile.rect;
                for y in min.y..max.y {
                    let row = tile.row(y - min.y);
                    assert_eq!(row.len() as u32, max.x - min.x);
                    for (value, x) in row.iter_mut().zip(min.x..) {
                        assert_eq!(std::mem::replace(value, x + 1000 * y + 10), 7);
                    }
                }
            });
            for y in 0..size.y {
                for x in 0..size.x {
                    let inside = x >= a[0] && x < b[0] && y >= a[1] && y < b[1];
                    let expected = if inside { x + 1000 * y + 10 } else { 7 };
                    prop_assert_eq!(map.get(x, y), Some(expected));
                }
            }
        }
    }
}
