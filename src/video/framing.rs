//! The placement of a frame on a screen of another shape: fitted, filling or stretched, and mirrored. Pure; x to the
//! right, y down, both 0 to 1 from the upper left corner.

use glam::{UVec2, Vec2};
use serde::Deserialize;

/// The treatment of a frame whose shape differs from that of the screen.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Fit {
    /// Show all of the frame, with bars beside it.
    Fit,
    /// Fill all of the screen, cropping the frame.
    #[default]
    Fill,
    /// Stretch the frame to the screen.
    Stretch,
}

/// Frame position from screen position: `screen * scale + offset`. A result outside 0 to 1 is
/// beyond the frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Framing {
    pub scale: Vec2,
    pub offset: Vec2,
}

impl Framing {
    /// Computes the framing. Sizes are in pixels (pixels are square); a side of 0, as of a minimised window, counts as
    /// 1. A mirrored frame shows its left on the right.
    pub fn new(picture: UVec2, screen: UVec2, fit: Fit, mirror: bool) -> Framing {
        let picture = picture.max(UVec2::ONE).as_vec2();
        let screen = screen.max(UVec2::ONE).as_vec2();
        // Above 1 where the screen is the wider of the two.
        let wider = (screen.x / screen.y) / (picture.x / picture.y);
        let scale = match fit {
            Fit::Stretch => Vec2::ONE,
            Fit::Fit => Vec2::new(wider.max(1.0), wider.recip().max(1.0)),
            Fit::Fill => Vec2::new(wider.min(1.0), wider.recip().min(1.0)),
        };
        let scale = if mirror { scale * Vec2::new(-1.0, 1.0) } else { scale };
        Framing { scale, offset: 0.5 * (Vec2::ONE - scale) }
    }

    /// Returns the position in the frame of a position on the screen.
    pub fn picture_from_screen(&self, screen: Vec2) -> Vec2 {
        screen * self.scale + self.offset
    }

    /// Returns the position on the screen of a position in the frame.
    pub fn screen_from_picture(&self, picture: Vec2) -> Vec2 {
        (picture - self.offset) / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(a: Vec2, b: Vec2) -> bool {
        a.distance(b) < 1e-4
    }

    #[test]
    fn shapes_known_by_hand() {
        let (wide, square) = (UVec2::new(1600, 800), UVec2::new(500, 500));
        let fit = Framing::new(wide, square, Fit::Fit, false);
        // The frame fills the middle half of the square's height.
        assert!(close(fit.screen_from_picture(Vec2::ZERO), Vec2::new(0.0, 0.25)));
        assert!(close(fit.screen_from_picture(Vec2::ONE), Vec2::new(1.0, 0.75)));
        assert!(fit.picture_from_screen(Vec2::new(0.5, 0.1)).y < 0.0);
        let fill = Framing::new(wide, square, Fit::Fill, false);
        assert!(close(fill.picture_from_screen(Vec2::ZERO), Vec2::new(0.25, 0.0)));
        assert!(close(fill.picture_from_screen(Vec2::ONE), Vec2::new(0.75, 1.0)));
        let mirrored = Framing::new(wide, square, Fit::Fill, true);
        assert!(close(mirrored.picture_from_screen(Vec2::ZERO), Vec2::new(0.75, 0.0)));
        let stretch = Framing::new(wide, square, Fit::Stretch, false);
        assert!(close(stretch.picture_from_screen(Vec2::new(0.3, 0.7)), Vec2::new(0.3, 0.7)));
        let none = Framing::new(UVec2::ZERO, UVec2::ZERO, Fit::Fit, false);
        assert!(none.scale.is_finite() && none.offset.is_finite());
    }

    proptest! {
        #[test]
        fn framing_keeps_its_promises(
            pw in 1u32..4000, ph in 1u32..4000, sw in 1u32..4000, sh in 1u32..4000,
            mirror: bool, x in 0.0f32..1.0, y in 0.0f32..1.0,
        ) {
            let (picture, screen) = (UVec2::new(pw, ph), UVec2::new(sw, sh));
            let at = Vec2::new(x, y);
            for fit in [Fit::Fit, Fit::Fill, Fit::Stretch] {
                let framing = Framing::new(picture, screen, fit, mirror);
                prop_assert!(close(framing.picture_from_screen(Vec2::splat(0.5)), Vec2::splat(0.5)));
                let seen = framing.scale.abs();
                // A frame 1 pixel wide on a wide screen is scaled by thousands, and the rounding of its positions with it.
                let back = framing.screen_from_picture(framing.picture_from_screen(at));
                let rounding = f32::EPSILON / seen.min_element();
                prop_assert!(back.distance(at) < rounding.max(1e-3));
                prop_assert_eq!(framing.scale.x < 0.0, mirror);
                match fit {
                    Fit::Stretch => prop_assert_eq!(seen, Vec2::ONE),
                    Fit::Fit => prop_assert!(seen.min_element() == 1.0),
                    Fit::Fill => prop_assert!(seen.max_element() == 1.0),
                }
                if fit != Fit::Stretch {
                    // Square pixels stay square: frame pixels per screen pixel, both ways.
                    let density = seen * picture.as_vec2() / screen.as_vec2();
                    prop_assert!((density.x / density.y - 1.0).abs() < 1e-4);
                }
            }
        }
    }
}
