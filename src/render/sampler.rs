//! Owns finding the voxel of every pixel, in whichever way is asked for, and what the device needs
//! for it: the copy of the bits, the slices' areas, the way back.
//!
//! The maps end up both in memory, for the software shader and the pointer, and on the device, for
//! the composite: one layer an eye.

use std::sync::Arc;

use ash::vk;

use super::{IndexReadback, IndexTarget, MAX_EYES, Slicing, Volume};
use crate::config::RenderMode;
use crate::document::Document;
use crate::gpu::{Device, Frames, Recorder, Result, Staging};
use crate::surface::slices::SliceAreas;
use crate::surface::{IndexMap, quickstep, raycast};
use crate::view::PixelRays;

/// Samples the surface of one document.
pub struct Sampler {
    /// Made when first needed: the ray casters do without.
    slices: Option<Slices>,
    maps: Option<IndexTarget>,
    /// Maps on their way to the device.
    staging: Staging,
    /// The maps in memory that are not yet on the device.
    pending: [bool; MAX_EYES],
    device: Arc<Device>,
}

/// What slicing needs.
struct Slices {
    pass: Slicing,
    volume: Volume,
    areas: SliceAreas,
    readbacks: [IndexReadback; MAX_EYES],
    frames: Frames,
}

impl Sampler {
    pub fn new(device: &Arc<Device>) -> Result<Sampler> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        Ok(Sampler {
            slices: None,
            maps: None,
            staging: Staging::new(device, "index maps", usage, 1 << 20)?,
            pending: [false; MAX_EYES],
            device: device.clone(),
        })
    }

    /// The maps on the device, ready for shaders. `maps` are those that were sampled last.
    pub fn maps(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        maps: &[Arc<IndexMap>],
    ) -> Result<&IndexTarget> {
        let target = target(&self.device, &mut self.maps, maps)?;
        self.staging.begin(slot);
        for ((eye, map), pending) in (0..).zip(maps).zip(&mut self.pending) {
            if std::mem::take(pending) {
                let piece = self.staging.push(&map.voxels, 4)?;
                target.upload(recorder, eye, piece);
            }
            target.make_readable(recorder, eye);
        }
        Ok(target)
    }

    /// Fills `maps` with what is seen of the document by `rays`: one set of rays an eye, all of
    /// one size in pixels. A map that nobody else holds keeps its memory.
    pub fn sample(
        &mut self,
        document: &mut Document,
        rays: &[PixelRays],
        mode: RenderMode,
        maps: &mut [Arc<IndexMap>],
    ) -> Result<()> {
        for (rays, map) in rays.iter().zip(maps.iter_mut()) {
            let map = Arc::make_mut(map);
            match mode {
                RenderMode::Ray => raycast::sample(document.grid(), rays, map),
                RenderMode::Quickstep => quickstep::sample(document.grid(), rays, map),
                RenderMode::Slicing => map.reset(*rays),
            }
        }
        if mode == RenderMode::Slicing {
            return self.slice(document, maps);
        }
        self.pending = [true; MAX_EYES];
        Ok(())
    }

    fn slice(&mut self, document: &mut Document, maps: &mut [Arc<IndexMap>]) -> Result<()> {
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
                    readbacks: std::array::from_fn(|_| IndexReadback::new(device)),
                    frames: Frames::new(device)?,
                })
            })?),
        };
        let target = target(device, &mut self.maps, maps)?;
        let mut recorder = slices.frames.begin()?;
        let slot = slices.frames.slot();
        document.take_dirty(|contents, changed| {
            slices.areas.update(&contents.grid, changed);
            slices.volume.update(&mut recorder, slot, &contents.grid, changed)
        })?;
        slices.pass.begin(slot, &slices.volume);
        let (pass, volume, areas) = (&mut slices.pass, &slices.volume, &mut slices.areas);
        for ((eye, map), readback) in (0..).zip(maps.iter()).zip(&mut slices.readbacks) {
            pass.record(&mut recorder, volume, areas, &map.rays, target, eye)?;
            readback.record(&mut recorder, slot, target, eye, &map.rays)?;
        }
        let serial = slices.frames.submit(recorder, &[], &[])?;
        for (map, readback) in maps.iter_mut().zip(&mut slices.readbacks) {
            readback.submitted(slot, serial);
            readback.fetch(slot, Arc::make_mut(map))?;
        }
        self.pending = [false; MAX_EYES];
        Ok(())
    }

    /// Forgets the device's copy, after an error that may have left it behind the document.
    pub fn forget_copy(&mut self) {
        self.slices = None;
    }
}

/// The target for maps of the number and size of `maps`.
fn target<'a>(
    device: &Arc<Device>,
    target: &'a mut Option<IndexTarget>,
    maps: &[Arc<IndexMap>],
) -> Result<&'a mut IndexTarget> {
    let eyes = maps.len() as u32;
    let size = maps.first().map_or(glam::UVec2::ONE, |map| map.rays.size);
    if target.as_ref().is_none_or(|target| target.size() != size || target.eyes() != eyes) {
        *target = None;
    }
    Ok(match target {
        Some(target) => target,
        none => none.insert(IndexTarget::new(device, size, eyes)?),
    })
}
