//! Voxels to remove, to add and to recolour, as kernels return them.

use crate::sculpture::region::ListedBricks;

/// The voxels that a brush changes; for a mask those added to it or removed from it.
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
    /// Returns all that any of the stamps changes.
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
