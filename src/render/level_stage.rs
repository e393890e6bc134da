//! The smooth surface of a renderer's pictures: when it is drawn, its changes, and the device's copy.
//!
//! Follows the grid and the normals of one document. The surface between voxels is drawn where a voxel covers more than
//! a pixel of any picture; farther away it would be invisible. Modes that shade on the device find it there, once all of
//! it is computed: for an opened sculpture in portions, while pictures show the voxels. On the CPU, pictures compute
//! what they show. A sculpture that is too large for it shows its voxels.

use std::fmt::Display;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use glam::UVec3;

use super::{IndexTarget, LevelMarch, LevelTask, Levels, MAX_EYES, Normals};
use crate::gpu::{Device, GpuError, Recorder, Result};
use crate::sculpture::brick_set::{BrickSet, for_each_in};
use crate::sculpture::{Grid, GridError};
use crate::shade::{LevelSampler, LevelSet, NormalField};
use crate::surface::{IndexMap, PixelRect, PixelRects, changed_pixels, pixels_of_grid};
use crate::view::PixelRays;

/// Bits of a grid from which on a picture that must not wait lets another thread find its cells.
const LARGE_BYTES: u64 = 8 << 20;

/// Reach of a voxel's level beyond the voxel: cells lie between the middles of voxels.
const LEVEL_REACH_VX: u32 = 1;

/// The requirements of the next picture.
pub(super) struct LevelWish {
    /// Its mode can show the surface, and the surface is wanted.
    pub wanted: bool,
    /// The device that shades, if the mode shades on one.
    pub device: Option<Arc<Device>>,
    /// The most memory of the surface.
    pub budget_bytes: u64,
    /// Longest delay by a surface that has never been complete; `None`: until it is.
    pub patience: Option<Duration>,
}

type NewLevels = std::result::Result<LevelSet, GridError>;

/// A surface whose cells another thread finds.
struct BegunLevels {
    thread: JoinHandle<NewLevels>,
    /// The size of its grid in voxels.
    dims: UVec3,
    /// The bricks that have changed, or have other normals, since it began.
    changed: Vec<u32>,
}

/// See the module text.
#[derive(Default)]
pub(super) struct LevelStage {
    levels: Option<LevelSet>,
    begun: Option<BegunLevels>,
    sampler: LevelSampler,
    /// The present picture shows the smooth surface.
    active: bool,
    /// It will show it once the surface is complete.
    pending: bool,
    /// The surface was complete, and follows edits at once.
    was_complete: bool,
    /// There is no memory for the surface of this sculpture.
    given_up: bool,
    /// Bricks whose levels, or normals between voxels, differ from those of the last picture, rising.
    changed: Vec<u32>,
    /// Exists only while a mode uses it.
    copy: Option<Levels>,
    march: Option<LevelMarch>,
    /// The outstanding parts of maps on the device.
    tasks: [Option<LevelTask>; MAX_EYES],
}

impl LevelStage {
    /// Updates the surface for a picture of `grid`, if the picture shows it. `edited`: the bricks that have changed since
    /// the last call; `reshaded`: those, and the bricks with other normals; `None`: all may have.
    pub fn update(
        &mut self,
        grid: &Grid,
        normals: &NormalField,
        edited: &[u32],
        reshaded: Option<&[u32]>,
        wish: &LevelWish,
    ) -> Result<()> {
        let mut followed = BrickSet::default();
        match (reshaded, &mut self.levels) {
            (Some(changed), Some(levels)) if levels.fits(grid) => {
                match wish.device {
                    Some(_) => levels.follow(grid, edited),
                    // Normals of bricks out of sight may follow later.
                    None => levels.follow_edits(grid, edited),
                }
                followed = levels.follow_normals(grid, changed);
            }
            (Some(changed), None) => match &mut self.begun {
                Some(begun) if begun.dims == grid.dims() => {
                    begun.changed.extend_from_slice(changed)
                }
                _ => self.forget(),
            },
            _ => self.forget(),
        }
        if reshaded.is_none() {
            self.given_up = false;
        }
        self.show(grid, normals, wish)?;
        if let (true, Some(reshaded)) = (self.active, reshaded) {
            // Between voxels, normals may differ where levels do not.
            self.changed.extend_from_slice(reshaded);
            if wish.device.is_none() {
                // Which of them differ is found out when they are seen.
                for (leaf, bricks) in followed.leaves() {
                    let changed = &mut self.changed;
                    for_each_in(leaf, &bricks, |b| changed.push(grid.brick_index(b) as u32));
                }
            }
            self.changed.sort_unstable();
            self.changed.dedup();
        }
        Ok(())
    }

    fn forget(&mut self) {
        (self.levels, self.begun, self.copy, self.was_complete) = (None, None, None, false);
    }

    /// Decides whether the next pictures show the surface, and if so, updates it.
    pub fn show(&mut self, grid: &Grid, normals: &NormalField, wish: &LevelWish) -> Result<()> {
        self.changed.clear();
        self.tasks = [None; MAX_EYES];
        (self.active, self.pending) = (false, false);
        if wish.device.is_none() {
            self.copy = None;
        }
        if !wish.wanted || self.given_up {
            return Ok(());
        }
        if wish.device.is_some() && !normals.is_complete() {
            // It is wanted once pictures have all normals that they show: there is no memory for the others. The CPU computes
            // those that it needs.
            self.give_up(&"its normals take more memory than grids may");
            return Ok(());
        }
        if self.levels.is_none() {
            match self.begin(grid, wish) {
                Some(Ok(levels)) => self.levels = Some(levels),
                None => {
                    self.pending = true;
                    return Ok(());
                }
                Some(Err(reason)) => {
                    self.give_up(&reason);
                    return Ok(());
                }
            }
        }
        match self.complete(grid, normals, wish) {
            Ok(complete) => {
                (self.active, self.pending) = (complete, !complete && !self.given_up);
            }
            Err(reason @ (GpuError::Limit { .. } | GpuError::OutOfMemory(_))) => {
                self.give_up(&reason);
            }
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Returns the surface, of which nothing is computed yet; `None` while another thread finds its cells.
    fn begin(&mut self, grid: &Grid, wish: &LevelWish) -> Option<NewLevels> {
        let budget_bytes = wish.budget_bytes;
        match self.begun.take() {
            Some(begun) if wish.patience.is_some() && !begun.thread.is_finished() => {
                self.begun = Some(begun);
                None
            }
            Some(BegunLevels { thread, changed, .. }) => {
                let levels = thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
                Some(levels.map(|mut levels| {
                    levels.follow_edits(grid, &changed);
                    levels
                }))
            }
            None if wish.patience.is_some() && grid.heap_bytes() > LARGE_BYTES => {
                let (snapshot, dims, changed) = (grid.clone(), grid.dims(), Vec::new());
                let find = move || LevelSet::new(&snapshot, budget_bytes);
                match thread::Builder::new().name("cells".to_string()).spawn(find) {
                    Ok(thread) => {
                        self.begun = Some(BegunLevels { thread, dims, changed });
                        None
                    }
                    Err(_) => Some(LevelSet::new(grid, budget_bytes)),
                }
            }
            None => Some(LevelSet::new(grid, budget_bytes)),
        }
    }

    fn give_up(&mut self, reason: &dyn Display) {
        tracing::warn!("voxels are shown instead of the smooth surface: {reason}");
        self.forget();
        self.given_up = true;
    }

    /// Computes all outstanding parts for the device, and there. Returns whether it is finished.
    fn complete(&mut self, grid: &Grid, normals: &NormalField, wish: &LevelWish) -> Result<bool> {
        let Some(levels) = &mut self.levels else { return Ok(false) };
        let Some(device) = &wish.device else { return Ok(true) };
        if let Err(reason) = levels.check_whole(grid, wish.budget_bytes) {
            self.give_up(&reason);
            return Ok(false);
        }
        let start = Instant::now();
        let patience = wish.patience.filter(|_| !self.was_complete);
        levels.update_while(grid, normals, &mut self.changed, || {
            patience.is_none_or(|patience| start.elapsed() < patience)
        });
        if !levels.is_complete() {
            return Ok(false);
        }
        self.was_complete = true;
        let copy = self.copy.as_mut();
        if !copy.is_some_and(|copy| copy.follow(grid, levels, &self.changed)) {
            // Drops the old one first, since both may not fit.
            self.copy = None;
            self.copy = Some(Levels::new(device, grid, levels)?);
        }
        Ok(true)
    }

    /// Returns whether the picture shows the smooth surface, and if so, whether it differs from that of the last
    /// picture.
    pub fn state(&self) -> Option<bool> {
        self.active.then_some(!self.changed.is_empty())
    }

    /// Returns whether pictures will show the smooth surface once it is complete.
    pub fn is_pending(&self) -> bool {
        self.pending
    }

    /// Returns whether the picture shows the smooth surface and the device finds it.
    pub fn is_on_device(&self) -> bool {
        self.active && self.copy.is_some()
    }

    /// Returns the bricks whose levels or normals differ from those of the last picture.
    pub fn changed(&self) -> &[u32] {
        &self.changed
    }

    /// Returns the surface, if the picture shows it, for a sample of antialiased pictures
    /// ([`super::FrameDesc::sample`]).
    pub fn surface<'a>(
        &'a mut self,
        normals: &'a mut NormalField,
        sample: u32,
    ) -> Option<SampledLevels<'a>> {
        let is_on_device = self.is_on_device();
        let levels = self.levels.as_mut().filter(|_| self.active)?;
        self.sampler.sample = sample;
        let (changed, sampler) = (self.changed.as_slice(), &mut self.sampler);
        Some(SampledLevels { levels, normals, changed, sampler, is_on_device })
    }

    /// Requests the surface from the device for the pixels of a task.
    pub fn ask_device(&mut self, task: LevelTask) {
        self.tasks[task.part.eye as usize] = Some(task);
    }

    /// Cancels all other requests to the device.
    pub fn ask_device_only(&mut self, task: LevelTask) {
        self.tasks = [None; MAX_EYES];
        self.ask_device(task);
    }

    /// Executes the requests on the device: records the update of its copy, and fills the parts of maps. Once per
    /// frame.
    pub fn march(
        &mut self,
        device: &Arc<Device>,
        recorder: &mut Recorder,
        slot: usize,
        (grid, normals): (&Grid, &Normals),
        target: &mut IndexTarget,
    ) -> Result<()> {
        let tasks = std::mem::take(&mut self.tasks);
        let (Some(copy), Some(levels)) = (&mut self.copy, &self.levels) else { return Ok(()) };
        let march = match &mut self.march {
            Some(march) => march,
            none => none.insert(LevelMarch::new(device, MAX_EYES as u32)?),
        };
        copy.update(recorder, slot, grid, levels)?;
        march.begin(slot);
        for task in tasks.iter().flatten() {
            march.record(recorder, copy, normals, task, target)?;
        }
        Ok(())
    }

    /// Returns whether anything was requested from the device since the last march.
    pub fn has_tasks(&self) -> bool {
        self.tasks.iter().any(Option::is_some)
    }
}

/// The smooth surface, ready to be sampled.
pub(super) struct SampledLevels<'a> {
    levels: &'a mut LevelSet,
    normals: &'a mut NormalField,
    changed: &'a [u32],
    sampler: &'a mut LevelSampler,
    is_on_device: bool,
}

impl SampledLevels<'_> {
    /// Returns whether the device finds it instead of the methods that sample.
    pub fn is_on_device(&self) -> bool {
        self.is_on_device
    }

    /// Returns the pixels in which anything can be visible.
    pub fn visible(&self, rays: &PixelRays) -> PixelRect {
        pixels_of_grid(self.levels.cells(), &LevelSet::rays_of_cells(rays))
    }

    /// Samples the pixels of `rect` of a map that has its rays, for as long as `goes_on` returns true. Returns whether
    /// they are all sampled; if not, the next call has less to do.
    pub fn sample_rect(
        &mut self,
        grid: &Grid,
        rect: PixelRect,
        map: &mut IndexMap,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> bool {
        let surface = (&mut *self.normals, &mut *self.levels);
        self.sampler.complete_rect(grid, surface, rect, map, goes_on)
    }

    /// Samples `map` with `rays`, or only the changes since it was sampled with them; in that case returns the pixels.
    pub fn sample(
        &mut self,
        grid: &Grid,
        rays: &PixelRays,
        partially: bool,
        map: &mut IndexMap,
    ) -> Option<PixelRects> {
        if !partially {
            let surface = (&mut *self.normals, &mut *self.levels);
            self.sampler.sample_completing(grid, surface, rays, map);
            return None;
        }
        let rects = changed_levels(grid, self.changed, rays);
        for rect in rects.as_slice() {
            self.sample_rect(grid, *rect, map, &mut || true);
        }
        Some(rects)
    }
}

/// Returns the pixels that see levels of `changed` bricks.
pub(super) fn changed_levels(grid: &Grid, changed: &[u32], rays: &PixelRays) -> PixelRects {
    changed_pixels(grid, changed, rays, LEVEL_REACH_VX)
}
