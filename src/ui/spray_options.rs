//! The options of the spray tool in hand; each tool shows what it has a use for.

use egui::{Slider, Ui};

use super::sprays::SprayOptions;
use super::top_bar::capital;
use crate::command::SpraySurface;
use crate::tools::spray::{MAX_FOOTPRINT, MAX_REACH_VX, Outline, SprayKind};

/// Leaves room for a name before and a number with its unit behind.
const SLIDER_WIDTH: f32 = 80.0;

pub fn show(ui: &mut Ui, options: &mut SprayOptions, kind: SprayKind) {
    use SprayKind::{Clay, Devourer, Dilation, Erosion, Growth, Paintbrush, Smooth};
    ui.spacing_mut().slider_width = SLIDER_WIDTH;
    egui::Grid::new("spray").num_columns(2).show(ui, |ui| {
        let label = ui.label("Radius");
        let slider = Slider::new(&mut options.radius_px, 1.0..=MAX_FOOTPRINT)
            .logarithmic(true)
            .max_decimals(0)
            .suffix(" px");
        ui.add(slider).labelled_by(label.id).on_hover_text("Of the footprint on the screen");
        ui.end_row();
        ui.label("Footprint");
        outline(ui, &mut options.outline, "All rays in a disc", "All rays in a square");
        ui.end_row();
        if kind != Paintbrush {
            let (name, hint) = match kind {
                Devourer => ("Bite", "How deep it bites around every point under the footprint"),
                Clay => ("Height", "Of the mound in the middle of the footprint"),
                _ => ("Reach", "How far around the surface voxels may change"),
            };
            let label = ui.label(name);
            let slider = Slider::new(&mut options.reach_vx, 0.0..=MAX_REACH_VX)
                .logarithmic(true)
                .smallest_positive(1.0)
                .max_decimals(1)
                .suffix(" vx");
            ui.add(slider).labelled_by(label.id).on_hover_text(hint);
            ui.end_row();
        }
        if kind == Devourer {
            ui.label("Shape");
            outline(ui, &mut options.bite, "Bites balls", "Bites cubes");
            ui.end_row();
        }
        if matches!(kind, Erosion | Dilation | Growth) {
            let label = ui.label("Threshold");
            let hint = match kind {
                Erosion => "Voxels with fewer of the 26 neighbours go; up to 17 keeps planes",
                _ => "Gaps with at least so many of the 26 neighbours are filled; from 10 on keeps planes",
            };
            let slider = Slider::new(&mut options.threshold, 1..=26);
            ui.add(slider).labelled_by(label.id).on_hover_text(hint);
            ui.end_row();
        }
        if kind == Smooth {
            let label = ui.label("Around");
            let slider = Slider::new(&mut options.around_vx, 1..=8).suffix(" vx");
            ui.add(slider)
                .labelled_by(label.id)
                .on_hover_text("How far around a voxel the majority decides");
            ui.end_row();
        }
        if kind == Paintbrush {
            let label = ui.label("Cover");
            let mut percent = options.cover * 100.0;
            let slider = Slider::new(&mut percent, 1.0..=100.0).fixed_decimals(0).suffix(" %");
            let hint = "Share of the colour that every pass mixes in";
            if ui.add(slider).labelled_by(label.id).on_hover_text(hint).changed() {
                options.cover = percent / 100.0;
            }
            ui.end_row();
        }
    });
    if kind != Paintbrush {
        let mut once = options.surface == SpraySurface::Stroke;
        ui.checkbox(&mut once, "Once a stroke").on_hover_text(
            "Meets the surface as it was when the stroke began, so that it does not work twice \
             where the stroke overlaps",
        );
        options.surface = if once { SpraySurface::Stroke } else { SpraySurface::Now };
    }
    if ui.button("Reset the options").clicked() {
        *options = SprayOptions::of(kind);
    }
}

fn outline(ui: &mut Ui, outline: &mut Outline, round: &str, square: &str) {
    ui.horizontal(|ui| {
        for choice in Outline::ALL {
            let hint = if choice == Outline::Round { round } else { square };
            ui.selectable_value(outline, choice, capital(choice.name())).on_hover_text(hint);
        }
    });
}
