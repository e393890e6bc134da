//! Display names: tools, tables of keys, numbers of voxels.
//!
//! Takes values, gives words; shows nothing.

use crate::input::ToolMode;

/// Returns the name of a table of keys, written like the program that it imitates.
pub fn preset_name(name: &str) -> String {
    match name {
        "magicavoxel" => "MagicaVoxel".to_string(),
        other => capital(other),
    }
}

/// Returns the text with its first letter in upper case.
pub fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| first.to_uppercase().chain(chars).collect())
}

/// Returns the name of a mode in the interface.
pub fn mode_name(mode: ToolMode) -> &'static str {
    match mode {
        ToolMode::Add => "Add",
        ToolMode::Subtract => "Cut",
        ToolMode::Recolour => "Paint",
        ToolMode::Protect | ToolMode::Release => "Protect",
    }
}

/// Formats digits in groups of three with narrow spaces.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let first = digits.len() % 3;
    let mut out = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && i % 3 == first {
            out.push('\u{2009}');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_are_grouped() {
        let shown =
            [0, 12, 999, 1000, 16_777_216].map(|n| super::grouped(n).replace('\u{2009}', " "));
        assert_eq!(shown, ["0", "12", "999", "1 000", "16 777 216"]);
    }
}
