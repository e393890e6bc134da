//! Taps of the left Shift key: pressed and released with no other key, button or wheel in between. Shift as a modifier
//! never counts.

use egui::{Event, Key};

/// The state between events.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct ShiftTap {
    /// Shift is down, and nothing else has happened since.
    alone: bool,
}

impl ShiftTap {
    /// Processes an event. Returns true if `event` completes a tap.
    pub fn feed(&mut self, event: &Event) -> bool {
        match *event {
            Event::Key { key: Key::ShiftLeft, pressed: true, repeat, modifiers, .. } => {
                // Key repeat neither begins a tap nor cancels one.
                if !repeat {
                    self.alone = !(modifiers.ctrl || modifiers.command || modifiers.alt);
                }
                false
            }
            Event::Key { key: Key::ShiftLeft, pressed: false, .. } => {
                std::mem::take(&mut self.alone)
            }
            Event::Key { pressed: true, .. }
            | Event::PointerButton { .. }
            | Event::MouseWheel { .. }
            | Event::Zoom(_)
            | Event::Text(_)
            | Event::Copy
            | Event::Cut
            | Event::Paste(_)
            | Event::WindowFocused(_) => {
                self.alone = false;
                false
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, PointerButton, Pos2};

    fn key(key: Key, pressed: bool, repeat: bool) -> Event {
        let modifiers = Modifiers { shift: true, ..Modifiers::NONE };
        Event::Key { key, physical_key: None, pressed, repeat, modifiers }
    }

    fn taps(events: &[Event]) -> usize {
        let mut tap = ShiftTap::default();
        events.iter().filter(|event| tap.feed(event)).count()
    }

    const SHIFT: Key = Key::ShiftLeft;

    #[test]
    fn only_shift_alone_is_a_tap() {
        let press = key(SHIFT, true, false);
        let release = key(SHIFT, false, false);
        let click = |pressed| Event::PointerButton {
            pos: Pos2::ZERO,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::SHIFT,
        };
        let alone = [press.clone(), release.clone(), press.clone(), release.clone()];
        assert_eq!(taps(&alone), 2);
        let held = [press.clone(), key(SHIFT, true, true), release.clone()];
        assert_eq!(taps(&held), 1);
        let moved = [press.clone(), Event::PointerMoved(Pos2::ZERO), release.clone()];
        assert_eq!(taps(&moved), 1);
        let letter = [press.clone(), key(Key::A, true, false), release.clone()];
        assert_eq!(taps(&letter), 0);
        assert_eq!(taps(&[press.clone(), click(true), release.clone(), click(false)]), 0);
        assert_eq!(taps(&[press.clone(), click(false), release.clone()]), 0, "the end of a drag");
        assert_eq!(taps(&[press, Event::WindowFocused(false), release.clone()]), 0);
        assert_eq!(taps(&[release]), 0);
    }

    #[test]
    fn with_ctrl_or_the_right_shift_it_is_none() {
        let modifiers = Modifiers { shift: true, ctrl: true, ..Modifiers::NONE };
        let both =
            Event::Key { key: SHIFT, physical_key: None, pressed: true, repeat: false, modifiers };
        assert_eq!(taps(&[both, key(SHIFT, false, false)]), 0);
        let right = [key(Key::ShiftRight, true, false), key(Key::ShiftRight, false, false)];
        assert_eq!(taps(&right), 0);
    }
}
