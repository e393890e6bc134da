//! Composition of a renderer's pictures back to front: background, sculpture, overlay. On a device that is this
//! processor, background and sculpture are computed and copied where they can be ([`super::software_composite`]).

use glam::UVec2;

use super::frame_cache::{FrameCache, pixels_to_compose};
use super::overlay_scene::Scene;
use super::pictures::pictures;
use super::smooth_edges::{REACH_PX, SmoothEdges};
use super::software_composite::{SoftwareComposite, layout_of};
use super::times::PictureTimer;
use super::{
    Backdrop, Background, Colours, Composite, CompositeEye, FrameDesc, GpuOnly, GroundPass,
    IndexTarget, MAX_EYES, Points, Renderer, Shading, Surface, Volume,
};
use crate::document::Document;
use crate::gpu::{Recorder, Result};
use crate::shade::composed::Composition;
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
        let can_be_composed = self.device.is_software()
            && desc.video.is_none()
            && !desc.smooth_edges
            && self.maps.iter().all(|map| map.is_known());
        let composed = layout_of(self.format).filter(|_| can_be_composed);
        let mut sculpture = match shading {
            Shading::Software if let Some((is_bgra, is_linear)) = composed => {
                let pass = match &mut self.software_composite {
                    Some(pass) => pass,
                    none => none.insert(SoftwareComposite::new(&self.device)?),
                };
                pass.begin(slot);
                Sculpture::Composed(pass, is_bgra, is_linear)
            }
            Shading::Software | Shading::Device => {
                if shading == Shading::Software {
                    for (i, pixels) in (0..).zip(&self.pixels[..self.maps.len()]) {
                        let visible = visible[i as usize];
                        self.composite.upload_shaded(recorder, i, pixels, visible)?;
                    }
                }
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
                if let Sculpture::Composed(pass, is_bgra, is_linear) = &mut sculpture {
                    let composition = Composition {
                        map,
                        pixels: &self.pixels[i as usize],
                        dims: view.dims,
                        projection: view.projection,
                        background: match background {
                            Background::Keep => None,
                            Background::Gradient { top, bottom } => Some([top, bottom]),
                        },
                        is_linear: *is_linear,
                        is_bgra: *is_bgra,
                        visible: view.visible,
                    };
                    pass.compose(recorder, pictures, i, &composition, *scissor)?;
                    if desc.ground.is_some() || self.overlay.draws(&scene) {
                        pictures.begin_over(recorder, i, *scissor);
                        if let Some(ground) = &self.ground {
                            ground.draw(recorder, document, desc, eye, &map.rays);
                        }
                        self.overlay.draw(recorder, &scene)?;
                        recorder.end_rendering();
                    }
                    continue;
                }
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
                    Sculpture::Composed(..) => {}
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

    /// Makes the ground of `desc` ready to be drawn, if it has one. Before rendering begins.
    fn prepare_ground(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        desc: &FrameDesc,
    ) -> Result<()> {
        if desc.ground.is_none() {
            return Ok(());
        }
        let pass = match &mut self.ground {
            Some(pass) => pass,
            none => none.insert(GroundPass::new(&self.device, self.format)?),
        };
        pass.update(recorder, slot, document, desc)
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
    /// With the order of channels, and whether the device encodes them.
    Composed(&'a mut SoftwareComposite, bool, bool),
    Composite(&'a mut Composite, &'a IndexTarget),
    Points(&'a mut Points),
    Within(&'a mut GpuOnly, &'a Volume, Option<&'a Colours>),
}

impl Sculpture<'_> {
    /// The rectangles to draw one by one so that `rects` are drawn.
    fn areas(&self, rects: &PixelRects) -> PixelRects {
        match self {
            Sculpture::Composed(..) | Sculpture::Composite(..) => *rects,
            // Each draw writes uniforms.
            Sculpture::Points(_) | Sculpture::Within(..) => PixelRects::of(rects.bounds()),
        }
    }
}
