//! The options of the spray tool in hand; each tool shows what it has a use for. The sizes of all brushes have one unit.

use egui::{Slider, Ui};

use super::UiRequest;
use super::top_bar::capital;
use crate::command::SpraySurface;
use crate::editor::sizes::SizeUnit;
use crate::editor::sprays::SprayOptions;
use crate::editor::tool::{ToolEdit, ToolState};
use crate::tools::brush::footprint::Outline;
use crate::tools::brush::spray::{MAX_REACH_VX, SprayKind};

/// Leaves room for a name before and a number with its unit behind.
const SLIDER_WIDTH: f32 = 80.0;

pub fn show(
    ui: &mut Ui,
    options: &mut SprayOptions,
    kind: SprayKind,
    tool: &ToolState,
    requests: &mut Vec<UiRequest>,
) {
    use SprayKind::{Clay, Devourer, Dilation, Erosion, Growth, Mask, Paintbrush, Smooth, Unmask};
    ui.spacing_mut().slider_width = SLIDER_WIDTH;
    egui::Grid::new("spray").num_columns(2).show(ui, |ui| {
        radius(ui, &mut options.radius, tool.size_unit, requests);
        ui.label("Brush shape");
        outline(ui, &mut options.outline, "Circular brush", "Square brush");
        ui.end_row();
        if !matches!(kind, Paintbrush | Smooth) {
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
        if matches!(kind, Paintbrush | Smooth) {
            let label = ui.label("Strength");
            let mut percent = options.strength * 100.0;
            let slider = Slider::new(&mut percent, 1.0..=100.0).fixed_decimals(0).suffix(" %");
            let hint = match kind {
                Smooth => "How much of what is smaller than the brush each use takes away; it goes on while the button is held",
                _ => "How much of the colour each pass mixes in",
            };
            if ui.add(slider).labelled_by(label.id).on_hover_text(hint).changed() {
                options.strength = percent / 100.0;
            }
            ui.end_row();
        }
    });
    if !matches!(kind, Paintbrush | Smooth | Mask | Unmask) {
        let mut once = options.surface == SpraySurface::Stroke;
        ui.checkbox(&mut once, "Once per stroke").on_hover_text(
            "Uses the surface as it was when the stroke began, so that overlapping parts of the \
             stroke are not cut or raised twice",
        );
        options.surface = if once { SpraySurface::Stroke } else { SpraySurface::Now };
    }
    if ui.button("Reset options").clicked() {
        let usual = SprayOptions::of(kind);
        *options = SprayOptions { radius: tool.usual_radius(usual.radius), ..usual };
    }
}

/// The radius of a brush, and the unit in which the radii of all brushes are given.
pub fn radius(ui: &mut Ui, radius: &mut f32, in_unit: SizeUnit, requests: &mut Vec<UiRequest>) {
    let label = ui.label("Radius");
    let (decimals, hint) = match in_unit {
        SizeUnit::Screen => (0, "Radius of the brush on the screen, in pixels"),
        SizeUnit::Sculpture => (1, "Radius of the brush in the sculpture, in voxels"),
    };
    let slider = Slider::new(radius, in_unit.radii())
        .logarithmic(true)
        .max_decimals(decimals)
        .suffix(in_unit.suffix());
    ui.add(slider).labelled_by(label.id).on_hover_text(hint);
    ui.end_row();
    ui.label("Size on");
    ui.horizontal(|ui| {
        for unit in SizeUnit::ALL {
            let hint = match unit {
                SizeUnit::Screen => "All brushes keep their sizes on the screen, in pixels, however near the sculpture is",
                SizeUnit::Sculpture => "All brushes keep their sizes on the sculpture, in voxels, however near it is",
            };
            let response = ui.selectable_label(unit == in_unit, capital(unit.name()));
            if response.on_hover_text(hint).clicked() && unit != in_unit {
                requests.push(UiRequest::Tool(ToolEdit::SizeUnit(unit)));
            }
        }
    });
    ui.end_row();
}

fn outline(ui: &mut Ui, outline: &mut Outline, round: &str, square: &str) {
    ui.horizontal(|ui| {
        for choice in Outline::ALL {
            let hint = if choice == Outline::Round { round } else { square };
            ui.selectable_value(outline, choice, capital(choice.name())).on_hover_text(hint);
        }
    });
}
