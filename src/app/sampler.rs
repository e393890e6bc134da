//! Owns finding the voxel of every pixel, in whichever way the person has chosen, and what the
//! device needs for it: the copy of the bits, the slices' areas, the way back.
//!
//! The map ends up both in memory, for the software shader and the pointer, and on the device,
//! for the composite.

use std::sync::Arc;

use ash::vk;
use glam::Affine3A;

use crate::config::RenderMode;
use crate::document::Document;
use crate::gpu::{Device, Frames, Recorder, Result, Staging};
use crate::render::{IndexReadback, IndexTarget, Slicing, Volume};
use crate::surface::slices::SliceAreas;
use crate::surface::{IndexMap, quickstep, raycast};
use crate::view::Eye;

/// Samples the surface of one document.
pub struct Sampler {
    /// Made when first needed: the ray casters do without.
    slices: Option<Slices>,
    maps: Option<IndexTarget>,
    /// Maps on their way to the device.
    staging: Staging,
    /// The map in memory is not yet on the device.
    pending: bool,
    device: Arc<Device>,
}

/// What slicing needs.
struct Slices {
    pass: Slicing,
    volume: Volume,
    areas: SliceAreas,
    readback: IndexReadback,
    frames: Frames,
}

impl Sampler {
    pub fn new(device: &Arc<Device>) -> Result<Sampler> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        Ok(Sampler {
            slices: None,
            maps: None,
            staging: Staging::new(device, "index maps", usage, 1 << 20)?,
            pending: false,
            device: device.clone(),
        })
    }

    /// The maps on the device, ready for shaders. `map` is what was sampled last.
    pub fn maps(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        map: &IndexMap,
    ) -> Result<&IndexTarget> {
        let maps = target(&self.device, &mut self.maps, map)?;
        if self.pending {
            self.staging.begin(slot);
            let piece = self.staging.push(&map.voxels, 4)?;
            maps.upload(recorder, 0, piece);
            self.pending = false;
        }
        maps.make_readable(recorder, 0);
        Ok(maps)
    }

    /// Fills `map` with what `eye` sees of the document.
    pub fn sample(
        &mut self,
        document: &mut Document,
        eye: &Eye,
        world_from_grid: &Affine3A,
        mode: RenderMode,
        map: &mut IndexMap,
    ) -> Result<()> {
        let rays = eye.pixel_rays(world_from_grid);
        match mode {
            RenderMode::Ray => raycast::sample(document.grid(), &rays, map),
            RenderMode::Quickstep => quickstep::sample(document.grid(), &rays, map),
            RenderMode::Slicing => {
                map.reset(rays);
                return self.slice(document, map);
            }
        }
        self.pending = true;
        Ok(())
    }

    fn slice(&mut self, document: &mut Document, map: &mut IndexMap) -> Result<()> {
        let device = &self.device;
        let slices = match &mut self.slices {
            Some(slices) => slices,
            // All bricks are new to a new copy, whatever the document says has changed.
            slices => slices.insert(document.take_dirty(|contents, _| {
                let mut areas = SliceAreas::default();
                areas.update(&contents.grid, None);
                Result::Ok(Slices {
                    pass: Slicing::new(device)?,
                    volume: Volume::new(device, &contents.grid)?,
                    areas,
                    readback: IndexReadback::new(device),
                    frames: Frames::new(device)?,
                })
            })?),
        };
        let maps = target(device, &mut self.maps, map)?;
        let mut recorder = slices.frames.begin()?;
        let slot = slices.frames.slot();
        document.take_dirty(|contents, changed| {
            slices.areas.update(&contents.grid, changed);
            slices.volume.update(&mut recorder, slot, &contents.grid, changed)
        })?;
        slices.pass.begin(slot, &slices.volume);
        let (pass, volume, areas) = (&mut slices.pass, &slices.volume, &mut slices.areas);
        pass.record(&mut recorder, volume, areas, &map.rays, maps, 0)?;
        slices.readback.record(&mut recorder, slot, maps, 0, &map.rays)?;
        let serial = slices.frames.submit(recorder, &[], &[])?;
        slices.readback.submitted(slot, serial);
        self.pending = false;
        slices.readback.fetch(slot, map)
    }

    /// Forgets the device's copy, after an error that may have left it behind the document.
    pub fn forget_copy(&mut self) {
        self.slices = None;
    }
}

/// The target for maps of the size of `map`.
fn target<'a>(
    device: &Arc<Device>,
    maps: &'a mut Option<IndexTarget>,
    map: &IndexMap,
) -> Result<&'a mut IndexTarget> {
    let size = map.rays.size;
    if maps.as_ref().is_none_or(|maps| maps.size() != size) {
        *maps = None;
    }
    Ok(match maps {
        Some(maps) => maps,
        none => none.insert(IndexTarget::new(device, size, 1)?),
    })
}
