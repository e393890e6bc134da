//! Mixes a colour with those of the voxels. With few colour bits a mixture lies between two storable colours; it is
//! dithered so that the mean over an area is right.

use glam::{IVec3, UVec3};

use super::footprint::Footprint;
use crate::sculpture::{ColourDepth, Rgb};

/// A colour that a pass of a brush mixes in.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Mix {
    colour: Rgb,
    cover: f32,
    pass: u32,
    depth: ColourDepth,
}

impl Mix {
    /// Creates the mixture of a pass. `cover`: opacity of the colour, 0 to 1; `footprint`: that of the pass, which
    /// gives the same dither if it is replayed.
    pub fn new(colour: Rgb, cover: f32, footprint: &Footprint, depth: ColourDepth) -> Mix {
        Mix { colour, cover, pass: pass(footprint), depth }
    }

    /// Returns the new colour of a voxel from its present one.
    pub fn colour(&self, v: UVec3, now: Rgb) -> Rgb {
        let chance = scatter(v.as_ivec3(), self.pass);
        let mixed = std::array::from_fn(|i| {
            let (from, to) = (f32::from(now.0[i]), f32::from(self.colour.0[i]));
            let dither = (chance - 0.5) * self.depth.step()[i];
            (from + (to - from) * self.cover + dither).round().clamp(0.0, 255.0) as u8
        });
        match self.cover {
            1.0.. => self.colour,
            _ if self.cover <= 0.0 => now,
            _ => Rgb(mixed),
        }
    }
}

/// Returns a number that differs from pass to pass and is reproduced when a pass is replayed.
fn pass(footprint: &Footprint) -> u32 {
    let Footprint { aim, eye_vx, .. } = footprint;
    let numbers = [aim.x, aim.y, aim.z, eye_vx.x, eye_vx.y, eye_vx.z];
    numbers.iter().fold(0, |pass, number| mixed(pass ^ number.to_bits()))
}

/// Returns a number in [0, 1) for a voxel and a pass, without a visible pattern.
fn scatter(voxel: IVec3, pass: u32) -> f32 {
    let hash = voxel.to_array().iter().fold(pass, |hash, &v| mixed(hash ^ v as u32));
    (hash >> 8) as f32 / (1u32 << 24) as f32
}

/// Spreads every bit of `v` over all bits (the finaliser of MurmurHash3, A. Appleby).
fn mixed(v: u32) -> u32 {
    let v = (v ^ v >> 16).wrapping_mul(0x85eb_ca6b);
    let v = (v ^ v >> 13).wrapping_mul(0xc2b2_ae35);
    v ^ v >> 16
}
