//! Spray tools: the voxels that a footprint on the surface adds, removes or paints.
//!
//! From the visible grid (or the grid when the stroke began) and a [`Spray`] to the voxels to change, as
//! a [`Stamp`]. Changes nothing itself and knows no document.
//!
//! The footprint lies in the picture, so that the tool works on exactly what is on the screen
//! (J. Mueller 2005: "congruent with the picture").

use glam::{IVec3, UVec3};

use super::BrushId;
use super::footprint::{Footprint, MAX_FOOTPRINT, Outline, Touch};
use super::kernel::filter;
use super::kernel::level::Level;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::{ColourDepth, Grid, Rgb};

/// Largest reach of a spray around a hit, in voxels.
pub const MAX_REACH_VX: f32 = 64.0;
/// Most rounds of growth.
const GROWTH_ROUNDS: u32 = 64;

/// What a spray does where its rays meet the surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Effect {
    /// Mixes the colour into the visible voxels, so that it builds up with every pass.
    Paintbrush {
        /// The colour.
        colour: Rgb,
        /// Share of the colour in the mixture, 0 to 1.
        cover: f32,
    },
    /// Removes a ball or a cube around each hit.
    Devourer {
        /// Ball or cube.
        outline: Outline,
    },
    /// Removes voxels near the hits that have fewer than `threshold` of 26 neighbours.
    Erosion {
        /// Least number of neighbours with which a voxel stays.
        threshold: u32,
    },
    /// Adds voxels near the hits that have at least `threshold` of 26 neighbours. Without a colour
    /// they take their neighbours'.
    Dilation {
        /// Neighbours from which on a voxel is added.
        threshold: u32,
        /// Colour of new voxels.
        colour: Option<Rgb>,
    },
    /// Adds voxels near the hits into concave corners until the surface is closed. Without a
    /// colour they take their neighbours'.
    Growth {
        /// Neighbours from which on a voxel is added.
        threshold: u32,
        /// Colour of new voxels.
        colour: Option<Rgb>,
    },
    /// Smooths the surface; new voxels take their neighbours' colours.
    Smooth(Smoothing),
    /// Adds a soft mound on the surface, highest in the middle of the footprint.
    Clay {
        /// Colour of new voxels.
        colour: Rgb,
    },
    /// Adds all voxels around each hit to the mask, existing or not, or takes them out of it.
    Mask {
        /// Adds them.
        adds: bool,
    },
}

/// The way in which a brush smooths.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Smoothing {
    /// Voxels near the hits get the value of the majority around them.
    Majority {
        /// Reach of the neighbourhood on each axis.
        radius_vx: u32,
    },
    /// Forms smaller than the footprint go; the reach has no say.
    Level(Level),
}

/// The spray tools, without their options.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum SprayKind {
    /// Colours the surface.
    Paintbrush,
    /// Removes balls or cubes of voxels.
    Devourer,
    /// Removes voxels with few neighbours.
    Erosion,
    /// Adds voxels with many neighbours.
    Dilation,
    /// Adds voxels in balls or cubes.
    Growth,
    /// Removes and adds by the majority of the neighbourhood.
    Smooth,
    /// Adds a layer.
    Clay,
    /// Protects the surface.
    Mask,
    /// Takes protection away.
    Unmask,
}

impl SprayKind {
    /// All kinds, in the order in which interfaces offer them.
    pub const ALL: [SprayKind; 9] = [
        SprayKind::Paintbrush,
        SprayKind::Devourer,
        SprayKind::Clay,
        SprayKind::Erosion,
        SprayKind::Dilation,
        SprayKind::Growth,
        SprayKind::Smooth,
        SprayKind::Mask,
        SprayKind::Unmask,
    ];

    /// As a brush.
    pub const fn brush(self) -> BrushId {
        match self {
            SprayKind::Paintbrush => BrushId::Paint,
            SprayKind::Devourer => BrushId::Devour,
            SprayKind::Erosion => BrushId::Erode,
            SprayKind::Dilation => BrushId::Dilate,
            SprayKind::Growth => BrushId::Grow,
            SprayKind::Smooth => BrushId::Smooth,
            SprayKind::Clay => BrushId::Clay,
            SprayKind::Mask => BrushId::Mask,
            SprayKind::Unmask => BrushId::Unmask,
        }
    }

    /// Its name in the text form.
    pub const fn name(self) -> &'static str {
        self.brush().spec().name
    }

    /// Whether the tool needs a colour.
    pub const fn gives_colour(self) -> bool {
        matches!(self, SprayKind::Paintbrush | SprayKind::Clay)
    }
}

impl Effect {
    /// The kind, without its parameters.
    pub const fn kind(self) -> SprayKind {
        match self {
            Effect::Paintbrush { .. } => SprayKind::Paintbrush,
            Effect::Devourer { .. } => SprayKind::Devourer,
            Effect::Erosion { .. } => SprayKind::Erosion,
            Effect::Dilation { .. } => SprayKind::Dilation,
            Effect::Growth { .. } => SprayKind::Growth,
            Effect::Smooth(_) => SprayKind::Smooth,
            Effect::Clay { .. } => SprayKind::Clay,
            Effect::Mask { adds: true } => SprayKind::Mask,
            Effect::Mask { adds: false } => SprayKind::Unmask,
        }
    }

    /// Its name in the text form and the interface.
    pub const fn name(self) -> &'static str {
        self.kind().name()
    }
}

/// A spray tool used once.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Spray {
    /// What happens at the surface.
    pub effect: Effect,
    /// The rays.
    pub footprint: Footprint,
    /// How far around a hit voxels may change, 0 to [`MAX_REACH_VX`].
    pub reach_vx: f32,
}

/// The voxels that a spray changes; of a mask those that are added to it or removed from it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Stamp {
    /// Voxels to remove.
    pub remove: ListedBricks,
    /// Voxels to add.
    pub add: ListedBricks,
    /// Voxels to recolour.
    pub paint: ListedBricks,
}

impl Stamp {
    /// All that any of the stamps changes.
    pub fn union(stamps: impl IntoIterator<Item = Stamp>) -> Stamp {
        let mut stamps: Vec<Stamp> = stamps.into_iter().collect();
        if stamps.len() == 1 {
            return stamps.swap_remove(0);
        }
        let lists = |part: fn(&mut Stamp) -> &mut ListedBricks, stamps: &mut [Stamp]| {
            ListedBricks::union(stamps.iter_mut().map(|stamp| std::mem::take(part(stamp))))
        };
        Stamp {
            remove: lists(|stamp| &mut stamp.remove, &mut stamps),
            add: lists(|stamp| &mut stamp.add, &mut stamps),
            paint: lists(|stamp| &mut stamp.paint, &mut stamps),
        }
    }
}

impl Spray {
    /// An error that names the first invalid field, if there is one.
    pub fn check(&self) -> Result<(), &'static str> {
        let f = &self.footprint;
        let finite =
            f.eye_vx.is_finite() && f.aim.is_finite() && f.across.is_finite() && f.down.is_finite();
        if !finite {
            return Err("a ray");
        }
        if !(0.0..=MAX_FOOTPRINT).contains(&f.radius) {
            return Err("the radius of the footprint");
        }
        if !(0.0..=MAX_REACH_VX).contains(&self.reach_vx) {
            return Err("the reach");
        }
        match self.effect {
            Effect::Paintbrush { cover, .. } if !(0.0..=1.0).contains(&cover) => Err("the cover"),
            Effect::Erosion { threshold }
            | Effect::Dilation { threshold, .. }
            | Effect::Growth { threshold, .. }
                if !(1..=26).contains(&threshold) =>
            {
                Err("the threshold")
            }
            Effect::Smooth(Smoothing::Majority { radius_vx }) if !(1..=8).contains(&radius_vx) => {
                Err("the radius")
            }
            Effect::Smooth(Smoothing::Level(level)) => level.check(),
            _ => Ok(()),
        }
    }

    /// The voxels that this spray changes in `grid`. Its rays are cast on `surface`: the same grid, or
    /// the grid when the stroke began, of the same size.
    pub fn stamp(&self, grid: &Grid, surface: &Grid) -> Stamp {
        if let Effect::Smooth(Smoothing::Level(level)) = self.effect {
            // All of it works on one surface: overlapping uses on that of a stroke's beginning do not add up.
            return level.stamp(&self.footprint, surface);
        }
        let hits = self.footprint.touched(surface);
        if hits.is_empty() {
            return Stamp::default();
        }
        let (min, max) = self.bounds(&hits);
        let bricks = |block: &BitBlock| ListedBricks::new(block.bricks(grid.brick_dims()));
        match self.effect {
            Effect::Paintbrush { .. } => {
                let mut seen = BitBlock::empty(min, max);
                hits.iter().for_each(|Touch { voxel: v, .. }| seen.set_span(v.x, v.x, v.y, v.z));
                Stamp { paint: bricks(&seen), ..Stamp::default() }
            }
            Effect::Devourer { outline } => {
                let bitten = self.around(&hits, min, max, |_| self.reach_vx, outline);
                Stamp { remove: bricks(&bitten), ..Stamp::default() }
            }
            Effect::Mask { adds } => {
                let around = self.around(&hits, min, max, |_| self.reach_vx, Outline::Round);
                match adds {
                    true => Stamp { add: bricks(&around), ..Stamp::default() },
                    false => Stamp { remove: bricks(&around), ..Stamp::default() },
                }
            }
            Effect::Clay { .. } => {
                // A paraboloid over the footprint, so that strokes blend into what is there.
                let height = |offset: f32| self.reach_vx * (1.0 - offset * offset);
                let mound = self.around(&hits, min, max, height, Outline::Round);
                Stamp { add: bricks(&mound), ..Stamp::default() }
            }
            Effect::Erosion { threshold } => {
                let (solid, may) = self.neighbourhood(grid, &hits, min, max);
                let removed = filter::erosion(&solid, &may, threshold);
                Stamp { remove: bricks(&removed), ..Stamp::default() }
            }
            Effect::Dilation { threshold, .. } => {
                let (solid, may) = self.neighbourhood(grid, &hits, min, max);
                let added = filter::dilation(&solid, &may, threshold);
                Stamp { add: bricks(&added), ..Stamp::default() }
            }
            Effect::Growth { threshold, .. } => {
                let (solid, may) = self.neighbourhood(grid, &hits, min, max);
                let added = filter::growth(&solid, &may, threshold, GROWTH_ROUNDS);
                Stamp { add: bricks(&added), ..Stamp::default() }
            }
            Effect::Smooth(Smoothing::Majority { radius_vx }) => {
                let (solid, may) = self.neighbourhood(grid, &hits, min, max);
                let (added, removed) = filter::majority(&solid, &may, radius_vx);
                Stamp { add: bricks(&added), remove: bricks(&removed), ..Stamp::default() }
            }
            Effect::Smooth(Smoothing::Level(_)) => Stamp::default(),
        }
    }

    /// The colour of this spray. None if new voxels take their neighbours' colours.
    pub fn colour(&self) -> Option<Rgb> {
        match self.effect {
            Effect::Paintbrush { colour, .. } | Effect::Clay { colour } => Some(colour),
            Effect::Dilation { colour, .. } | Effect::Growth { colour, .. } => colour,
            Effect::Devourer { .. }
            | Effect::Erosion { .. }
            | Effect::Smooth(_)
            | Effect::Mask { .. } => None,
        }
    }

    /// The new colour of a voxel of the stamp's `paint`, from its present one. With few bits of colour
    /// a mixture lies between two storable colours: it is dithered so that the mean over an area is
    /// right.
    pub fn paint(&self, depth: ColourDepth) -> Option<impl Fn(UVec3, Rgb) -> Rgb + Sync + use<>> {
        let Effect::Paintbrush { colour, cover } = self.effect else { return None };
        let pass = self.pass();
        Some(move |v: UVec3, now: Rgb| {
            let chance = scatter(v.as_ivec3(), pass);
            let mixed = std::array::from_fn(|i| {
                let (from, to) = (f32::from(now.0[i]), f32::from(colour.0[i]));
                let dither = (chance - 0.5) * depth.step()[i];
                (from + (to - from) * cover + dither).round().clamp(0.0, 255.0) as u8
            });
            match cover {
                1.0.. => colour,
                _ if cover <= 0.0 => now,
                _ => Rgb(mixed),
            }
        })
    }

    /// A number that differs from pass to pass and is reproduced when a pass is replayed.
    fn pass(&self) -> u32 {
        let Footprint { aim, eye_vx, .. } = self.footprint;
        let numbers = [aim.x, aim.y, aim.z, eye_vx.x, eye_vx.y, eye_vx.z];
        numbers.iter().fold(0, |pass, number| mixed(pass ^ number.to_bits()))
    }

    /// A box of all voxels that may change and the neighbours that filters read.
    fn bounds(&self, hits: &[Touch]) -> (IVec3, IVec3) {
        let margin = self.reach_vx.ceil() as i32
            + match self.effect {
                Effect::Smooth(Smoothing::Majority { radius_vx }) => radius_vx as i32,
                _ => 1,
            };
        let min = hits.iter().map(|h| h.voxel).fold(IVec3::MAX, IVec3::min);
        let max = hits.iter().map(|h| h.voxel).fold(IVec3::MIN, IVec3::max);
        (min - margin, max + margin + 1)
    }

    /// The voxels around each hit, up to the `reach` for its offset from the centre.
    fn around(
        &self,
        hits: &[Touch],
        min: IVec3,
        max: IVec3,
        reach: impl Fn(f32) -> f32,
        outline: Outline,
    ) -> BitBlock {
        // Distances between voxels are roots of whole numbers: reaches between two of them are the same.
        let steps = |offset: f32| match outline {
            Outline::Round => reach(offset).max(0.0).powi(2) as u32,
            Outline::Square => reach(offset).max(0.0) as u32,
        };
        let mut hits: Vec<(u32, IVec3)> = hits.iter().map(|h| (steps(h.offset), h.voxel)).collect();
        hits.sort_unstable_by_key(|(steps, _)| *steps);
        let mut around = BitBlock::empty(min, max);
        for alike in hits.chunk_by(|(a, _), (b, _)| a == b) {
            let mut seeds = around.emptied();
            alike.iter().for_each(|(_, v)| seeds.set_span(v.x, v.x, v.y, v.z));
            match outline {
                Outline::Round => around.add_balls(&seeds, alike[0].0),
                Outline::Square => around.add_cubes(&seeds, alike[0].0),
            }
        }
        around
    }

    /// The existing voxels near the hits, and those that may change.
    fn neighbourhood(
        &self,
        grid: &Grid,
        hits: &[Touch],
        min: IVec3,
        max: IVec3,
    ) -> (BitBlock, BitBlock) {
        let may = self.around(hits, min, max, |_| self.reach_vx, Outline::Round);
        (BitBlock::of_grid(grid, min, max), may)
    }
}

/// A number in [0, 1) for a voxel and a pass, without a visible pattern.
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
