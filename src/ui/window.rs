//! The interface of the main window: the panels around the picture, and everything that lies over it.
//!
//! The top of the interface: takes its state and the program as it sees it, and gives the person's requests.

use egui::{Align2, Area, CentralPanel, Frame, Id, Label, Order, Rect, Response, RichText, Sense};
use egui::{Ui, vec2};

use super::context::UiContext;
use super::dialogs::{busy, guide, key_catch};
use super::request::UiRequest;
use super::state::UiState;
use super::widgets::{numbers, theme};
use super::{dropped, gizmo, options, panels, status, toolbox, top_bar, upright};

/// Shows everything in `root` and adds the person's requests to `requests`. Returns the area left for the picture of
/// the sculpture.
pub fn show(
    root: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) -> Response {
    theme::apply(root.ctx(), state.appearance.theme, state.appearance.scale);
    theme::hear_slow_clicks(root.ctx());
    key_catch::listen(root, &mut state.dialogs.keys.catch, context, requests);
    if !state.dialogs.files.is_open() {
        numbers::hear(root.ctx());
    }
    if !state.layout.hidden {
        top_bar::show(root, state, context, requests);
        status::show(root, context);
        toolbox::show(root, state, context, requests);
        options::show(root, state, context, requests);
    }
    guide::strip(root, &mut state.dialogs.guide, context, requests);
    let picture = CentralPanel::default()
        .frame(Frame::NONE)
        .show(root, |ui| {
            let rect = ui.available_rect_before_wrap();
            ui.allocate_rect(rect, Sense::hover())
        })
        .inner;
    if state.layout.hidden {
        panels::show_panels_button(root, context, requests, picture.rect);
    } else if state.view.gizmo {
        gizmo::show(root, state, context, requests, picture.rect);
    }
    upright::show(root, state, context, requests, picture.rect);
    if let Some(what) = state.view.has_lines() {
        line_scale(root, what, context, picture.rect);
    }
    state.show_dialogs(root, context, requests);
    dropped::show(root, state, picture.rect, requests);
    state.toasts.show(root, picture.rect);
    let (busy, preview) = (state.dialogs.busy.as_ref(), state.dialogs.preview.as_mut());
    busy::show(root, busy, preview, requests);
    picture
}

/// Shows in a corner of `within` the distance between the lines of ground or floor grid.
fn line_scale(root: &Ui, what: &str, context: &UiContext, within: Rect) {
    let spacing = match context.line_spacing_vx {
        1 => "1 voxel".to_string(),
        spacing => format!("{spacing} voxels"),
    };
    Area::new(Id::new("line scale"))
        .order(Order::Background)
        .interactable(false)
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(within.left_bottom() + vec2(10.0, -6.0))
        .show(root.ctx(), |ui| {
            let text = RichText::new(format!("{what}: {spacing}")).small();
            ui.add(Label::new(text).extend().selectable(false));
        });
}
