//! The interface: panels, windows and messages over the sculpture, in egui.
//!
//! Reads the program through [`UiContext`], changes its own choices in [`UiState`] alone, and says
//! what else the person wants as [`UiRequest`]s. It changes no sculpture and knows no Vulkan.

pub mod board;
pub mod dialogs;
mod dropped;
pub mod gizmo;
pub mod history;
pub mod memory;
pub mod options;
pub mod panels;
pub mod references;
pub mod state;
pub mod status;
pub mod switches;
pub mod toolbox;
pub mod top_bar;
pub mod view_options;
pub mod widgets;
pub mod window_options;

use std::path::Path;

use egui::{Align2, Area, CentralPanel, Frame, Id, Label, Order, Rect, Response, RichText, Sense};
use egui::{Ui, vec2};

use crate::controls::pads::PadStatus;
use crate::document::Document;
use crate::editor::draw::Progress;
use crate::editor::tool::ToolState;
use crate::input::{Action, Bindings};
use crate::screen::headset::Blend;
use crate::sculpture::orientation::Up;
use crate::viewpoint::ar::ArStatus;
use crate::viewpoint::camera::VideoStatus;
use crate::viewpoint::head::HeadStatus;

use dialogs::{
    busy, changed_on_disk, export, files, film, final_picture, guide, import, in_use, key_catch,
    key_table, light, masks, new, palette, print_check, recovery, tints, unkept, unsaved, upright,
};
use options::head;
pub use state::{ScreenshotTo, UiOptions, UiRequest, UiState, ViewState};
pub use view_options::ViewOptions;
use widgets::{numbers, theme};

pub use window_options::{SCALE_RANGE, Theme, WindowOptions};

/// How long the last picture took, in milliseconds.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct FrameTimes {
    /// Finding the voxel of every pixel, with upload and read-back.
    pub sample_ms: f32,
    pub shade_ms: f32,
    /// Everything, interface included.
    pub total_ms: f32,
}

/// The values that the interface reads.
pub struct UiContext<'a> {
    pub document: &'a Document,
    pub path: Option<&'a Path>,
    /// The script that is recorded, if one is.
    pub recording: Option<&'a Path>,
    /// Size of the picture of the view, in pixels.
    pub picture_px: glam::UVec2,
    /// The axis that was taken for the one that points up in a file that does not say so; none once
    /// the sculpture has been changed.
    pub assumed_up: Option<Up>,
    /// Something would be lost by leaving now.
    pub modified: bool,
    /// Why the journal does not keep what is done, while it does not.
    pub unsafe_because: Option<String>,
    pub tool: &'a ToolState,
    /// How far what is drawn by several presses is, if there is any.
    pub drawn: Option<Progress>,
    /// The tables of bindings to choose from.
    pub presets: &'a [Bindings],
    /// The same as the program brings them along.
    pub pristine: &'a [Bindings],
    /// Index of the table in use.
    pub preset: usize,
    pub times: FrameTimes,
    /// These are the panels on a hand in a headset, where nobody reaches keyboard and mouse.
    pub in_headset: bool,
    /// How a headset's pictures can go together with the surroundings; none without a headset.
    pub blends: &'a [Blend],
    /// Whether the window can have a layer an eye.
    pub quad_buffered: bool,
    /// Name of the Vulkan device.
    pub device: &'a str,
    /// Between two lines of the floor grid and of the ground.
    pub line_spacing_vx: u32,
    /// Where the axes of the grid point in the picture: x right, y up, z to the viewer.
    pub axes_in_picture: [glam::Vec3; 3],
    /// The voxel that the pointer points at.
    pub pointed_vx: Option<glam::UVec3>,
    /// The gamepad that leads, if there is one.
    pub pad: Option<PadStatus<'a>>,
    pub head: HeadStatus,
    pub ar: ArStatus,
    pub video: VideoStatus,
}

impl UiContext<'_> {
    /// The bindings in use.
    fn bindings(&self) -> Option<&Bindings> {
        self.presets.get(self.preset)
    }

    /// The first key or button for an action, as a person reads it; none in a headset.
    fn shortcut(&self, action: Action) -> Option<String> {
        self.bindings().filter(|_| !self.in_headset).and_then(|b| b.shortcut(action))
    }
}

/// Shows everything in `root` and adds to `requests` what was asked for. Gives the area that is
/// left for the picture of the sculpture.
pub fn show(
    root: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) -> Response {
    theme::apply(root.ctx(), state.appearance.theme, state.appearance.scale);
    theme::hear_slow_clicks(root.ctx());
    key_catch::listen(root, state, context, requests);
    if !state.dialogs.files.is_open() {
        numbers::hear(root.ctx());
    }
    if !state.layout.hidden {
        top_bar::show(root, state, context, requests);
        status::show(root, context);
        toolbox::show(root, state, context, requests);
        options::show(root, state, context, requests);
    }
    guide::strip(root, state, context, requests);
    let picture = CentralPanel::default()
        .frame(Frame::NONE)
        .show(root, |ui| {
            let rect = ui.available_rect_before_wrap();
            ui.allocate_rect(rect, Sense::hover())
        })
        .inner;
    if state.layout.hidden {
        panels::way_back(root, context, requests, picture.rect);
    } else if state.view.gizmo {
        gizmo::show(root, state, context, requests, picture.rect);
    }
    upright::show(root, state, context, requests, picture.rect);
    if let Some(what) = state.view.has_lines() {
        line_scale(root, what, context, picture.rect);
    }
    light::show(root, state);
    references::show(root, state, context.path);
    print_check::show(root, state, context, requests);
    tints::show(root, state, context, requests);
    masks::show(root, state, context, requests);
    key_table::show(root, state, context, requests);
    key_catch::show(root, state, requests);
    palette::show(root, state, context, requests);
    new::show(root, state, context, requests);
    final_picture::show(root, state, context, requests);
    film::show(root, state, context, requests);
    export::show(root, state, context, requests);
    import::show(root, state, context, requests);
    recovery::show(root, state, requests);
    head::calibration(root, context, requests);
    unsaved::show(root, state, requests);
    unkept::show(root, state, requests);
    changed_on_disk::show(root, state, requests);
    in_use::show(root, state, requests);
    files::show(root, state, requests);
    dropped::show(root, state, picture.rect, requests);
    state.toasts.show(root, picture.rect);
    busy::show(root, state, context, requests);
    picture
}

/// Says in a corner of `within` how far apart the lines of ground or floor grid are.
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
