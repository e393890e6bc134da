//! Pens of graphics tablets as values: the reports of a pen ([`PenSample`]), the part that affects a tool
//! ([`PenTouch`]), and their link to the pointer that the window system or [`PenPointer`] makes of a pen.
//!
//! Knows no window system: the back ends in `screen::pen` give samples.

mod options;
mod pointer;
mod track;

use glam::Vec2;

use super::button::{Button, Buttons};

pub use options::{EXPONENTS, FULL, PenCurve, PenOptions};
pub use pointer::PenPointer;
pub use track::PenTrack;

/// Largest valid tilt of a pen, in degrees.
const MOST_TILT_DEG: f32 = 90.0;

/// The end of the pen that points at the tablet.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum PenEnd {
    #[default]
    Tip,
    Eraser,
}

/// The report of a pen at a time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PenSample {
    /// In pixels from the window's upper left corner.
    pub position_px: Vec2,
    /// 0 to 1; `None` if the tablet does not report it. 0 while the pen hovers.
    pub pressure: Option<f32>,
    /// Tilt to the right, and towards the person; zero for an upright pen.
    pub tilt_deg: Vec2,
    pub end: PenEnd,
    /// The touching end ([`Button::Left`] or [`Button::Eraser`]), and the held buttons.
    pub buttons: Buttons,
    /// Whether the pen is over the window; false once, when it has left.
    pub is_near: bool,
}

impl PenSample {
    /// Returns the button of the pen's end.
    pub fn tip(&self) -> Button {
        match self.end {
            PenEnd::Tip => Button::Left,
            PenEnd::Eraser => Button::Eraser,
        }
    }

    /// Returns whether the pen touches the tablet.
    pub fn is_down(&self) -> bool {
        self.buttons.has(Button::Left) || self.buttons.has(Button::Eraser)
    }

    /// Returns the sample, or `None` if a driver has sent an invalid number.
    pub fn checked(self) -> Option<PenSample> {
        let limit = Vec2::splat(MOST_TILT_DEG);
        let tilt_deg = if self.tilt_deg.is_finite() { self.tilt_deg } else { Vec2::ZERO };
        let pressure = self.pressure.filter(|p| p.is_finite()).map(|p| p.clamp(0.0, 1.0));
        self.position_px.is_finite().then_some(PenSample {
            tilt_deg: tilt_deg.clamp(-limit, limit),
            pressure,
            ..self
        })
    }

    /// Returns the touch, if there is one.
    pub fn touch(&self) -> Option<PenTouch> {
        let pressure = self.pressure.unwrap_or(1.0);
        self.is_down().then_some(PenTouch { pressure, tilt_deg: self.tilt_deg })
    }
}

/// The touch of a pen or a finger.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PenTouch {
    /// 0 to 1.
    pub pressure: f32,
    /// As in [`PenSample`]; zero if it is not known.
    pub tilt_deg: Vec2,
}

impl PenTouch {
    /// Returns a touch with a pressure and no tilt.
    pub fn of_pressure(pressure: f32) -> PenTouch {
        PenTouch { pressure, tilt_deg: Vec2::ZERO }
    }

    /// Returns the tilt of the pen in any direction, in degrees from upright.
    pub fn lean_deg(&self) -> f32 {
        let slope = Vec2::new(slope(self.tilt_deg.x), slope(self.tilt_deg.y)).length();
        slope.atan().to_degrees()
    }
}

/// Returns the slope of an axis tilted by an angle in degrees.
fn slope(tilt_deg: f32) -> f32 {
    tilt_deg.clamp(-89.0, 89.0).to_radians().tan()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> PenSample {
        PenSample {
            position_px: Vec2::new(3.0, 4.0),
            pressure: Some(0.5),
            tilt_deg: Vec2::ZERO,
            end: PenEnd::Tip,
            buttons: Buttons::NONE.with(Button::Left),
            is_near: true,
        }
    }

    #[test]
    fn values_from_a_driver_are_kept_within_bounds() {
        let odd = PenSample { pressure: Some(7.0), tilt_deg: Vec2::new(200.0, -200.0), ..sample() };
        let kept = odd.checked().unwrap();
        assert_eq!((kept.pressure, kept.tilt_deg), (Some(1.0), Vec2::new(90.0, -90.0)));
        let odd = PenSample { pressure: Some(f32::NAN), tilt_deg: Vec2::NAN, ..sample() };
        let kept = odd.checked().unwrap();
        assert_eq!((kept.pressure, kept.tilt_deg), (None, Vec2::ZERO));
        assert_eq!(kept.touch(), Some(PenTouch::of_pressure(1.0)), "as a mouse");
        assert!(PenSample { position_px: Vec2::NAN, ..sample() }.checked().is_none());
        assert_eq!(PenSample { buttons: Buttons::NONE, ..sample() }.touch(), None);
    }

    #[test]
    fn a_pen_leans_the_same_whichever_way() {
        let lean = |x, y| PenTouch { pressure: 1.0, tilt_deg: Vec2::new(x, y) }.lean_deg();
        assert_eq!(lean(0.0, 0.0), 0.0);
        for (x, y) in [(40.0, 0.0), (-40.0, 0.0), (0.0, 40.0)] {
            assert!((lean(x, y) - 40.0).abs() < 1e-3);
        }
        assert!((lean(30.0, 30.0) - 39.23).abs() < 0.01);
        assert!(lean(90.0, 90.0) < 90.0);
    }
}
