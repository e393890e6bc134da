//! The layers of a picture around the sculpture: video behind it, the ground below it, edges smoothed, and tools, lines
//! and reference pictures over it; and the target pictures of all of them.
//!
//! Takes a [`SampledFrame`]. Does not know how the sculpture is drawn: the caller passes a function for it.

use std::sync::Arc;

use ash::vk;

use super::overlay::Overlay;
use super::pictures::{DEPTH_FORMAT, FinishedPictures, pictures};
use super::reference::{MAX_REFERENCES, ReferencePicture, References};
use super::sampled_frame::{FrameEye, SampledFrame};
use super::smooth_edges::{REACH_PX, SmoothEdges};
use super::{Backdrop, CompositeEye, FrameDesc, GroundPass};
use crate::document::Document;
use crate::gpu::{Device, Recorder, Result};
use crate::surface::{PixelRect, PixelRects};
use crate::view::Eye;

/// See the module text.
pub(super) struct Layers {
    pub pictures: Option<FinishedPictures>,
    overlay: Overlay,
    /// Made when first needed.
    backdrop: Option<Backdrop>,
    ground: Option<GroundPass>,
    smooth_edges: Option<SmoothEdges>,
    format: vk::Format,
    device: Arc<Device>,
}

impl Layers {
    /// Creates one for pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Layers> {
        Ok(Layers {
            pictures: None,
            overlay: Overlay::new(device, format, DEPTH_FORMAT)?,
            backdrop: None,
            ground: None,
            smooth_edges: None,
            format,
            device: device.clone(),
        })
    }

    /// Returns the format of the pictures.
    pub fn format(&self) -> vk::Format {
        self.format
    }

    /// Returns the pictures, resized for `eyes`.
    pub fn fit_pictures(&mut self, eyes: &[Eye]) -> Result<&mut FinishedPictures> {
        pictures(&self.device, &mut self.pictures, self.format, eyes)
    }

    /// Returns whether these reference pictures are set already.
    pub fn shows_references(&self, pictures: &[ReferencePicture]) -> bool {
        let shown = self.overlay.references.as_ref().map_or(&[][..], |known| &known.shown);
        shown == &pictures[..pictures.len().min(MAX_REFERENCES)]
    }

    /// Uploads the new ones of these reference pictures, at most [`MAX_REFERENCES`]. After an error there are none.
    pub fn set_references(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        pictures: &[ReferencePicture],
    ) -> Result<()> {
        let pictures = &pictures[..pictures.len().min(MAX_REFERENCES)];
        let references = match self.overlay.references.take() {
            Some(references) => references,
            None => References::new(&self.device, self.format)?,
        };
        let references = self.overlay.references.insert(references);
        let result = references.bring(recorder, slot, pictures);
        if result.is_err() {
            self.overlay.references = None;
        }
        result
    }

    /// Discards the state that depends on the document.
    pub fn forget_document(&mut self) {
        if let Some(ground) = &mut self.ground {
            ground.forget();
        }
    }

    /// Prepares the ground of `desc`, if it has one. Call before rendering begins.
    pub fn prepare_ground(
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

    /// Starts the pictures of a frame, for which they fit. Call before rendering begins.
    pub fn begin(&mut self, recorder: &mut Recorder, frame: &SampledFrame) -> Result<()> {
        if let Some(video) = &frame.desc.video {
            let pass = match &mut self.backdrop {
                Some(pass) => pass,
                none => none.insert(Backdrop::new(&self.device, self.format)?),
            };
            pass.begin(frame.slot);
            pass.bring(recorder, video.frame)?;
        }
        if let (true, Some(pictures)) = (frame.desc.smooth_edges, &self.pictures) {
            let edges = match &mut self.smooth_edges {
                Some(pass) => pass,
                none => none.insert(SmoothEdges::new(&self.device, self.format)?),
            };
            edges.begin(frame.slot, pictures)?;
        }
        self.overlay.begin(frame.slot);
        Ok(())
    }

    /// Draws `rects` of the picture of an eye, one by one and back to front. `sculpture` draws the sculpture over its
    /// background.
    pub fn draw(
        &mut self,
        recorder: &mut Recorder,
        frame: &SampledFrame,
        eye: &FrameEye,
        rects: &PixelRects,
        mut sculpture: impl FnMut(&mut Recorder, &CompositeEye) -> Result<()>,
    ) -> Result<()> {
        let areas = match frame.desc.smooth_edges {
            true => with_edges(rects, PixelRect::of_picture(eye.eye.size)),
            false => *rects,
        };
        for scissor in areas.as_slice() {
            let view = CompositeEye { scissor: *scissor, ..eye.view };
            self.begin_area(recorder, frame, &view);
            sculpture(recorder, &view)?;
            self.finish_area(recorder, frame, eye, &view)?;
        }
        Ok(())
    }

    /// Starts drawing the pixels of `view`, with the video behind the sculpture.
    fn begin_area(&mut self, recorder: &mut Recorder, frame: &SampledFrame, view: &CompositeEye) {
        let Some(pictures) = &mut self.pictures else { return };
        match self.smooth_edges.as_mut().filter(|_| frame.desc.smooth_edges) {
            Some(edges) => edges.begin_sculpture(recorder, pictures, view),
            None => pictures.begin(recorder, view.eye, view.background, view.scissor),
        }
        if let (Some(video), Some(pass)) = (&frame.desc.video, &mut self.backdrop) {
            pass.draw(recorder, view.size, &video.view);
        }
    }

    /// Draws everything over the sculpture in the pixels of `view`, and ends them.
    fn finish_area(
        &mut self,
        recorder: &mut Recorder,
        frame: &SampledFrame,
        eye: &FrameEye,
        view: &CompositeEye,
    ) -> Result<()> {
        recorder.set_scissor(view.pixels_of(view.scissor));
        self.draw_ground(recorder, frame, eye);
        let edges = self.smooth_edges.as_mut().filter(|_| frame.desc.smooth_edges);
        if let (Some(edges), Some(pictures)) = (edges, &mut self.pictures) {
            edges.finish(recorder, pictures, view, &frame.desc.world_from_grid);
            recorder.set_scissor(view.pixels_of(view.scissor));
        }
        self.overlay.draw(recorder, &eye.scene)?;
        recorder.end_rendering();
        Ok(())
    }

    /// Draws everything over the sculpture, which is in the picture already, in these pixels.
    pub fn draw_over(
        &mut self,
        recorder: &mut Recorder,
        frame: &SampledFrame,
        eye: &FrameEye,
        scissor: PixelRect,
    ) -> Result<()> {
        let is_bare = frame.desc.ground.is_none() && !self.overlay.draws(&eye.scene);
        let Some(pictures) = self.pictures.as_mut().filter(|_| !is_bare) else { return Ok(()) };
        pictures.begin_over(recorder, eye.view.eye, scissor);
        self.draw_ground(recorder, frame, eye);
        self.overlay.draw(recorder, &eye.scene)?;
        recorder.end_rendering();
        Ok(())
    }

    fn draw_ground(&self, recorder: &mut Recorder, frame: &SampledFrame, eye: &FrameEye) {
        if let Some(ground) = &self.ground {
            ground.draw(recorder, frame.document, frame.desc, eye.eye, &eye.map.rays);
        }
    }
}

/// Returns the rectangles of a `picture` whose colours depend on those of `areas` after edge smoothing.
fn with_edges(areas: &PixelRects, picture: PixelRect) -> PixelRects {
    let mut grown = PixelRects::NONE;
    for area in areas.as_slice().iter().filter(|area| !area.is_empty()) {
        grown.add(area.grown(REACH_PX).intersect(picture));
    }
    grown.without_overlap()
}
