//! The options of the tool in hand that deforms clay.

use egui::{Slider, Ui};

use super::buttons::explain;
use super::spot::{self, Spot};
use super::spray_options::radius;
use super::top_bar::capital;
use super::{UiContext, UiRequest};
use crate::editor::deform::{DeformOptions, MAX_STEADY_PX};
use crate::editor::tool::ToolEdit;
use crate::input::Action;
use crate::tools::brush::deform::DeformKind;
use crate::tools::brush::kernel::grab::Falloff;

/// Leaves room for a name before and a number with its unit behind.
const SLIDER_WIDTH: f32 = 80.0;

pub fn show(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let kind = context.tool.deform;
    ui.label(kind.brush().spec().label);
    let before = *context.tool.deforms.of(kind);
    let mut options = before;
    ui.spacing_mut().slider_width = SLIDER_WIDTH;
    egui::Grid::new("deform").num_columns(2).show(ui, |ui| {
        radius(ui, &mut options.radius, context.tool.size_unit, requests);
        let label = ui.label("Strength");
        let mut percent = options.strength * 100.0;
        let slider = Slider::new(&mut percent, 0.0..=100.0).fixed_decimals(0).suffix(" %");
        let hint = match kind {
            DeformKind::Grab => "How far the surface goes along with the pointer",
            DeformKind::Inflate => "How far the surface swells: at 100 % by half the radius",
            DeformKind::Draw => "How far the surface is raised: at 100 % by half the radius",
            DeformKind::Crease => "How deep the furrow is: at 100 % half the radius",
            DeformKind::Pinch => "How far the clay comes together",
            DeformKind::Twist => "How far the clay turns with the pointer",
            DeformKind::Smear => "How far the clay goes along with the brush",
            _ => "How far the surface goes to the plane",
        };
        if ui.add(slider).labelled_by(label.id).on_hover_text(hint).changed() {
            options.strength = percent / 100.0;
        }
        ui.end_row();
        let dragged = matches!(kind, DeformKind::Grab | DeformKind::Twist);
        if !dragged && !context.in_headset {
            let label = ui.label("Steady");
            let slider = Slider::new(&mut options.steady_px, 0.0..=MAX_STEADY_PX)
                .fixed_decimals(0)
                .suffix(" px");
            let steady = ui.add(slider).labelled_by(label.id).on_hover_text(
                "The pointer leads the brush on a rope of this length, so that a hand that trembles draws \
                 an even line; 0 without one",
            );
            spot::mark(&steady, Spot::Steady);
            ui.end_row();
        }
        ui.label("Falloff");
        ui.horizontal(|ui| {
            for falloff in Falloff::ALL {
                let hint = match falloff {
                    Falloff::Smooth => "Evenly less from the middle to the rim",
                    Falloff::Sharp => "Quickly less from the middle: a tip",
                    Falloff::Flat => "The same around the middle, then less: as if by a hand",
                };
                ui.selectable_value(&mut options.falloff, falloff, capital(falloff.name()))
                    .on_hover_text(hint);
            }
        });
        ui.end_row();
    });
    if ui.button("Reset options").clicked() {
        let usual = DeformOptions::of(kind);
        options = DeformOptions { radius: context.tool.usual_radius(usual.radius), ..usual };
    }
    if options != before {
        requests.push(UiRequest::Tool(ToolEdit::Deform(kind, options)));
    }
    if !context.in_headset {
        let mut follow = context.tool.follow;
        let response = ui.checkbox(&mut follow, "Follow the pointer");
        if response.changed() {
            requests.push(UiRequest::Tool(ToolEdit::Follow(follow)));
        }
        explain(response, context, Action::ToggleFollow);
    }
}
