//! Falloffs: how the effect of a brush decreases from the centre of its ball to the rim, and how steeply.
//!
//! Takes distances in radii; gives shares. Knows no brush and no grid.

/// The falloff of the effect from the centre of the ball (0) to its rim (1).
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Falloff {
    /// (1 - r^2)^2
    #[default]
    Smooth,
    /// (1 - r)^2, which makes a tip
    Sharp,
    /// 1 up to half the radius, then smoothly to 0, as if moved by hand
    Flat,
}

impl Falloff {
    /// All falloffs, in the order in which interfaces offer them.
    pub const ALL: [Falloff; 3] = [Falloff::Smooth, Falloff::Sharp, Falloff::Flat];

    /// Returns the name in the text form and the interface.
    pub const fn name(self) -> &'static str {
        match self {
            Falloff::Smooth => "smooth",
            Falloff::Sharp => "sharp",
            Falloff::Flat => "flat",
        }
    }

    /// Returns the share of the effect at `r`, given its square. 0 from 1 on.
    #[inline(always)]
    pub(super) fn at(self, squared: f32) -> f32 {
        match self {
            Falloff::Smooth => {
                let left = (1.0 - squared).max(0.0);
                left * left
            }
            Falloff::Sharp => {
                let left = (1.0 - squared.sqrt()).max(0.0);
                left * left
            }
            Falloff::Flat => {
                let t = (2.0 * (1.0 - squared.sqrt()).max(0.0)).min(1.0);
                t * t * (3.0 - 2.0 * t)
            }
        }
    }

    /// Returns the share and its derivative with respect to the square of `r`.
    #[inline(always)]
    pub(super) fn at_with_slope(self, squared: f32) -> (f32, f32) {
        // At the centre the slope of a tip is unbounded; its factor there is 0.
        let r = squared.sqrt().max(1e-6);
        let slope = match self {
            Falloff::Smooth => -2.0 * (1.0 - squared).max(0.0),
            Falloff::Sharp => -(1.0 - r).max(0.0) / r,
            Falloff::Flat => {
                let t = (2.0 * (1.0 - r).max(0.0)).min(1.0);
                -6.0 * t * (1.0 - t) / r
            }
        };
        (self.at(squared), slope)
    }

    /// Returns the maximum product of the share and the distance from the centre.
    pub(super) fn widest_twist(self) -> f64 {
        match self {
            Falloff::Smooth => 0.287,
            Falloff::Sharp => 0.149,
            Falloff::Flat => 0.541,
        }
    }

    /// Returns the steepest slope of a twist by 1.
    pub(super) fn steepest_twist(self) -> f64 {
        match self {
            Falloff::Smooth | Falloff::Sharp => 1.0,
            Falloff::Flat => 2.0,
        }
    }

    /// Returns the steepest slope of a pinch of strength 1.
    pub(super) fn steepest_pinch(self) -> f64 {
        match self {
            Falloff::Smooth => 4.0,
            Falloff::Sharp => 2.0,
            Falloff::Flat => 12.0,
        }
    }

    /// Returns the steepest slope.
    pub(super) fn steepest(self) -> f64 {
        match self {
            // At r = 1 / sqrt(3).
            Falloff::Smooth => 1.54,
            Falloff::Sharp => 2.0,
            Falloff::Flat => 3.0,
        }
    }
}
