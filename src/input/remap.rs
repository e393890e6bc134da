//! Changes to key tables: binding a trigger to an action, removing it, resetting to the preset; and
//! the differences of a table from its preset, as lines of text.
//!
//! A trigger is never bound to two actions: binding it to one removes it from the other.

use std::fmt;

use super::action::Action;
use super::bindings::{BindingLines, Bindings, check_kind};
use super::trigger::Trigger;

/// A trigger that does not fit an action, with one that does; shown as a sentence.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Unfit {
    pub trigger: Trigger,
    pub needs: &'static str,
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} cannot trigger this action; it needs {}", self.trigger, self.needs)
    }
}

/// A change to a table.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum KeyChange {
    Bind(Trigger, Action),
    Unbind(Trigger),
    /// Reset one action to the preset.
    Reset(Action),
    /// Reset the whole table to the preset.
    ResetAll,
}

impl Bindings {
    /// Changes this table, which came from `preset`.
    pub fn change(&mut self, change: KeyChange, preset: &Bindings) -> Result<(), Unfit> {
        match change {
            KeyChange::Bind(trigger, action) => self.bind(trigger, action).map(drop),
            KeyChange::Unbind(trigger) => {
                self.unbind(trigger);
                Ok(())
            }
            KeyChange::Reset(action) => {
                self.reset(action, preset);
                Ok(())
            }
            KeyChange::ResetAll => {
                self.clone_from(preset);
                Ok(())
            }
        }
    }

    /// Checks that `trigger` fits `action`.
    pub fn fits(trigger: Trigger, action: Action) -> Result<(), Unfit> {
        check_kind(action.help().kind, trigger).map_err(|needs| Unfit { trigger, needs })
    }

    /// Returns the other action that `trigger` is bound to.
    pub fn conflict(&self, trigger: Trigger, action: Action) -> Option<Action> {
        self.action(trigger).filter(|other| *other != action)
    }

    /// Binds `trigger` to `action`, as its last one. Returns the action that loses it.
    pub fn bind(&mut self, trigger: Trigger, action: Action) -> Result<Option<Action>, Unfit> {
        Bindings::fits(trigger, action)?;
        if self.action(trigger) == Some(action) {
            return Ok(None);
        }
        let former = self.unbind(trigger);
        self.table.push((trigger, action));
        super::bindings::sort(&mut self.table);
        Ok(former)
    }

    /// Unbinds `trigger` and returns its action.
    pub fn unbind(&mut self, trigger: Trigger) -> Option<Action> {
        let at = self.table.iter().position(|(bound, _)| *bound == trigger)?;
        Some(self.table.remove(at).1)
    }

    /// Resets the triggers of `action` to those in `preset`; other actions lose them.
    pub fn reset(&mut self, action: Action, preset: &Bindings) {
        self.table
            .retain(|(trigger, bound)| *bound != action && preset.action(*trigger) != Some(action));
        self.table.extend(preset.triggers(action).map(|trigger| (trigger, action)));
        super::bindings::sort(&mut self.table);
    }

    /// Returns whether the triggers of `action` differ from those in `preset`.
    pub fn differs(&self, action: Action, preset: &Bindings) -> bool {
        !self.triggers(action).eq(preset.triggers(action))
    }

    /// Returns the lines that turn `preset` into this table; an action without triggers has an empty line.
    pub fn lines_since(&self, preset: &Bindings) -> BindingLines {
        let changed = Action::ALL.iter().filter(|action| self.differs(**action, preset));
        changed
            .map(|&action| {
                let triggers = self.triggers(action).map(Trigger::code).collect();
                (action.help().name.to_string(), triggers)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn presets() -> Vec<Bindings> {
        Bindings::presets().unwrap()
    }

    fn trigger(text: &str) -> Trigger {
        text.parse().unwrap()
    }

    #[test]
    fn a_trigger_goes_from_one_action_to_another_and_back() {
        let preset = &presets()[0];
        let mut mine = preset.clone();
        let z = trigger("ctrl+z");
        assert_eq!(mine.conflict(z, Action::Fill), Some(Action::Undo));
        assert_eq!(mine.conflict(z, Action::Undo), None);
        assert_eq!(mine.bind(z, Action::Fill), Ok(Some(Action::Undo)));
        assert_eq!(mine.action(z), Some(Action::Fill));
        assert!(mine.triggers(Action::Undo).all(|trigger| trigger != z));
        assert!(mine.differs(Action::Undo, preset) && mine.differs(Action::Fill, preset));
        mine.reset(Action::Undo, preset);
        assert_eq!(mine.action(z), Some(Action::Undo));
        assert_eq!(mine, *preset);
        assert!(mine.lines_since(preset).is_empty());
        assert_eq!(mine.unbind(z), Some(Action::Undo));
        assert_eq!(
            mine.lines_since(preset),
            [("undo".to_string(), vec!["pad-dpad-left".to_string()])].into()
        );
    }

    #[test]
    fn an_unfit_trigger_is_refused_with_a_reason_and_changes_nothing() {
        let mut mine = presets().remove(0);
        let before = mine.clone();
        let unfit = mine.bind(trigger("ctrl+wheel"), Action::Undo).unwrap_err();
        assert_eq!(
            unfit.to_string(),
            "Ctrl+wheel cannot trigger this action; it needs a key, a gamepad button or a button of a pen"
        );
        assert!(mine.bind(trigger("z"), Action::Zoom).is_err());
        assert!(mine.bind(trigger("left"), Action::Apply).is_err());
        assert_eq!(mine, before);
    }

    fn any_trigger() -> impl Strategy<Value = Trigger> {
        let words = prop::sample::select(vec![
            "a",
            "z",
            "7",
            "f5",
            "[",
            "plus",
            "minus",
            "space",
            "arrowleft",
            "pagedown",
            "pad-south",
            "shift-tap",
            "quote",
            "backslash",
            "left",
            "right",
            "left+right",
            "middle+back",
            "wheel",
        ]);
        let modifiers = prop::sample::select(vec!["", "ctrl+", "shift+", "ctrl+alt+"]);
        (modifiers, words).prop_map(|(modifiers, word)| {
            let alone = word.contains("-");
            trigger(&if alone { word.to_string() } else { format!("{modifiers}{word}") })
        })
    }

    #[derive(Clone, Debug)]
    enum Change {
        Bind(Trigger, Action),
        Unbind(Trigger),
        Reset(Action),
    }

    fn any_change() -> impl Strategy<Value = Change> {
        let action = || prop::sample::select(Action::ALL.to_vec());
        prop_oneof![
            4 => (any_trigger(), action()).prop_map(|(t, a)| Change::Bind(t, a)),
            1 => any_trigger().prop_map(Change::Unbind),
            1 => action().prop_map(Change::Reset),
        ]
    }

    proptest! {
        #[test]
        fn changed_tables_are_sound_and_come_back_from_their_lines(
            preset in 0..4_usize,
            changes in prop::collection::vec(any_change(), 0..40),
        ) {
            let preset = &presets()[preset];
            let mut mine = preset.clone();
            for change in changes {
                match change {
                    Change::Bind(trigger, action) => {
                        let fits = Bindings::fits(trigger, action).is_ok();
                        prop_assert_eq!(mine.bind(trigger, action).is_ok(), fits);
                        prop_assert!(!fits || mine.action(trigger) == Some(action));
                    }
                    Change::Unbind(trigger) => {
                        mine.unbind(trigger);
                        prop_assert_eq!(mine.action(trigger), None);
                    }
                    Change::Reset(action) => {
                        mine.reset(action, preset);
                        prop_assert!(!mine.differs(action, preset));
                    }
                }
                for (i, (trigger, _)) in mine.table.iter().enumerate() {
                    prop_assert!(mine.table[..i].iter().all(|(other, _)| other != trigger));
                }
            }
            prop_assert_eq!(preset.with_lines(&mine.lines_since(preset)).unwrap(), mine);
        }
    }
}
