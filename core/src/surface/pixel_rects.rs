//! A small set of pixel rectangles that cover all rectangles added to it. Rectangles close to each other are merged, so
//! that the overhead per rectangle stays small.

use super::index_map::PixelRect;

/// The most rectangles in a set: enough for a tool and its mirror images.
pub const MAX_RECTS: usize = 8;

/// Rectangles of pixels, which may overlap; see [`PixelRects::without_overlap`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PixelRects {
    rects: [PixelRect; MAX_RECTS],
    count: usize,
}

impl PixelRects {
    /// No rectangle.
    pub const NONE: PixelRects = PixelRects { rects: [PixelRect::EMPTY; MAX_RECTS], count: 0 };

    /// Returns a set of one rectangle, or none if it is empty.
    pub fn of(rect: PixelRect) -> PixelRects {
        let mut rects = PixelRects::NONE;
        rects.add(rect);
        rects
    }

    /// Returns the rectangles.
    pub fn as_slice(&self) -> &[PixelRect] {
        &self.rects[..self.count]
    }

    /// Returns whether there is no rectangle.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns the number of pixels in all rectangles.
    pub fn pixel_count(&self) -> u64 {
        self.as_slice().iter().map(|rect| rect.pixel_count()).sum()
    }

    /// Returns the smallest rectangle that holds all rectangles.
    pub fn bounds(&self) -> PixelRect {
        self.as_slice().iter().copied().reduce(PixelRect::union).unwrap_or(PixelRect::EMPTY)
    }

    /// Merges a rectangle into the one that grows least, or adds it on its own.
    pub fn add(&mut self, rect: PixelRect) {
        if rect.is_empty() {
            return;
        }
        let growth = |old: &PixelRect| {
            let union = old.union(rect).pixel_count();
            (union, union as i64 - old.pixel_count() as i64 - rect.pixel_count() as i64)
        };
        let nearest = (0..self.count).min_by_key(|&i| growth(&self.rects[i]).1);
        match nearest {
            Some(i) if self.count == MAX_RECTS || near(&self.rects[i], &rect) => {
                self.rects[i] = self.rects[i].union(rect);
            }
            _ => {
                self.rects[self.count] = rect;
                self.count += 1;
            }
        }
    }

    /// Merges rectangles until none overlap.
    pub fn without_overlap(mut self) -> PixelRects {
        let mut i = 0;
        while i < self.count {
            let rect = self.rects[i];
            let other = (i + 1..self.count).find(|&j| !rect.intersect(self.rects[j]).is_empty());
            match other {
                Some(j) => {
                    self.rects[i] = rect.union(self.rects[j]);
                    self.count -= 1;
                    self.rects[j] = self.rects[self.count];
                    // The larger one may now overlap any other.
                    i = 0;
                }
                None => i += 1,
            }
        }
        self
    }
}

/// Returns whether sampling the bounds of two rectangles costs no more than sampling both on their own.
fn near(a: &PixelRect, b: &PixelRect) -> bool {
    const FIXED_COST_PX: u64 = 1024;
    a.union(*b).pixel_count() <= a.pixel_count() + b.pixel_count() + FIXED_COST_PX
}
