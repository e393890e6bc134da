//! Finds the voxel of every pixel by any of the samplings, with their device resources: the copy of bits and colours,
//! the slices' areas, readback.
//!
//! The maps end up both in memory, for the software shader and for picking, and on the device, for the composite, with
//! a layer per eye. Where the device also shades, they stay there.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use ash::vk;
use glam::{UVec2, UVec3};

use super::device_copy::DeviceCopy;
use super::entry_times::entry_times;
use super::level_stage::SampledLevels;
use super::pending::PendingUpload;
use super::pixel_pass::PixelStage;
use super::{
    DeviceColours, EyeTask, IndexReadback, IndexTarget, MAX_EYES, RayMarch, Slicing, Volume,
};
use super::{MaskShown, RenderMode, Sampling};
use crate::document::Document;
use crate::gpu::{BufferRange, Device, Recorder, Result, Serial, Staging};
use crate::sculpture::Grid;
use crate::surface::partial::changed_pixels;
use crate::surface::{IndexMap, PixelRect, pixels_of_grid, quickstep, raycast};
use crate::view::PixelRays;

/// Samples a whole map, or a rectangle of it.
type Whole = fn(&Grid, &PixelRays, &mut IndexMap);
type InRect = fn(&Grid, &mut IndexMap, PixelRect);

/// The document to sample, and the mode.
#[derive(Clone, Copy)]
pub(super) struct SampleRequest<'a> {
    /// One set of rays per eye, all with the same size in pixels.
    pub rays: &'a [PixelRays],
    pub mode: RenderMode,
    /// The display of the mask by the copy of the document.
    pub mask: Option<MaskShown>,
    /// The only bricks that have changed since the maps were sampled with the same rays in the same mode. Only the
    /// pixels that may see them are sampled then.
    pub changed: Option<&'a [u32]>,
}

/// Some rows of the map of an eye.
#[derive(Clone)]
pub(super) struct EyeRows {
    pub eye: usize,
    pub rays: PixelRays,
    pub rows: Range<u32>,
}

impl EyeRows {
    /// Returns their pixels.
    pub fn rect(&self) -> PixelRect {
        let EyeRows { rays, rows, .. } = self;
        PixelRect { min: UVec2::new(0, rows.start), max: UVec2::new(rays.size.x, rows.end) }
    }
}

/// Samples the surface of one document.
pub struct Sampler {
    /// Created when first needed: the ray casters do not use it.
    copy: Option<DeviceCopy>,
    passes: SamplingPasses,
    readbacks: [IndexReadback; MAX_EYES],
    maps: Option<IndexTarget>,
    /// Maps being uploaded.
    staging: Staging,
    /// The parts of the maps in memory that are not yet on the device.
    pending: [PendingUpload; MAX_EYES],
    /// The visible rects: nothing is visible outside of them.
    visible: [PixelRect; MAX_EYES],
    read_back_ms: Option<f32>,
    device_ms: Option<f32>,
    device: Arc<Device>,
}

/// Maps on the device, and their state.
pub(super) struct DeviceMaps {
    maps: Option<IndexTarget>,
    pending: [PendingUpload; MAX_EYES],
    visible: [PixelRect; MAX_EYES],
}

impl Default for DeviceMaps {
    fn default() -> DeviceMaps {
        DeviceMaps {
            maps: None,
            pending: [PendingUpload::Nothing; MAX_EYES],
            visible: [PixelRect::EMPTY; MAX_EYES],
        }
    }
}

/// The passes that sample on the device, created when first needed.
#[derive(Default)]
struct SamplingPasses {
    slicing: Option<Slicing>,
    march: Option<RayMarch>,
}

impl Sampler {
    pub fn new(device: &Arc<Device>) -> Result<Sampler> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        Ok(Sampler {
            copy: None,
            passes: SamplingPasses::default(),
            readbacks: std::array::from_fn(|_| IndexReadback::new(device)),
            maps: None,
            staging: Staging::new(device, "index maps", usage, 1 << 20)?,
            pending: [PendingUpload::Nothing; MAX_EYES],
            visible: [PixelRect::EMPTY; MAX_EYES],
            read_back_ms: None,
            device_ms: None,
            device: device.clone(),
        })
    }

    /// Returns the maps on the device, ready for shaders. `maps` are those of the last sampling.
    pub fn maps(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        maps: &[Arc<IndexMap>],
    ) -> Result<&mut IndexTarget> {
        // Maps from memory have their normals there.
        let has_normals =
            self.pending.iter().all(|pending| matches!(pending, PendingUpload::Nothing))
                && self.maps.as_ref().is_some_and(IndexTarget::has_normals);
        let target = target(&self.device, &mut self.maps, maps, has_normals)?;
        self.staging.begin(slot);
        for ((eye, map), pending) in (0..).zip(maps).zip(&mut self.pending) {
            let visible = self.visible[eye as usize];
            match std::mem::take(pending) {
                PendingUpload::Nothing => {}
                PendingUpload::Changed(rect) => {
                    let rect = rect.intersect(visible);
                    let piece = push_rows(&mut self.staging, map, rect)?;
                    target.update(recorder, eye, piece, rect.rows());
                }
                PendingUpload::All => {
                    let piece = push_rows(&mut self.staging, map, visible)?;
                    target.upload(recorder, eye, piece, visible.rows());
                }
            }
            target.make_readable(recorder, eye);
        }
        Ok(target)
    }

    /// Returns the maps on the device, and the copy of the document, once it was sampled in a mode that needs them.
    pub fn on_device(&mut self) -> Option<(&mut IndexTarget, &Volume, Option<&DeviceColours>)> {
        let copy = self.copy.as_ref()?;
        Some((self.maps.as_mut()?, &copy.volume, copy.colours.as_ref()))
    }

    /// Returns the maps on the device, for the pass that finds the smooth surface there.
    pub(super) fn smooth_maps(&mut self, maps: &[Arc<IndexMap>]) -> Result<&mut IndexTarget> {
        target(&self.device, &mut self.maps, maps, true)
    }

    /// Exchanges the maps sampled last for others.
    pub(super) fn swap_maps(&mut self, other: &mut DeviceMaps) {
        std::mem::swap(&mut self.maps, &mut other.maps);
        std::mem::swap(&mut self.pending, &mut other.pending);
        std::mem::swap(&mut self.visible, &mut other.visible);
    }

    /// Returns the visible rect of each eye.
    pub fn visible(&self) -> [PixelRect; MAX_EYES] {
        self.visible
    }

    /// Returns the copy of the document, once it was sampled in a mode that needs it.
    pub fn copy(&self) -> Option<(&Volume, Option<&DeviceColours>)> {
        let copy = self.copy.as_ref()?;
        Some((&copy.volume, copy.colours.as_ref()))
    }

    /// Fills `maps` with the voxels that the rays of `request` see. A map without other owners keeps its allocation. If
    /// the device also shades, the maps are not known in memory ([`IndexMap::is_known`]).
    ///
    /// `smooth`: the surface to sample instead of the voxels, whatever the mode's own sampling is. If it is on the
    /// device, this only updates the copy of the document; the passes that draw do the rest.
    pub(super) fn sample(
        &mut self,
        document: &mut Document,
        request: &SampleRequest,
        smooth: Option<SampledLevels>,
        maps: &mut [Arc<IndexMap>],
    ) -> Result<()> {
        let SampleRequest { rays, mode, changed, .. } = *request;
        self.read_back_ms = None;
        let grid = document.grid();
        if let Some(smooth) = smooth.as_ref().filter(|smooth| smooth.is_on_device()) {
            for (i, (rays, map)) in rays.iter().zip(maps.iter_mut()).enumerate() {
                (self.visible[i], self.pending[i]) = (smooth.visible(rays), PendingUpload::Nothing);
                Arc::make_mut(map).forget(*rays);
            }
            let request = SampleRequest { changed: None, ..*request };
            return self.sample_on_device(document, &request, Sampling::Within, maps);
        }
        if let Some(mut smooth) = smooth {
            self.device_ms = None;
            for (i, (rays, map)) in rays.iter().zip(maps.iter_mut()).enumerate() {
                let visible = smooth.visible(rays);
                let same_visible = std::mem::replace(&mut self.visible[i], visible) == visible;
                let map = Arc::make_mut(map);
                let rects = smooth.sample(grid, rays, changed.is_some(), map);
                let sampled = rects.map(|rects| rects.bounds()).filter(|_| same_visible);
                self.pending[i] = self.pending[i].and(sampled);
            }
            return Ok(());
        }
        let stays = mode.shades_on_device();
        for (i, (rays, map)) in rays.iter().zip(maps.iter_mut()).enumerate() {
            let visible = pixels_of_grid(grid, rays);
            // Only the visible rect of the map is uploaded.
            let same_visible = std::mem::replace(&mut self.visible[i], visible) == visible;
            let map = Arc::make_mut(map);
            let (whole, rect): (Whole, InRect) = match mode.sampling() {
                Sampling::Cast => (raycast::sample, raycast::sample_rect),
                Sampling::Quickstep => (quickstep::sample, quickstep::sample_rect),
                Sampling::Slicing | Sampling::March | Sampling::Within => {
                    if stays {
                        map.forget(*rays)
                    } else {
                        map.reset(grid.dims(), *rays)
                    }
                    self.pending[i] = PendingUpload::Nothing;
                    continue;
                }
            };
            let sampled = match changed {
                Some(bricks) => {
                    let rects = changed_pixels(grid, bricks, rays, 0);
                    rects.as_slice().iter().for_each(|pixels| rect(grid, map, *pixels));
                    Some(rects.bounds()).filter(|_| same_visible)
                }
                None => {
                    whole(grid, rays, map);
                    None
                }
            };
            self.pending[i] = self.pending[i].and(sampled);
        }
        match mode.sampling() {
            Sampling::Cast | Sampling::Quickstep => {
                self.device_ms = None;
                Ok(())
            }
            Sampling::Slicing | Sampling::March | Sampling::Within => {
                self.sample_on_device(document, request, mode.sampling(), maps)
            }
        }
    }

    /// Samples some rows of the map of an eye with the smooth surface, from row 0 on with new rays.
    pub(super) fn sample_rows(
        &mut self,
        grid: &Grid,
        part: &EyeRows,
        smooth: &mut SampledLevels,
        map: &mut IndexMap,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> bool {
        if part.rows.start == 0 {
            map.reset_with_normals(grid.dims(), part.rays);
        }
        let is_sampled = smooth.sample_rect(grid, part.rect(), map, goes_on);
        (self.visible[part.eye], self.pending[part.eye]) =
            (smooth.visible(&part.rays), PendingUpload::All);
        (self.device_ms, self.read_back_ms) = (None, None);
        is_sampled
    }

    fn sample_on_device(
        &mut self,
        document: &mut Document,
        request: &SampleRequest,
        sampling: Sampling,
        maps: &mut [Arc<IndexMap>],
    ) -> Result<()> {
        let tasks = self.tasks(document.grid(), request.changed, maps);
        let mode = request.mode;
        let read_back = !mode.shades_on_device();
        let device = &self.device;
        let copy = match &mut self.copy {
            Some(copy) => copy,
            none => none.insert(DeviceCopy::new(device, document)?),
        };
        let mut recorder = copy.frames.begin()?;
        let slot = copy.frames.slot();
        copy.update(&mut recorder, document, mode, request.mask)?;
        if sampling == Sampling::Within {
            copy.frames.submit(recorder, &[], &[])?;
            self.device_ms = None;
            return Ok(());
        }
        let target = target(device, &mut self.maps, maps, false)?;
        if let Some(timer) = &mut copy.timer {
            let [former] = timer.begin(&mut recorder, slot)?;
            self.device_ms = former.or(self.device_ms);
            timer.start(&mut recorder, 0);
        }
        self.passes.record(&mut recorder, sampling, copy, &tasks, target)?;
        if let Some(timer) = &mut copy.timer {
            timer.stop(&mut recorder, 0);
        }
        if read_back {
            for (task, readback) in tasks.iter().zip(&mut self.readbacks) {
                if let Some(task) = task {
                    readback.record(&mut recorder, slot, target, task)?;
                }
            }
        }
        let serial = copy.frames.submit(recorder, &[], &[])?;
        if read_back {
            device.wait(serial)?;
            self.fetch_maps(document.grid().dims(), &tasks, (slot, serial), maps)?;
            self.device_ms = self.device_ms_when_done(mode)?;
        }
        Ok(())
    }

    /// Returns the parts of `maps` to sample on the device: all, or those that may see `changed` bricks.
    fn tasks(
        &self,
        grid: &Grid,
        changed: Option<&[u32]>,
        maps: &[Arc<IndexMap>],
    ) -> [Option<EyeTask>; MAX_EYES] {
        let mut tasks = [None; MAX_EYES];
        for ((eye, map), task) in (0..).zip(maps).zip(&mut tasks) {
            let mut eye_task =
                EyeTask { visible: self.visible[eye as usize], ..EyeTask::whole(eye, map.rays) };
            if let Some(bricks) = changed {
                eye_task.scissor = changed_pixels(grid, bricks, &map.rays, 0).bounds();
            }
            *task = Some(eye_task).filter(|task| !task.scissor.is_empty());
        }
        tasks
    }

    /// Copies the maps of a grid of `dims` voxels that the submission `serial` of frame `slot` has read back to `maps`.
    fn fetch_maps(
        &mut self,
        dims: UVec3,
        tasks: &[Option<EyeTask>; MAX_EYES],
        (slot, serial): (usize, Serial),
        maps: &mut [Arc<IndexMap>],
    ) -> Result<()> {
        let start = Instant::now();
        for ((map, task), readback) in maps.iter_mut().zip(tasks).zip(&mut self.readbacks) {
            if task.is_some() {
                readback.submitted(slot, serial);
                readback.fetch(slot, dims, Arc::make_mut(map))?;
            }
        }
        self.read_back_ms = Some(start.elapsed().as_secs_f32() * 1e3);
        Ok(())
    }

    /// Returns the time to read back the maps sampled last, in milliseconds; `None` if they were not read back.
    pub fn read_back_ms(&self) -> Option<f32> {
        self.read_back_ms
    }

    /// Returns the device's time for the maps, in milliseconds, without upload and readback: of the maps sampled last,
    /// or if they stay on the device, of the last ones known to be finished. `None` if it does not sample or has no
    /// time stamps.
    pub fn device_ms(&self) -> Option<f32> {
        self.device_ms
    }

    /// Returns that time for the maps sampled last, in `mode`. The caller must have waited for them.
    pub fn device_ms_when_done(&self, mode: RenderMode) -> Result<Option<f32>> {
        let timer = self.copy.as_ref().and_then(|copy| copy.timer.as_ref());
        match (mode.sampling(), timer) {
            (Sampling::Slicing | Sampling::March, Some(timer)) => Ok(timer.latest()?[0]),
            _ => Ok(None),
        }
    }

    /// Drops the device's copy: after an error that may have left it out of date, or before another document.
    pub fn forget_copy(&mut self) {
        self.copy = None;
        self.device_ms = None;
    }
}

/// Stages the rows of a map that `rect` touches, as the composite reads them.
fn push_rows(staging: &mut Staging, map: &IndexMap, rect: PixelRect) -> Result<BufferRange> {
    match map.numbering.is_linear() {
        true => staging.push(rect.rows_of(&map.voxels, map.rays.size.x), 4),
        false => staging.push(&entry_times(map, rect), 4),
    }
}

impl SamplingPasses {
    /// Records the sampling of the parts of `target` that `tasks` describe.
    fn record(
        &mut self,
        recorder: &mut Recorder,
        sampling: Sampling,
        copy: &mut DeviceCopy,
        tasks: &[Option<EyeTask>; MAX_EYES],
        target: &mut IndexTarget,
    ) -> Result<()> {
        let slot = copy.frames.slot();
        match sampling {
            Sampling::March => {
                let pass = match &mut self.march {
                    Some(pass) => pass,
                    none => {
                        let stage = PixelStage::of(&copy.device);
                        none.insert(RayMarch::new(&copy.device, stage, MAX_EYES as u32)?)
                    }
                };
                pass.begin(slot);
                for task in tasks.iter().flatten() {
                    pass.record(recorder, &copy.volume, task, target)?;
                }
            }
            Sampling::Slicing => {
                let pass = match &mut self.slicing {
                    Some(pass) => pass,
                    none => none.insert(Slicing::new(&copy.device)?),
                };
                pass.begin(slot, &copy.volume);
                let areas = copy.areas.get_or_insert_default();
                for task in tasks.iter().flatten() {
                    pass.record(recorder, &copy.volume, areas, task, target)?;
                }
            }
            Sampling::Cast | Sampling::Quickstep | Sampling::Within => {}
        }
        Ok(())
    }
}

/// Returns the target for maps of the number and size of `maps`, with normals or without.
fn target<'a>(
    device: &Arc<Device>,
    target: &'a mut Option<IndexTarget>,
    maps: &[Arc<IndexMap>],
    has_normals: bool,
) -> Result<&'a mut IndexTarget> {
    let eyes = maps.len() as u32;
    let size = maps.first().map_or(glam::UVec2::ONE, |map| map.rays.size);
    let wanted = (size, eyes, has_normals);
    target.take_if(|found| (found.size(), found.eyes(), found.has_normals()) != wanted);
    Ok(match target {
        Some(target) => target,
        none if has_normals => none.insert(IndexTarget::with_normals(device, size, eyes)?),
        none => none.insert(IndexTarget::new(device, size, eyes)?),
    })
}
