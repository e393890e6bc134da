//! The pictures of a renderer in memory: index maps, and their shading by the CPU, as pixels or as points.
//!
//! Takes a frame description and the normals; shades all of the maps, or what has changed. Knows no device.

use std::sync::Arc;

use super::frame_cache::Redraw;
use super::normal_stage::NormalStage;
use super::{FrameDesc, MAX_EYES};
use crate::document::Document;
use crate::shade::points::PointCloud;
use crate::shade::{Pixels, SoftwareShader, shade_rect};
use crate::surface::{IndexMap, PixelRect, changed_pixels};
use crate::view::PixelRays;

/// See the module text.
#[derive(Default)]
pub(super) struct CpuPictures {
    /// One per eye. Shared with picking.
    pub maps: Vec<Arc<IndexMap>>,
    pub pixels: Vec<Pixels>,
    pub clouds: [PointCloud; MAX_EYES],
    shader: SoftwareShader,
}

impl CpuPictures {
    /// Keeps a map for each of so many eyes; new ones show nothing.
    pub fn resize_maps(&mut self, eyes: usize) {
        self.maps.resize_with(eyes, || Arc::new(IndexMap::new(PixelRays::of_nothing())));
    }

    /// Shades the maps. Calls `note` with each eye and the pixels that were shaded, if not all.
    pub fn shade(
        &mut self,
        document: &Document,
        desc: &FrameDesc,
        normals: &NormalStage,
        redraw: Redraw,
        mut note: impl FnMut(u32, Option<PixelRect>),
    ) {
        self.pixels.resize_with(self.maps.len(), Pixels::default);
        let source = desc.source(document, normals.field());
        let lighting = &desc.lighting;
        for (i, (map, pixels)) in self.maps.iter().zip(&mut self.pixels).enumerate() {
            let pose = desc.pose(&desc.eyes[i]);
            let shaded = match redraw {
                Redraw::All => {
                    self.shader.shade(map, &source, &pose, lighting, pixels);
                    None
                }
                Redraw::Changed => {
                    let reach_vx = desc.reach_vx();
                    let rects =
                        changed_pixels(source.grid, normals.reshaded(), &map.rays, reach_vx);
                    for rect in rects.as_slice() {
                        shade_rect(map, &source, &pose, lighting, *rect, pixels);
                    }
                    Some(rects.bounds())
                }
            };
            note(i as u32, shaded);
        }
    }

    /// Lists the lit points of the maps.
    pub fn take_points(&mut self, document: &Document, desc: &FrameDesc, normals: &NormalStage) {
        let source = desc.source(document, normals.field());
        for ((map, cloud), eye) in self.maps.iter().zip(&mut self.clouds).zip(desc.eyes) {
            cloud.take(map, &source, &desc.pose(eye), &desc.lighting);
        }
    }

    /// Exchanges the pictures for others. Both are shaded in the same working memory.
    pub fn swap(&mut self, other: &mut CpuPictures) {
        std::mem::swap(&mut self.maps, &mut other.maps);
        std::mem::swap(&mut self.pixels, &mut other.pixels);
        std::mem::swap(&mut self.clouds, &mut other.clouds);
    }
}
