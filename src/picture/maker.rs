//! Makes pictures of one document one after another, and keeps reusable state between them: the device with its
//! renderer, and the normals, which follow the document's changes.
//!
//! A picture does not depend on those made before it. Knows no files.

use std::sync::Arc;

use image::RgbImage;

use super::{
    CameraPlacement, PictureError, PictureOptions, PictureView, PlacedEyes, compose_eyes,
    render_by_casting, render_on_device,
};
use crate::document::{ChangeSubscriber, Document};
use crate::gpu::{Device, DeviceOptions, Frames, Headless};
use crate::render::Renderer;
use crate::screen::offscreen;
use crate::sculpture::{Grid, Limits};
use crate::shade::{LevelSampler, LevelSet, NormalField};
use crate::surface::IndexMap;
use crate::view::{PixelRays, StereoLayout};

/// See the module text.
pub struct PictureMaker {
    options: PictureOptions,
    followed: FollowedNormals,
    /// Created for the first picture that needs it.
    painter: Option<PictureDevice>,
}

impl PictureMaker {
    /// Creates one for pictures of one document; another one needs a maker of its own.
    pub fn new(options: &PictureOptions) -> PictureMaker {
        let followed = FollowedNormals::default();
        PictureMaker { options: options.clone(), followed, painter: None }
    }

    /// Renders `document` as seen from `placement`: one picture, or with [`StereoLayout::Layers`] one for each eye. Of
    /// `view` everything counts except the fields that `placement` replaces.
    pub fn make(
        &mut self,
        document: &mut Document,
        view: &PictureView,
        placement: &CameraPlacement,
    ) -> Result<Vec<RgbImage>, PictureError> {
        let PictureMaker { options, followed, painter } = self;
        let eyes = match view.stereo {
            StereoLayout::Mono => vec![placement.eye],
            _ => options
                .stereo
                .rig(placement.distance.max(f32::MIN_POSITIVE))
                .eyes(&placement.eye)
                .to_vec(),
        };
        let seen = PlacedEyes { eyes: &eyes, world_from_grid: placement.world_from_grid };
        let pictures = if view.mode.needs_device() {
            let painter = match painter {
                Some(painter) => painter,
                none => none.insert(PictureDevice::new(&options.device)?),
            };
            render_on_device(document, painter, followed, view, &seen, options)?
        } else {
            render_by_casting(document, followed, view, view.mode, &seen, options)
        };
        Ok(compose_eyes(pictures, view))
    }
}

/// The normals of a document for the software shader, those that its pictures have shown or all, and its smooth surface.
#[derive(Default)]
pub(super) struct FollowedNormals {
    field: NormalField,
    /// `None` until it was needed, and where it is too large.
    levels: Option<LevelSet>,
    is_too_large: bool,
    /// Bricks whose bits have changed since the smooth surface was made.
    changed: Vec<u32>,
    subscriber: ChangeSubscriber,
}

impl FollowedNormals {
    /// Notes what has changed in the document since the last call.
    pub fn follow(&mut self, document: &mut Document) {
        let FollowedNormals { field, levels, is_too_large, changed, subscriber } = self;
        document.drain_changes_for(subscriber, |contents, bricks| {
            field.follow(&contents.grid, bricks);
            *is_too_large &= bricks.is_some();
            changed.extend_from_slice(bricks.unwrap_or_default());
            levels.take_if(|levels| bricks.is_none() || !levels.fits(&contents.grid));
        });
        if self.levels.is_none() {
            self.changed.clear();
        }
    }

    /// Prepares the smooth surface. A sculpture that is too large for it has none.
    pub fn prepare_surface(&mut self, grid: &Grid, limits: &Limits) {
        let FollowedNormals { levels, is_too_large, changed, .. } = self;
        match levels {
            Some(levels) => levels.follow_edits(grid, changed),
            None if *is_too_large => {}
            None => {
                let made = LevelSet::new(grid, limits.grid_bytes);
                *is_too_large = made.is_err();
                *levels = made
                    .inspect_err(|reason| tracing::warn!("{reason}; pictures show voxels instead"))
                    .ok();
            }
        }
        changed.clear();
    }

    /// Samples the smooth surface, of which it computes what the picture shows. Returns false if there is none.
    pub fn sample_surface(
        &mut self,
        grid: &Grid,
        sampler: &mut LevelSampler,
        rays: &PixelRays,
        map: &mut IndexMap,
    ) -> bool {
        let FollowedNormals { field, levels, .. } = self;
        let Some(levels) = levels else { return false };
        sampler.sample_completing(grid, (field, levels), rays, map);
        true
    }

    /// Completes the normals of the voxels in an index map.
    pub fn complete_seen(&mut self, grid: &Grid, map: &IndexMap) {
        self.field.complete_seen(grid, [map], &mut Vec::new(), || true);
    }

    /// Returns the normals computed so far.
    pub fn field(&self) -> &NormalField {
        &self.field
    }
}

/// A device with its renderer.
pub(super) struct PictureDevice {
    pub frames: Frames,
    pub renderer: Renderer,
    pub device: Arc<Device>,
    /// Whether fallbacks were reported: once is enough.
    pub warned: bool,
}

impl PictureDevice {
    fn new(options: &DeviceOptions) -> Result<PictureDevice, PictureError> {
        let device = Device::new(&mut Headless, options)?;
        let renderer = Renderer::new(&device, offscreen::FORMAT)?;
        Ok(PictureDevice { renderer, frames: Frames::new(&device)?, device, warned: false })
    }
}
