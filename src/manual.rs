//! The reference of the brushes (`docs/tools.md`), made from their descriptions.
//!
//! Takes the descriptions and the keys of a preset; gives a page in Markdown. Knows no window.

use std::fmt::{self, Display, Write};

use crate::command::usage_of_brush;
use crate::input::bindings::BindingsError;
use crate::input::{Action, Bindings};
use crate::tools::brush::BrushId;
use crate::tools::brush::param::{Domain, OptionValue, Param};
use crate::tools::brush::spec::{BrushSpec, Inverse};

const INTRODUCTION: &str = "# Brushes

<!-- Made by `virtual-sculpture commands --markdown` from the descriptions in core/src/tools/brush. Change those, not this. -->

This page lists every brush with its key in the preset `direct`, its options and its command. The [guide](guide.md#tools)
says how to work with them, [Scripts](scripting.md#scripts) what the arguments of the commands mean.

";

/// Returns the page about all brushes, with the keys of the default preset. Fails if the built-in presets cannot be
/// read.
pub fn brushes() -> Result<String, BindingsError> {
    let presets = Bindings::presets()?;
    let page = presets.first().map(|bindings| BrushReference { bindings }.to_string());
    Ok(page.unwrap_or_default())
}

/// The reference of all brushes.
struct BrushReference<'a> {
    bindings: &'a Bindings,
}

impl Display for BrushReference<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(INTRODUCTION)?;
        let all = || BrushId::ALL.iter().map(|brush| (*brush, brush.spec()));
        table(f, &["brush", "key", "with Ctrl", "effect"], |f| {
            all().try_for_each(|(brush, spec)| {
                let key = self.bindings.shortcut(Action::Brush(brush)).unwrap_or_default();
                let inverse = match spec.inverse {
                    Inverse::Same => "the same",
                    Inverse::Sense => "the inverse",
                    Inverse::Brush(other) => other.spec().label,
                };
                row(f, &[&spec.label, &format!("`{key}`"), &inverse, &spec.effect])
            })
        })?;
        f.write_str("\n## Options\n\n")?;
        f.write_str(
            "A radius is in pixels (px) of the picture or in voxels (vx) of the sculpture, as *Size on* says; at first in \
             pixels.\n\n",
        )?;
        table(f, &["brush", "option", "values", "at first", "meaning"], |f| {
            all().try_for_each(|(_, spec)| options(f, spec))
        })?;
        f.write_str("\n## Effect on volume, colours and flat faces\n\n")?;
        table(f, &["brush", "volume", "colours", "flat faces"], |f| {
            all().try_for_each(|(_, spec)| {
                let keeps = &spec.keeps;
                row(f, &[&spec.label, &keeps.volume, &keeps.colour, &keeps.flat_faces])
            })
        })?;
        f.write_str("\n## Commands\n\n")?;
        let mut usages = all().filter_map(|(brush, _)| usage_of_brush(brush));
        usages.try_for_each(|usage| writeln!(f, "    {usage}"))
    }
}

fn table(
    f: &mut fmt::Formatter<'_>,
    heads: &[&str],
    rows: impl FnOnce(&mut fmt::Formatter<'_>) -> fmt::Result,
) -> fmt::Result {
    writeln!(f, "| {} |\n|{}", heads.join(" | "), "---|".repeat(heads.len()))?;
    rows(f)
}

fn row(f: &mut fmt::Formatter<'_>, cells: &[&dyn Display]) -> fmt::Result {
    f.write_char('|')?;
    cells.iter().try_for_each(|cell| write!(f, " {} |", cell.to_string().replace('|', "\\|")))?;
    f.write_char('\n')
}

fn options(f: &mut fmt::Formatter<'_>, spec: &BrushSpec) -> fmt::Result {
    let mut name = spec.label;
    for param in spec.options {
        row(f, &[&name, &param.label, &values(param), &shown(param, param.first), &param.help])?;
        name = "";
    }
    Ok(())
}

/// Returns the valid values of an option.
fn values(param: &Param) -> String {
    match param.domain {
        Domain::Radius => "px or vx".to_string(),
        Domain::Number([least, most]) => {
            let factor = param.unit.factor();
            format!("{} to {}{}", least * factor, most * factor, param.unit.suffix())
        }
        Domain::Whole([least, most]) => format!("{least} to {most}{}", param.unit.suffix()),
        Domain::Switch => "on, off".to_string(),
        Domain::Choice(choices) => {
            let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
            names.join(", ")
        }
        Domain::Colour => "any colour".to_string(),
    }
}

fn shown(param: &Param, value: OptionValue) -> String {
    match value {
        OptionValue::Number(number) if param.domain == Domain::Radius => format!("{number} px"),
        OptionValue::Number(number) => {
            format!("{}{}", number * param.unit.factor(), param.unit.suffix())
        }
        OptionValue::Whole(count) => format!("{count}{}", param.unit.suffix()),
        OptionValue::On(on) => if on { "on" } else { "off" }.to_string(),
        OptionValue::Choice(place) => match param.domain {
            Domain::Choice(choices) => choices.get(usize::from(place)).map_or("", |c| c.name),
            _ => "",
        }
        .to_string(),
        OptionValue::Colour(colour) => colour.to_string(),
        OptionValue::Absent => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_that_of_the_descriptions() {
        let page = include_str!("../docs/tools.md");
        assert!(
            page == brushes().unwrap(),
            "docs/tools.md is stale: `virtual-sculpture commands --markdown > docs/tools.md` makes it anew"
        );
    }

    #[test]
    fn every_brush_has_a_key_an_effect_and_rows_of_as_many_cells() {
        let page = brushes().unwrap();
        for brush in BrushId::ALL {
            let spec = brush.spec();
            assert!(page.contains(&format!("| {} | `", spec.label)), "{brush:?}");
            for text in [spec.effect, spec.keeps.volume, spec.keeps.colour, spec.keeps.flat_faces] {
                assert!(
                    !text.is_empty() && !text.contains(['\n', '|', '`', '*']),
                    "{brush:?}: {text}"
                );
            }
            assert!(spec.effect.ends_with('.') && !spec.keeps.volume.ends_with('.'), "{brush:?}");
        }
        assert!(!page.contains("| `` |"), "a brush has no key");
        let cells = |line: &str| line.replace("\\|", "").matches('|').count();
        let lines: Vec<&str> = page.lines().collect();
        for pair in lines.windows(2) {
            if pair.iter().all(|line| line.starts_with('|')) {
                assert_eq!(cells(pair[0]), cells(pair[1]), "{pair:?}");
            }
        }
    }
}
