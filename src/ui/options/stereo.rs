//! The options of stereo pictures: the layout of two eyes on the screen, and their distance.

use egui::{ComboBox, Slider, Ui};

use crate::input::Action;
use crate::render::stereo_options::{CONVERGENCE_PERCENT, EYE_DISTANCE_MM};
use crate::ui::context::UiContext;
use crate::ui::state::UiState;
use crate::ui::widgets::buttons::explain;
use crate::view::StereoLayout;

pub fn show(ui: &mut Ui, state: &mut UiState, context: &UiContext) {
    ui.horizontal(|ui| {
        ui.label("Stereo");
        layouts(ui, state, context);
    });
    let stereo = &mut state.view.stereo;
    if stereo.layout == StereoLayout::Mono {
        return;
    }
    egui::Grid::new("stereo").num_columns(2).show(ui, |ui| {
        let mut row = |label: &str, value: &mut f32, range, unit: &str, tip: &str| {
            let label = ui.label(label);
            let slider = Slider::new(value, range).fixed_decimals(0).suffix(unit);
            ui.add(slider).labelled_by(label.id).on_hover_text(tip);
            ui.end_row();
        };
        row(
            "Eye separation",
            &mut stereo.eye_distance_mm,
            EYE_DISTANCE_MM,
            " mm",
            "More separation gives more depth; people's eyes are 55 to 75 mm apart",
        );
        row(
            "Convergence",
            &mut stereo.convergence_percent,
            CONVERGENCE_PERCENT,
            " %",
            "Distance that appears at screen depth, in percent of the distance to the sculpture's \
             centre; less pushes the sculpture behind the screen",
        );
    });
    let response = ui.checkbox(&mut state.view.stereo.swap_eyes, "Swap eyes");
    explain(response, context, Action::SwapEyes);
}

/// Chooses the layout.
pub fn layouts(ui: &mut Ui, state: &mut UiState, context: &UiContext) {
    let chosen = state.view.stereo.layout;
    let response = ComboBox::from_id_salt("stereo layout")
        .width(112.0)
        .selected_text(chosen.label())
        .show_ui(ui, |ui| {
            for layout in StereoLayout::ALL {
                self::layout(ui, state, context, layout);
            }
        })
        .response;
    explain(response, context, Action::NextStereo);
}

/// Shows one of the choices.
pub fn layout(ui: &mut Ui, state: &mut UiState, context: &UiContext, layout: StereoLayout) {
    let can = layout != StereoLayout::Layers || context.quad_buffered;
    ui.add_enabled_ui(can, |ui| {
        ui.selectable_value(&mut state.view.stereo.layout, layout, layout.label())
            .on_disabled_hover_text("This display does not support quad-buffered stereo");
    });
}
