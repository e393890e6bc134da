//! Pen events since the last pass, matched to the pointer that they lead: the pen button of a pointer press, and the
//! touch at each pointer move.
//!
//! The window system, or [`PenPointer`](super::PenPointer), moves the pointer; samples may come on another connection.
//! Both are matched by position and by changes.

use std::collections::VecDeque;

use egui::PointerButton;
use glam::Vec2;

use super::{Button, Buttons, PenSample, PenTouch, pointer};

/// Largest distance between a pointer move and its sample, in pixels.
const SAME_PX: f32 = 1.5;
/// Most samples that are kept: seconds of a fast tablet.
const MOST: usize = 4096;
/// Passes after which a sample without a pointer event is forgotten.
const LASTS: u32 = 4;

/// A sample with the buttons pressed since the one before.
#[derive(Clone, Copy, Debug)]
struct TrackedSample {
    sample: PenSample,
    pressed: Buttons,
    /// Its age in passes.
    age: u32,
}

/// Pen events over one window.
#[derive(Debug, Default)]
pub struct PenTrack {
    steps: VecDeque<TrackedSample>,
    /// Buttons held after all of them.
    held: Buttons,
    /// The sample that the pointer has reached.
    at: Option<PenSample>,
    /// Pointer buttons pressed by a pen, with the pen's own buttons.
    pressed: Vec<(PointerButton, Button)>,
    /// The pen button pressed since the last query.
    heard: Option<Button>,
    /// The last reported touch.
    said: Option<PenTouch>,
}

impl PenTrack {
    /// Adds a sample.
    pub fn push(&mut self, sample: &PenSample) {
        let Some(sample) = sample.checked() else { return };
        let before = std::mem::replace(&mut self.held, sample.buttons);
        let new = |button: &Button| !before.has(*button);
        let pressed = sample.buttons.iter().filter(new).fold(Buttons::NONE, Buttons::with);
        if self.steps.len() == MOST {
            self.steps.pop_front();
        }
        self.heard = pressed.iter().last().or(self.heard);
        self.steps.push_back(TrackedSample { sample, pressed, age: 0 });
    }

    /// Returns the button pressed last, once. The tip is excluded: it is the left button everywhere.
    pub fn take_heard(&mut self) -> Option<Button> {
        self.heard.take().filter(|button| *button != Button::Left)
    }

    /// Moves the pointer, in pixels of the window, to the first sample at that position.
    pub fn moved(&mut self, to_px: Vec2) {
        let near = |step: &TrackedSample| step.sample.position_px.distance(to_px) <= SAME_PX;
        if let Some(found) = self.steps.iter().position(near) {
            // A press is reached only by its own event.
            let mut until = self.steps.range(..=found);
            let press = until.position(|step| step.pressed != Buttons::NONE);
            self.go(press.unwrap_or(found + 1));
        }
    }

    /// Handles a press of a pointer button. Returns the pen's button; `None` for a mouse.
    pub fn press(&mut self, button: PointerButton) -> Option<Button> {
        let find = |step: &TrackedSample| pointer::behind(button, |own| step.pressed.has(own));
        let (count, own) =
            self.steps.iter().enumerate().find_map(|(i, step)| Some((i, find(step)?)))?;
        self.go(count);
        if let Some(step) = self.steps.front_mut() {
            step.pressed = step.pressed.without(own);
            self.at = Some(step.sample);
        }
        self.pressed.retain(|(held, _)| *held != button);
        self.pressed.push((button, own));
        Some(own)
    }

    /// Handles a release of a pointer button. Returns the pen's button.
    pub fn release(&mut self, button: PointerButton) -> Option<Button> {
        let held = self.pressed.iter().position(|(held, _)| *held == button)?;
        Some(self.pressed.remove(held).1)
    }

    /// Returns the touch of the pen at the pointer; `None` if it hovers or there is none.
    pub fn touch(&self) -> Option<PenTouch> {
        let is_held = |(_, own): &(PointerButton, Button)| !own.is_on_barrel();
        self.pressed.iter().any(is_held).then_some(self.at?.touch()).flatten()
    }

    /// Returns the present touch, if it has changed since the last report.
    pub fn news(&mut self) -> Option<Option<PenTouch>> {
        let now = self.touch();
        (std::mem::replace(&mut self.said, now) != now).then_some(now)
    }

    /// Ends the pass. Samples from another connection may be ahead of the pointer: they wait for it, but not for long.
    pub fn finish(&mut self) {
        self.steps.iter_mut().for_each(|step| step.age += 1);
        let old = self.steps.iter().take_while(|step| step.age > LASTS).count();
        self.go(old);
    }

    /// Releases everything when the window loses the focus.
    pub fn let_go(&mut self) {
        *self = PenTrack { held: self.held, ..PenTrack::default() };
    }

    fn go(&mut self, count: usize) {
        self.at = self.steps.drain(..count).next_back().map(|step| step.sample).or(self.at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::pen::PenEnd;
    use egui::PointerButton::{Middle, Primary, Secondary};

    fn sample(x: f32, pressure: f32, buttons: &[Button]) -> PenSample {
        PenSample {
            position_px: Vec2::new(x, 0.0),
            pressure: Some(pressure),
            tilt_deg: Vec2::ZERO,
            end: PenEnd::Tip,
            buttons: buttons.iter().fold(Buttons::NONE, |set, button| set.with(*button)),
            is_near: true,
        }
    }

    fn pressure(track: &PenTrack) -> Option<f32> {
        track.touch().map(|touch| touch.pressure)
    }

    #[test]
    fn each_move_has_the_pressure_of_its_own_sample() {
        let mut track = PenTrack::default();
        track.push(&sample(0.0, 0.0, &[]));
        for i in 0..5 {
            track.push(&sample(i as f32 * 10.0, 0.2 * (i + 1) as f32, &[Button::Left]));
        }
        track.moved(Vec2::ZERO);
        assert_eq!(pressure(&track), None, "it hovers");
        assert_eq!(track.press(Primary), Some(Button::Left));
        assert_eq!(pressure(&track), Some(0.2));
        for (x, expected) in [(10.0, 0.4), (20.0, 0.6), (25.0, 0.6), (40.0, 1.0)] {
            track.moved(Vec2::new(x, 0.0));
            assert_eq!(pressure(&track), Some(expected), "{x}");
        }
        track.push(&sample(40.0, 0.0, &[]));
        assert_eq!(track.release(Primary), Some(Button::Left));
        assert_eq!(pressure(&track), None);
        (0..=LASTS).for_each(|_| track.finish());
        // Now it is a mouse.
        assert_eq!(track.press(Primary), None);
        assert_eq!((track.release(Primary), pressure(&track)), (None, None));
    }

    #[test]
    fn presses_are_the_pens_own_whatever_number_the_system_gives_them() {
        for (own, shown) in [
            (Button::Eraser, Primary),
            (Button::PenLower, Secondary),
            (Button::PenLower, Middle),
            (Button::PenUpper, Middle),
            (Button::PenUpper, Secondary),
            (Button::PenThird, PointerButton::Extra1),
        ] {
            let mut track = PenTrack::default();
            track.push(&sample(5.0, 0.3, &[own]));
            assert_eq!(track.take_heard(), Some(own));
            assert_eq!(track.press(shown), Some(own));
            assert_eq!(track.press(shown), None, "once");
            assert_eq!(track.release(shown), Some(own));
        }
        let mut track = PenTrack::default();
        track.push(&sample(5.0, 0.3, &[Button::Left]));
        assert_eq!(track.press(Secondary), None, "a mouse beside the pen");
        assert_eq!(track.take_heard(), None);
        track.let_go();
        assert_eq!(track.press(Primary), None);
    }

    #[test]
    fn samples_ahead_of_the_pointer_wait_for_it() {
        let mut track = PenTrack::default();
        track.push(&sample(0.0, 0.0, &[]));
        track.push(&sample(0.0, 0.1, &[Button::Left]));
        track.push(&sample(8.0, 0.7, &[Button::Left]));
        track.moved(Vec2::ZERO);
        track.finish();
        assert_eq!(track.press(Primary), Some(Button::Left));
        assert_eq!(track.news(), Some(Some(PenTouch::of_pressure(0.1))));
        assert_eq!(track.news(), None, "nothing new");
        track.finish();
        track.moved(Vec2::new(8.0, 0.0));
        assert_eq!(track.news(), Some(Some(PenTouch::of_pressure(0.7))));
        track.release(Primary);
        assert_eq!(track.news(), Some(None));
        // A pen that presses harder in place.
        track.push(&sample(8.0, 0.2, &[]));
        track.push(&sample(8.0, 0.3, &[Button::Left]));
        track.push(&sample(8.0, 0.4, &[Button::Left]));
        track.moved(Vec2::new(8.0, 0.0));
        track.press(Primary);
        assert_eq!(pressure(&track), Some(0.3));
        track.moved(Vec2::new(8.0, 0.0));
        assert_eq!(pressure(&track), Some(0.3), "the sample of the press itself");
        track.moved(Vec2::new(8.0, 0.0));
        assert_eq!(pressure(&track), Some(0.4));
    }

    #[test]
    fn a_pen_that_is_never_asked_about_takes_no_memory() {
        let mut track = PenTrack::default();
        for i in 0..3 * MOST {
            track.push(&sample(i as f32, 0.5, &[]));
        }
        assert_eq!(track.steps.len(), MOST);
    }
}
