//! The change that a motion of clay makes: the voxels that appear, vanish or change colour, with the transported
//! colours.
//!
//! Changes nothing itself; knows no motion and no brush.

use glam::UVec3;

use super::stamp::Stamp;
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_VOXELS, local_index};
use crate::sculpture::{Brick, Rgb};

/// The transported colours of the voxels of a brick, valid where its mask in the list is set.
pub(super) type PulledColours = (UVec3, Box<[Rgb; BRICK_VOXELS as usize]>);

/// The change that a pull makes.
#[derive(Default)]
pub struct Pulled {
    /// Voxels to remove, to add and to recolour, among them those added.
    pub stamp: Stamp,
    /// The colours, in the order of the bricks of `stamp.paint`.
    pub(super) colours: Vec<PulledColours>,
}

impl Pulled {
    /// Returns the colour of a voxel of `stamp.paint`.
    pub fn colour(&self, v: UVec3) -> Option<Rgb> {
        let brick = v / BRICK_EDGE_VX;
        let key = |b: UVec3| (b.z, b.y, b.x);
        let place = self.colours.binary_search_by_key(&key(brick), |(b, _)| key(*b)).ok()?;
        let [x, y, z] = (v % BRICK_EDGE_VX).to_array();
        Some(self.colours[place].1[local_index(x, y, z) as usize])
    }

    /// Unites the parts. Voxels in several parts have the same source in each.
    pub(super) fn union(parts: Vec<Pulled>) -> Pulled {
        let (stamps, colours): (Vec<_>, Vec<_>) =
            parts.into_iter().map(|part| (part.stamp, part.colours)).unzip();
        let masks: Vec<Vec<(UVec3, Brick)>> =
            stamps.iter().map(|stamp| stamp.paint.bricks().to_vec()).collect();
        let mut all: Vec<(PulledColours, Brick)> = colours
            .into_iter()
            .zip(masks)
            .flat_map(|(colours, masks)| colours.into_iter().zip(masks.into_iter().map(|m| m.1)))
            .collect();
        all.sort_by_key(|((b, _), _)| (b.z, b.y, b.x));
        let mut merged: Vec<PulledColours> = Vec::new();
        for ((brick, colours), mask) in all {
            match merged.last_mut() {
                Some((last, kept)) if *last == brick => {
                    mask.for_each(|i| kept[i as usize] = colours[i as usize]);
                }
                _ => merged.push((brick, colours)),
            }
        }
        Pulled { stamp: Stamp::union(stamps), colours: merged }
    }
}
