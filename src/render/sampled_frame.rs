//! A sampled frame for the passes that shade and draw it: eye by eye, with the pixels to repeat.
//!
//! Values alone; knows no pass and no device.

use glam::{UVec2, UVec3};

use super::cpu_pictures::CpuPictures;
use super::frame_cache::{FrameCache, pixels_to_compose};
use super::normal_stage::NormalStage;
use super::overlay_scene::OverlayDrawing;
use super::{Background, CompositeEye, FrameDesc, LitSurface, MAX_EYES, Shading};
use crate::document::Document;
use crate::surface::{IndexMap, PixelRect, PixelRects, is_linear};
use crate::view::Eye;

/// See the module text.
#[derive(Clone, Copy)]
pub(super) struct SampledFrame<'a> {
    /// [`crate::gpu::Frames::slot`].
    pub slot: usize,
    pub document: &'a Document,
    pub desc: &'a FrameDesc<'a>,
    /// The shading of the sculpture.
    pub shading: Shading,
    pub normals: &'a NormalStage,
    pub cpu: &'a CpuPictures,
    /// The visible rect of each eye.
    pub visible: [PixelRect; MAX_EYES],
    /// The pictures to draw over, if only the differences from them are composed.
    pub before: Option<&'a FrameCache>,
}

/// One eye's part of a frame.
pub(super) struct FrameEye<'a> {
    pub eye: &'a Eye,
    pub map: &'a IndexMap,
    /// The pixels to compose.
    pub rects: PixelRects,
    /// The sculpture in a single colour.
    pub surface: LitSurface<'a>,
    pub scene: OverlayDrawing<'a>,
    /// Its area in the picture, with all pixels.
    pub view: CompositeEye,
}

impl<'a> SampledFrame<'a> {
    /// Returns each eye's part of the frame, one after another.
    pub fn eyes(&self) -> impl Iterator<Item = FrameEye<'a>> {
        let SampledFrame { desc, cpu, .. } = *self;
        let eyes = (0..).zip(desc.eyes).zip(&cpu.maps);
        eyes.map(|((index, eye), map)| self.seen_by(index, eye, map))
    }

    fn seen_by(&self, index: u32, eye: &'a Eye, map: &'a IndexMap) -> FrameEye<'a> {
        let SampledFrame { document, desc, before, .. } = *self;
        let picture = PixelRect::of_picture(eye.size);
        let rects = match before {
            Some(before) => {
                let reshaded = self.normals.reshaded();
                pixels_to_compose(before, document, reshaded, desc, eye, &map.rays)
            }
            None => PixelRects::of(picture),
        };
        let scene = OverlayDrawing {
            eye_from_grid: eye.eye_from_world * desc.world_from_grid,
            projection: eye.projection,
            size: eye.size.to_array(),
            previews: desc.previews,
            lines: desc.lines,
        };
        let view = CompositeEye {
            eye: index,
            rays: map.rays,
            projection: eye.projection,
            dims: if is_linear(document.grid().dims()) {
                document.grid().dims()
            } else {
                UVec3::ZERO
            },
            corner: UVec2::ZERO,
            size: eye.size,
            background: if desc.video.is_some() { Background::Keep } else { desc.background },
            scissor: picture,
            visible: self.visible[index as usize],
        };
        FrameEye { eye, map, rects, surface: self.surface(eye), scene, view }
    }

    /// Returns the surface of the sculpture in a single colour.
    pub fn surface(&self, eye: &Eye) -> LitSurface<'a> {
        let estimates = !self.normals.field().is_complete();
        self.desc.surface(self.document, estimates, eye)
    }
}
