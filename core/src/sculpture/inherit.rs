//! Colours for voxels that a filter adds: each takes the mean of its neighbours' colours, so that the result matches
//! the painted surface around it.
//!
//! Takes the contents before the change and the voxels to be added; returns their colours and changes
//! nothing. The order of the voxels does not matter, so that mirrored voxels get mirrored colours.

use std::collections::{HashMap, HashSet};

use glam::{IVec3, UVec3};

use super::brick::{BRICK_EDGE_VX, local_coords};
use super::colour::Rgb;
use super::contents::Contents;
use super::region::ListedBricks;
use super::to_paint::growth_of_bricks;

/// The distance up to which a voxel without neighbours searches for existing voxels: that of the widest majority
/// filter.
const FAR_VX: i32 = 8;

/// Colours for voxels that are about to exist.
#[derive(Debug, Default)]
pub struct Inherited(HashMap<UVec3, Rgb>);

impl Inherited {
    /// Returns colours for the voxels of `add` that do not exist yet and for which `may_change` is true. Empty if no
    /// brick has been painted.
    pub fn colours(
        contents: &Contents,
        add: &ListedBricks,
        may_change: impl Fn(IVec3) -> bool,
    ) -> Inherited {
        let mut colours = HashMap::new();
        if contents.material.page_count() == 0 {
            return Inherited(colours);
        }
        let mut pending = Vec::new();
        for (b, mask) in add.bricks() {
            mask.for_each(|local| {
                let v = *b * BRICK_EDGE_VX + UVec3::from(local_coords(local));
                let signed = v.as_ivec3();
                let grid = &contents.grid;
                if grid.contains(signed) && !grid.get(signed) && may_change(signed) {
                    pending.push(v);
                }
            });
        }
        // From the surface outwards, one layer of voxels at a time.
        while !pending.is_empty() {
            let before = pending.len();
            let mut layer = Vec::new();
            pending.retain(|&v| {
                let known = |at: IVec3| match contents.colour(at) {
                    None if colours.is_empty() => None,
                    None => colours.get(&at.as_uvec3()).copied(),
                    existing => existing,
                };
                let found = mean_within(v, 1, known);
                layer.extend(found.map(|colour| (v, colour)));
                found.is_none()
            });
            colours.extend(layer);
            if pending.len() == before {
                break;
            }
        }
        for v in pending {
            let near =
                (2..=FAR_VX).find_map(|reach| mean_within(v, reach, |at| contents.colour(at)));
            colours.insert(v, near.unwrap_or(contents.material.base()));
        }
        Inherited(colours)
    }

    /// Returns whether no voxel inherits a colour.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the colour that the voxel `v` inherits, if any.
    pub fn colour(&self, v: UVec3) -> Option<Rgb> {
        self.0.get(&v).copied()
    }

    /// Returns an upper bound of the bytes by which painting the voxels makes the colours larger.
    pub(crate) fn growth(&self, contents: &Contents) -> u64 {
        let material = &contents.material;
        let is_painted = |(v, colour): &(&UVec3, &Rgb)| {
            material.page(**v / BRICK_EDGE_VX).is_some()
                || material.depth().quantise(**colour) != material.base()
        };
        let painted = self.0.iter().filter(is_painted);
        let bricks: HashSet<UVec3> = painted.map(|(v, _)| *v / BRICK_EDGE_VX).collect();
        growth_of_bricks(material, bricks)
    }
}

/// Returns the mean of the colours known in the cube that extends `reach` voxels around `v`, each channel rounded.
fn mean_within(v: UVec3, reach: i32, known: impl Fn(IVec3) -> Option<Rgb>) -> Option<Rgb> {
    let (mut sum, mut count) = ([0u32; 3], 0);
    for z in -reach..=reach {
        for y in -reach..=reach {
            for x in -reach..=reach {
                if let Some(Rgb(colour)) = known(v.as_ivec3() + IVec3::new(x, y, z)) {
                    (0..3).for_each(|i| sum[i] += u32::from(colour[i]));
                    count += 1;
                }
            }
        }
    }
    (count > 0).then(|| Rgb(sum.map(|sum| ((sum + count / 2) / count) as u8)))
}
