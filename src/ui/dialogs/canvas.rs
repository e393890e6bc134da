//! The window of the canvas: the size of the sculpture's box, growth at its sides, the crop to the voxels in it, and
//! another resolution.
//!
//! Gives [`UiRequest`]s, most of them commands; changes no sculpture itself.

use egui::{DragValue, Ui, Window, pos2};
use glam::UVec3;

use crate::command::{CanvasChange, Command};
use crate::resample::Resolution;
use crate::sculpture::canvas_frame::CanvasSides;
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::ui::context::UiContext;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

const WIDTH: f32 = 290.0;
const AXES: [&str; 3] = ["x", "y", "z"];

/// The state that the window remembers.
#[derive(Clone, PartialEq, Debug)]
pub struct CanvasWindow {
    pub open: bool,
    /// The size to set: that of the sculpture until it is edited.
    dims: Option<UVec3>,
    by_vx: u32,
    sides: CanvasSides,
    factor: f32,
}

impl Default for CanvasWindow {
    fn default() -> CanvasWindow {
        let sides = CanvasSides::ALL;
        CanvasWindow { open: false, dims: None, by_vx: 64, sides, factor: 2.0 }
    }
}

impl Dialog for CanvasWindow {
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
        Window::new("Canvas")
            .open(&mut open)
            .resizable(false)
            .default_width(WIDTH)
            .default_pos(pos2(theme::TOOLBOX_WIDTH + 28.0, 52.0))
            .show(root.ctx(), |ui| {
                ui.set_width(WIDTH);
                let mut ask = |command| requests.push(UiRequest::Run(command));
                present(ui, context, &mut ask);
                size(ui, self, context, &mut ask);
                growth(ui, self, &mut ask);
                ui.separator();
                resolution(ui, self, context, &mut ask);
            });
        self.open &= open;
    }
}

/// Shows the present box, and whether it grows.
fn present(ui: &mut Ui, context: &UiContext, ask: &mut impl FnMut(Command)) {
    let canvas = context.document.contents().canvas();
    let UVec3 { x, y, z } = canvas.dims;
    let [from_x, from_y, from_z] = canvas.frame.origin.to_array();
    ui.label(format!("{x} × {y} × {z} voxels, from {from_x}, {from_y}, {from_z}"));
    let mut grows = canvas.frame.grows;
    let help = "Tools that add beyond the canvas make it larger, in the same step of undo";
    if ui.checkbox(&mut grows, "Grow as needed").on_hover_text(help).changed() {
        ask(Command::Canvas(CanvasChange::Auto(grows)));
    }
}

fn size(
    ui: &mut Ui,
    window: &mut CanvasWindow,
    context: &UiContext,
    ask: &mut impl FnMut(Command),
) {
    let now = context.document.grid().dims();
    let mut dims = window.dims.unwrap_or(now);
    ui.horizontal(|ui| {
        for (axis, name) in AXES.into_iter().enumerate() {
            let value = DragValue::new(&mut dims[axis]).range(1..=MAX_AXIS_VX).speed(1.0);
            ui.add(value.prefix(format!("{name} ")))
                .on_hover_text(format!("Size of the canvas along {name}, in voxels"));
        }
        window.dims = (dims != now).then_some(dims);
        let set = ui.add_enabled(dims != now, egui::Button::new("Set"));
        let help = "Move the upper sides until the canvas has this size; voxels beyond are cut off";
        if set.on_hover_text(help).clicked() {
            ask(Command::Canvas(CanvasChange::Size(dims)));
            window.dims = None;
        }
    });
}

fn growth(ui: &mut Ui, window: &mut CanvasWindow, ask: &mut impl FnMut(Command)) {
    ui.horizontal(|ui| {
        for (axis, name) in AXES.into_iter().enumerate() {
            let low = format!("The lower side of {name}: it moves by multiples of 64 voxels");
            ui.toggle_value(&mut window.sides.low[axis], format!("−{name}")).on_hover_text(low);
            let high = format!("The upper side of {name}");
            ui.toggle_value(&mut window.sides.high[axis], name).on_hover_text(high);
        }
    });
    ui.horizontal(|ui| {
        ui.add(DragValue::new(&mut window.by_vx).range(1..=MAX_AXIS_VX).suffix(" vx"))
            .on_hover_text("How far the chosen sides move outwards");
        let (by_vx, sides) = (window.by_vx, window.sides);
        let is_any = sides.low.contains(&true) || sides.high.contains(&true);
        let grow = ui.add_enabled(is_any, egui::Button::new("Grow"));
        if grow.on_hover_text("Add empty room at the chosen sides").clicked() {
            ask(Command::Canvas(CanvasChange::Grow { by_vx, sides }));
        }
        let help = "Move all sides inwards to the voxels; lower sides move by multiples of 64";
        if ui.button("Crop to content").on_hover_text(help).clicked() {
            ask(Command::Canvas(CanvasChange::Crop));
        }
    });
}

fn resolution(
    ui: &mut Ui,
    window: &mut CanvasWindow,
    context: &UiContext,
    ask: &mut impl FnMut(Command),
) {
    ui.strong("Resolution");
    ui.horizontal(|ui| {
        for (name, factor) in [("Half", 0.5), ("Double", 2.0)] {
            let help = "The same shape and size in the world, of voxels of another size";
            if ui.button(name).on_hover_text(help).clicked() {
                ask(Command::Resample(Resolution::Factor(factor)));
            }
        }
        ui.add(DragValue::new(&mut window.factor).range(0.1..=8.0).speed(0.01).prefix("× "))
            .on_hover_text("How many times as many voxels along each axis");
        if ui.button("Resample").clicked() {
            ask(Command::Resample(Resolution::Factor(window.factor)));
        }
    });
    let to = Resolution::Factor(window.factor).dims(context.document.grid().dims());
    if let Ok(UVec3 { x, y, z }) = to {
        ui.weak(format!("× {:.2} gives {x} × {y} × {z} voxels", window.factor));
    }
}
