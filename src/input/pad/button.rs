//! The buttons of a gamepad: their names in key tables, by position so that they fit every pad
//! (`pad-south` is A on an Xbox pad, the cross on a PlayStation's), and sets of them.

/// A button. The numbers in the comments are those of the pads used in 2005.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[repr(u8)]
pub enum PadButton {
    /// 1: A, cross.
    South,
    /// 2: B, circle.
    East,
    /// 3: X, square.
    West,
    /// 4: Y, triangle.
    North,
    /// 5: the upper left shoulder.
    LeftShoulder,
    /// 6: the upper right shoulder.
    RightShoulder,
    /// 7: the lower left shoulder, an analog trigger on most pads.
    LeftTrigger,
    /// 8: the lower right shoulder.
    RightTrigger,
    Select,
    Start,
    /// The left stick pressed down.
    LeftStick,
    RightStick,
    DpadLeft,
    DpadRight,
    DpadUp,
    DpadDown,
}

impl PadButton {
    pub const ALL: [PadButton; 16] = [
        PadButton::South,
        PadButton::East,
        PadButton::West,
        PadButton::North,
        PadButton::LeftShoulder,
        PadButton::RightShoulder,
        PadButton::LeftTrigger,
        PadButton::RightTrigger,
        PadButton::Select,
        PadButton::Start,
        PadButton::LeftStick,
        PadButton::RightStick,
        PadButton::DpadLeft,
        PadButton::DpadRight,
        PadButton::DpadUp,
        PadButton::DpadDown,
    ];

    /// Returns the name in key tables.
    pub const fn name(self) -> &'static str {
        match self {
            PadButton::South => "pad-south",
            PadButton::East => "pad-east",
            PadButton::West => "pad-west",
            PadButton::North => "pad-north",
            PadButton::LeftShoulder => "pad-left-shoulder",
            PadButton::RightShoulder => "pad-right-shoulder",
            PadButton::LeftTrigger => "pad-left-trigger",
            PadButton::RightTrigger => "pad-right-trigger",
            PadButton::Select => "pad-select",
            PadButton::Start => "pad-start",
            PadButton::LeftStick => "pad-left-stick",
            PadButton::RightStick => "pad-right-stick",
            PadButton::DpadLeft => "pad-dpad-left",
            PadButton::DpadRight => "pad-dpad-right",
            PadButton::DpadUp => "pad-dpad-up",
            PadButton::DpadDown => "pad-dpad-down",
        }
    }

    /// Returns the text shown to people.
    pub const fn label(self) -> &'static str {
        match self {
            PadButton::South => "gamepad A",
            PadButton::East => "gamepad B",
            PadButton::West => "gamepad X",
            PadButton::North => "gamepad Y",
            PadButton::LeftShoulder => "gamepad left shoulder",
            PadButton::RightShoulder => "gamepad right shoulder",
            PadButton::LeftTrigger => "gamepad left trigger",
            PadButton::RightTrigger => "gamepad right trigger",
            PadButton::Select => "gamepad select",
            PadButton::Start => "gamepad start",
            PadButton::LeftStick => "gamepad left stick click",
            PadButton::RightStick => "gamepad right stick click",
            PadButton::DpadLeft => "gamepad D-pad left",
            PadButton::DpadRight => "gamepad D-pad right",
            PadButton::DpadUp => "gamepad D-pad up",
            PadButton::DpadDown => "gamepad D-pad down",
        }
    }

    /// Returns the button with a name in key tables.
    pub fn named(name: &str) -> Option<PadButton> {
        PadButton::ALL.into_iter().find(|button| button.name() == name)
    }
}

/// A set of buttons.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct PadButtons(u16);

impl PadButtons {
    pub const NONE: PadButtons = PadButtons(0);

    pub fn with(self, button: PadButton) -> PadButtons {
        PadButtons(self.0 | 1 << button as u8)
    }

    pub fn contains(self, button: PadButton) -> bool {
        self.0 & 1 << button as u8 != 0
    }

    /// Returns the buttons of this set that are not in another.
    pub fn without(self, other: PadButtons) -> impl Iterator<Item = PadButton> {
        let rest = PadButtons(self.0 & !other.0);
        PadButton::ALL.into_iter().filter(move |button| rest.contains(*button))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_and_sets_tell_what_is_new() {
        for button in PadButton::ALL {
            assert_eq!(PadButton::named(button.name()), Some(button));
            assert!(PadButtons::NONE.with(button).contains(button));
        }
        assert_eq!(PadButton::named("south"), None);
        let (a, b) = (PadButton::South, PadButton::DpadDown);
        let both = PadButtons::NONE.with(a).with(b);
        assert_eq!(both.without(PadButtons::NONE.with(a)).collect::<Vec<_>>(), [b]);
        assert_eq!(PadButtons::NONE.without(both).count(), 0);
    }
}
