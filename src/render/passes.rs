//! The passes of a renderer on the device: the sampler, those that shade and draw the sculpture, and the layers around
//! it.
//!
//! Does not know when a picture is repeated, nor its progress.

use std::sync::Arc;

use ash::vk;

use super::composite::ShadedPictures;
use super::layers::Layers;
use super::pictures::FinishedPictures;
use super::sampler::{DeviceMaps, Sampler};
use super::sculpture_passes::SculpturePasses;
use crate::gpu::{Device, Result};

/// See the module text.
pub(super) struct Passes {
    pub sampler: Sampler,
    pub sculpture: SculpturePasses,
    pub layers: Layers,
}

/// The images on the device from which a picture is made.
#[derive(Default)]
pub(super) struct PictureImages {
    pub pictures: Option<FinishedPictures>,
    maps: DeviceMaps,
    shaded: ShadedPictures,
}

impl Passes {
    /// Creates one for pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Passes> {
        Ok(Passes {
            sampler: Sampler::new(device)?,
            sculpture: SculpturePasses::new(device, format)?,
            layers: Layers::new(device, format)?,
        })
    }

    /// Discards the device's copy of the document.
    pub fn forget_document(&mut self) {
        self.sampler.forget_copy();
        self.layers.forget_document();
    }

    /// Exchanges the images for others.
    pub fn swap_images(&mut self, other: &mut PictureImages) {
        std::mem::swap(&mut self.layers.pictures, &mut other.pictures);
        self.sampler.swap_maps(&mut other.maps);
        self.sculpture.composite.swap_pictures(&mut other.shaded);
    }
}
