//! Captures a trigger: turns device events into the first key, set of mouse buttons or notch of the wheel, with the
//! held modifiers. Escape cancels.

use egui::{Event, Key};

use super::button::Buttons;
use super::events::Modifiers;
use super::pad::shift_tap::ShiftTap;
use super::trigger::Trigger;

/// The result of a capture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CapturedInput {
    Trigger(Trigger),
    Cancelled,
}

/// The buttons and modifiers that are held during a capture.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Listener {
    held: Buttons,
    /// All buttons that were down together, until the first is released.
    chord: Buttons,
    modifiers: Modifiers,
    shift_tap: ShiftTap,
}

impl Listener {
    /// Processes one event. Returns the result if that completes it. Buttons count when the first is released, so that
    /// others can join.
    pub fn hear(&mut self, event: &Event) -> Option<CapturedInput> {
        if self.shift_tap.feed(event) {
            return Some(CapturedInput::Trigger(Trigger::ShiftTap));
        }
        let key = |key, modifiers| Some(CapturedInput::Trigger(Trigger::Key { key, modifiers }));
        match *event {
            Event::ModifiersChanged(now) => {
                self.modifiers = now.into();
                None
            }
            Event::Key { key: Key::Escape, pressed: true, .. } => Some(CapturedInput::Cancelled),
            Event::Key { key: pressed, pressed: true, repeat: false, modifiers, .. } => {
                self.modifiers = modifiers.into();
                if is_modifier(pressed) { None } else { key(pressed, modifiers.into()) }
            }
            Event::Copy => key(Key::C, self.with_ctrl()),
            Event::Cut => key(Key::X, self.with_ctrl()),
            Event::Paste(_) => key(Key::V, self.with_ctrl()),
            Event::PointerButton { button, pressed: true, modifiers, .. } => {
                self.modifiers = modifiers.into();
                self.held = self.held.with(button.into());
                self.chord = self.held;
                None
            }
            Event::PointerButton { button, pressed: false, .. } => {
                self.held = self.held.without(button.into());
                let buttons = std::mem::take(&mut self.chord);
                let modifiers = self.modifiers;
                // A release without a press belongs to the click that started the capture.
                (buttons != Buttons::NONE)
                    .then_some(CapturedInput::Trigger(Trigger::Mouse { buttons, modifiers }))
            }
            Event::MouseWheel { delta, modifiers, .. } if delta.y != 0.0 => {
                let modifiers = modifiers.into();
                Some(CapturedInput::Trigger(Trigger::Wheel { modifiers }))
            }
            Event::WindowFocused(false) => {
                *self = Listener::default();
                None
            }
            _ => None,
        }
    }

    fn with_ctrl(self) -> Modifiers {
        Modifiers { ctrl: true, ..self.modifiers }
    }
}

fn is_modifier(key: Key) -> bool {
    matches!(
        key,
        Key::ShiftLeft
            | Key::ShiftRight
            | Key::ControlLeft
            | Key::ControlRight
            | Key::AltLeft
            | Key::AltRight
            | Key::SuperLeft
            | Key::SuperRight
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{PointerButton, Pos2};

    fn hear(events: &[Event]) -> Vec<String> {
        let mut listener = Listener::default();
        let heard = events.iter().filter_map(|event| listener.hear(event));
        heard
            .map(|heard| match heard {
                CapturedInput::Trigger(trigger) => trigger.to_string(),
                CapturedInput::Cancelled => "cancelled".to_string(),
            })
            .collect()
    }

    fn key(key: Key, modifiers: egui::Modifiers) -> Event {
        Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers }
    }

    fn button(button: PointerButton, pressed: bool, modifiers: egui::Modifiers) -> Event {
        Event::PointerButton { pos: Pos2::ZERO, button, pressed, modifiers }
    }

    #[test]
    fn keys_come_with_their_modifiers_which_alone_are_nothing() {
        let both = egui::Modifiers::COMMAND | egui::Modifiers::SHIFT;
        assert_eq!(hear(&[key(Key::ShiftLeft, both), key(Key::K, both)]), ["Ctrl+Shift+K"]);
        assert_eq!(hear(&[key(Key::Escape, egui::Modifiers::NONE)]), ["cancelled"]);
        let released = Event::Key {
            key: Key::ShiftLeft,
            physical_key: None,
            pressed: false,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        };
        let shift = key(Key::ShiftLeft, egui::Modifiers::SHIFT);
        assert_eq!(hear(&[shift, released]), ["tap left Shift"]);
        assert_eq!(hear(&[Event::Copy, Event::Paste(String::new())]), ["Ctrl+C", "Ctrl+V"]);
    }

    #[test]
    fn buttons_are_heard_together() {
        use PointerButton::{Primary, Secondary};
        let none = egui::Modifiers::NONE;
        let alt = egui::Modifiers::ALT;
        assert_eq!(hear(&[button(Primary, false, none)]), [""; 0], "the end of an earlier click");
        assert_eq!(
            hear(&[button(Primary, true, alt), button(Primary, false, alt)]),
            ["Alt+left button"]
        );
        assert_eq!(
            hear(&[
                button(Primary, true, none),
                button(Secondary, true, none),
                button(Primary, false, none),
                button(Secondary, false, none),
            ]),
            ["left + right buttons"]
        );
    }

    #[test]
    fn the_wheel_is_heard_at_once() {
        let wheel = Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: egui::vec2(0.0, -1.0),
            modifiers: egui::Modifiers::SHIFT,
            phase: egui::TouchPhase::Move,
        };
        assert_eq!(hear(&[wheel]), ["Shift+wheel"]);
    }
}
