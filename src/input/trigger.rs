//! Triggers: a key, a set of buttons of mouse or pen, or the wheel, each with modifiers, the left Shift key
//! tapped alone, or a gamepad button; and their text form: `ctrl+shift+z`, `left`,
//! `ctrl+left+right`, `eraser`, `shift+wheel`, `shift-tap`, `pad-south`.

use std::fmt;
use std::str::FromStr;

use egui::Key;

use super::button::{Button, Buttons};
use super::events::Modifiers;
use super::pad::PadButton;

const SHIFT_TAP: &str = "shift-tap";

/// An input that triggers an action.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Trigger {
    Key {
        key: Key,
        modifiers: Modifiers,
    },
    Mouse {
        buttons: Buttons,
        modifiers: Modifiers,
    },
    Wheel {
        modifiers: Modifiers,
    },
    /// The left Shift key, pressed and released with nothing in between.
    ShiftTap,
    Pad {
        button: PadButton,
    },
}

impl FromStr for Trigger {
    type Err = String;

    fn from_str(text: &str) -> Result<Trigger, String> {
        if text == SHIFT_TAP {
            return Ok(Trigger::ShiftTap);
        }
        if let Some(button) = PadButton::named(text) {
            return Ok(Trigger::Pad { button });
        }
        let mut modifiers = Modifiers::default();
        let mut buttons = Buttons::NONE;
        let mut wheel = false;
        let mut key = None;
        for word in text.split('+').map(str::trim) {
            match word {
                "ctrl" => modifiers.ctrl = true,
                "shift" => modifiers.shift = true,
                "alt" => modifiers.alt = true,
                "wheel" => wheel = true,
                _ => match Button::ALL.into_iter().find(|button| button.name() == word) {
                    Some(button) => buttons = buttons.with(button),
                    None if key.is_none() => key = Some(parse_key(word)?),
                    None => return Err(format!("`{text}` names more than one key")),
                },
            }
        }
        match (key, buttons, wheel) {
            (Some(key), Buttons::NONE, false) => Ok(Trigger::Key { key, modifiers }),
            (None, Buttons::NONE, true) => Ok(Trigger::Wheel { modifiers }),
            (None, Buttons::NONE, false) => Err(format!("`{text}` names modifiers only")),
            (None, buttons, false) => Ok(Trigger::Mouse { buttons, modifiers }),
            _ => Err(format!("`{text}` mixes keys, mouse buttons or the wheel")),
        }
    }
}

fn parse_key(word: &str) -> Result<Key, String> {
    // `left` and `right` are mouse buttons, so the arrow keys have other names; the names of other
    // keys are egui's, ignoring case.
    let arrow = match word {
        "arrowleft" => Some(Key::ArrowLeft),
        "arrowright" => Some(Key::ArrowRight),
        "arrowup" => Some(Key::ArrowUp),
        "arrowdown" => Some(Key::ArrowDown),
        _ => None,
    };
    let found = arrow
        .or_else(|| Key::from_name(word))
        .or_else(|| Key::ALL.iter().copied().find(|key| key.name().eq_ignore_ascii_case(word)));
    found.ok_or_else(|| format!("`{word}` is not a key, a mouse button or a modifier"))
}

impl Trigger {
    /// Returns the text that `parse` reads.
    pub fn code(self) -> String {
        let modifiers = self.modifiers();
        let held = [(modifiers.ctrl, "ctrl"), (modifiers.shift, "shift"), (modifiers.alt, "alt")];
        let mut words: Vec<String> =
            held.into_iter().filter(|(held, _)| *held).map(|(_, name)| name.to_string()).collect();
        match self {
            Trigger::Key { key, .. } => words.push(match key {
                Key::ArrowLeft => "arrowleft".to_string(),
                Key::ArrowRight => "arrowright".to_string(),
                Key::ArrowUp => "arrowup".to_string(),
                Key::ArrowDown => "arrowdown".to_string(),
                other => other.name().to_lowercase(),
            }),
            Trigger::Mouse { buttons, .. } => {
                words.extend(buttons.iter().map(|button| button.name().to_string()));
            }
            Trigger::Wheel { .. } => words.push("wheel".to_string()),
            Trigger::ShiftTap => words.push(SHIFT_TAP.to_string()),
            Trigger::Pad { button } => words.push(button.name().to_string()),
        }
        words.join("+")
    }

    fn modifiers(self) -> Modifiers {
        match self {
            Trigger::Key { modifiers, .. }
            | Trigger::Mouse { modifiers, .. }
            | Trigger::Wheel { modifiers } => modifiers,
            Trigger::ShiftTap | Trigger::Pad { .. } => Modifiers::default(),
        }
    }
}

/// The text shown to people: `Ctrl+Shift+Z`, `left button`, `Ctrl+wheel`.
impl fmt::Display for Trigger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let modifiers = self.modifiers();
        for (held, name) in
            [(modifiers.ctrl, "Ctrl+"), (modifiers.shift, "Shift+"), (modifiers.alt, "Alt+")]
        {
            if held {
                f.write_str(name)?;
            }
        }
        match self {
            Trigger::Key { key, .. } => f.write_str(match key {
                Key::ArrowLeft => "Left arrow",
                Key::ArrowRight => "Right arrow",
                Key::ArrowUp => "Up arrow",
                Key::ArrowDown => "Down arrow",
                Key::PageUp => "Page up",
                Key::PageDown => "Page down",
                Key::OpenBracket => "[",
                Key::CloseBracket => "]",
                other => other.name(),
            }),
            Trigger::Mouse { buttons, .. } => {
                if *buttons == Buttons::NONE.with(Button::Eraser) {
                    return f.write_str(Button::Eraser.label());
                }
                let names: Vec<&str> = buttons.iter().map(Button::label).collect();
                let plural = if names.len() > 1 { "s" } else { "" };
                write!(f, "{} button{plural}", names.join(" + "))
            }
            Trigger::Wheel { .. } => f.write_str("wheel"),
            Trigger::ShiftTap => f.write_str("tap left Shift"),
            Trigger::Pad { button } => f.write_str(button.label()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str) -> String {
        text.parse::<Trigger>().unwrap().to_string()
    }

    #[test]
    fn triggers_read_and_show() {
        assert_eq!(shown("ctrl+shift+z"), "Ctrl+Shift+Z");
        assert_eq!(shown("openbracket"), "[");
        assert_eq!(shown("["), "[");
        assert_eq!(shown("f1"), "F1");
        assert_eq!(shown("home"), "Home");
        assert_eq!(shown("pageup"), "Page up");
        assert_eq!(shown("arrowleft"), "Left arrow");
        assert_eq!(shown("left"), "left button");
        assert_eq!(shown("ctrl+left+right"), "Ctrl+left + right buttons");
        assert_eq!(shown("eraser"), "pen's eraser");
        assert_eq!(shown("ctrl+pen-lower"), "Ctrl+pen's lower button");
        assert_eq!(shown("left+pen-upper"), "left + pen's upper buttons");
        assert_eq!(shown("shift+wheel"), "Shift+wheel");
        assert_eq!(shown("shift-tap"), "tap left Shift");
        assert_eq!(shown("pad-dpad-left"), "gamepad D-pad left");
    }

    #[test]
    fn every_key_button_and_the_wheel_come_back_from_their_text() {
        let modifiers = Modifiers { ctrl: true, shift: false, alt: true };
        let keys = Key::ALL.iter().map(|&key| Trigger::Key { key, modifiers });
        let set = |bits: u32| {
            let held = Button::ALL.into_iter().filter(|button| bits >> *button as u32 & 1 == 1);
            held.fold(Buttons::NONE, Buttons::with)
        };
        let mice = (1..512).map(|bits| Trigger::Mouse { buttons: set(bits), modifiers });
        let plain = Modifiers::default();
        let pads = PadButton::ALL.into_iter().map(|button| Trigger::Pad { button });
        let others = [Trigger::Wheel { modifiers: plain }, Trigger::ShiftTap];
        for trigger in keys.chain(mice).chain(pads).chain(others) {
            assert_eq!(trigger.code().parse(), Ok(trigger));
        }
    }

    #[test]
    fn nonsense_is_refused() {
        for bad in
            ["", "ctrl", "a+b", "left+a", "wheel+left", "hyper+x", "ctrl++", "ctrl+pad-south"]
        {
            assert!(bad.parse::<Trigger>().is_err(), "{bad}");
        }
    }
}
