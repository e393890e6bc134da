//! Distributes the changed bricks of a document to its subscribers. Each drains every change once, at its own time. A
//! window and a headset, for instance, draw the same sculpture on devices of their own.
//!
//! Takes sets of bricks; returns rising lists of linear brick indices. Knows nothing of the grid but its size in bricks.

use std::sync::{Arc, Weak};

use glam::UVec3;

use crate::sculpture::brick_set::{BrickSet, for_each_in};
use crate::sculpture::index_set::IndexSet;

/// Identifies a subscriber to the changes of a document. Clones are the same subscriber; once all are
/// dropped, it is removed.
#[derive(Clone, Debug, Default)]
pub struct ChangeSubscriber(Arc<()>);

/// The changes that a subscriber has not drained yet.
#[derive(Debug)]
struct PendingChanges {
    subscriber: Weak<()>,
    /// Changed bricks; meaningless if `all` is set.
    bricks: IndexSet,
    all: bool,
}

/// The pending changes of all subscribers of one document.
#[derive(Debug, Default)]
pub(super) struct SubscribedChanges {
    pending: Vec<PendingChanges>,
    /// The bricks drained last, kept to reuse the allocation.
    drained: Vec<u32>,
}

impl SubscribedChanges {
    /// Adds changes to the pending ones of every subscriber, in a grid of `brick_dims` bricks. These are the bricks in
    /// `bricks`, which is emptied, or, with `all`, all bricks of a grid that may have another size.
    pub fn publish(&mut self, bricks: &mut BrickSet, all: bool, brick_dims: UVec3) {
        self.pending.retain(|pending| pending.subscriber.strong_count() > 0);
        if all {
            for pending in &mut self.pending {
                pending.bricks = IndexSet::new(brick_dims.element_product() as usize);
                pending.all = true;
            }
        }
        if !self.pending.is_empty() {
            for (leaf, changed) in bricks.leaves() {
                for_each_in(leaf, &changed, |b| {
                    let index = b.x + brick_dims.x * (b.y + brick_dims.y * b.z);
                    self.pending.iter_mut().for_each(|pending| pending.bricks.insert(index));
                });
            }
        }
        bricks.clear();
    }

    /// Returns the changes published since `subscriber` last drained, as rising linear indices. `None` means all
    /// bricks, as for a new subscriber.
    pub fn drain(&mut self, subscriber: &ChangeSubscriber, brick_count: usize) -> Option<&[u32]> {
        let subscriber = Arc::downgrade(&subscriber.0);
        let known = |pending: &&mut PendingChanges| pending.subscriber.ptr_eq(&subscriber);
        let Some(pending) = self.pending.iter_mut().find(known) else {
            let bricks = IndexSet::new(brick_count);
            self.pending.push(PendingChanges { subscriber, bricks, all: false });
            return None;
        };
        self.drained.clear();
        pending.bricks.collect_into(&mut self.drained);
        pending.bricks.clear();
        (!std::mem::take(&mut pending.all)).then_some(&self.drained)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The size in bricks: 500 of them.
    const DIMS: UVec3 = UVec3::new(20, 5, 5);

    fn set(bricks: &[u32]) -> BrickSet {
        let mut set = BrickSet::default();
        bricks.iter().for_each(|i| set.insert(UVec3::new(i % 20, i / 20 % 5, i / 100)));
        set
    }

    #[test]
    fn each_subscriber_drains_every_change_once() {
        let (window, headset) = (ChangeSubscriber::default(), ChangeSubscriber::default());
        let mut changes = SubscribedChanges::default();
        assert_eq!(changes.drain(&window, 500), None, "a new subscriber needs all");
        changes.publish(&mut set(&[3, 70, 71]), false, DIMS);
        assert_eq!(changes.drain(&headset, 500), None);
        assert_eq!(changes.drain(&window, 500), Some(&[3, 70, 71][..]));
        changes.publish(&mut set(&[1, 499]), false, DIMS);
        changes.publish(&mut set(&[1, 2]), false, DIMS);
        assert_eq!(changes.drain(&headset.clone(), 500), Some(&[1, 2, 499][..]));
        assert_eq!(changes.drain(&headset, 500), Some(&[][..]));
        assert_eq!(changes.drain(&window, 500), Some(&[1, 2, 499][..]));
        // In another grid, pending changes of the old one no longer matter.
        changes.publish(&mut set(&[]), true, UVec3::splat(2));
        assert_eq!(changes.drain(&window, 8), None);
        assert_eq!(changes.drain(&window, 8), Some(&[][..]));
        assert_eq!(changes.drain(&headset, 8), None);
    }

    #[test]
    fn a_dropped_subscriber_is_removed() {
        let mut changes = SubscribedChanges::default();
        for _ in 0..10 {
            changes.drain(&ChangeSubscriber::default(), 10);
            changes.publish(&mut BrickSet::default(), false, UVec3::new(10, 1, 1));
        }
        assert!(changes.pending.is_empty());
    }
}
