//! The rows of options in the dialog of a final picture. Each changes a choice of the [`FinalDialog`].

use std::ops::RangeInclusive;

use egui::{Checkbox, ComboBox, DragValue, Slider, Ui};

use crate::trace::{
    AreaLight, LightOptions, MAX_BOUNCES, MAX_FINAL_SAMPLES, SunLight, TraceGround,
};
use crate::ui::dialogs::final_choices::FinalDialog;
use crate::ui::pictures::FinalFile;

pub fn quality(ui: &mut Ui, dialog: &mut FinalDialog) {
    let label = ui.label("Samples");
    let samples = Slider::new(&mut dialog.trace.samples, 1..=MAX_FINAL_SAMPLES).logarithmic(true);
    ui.add(samples)
        .labelled_by(label.id)
        .on_hover_text("Rays per pixel: four times as many halve the noise");
    ui.end_row();
    ui.label("");
    ui.checkbox(&mut dialog.denoise, "Remove noise")
        .on_hover_text("Filters the remaining noise without blurring edges");
    ui.end_row();
    let label = ui.label("Bounces");
    ui.add(Slider::new(&mut dialog.trace.bounces, 0..=MAX_BOUNCES).logarithmic(true))
        .labelled_by(label.id)
        .on_hover_text("Maximum number of reflections: 0 means no light from surface to surface");
    ui.end_row();
    let label = ui.label("Exposure");
    let exposure = Slider::new(&mut dialog.exposure_ev, -10.0..=10.0).suffix(" EV").max_decimals(1);
    ui.add(exposure)
        .labelled_by(label.id)
        .on_hover_text("Each unit doubles the light in PNG and JPEG");
    ui.end_row();
}

pub fn light(ui: &mut Ui, light: &mut LightOptions) {
    let LightOptions::Outdoors { sun, sky, .. } = light else { return };
    let SunLight { azimuth_deg, elevation_deg, size_deg, strength } = sun;
    for (name, value, range, suffix, help) in [
        (
            "Sun azimuth",
            azimuth_deg,
            -180.0..=180.0,
            "°",
            "Direction of the sun: 0 is behind the viewer, larger values are to the right",
        ),
        (
            "Sun elevation",
            elevation_deg,
            0.0..=90.0,
            "°",
            "Height of the sun above the horizon; at 0 it has set",
        ),
        ("Sun size", size_deg, 0.2..=60.0, "°", "The larger, the softer the shadows"),
        ("Sun strength", strength, 0.0..=10.0, "", "1 is a clear day"),
        ("Sky", sky, 0.0..=10.0, "", "Strength of the sky light; 1 is a clear day"),
    ] {
        number(ui, name, value, range, suffix, help);
    }
}

/// Shows the lamp, a light besides those of [`LightOptions::Outdoors`].
pub fn lamp(ui: &mut Ui, dialog: &mut FinalDialog) {
    let LightOptions::Outdoors { area_light, .. } = &mut dialog.trace.light else { return };
    ui.label("");
    let mut is_on = area_light.is_some();
    ui.checkbox(&mut is_on, "Lamp").on_hover_text(
        "A square lamp that faces the middle of the sculpture from three radii away",
    );
    ui.end_row();
    if is_on {
        let AreaLight { azimuth_deg, elevation_deg, size, strength } = &mut dialog.lamp;
        for (name, value, range, suffix, help) in [
            (
                "Lamp azimuth",
                azimuth_deg,
                -180.0..=180.0,
                "°",
                "Direction of the lamp: 0 is behind the viewer, larger values are to the right",
            ),
            ("Lamp elevation", elevation_deg, -90.0..=90.0, "°", "Its height above the horizon"),
            (
                "Lamp size",
                size,
                0.01..=5.0,
                "",
                "Edge length in radii of the sculpture: the larger, the softer the shadows",
            ),
            ("Lamp strength", strength, 0.0..=10.0, "", "1 is about that of the sun"),
        ] {
            number(ui, name, value, range, suffix, help);
        }
    }
    *area_light = is_on.then_some(dialog.lamp);
}

fn number(
    ui: &mut Ui,
    name: &str,
    value: &mut f32,
    range: RangeInclusive<f32>,
    suffix: &str,
    help: &str,
) {
    let label = ui.label(name);
    let slider = Slider::new(value, range).suffix(suffix).max_decimals(2);
    ui.add(slider).labelled_by(label.id).on_hover_text(help);
    ui.end_row();
}

pub fn ground(ui: &mut Ui, dialog: &mut FinalDialog) {
    ui.label("");
    ui.horizontal(|ui| {
        let mut has_ground = dialog.trace.ground.is_some();
        ui.checkbox(&mut has_ground, "Ground")
            .on_hover_text("A flat ground that the sculpture stands on and casts its shadow on");
        ui.add_enabled_ui(has_ground, |ui| {
            ui.color_edit_button_srgb(&mut dialog.ground.0).on_hover_text("Colour of the ground");
        });
        dialog.trace.ground = has_ground.then_some(TraceGround { colour: dialog.ground });
    });
    ui.end_row();
}

pub fn lens(ui: &mut Ui, dialog: &mut FinalDialog) {
    let lens = &mut dialog.trace.lens;
    let label = ui.label("Depth of field");
    let mut percent = lens.aperture * 100.0;
    let slider = Slider::new(&mut percent, 0.0..=50.0).suffix(" %").max_decimals(1);
    let slider = ui.add(slider).labelled_by(label.id).on_hover_text(
        "Diameter of the lens as a share of the focus distance; 0 keeps everything sharp, 4 blurs visibly",
    );
    if slider.changed() {
        lens.aperture = percent / 100.0;
    }
    ui.end_row();
    let label = ui.label("Focus");
    let has_focus = lens.aperture > 0.0;
    ui.horizontal(|ui| {
        for (share, prefix, help) in [
            (&mut lens.focus.x, "X ", "Focus point in the picture, from the left"),
            (&mut lens.focus.y, "Y ", "Focus point in the picture, from the top"),
        ] {
            let mut shown = *share * 100.0;
            let value = DragValue::new(&mut shown)
                .range(0.0..=100.0)
                .prefix(prefix)
                .suffix(" %")
                .max_decimals(0);
            let field = ui.add_enabled(has_focus, value).labelled_by(label.id);
            if field.on_hover_text(help).changed() {
                *share = shown / 100.0;
            }
        }
    });
    ui.end_row();
}

pub fn file(ui: &mut Ui, dialog: &mut FinalDialog) {
    let label = ui.label("File");
    ComboBox::from_id_salt("final file")
        .width(150.0)
        .selected_text(dialog.file.name())
        .show_ui(ui, |ui| {
            for file in FinalFile::ALL {
                let choice = ui.selectable_value(&mut dialog.file, file, file.name());
                choice.on_hover_text(file.help());
            }
        })
        .response
        .labelled_by(label.id)
        .on_hover_text(dialog.file.help());
    ui.end_row();
    ui.label("");
    ui.add(Checkbox::new(&mut dialog.on_gpu, "Trace on the graphics device"))
        .on_hover_text("Much faster on a GPU, but shows voxel cubes instead of the smooth surface");
    ui.end_row();
}
