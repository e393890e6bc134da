//! Bindings: the table from triggers to actions, read from TOML:
//!
//! ```toml
//! name = "direct"
//! text = "The tool follows the pointer on the surface"
//! extends = "keys"
//! [bindings]
//! undo = ["ctrl+z"]
//! sculpt = ["left"]
//! ```
//!
//! A table that extends another inherits its lines, except those of actions that it binds itself
//! and triggers that it takes; name and text are inherited, too, if it has none. `keys` and the
//! presets can be extended.

use std::collections::BTreeMap;

use egui::Key;
use serde::Deserialize;
use thiserror::Error;

use super::action::{Action, TriggerKind};
use super::events::Modifiers;
use super::trigger::Trigger;

/// The keyboard bindings that all presets share.
const KEYS: (&str, &str) = ("keys", include_str!("../../config/bindings/keys.toml"));
const PRESETS: [(&str, &str); 4] = [
    ("direct", include_str!("../../config/bindings/direct.toml")),
    ("thesis", include_str!("../../config/bindings/thesis.toml")),
    ("blender", include_str!("../../config/bindings/blender.toml")),
    ("magicavoxel", include_str!("../../config/bindings/magicavoxel.toml")),
];

/// The lines of a table in its text: triggers by the names of actions.
pub type BindingLines = BTreeMap<String, Vec<String>>;

/// The reason why a table cannot be used.
#[derive(Debug, Error, PartialEq)]
pub enum BindingsError {
    #[error("{0}")]
    Toml(String),
    #[error("there is no preset called \"{0}\"; use direct, thesis, blender or magicavoxel")]
    UnknownTable(String),
    #[error("the changes to {0} are given twice, in [bindings] and in [kept.{0}]; remove one")]
    KeptTwice(String),
    #[error("a table without `extends` needs a {0}")]
    Unnamed(&'static str),
    #[error("[bindings] {0}: there is no such action; F1 lists all, with their names")]
    UnknownAction(String),
    #[error("[bindings] {action}: {error}")]
    Trigger { action: &'static str, error: String },
    #[error("[bindings] {action}: `{trigger}` cannot trigger this action; it needs {needs}")]
    Kind { action: &'static str, trigger: Trigger, needs: &'static str },
    #[error("[bindings] `{trigger}` is assigned to both {first} and {second}; remove one")]
    Twice { trigger: Trigger, first: &'static str, second: &'static str },
}

/// A table of triggers and actions.
#[derive(Clone, PartialEq, Debug)]
pub struct Bindings {
    pub name: String,
    /// A description for the menu.
    pub text: String,
    /// In the order of `Action::ALL`; the first trigger of an action is its shortcut.
    pub(super) table: Vec<(Trigger, Action)>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BindingsFile {
    name: Option<String>,
    text: Option<String>,
    extends: Option<String>,
    #[serde(default)]
    bindings: BindingLines,
}

impl Bindings {
    /// Returns the presets of the program; the first one is the default.
    pub fn presets() -> Result<Vec<Bindings>, BindingsError> {
        PRESETS.into_iter().map(|(_, toml)| Bindings::parse(toml)).collect()
    }

    /// Reads a table.
    pub fn parse(toml: &str) -> Result<Bindings, BindingsError> {
        let raw: BindingsFile =
            toml::from_str(toml).map_err(|e| BindingsError::Toml(e.to_string()))?;
        let base = match &raw.extends {
            None => Bindings {
                name: raw.name.clone().ok_or(BindingsError::Unnamed("name"))?,
                text: raw.text.clone().ok_or(BindingsError::Unnamed("text"))?,
                table: Vec::new(),
            },
            Some(name) => {
                let known = PRESETS.into_iter().chain([KEYS]).find(|(known, _)| known == name);
                let (_, toml) = known.ok_or_else(|| BindingsError::UnknownTable(name.clone()))?;
                Bindings::parse(toml)?
            }
        };
        let table = base.with_lines(&raw.bindings)?;
        Ok(Bindings {
            name: raw.name.unwrap_or(table.name),
            text: raw.text.unwrap_or(table.text),
            ..table
        })
    }

    /// Returns this table with other lines for the actions named by `lines`, which take their triggers from other
    /// actions.
    pub fn with_lines(&self, lines: &BindingLines) -> Result<Bindings, BindingsError> {
        let mut table: Vec<(Trigger, Action)> = Vec::new();
        let mut named = Vec::new();
        for (name, triggers) in lines {
            let action =
                Action::named(name).ok_or_else(|| BindingsError::UnknownAction(name.clone()))?;
            named.push(action);
            let help = action.help();
            for text in triggers {
                let trigger = text
                    .parse()
                    .map_err(|error| BindingsError::Trigger { action: help.name, error })?;
                check_kind(help.kind, trigger).map_err(|needs| BindingsError::Kind {
                    action: help.name,
                    trigger,
                    needs,
                })?;
                if let Some((_, first)) = table.iter().find(|(taken, _)| *taken == trigger) {
                    return Err(BindingsError::Twice {
                        trigger,
                        first: first.help().name,
                        second: help.name,
                    });
                }
                table.push((trigger, action));
            }
        }
        for &(trigger, action) in &self.table {
            if !named.contains(&action) && table.iter().all(|(taken, _)| *taken != trigger) {
                table.push((trigger, action));
            }
        }
        sort(&mut table);
        Ok(Bindings { name: self.name.clone(), text: self.text.clone(), table })
    }

    /// Returns the action of a trigger.
    pub fn action(&self, trigger: Trigger) -> Option<Action> {
        self.table.iter().find(|(bound, _)| *bound == trigger).map(|(_, action)| *action)
    }

    /// Returns the action of a key: by its label or, if that is not bound, by its position among Latin letters. Greek
    /// and Hebrew keyboards have signs in place of some letters.
    pub fn action_of_key(
        &self,
        key: Key,
        place: Option<Key>,
        modifiers: Modifiers,
    ) -> Option<Action> {
        let by = |key| self.action(Trigger::Key { key, modifiers });
        let letter = place.filter(|place| is_letter(*place) && !is_letter(key));
        by(key).or_else(|| letter.and_then(by))
    }

    /// Returns the triggers of an action.
    pub fn triggers(&self, action: Action) -> impl Iterator<Item = Trigger> {
        self.table.iter().filter(move |(_, bound)| *bound == action).map(|(trigger, _)| *trigger)
    }

    /// Returns the first trigger of an action as text.
    pub fn shortcut(&self, action: Action) -> Option<String> {
        self.triggers(action).next().map(|trigger| trigger.to_string())
    }
}

/// Sorts a table by actions; the triggers of each keep their order.
pub(super) fn sort(table: &mut [(Trigger, Action)]) {
    table.sort_by_key(|(_, action)| Action::ALL.iter().position(|other| other == action));
}

/// Checks that a trigger fits an action of that kind. An error names the requirement.
pub(super) fn check_kind(kind: TriggerKind, trigger: Trigger) -> Result<(), &'static str> {
    match (kind, trigger) {
        (TriggerKind::Tap | TriggerKind::Hold, Trigger::Key { .. } | Trigger::Pad { .. })
        | (TriggerKind::Tap, Trigger::ShiftTap)
        | (TriggerKind::Drag, Trigger::Mouse { .. })
        | (TriggerKind::Wheel, Trigger::Wheel { .. }) => Ok(()),
        // Pen buttons may do this for people without a free hand for keys.
        (TriggerKind::Tap | TriggerKind::Hold, Trigger::Mouse { buttons, .. })
            if buttons.is_on_barrel() =>
        {
            Ok(())
        }
        // A single button starts a drag; two together can hold something during it.
        (TriggerKind::Hold, Trigger::Mouse { buttons, .. }) if buttons.count() >= 2 => Ok(()),
        (TriggerKind::Tap, _) => Err("a key, a gamepad button or a button of a pen"),
        (TriggerKind::Hold, _) => {
            Err("a key, a gamepad button, a button of a pen, or several mouse buttons together")
        }
        (TriggerKind::Drag, _) => Err("buttons of mouse or pen"),
        (TriggerKind::Wheel, _) => Err("the mouse wheel"),
    }
}

fn is_letter(key: Key) -> bool {
    matches!(key.name().as_bytes(), [letter] if letter.is_ascii_alphabetic())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bindings: &str) -> Result<Bindings, BindingsError> {
        Bindings::parse(&format!("name = \"t\"\ntext = \"\"\n[bindings]\n{bindings}"))
    }

    #[test]
    fn every_preset_has_a_key_for_every_tap_and_no_trigger_twice() {
        let presets = Bindings::presets().unwrap();
        for ((name, _), preset) in PRESETS.iter().zip(&presets) {
            assert_eq!(*name, preset.name);
            for &action in Action::ALL {
                let has_key = preset
                    .triggers(action)
                    .any(|trigger| matches!(trigger, Trigger::Key { .. } | Trigger::ShiftTap));
                assert!(has_key || action.help().kind != TriggerKind::Tap, "{name}: {action:?}");
            }
            for action in [Action::TurnSculpture, Action::PanSculpture, Action::Zoom] {
                assert!(preset.triggers(action).next().is_some(), "{name}: {action:?}");
            }
            for (i, (trigger, _)) in preset.table.iter().enumerate() {
                assert!(preset.table[..i].iter().all(|(t, _)| t != trigger), "{name}: {trigger}");
            }
        }
    }

    /// Checks that drags, holds and wheels, too, can be reached: the palette offers taps alone.
    #[test]
    fn every_action_has_a_trigger_in_some_preset() {
        let presets = Bindings::presets().unwrap();
        for &action in Action::ALL {
            let is_bound = presets.iter().any(|preset| preset.triggers(action).next().is_some());
            assert!(is_bound, "{action:?}");
        }
    }

    /// Checks that no binding depends on Shift with a digit, which gives different characters on different keyboard
    /// layouts, or on the positions of punctuation.
    #[test]
    fn no_action_depends_on_shift_with_digits_or_punctuation() {
        let shifted = |trigger| match trigger {
            Trigger::Key { key, modifiers } if modifiers.shift => {
                let code = trigger.code();
                let name = code.rsplit('+').next().unwrap();
                let letter = name.len() == 1 && name.chars().all(char::is_alphabetic);
                let steady = ["arrow", "page", "home", "end", "insert", "delete", "f1"];
                !letter && !steady.iter().any(|s| name.starts_with(s)) && key != egui::Key::Tab
            }
            _ => false,
        };
        for preset in Bindings::presets().unwrap() {
            for &action in Action::ALL {
                let mut triggers = preset.triggers(action).peekable();
                let none = triggers.peek().is_none();
                assert!(none || triggers.any(|t| !shifted(t)), "{}: {action:?}", preset.name);
            }
        }
    }

    #[test]
    fn a_few_lines_extend_a_preset() {
        let mine =
            Bindings::parse("extends = \"thesis\"\n[bindings]\nundo = [\"u\"]\nzoom = []").unwrap();
        let thesis = &Bindings::presets().unwrap()[1];
        assert_eq!((&mine.name, &mine.text), (&thesis.name, &thesis.text));
        assert_eq!(mine.shortcut(Action::Undo).unwrap(), "U");
        assert_eq!(mine.triggers(Action::Zoom).count(), 0);
        assert_eq!(mine.shortcut(Action::MoveTool).unwrap(), "left button");
        // A trigger that a line takes is removed from the other action.
        let mine = Bindings::parse(
            "name = \"mine\"\nextends = \"direct\"\n[bindings]\nfill = [\"ctrl+z\"]",
        )
        .unwrap();
        assert_eq!(mine.name, "mine");
        assert_eq!(mine.action("ctrl+z".parse().unwrap()), Some(Action::Fill));
        assert_eq!(mine.shortcut(Action::Undo).unwrap(), "gamepad D-pad left");
        let error = Bindings::parse("extends = \"emacs\"").unwrap_err().to_string();
        assert!(error.contains("no preset called \"emacs\""), "{error}");
    }

    #[test]
    fn mistakes_are_named() {
        let error = |bindings| parse(bindings).unwrap_err().to_string();
        assert!(error("fly = [\"a\"]").contains("fly: there is no such action"));
        assert!(error("undo = [\"ctrl+nokey\"]").contains("undo: `nokey` is not a key"));
        assert!(error("undo = [\"left\"]").contains("needs a key"));
        assert!(error("zoom = [\"z\"]").contains("needs the mouse wheel"));
        assert!(error("apply = [\"left\"]").contains("mouse buttons together"));
        let twice = error("undo = [\"ctrl+z\"]\nredo = [\"ctrl+z\"]");
        assert!(twice.contains("Ctrl+Z") && twice.contains("redo") && twice.contains("undo"));
        assert!(matches!(Bindings::parse("name = 3"), Err(BindingsError::Toml(_))));
    }

    #[test]
    fn lookups_go_both_ways() {
        let bindings = parse("redo = [\"ctrl+y\", \"ctrl+shift+z\"]").unwrap();
        assert_eq!(bindings.shortcut(Action::Redo).unwrap(), "Ctrl+Y");
        assert_eq!(bindings.triggers(Action::Redo).count(), 2);
        assert_eq!(bindings.action("ctrl+shift+z".parse().unwrap()), Some(Action::Redo));
        assert_eq!(bindings.action("z".parse().unwrap()), None);
    }

    #[test]
    fn a_sign_in_the_place_of_a_letter_is_that_letter_unless_it_is_bound() {
        let plain = Modifiers::default();
        let bindings = parse("undo = [\"q\"]\nredo = [\"w\"]").unwrap();
        // Q on a Greek keyboard, and on a Hebrew one.
        for sign in [Key::Semicolon, Key::Slash] {
            let action = bindings.action_of_key(sign, Some(Key::Q), plain);
            assert_eq!(action, Some(Action::Undo));
        }
        // A letter is itself: A on a French keyboard is at the position of Q.
        assert_eq!(bindings.action_of_key(Key::A, Some(Key::Q), plain), None);
        assert_eq!(bindings.action_of_key(Key::W, Some(Key::Q), plain), Some(Action::Redo));
        let bound = parse("undo = [\"q\"]\nredo = [\"semicolon\"]").unwrap();
        let action = bound.action_of_key(Key::Semicolon, Some(Key::Q), plain);
        assert_eq!(action, Some(Action::Redo));
    }
}
