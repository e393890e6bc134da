//! Distributes the changed bricks of a document to its subscribers. Each drains every change once, at its own time. A
//! window and a headset, for instance, draw the same sculpture on devices of their own.
//!
//! Takes sets of linear brick indices; returns rising lists of them. Knows nothing of the grid but its number of
//! bricks.

use std::sync::{Arc, Weak};

use crate::sculpture::brick_set::BrickSet;

/// Identifies a subscriber to the changes of a document. Clones are the same subscriber; once all are
/// dropped, it is removed.
#[derive(Clone, Debug, Default)]
pub struct ChangeSubscriber(Arc<()>);

/// The changes that a subscriber has not drained yet.
#[derive(Debug)]
struct PendingChanges {
    subscriber: Weak<()>,
    /// Changed bricks; meaningless if `all` is set.
    bricks: BrickSet,
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
    /// Adds changes to the pending ones of every subscriber, in a grid of `brick_count` bricks. These are the bricks in
    /// `bricks`, which is emptied, or, with `all`, all bricks of a grid that may have another size.
    pub fn publish(&mut self, bricks: &mut BrickSet, all: bool, brick_count: usize) {
        self.pending.retain(|pending| pending.subscriber.strong_count() > 0);
        if all {
            for pending in &mut self.pending {
                pending.bricks = BrickSet::new(brick_count);
                pending.all = true;
            }
        }
        for changed in bricks.masks() {
            self.pending.iter_mut().for_each(|pending| pending.bricks.insert_mask(changed));
        }
        bricks.clear();
    }

    /// Returns the changes published since `subscriber` last drained, as rising linear indices. `None` means all
    /// bricks, as for a new subscriber.
    pub fn drain(&mut self, subscriber: &ChangeSubscriber, brick_count: usize) -> Option<&[u32]> {
        let subscriber = Arc::downgrade(&subscriber.0);
        let known = |pending: &&mut PendingChanges| pending.subscriber.ptr_eq(&subscriber);
        let Some(pending) = self.pending.iter_mut().find(known) else {
            let bricks = BrickSet::new(brick_count);
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

    fn set(bricks: &[u32]) -> BrickSet {
        let mut set = BrickSet::new(500);
        bricks.iter().for_each(|brick| set.insert(*brick));
        set
    }

    #[test]
    fn each_subscriber_drains_every_change_once() {
        let (window, headset) = (ChangeSubscriber::default(), ChangeSubscriber::default());
        let mut changes = SubscribedChanges::default();
        assert_eq!(changes.drain(&window, 500), None, "a new subscriber needs all");
        changes.publish(&mut set(&[3, 70, 71]), false, 500);
        assert_eq!(changes.drain(&headset, 500), None);
        assert_eq!(changes.drain(&window, 500), Some(&[3, 70, 71][..]));
        changes.publish(&mut set(&[1, 499]), false, 500);
        changes.publish(&mut set(&[1, 2]), false, 500);
        assert_eq!(changes.drain(&headset.clone(), 500), Some(&[1, 2, 499][..]));
        assert_eq!(changes.drain(&headset, 500), Some(&[][..]));
        assert_eq!(changes.drain(&window, 500), Some(&[1, 2, 499][..]));
        // In another grid, pending changes of the old one no longer matter.
        changes.publish(&mut set(&[]), true, 8);
        assert_eq!(changes.drain(&window, 8), None);
        assert_eq!(changes.drain(&window, 8), Some(&[][..]));
        assert_eq!(changes.drain(&headset, 8), None);
    }

    #[test]
    fn a_dropped_subscriber_is_removed() {
        let mut changes = SubscribedChanges::default();
        for _ in 0..10 {
            changes.drain(&ChangeSubscriber::default(), 10);
            changes.publish(&mut BrickSet::new(10), false, 10);
        }
        assert!(changes.pending.is_empty());
    }
}
