//! The text of the user's changes to key tables: which preset is in use, and what was changed in
//! each.
//!
//! ```toml
//! extends = "thesis"      # the preset in use
//! [bindings]              # what differs from it
//! undo = ["u"]
//! fill = []
//! [kept.direct]           # changes made to another preset
//! redo = ["ctrl+y"]
//! ```
//!
//! Takes and returns text; knows no file.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Deserialize;

use super::bindings::{BindingLines, Bindings, BindingsError};

const HEAD: &str = "\
# Controls, as changed under Help (F1) in Virtual Sculpture.
# `extends` names the preset in use; the lines below override it, [] removes every key of an action.
";

/// All presets with the user's changes.
#[derive(Clone, PartialEq, Debug)]
pub struct Personal {
    /// In the order of the presets.
    pub tables: Vec<Bindings>,
    /// Index of the preset in use.
    pub in_use: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PersonalFile {
    extends: String,
    #[serde(default)]
    bindings: BindingLines,
    #[serde(default)]
    kept: BTreeMap<String, BindingLines>,
}

impl Personal {
    /// Applies the user's changes in a text to `presets`.
    pub fn parse(toml: &str, presets: &[Bindings]) -> Result<Personal, BindingsError> {
        let raw: PersonalFile =
            toml::from_str(toml).map_err(|e| BindingsError::Toml(e.to_string()))?;
        let find = |name: &str| {
            let found = presets.iter().position(|preset| preset.name == name);
            found.ok_or_else(|| BindingsError::UnknownTable(name.to_string()))
        };
        let mut tables = presets.to_vec();
        for (name, lines) in &raw.kept {
            let preset = find(name)?;
            tables[preset] = presets[preset].with_lines(lines)?;
        }
        let in_use = find(&raw.extends)?;
        if raw.kept.contains_key(&raw.extends) && !raw.bindings.is_empty() {
            return Err(BindingsError::KeptTwice(raw.extends));
        }
        if !raw.kept.contains_key(&raw.extends) {
            tables[in_use] = presets[in_use].with_lines(&raw.bindings)?;
        }
        Ok(Personal { tables, in_use })
    }

    /// Returns the text that `parse` reads back with the same `presets`.
    pub fn to_toml(&self, presets: &[Bindings]) -> String {
        let mut text = String::from(HEAD);
        let mut section = |head: &str, lines: &BindingLines| {
            let _ = writeln!(text, "{head}");
            for (name, triggers) in lines {
                let triggers: Vec<String> =
                    triggers.iter().map(|t| toml::Value::from(t.as_str()).to_string()).collect();
                let _ = writeln!(text, "{name} = [{}]", triggers.join(", "));
            }
        };
        let pairs = || self.tables.iter().zip(presets).enumerate();
        for (_, (table, preset)) in pairs().filter(|(i, _)| *i == self.in_use) {
            let head = format!("extends = {}\n\n[bindings]", toml::Value::from(&*preset.name));
            section(&head, &table.lines_since(preset));
        }
        for (_, (table, preset)) in pairs().filter(|(i, _)| *i != self.in_use) {
            let lines = table.lines_since(preset);
            if !lines.is_empty() {
                section(&format!("\n[kept.{}]", toml::Value::from(&*preset.name)), &lines);
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Action;

    fn presets() -> Vec<Bindings> {
        Bindings::presets().unwrap()
    }

    #[test]
    fn changes_to_all_presets_and_the_choice_come_back() {
        let presets = presets();
        for in_use in 0..presets.len() {
            let mut mine = Personal { tables: presets.clone(), in_use };
            assert_eq!(Personal::parse(&mine.to_toml(&presets), &presets).unwrap(), mine);
            mine.tables[0].bind("ctrl+backslash".parse().unwrap(), Action::Fill).unwrap();
            mine.tables[1].unbind("ctrl+z".parse().unwrap());
            mine.tables[3].bind("forward".parse().unwrap(), Action::PanSculpture).unwrap();
            let text = mine.to_toml(&presets);
            assert_eq!(Personal::parse(&text, &presets).unwrap(), mine, "{text}");
        }
        let mine = Personal { tables: presets.clone(), in_use: 1 };
        assert_eq!(
            mine.to_toml(&presets),
            format!("{HEAD}extends = \"thesis\"\n\n[bindings]\n"),
            "only what differs"
        );
    }

    #[test]
    fn a_file_written_by_hand_is_the_preset_with_a_few_lines() {
        let text = "extends = \"thesis\"\n[bindings]\nundo = [\"u\", \"ctrl+z\"]\n";
        let mine = Personal::parse(text, &presets()).unwrap();
        assert_eq!(mine.in_use, 1);
        assert_eq!(mine.tables[1].shortcut(Action::Undo).unwrap(), "U");
        assert_eq!(mine.tables[0], presets()[0]);
    }

    #[test]
    fn mistakes_are_named() {
        let error = |text: &str| Personal::parse(text, &presets()).unwrap_err().to_string();
        assert!(error("").contains("extends"));
        assert!(error("extends = \"emacs\"").contains("no preset called \"emacs\""));
        assert!(error("extends = \"direct\"\n[kept.vi]").contains("\"vi\""));
        assert!(error("extends = \"direct\"\n[bindings]\nfly = [\"a\"]").contains("fly"));
        assert!(error("extends = \"direct\"\n[kept.thesis]\nundo = [\"wheel\"]").contains("a key"));
        let twice = "extends = \"direct\"\n[bindings]\nundo = []\n[kept.direct]\nredo = []";
        assert!(error(twice).contains("[kept.direct]"));
    }
}
