//! The buttons of mice and pens, and sets of them, with their names in key tables. The tip of a pen is the left button,
//! as everywhere; its other end and the buttons on its barrel are buttons of their own.

use egui::PointerButton;

/// A button that triggers an action over the picture.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Button {
    /// The left button of a mouse, or the tip of a pen.
    Left,
    Right,
    Middle,
    Back,
    Forward,
    /// The end of a pen that erases, on the surface.
    Eraser,
    /// The button on a pen's barrel that is next to its tip.
    PenLower,
    PenUpper,
    PenThird,
}

impl Button {
    pub const ALL: [Button; 9] = [
        Button::Left,
        Button::Right,
        Button::Middle,
        Button::Back,
        Button::Forward,
        Button::Eraser,
        Button::PenLower,
        Button::PenUpper,
        Button::PenThird,
    ];

    /// Returns the name in key tables.
    pub const fn name(self) -> &'static str {
        match self {
            Button::Left => "left",
            Button::Right => "right",
            Button::Middle => "middle",
            Button::Back => "back",
            Button::Forward => "forward",
            Button::Eraser => "eraser",
            Button::PenLower => "pen-lower",
            Button::PenUpper => "pen-upper",
            Button::PenThird => "pen-third",
        }
    }

    /// Returns the name for people, without the word button.
    pub(super) const fn label(self) -> &'static str {
        match self {
            Button::Eraser => "pen's eraser",
            Button::PenLower => "pen's lower",
            Button::PenUpper => "pen's upper",
            Button::PenThird => "pen's third",
            other => other.name(),
        }
    }

    /// Returns whether it is on the barrel of a pen.
    pub const fn is_on_barrel(self) -> bool {
        matches!(self, Button::PenLower | Button::PenUpper | Button::PenThird)
    }
}

impl From<PointerButton> for Button {
    fn from(button: PointerButton) -> Button {
        match button {
            PointerButton::Primary => Button::Left,
            PointerButton::Secondary => Button::Right,
            PointerButton::Middle => Button::Middle,
            PointerButton::Extra1 => Button::Back,
            PointerButton::Extra2 => Button::Forward,
        }
    }
}

/// A set of buttons.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Buttons(u16);

impl Buttons {
    pub const NONE: Buttons = Buttons(0);

    pub fn with(self, button: Button) -> Buttons {
        Buttons(self.0 | 1 << button as u16)
    }

    pub fn without(self, button: Button) -> Buttons {
        Buttons(self.0 & !(1 << button as u16))
    }

    pub fn contains(self, other: Buttons) -> bool {
        self.0 & other.0 == other.0
    }

    pub fn has(self, button: Button) -> bool {
        self.contains(Buttons::NONE.with(button))
    }

    pub fn count(self) -> u32 {
        self.0.count_ones()
    }

    pub fn iter(self) -> impl Iterator<Item = Button> {
        Button::ALL.into_iter().filter(move |button| self.has(*button))
    }

    /// Returns whether it is a single button on the barrel of a pen, which may be bound like a key.
    pub fn is_on_barrel(self) -> bool {
        self.count() == 1 && self.iter().all(Button::is_on_barrel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_hold_what_was_put_in_and_know_the_barrel() {
        let both = Buttons::NONE.with(Button::Left).with(Button::PenThird);
        assert_eq!(both.iter().collect::<Vec<_>>(), [Button::Left, Button::PenThird]);
        assert_eq!(both.without(Button::Left), Buttons::NONE.with(Button::PenThird));
        assert!(!both.is_on_barrel() && both.without(Button::Left).is_on_barrel());
        assert!(
            !Buttons::NONE.is_on_barrel() && !Buttons::NONE.with(Button::Eraser).is_on_barrel()
        );
    }
}
