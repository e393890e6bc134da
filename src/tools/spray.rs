//! Owns the spray tools: what a footprint of rays, cast onto the surface, adds, removes or paints.
//!
//! Takes the grid as it is seen (or as it was when the stroke began) and a [`Spray`]; gives the
//! voxels to change as a [`Stamp`]. Changes nothing itself and knows no document.
//!
//! The rays are the rays of the picture's pixels under the footprint, so that the tool works on
//! exactly what is on the screen (J. Mueller 2005: "congruent with the picture").

use std::collections::HashSet;

use glam::{IVec3, UVec2, Vec3};

use super::filter;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::{Grid, Rgb};
use crate::surface::raycast;

/// Widest footprint: radius in rays.
pub const MAX_FOOTPRINT: f32 = 256.0;
/// Furthest reach of a spray around a hit, in voxels.
pub const MAX_REACH_VX: f32 = 64.0;
/// Rounds after which growth stops at the latest.
const GROWTH_ROUNDS: u32 = 64;

/// The outline of a footprint, and of what is cut or added around a hit.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Outline {
    #[default]
    Round,
    Square,
}

impl Outline {
    pub const ALL: [Outline; 2] = [Outline::Round, Outline::Square];

    pub const fn name(self) -> &'static str {
        match self {
            Outline::Round => "round",
            Outline::Square => "square",
        }
    }
}

/// What a spray does where its rays meet the surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Effect {
    /// Gives the voxels that are seen the colour: the share `cover` (0 to 1) of them, evenly
    /// scattered, so that the colour thickens with every pass.
    Paintbrush { colour: Rgb, cover: f32 },
    /// Removes a ball or a cube around each hit.
    Devourer { outline: Outline },
    /// Removes voxels near the hits that have fewer than `threshold` of 26 neighbours.
    Erosion { threshold: u32 },
    /// Adds voxels near the hits that have at least `threshold` of 26 neighbours.
    Dilation { threshold: u32, colour: Rgb },
    /// Adds voxels near the hits into concave corners until the surface is closed.
    Growth { threshold: u32, colour: Rgb },
    /// Gives voxels near the hits the value of the majority around them.
    Smooth { radius_vx: u32 },
    /// Adds a soft mound on the surface, highest in the middle of the footprint.
    Clay { colour: Rgb },
}

impl Effect {
    /// The word for it in the text form and the interface.
    pub const fn name(self) -> &'static str {
        match self {
            Effect::Paintbrush { .. } => "paintbrush",
            Effect::Devourer { .. } => "devourer",
            Effect::Erosion { .. } => "erosion",
            Effect::Dilation { .. } => "dilation",
            Effect::Growth { .. } => "growth",
            Effect::Smooth { .. } => "smooth",
            Effect::Clay { .. } => "clay",
        }
    }
}

/// Rays under a footprint: through `aim + across * i + down * j` for whole i, j within `radius`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Footprint {
    /// The eye, in grid coordinates.
    pub eye_vx: Vec3,
    /// Direction of the middle ray.
    pub aim: Vec3,
    /// Change of direction from a ray to its right neighbour.
    pub across: Vec3,
    /// Change of direction from a ray to the one below.
    pub down: Vec3,
    /// In rays, 0 to [`MAX_FOOTPRINT`].
    pub radius: f32,
    pub outline: Outline,
}

/// A spray tool used once.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Spray {
    pub effect: Effect,
    pub footprint: Footprint,
    /// How far around a hit voxels may change, 0 to [`MAX_REACH_VX`].
    pub reach_vx: f32,
}

/// The voxels that a spray changes.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Stamp {
    pub remove: ListedBricks,
    pub add: ListedBricks,
    pub paint: ListedBricks,
}

/// A voxel that a ray met, and how far the ray is from the footprint's middle (0) to its rim (1).
#[derive(Clone, Copy, PartialEq, Debug)]
struct SprayHit {
    voxel: IVec3,
    offset: f32,
}

impl Spray {
    /// Names the first field that cannot be used, if any.
    pub fn check(&self) -> Result<(), &'static str> {
        let f = &self.footprint;
        let finite =
            f.eye_vx.is_finite() && f.aim.is_finite() && f.across.is_finite() && f.down.is_finite();
        if !finite {
            return Err("the rays");
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
            Effect::Smooth { radius_vx } if !(1..=8).contains(&radius_vx) => Err("the radius"),
            _ => Ok(()),
        }
    }

    /// What this spray changes in `grid`, its rays being cast on `surface` (the same grid, or the
    /// grid as it was when the stroke began; both of one size).
    pub fn stamp(&self, grid: &Grid, surface: &Grid) -> Stamp {
        let hits = self.footprint.hits(surface);
        if hits.is_empty() {
            return Stamp::default();
        }
        let (min, max) = self.bounds(&hits);
        let bricks = |block: &BitBlock| ListedBricks::new(block.bricks(grid.brick_dims()));
        match self.effect {
            Effect::Paintbrush { cover, .. } => {
                let mut seen = BitBlock::empty(min, max);
                let pass = self.pass();
                for hit in hits.iter().filter(|hit| scatter(hit.voxel, pass) < cover) {
                    seen.set_ball(hit.voxel, 0.0);
                }
                Stamp { paint: bricks(&seen), ..Stamp::default() }
            }
            Effect::Devourer { outline } => {
                let bitten = self.around(&hits, min, max, |_| self.reach_vx, outline);
                Stamp { remove: bricks(&bitten), ..Stamp::default() }
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
            Effect::Smooth { radius_vx } => {
                let (solid, may) = self.neighbourhood(grid, &hits, min, max);
                let (added, removed) = filter::majority(&solid, &may, radius_vx);
                Stamp { add: bricks(&added), remove: bricks(&removed), ..Stamp::default() }
            }
        }
    }

    /// The colour that this spray gives.
    pub fn colour(&self) -> Option<Rgb> {
        match self.effect {
            Effect::Paintbrush { colour, .. }
            | Effect::Dilation { colour, .. }
            | Effect::Growth { colour, .. }
            | Effect::Clay { colour } => Some(colour),
            Effect::Devourer { .. } | Effect::Erosion { .. } | Effect::Smooth { .. } => None,
        }
    }

    /// A number that differs from pass to pass and is the same when the pass is replayed.
    fn pass(&self) -> u32 {
        let Footprint { aim, eye_vx, .. } = self.footprint;
        let numbers = [aim.x, aim.y, aim.z, eye_vx.x, eye_vx.y, eye_vx.z];
        numbers.iter().fold(0, |pass, number| mixed(pass ^ number.to_bits()))
    }

    /// A box that holds whatever may change, and the neighbours that a filter looks at.
    fn bounds(&self, hits: &[SprayHit]) -> (IVec3, IVec3) {
        let margin = self.reach_vx.ceil() as i32
            + match self.effect {
                Effect::Smooth { radius_vx } => radius_vx as i32,
                _ => 1,
            };
        let min = hits.iter().map(|h| h.voxel).fold(IVec3::MAX, IVec3::min);
        let max = hits.iter().map(|h| h.voxel).fold(IVec3::MIN, IVec3::max);
        (min - margin, max + margin + 1)
    }

    /// The voxels around each hit, as far as `reach` says for its offset from the middle.
    fn around(
        &self,
        hits: &[SprayHit],
        min: IVec3,
        max: IVec3,
        reach: impl Fn(f32) -> f32,
        outline: Outline,
    ) -> BitBlock {
        let mut block = BitBlock::empty(min, max);
        for hit in hits {
            match outline {
                Outline::Round => block.set_ball(hit.voxel, reach(hit.offset)),
                Outline::Square => block.set_cube(hit.voxel, reach(hit.offset)),
            }
        }
        block
    }

    /// What exists near the hits, and what of it may change.
    fn neighbourhood(
        &self,
        grid: &Grid,
        hits: &[SprayHit],
        min: IVec3,
        max: IVec3,
    ) -> (BitBlock, BitBlock) {
        let may = self.around(hits, min, max, |_| self.reach_vx, Outline::Round);
        (BitBlock::of_grid(grid, min, max), may)
    }
}

/// A number in [0, 1) for a voxel and a pass, without a pattern that the eye would see.
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

impl Footprint {
    /// The voxels that the rays meet, each once, with the offset of the ray that came first.
    fn hits(&self, surface: &Grid) -> Vec<SprayHit> {
        let reach = self.radius as i32;
        let mut seen = HashSet::new();
        let mut hits = Vec::new();
        // From the middle outwards, so that a voxel keeps its smallest offset.
        let mut rays: Vec<(f32, i32, i32)> = Vec::new();
        for j in -reach..=reach {
            for i in -reach..=reach {
                let (x, y) = (i as f32, j as f32);
                let distance = match self.outline {
                    Outline::Round => x.hypot(y),
                    Outline::Square => x.abs().max(y.abs()),
                };
                if distance <= self.radius {
                    rays.push((distance / self.radius.max(1.0), i, j));
                }
            }
        }
        rays.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (offset, i, j) in rays {
            let direction = self.aim + self.across * i as f32 + self.down * j as f32;
            if let Some(hit) = raycast::cast(surface, self.eye_vx, direction)
                && seen.insert(hit.voxel)
            {
                hits.push(SprayHit { voxel: hit.voxel.as_ivec3(), offset });
            }
        }
        hits
    }
}

impl Footprint {
    /// The footprint around pixel (x, y) of a picture made with `rays`.
    pub fn of_pixel(
        rays: &crate::view::PixelRays,
        pixel: UVec2,
        radius: f32,
        outline: Outline,
    ) -> Footprint {
        Footprint {
            eye_vx: rays.origin,
            aim: rays.direction(pixel.x, pixel.y),
            across: rays.step_x,
            down: rays.step_y,
            radius,
            outline,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::Brick;
    use crate::sculpture::brick::local_coords;
    use glam::UVec3;

    const COLOUR: Rgb = Rgb::new(200, 30, 40);

    /// A slab that fills y < 20 of a 64^3 grid.
    fn slab() -> Grid {
        let mut grid = Grid::new(UVec3::splat(64), Vec3::ONE, 1 << 30).unwrap();
        grid.fill_bricks(|b| Brick::below([8, (20 - (b.y * 8).min(20)).min(8), 8]));
        grid
    }

    /// A footprint that looks straight down on (32, 32), a ray a voxel at the slab's surface.
    fn from_above(radius: f32, outline: Outline) -> Footprint {
        let height = 100.0;
        Footprint {
            eye_vx: Vec3::new(32.5, 20.0 + height, 32.5),
            aim: Vec3::NEG_Y,
            across: Vec3::X / height,
            down: Vec3::Z / height,
            radius,
            outline,
        }
    }

    fn spray(effect: Effect, footprint: Footprint, reach_vx: f32) -> Spray {
        Spray { effect, footprint, reach_vx }
    }

    fn voxels(bricks: &ListedBricks) -> Vec<IVec3> {
        let mut all = Vec::new();
        for (b, mask) in bricks.bricks() {
            mask.for_each(|i| all.push((*b * 8 + UVec3::from(local_coords(i))).as_ivec3()));
        }
        all
    }

    #[test]
    fn the_paintbrush_paints_what_is_seen_under_the_disc() {
        let grid = slab();
        let effect = Effect::Paintbrush { colour: COLOUR, cover: 1.0 };
        let stamp = spray(effect, from_above(6.0, Outline::Round), 3.0).stamp(&grid, &grid);
        let mut painted = voxels(&stamp.paint);
        painted.sort_by_key(|v| (v.z, v.x));
        let mut disc = Vec::new();
        for z in -6i32..=6 {
            for x in -6i32..=6 {
                if x * x + z * z <= 36 {
                    disc.push(IVec3::new(32 + x, 19, 32 + z));
                }
            }
        }
        assert_eq!(painted, disc);
        assert!(stamp.add.bricks().is_empty() && stamp.remove.bricks().is_empty());
    }

    #[test]
    fn cover_is_the_share_that_one_pass_paints() {
        let grid = slab();
        let paint = |cover: f32, eye: f32| {
            let mut footprint = from_above(20.0, Outline::Square);
            footprint.eye_vx.y += eye;
            let effect = Effect::Paintbrush { colour: COLOUR, cover };
            voxels(&spray(effect, footprint, 0.0).stamp(&grid, &grid).paint)
        };
        let (all, some, others) = (paint(1.0, 0.0), paint(0.3, 0.0), paint(0.3, 0.001));
        let share = some.len() as f32 / all.len() as f32;
        assert!((0.25..0.35).contains(&share), "{share}");
        assert_eq!(some, paint(0.3, 0.0), "a pass replayed is the same pass");
        assert_ne!(some, others, "another pass paints others");
        assert!(paint(0.0, 0.0).is_empty());
    }

    #[test]
    fn a_square_footprint_is_square() {
        let grid = slab();
        let effect = Effect::Paintbrush { colour: COLOUR, cover: 1.0 };
        let stamp = spray(effect, from_above(4.0, Outline::Square), 0.0).stamp(&grid, &grid);
        assert_eq!(voxels(&stamp.paint).len(), 9 * 9);
    }

    #[test]
    fn the_devourer_bites_a_ball_or_a_cube() {
        let grid = slab();
        for (outline, expected) in [(Outline::Round, 33), (Outline::Square, 125)] {
            let one = from_above(0.0, Outline::Round);
            let stamp = spray(Effect::Devourer { outline }, one, 2.0).stamp(&grid, &grid);
            let bitten = voxels(&stamp.remove);
            assert_eq!(bitten.len(), expected);
            let centre = IVec3::new(32, 19, 32);
            assert!(bitten.iter().all(|v| (*v - centre).abs().max_element() <= 2));
        }
    }

    #[test]
    fn rays_are_cast_on_the_surface_at_the_beginning_of_the_stroke() {
        let (surface, mut grid) = (slab(), slab());
        grid.set(IVec3::new(32, 19, 32), false);
        let effect = Effect::Devourer { outline: Outline::Round };
        let spray = spray(effect, from_above(0.0, Outline::Round), 0.0);
        let at_beginning = voxels(&spray.stamp(&grid, &surface).remove);
        let now = voxels(&spray.stamp(&grid, &grid).remove);
        assert_eq!(at_beginning, [IVec3::new(32, 19, 32)]);
        assert_eq!(now, [IVec3::new(32, 18, 32)]);
    }

    #[test]
    fn filters_leave_a_plane_alone() {
        let grid = slab();
        for effect in [
            Effect::Erosion { threshold: 14 },
            Effect::Dilation { threshold: 10, colour: COLOUR },
            Effect::Growth { threshold: 12, colour: COLOUR },
            Effect::Smooth { radius_vx: 2 },
        ] {
            let stamp = spray(effect, from_above(8.0, Outline::Round), 4.0).stamp(&grid, &grid);
            assert_eq!(stamp, Stamp::default(), "{}", effect.name());
        }
    }

    #[test]
    fn smoothing_takes_a_single_voxel_and_fills_a_single_hole() {
        let mut grid = slab();
        grid.set(IVec3::new(32, 20, 32), true);
        grid.set(IVec3::new(36, 19, 32), false);
        let effect = Effect::Smooth { radius_vx: 1 };
        let stamp = spray(effect, from_above(8.0, Outline::Round), 3.0).stamp(&grid, &grid);
        assert_eq!(voxels(&stamp.remove), [IVec3::new(32, 20, 32)]);
        assert_eq!(voxels(&stamp.add), [IVec3::new(36, 19, 32)]);
    }

    #[test]
    fn clay_is_a_mound_highest_in_the_middle() {
        let grid = slab();
        let effect = Effect::Clay { colour: COLOUR };
        let stamp = spray(effect, from_above(10.0, Outline::Round), 5.0).stamp(&grid, &grid);
        let clay = voxels(&stamp.add);
        let height = |x: i32| clay.iter().filter(|v| v.x == x && v.z == 32).map(|v| v.y).max();
        assert_eq!(height(32), Some(24));
        assert!(height(38) < height(34) && height(41) < height(38));
        assert!(clay.iter().all(|v| (*v - IVec3::new(32, 19, 32)).abs().max_element() <= 12));
    }

    #[test]
    fn what_meets_nothing_does_nothing_and_nonsense_is_refused() {
        let grid = slab();
        let mut up = from_above(5.0, Outline::Round);
        up.aim = Vec3::Y;
        let effect = Effect::Devourer { outline: Outline::Round };
        assert_eq!(spray(effect, up, 3.0).stamp(&grid, &grid), Stamp::default());
        assert!(spray(effect, up, f32::NAN).check().is_err());
        assert!(spray(effect, from_above(1e9, Outline::Round), 3.0).check().is_err());
        let effect = Effect::Erosion { threshold: 99 };
        assert_eq!(spray(effect, up, 3.0).check(), Err("the threshold"));
    }
}
