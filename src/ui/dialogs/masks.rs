//! The window of masks: protects voxels from all tools by area, colour, shape and wand, and changes the mask's outline.
//!
//! Gives [`UiRequest`]s, most of them commands; changes no sculpture itself.

use egui::{Button, DragValue, Grid, Slider, Ui, Window, pos2};

use crate::command::{Area, Command, MaskArea, MaskChange};
use crate::editor::tool::{NextPress, ToolEdit};
use crate::editor::wand::{Wand, WandRule};
use crate::sculpture::ColourDepth;
use crate::tools::mask::{MAX_GROWTH_VX, MAX_REACH_VX};
use crate::ui::context::UiContext;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

const WIDTH: f32 = 290.0;
/// Least width of the names before sliders.
const NAME_WIDTH: f32 = 76.0;

/// The state that the window remembers.
#[derive(Clone, PartialEq, Debug)]
pub struct Masks {
    pub open: bool,
    /// Adds the chosen voxels to the mask; otherwise removes them.
    adds: bool,
    /// The distance by which the outline moves.
    by_vx: u32,
    /// The distance within which cavities are searched for.
    cavity_vx: u32,
}

impl Default for Masks {
    fn default() -> Masks {
        Masks { open: false, adds: true, by_vx: 2, cavity_vx: 4 }
    }
}

impl Dialog for Masks {
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
        Window::new("Masks")
            .open(&mut open)
            .resizable(false)
            .default_width(WIDTH)
            .default_pos(pos2(theme::TOOLBOX_WIDTH + 28.0, 52.0))
            .show(root.ctx(), |ui| {
                ui.set_width(WIDTH);
                let mut ask = |change| requests.push(UiRequest::Run(Command::Mask(change)));
                whole(ui, context, &mut ask);
                outline(ui, self, context, &mut ask);
                ui.separator();
                sides(ui, &mut self.adds);
                areas(ui, self, context, &mut ask);
                ui.separator();
                wand(ui, self.adds, context, requests);
            });
        self.open &= open;
    }
}

/// Shows a button that is enabled only if there is a mask.
fn of_mask(ui: &mut Ui, context: &UiContext, name: &str, help: &str) -> bool {
    ui.add_enabled(context.document.mask().is_some(), Button::new(name))
        .on_hover_text(help)
        .on_disabled_hover_text("Nothing is masked")
        .clicked()
}

/// Shows the changes to the mask as a whole, and its size.
fn whole(ui: &mut Ui, context: &UiContext, ask: &mut impl FnMut(MaskChange)) {
    ui.horizontal(|ui| {
        let help = "Protect what is not masked, and nothing else";
        if ui.button("Invert").on_hover_text(help).clicked() {
            ask(MaskChange::Invert);
        }
        if of_mask(ui, context, "Clear", "Nothing is protected any more") {
            ask(MaskChange::Clear);
        }
    });
    ui.weak(match context.document.mask() {
        Some(mask) => {
            let voxels = context.document.grid().dims().as_u64vec3().element_product();
            let share = 100.0 * mask.opaque_count() as f64 / voxels as f64;
            format!("{share:.1} % of the grid is protected from all tools")
        }
        None => "Nothing is masked: all tools work everywhere".to_string(),
    });
}

fn outline(ui: &mut Ui, window: &mut Masks, context: &UiContext, ask: &mut impl FnMut(MaskChange)) {
    ui.horizontal(|ui| {
        let by = window.by_vx;
        if of_mask(ui, context, "Grow", "Move its outline outwards") {
            ask(MaskChange::Grow(by));
        }
        if of_mask(ui, context, "Shrink", "Move its outline inwards") {
            ask(MaskChange::Shrink(by));
        }
        if of_mask(ui, context, "Even out", "Even out its outline: fill notches and remove tips") {
            ask(MaskChange::Smooth(by.min(8)));
        }
        ui.add(DragValue::new(&mut window.by_vx).range(1..=MAX_GROWTH_VX).speed(0.1).suffix(" vx"))
            .on_hover_text("Distance; evening out uses at most 8 voxels");
    });
}

/// Chooses between protecting and releasing.
fn sides(ui: &mut Ui, adds: &mut bool) {
    ui.horizontal(|ui| {
        ui.radio_value(adds, true, "Add to it").on_hover_text("Protect what is chosen below");
        ui.radio_value(adds, false, "Take out").on_hover_text("Release what is chosen below");
    });
}

fn areas(ui: &mut Ui, window: &mut Masks, context: &UiContext, ask: &mut impl FnMut(MaskChange)) {
    let adds = window.adds;
    let mut put = |what| ask(MaskChange::Put { adds, what });
    ui.horizontal(|ui| {
        for (area, name, help) in [
            (Area::Grid, "Everything", "All voxels of the grid"),
            (Area::Selection, "Selected boxes", "The boxes of the selection"),
            (Area::Marker, "Marker's box", "The box of the marker"),
        ] {
            let is_there =
                area != Area::Selection || !context.document.selection().boxes().is_empty();
            let button = ui.add_enabled(is_there, Button::new(name)).on_hover_text(help);
            if button.on_disabled_hover_text("Nothing is selected").clicked() {
                put(MaskArea::Area(area));
            }
        }
    });
    ui.horizontal(|ui| {
        let has_colours = context.document.material().depth() != ColourDepth::None;
        let button = ui.add_enabled(has_colours, Button::new("Tool's colour"));
        let tool = context.tool;
        let help = "All voxels of the tool's colour, within the tolerance below";
        if button
            .on_hover_text(help)
            .on_disabled_hover_text("This sculpture has only one colour")
            .clicked()
        {
            put(MaskArea::Colour { colour: tool.colour, tolerance: tool.flood_tolerance });
        }
        let help = "Furrows, corners and holes of the surface";
        if ui.button("Cavities").on_hover_text(help).clicked() {
            let depth_vx = tool.wand.depth_vx;
            put(MaskArea::Cavities { reach_vx: window.cavity_vx, depth_vx });
        }
        let reach = DragValue::new(&mut window.cavity_vx).range(1..=MAX_REACH_VX).speed(0.05);
        ui.add(reach.suffix(" vx")).on_hover_text("Search distance around a voxel");
    });
}

/// Shows the options of the wand, and the button that makes the next press use it.
fn wand(ui: &mut Ui, adds: bool, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let tool = context.tool;
    let before = tool.wand;
    let mut wand = Wand { adds, ..before };
    ui.horizontal(|ui| {
        let chosen = tool.next_press == Some(NextPress::Wand);
        let help = "The next press on the surface protects or releases everything connected to it";
        if ui.selectable_label(chosen, "✨ Wand").on_hover_text(help).clicked() {
            let next = (!chosen).then_some(NextPress::Wand);
            requests.push(UiRequest::Tool(ToolEdit::NextPress(next)));
        }
        for (rule, name, help) in [
            (WandRule::Flat, "Flat", "Voxels of the surface that face nearly the same way"),
            (WandRule::Colour, "Colour", "Voxels of the surface of nearly the same colour"),
            (WandRule::Piece, "Piece", "All voxels connected to the one that is pressed"),
        ] {
            ui.radio_value(&mut wand.rule, rule, name).on_hover_text(help);
        }
    });
    Grid::new("wand").num_columns(2).min_col_width(NAME_WIDTH).show(ui, |ui| {
        let angle = Slider::new(&mut wand.angle_deg, 0.0..=90.0).suffix("°").max_decimals(0);
        let help = "Largest difference in direction within a flat patch";
        row(ui, "Angle", angle, help);
        let mut tolerance = tool.flood_tolerance;
        let shown = |value: f64, _| format!("{:.0} %", value * 100.0);
        let slider = Slider::new(&mut tolerance, 0.0..=1.0).custom_formatter(shown);
        if row(ui, "Tolerance", slider, "Largest difference between colours that count as the same")
        {
            requests.push(UiRequest::Tool(ToolEdit::FloodTolerance(tolerance)));
        }
        let depth = Slider::new(&mut wand.depth_vx, 0..=MAX_REACH_VX).suffix(" vx");
        let help = "Depth of the mask: how far it reaches below the surface of a patch, or around a cavity";
        row(ui, "Depth", depth, help);
    });
    if wand != before {
        requests.push(UiRequest::Tool(ToolEdit::Wand(wand)));
    }
}

/// Shows a named slider in a row of a table. Returns whether it was moved.
fn row(ui: &mut Ui, name: &str, slider: Slider<'_>, help: &str) -> bool {
    let label = ui.label(name);
    let moved = ui.add(slider).labelled_by(label.id).on_hover_text(help).changed();
    ui.end_row();
    moved
}
