//! The window of colours: hue, saturation and value, gradients and noise for an area, each as a command.
//!
//! Gives [`UiRequest::Run`]; changes no sculpture itself.

use egui::{Button, DragValue, Grid, Slider, Ui, Window, pos2};
use glam::Vec3;

use crate::command::{Area, Command};
use crate::document::Document;
use crate::editor::tool::ToolEdit;
use crate::sculpture::region::Region;
use crate::sculpture::{ColourDepth, Rgb};
use crate::tools::tint::{SIZE_RANGE, Tint};
use crate::ui::context::UiContext;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

const WIDTH: f32 = 290.0;
/// Least width of the names before sliders.
const NAME_WIDTH: f32 = 76.0;
/// Largest factor on saturation and value of the sliders; scripts may go further.
const MOST_FACTOR: f32 = 2.0;

/// The tools that the window offers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum TintTool {
    Adjust,
    Gradient,
    Noise,
}

/// The state that the window remembers.
#[derive(Clone, PartialEq, Debug)]
pub struct Tints {
    pub open: bool,
    area: Area,
    kind: TintTool,
    hue_deg: f32,
    saturation: f32,
    value: f32,
    /// The colours of the gradient, lower end first.
    colours: [Rgb; 2],
    /// The axis of the gradient.
    axis: usize,
    strength: f32,
    /// Size of patches of noise.
    size: f32,
    amount: f32,
    seed: u32,
}

impl Default for Tints {
    fn default() -> Tints {
        Tints {
            open: false,
            area: Area::Grid,
            kind: TintTool::Adjust,
            hue_deg: 0.0,
            saturation: 1.0,
            value: 1.0,
            colours: [Rgb::new(0x3a, 0x5f, 0x2e), Rgb::new(0xe8, 0xdc, 0xb8)],
            axis: 1,
            strength: 1.0,
            size: 16.0,
            amount: 0.5,
            seed: 0,
        }
    }
}

impl Tints {
    /// Returns the chosen tint. A gradient spans the existing voxels of the area.
    fn tint(&self, context: &UiContext) -> Tint {
        match self.kind {
            TintTool::Adjust => Tint::Adjust {
                hue_deg: self.hue_deg,
                saturation: self.saturation,
                value: self.value,
            },
            TintTool::Gradient => {
                let [from_vx, to_vx] = ends(context.document, self.area, self.axis);
                Tint::Gradient { from_vx, to_vx, colours: self.colours, strength: self.strength }
            }
            TintTool::Noise => Tint::Noise {
                colour: context.tool.colour,
                size: self.size,
                amount: self.amount,
                seed: self.seed,
            },
        }
    }
}

/// Returns the centres of the lower and the upper side, along an axis, of the existing voxels in an area.
fn ends(document: &Document, area: Area, axis: usize) -> [Vec3; 2] {
    let grid = document.grid();
    let (mut low, mut high) = grid
        .opaque_bounds()
        .map_or((Vec3::ZERO, grid.dims().as_vec3()), |(min, max)| (min.as_vec3(), max.as_vec3()));
    let bounds = match area {
        Area::Grid => None,
        Area::Marker => Some(document.selection().marker()),
        Area::Selection => Some(document.selection().stack().bounds_vx()),
    };
    if let Some(bounds) = bounds {
        let (min, max) = (bounds.min.as_vec3(), bounds.max.as_vec3());
        // Beside the sculpture there is nothing to recolour, and the command reports it.
        (low, high) = (low.max(min), high.min(max).max(low.max(min) + 1.0));
    }
    let middle = (low + high) * 0.5;
    let mut ends = [middle; 2];
    (ends[0][axis], ends[1][axis]) = (low[axis], high[axis]);
    ends
}

impl Dialog for Tints {
    fn is_open(&self) -> bool {
        self.open
    }

    fn is_modal(&self) -> bool {
        false
    }

    fn close(&mut self) -> bool {
        std::mem::take(&mut self.open)
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let DialogContext { context, requests, .. } = shared;
        if !self.open {
            return;
        }
        let mut open = true;
        Window::new("Colours")
            .open(&mut open)
            .resizable(false)
            .default_width(WIDTH)
            .default_pos(pos2(theme::TOOLBOX_WIDTH + 28.0, 52.0))
            .show(root.ctx(), |ui| {
                ui.set_width(WIDTH);
                if context.document.material().depth() == ColourDepth::None {
                    ui.weak("This sculpture has only one colour; a new one can have more");
                    return;
                }
                choices(ui, self, context);
                ui.separator();
                match self.kind {
                    TintTool::Adjust => adjustment(ui, self),
                    TintTool::Gradient => gradient(ui, self),
                    TintTool::Noise => noise(ui, self, context),
                }
                ui.add_space(4.0);
                let apply = ui.add(Button::new("Apply").min_size([90.0, 24.0].into()));
                if apply
                    .on_hover_text("Recolour all voxels of the area, including those inside")
                    .clicked()
                {
                    let (area, tint) = (self.area, self.tint(context));
                    requests.push(UiRequest::Run(Command::Tint { area, tint }));
                }
                ui.separator();
                flood(ui, context, requests);
            });
        self.open &= open;
    }
}

/// Shows the tolerance for colours that a flood treats as equal.
fn flood(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    Grid::new("flood").num_columns(2).min_col_width(NAME_WIDTH).show(ui, |ui| {
        let mut tolerance = context.tool.flood_tolerance;
        let label = ui.label("Flood tolerance");
        let value = ui.add(percent(&mut tolerance, 1.0)).labelled_by(label.id);
        let help = "Largest colour difference within a flooded patch";
        if value.on_hover_text(help).changed() {
            requests.push(UiRequest::Tool(ToolEdit::FloodTolerance(tolerance)));
        }
        ui.end_row();
    });
}

/// Shows the choices of voxels and of the change.
fn choices(ui: &mut Ui, window: &mut Tints, context: &UiContext) {
    ui.horizontal(|ui| {
        for (area, name, help) in [
            (
                Area::Grid,
                "Everything",
                "All voxels, within the selection if tools are limited to it",
            ),
            (Area::Selection, "Selected boxes", "The boxes of the selection"),
            (Area::Marker, "Marker's box", "The box of the marker"),
        ] {
            let is_there =
                area != Area::Selection || !context.document.selection().boxes().is_empty();
            ui.add_enabled_ui(is_there, |ui| {
                ui.radio_value(&mut window.area, area, name)
                    .on_hover_text(help)
                    .on_disabled_hover_text("Nothing is selected");
            });
        }
    });
    if window.area == Area::Selection && context.document.selection().boxes().is_empty() {
        window.area = Area::Grid;
    }
    ui.horizontal(|ui| {
        for (kind, name, help) in [
            (TintTool::Adjust, "Adjust", "Change hue, saturation and value"),
            (TintTool::Gradient, "Gradient", "From one colour to another along an axis"),
            (TintTool::Noise, "Noise", "Irregular patches of the tool's colour"),
        ] {
            ui.selectable_value(&mut window.kind, kind, name).on_hover_text(help);
        }
    });
}

/// Shows a named slider in a row of a table.
fn slider(ui: &mut Ui, name: &str, slider: Slider<'_>, help: &str) {
    let label = ui.label(name);
    ui.add(slider).labelled_by(label.id).on_hover_text(help);
    ui.end_row();
}

fn percent(value: &mut f32, most: f32) -> Slider<'_> {
    let shown = |value: f64, _| format!("{:.0} %", value * 100.0);
    let read = |text: &str| text.trim_end_matches('%').trim().parse().ok().map(|v: f64| v / 100.0);
    Slider::new(value, 0.0..=most).custom_formatter(shown).custom_parser(read)
}

fn adjustment(ui: &mut Ui, window: &mut Tints) {
    Grid::new("adjust").num_columns(2).min_col_width(NAME_WIDTH).show(ui, |ui| {
        let hue = Slider::new(&mut window.hue_deg, -180.0..=180.0).suffix("°").max_decimals(0);
        slider(
            ui,
            "Hue",
            hue,
            "Rotates the hue: at 120° red becomes green, green blue, and blue red",
        );
        slider(
            ui,
            "Saturation",
            percent(&mut window.saturation, MOST_FACTOR),
            "0 % makes everything grey; over 100 % is more colourful",
        );
        slider(ui, "Value", percent(&mut window.value, MOST_FACTOR), "Darker or brighter");
    });
    if ui.button("Reset").on_hover_text("Reset to no change").clicked() {
        (window.hue_deg, window.saturation, window.value) = (0.0, 1.0, 1.0);
    }
}

fn gradient(ui: &mut Ui, window: &mut Tints) {
    Grid::new("gradient").num_columns(2).min_col_width(NAME_WIDTH).show(ui, |ui| {
        ui.label("Along");
        ui.horizontal(|ui| {
            for (axis, (name, help)) in [
                ("X", "From left to right"),
                ("Y", "From the bottom to the top"),
                ("Z", "From the back to the front"),
            ]
            .into_iter()
            .enumerate()
            {
                ui.radio_value(&mut window.axis, axis, name).on_hover_text(help);
            }
        });
        ui.end_row();
        ui.label("From, to");
        ui.horizontal(|ui| {
            let [from, to] = &mut window.colours;
            ui.color_edit_button_srgb(&mut from.0).on_hover_text("Colour at the start of the axis");
            ui.color_edit_button_srgb(&mut to.0).on_hover_text("Colour at the end of the axis");
            if ui.button("Swap").on_hover_text("Exchange the two colours").clicked() {
                std::mem::swap(from, to);
            }
        });
        ui.end_row();
        slider(
            ui,
            "Strength",
            percent(&mut window.strength, 1.0),
            "Share of the gradient that is mixed in",
        );
    });
}

fn noise(ui: &mut Ui, window: &mut Tints, context: &UiContext) {
    Grid::new("noise").num_columns(2).min_col_width(NAME_WIDTH).show(ui, |ui| {
        let size = Slider::new(&mut window.size, SIZE_RANGE).logarithmic(true).max_decimals(0);
        slider(ui, "Size", size.suffix(" vx"), "Size of the largest patches");
        slider(
            ui,
            "Amount",
            percent(&mut window.amount, 1.0),
            "Largest share of the colour that is mixed in",
        );
        let label = ui.label("Pattern");
        ui.add(DragValue::new(&mut window.seed).speed(0.1))
            .labelled_by(label.id)
            .on_hover_text("Each number gives a different pattern");
        ui.end_row();
    });
    ui.weak(format!("Blends in the tool's colour, {}", context.tool.colour));
}
