//! The device's copy of the smooth surface ([`LevelSet`]): a buffer with the page of each brick and the pages, a byte a
//! voxel (shaders/level_field.wgsl), and the bits of the cells, in which rays find it.
//!
//! It is uploaded as a whole at first, and afterwards by the bricks that have changed. Its memory is in proportion to
//! the surface; the bits of the cells take as much as those of the voxels. If either exceeds a limit of the device,
//! that fails with the name of the limit, before anything of a frame is recorded.

use std::sync::Arc;

use super::Volume;
use super::paged_buffer::{CHUNK_BYTES, PagedBuffer, PagedKind};
use crate::gpu::{Buffer, Device, Recorder, Result};
use crate::sculpture::Grid;
use crate::sculpture::brick::BrickKind;
use crate::shade::LevelSet;
use crate::shade::level_set::{NO_PAGE, PageLevels};

const KIND: PagedKind = PagedKind {
    name: "levels",
    what: "the smooth surface of the sculpture",
    unit_bytes: size_of::<PageLevels>(),
};

/// The entry of a full brick without a page; that of an empty one is [`NO_PAGE`].
const FULL_BRICK: u32 = NO_PAGE - 1;

/// The copy.
pub struct Levels {
    pages: PagedBuffer,
    /// Entries as they are on the device.
    table: Vec<u32>,
    cells: Volume,
    /// Bricks that are not up to date, rising.
    outdated: Vec<u32>,
    /// Reused allocations.
    written: Vec<u32>,
    cell_bricks: Vec<u32>,
}

impl Levels {
    /// Uploads all levels and waits for it. `levels` must be up to date with `grid`.
    pub fn new(device: &Arc<Device>, grid: &Grid, levels: &LevelSet) -> Result<Levels> {
        let table: Vec<u32> =
            (0..grid.brick_count() as u32).map(|brick| entry(grid, levels, brick)).collect();
        Ok(Levels {
            pages: PagedBuffer::new(device, KIND, &table, bytes(levels))?,
            table,
            cells: Volume::new(device, levels.cells())?,
            outdated: Vec::new(),
            written: Vec::new(),
            cell_bricks: Vec::new(),
        })
    }

    /// Records that the levels or cells of `changed` bricks (rising) differ. Returns false if there is no room for
    /// them, so that a new copy is needed.
    pub fn follow(&mut self, grid: &Grid, levels: &LevelSet, changed: &[u32]) -> bool {
        self.outdated.extend_from_slice(changed);
        self.outdated.sort_unstable();
        self.outdated.dedup();
        self.cells.dims() == levels.cells().dims()
            && self.pages.has_room(grid.brick_count(), levels.pages().len())
            && self.outdated.len() * size_of::<PageLevels>() <= CHUNK_BYTES
    }

    /// Updates the copy with the changes of [`Levels::follow`]. Recorded in `recorder`, for frame `slot`, once per
    /// frame. After an error the copy is out of date.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        grid: &Grid,
        levels: &LevelSet,
    ) -> Result<()> {
        let Levels { pages, table, cells, outdated, written, cell_bricks } = self;
        written.clear();
        cell_bricks.clear();
        for &brick in outdated.iter() {
            let entry = entry(grid, levels, brick);
            table[brick as usize] = entry;
            if entry < FULL_BRICK {
                written.push(entry);
            }
            cell_bricks.extend(levels.cell_bricks(grid, brick));
        }
        written.sort_unstable();
        cell_bricks.sort_unstable();
        cell_bricks.dedup();
        cells.update(recorder, slot, levels.cells(), Some(cell_bricks))?;
        pages.update(recorder, slot, (table, outdated), (bytes(levels), written))?;
        outdated.clear();
        Ok(())
    }

    pub fn buffer(&self) -> &Buffer {
        self.pages.buffer()
    }

    /// Returns the bits of the cells.
    pub fn cells(&self) -> &Volume {
        &self.cells
    }
}

/// Returns the entry of a brick in the table.
fn entry(grid: &Grid, levels: &LevelSet, brick: u32) -> u32 {
    let b = grid.brick_coords(brick as usize);
    match levels.page(b) {
        NO_PAGE if grid.kind(b) == BrickKind::Full => FULL_BRICK,
        page => page,
    }
}

fn bytes(levels: &LevelSet) -> &[u8] {
    bytemuck::cast_slice(levels.pages())
}
