//! The options of a brush, made from its description; the sizes of all brushes have one unit.

use egui::{Slider, Ui};

use crate::editor::sizes::SizeUnit;
use crate::editor::tool::ToolEdit;
use crate::input::Action;
use crate::tools::brush::BrushId;
use crate::tools::brush::keys::{RADIUS, STEADY};
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::param::{Choice, Domain, OptionValue, Param, Unit};
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::widgets::buttons::explain;
use crate::ui::widgets::names::capital;
use crate::ui::widgets::spot::{self, Spot};

/// Leaves room for a name before it and a number with its unit after it.
const SLIDER_WIDTH: f32 = 80.0;

pub fn show(ui: &mut Ui, brush: BrushId, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let tool = context.tool;
    ui.label(brush.spec().title());
    let before = *tool.brushes.of(brush);
    let mut options = before;
    ui.spacing_mut().slider_width = SLIDER_WIDTH;
    let shown = || before.iter().filter(|(param, _)| !(param.needs_pointer && context.in_headset));
    let is_switch = |param: &Param| param.domain == Domain::Switch;
    egui::Grid::new("brush").num_columns(2).show(ui, |ui| {
        for (param, value) in shown().filter(|(param, _)| !is_switch(param)) {
            let changed = row(ui, param, value, tool.brushes.unit);
            options.set_value(param.key, changed);
            ui.end_row();
            if param.domain == Domain::Radius {
                size_unit(ui, tool.brushes.unit, requests);
            }
        }
    });
    for (param, value) in shown() {
        if let OptionValue::On(mut on) = value {
            ui.checkbox(&mut on, param.label).on_hover_text(param.help);
            options.set_value(param.key, OptionValue::On(on));
        }
    }
    if ui.button("Reset options").clicked() {
        let first = BrushOptions::first(brush);
        options = first.with(RADIUS, tool.brushes.usual_radius(first.get(RADIUS)));
    }
    if options != before {
        requests.push(UiRequest::Tool(ToolEdit::Brush(options)));
    }
    if !brush.spec().is_in_picture() && !context.in_headset {
        let mut follow = tool.follow;
        let response = ui.checkbox(&mut follow, "Follow the pointer");
        if response.changed() {
            requests.push(UiRequest::Tool(ToolEdit::Follow(follow)));
        }
        explain(response, context, Action::ToggleFollow);
    }
}

/// Shows the row of an option. Returns its new value.
fn row(ui: &mut Ui, param: &Param, value: OptionValue, in_unit: SizeUnit) -> OptionValue {
    let label = ui.label(param.label);
    match (param.domain, value) {
        (Domain::Choice(choices), OptionValue::Choice(place)) => {
            OptionValue::Choice(choice(ui, choices, place))
        }
        (Domain::Whole([least, most]), OptionValue::Whole(mut count)) => {
            let slider = Slider::new(&mut count, least..=most);
            ui.add(slider).labelled_by(label.id).on_hover_text(param.help);
            OptionValue::Whole(count)
        }
        (domain, OptionValue::Number(number)) => {
            let (range, hint) = match (domain, in_unit) {
                (Domain::Number([least, most]), _) => (least..=most, param.help),
                (_, SizeUnit::Screen) => {
                    (in_unit.radii(), "Radius of the brush on the screen, in pixels")
                }
                (_, SizeUnit::Sculpture) => {
                    (in_unit.radii(), "Radius of the brush in the sculpture, in voxels")
                }
            };
            let (decimals, suffix) = match (domain, in_unit, param.unit) {
                (Domain::Radius, SizeUnit::Screen, _) => (0, in_unit.suffix()),
                (Domain::Radius, SizeUnit::Sculpture, _) => (1, in_unit.suffix()),
                (_, _, unit @ (Unit::Share | Unit::Pixels)) => (0, unit.suffix()),
                (_, _, unit @ Unit::Voxels) => (1, unit.suffix()),
                (_, _, unit @ Unit::Plain) => (2, unit.suffix()),
            };
            let factor = param.unit.factor();
            let mut shown = number * factor;
            let slider = Slider::new(&mut shown, range.start() * factor..=range.end() * factor)
                .logarithmic(param.logarithmic)
                .smallest_positive(1.0)
                .max_decimals(decimals)
                .suffix(suffix);
            let response = ui.add(slider).labelled_by(label.id).on_hover_text(hint);
            if param.key == STEADY.param.key {
                spot::mark(&response, Spot::Steady);
            }
            OptionValue::Number(if response.changed() { shown / factor } else { number })
        }
        _ => value,
    }
}

/// Chooses the unit of the radii of all brushes.
fn size_unit(ui: &mut Ui, in_unit: SizeUnit, requests: &mut Vec<UiRequest>) {
    ui.label("Size on");
    ui.horizontal(|ui| {
        for unit in SizeUnit::ALL {
            let hint = match unit {
                SizeUnit::Screen => "Brush sizes are fixed on the screen, in pixels, at any zoom",
                SizeUnit::Sculpture => {
                    "Brush sizes are fixed on the sculpture, in voxels, at any zoom"
                }
            };
            let response = ui.selectable_label(unit == in_unit, capital(unit.name()));
            if response.on_hover_text(hint).clicked() && unit != in_unit {
                requests.push(UiRequest::Tool(ToolEdit::SizeUnit(unit)));
            }
        }
    });
    ui.end_row();
}

/// Shows the choices side by side. Returns the index of the chosen one.
fn choice(ui: &mut Ui, choices: &[Choice], mut chosen: u8) -> u8 {
    ui.horizontal(|ui| {
        for (place, choice) in choices.iter().enumerate() {
            ui.selectable_value(&mut chosen, place as u8, capital(choice.name))
                .on_hover_text(choice.help);
        }
    });
    chosen
}
