//! Mouse and keyboard state: turns device events into [`ActionEvent`]s by a key table.
//!
//! A drag is the action of the buttons that are down. A second button pressed during a drag may be bound, together with
//! the first, to an action held on top of the drag, which continues. In this way, the tool can be moved while it is
//! used.

use egui::Key;
use glam::Vec2;

use super::action::{Action, TriggerKind};
use super::bindings::Bindings;
use super::button::Buttons;
use super::events::{DeviceEvent, Modifiers};
use super::pen::PenTouch;
use super::trigger::Trigger;

/// An action, with its position and amount. Positions are in pixels of the viewport.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum ActionEvent {
    /// Happens once.
    Tap(Action),
    /// A drag or a hold begins, at the pointer if there is one.
    Begin {
        action: Action,
        at: Option<Vec2>,
    },
    /// A drag moves.
    Drag {
        action: Action,
        at: Vec2,
        by: Vec2,
    },
    /// A drag or a hold ends.
    End(Action),
    /// The pointer moves with nothing held.
    Hover(Vec2),
    /// The pointer has left the viewport.
    Left,
    Wheel {
        action: Action,
        notches: f32,
        at: Vec2,
    },
    /// The touch of a pen or a finger from here on; `None` for a mouse.
    Touch(Option<PenTouch>),
}

/// The state between events.
#[derive(Debug, Default)]
pub struct Mapper {
    buttons: Buttons,
    drag: Option<Drag>,
    /// The action that several buttons hold together.
    chord: Option<(Buttons, Action)>,
    /// The actions that keys hold.
    keys: Vec<(Key, Action)>,
    at: Option<Vec2>,
}

#[derive(Clone, Copy, Debug)]
struct Drag {
    buttons: Buttons,
    modifiers: Modifiers,
    action: Action,
    at: Vec2,
}

impl Mapper {
    /// Returns whether a button that was pressed in the viewport is still down.
    pub fn captures_pointer(&self) -> bool {
        self.buttons != Buttons::NONE
    }

    /// Returns whether anything is held.
    pub fn is_holding(&self) -> bool {
        self.drag.is_some() || self.chord.is_some() || !self.keys.is_empty()
    }

    /// Appends the events that `event` causes to `actions`.
    pub fn feed(
        &mut self,
        event: &DeviceEvent,
        bindings: &Bindings,
        actions: &mut Vec<ActionEvent>,
    ) {
        match *event {
            DeviceEvent::Moved { at, modifiers } => self.moved(at, modifiers, bindings, actions),
            DeviceEvent::Left => {
                if self.at.take().is_some() && !self.captures_pointer() {
                    actions.push(ActionEvent::Left);
                }
            }
            DeviceEvent::Pressed { button, at, modifiers } => {
                self.at = Some(at);
                self.buttons = self.buttons.with(button);
                self.buttons_changed(at, modifiers, bindings, actions);
            }
            DeviceEvent::Released { button } => {
                self.buttons = self.buttons.without(button);
                self.end_released(actions);
            }
            DeviceEvent::Wheel { notches, at, modifiers } => {
                let action = bindings.action(Trigger::Wheel { modifiers });
                actions.extend(action.map(|action| ActionEvent::Wheel { action, notches, at }));
            }
            DeviceEvent::KeyPressed { key, place, modifiers, repeat } => {
                let action = bindings.action_of_key(key, place, modifiers);
                self.key_pressed(key, action, repeat, actions);
            }
            DeviceEvent::KeyReleased { key } => {
                if let Some(held) = self.keys.iter().position(|(k, _)| *k == key) {
                    actions.push(ActionEvent::End(self.keys.remove(held).1));
                }
            }
            DeviceEvent::Touch(touch) => actions.push(ActionEvent::Touch(touch)),
            DeviceEvent::FocusLost => {
                self.buttons = Buttons::NONE;
                self.end_released(actions);
                actions.extend(self.keys.drain(..).map(|(_, action)| ActionEvent::End(action)));
            }
        }
    }

    fn moved(
        &mut self,
        at: Vec2,
        modifiers: Modifiers,
        bindings: &Bindings,
        actions: &mut Vec<ActionEvent>,
    ) {
        self.at = Some(at);
        let Some(mut drag) = self.drag else {
            if !self.captures_pointer() {
                actions.push(ActionEvent::Hover(at));
            }
            return;
        };
        let by = at - drag.at;
        drag.at = at;
        if modifiers != drag.modifiers && !drag.action.is_stroke() {
            drag.modifiers = modifiers;
            let trigger = Trigger::Mouse { buttons: drag.buttons, modifiers };
            if let Some(other) = bindings.action(trigger).filter(|a| is_glide(*a, drag.action)) {
                actions.push(ActionEvent::End(drag.action));
                actions.push(ActionEvent::Begin { action: other, at: Some(at) });
                drag.action = other;
            }
        }
        self.drag = Some(drag);
        actions.push(ActionEvent::Drag { action: drag.action, at, by });
    }

    fn buttons_changed(
        &mut self,
        at: Vec2,
        modifiers: Modifiers,
        bindings: &Bindings,
        actions: &mut Vec<ActionEvent>,
    ) {
        let trigger = Trigger::Mouse { buttons: self.buttons, modifiers };
        let Some(action) = bindings.action(trigger) else { return };
        match action.help().kind {
            TriggerKind::Drag if self.drag.is_none() => {
                self.drag = Some(Drag { buttons: self.buttons, modifiers, action, at });
                actions.push(ActionEvent::Begin { action, at: Some(at) });
            }
            TriggerKind::Hold if self.chord.is_none() => {
                self.chord = Some((self.buttons, action));
                actions.push(ActionEvent::Begin { action, at: Some(at) });
            }
            TriggerKind::Tap => actions.push(ActionEvent::Tap(action)),
            _ => {}
        }
    }

    /// Ends the actions of a released button.
    fn end_released(&mut self, actions: &mut Vec<ActionEvent>) {
        if let Some((_, action)) = self.chord.take_if(|(needs, _)| !self.buttons.contains(*needs)) {
            actions.push(ActionEvent::End(action));
        }
        if let Some(drag) = self.drag.take_if(|drag| !self.buttons.contains(drag.buttons)) {
            actions.push(ActionEvent::End(drag.action));
        }
    }

    fn key_pressed(
        &mut self,
        key: Key,
        action: Option<Action>,
        repeat: bool,
        actions: &mut Vec<ActionEvent>,
    ) {
        let Some(action) = action else { return };
        let held = self.keys.iter().any(|(k, _)| *k == key);
        if action.help().kind == TriggerKind::Hold {
            if !held && !repeat {
                self.keys.push((key, action));
                actions.push(ActionEvent::Begin { action, at: self.at });
            }
        } else if !repeat || action.repeats() {
            actions.push(ActionEvent::Tap(action));
        }
    }
}

/// Returns whether a running drag may change to `next`.
fn is_glide(next: Action, now: Action) -> bool {
    next != now && next.help().kind == TriggerKind::Drag && !next.is_stroke()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Button::{self, Left, Right};

    const NONE: Modifiers = Modifiers { ctrl: false, shift: false, alt: false };
    const CTRL: Modifiers = Modifiers { ctrl: true, ..NONE };

    fn preset(name: &str) -> Bindings {
        Bindings::presets().unwrap().into_iter().find(|b| b.name == name).unwrap()
    }

    fn run(bindings: &Bindings, events: &[DeviceEvent]) -> Vec<ActionEvent> {
        let (mut mapper, mut actions) = (Mapper::default(), Vec::new());
        events.iter().for_each(|event| mapper.feed(event, bindings, &mut actions));
        actions
    }

    fn moved(x: f32, modifiers: Modifiers) -> DeviceEvent {
        DeviceEvent::Moved { at: Vec2::new(x, 0.0), modifiers }
    }

    fn pressed(button: Button, x: f32, modifiers: Modifiers) -> DeviceEvent {
        DeviceEvent::Pressed { button, at: Vec2::new(x, 0.0), modifiers }
    }

    fn key(key: Key, modifiers: Modifiers, repeat: bool) -> DeviceEvent {
        DeviceEvent::KeyPressed { key, place: None, modifiers, repeat }
    }

    #[test]
    fn a_drag_runs_from_press_to_release() {
        let at = |x| Vec2::new(x, 0.0);
        let actions = run(
            &preset("direct"),
            &[
                moved(1.0, NONE),
                pressed(Left, 2.0, NONE),
                moved(5.0, NONE),
                DeviceEvent::Released { button: Left },
                moved(6.0, NONE),
            ],
        );
        let action = Action::Sculpt;
        assert_eq!(
            actions,
            [
                ActionEvent::Hover(at(1.0)),
                ActionEvent::Begin { action, at: Some(at(2.0)) },
                ActionEvent::Drag { action, at: at(5.0), by: at(3.0) },
                ActionEvent::End(action),
                ActionEvent::Hover(at(6.0)),
            ]
        );
    }

    #[test]
    fn both_buttons_use_the_tool_while_it_is_moved() {
        let actions = run(
            &preset("thesis"),
            &[
                pressed(Left, 0.0, NONE),
                pressed(Right, 0.0, NONE),
                moved(4.0, NONE),
                DeviceEvent::Released { button: Right },
                moved(5.0, CTRL),
                DeviceEvent::Released { button: Left },
            ],
        );
        let kinds: Vec<_> = actions
            .iter()
            .map(|event| match *event {
                ActionEvent::Begin { action, .. } => ("begin", action),
                ActionEvent::Drag { action, .. } => ("drag", action),
                ActionEvent::End(action) => ("end", action),
                _ => panic!("{event:?}"),
            })
            .collect();
        assert_eq!(
            kinds,
            [
                ("begin", Action::MoveTool),
                ("begin", Action::Apply),
                ("drag", Action::MoveTool),
                ("end", Action::Apply),
                // Ctrl changes X/Y to X/Z during the drag.
                ("end", Action::MoveTool),
                ("begin", Action::MoveToolDeep),
                ("drag", Action::MoveToolDeep),
                ("end", Action::MoveToolDeep),
            ]
        );
    }

    #[test]
    fn a_pen_erases_turns_the_view_and_may_undo() {
        use Button::{Eraser, PenLower, PenUpper};
        let mut mine = preset("direct");
        let undo = "pen-upper".parse().unwrap();
        mine.bind(undo, Action::Undo).unwrap();
        let release = |button| DeviceEvent::Released { button };
        let actions = run(
            &mine,
            &[
                pressed(Eraser, 0.0, NONE),
                release(Eraser),
                pressed(PenLower, 0.0, NONE),
                release(PenLower),
                pressed(PenUpper, 0.0, NONE),
                release(PenUpper),
            ],
        );
        let at = Some(Vec2::ZERO);
        assert_eq!(
            actions,
            [
                ActionEvent::Begin { action: Action::SculptInverse, at },
                ActionEvent::End(Action::SculptInverse),
                ActionEvent::Begin { action: Action::TurnSculpture, at },
                ActionEvent::End(Action::TurnSculpture),
                ActionEvent::Tap(Action::Undo),
            ]
        );
        // A mouse has no spare button for a tap, nor has the eraser.
        for other in ["right", "eraser"] {
            assert!(mine.bind(other.parse().unwrap(), Action::Undo).is_err(), "{other}");
        }
    }

    #[test]
    fn a_modifier_does_not_break_a_stroke() {
        let alt = Modifiers { alt: true, ..NONE };
        let actions = run(&preset("direct"), &[pressed(Left, 0.0, NONE), moved(1.0, alt)]);
        assert!(matches!(actions[1], ActionEvent::Drag { action: Action::Sculpt, .. }));
    }

    #[test]
    fn keys_tap_hold_and_repeat() {
        let actions = run(
            &preset("direct"),
            &[
                key(Key::Z, CTRL, false),
                key(Key::Z, CTRL, true),
                key(Key::E, NONE, true),
                key(Key::Space, NONE, false),
                key(Key::Space, NONE, true),
                DeviceEvent::KeyReleased { key: Key::Space },
            ],
        );
        assert_eq!(
            actions,
            [
                ActionEvent::Tap(Action::Undo),
                ActionEvent::Tap(Action::Undo),
                ActionEvent::Begin { action: Action::Apply, at: None },
                ActionEvent::End(Action::Apply),
            ]
        );
    }

    #[test]
    fn losing_the_focus_releases_everything() {
        let bindings = preset("direct");
        let (mut mapper, mut actions) = (Mapper::default(), Vec::new());
        for event in
            [key(Key::Space, NONE, false), pressed(Left, 0.0, NONE), DeviceEvent::FocusLost]
        {
            mapper.feed(&event, &bindings, &mut actions);
        }
        assert!(!mapper.is_holding() && !mapper.captures_pointer());
        assert!(actions.contains(&ActionEvent::End(Action::Apply)));
        assert!(actions.contains(&ActionEvent::End(Action::Sculpt)));
    }
}
