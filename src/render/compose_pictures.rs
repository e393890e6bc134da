//! Composition of a renderer's pictures back to front: background, sculpture, overlay.

use glam::UVec2;

use super::frame_cache::{FrameCache, pixels_to_compose};
use super::overlay::Scene;
use super::pictures::pictures;
use super::smooth_edges::{REACH_PX, SmoothEdges};
use super::times::PictureTimer;
use super::{
    Backdrop, Background, Colours, Composite, CompositeEye, FrameDesc, GpuOnly, IndexTarget,
    MAX_EYES, Points, Renderer, Shading, Surface, Volume,
};
use crate::document::Document;
use crate::gpu::{Recorder, Result};
use crate::surface::{PixelRect, PixelRects};

impl Renderer {
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
        self.prepare_ground(recorder, slot, document, desc)?;
        let estimates = !self.is_complete();
        let shading = self.shading(desc.mode);
        let pictures = pictures(&self.device, &mut self.pictures, self.format, desc.eyes)?;
        let visible = self.sampler.visible();
        let mut sculpture = match shading {
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
        let mut edges = match (desc.smooth_edges, &mut self.smooth_edges) {
            (false, _) => None,
            (true, Some(pass)) => Some(pass),
            (true, none) => Some(none.insert(SmoothEdges::new(&self.device, self.format)?)),
        };
        if let Some(edges) = &mut edges {
            edges.begin(slot, pictures)?;
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
            let mut areas = sculpture.areas(&rects);
            if edges.is_some() {
                areas = with_edges(&areas, PixelRect::of_picture(eye.size));
            }
            for scissor in areas.as_slice() {
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
                match &mut edges {
                    Some(edges) => {
                        edges.begin_sculpture(recorder, pictures, i, background, *scissor)
                    }
                    None => pictures.begin(recorder, i, background, *scissor),
                }
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
                if let Some(ground) = &self.ground {
                    ground.draw(recorder, document, desc, eye, &map.rays);
                }
                if let Some(edges) = &mut edges {
                    let (projection, placed) = (&eye.projection, &desc.world_from_grid);
                    edges.finish(recorder, pictures, i, *scissor, projection, placed);
                    recorder.set_scissor(view.pixels_of(*scissor));
                }
                self.overlay.draw(recorder, &scene)?;
                recorder.end_rendering();
            }
        }
        self.timer.stop(recorder, PictureTimer::COMPOSE);
        Ok(())
    }
}

/// The rectangles of a `picture` whose colours depend on those of `areas` once edges are smooth.
fn with_edges(areas: &PixelRects, picture: PixelRect) -> PixelRects {
    let mut grown = PixelRects::NONE;
    for area in areas.as_slice().iter().filter(|area| !area.is_empty()) {
        grown.add(area.grown(REACH_PX).intersect(picture));
    }
    grown.without_overlap()
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
