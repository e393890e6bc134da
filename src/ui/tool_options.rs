//! The options of the tool in hand: size, rotation, colour, where it goes.

use egui::{Color32, DragValue, Sense, Slider, Ui, vec2};
use glam::Vec3;

use super::buttons::{action_button, explain};
use super::hand::HALF_RANGE;
use super::toolbox::mode_name;
use super::top_bar::capital;
use super::{Facts, Intent, UiState};
use crate::input::Action;
use crate::sculpture::{ColourDepth, Rgb};

const AXES: [&str; 3] = ["X", "Y", "Z"];
/// Stone, metal, plants, water and the signal colours.
const PALETTE: [Rgb; 14] = [
    Rgb::new(0xf2, 0xee, 0xe6),
    Rgb::new(0xc8, 0xbe, 0xaa),
    Rgb::new(0x8c, 0x84, 0x78),
    Rgb::new(0x3c, 0x3a, 0x38),
    Rgb::new(0x6e, 0x46, 0x2a),
    Rgb::new(0xb9, 0x7a, 0x45),
    Rgb::new(0xd0, 0x5a, 0x32),
    Rgb::new(0xb8, 0x26, 0x2e),
    Rgb::new(0xe8, 0xb4, 0x3a),
    Rgb::new(0x7c, 0xa6, 0x3c),
    Rgb::new(0x2f, 0x6b, 0x3a),
    Rgb::new(0x4f, 0xa8, 0xb8),
    Rgb::new(0x2c, 0x5f, 0xa8),
    Rgb::new(0x7a, 0x4c, 0x9c),
];

pub fn show(ui: &mut Ui, state: &mut UiState, facts: &Facts, intents: &mut Vec<Intent>) {
    let hand = &state.hand;
    ui.label(format!("{} — {}", capital(hand.solid.name()), mode_name(hand.mode).to_lowercase()));
    size(ui, state);
    rotation(ui, state);
    colour(ui, state, facts);
    let follow = ui.checkbox(&mut state.hand.follow, "Follow the pointer");
    explain(follow, state, facts, Action::ToggleFollow);
    ui.checkbox(&mut state.hand.snap, "Snap to voxels")
        .on_hover_text("Keep the centre of the tool at centres of voxels");
    action_button(ui, state, facts, "Reset the tool", Action::ResetTool, true, intents);
}

fn size(ui: &mut Ui, state: &mut UiState) {
    let hand = &mut state.hand;
    let range = 2.0 * HALF_RANGE.start()..=2.0 * HALF_RANGE.end();
    ui.horizontal(|ui| {
        let label = ui.label("Size");
        let mut size = 2.0 * hand.half().max_element();
        let slider = Slider::new(&mut size, 1.0..=512.0)
            .logarithmic(true)
            .clamping(egui::SliderClamping::Never)
            .max_decimals(1);
        let response = ui.add(slider).labelled_by(label.id);
        if response.on_hover_text("Longest side in voxels").changed() {
            hand.scale_by(0.5 * size / hand.half().max_element());
        }
    });
    ui.horizontal(|ui| {
        for (axis, name) in AXES.iter().enumerate() {
            let mut size = 2.0 * hand.half()[axis];
            let speed = 0.02 * size.max(1.0);
            let value = DragValue::new(&mut size)
                .range(range.clone())
                .speed(speed)
                .max_decimals(1)
                .prefix(format!("{name} "));
            let hint = format!("Size along the tool's {name} axis in voxels");
            if ui.add(value).on_hover_text(hint).changed() {
                hand.set_half(axis, 0.5 * size);
            }
        }
    });
    let mut uniform = hand.uniform;
    ui.horizontal(|ui| {
        ui.checkbox(&mut uniform, "Keep proportions")
            .on_hover_text("Changing one side changes all");
        let sides = hand.half();
        let even = sides.max_element() - sides.min_element() < 1e-3;
        if ui
            .add_enabled(!even, egui::Button::new("Even"))
            .on_hover_text("All sides alike")
            .clicked()
        {
            hand.even_out();
        }
    });
    hand.uniform = uniform;
}

fn rotation(ui: &mut Ui, state: &mut UiState) {
    ui.horizontal(|ui| {
        ui.label("Rotation");
        let reset = egui::Button::new("Upright");
        let turned = state.hand.turn_deg() != Vec3::ZERO;
        if ui.add_enabled(turned, reset).on_hover_text("No rotation").clicked() {
            state.hand.set_turn_deg(Vec3::ZERO);
        }
    });
    ui.horizontal(|ui| {
        let mut turn_deg = state.hand.turn_deg();
        let mut changed = false;
        for (axis, name) in AXES.iter().enumerate() {
            let value = DragValue::new(&mut turn_deg[axis])
                .range(-180.0..=180.0)
                .speed(1.0)
                .max_decimals(0)
                .prefix(format!("{name} "))
                .suffix("°");
            let hint = format!("Rotation about the grid's {name} axis");
            changed |= ui.add(value).on_hover_text(hint).changed();
        }
        if changed {
            state.hand.set_turn_deg(turn_deg);
        }
    });
}

fn colour(ui: &mut Ui, state: &mut UiState, facts: &Facts) {
    if facts.document.material().depth() == ColourDepth::None {
        ui.weak("This sculpture has one colour only");
        return;
    }
    ui.horizontal(|ui| {
        let label = ui.label("Colour");
        ui.color_edit_button_srgb(&mut state.hand.colour.0).labelled_by(label.id);
        ui.monospace(state.hand.colour.to_string());
    });
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        for colour in PALETTE {
            if swatch(ui, colour, colour == state.hand.colour) {
                state.hand.colour = colour;
            }
        }
    });
}

fn swatch(ui: &mut Ui, colour: Rgb, chosen: bool) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(26.0, 18.0), Sense::click());
    let [r, g, b] = colour.0;
    let rim = if chosen || response.hovered() {
        egui::Stroke::new(2.0, ui.visuals().strong_text_color())
    } else {
        egui::Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color)
    };
    let fill = Color32::from_rgb(r, g, b);
    ui.painter().rect(rect, 3.0, fill, rim, egui::StrokeKind::Inside);
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::WidgetType::ColorButton, true, chosen, colour.to_string())
    });
    response.on_hover_text(colour.to_string()).clicked()
}
