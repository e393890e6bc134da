//! The pointer of a pen, for window systems that send no mouse events for it. The tip and the eraser press the first
//! button; the buttons on the barrel press the others, as elsewhere.

use egui::{Event, Modifiers, PointerButton, pos2};

use super::{Button, Buttons, PenSample};

/// Parts of a pen that act as buttons of a pointer.
const HELD: [(Button, PointerButton); 7] = [
    (Button::Left, PointerButton::Primary),
    (Button::Eraser, PointerButton::Primary),
    (Button::PenLower, PointerButton::Secondary),
    (Button::PenUpper, PointerButton::Middle),
    (Button::PenThird, PointerButton::Extra1),
    // Buttons of the mice that belong to some tablets.
    (Button::Right, PointerButton::Secondary),
    (Button::Middle, PointerButton::Middle),
];

/// The pointer of a pen over a window.
#[derive(Clone, Copy, Debug, Default)]
pub struct PenPointer {
    buttons: Buttons,
}

impl PenPointer {
    /// Returns the pointer events of a sample, with the held modifier keys.
    pub fn events(
        &mut self,
        sample: &PenSample,
        pixels_per_point: f32,
        modifiers: Modifiers,
    ) -> Vec<Event> {
        let at = sample.position_px / pixels_per_point;
        let pos = pos2(at.x, at.y);
        let mut events = Vec::new();
        if sample.is_near {
            events.push(Event::PointerMoved(pos));
        }
        let before = std::mem::replace(&mut self.buttons, sample.buttons);
        for (own, button) in HELD {
            let pressed = sample.buttons.has(own);
            if pressed != before.has(own) {
                events.push(Event::PointerButton { pos, button, pressed, modifiers });
            }
        }
        if !sample.is_near {
            events.push(Event::PointerGone);
        }
        events
    }
}

/// Returns the pen button that may have caused a pointer button. X11 numbers those of the barrel in another order.
pub(super) fn behind(button: PointerButton, held: impl Fn(Button) -> bool) -> Option<Button> {
    let own = match button {
        PointerButton::Primary => [Button::Left, Button::Eraser, Button::Eraser],
        _ => [Button::PenLower, Button::PenUpper, Button::PenThird],
    };
    let usual = HELD.into_iter().filter(|(_, of)| *of == button).map(|(own, _)| own);
    usual.chain(own).find(|own| held(*own))
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::input::pen::PenEnd;

    fn sample(x: f32, end: PenEnd, buttons: &[Button]) -> PenSample {
        PenSample {
            position_px: Vec2::new(x, 0.0),
            pressure: Some(0.5),
            tilt_deg: Vec2::ZERO,
            end,
            buttons: buttons.iter().fold(Buttons::NONE, |set, button| set.with(*button)),
            is_near: true,
        }
    }

    #[test]
    fn a_pen_is_a_mouse_for_panels_and_lets_go_when_it_leaves() {
        let mut pointer = PenPointer::default();
        let mut run = |sample: PenSample| pointer.events(&sample, 2.0, Modifiers::CTRL);
        let press = |x, button, pressed| {
            let (pos, modifiers) = (pos2(x, 0.0), Modifiers::CTRL);
            Event::PointerButton { pos, button, pressed, modifiers }
        };
        use PointerButton::{Primary, Secondary};
        assert_eq!(run(sample(4.0, PenEnd::Tip, &[])), [Event::PointerMoved(pos2(2.0, 0.0))]);
        assert_eq!(
            run(sample(4.0, PenEnd::Tip, &[Button::Left, Button::PenLower])),
            [
                Event::PointerMoved(pos2(2.0, 0.0)),
                press(2.0, Primary, true),
                press(2.0, Secondary, true)
            ]
        );
        let gone = PenSample { is_near: false, ..sample(6.0, PenEnd::Tip, &[]) };
        assert_eq!(
            run(gone),
            [press(3.0, Primary, false), press(3.0, Secondary, false), Event::PointerGone]
        );
        let erased = run(sample(8.0, PenEnd::Eraser, &[Button::Eraser]));
        assert_eq!(erased, [Event::PointerMoved(pos2(4.0, 0.0)), press(4.0, Primary, true)]);
    }
}
