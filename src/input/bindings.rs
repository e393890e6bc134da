//! Owns the table that says which trigger stands for which action, read from TOML:
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
//! A table that extends another has its lines as well, but for the actions that it names itself
//! and the triggers that it takes.

use std::collections::BTreeMap;

use serde::Deserialize;
use thiserror::Error;

use super::action::{Action, Kind};
use super::trigger::Trigger;

/// What tables are extended from: the keyboard, the same for all.
const KEYS: &str = include_str!("../../config/bindings/keys.toml");
const PRESETS: [&str; 4] = [
    include_str!("../../config/bindings/direct.toml"),
    include_str!("../../config/bindings/thesis.toml"),
    include_str!("../../config/bindings/blender.toml"),
    include_str!("../../config/bindings/magicavoxel.toml"),
];

/// Why a table cannot be used.
#[derive(Debug, Error, PartialEq)]
pub enum BindingsError {
    #[error("{0}")]
    Toml(String),
    #[error("extends = \"{0}\": there is no such table")]
    UnknownTable(String),
    #[error("[bindings] {0}: there is no such action")]
    UnknownAction(String),
    #[error("[bindings] {action}: {error}")]
    Trigger { action: &'static str, error: String },
    #[error("[bindings] {action}: `{trigger}` cannot trigger it; it needs {needs}")]
    Kind { action: &'static str, trigger: Trigger, needs: &'static str },
    #[error("[bindings] `{trigger}` is given to both {first} and {second}")]
    Twice { trigger: Trigger, first: &'static str, second: &'static str },
}

/// A table of triggers and actions.
#[derive(Clone, PartialEq, Debug)]
pub struct Bindings {
    pub name: String,
    /// What it is like, for the menu.
    pub text: String,
    table: Vec<(Trigger, Action)>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    name: String,
    text: String,
    extends: Option<String>,
    bindings: BTreeMap<String, Vec<String>>,
}

impl Bindings {
    /// The tables that the program brings along; the first is the default.
    pub fn presets() -> Result<Vec<Bindings>, BindingsError> {
        PRESETS.into_iter().map(Bindings::parse).collect()
    }

    /// Reads a table.
    pub fn parse(toml: &str) -> Result<Bindings, BindingsError> {
        let raw: Raw = toml::from_str(toml).map_err(|e| BindingsError::Toml(e.to_string()))?;
        let extended = match raw.extends.as_deref() {
            None => None,
            Some("keys") => Some(Bindings::parse(KEYS)?),
            Some(other) => return Err(BindingsError::UnknownTable(other.to_string())),
        };
        let mut table: Vec<(Trigger, Action)> = Vec::new();
        let mut named = Vec::new();
        for (name, triggers) in raw.bindings {
            let action =
                Action::named(&name).ok_or_else(|| BindingsError::UnknownAction(name.clone()))?;
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
        for (trigger, action) in extended.into_iter().flat_map(|extended| extended.table) {
            if !named.contains(&action) && table.iter().all(|(taken, _)| *taken != trigger) {
                table.push((trigger, action));
            }
        }
        Ok(Bindings { name: raw.name, text: raw.text, table })
    }

    /// What a trigger stands for.
    pub fn action(&self, trigger: Trigger) -> Option<Action> {
        self.table.iter().find(|(bound, _)| *bound == trigger).map(|(_, action)| *action)
    }

    /// What triggers an action.
    pub fn triggers(&self, action: Action) -> impl Iterator<Item = Trigger> {
        self.table.iter().filter(move |(_, bound)| *bound == action).map(|(trigger, _)| *trigger)
    }

    /// The first trigger of an action, as a person reads it.
    pub fn shortcut(&self, action: Action) -> Option<String> {
        self.triggers(action).next().map(|trigger| trigger.to_string())
    }
}

fn check_kind(kind: Kind, trigger: Trigger) -> Result<(), &'static str> {
    match (kind, trigger) {
        (Kind::Tap | Kind::Hold, Trigger::Key { .. } | Trigger::Pad { .. })
        | (Kind::Tap, Trigger::ShiftTap)
        | (Kind::Drag, Trigger::Mouse { .. })
        | (Kind::Wheel, Trigger::Wheel { .. }) => Ok(()),
        // One button alone starts a drag; two together can hold something on top of it.
        (Kind::Hold, Trigger::Mouse { buttons, .. }) if buttons.count() >= 2 => Ok(()),
        (Kind::Tap, _) => Err("a key or a button of a gamepad"),
        (Kind::Hold, _) => Err("a key, a button of a gamepad, or mouse buttons together"),
        (Kind::Drag, _) => Err("mouse buttons"),
        (Kind::Wheel, _) => Err("the wheel"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bindings: &str) -> Result<Bindings, BindingsError> {
        Bindings::parse(&format!("name = \"t\"\ntext = \"\"\n[bindings]\n{bindings}"))
    }

    #[test]
    fn the_presets_are_sound_and_name_every_action_that_needs_a_device() {
        let presets = Bindings::presets().unwrap();
        assert_eq!(presets[0].name, "direct");
        assert_eq!(presets[1].name, "thesis");
        // What has no button on screen must be reachable in every preset.
        for preset in &presets {
            for action in [Action::Undo, Action::Help, Action::Zoom, Action::TurnSculpture] {
                assert!(preset.triggers(action).next().is_some(), "{} {action:?}", preset.name);
            }
        }
    }

    #[test]
    fn mistakes_are_named() {
        let error = |bindings| parse(bindings).unwrap_err().to_string();
        assert!(error("fly = [\"a\"]").contains("fly: there is no such action"));
        assert!(error("undo = [\"ctrl+nokey\"]").contains("undo: `nokey` is not a key"));
        assert!(error("undo = [\"left\"]").contains("needs a key"));
        assert!(error("zoom = [\"z\"]").contains("needs the wheel"));
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
}
