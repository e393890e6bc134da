//! From device events to action events: the key tables with their file, the keys held in each window,
//! and the gamepads.
//!
//! [`Controls`] takes device events and gamepad states as values and returns [`ActionEvent`]s, which are
//! interpreted elsewhere. Knows no sculpture and no window.

mod key_file;
pub mod pads;

use std::collections::BTreeMap;

use crate::input::pad::device::PadNews;
use crate::input::pad::shift_tap::ShiftTap;
use crate::input::pad::{GamepadOptions, PadEvent};
use crate::input::trigger::Trigger;
use crate::input::{Action, ActionEvent, Bindings, DeviceEvent, Mapper, Panel};

use key_file::KeyFile;
use pads::{PadReport, Pads};

/// Everything that turns input into action events.
pub struct Controls {
    /// The key tables with the person's changes.
    presets: Vec<Bindings>,
    /// The key tables as shipped.
    pristine: Vec<Bindings>,
    /// Index of the table in use.
    pub preset: usize,
    /// The file for changes to the tables, if there is one.
    key_file: Option<KeyFile>,
    /// Keys and buttons held in the main window.
    mapper: Mapper,
    /// Keys held in the windows of panels.
    panel_mappers: BTreeMap<Panel, Mapper>,
    shift_tap: ShiftTap,
    pub pads: Pads,
}

impl Controls {
    pub fn new(presets: Vec<Bindings>, gamepad: &GamepadOptions) -> Controls {
        Controls {
            pristine: presets.clone(),
            presets,
            preset: 0,
            key_file: None,
            mapper: Mapper::default(),
            panel_mappers: BTreeMap::new(),
            shift_tap: ShiftTap::default(),
            pads: Pads::new(gamepad),
        }
    }

    /// Returns the tables to choose from.
    pub fn presets(&self) -> &[Bindings] {
        &self.presets
    }

    /// Returns the key tables as shipped.
    pub fn pristine(&self) -> &[Bindings] {
        &self.pristine
    }

    /// Returns the table in use.
    pub fn bindings(&self) -> Option<&Bindings> {
        self.presets.get(self.preset)
    }

    /// Returns whether a drag over the picture is in progress.
    pub fn is_dragging(&self) -> bool {
        self.mapper.captures_pointer()
    }

    /// Returns whether the tool follows the pointer: in a table without `Sculpt` only drags move it.
    pub fn tool_follows_pointer(&self) -> bool {
        let table = self.bindings();
        table.is_some_and(|bindings| bindings.triggers(Action::Sculpt).next().is_some())
    }

    /// Returns the action events for the device events of a window: a panel's, or the main one. Each window has its own
    /// held keys, so that losing the focus releases only those.
    pub fn handle(&mut self, panel: Option<Panel>, events: &[DeviceEvent]) -> Vec<ActionEvent> {
        let Some(bindings) = self.presets.get(self.preset) else { return Vec::new() };
        let mapper = match panel {
            Some(panel) => self.panel_mappers.entry(panel).or_default(),
            None => &mut self.mapper,
        };
        let mut actions = Vec::new();
        for event in events {
            mapper.feed(event, bindings, &mut actions);
        }
        // Only the last of several moves without a button matters.
        actions.dedup_by(|later, earlier| {
            let is_hover = |event: &ActionEvent| matches!(event, ActionEvent::Hover(_));
            let overtaken = is_hover(later) && is_hover(earlier);
            if overtaken {
                std::mem::swap(later, earlier);
            }
            overtaken
        });
        actions
    }

    /// Returns the action bound to a tap of Shift, once for each tap.
    pub fn take_shift_taps(&mut self, events: &[egui::Event]) -> Vec<Action> {
        let taps = events.iter().filter(|event| self.shift_tap.feed(event)).count();
        let action = self.bindings().and_then(|bindings| bindings.action(Trigger::ShiftTap));
        action.into_iter().cycle().take(if action.is_some() { taps } else { 0 }).collect()
    }

    /// Handles an event of a gamepad; see [`Pads::handle`].
    pub fn handle_pad(&mut self, news: PadNews, now_s: f64, catching: bool) -> PadReport {
        self.pads.handle(news, now_s, self.presets.get(self.preset), catching)
    }

    /// Returns the gamepads' events up to `now_s`, in order.
    pub fn take_pad_events(&mut self, now_s: f64) -> Vec<PadEvent> {
        let bindings = self.presets.get(self.preset);
        bindings.map_or(Vec::new(), |bindings| self.pads.take(now_s, bindings))
    }

    /// Releases the keys held in the window of a panel that was closed.
    pub fn panel_closed(&mut self, panel: Panel) -> Vec<ActionEvent> {
        let released = self.handle(Some(panel), &[DeviceEvent::FocusLost]);
        self.panel_mappers.remove(&panel);
        released
    }
}
