//! Owns what pipelines that light surfaces are specialised to, and the pipelines of a pass by that.
//!
//! The twin of shaders/surface_kind.wgsl. What a person moves while looking, as the place of a lamp
//! or its strength, is a uniform; what is there or not is a kind, so that a shader is made for it once.

use super::Colours;
use super::shading::Surface;
use crate::gpu::Result;

/// What a shader has to be able to do.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct SurfaceKind {
    lights: u32,
    occlusion: bool,
    /// Of a voxel; 0 where all have the base colour.
    colour_bytes: u32,
}

impl SurfaceKind {
    /// What lighting `surface` takes.
    pub fn of(surface: &Surface) -> SurfaceKind {
        let lighting = surface.lighting;
        SurfaceKind {
            lights: lighting.lights.iter().flatten().count() as u32,
            occlusion: lighting.occlusion,
            colour_bytes: surface.colours.map_or(0, Colours::bytes_per_voxel),
        }
    }

    /// The specialization constants of the shaders.
    fn constants(self) -> [u32; 3] {
        [self.lights, self.occlusion.into(), self.colour_bytes]
    }
}

/// What a pass has made for each kind of surface that it has met: at most as many as there are kinds,
/// a few dozen.
pub(super) struct ByKind<P> {
    made: Vec<(SurfaceKind, P)>,
}

impl<P> ByKind<P> {
    pub fn new() -> ByKind<P> {
        ByKind { made: Vec::new() }
    }

    /// That of `kind`, which `make` makes with specialization constants if it is not there yet.
    pub fn get(&mut self, kind: SurfaceKind, make: impl FnOnce(&[u32]) -> Result<P>) -> Result<&P> {
        let place = match self.made.iter().position(|(made, _)| *made == kind) {
            Some(place) => place,
            None => {
                self.made.push((kind, make(&kind.constants())?));
                self.made.len() - 1
            }
        };
        Ok(&self.made[place].1)
    }
}
