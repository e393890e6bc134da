//! Waits for a new trigger for an action. The next key or button is taken before any widget sees it, then refused,
//! queried, or assigned to the action.

use egui::{Id, Modal, Ui};

use crate::input::action::TriggerKind;
use crate::input::listener::{CapturedInput, Listener};
use crate::input::remap::KeyChange;
use crate::input::{Action, Bindings, Trigger};
use crate::ui::context::UiContext;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::names::capital;
use crate::ui::widgets::theme;

/// An action waiting for a trigger.
#[derive(Clone, PartialEq, Debug)]
struct Catch {
    action: Action,
    step: CatchStep,
}

#[derive(Clone, PartialEq, Debug)]
enum CatchStep {
    /// With the reason why the last trigger was refused.
    Listen(Listener, Option<String>),
    /// The trigger belongs to the other action now.
    Ask(Trigger, Action),
}

impl Catch {
    fn new(action: Action) -> Catch {
        Catch { action, step: CatchStep::Listen(Listener::default(), None) }
    }

    /// Handles a trigger. Returns the change, if there is nothing to ask, and whether the wait is over.
    fn take(&mut self, heard: CapturedInput, bindings: &Bindings) -> (Option<KeyChange>, bool) {
        let CapturedInput::Trigger(trigger) = heard else { return (None, true) };
        if let Err(unfit) = Bindings::fits(trigger, self.action) {
            let refusal = capital(&unfit.to_string());
            self.step = CatchStep::Listen(Listener::default(), Some(refusal));
            return (None, false);
        }
        match bindings.conflict(trigger, self.action) {
            Some(other) => {
                self.step = CatchStep::Ask(trigger, other);
                (None, false)
            }
            None => (Some(KeyChange::Bind(trigger, self.action)), true),
        }
    }
}

/// The action that gets the next key or button, if one waits.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct KeyCatch {
    waiting: Option<Catch>,
    /// A trigger from another device since the last pass.
    pressed: Option<Trigger>,
}

impl KeyCatch {
    /// Waits for a trigger for `action`.
    pub fn listen_for(&mut self, action: Action) {
        self.waiting = Some(Catch::new(action));
    }

    /// Takes a trigger from a device other than keyboard and mouse, if one is awaited.
    pub fn hear(&mut self, trigger: Option<Trigger>) {
        self.pressed = trigger.or(self.pressed);
    }
}

/// Takes the awaited trigger from keyboard and mouse and hides it from all widgets. Called before any of them is shown.
pub fn listen(root: &Ui, keys: &mut KeyCatch, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let Some(bindings) = context.bindings() else { return };
    let pressed = keys.pressed.take().map(CapturedInput::Trigger);
    let Some(catch) = &mut keys.waiting else { return };
    if !matches!(catch.step, CatchStep::Listen(..)) {
        return;
    }
    root.ctx().memory_mut(|memory| {
        if let Some(focused) = memory.focused() {
            memory.surrender_focus(focused);
        }
    });
    let events = root.ctx().input_mut(|input| std::mem::take(&mut input.events));
    let mut events = events.iter();
    let mut next = pressed;
    loop {
        let CatchStep::Listen(listener, _) = &mut catch.step else { return };
        let Some(heard) = next.take().or_else(|| events.find_map(|event| listener.hear(event)))
        else {
            return;
        };
        let (change, over) = catch.take(heard, bindings);
        requests.extend(change.map(UiRequest::Keys));
        if over {
            keys.waiting = None;
            return;
        }
    }
}

/// Shows that a trigger is awaited, or asks which action a trigger should belong to.
impl Dialog for KeyCatch {
    fn is_open(&self) -> bool {
        self.waiting.is_some()
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let Some(catch) = &self.waiting else { return };
        let mut over = false;
        let response = Modal::new(Id::new("key catch")).show(root.ctx(), |ui| {
            ui.set_width(360.0);
            ui.heading(catch.action.help().text);
            ui.add_space(4.0);
            match &catch.step {
                CatchStep::Listen(_, refusal) => {
                    ui.label(wish(catch.action.help().kind));
                    if let Some(refusal) = refusal {
                        ui.colored_label(theme::error_colour(ui.visuals()), format!("{refusal}."));
                    }
                    ui.weak("Press Escape to cancel.");
                }
                CatchStep::Ask(trigger, other) => {
                    let text = capital(&trigger.to_string());
                    ui.label(format!("{text} is already assigned to: {}.", other.help().text));
                    ui.add_space(8.0);
                    ui.horizontal(|ui| {
                        if ui.add(theme::primary(ui.visuals(), "Reassign")).clicked() {
                            let change = KeyChange::Bind(*trigger, catch.action);
                            shared.requests.push(UiRequest::Keys(change));
                            over = true;
                        }
                        over |= ui.button("Cancel").clicked();
                    });
                }
            }
        });
        let asking = matches!(catch.step, CatchStep::Ask(..));
        // While it waits, a click anywhere is an answer.
        if over || asking && response.should_close() {
            self.waiting = None;
        }
    }
}

fn wish(kind: TriggerKind) -> &'static str {
    match kind {
        TriggerKind::Tap => {
            "Press a key, with Ctrl, Shift or Alt if you like, a gamepad button or a button of a pen."
        }
        TriggerKind::Hold => {
            "Press a key, a button of a pen, or several mouse buttons together, with Ctrl, Shift or Alt if you like."
        }
        TriggerKind::Drag => {
            "Click a mouse button, or one of a pen or its eraser, with Ctrl, Shift or Alt if you like."
        }
        TriggerKind::Wheel => "Turn the mouse wheel, with Ctrl, Shift or Alt if you like.",
    }
}
