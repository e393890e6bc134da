//! The device's copy of the normals of a sculpture's surface ([`NormalField`]): one buffer with the page of each brick,
//! then the units of all pages, as they lie in memory (shaders/normal_field.wgsl).
//!
//! It is uploaded as a whole at first, and afterwards by the written units; if there is no room for more units, it is
//! uploaded anew. If it exceeds a limit of the device, that fails with the name of the limit.

use std::sync::Arc;

use super::paged_buffer::{CHUNK_BYTES, PagedBuffer, PagedKind};
use crate::gpu::{Buffer, Device, Recorder, Result};
use crate::sculpture::Grid;
use crate::shade::NormalField;
use crate::shade::normal_field::PageUnit;

const KIND: PagedKind = PagedKind {
    name: "normals",
    what: "the normals of the sculpture",
    unit_bytes: size_of::<PageUnit>(),
};

/// The copy.
pub struct Normals {
    pages: PagedBuffer,
    /// Entries as they are on the device.
    table: Vec<u32>,
    /// The [`NormalField::generation`] of the copy.
    generation: u64,
    device: Arc<Device>,
}

impl Normals {
    /// Uploads all normals and waits for it.
    pub fn new(device: &Arc<Device>, field: &NormalField) -> Result<Normals> {
        let units = bytemuck::cast_slice(field.pages().units());
        let table = field.table().linear();
        let pages = PagedBuffer::new(device, KIND, &table, units)?;
        Ok(Normals { pages, table, generation: field.generation(), device: device.clone() })
    }

    /// Updates the copy: `written` units and the entries of `bricks`, both rising, differ. Recorded in `recorder`, for
    /// frame `slot`, once per frame. After an error the copy is out of date.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        (grid, field): (&Grid, &NormalField),
        written: &[u32],
        bricks: &[u32],
    ) -> Result<()> {
        let units = field.pages().units();
        let is_other = self.generation != field.generation()
            || !self.pages.has_room(grid.brick_count(), units.len());
        if is_other || size_of::<PageUnit>() * written.len() > CHUNK_BYTES {
            *self = Normals::new(&self.device, field)?;
            return Ok(());
        }
        let units = bytemuck::cast_slice(units);
        for &brick in bricks {
            self.table[brick as usize] = field.table().page(grid.brick_coords(brick as usize));
        }
        self.pages.update(recorder, slot, (&self.table, bricks), (units, written))
    }

    pub fn buffer(&self) -> &Buffer {
        self.pages.buffer()
    }
}
