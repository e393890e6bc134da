//! The options of the drawing tools. Lengths are in units of the smallest edge of a voxel.

use std::ops::RangeInclusive;

use super::glyphs::Font;
use crate::input::DrawKind;

/// Radii of tubes.
pub const RADII: RangeInclusive<f32> = 0.5..=256.0;
/// Heights of boxes and letters, thicknesses of slabs and depths of letters.
pub const LENGTHS: RangeInclusive<f32> = 1.0..=512.0;

/// The options with which the drawing tools turn a drag into solids.
#[derive(Clone, PartialEq, Debug)]
pub struct DrawOptions {
    /// The thickness of a slab that lasso and rectangle add, along the line of sight.
    pub thickness: f32,
    /// The pointer sets the height of a box after its base; otherwise it is `height`.
    pub height_by_pointer: bool,
    /// The height of a box over its base.
    pub height: f32,
    /// The radii of a tube at its start and its end.
    pub radii: [f32; 2],
    /// Lines and curves follow the surface; otherwise they stay in the view plane of their start.
    pub on_surface: bool,
    /// The axis of a turned solid is the grid axis that points up; otherwise the vertical of the picture.
    pub upright: bool,
    pub text: String,
    /// The height of capital letters.
    pub text_height: f32,
    /// Extension of letters out of the surface, or into it.
    pub text_depth: f32,
    pub font: Font,
}

impl Default for DrawOptions {
    fn default() -> Self {
        DrawOptions {
            thickness: 12.0,
            height_by_pointer: true,
            height: 12.0,
            radii: [4.0, 4.0],
            on_surface: true,
            upright: true,
            text: "Text".to_string(),
            text_height: 24.0,
            text_depth: 2.0,
            font: Font::default(),
        }
    }
}

impl DrawOptions {
    /// Scales the drawing of a tool.
    pub fn scale(&mut self, kind: DrawKind, factor: f32) {
        let scaled = |value: &mut f32, range: RangeInclusive<f32>| {
            if factor.is_finite() && factor > 0.0 {
                *value = (*value * factor).clamp(*range.start(), *range.end());
            }
        };
        match kind {
            DrawKind::Lasso | DrawKind::Rectangle => scaled(&mut self.thickness, LENGTHS),
            DrawKind::Box if !self.height_by_pointer => scaled(&mut self.height, LENGTHS),
            DrawKind::Line | DrawKind::Curve => {
                self.radii.iter_mut().for_each(|radius| scaled(radius, RADII));
            }
            DrawKind::Text => scaled(&mut self.text_height, LENGTHS),
            DrawKind::Box | DrawKind::Plane | DrawKind::Lathe => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_scaled_within_their_range() {
        let before = DrawOptions { height_by_pointer: false, ..DrawOptions::default() };
        for kind in DrawKind::ALL {
            let mut options = before.clone();
            options.scale(kind, 2.0);
            let scales = !matches!(kind, DrawKind::Plane | DrawKind::Lathe);
            assert_eq!(options != before, scales, "{kind:?}");
            options.scale(kind, 1e9);
            options.scale(kind, f32::NAN);
            options.scale(kind, 1e-9);
            assert!(RADII.contains(&options.radii[0]) && LENGTHS.contains(&options.text_height));
            assert!(LENGTHS.contains(&options.height));
        }
        // A height without effect is not changed.
        let mut options = DrawOptions::default();
        options.scale(DrawKind::Box, 2.0);
        assert_eq!(options, DrawOptions::default());
    }
}
