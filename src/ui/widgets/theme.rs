//! Owns the look of the interface: two themes of one design, in quiet greys that leave the colours to the sculpture,
//! with one warm accent.

use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, Style, TextStyle, Visuals, vec2};

use crate::ui::layout::Scale;
use crate::ui::window_options::Theme;

/// Width of a column of tools in points.
const TOOLBOX_COLUMN: f32 = 50.0;
/// Width of two columns of tools, with their margins.
pub const TOOLBOX_WIDTH: f32 = 2.0 * TOOLBOX_COLUMN + 16.0;
/// Windows narrower than this have one column of tools to leave room for the picture.
const NARROW: f32 = 900.0;
/// Smallest side of a click target, in points.
pub const LEAST_TARGET: f32 = 24.0;
/// Width of the column of options in points.
pub const OPTIONS_WIDTH: f32 = 246.0;

const ACCENT: Color32 = Color32::from_rgb(0xd9, 0x7b, 0x3f);
const ACCENT_DARK: Color32 = Color32::from_rgb(0x8a, 0x4a, 0x22);

/// Returns the width of the toolbox beside the picture in a window of `width` points.
pub fn toolbox_width(width: f32) -> f32 {
    if width < NARROW { TOOLBOX_COLUMN + 20.0 } else { TOOLBOX_WIDTH }
}

/// Returns the number of columns of tools in `width` points.
pub fn toolbox_columns(width: f32) -> usize {
    ((width / (TOOLBOX_COLUMN - 6.0)) as usize).clamp(1, 6)
}

/// Sets fonts, spacing, colours and scale of the context. Cheap if nothing has changed.
pub fn apply(ctx: &egui::Context, theme: Theme, scale: Scale) {
    ctx.set_zoom_factor(scale.factor());
    let wanted = match theme {
        Theme::Dark => egui::Theme::Dark,
        Theme::Light => egui::Theme::Light,
    };
    let id = egui::Id::new("virtual-sculpture-theme");
    if ctx.data(|data| data.get_temp::<egui::Theme>(id)) == Some(wanted) {
        return;
    }
    ctx.data_mut(|data| data.insert_temp(id, wanted));
    // Actions change the scale, by any key.
    ctx.options_mut(|options| options.zoom_with_keyboard = false);
    ctx.set_theme(wanted);
    ctx.set_style_of(wanted, style(theme));
}

/// Counts a press and its release as a click however long it takes: on a busy machine much time passes between two
/// passes, which egui takes for a held button.
pub fn hear_slow_clicks(ctx: &egui::Context) {
    ctx.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
}

/// Returns the colour of errors, readable on panels.
pub fn error_colour(visuals: &Visuals) -> Color32 {
    if visuals.dark_mode {
        Color32::from_rgb(0xf0, 0x6a, 0x60)
    } else {
        Color32::from_rgb(0xb0, 0x22, 0x1a)
    }
}

/// Returns the main button of a window.
pub fn primary(visuals: &Visuals, text: &str) -> egui::Button<'static> {
    let text = egui::RichText::new(text).color(visuals.selection.stroke.color);
    egui::Button::new(text).fill(visuals.selection.bg_fill)
}

fn style(theme: Theme) -> Style {
    let mut style = Style { visuals: visuals(theme), ..Style::default() };
    let font = |size| FontId::new(size, FontFamily::Proportional);
    style.text_styles = [
        (TextStyle::Small, font(11.0)),
        (TextStyle::Body, font(13.5)),
        (TextStyle::Button, font(13.5)),
        (TextStyle::Heading, font(16.0)),
        (TextStyle::Monospace, FontId::new(12.5, FontFamily::Monospace)),
    ]
    .into();
    style.spacing.item_spacing = vec2(6.0, 6.0);
    style.spacing.button_padding = vec2(8.0, 4.0);
    style.spacing.interact_size.y = LEAST_TARGET;
    style.spacing.slider_width = 120.0;
    // A permanent bar shows that there is more to see; a fade would be a bright stripe on light panels.
    style.spacing.scroll.fade.strength = 0.0;
    style.spacing.scroll.dormant_handle_opacity = 0.5;
    style
}

fn visuals(theme: Theme) -> Visuals {
    let grey = Color32::from_gray;
    let (mut visuals, panel, faint, extreme) = match theme {
        Theme::Dark => (Visuals::dark(), grey(0x22), grey(0x2a), grey(0x16)),
        Theme::Light => (Visuals::light(), grey(0xf0), grey(0xe6), grey(0xff)),
    };
    let dark = theme == Theme::Dark;
    visuals.panel_fill = panel;
    visuals.window_fill = if dark { grey(0x28) } else { grey(0xf7) };
    visuals.faint_bg_color = faint;
    visuals.weak_text_color = Some(if dark { grey(0x96) } else { grey(0x5c) });
    // A steady cursor, so that nothing is drawn while nothing happens.
    visuals.text_cursor.blink = false;
    visuals.extreme_bg_color = extreme;
    visuals.text_edit_bg_color = Some(extreme);
    visuals.hyperlink_color = if dark { ACCENT } else { ACCENT_DARK };
    visuals.selection.bg_fill =
        if dark { ACCENT_DARK } else { Color32::from_rgb(0xf2, 0xc6, 0xa4) };
    visuals.selection.stroke =
        Stroke::new(1.0, if dark { grey(0xff) } else { Color32::from_rgb(0x40, 0x1c, 0x06) });
    visuals.error_fg_color = error_colour(&visuals);
    let radius = CornerRadius::same(5);
    let widgets = &mut visuals.widgets;
    for state in [
        &mut widgets.noninteractive,
        &mut widgets.inactive,
        &mut widgets.hovered,
        &mut widgets.active,
        &mut widgets.open,
    ] {
        state.corner_radius = radius;
    }
    if dark {
        widgets.noninteractive.fg_stroke.color = grey(0xc4);
        widgets.inactive.fg_stroke.color = grey(0xd8);
        widgets.noninteractive.bg_stroke.color = grey(0x3a);
        widgets.inactive.weak_bg_fill = grey(0x34);
        widgets.inactive.bg_fill = grey(0x74);
        widgets.hovered.weak_bg_fill = grey(0x42);
        widgets.hovered.bg_fill = grey(0x80);
        widgets.active.bg_fill = grey(0x80);
    } else {
        widgets.noninteractive.fg_stroke.color = grey(0x38);
        widgets.inactive.fg_stroke.color = grey(0x28);
        widgets.inactive.weak_bg_fill = grey(0xdd);
        widgets.inactive.bg_fill = grey(0x88);
        widgets.hovered.bg_fill = grey(0x7c);
        widgets.active.bg_fill = grey(0x7c);
    }
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the contrast of two colours as defined by WCAG 2.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |colour: Color32| {
            let [r, g, b, _] = egui::Rgba::from(colour).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn checkboxes_stand_out_from_panels_and_their_ticks_from_them() {
        for theme in [Theme::Dark, Theme::Light] {
            let visuals = visuals(theme);
            let widgets = &visuals.widgets;
            for state in [&widgets.inactive, &widgets.hovered, &widgets.active] {
                for behind in [visuals.panel_fill, visuals.window_fill, state.fg_stroke.color] {
                    let contrast = contrast(state.bg_fill, behind);
                    assert!(contrast >= 3.0, "{theme:?}: {contrast} to {behind:?}");
                }
            }
        }
    }
}
