//! Owns who follows the changes of a document, so that each hears of every changed brick once,
//! however many there are: a window and a headset draw the same sculpture on devices of their own.

use std::sync::{Arc, Weak};

use crate::sculpture::brick_set::BrickSet;

/// Somebody who follows a document. Clones are the same follower; one that is dropped is
/// forgotten.
#[derive(Clone, Debug, Default)]
pub struct Follower(Arc<()>);

/// What a follower has not heard of yet.
#[derive(Debug)]
struct Unheard {
    by: Weak<()>,
    /// Changed bricks; of no meaning while `all`.
    bricks: BrickSet,
    all: bool,
}

/// All followers of one document.
#[derive(Debug, Default)]
pub(super) struct Followers {
    list: Vec<Unheard>,
    /// The bricks handed out last, kept for their memory.
    handed: Vec<u32>,
}

impl Followers {
    /// Notes for every follower what has changed in a grid of `brick_count` bricks: those of
    /// `bricks`, which is emptied, or with `all` all of them, perhaps of another number.
    pub fn tell(&mut self, bricks: &mut BrickSet, all: bool, brick_count: usize) {
        self.list.retain(|unheard| unheard.by.strong_count() > 0);
        if all {
            for unheard in &mut self.list {
                unheard.bricks = BrickSet::new(brick_count);
                unheard.all = true;
            }
        }
        for changed in bricks.masks() {
            self.list.iter_mut().for_each(|unheard| unheard.bricks.insert_mask(changed));
        }
        bricks.clear();
    }

    /// What `follower` has not heard of, as rising indices, which it has heard of from now on;
    /// none means all, as for one that is new.
    pub fn hear(&mut self, follower: &Follower, brick_count: usize) -> Option<&[u32]> {
        let by = Arc::downgrade(&follower.0);
        let Some(unheard) = self.list.iter_mut().find(|unheard| unheard.by.ptr_eq(&by)) else {
            self.list.push(Unheard { by, bricks: BrickSet::new(brick_count), all: false });
            return None;
        };
        self.handed.clear();
        unheard.bricks.collect_into(&mut self.handed);
        unheard.bricks.clear();
        (!std::mem::take(&mut unheard.all)).then_some(&self.handed)
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
    fn each_hears_of_every_change_once() {
        let (window, headset) = (Follower::default(), Follower::default());
        let mut followers = Followers::default();
        assert_eq!(followers.hear(&window, 500), None, "all is new");
        followers.tell(&mut set(&[3, 70, 71]), false, 500);
        assert_eq!(followers.hear(&headset, 500), None);
        assert_eq!(followers.hear(&window, 500), Some(&[3, 70, 71][..]));
        followers.tell(&mut set(&[1, 499]), false, 500);
        followers.tell(&mut set(&[1, 2]), false, 500);
        assert_eq!(followers.hear(&headset.clone(), 500), Some(&[1, 2, 499][..]));
        assert_eq!(followers.hear(&headset, 500), Some(&[][..]));
        assert_eq!(followers.hear(&window, 500), Some(&[1, 2, 499][..]));
        // Another grid: what was heard of the old one counts no more.
        followers.tell(&mut set(&[]), true, 8);
        assert_eq!(followers.hear(&window, 8), None);
        assert_eq!(followers.hear(&window, 8), Some(&[][..]));
        assert_eq!(followers.hear(&headset, 8), None);
    }

    #[test]
    fn one_that_is_gone_is_forgotten() {
        let mut followers = Followers::default();
        for _ in 0..10 {
            followers.hear(&Follower::default(), 10);
            followers.tell(&mut BrickSet::new(10), false, 10);
        }
        assert!(followers.list.is_empty());
    }
}
