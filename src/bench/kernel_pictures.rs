//! Pictures without a Vulkan device: the ray casters and the software shader alone, up to the
//! shaded picture.

use std::time::Instant;

use glam::Affine3A;

use super::measured::{AfterEdit, BenchScene, StageTimes};
use crate::document::Document;
use crate::render::RenderMode;
use crate::sculpture::Grid;
use crate::sculpture::history::Contents;
use crate::shade::{self, Lighting, NormalField, Pixels, ShadePose, ShadeSource};
use crate::surface::{IndexMap, PixelRect, PixelRects, changed_pixels, quickstep, raycast};
use crate::view::{Eye, PixelRays};

/// Pictures of one document in one mode.
pub struct KernelPictures {
    caster: Caster,
    lighting: Lighting,
    views: Vec<View>,
    normals: NormalField,
    /// Kept for its allocation.
    reshaded: Vec<u32>,
}

/// The view of an eye.
struct View {
    eye: Eye,
    map: IndexMap,
    pixels: Pixels,
}

/// The kernels of a mode.
#[derive(Clone, Copy)]
struct Caster {
    whole: fn(&Grid, &PixelRays, &mut IndexMap),
    rect: fn(&Grid, &mut IndexMap, PixelRect),
}

impl Caster {
    fn of(mode: RenderMode) -> Option<Caster> {
        match mode {
            RenderMode::Ray => Some(Caster { whole: raycast::sample, rect: raycast::sample_rect }),
            RenderMode::Quickstep => {
                Some(Caster { whole: quickstep::sample, rect: quickstep::sample_rect })
            }
            _ => None,
        }
    }
}

impl KernelPictures {
    /// Creates one; `None` if the mode needs a device.
    pub fn new(scene: &BenchScene, document: &mut Document) -> Option<KernelPictures> {
        let BenchScene { mode, eyes, lighting } = *scene;
        let world_from_grid = document.world_from_grid();
        let view = |eye: &Eye| {
            let rays = eye.pixel_rays(&world_from_grid);
            View { eye: *eye, map: IndexMap::new(rays), pixels: Pixels::new(rays.size) }
        };
        let views = eyes.iter().map(view).collect();
        let mut pictures = KernelPictures {
            caster: Caster::of(mode)?,
            lighting,
            views,
            normals: NormalField::default(),
            reshaded: Vec::new(),
        };
        pictures.whole(document);
        Some(pictures)
    }

    /// Renders whole pictures.
    pub fn whole(&mut self, document: &mut Document) -> StageTimes {
        let normals = &mut self.normals;
        document.drain_changes(|contents, changed| {
            normals.follow(&contents.grid, changed);
            normals.update(&contents.grid, &mut Vec::new(), || true);
        });
        let start = Instant::now();
        for View { map, .. } in &mut self.views {
            let rays = map.rays;
            (self.caster.whole)(document.grid(), &rays, map);
        }
        let sample = start.elapsed();
        let start = Instant::now();
        let world_from_grid = document.world_from_grid();
        for view in &mut self.views {
            let whole = PixelRect::of_picture(view.map.rays.size);
            view.shade(document.contents(), &self.normals, &world_from_grid, &self.lighting, whole);
        }
        StageTimes { sample, shade: start.elapsed(), ..StageTimes::default() }
    }

    /// Samples and shades only the pixels that an edit may have changed.
    pub fn after_edit(&mut self, document: &mut Document) -> AfterEdit {
        let start = Instant::now();
        let world_from_grid = document.world_from_grid();
        let KernelPictures { caster, lighting, views, normals, reshaded } = self;
        document.drain_changes(|contents, changed| {
            let grid = &contents.grid;
            reshaded.clear();
            normals.follow(grid, changed);
            normals.update(grid, reshaded, || true);
            reshaded.extend_from_slice(changed.unwrap_or_default());
            reshaded.sort_unstable();
            reshaded.dedup();
            for view in views {
                let rays = view.map.rays;
                let whole = PixelRects::of(PixelRect::of_picture(rays.size));
                let pixels_of = |bricks: &[u32]| match changed {
                    Some(_) => changed_pixels(grid, bricks, &rays, 0),
                    None => whole,
                };
                for &rect in pixels_of(changed.unwrap_or_default()).as_slice() {
                    (caster.rect)(grid, &mut view.map, rect);
                }
                for &rect in pixels_of(reshaded).as_slice() {
                    view.shade(contents, normals, &world_from_grid, lighting, rect);
                }
            }
        });
        AfterEdit { shaded: start.elapsed(), composite: None }
    }
}

impl View {
    fn shade(
        &mut self,
        contents: &Contents,
        normals: &NormalField,
        world_from_grid: &Affine3A,
        lighting: &Lighting,
        rect: PixelRect,
    ) {
        let world_from_grid = *world_from_grid;
        let pose = ShadePose { eye_from_world: self.eye.eye_from_world, world_from_grid };
        let Contents { grid, material, .. } = contents;
        let source = ShadeSource { grid, material, normals, mask: None };
        shade::shade_rect(&self.map, &source, &pose, lighting, rect, &mut self.pixels);
    }
}
