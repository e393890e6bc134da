//! Decides which keys of a pass go to the sculpture, and which to fields, buttons, lists and dialogs.
//!
//! Takes egui's state and whether a dialog asks for an answer; gives the keys that the viewport may use. Must not know
//! what the keys do.
//!
//! A field takes all keys; a focused button only Enter and Space; a slider the arrows, too; an open list Escape. After
//! a dialog or a field, keys that confirm or close are ignored until the pointer has been used over the picture, since
//! the hand may press once too often.

use egui::{Context, Event, EventFilter, Id, Key, Popup, Pos2};

use crate::input::events::KeptKeys;

/// The former owner of the keyboard, until the pointer is used over the picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
enum After {
    #[default]
    Nothing,
    /// A field, which Enter leaves.
    Field,
    /// A dialog or a button, which Enter or Space may have closed.
    Dialog,
}

/// The owner of the keyboard in one window.
#[derive(Clone, Debug, Default)]
pub struct KeyFocus {
    after: After,
    /// Position of the pointer when that last had the keyboard.
    pointer: Option<Pos2>,
    /// The widget that had the focus in the last pass.
    focused: Option<Id>,
}

/// The keys that go to the viewport in a pass.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HeardKeys {
    /// Whether it receives keys at all.
    pub keyboard: bool,
    pub kept: KeptKeys,
}

/// State of the program that egui does not know.
#[derive(Clone, Copy, Debug)]
pub struct Around {
    /// A dialog asks for an answer.
    pub asking: bool,
    /// A dialog asks, or exclusive work runs.
    pub modal: bool,
    /// Escape still has a window to close.
    pub closable: bool,
    /// The pointer is over the picture.
    pub hovered: bool,
}

impl KeyFocus {
    /// Determines the owner of the keyboard in this pass. Called once per pass, before anything is shown.
    pub fn pass(&mut self, ctx: &Context, around: Around) -> HeardKeys {
        let focused = ctx.memory(|memory| memory.focused());
        // A widget with new focus becomes a field only when it is shown.
        let is_new = focused.is_some() && focused != self.focused;
        self.focused = focused;
        let is_field = focused.is_some() && (is_new || ctx.text_edit_focused());
        let listed = Popup::is_any_open(ctx);
        let pointer = ctx.input(|input| input.pointer.latest_pos());
        let confirmed = focused.is_some() && !is_field && ctx.input(confirms);
        if around.asking || confirmed {
            (self.after, self.pointer) = (After::Dialog, pointer);
        } else if is_field {
            (self.after, self.pointer) = (self.after.max(After::Field), pointer);
        } else if around.hovered && (pointer != self.pointer || ctx.input(is_used)) {
            self.after = After::Nothing;
        }
        // A slider can be dragged, a button cannot.
        let slides = focused
            .and_then(|id| ctx.read_response(id))
            .is_some_and(|response| response.sense.senses_drag());
        if let Some(id) = focused.filter(|_| !is_field && !slides && !listed && !around.modal) {
            let arrows = EventFilter {
                horizontal_arrows: true,
                vertical_arrows: true,
                ..Default::default()
            };
            ctx.memory_mut(|memory| memory.set_focus_lock_filter(id, arrows));
        }
        HeardKeys {
            keyboard: !around.modal && !is_field,
            kept: KeptKeys {
                enter: focused.is_some() || listed || self.after != After::Nothing,
                space: focused.is_some() || listed || self.after == After::Dialog,
                arrows: focused.is_some() && slides || listed,
                escape: listed || self.after == After::Dialog && !around.closable,
            },
        }
    }
}

impl After {
    fn max(self, other: After) -> After {
        if self == After::Dialog { self } else { other }
    }
}

/// Returns whether a key is pressed that activates a button.
fn confirms(input: &egui::InputState) -> bool {
    input.key_pressed(Key::Enter) || input.key_pressed(Key::Space)
}

/// Returns whether the pointer does more than rest.
fn is_used(input: &egui::InputState) -> bool {
    input.events.iter().any(|event| {
        matches!(event, Event::PointerButton { pressed: true, .. } | Event::MouseWheel { .. })
    })
}
