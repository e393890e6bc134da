//! The options of the spray tool in hand; each tool shows what it has a use for.

use egui::{Slider, Ui};

use super::top_bar::capital;
use crate::command::SpraySurface;
use crate::editor::sprays::SprayOptions;
use crate::tools::footprint::{MAX_FOOTPRINT, Outline};
use crate::tools::spray::{MAX_REACH_VX, SprayKind};

/// Leaves room for a name before and a number with its unit behind.
const SLIDER_WIDTH: f32 = 80.0;

pub fn show(ui: &mut Ui, options: &mut SprayOptions, kind: SprayKind) {
    use SprayKind::{Clay, Devourer, Dilation, Erosion, Growth, Mask, Paintbrush, Smooth, Unmask};
    ui.spacing_mut().slider_width = SLIDER_WIDTH;
    egui::Grid::new("spray").num_columns(2).show(ui, |ui| {
        let label = ui.label("Radius");
        let slider = Slider::new(&mut options.radius_px, 1.0..=MAX_FOOTPRINT)
            .logarithmic(true)
            .max_decimals(0)
            .suffix(" px");
        ui.add(slider).labelled_by(label.id).on_hover_text("Radius of the brush on the screen");
        ui.end_row();
        ui.label("Brush shape");
        outline(ui, &mut options.outline, "Circular brush", "Square brush");
        ui.end_row();
        if kind != Paintbrush {
            let (name, hint) = match kind {
                Devourer => ("Depth", "How deep it cuts into the surface under the brush"),
                Mask | Unmask => ("Depth", "How far from the surface voxels are protected, outwards, too"),
                Clay => ("Height", "Height of the mound under the middle of the brush"),
                _ => ("Reach", "How far from the surface voxels may change"),
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
            ui.label("Cut shape");
            outline(ui, &mut options.bite, "Cut balls", "Cut cubes");
            ui.end_row();
        }
        if matches!(kind, Erosion | Dilation | Growth) {
            let label = ui.label("Threshold");
            let hint = match kind {
                Erosion => "Voxels with fewer of their 26 neighbours are removed; up to 17 keeps flat faces",
                _ => "Gaps with at least this many of their 26 neighbours are filled; 10 or more keeps flat faces",
            };
            let slider = Slider::new(&mut options.threshold, 1..=26);
            ui.add(slider).labelled_by(label.id).on_hover_text(hint);
            ui.end_row();
        }
        if kind == Smooth {
            let label = ui.label("Average");
            let slider = Slider::new(&mut options.around_vx, 1..=8).suffix(" vx");
            ui.add(slider)
                .labelled_by(label.id)
                .on_hover_text("Radius of the neighbourhood whose majority decides whether a voxel is filled");
            ui.end_row();
        }
        if kind == Paintbrush {
            let label = ui.label("Strength");
            let mut percent = options.cover * 100.0;
            let slider = Slider::new(&mut percent, 1.0..=100.0).fixed_decimals(0).suffix(" %");
            let hint = "How much of the colour each pass mixes in";
            if ui.add(slider).labelled_by(label.id).on_hover_text(hint).changed() {
                options.cover = percent / 100.0;
            }
            ui.end_row();
        }
    });
    if !matches!(kind, Paintbrush | Mask | Unmask) {
        let mut once = options.surface == SpraySurface::Stroke;
        ui.checkbox(&mut once, "Once per stroke").on_hover_text(
            "Uses the surface as it was when the stroke began, so that overlapping parts of the \
             stroke are not cut or raised twice",
        );
        options.surface = if once { SpraySurface::Stroke } else { SpraySurface::Now };
    }
    if ui.button("Reset options").clicked() {
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
