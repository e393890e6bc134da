//! Remembers the options of the tools that draw solids.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::editor::draw::DrawOptions;
use crate::editor::draw::glyphs::{Font, MOST_LETTERS};
use crate::editor::draw::options::{LENGTHS, RADII};
use crate::ui::memory::values::{neat, within};

/// The options. Missing or invalid ones get their defaults.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptDraw {
    thickness: Option<f64>,
    height_by_pointer: Option<bool>,
    height: Option<f64>,
    start_radius: Option<f64>,
    end_radius: Option<f64>,
    on_surface: Option<bool>,
    upright: Option<bool>,
    text: Option<String>,
    text_height: Option<f64>,
    text_depth: Option<f64>,
    font: Option<String>,
}

impl KeptDraw {
    pub fn of(options: &DrawOptions) -> KeptDraw {
        KeptDraw {
            thickness: Some(neat(options.thickness)),
            height_by_pointer: Some(options.height_by_pointer),
            height: Some(neat(options.height)),
            start_radius: Some(neat(options.radii[0])),
            end_radius: Some(neat(options.radii[1])),
            on_surface: Some(options.on_surface),
            upright: Some(options.upright),
            text: Some(options.text.clone()),
            text_height: Some(neat(options.text_height)),
            text_depth: Some(neat(options.text_depth)),
            font: Some(options.font.name().to_string()),
        }
    }

    /// Restores the options.
    pub fn recall(&self, options: &mut DrawOptions) {
        let number = |kept: Option<f64>, range: RangeInclusive<f32>, value: &mut f32| {
            *value = within(kept, range, *value);
        };
        number(self.thickness, LENGTHS, &mut options.thickness);
        number(self.height, LENGTHS, &mut options.height);
        number(self.start_radius, RADII, &mut options.radii[0]);
        number(self.end_radius, RADII, &mut options.radii[1]);
        number(self.text_height, LENGTHS, &mut options.text_height);
        number(self.text_depth, LENGTHS, &mut options.text_depth);
        options.height_by_pointer = self.height_by_pointer.unwrap_or(options.height_by_pointer);
        options.on_surface = self.on_surface.unwrap_or(options.on_surface);
        options.upright = self.upright.unwrap_or(options.upright);
        if let Some(text) = self.text.as_ref().filter(|text| text.chars().count() <= MOST_LETTERS) {
            options.text = text.clone();
        }
        let named = |font: &Font| Some(font.name()) == self.font.as_deref();
        options.font = Font::ALL.into_iter().find(named).unwrap_or(options.font);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_found_again_and_nonsense_is_not_believed() {
        let before = DrawOptions {
            thickness: 33.3,
            height_by_pointer: false,
            height: 5.0,
            radii: [7.0, 1.5],
            on_surface: false,
            upright: false,
            text: "two words, ä".to_string(),
            text_height: 40.0,
            text_depth: 3.5,
            font: Font::Mono,
        };
        let text = toml::to_string(&KeptDraw::of(&before)).unwrap();
        let mut after = DrawOptions::default();
        toml::from_str::<KeptDraw>(&text).unwrap().recall(&mut after);
        assert_eq!(after, before);
        for text in ["", "height = 0.0\nfont = \"bold\"", "start_radius = inf\nthickness = nan"] {
            let mut after = DrawOptions::default();
            toml::from_str::<KeptDraw>(text).unwrap().recall(&mut after);
            assert_eq!(after, DrawOptions::default(), "{text}");
        }
    }
}
