//! From a sculpture to its pictures: sample, shade, compose with background and overlay. One
//! renderer serves a window, a file or a headset; they differ in how they use the images.
//!
//! Takes a document and a [`FrameDesc`]; draws the pictures, one layer per eye, to images of its
//! own, and repeats only what the desc changes. So an interface that changes over a resting
//! sculpture costs a copy only. Knows no window, no camera and no tools: what to draw comes in as
//! values.

use std::sync::Arc;
use std::time::{Duration, Instant};

use ash::vk;
use glam::UVec2;

use super::Shading;
use super::frame_cache::{FrameCache, Redraw, RedrawPlan, pixels_to_compose};
pub use super::frame_desc::FrameDesc;
use super::level_stage::LevelStage;
use super::normal_stage::NormalStage;
use super::overlay::{Overlay, Scene};
use super::pictures::pictures;
pub use super::pictures::{DEPTH_FORMAT, Pictures};
use super::pixel_pass::PixelStage;
use super::refine::Refinement;
use super::sampler::Sampler;
use super::times::PictureTimer;
pub use super::times::{DeviceTimes, RenderTimes};
use super::{
    Backdrop, Background, Colours, Composite, CompositeEye, EyeTask, GpuOnly, IndexTarget,
    MAX_EYES, Points, SmoothSurface, Surface, SurfaceShade, Volume,
};
use crate::document::{ChangeSubscriber, Document};
use crate::gpu::{Device, Recorder, Result, Use, read_image_once};
use crate::shade::points::PointCloud;
use crate::shade::{Pixels, ShadeSource, SoftwareShader, shade_rect};
use crate::surface::{IndexMap, PixelRect, PixelRects, changed_pixels};
use crate::view::PixelRays;

/// Renders one document.
pub struct Renderer {
    pub(super) sampler: Sampler,
    pub(super) composite: Composite,
    pub(super) overlay: Overlay,
    pub(super) pictures: Option<Pictures>,
    pub(super) format: vk::Format,
    /// One per eye. Shared with picking.
    pub(super) maps: Vec<Arc<IndexMap>>,
    pub(super) pixels: Vec<Pixels>,
    software: SoftwareShader,
    pub(super) clouds: [PointCloud; MAX_EYES],
    /// The passes of some modes, made when first needed.
    points: Option<Points>,
    surface_shade: Option<SurfaceShade>,
    gpu_only: Option<GpuOnly>,
    backdrop: Option<Backdrop>,
    /// Drains the bricks that change between two pictures.
    subscriber: ChangeSubscriber,
    /// The bricks that changed since the last picture.
    changed: Vec<u32>,
    pub(super) normals: NormalStage,
    pub(super) levels: LevelStage,
    /// What the pictures were made of; none while they are incomplete.
    pub(super) cache: Option<FrameCache>,
    pub(super) refinement: Refinement,
    pub(super) times: RenderTimes,
    pub(super) timer: PictureTimer,
    pub(super) device: Arc<Device>,
}

impl Renderer {
    /// For pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Renderer> {
        Ok(Renderer {
            sampler: Sampler::new(device)?,
            composite: Composite::new(device, format, MAX_EYES as u32)?,
            overlay: Overlay::new(device, format, DEPTH_FORMAT)?,
            pictures: None,
            format,
            maps: Vec::new(),
            pixels: Vec::new(),
            software: SoftwareShader::default(),
            clouds: Default::default(),
            points: None,
            surface_shade: None,
            gpu_only: None,
            backdrop: None,
            subscriber: ChangeSubscriber::default(),
            changed: Vec::new(),
            normals: NormalStage::default(),
            levels: LevelStage::default(),
            cache: None,
            refinement: Refinement::default(),
            times: RenderTimes::default(),
            timer: PictureTimer::new(device)?,
            device: device.clone(),
        })
    }

    /// Records the pictures of `desc`; afterwards they are in [`Renderer::pictures`]. `slot`:
    /// [`crate::gpu::Frames::slot`]; once per frame.
    ///
    /// A sculpture that is too large for the device is an error of [`crate::gpu::GpuError::Limit`]:
    /// try again with the [`RenderMode::fallback`] of its mode.
    pub fn paint(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> Result<()> {
        let painted = self.try_paint(recorder, slot, document, desc);
        if painted.is_err() {
            // A second attempt follows the commands of the failed one, which may have stopped
            // within rendering.
            recorder.end_rendering_if_begun();
        }
        painted
    }

    fn try_paint(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> Result<()> {
        // Only complete pictures are kept in the frame cache.
        let before = self.cache.take();
        let changes_known = self.drain_changes(document);
        let changed = changes_known.then_some(self.changed.as_slice());
        let normals = self.normals.update(document.grid(), changed);
        let known = changes_known.then_some(self.normals.reshaded());
        let smooth = desc.is_smooth(SmoothSurface::Always, document.grid());
        self.levels.update(document.grid(), self.normals.field(), known, smooth);
        self.normals.reshade(self.levels.changed());
        let smooth = self.levels.state();
        let plan = RedrawPlan::new(before.as_ref(), document, desc, changes_known, normals, smooth);
        if let Some(redraw) = plan.sample {
            self.sample(document, desc, redraw)?;
        }
        self.composite.begin(slot);
        if plan.compose.is_some() {
            self.timer.begin(recorder, slot, desc.mode, &mut self.times.device)?;
        }
        if let Some(redraw) = plan.shade {
            self.shade(recorder, slot, document, desc, redraw)?;
        }
        if let Some(redraw) = plan.compose {
            let before = before.as_ref().filter(|_| redraw == Redraw::Changed);
            self.compose(recorder, slot, document, desc, before)?;
        }
        let rests = plan.is_nothing() && self.is_complete();
        self.refine_if(rests, recorder, slot, document, desc)?;
        self.cache = Some(FrameCache::new(before, document, desc, smooth.is_some()));
        let pictures = pictures(&self.device, &mut self.pictures, self.format, desc.eyes)?;
        for eye in 0..pictures.colour.eyes() {
            pictures.colour.transition(recorder, eye, Use::COPY_SOURCE);
        }
        Ok(())
    }

    /// The pictures painted last.
    pub fn pictures(&mut self) -> Option<&mut Pictures> {
        self.refinement.pictures_mut().or(self.pictures.as_mut())
    }

    /// The pixels of the pictures painted last, once the recording has been submitted. Waits.
    pub fn read_back(&self) -> Result<Vec<Pixels>> {
        let pictures = self.refinement.pictures().or(self.pictures.as_ref());
        let Some(pictures) = pictures else { return Ok(Vec::new()) };
        let (image, size) = (pictures.colour.image(), pictures.colour.size());
        let read = |eye| {
            let part = image.layer(eye);
            let bytes = read_image_once(&self.device, part, image.size(), 4, Use::COPY_SOURCE)?;
            Ok(Pixels { size, rgba: bytemuck::pod_collect_to_vec(&bytes) })
        };
        (0..pictures.colour.eyes()).map(read).collect()
    }

    /// The index maps of the pictures painted last.
    pub fn maps(&self) -> &[Arc<IndexMap>] {
        &self.maps
    }

    /// Those of the device are of the last picture that it is known to have finished.
    pub fn times(&self) -> RenderTimes {
        self.times
    }

    /// All times of the picture painted last, for a caller that has waited for it.
    pub fn times_when_done(&mut self) -> Result<RenderTimes> {
        if let Some(mode) = self.cache.as_ref().map(FrameCache::mode) {
            self.times.device.sample_ms = self.sampler.device_ms_when_done(mode)?;
            self.timer.latest(mode, &mut self.times.device)?;
        }
        Ok(self.times)
    }

    /// Discards the cached picture and the device's copy of the document; keeps all passes.
    pub(super) fn forget_pictures(&mut self) -> Result<()> {
        self.cache = None;
        self.refinement.forget();
        self.sampler.forget_copy();
        self.times = RenderTimes::default();
        self.timer = PictureTimer::new(&self.device)?;
        Ok(())
    }

    pub(super) fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Collects the bricks that have changed since the last picture; false if all may have.
    fn drain_changes(&mut self, document: &mut Document) -> bool {
        let changed = &mut self.changed;
        document.drain_changes_for(&self.subscriber, |_, bricks| {
            changed.clear();
            changed.extend_from_slice(bricks.unwrap_or_default());
            bricks.is_some()
        })
    }

    /// How long a picture may be held up by the normals of a sculpture that was opened: until they are complete
    /// ([`Renderer::is_complete`]), estimates stand in for them. None: until all are there.
    pub fn set_patience(&mut self, patience: Option<Duration>) {
        self.normals.patience = patience;
    }

    pub(super) fn patience(&self) -> Option<Duration> {
        self.normals.patience
    }

    /// Whether the last pictures have all normals. If not, the next ones have more.
    pub fn is_complete(&self) -> bool {
        self.normals.field().is_complete()
    }

    pub(super) fn sample(
        &mut self,
        document: &mut Document,
        desc: &FrameDesc,
        redraw: Redraw,
    ) -> Result<()> {
        let start = Instant::now();
        let mut rays = [None; MAX_EYES];
        for (rays, eye) in rays.iter_mut().zip(desc.eyes) {
            *rays = Some(eye.pixel_rays(&desc.world_from_grid));
        }
        let count = desc.eyes.len().min(MAX_EYES);
        let nothing = PixelRays::of_nothing();
        let rays = rays.map(|rays| rays.unwrap_or(nothing));
        self.maps.resize_with(count, || Arc::new(IndexMap::new(nothing)));
        let result = {
            let changed = (redraw == Redraw::Changed).then_some(self.changed.as_slice());
            let smooth = self.levels.surface(self.normals.field());
            let rays = &rays[..count];
            self.sampler.sample(document, rays, desc.mode, smooth, changed, &mut self.maps)
        };
        if result.is_err() {
            self.sampler.forget_copy();
        }
        self.times.sample_ms = ms_since(start);
        self.times.read_back_ms = self.sampler.read_back_ms();
        self.times.device.sample_ms = self.sampler.device_ms();
        result
    }

    pub(super) fn shade(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        desc: &FrameDesc,
        redraw: Redraw,
    ) -> Result<()> {
        let start = Instant::now();
        self.normals.upload(&self.device, recorder, slot, desc.mode.shading())?;
        match desc.mode.shading() {
            Shading::Software => self.shade_in_software(recorder, document, desc, redraw)?,
            Shading::Points => {
                let (grid, material) = (document.grid(), document.material());
                let source = ShadeSource { grid, material, normals: self.normals.field() };
                for ((map, cloud), eye) in self.maps.iter().zip(&mut self.clouds).zip(desc.eyes) {
                    cloud.take(map, &source, &desc.pose(eye), &desc.lighting);
                }
            }
            Shading::Device => self.shade_on_device(recorder, slot, document, desc, redraw)?,
            Shading::Within => {}
        }
        // The normals of what is shaded are part of it.
        self.times.shade_ms = ms_since(start) + self.normals.took.as_secs_f32() * 1e3;
        Ok(())
    }

    fn shade_in_software(
        &mut self,
        recorder: &mut Recorder,
        document: &Document,
        desc: &FrameDesc,
        redraw: Redraw,
    ) -> Result<()> {
        self.pixels.resize_with(self.maps.len(), Pixels::default);
        let (grid, material) = (document.grid(), document.material());
        let source = ShadeSource { grid, material, normals: self.normals.field() };
        let lighting = &desc.lighting;
        let visible = self.sampler.visible();
        for (i, (map, pixels)) in self.maps.iter().zip(&mut self.pixels).enumerate() {
            let pose = desc.pose(&desc.eyes[i]);
            let shaded = match redraw {
                Redraw::All => {
                    self.software.shade(map, &source, &pose, lighting, pixels);
                    None
                }
                Redraw::Changed => {
                    let reach_vx = desc.reach_vx();
                    let rects = changed_pixels(grid, self.normals.reshaded(), &map.rays, reach_vx);
                    for rect in rects.as_slice() {
                        shade_rect(map, &source, &pose, lighting, *rect, pixels);
                    }
                    Some(rects.bounds())
                }
            };
            self.composite.upload(recorder, i as u32, pixels, visible[i], shaded)?;
        }
        Ok(())
    }

    fn shade_on_device(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        desc: &FrameDesc,
        redraw: Redraw,
    ) -> Result<()> {
        let visible = self.sampler.visible();
        let estimates = !self.is_complete();
        let Some((maps, volume, colours)) = self.sampler.on_device() else { return Ok(()) };
        let pass = match &mut self.surface_shade {
            Some(pass) => pass,
            none => {
                let stage = PixelStage::of(&self.device);
                none.insert(SurfaceShade::new(&self.device, stage, MAX_EYES as u32)?)
            }
        };
        pass.begin(slot);
        let pictures = self.composite.pictures(maps.size())?;
        self.timer.start(recorder, PictureTimer::SHADE);
        for ((i, eye), map) in (0..).zip(desc.eyes).zip(&self.maps) {
            let mut task = EyeTask { visible: visible[i as usize], ..EyeTask::whole(i, map.rays) };
            if redraw == Redraw::Changed {
                let (grid, rays) = (document.grid(), &map.rays);
                task.scissor =
                    changed_pixels(grid, self.normals.reshaded(), rays, desc.reach_vx()).bounds();
            }
            if !task.scissor.is_empty() {
                let normals = self.normals.copy();
                let surface =
                    Surface { colours, normals, ..desc.surface(document, estimates, eye) };
                pass.record(recorder, volume, &surface, maps, pictures, &task)?;
            }
        }
        self.timer.stop(recorder, PictureTimer::SHADE);
        Ok(())
    }

    /// Composes the pictures back to front: only what differs from those of `before`, if they are
    /// known.
    pub(super) fn compose(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        desc: &FrameDesc,
        before: Option<&FrameCache>,
    ) -> Result<()> {
        let estimates = !self.is_complete();
        let pictures = pictures(&self.device, &mut self.pictures, self.format, desc.eyes)?;
        let visible = self.sampler.visible();
        let mut sculpture = match desc.mode.shading() {
            Shading::Software | Shading::Device => {
                let maps = self.sampler.maps(recorder, slot, &self.maps)?;
                Sculpture::Composite(&mut self.composite, maps)
            }
            Shading::Points => {
                let pass = match &mut self.points {
                    Some(pass) => pass,
                    none => none.insert(Points::new(&self.device, self.format, MAX_EYES as u32)?),
                };
                pass.begin(slot);
                for (eye, cloud) in (0..).zip(&self.clouds[..self.maps.len()]) {
                    pass.upload(eye, cloud)?;
                }
                Sculpture::Points(pass)
            }
            Shading::Within => {
                let pass = match &mut self.gpu_only {
                    Some(pass) => pass,
                    none => none.insert(GpuOnly::new(&self.device, self.format, MAX_EYES as u32)?),
                };
                pass.begin(slot);
                let Some((volume, colours)) = self.sampler.copy() else { return Ok(()) };
                Sculpture::Within(pass, volume, colours)
            }
        };
        if let Some(video) = &desc.video {
            let pass = match &mut self.backdrop {
                Some(pass) => pass,
                none => none.insert(Backdrop::new(&self.device, self.format)?),
            };
            pass.begin(slot);
            pass.bring(recorder, video.frame)?;
        }
        self.overlay.begin(slot);
        self.timer.start(recorder, PictureTimer::COMPOSE);
        for ((i, eye), map) in (0..).zip(desc.eyes).zip(&self.maps) {
            let background = if desc.video.is_some() { Background::Keep } else { desc.background };
            let rects = match before {
                Some(before) => pixels_to_compose(
                    before,
                    document,
                    self.normals.reshaded(),
                    desc,
                    eye,
                    &map.rays,
                ),
                None => PixelRects::of(PixelRect::of_picture(eye.size)),
            };
            if let Sculpture::Within(pass, volume, _) = &mut sculpture {
                pass.prepare(recorder, volume, &map.rays, i)?;
            }
            let surface = desc.surface(document, estimates, eye);
            let scene = Scene {
                eye_from_grid: eye.eye_from_world * desc.world_from_grid,
                projection: eye.projection,
                size: eye.size.to_array(),
                previews: desc.previews,
                lines: desc.lines,
            };
            for scissor in sculpture.areas(&rects).as_slice() {
                let view = CompositeEye {
                    rays: map.rays,
                    projection: eye.projection,
                    dims: document.grid().dims(),
                    corner: UVec2::ZERO,
                    size: eye.size,
                    background,
                    scissor: *scissor,
                    visible: visible[i as usize],
                };
                pictures.begin(recorder, i, background, *scissor);
                if let (Some(video), Some(pass)) = (&desc.video, &mut self.backdrop) {
                    pass.draw(recorder, eye.size, &video.view);
                }
                match &mut sculpture {
                    Sculpture::Composite(pass, maps) => pass.draw(recorder, maps, i, &view),
                    Sculpture::Points(pass) => pass.draw(recorder, &surface, i, &view)?,
                    Sculpture::Within(pass, volume, colours) => {
                        let normals = self.normals.copy();
                        let surface = Surface { colours: *colours, normals, ..surface };
                        pass.draw(recorder, volume, &surface, i, &view)?;
                    }
                }
                recorder.set_scissor(view.pixels_of(*scissor));
                self.overlay.draw(recorder, &scene)?;
                recorder.end_rendering();
            }
        }
        self.timer.stop(recorder, PictureTimer::COMPOSE);
        Ok(())
    }
}

/// The pass that draws the sculpture, and its inputs.
enum Sculpture<'a> {
    Composite(&'a mut Composite, &'a IndexTarget),
    Points(&'a mut Points),
    Within(&'a mut GpuOnly, &'a Volume, Option<&'a Colours>),
}

impl Sculpture<'_> {
    /// The rectangles to draw one by one so that `rects` are drawn.
    fn areas(&self, rects: &PixelRects) -> PixelRects {
        match self {
            Sculpture::Composite(..) => *rects,
            // Each draw writes uniforms.
            Sculpture::Points(_) | Sculpture::Within(..) => PixelRects::of(rects.bounds()),
        }
    }
}

fn ms_since(start: Instant) -> f32 {
    start.elapsed().as_secs_f32() * 1e3
}
