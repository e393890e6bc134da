//! Pens over the main window: what they do beside the pointer that they lead.

use egui::Context;

use super::Workspace;
use crate::input::pen::{PenSample, PenTouch};
use crate::input::{Buttons, Trigger};

impl Workspace {
    /// Takes what pens have done over the main window, in its pixels. Their pointer comes with the events of the window.
    pub fn hear_pens(&mut self, samples: &[PenSample]) {
        self.ui.pen.is_used |= !samples.is_empty();
        samples.iter().for_each(|sample| self.pens.push(sample));
    }

    /// Takes which tablets and pens there are.
    pub fn know_pens(&mut self, names: Vec<String>) {
        self.ui.pen.devices = names;
    }

    /// Takes how a pen or a finger touches from here on.
    pub(in crate::app) fn touched(&mut self, touch: Option<PenTouch>) {
        self.ui.pen.is_used |= touch.is_some();
        self.ui.pen.touch = touch;
        let curve = self.ui.pen.curve;
        let counted = |touch: PenTouch| PenTouch { pressure: curve.of(touch.pressure), ..touch };
        self.editor.set_touch(touch.map(counted));
    }

    /// A trigger that is awaited may be a button of a pen, which is another one to egui.
    pub(super) fn hear_pen_buttons(&mut self, ctx: &Context) {
        let Some(button) = self.pens.take_heard() else { return };
        if self.ui.dialogs.keys.is_catching() {
            let modifiers = ctx.input(|input| input.modifiers).into();
            let buttons = Buttons::NONE.with(button);
            self.ui.dialogs.keys.hear(Some(Trigger::Mouse { buttons, modifiers }));
        }
    }
}
