//! The values of the program that the interface reads.
//!
//! The owner of the parts makes a [`UiContext`] for each pass. Knows no panel and no dialog.

use std::path::Path;

use crate::controls::pads::PadStatus;
use crate::document::Document;
use crate::editor::draw::Progress;
use crate::editor::tool::ToolState;
use crate::input::{Action, Bindings};
use crate::screen::headset::BlendMode;
use crate::sculpture::orientation::Up;
use crate::viewpoint::ar::ArStatus;
use crate::viewpoint::camera::VideoStatus;
use crate::viewpoint::head::HeadStatus;

/// The time that the last picture took, in milliseconds.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct FrameTimes {
    /// To find the voxel of every pixel, with upload and read-back.
    pub sample_ms: f32,
    pub shade_ms: f32,
    /// Everything, interface included.
    pub total_ms: f32,
}

/// The values that the interface reads.
pub struct UiContext<'a> {
    pub document: &'a Document,
    pub path: Option<&'a Path>,
    /// The script being recorded, if there is one.
    pub recording: Option<&'a Path>,
    /// Size of the picture of the view, in pixels.
    pub picture_px: glam::UVec2,
    /// The up axis assumed for a file that does not state one; `None` once the sculpture has been changed.
    pub assumed_up: Option<Up>,
    /// Leaving now would lose something.
    pub modified: bool,
    /// The reason why the journal does not keep the work, while it does not.
    pub unsafe_because: Option<String>,
    pub tool: &'a ToolState,
    /// Progress of a drawing that takes several presses, if there is one.
    pub drawn: Option<Progress>,
    /// The tables of bindings to choose from.
    pub presets: &'a [Bindings],
    /// The same tables as shipped with the program.
    pub pristine: &'a [Bindings],
    /// Index of the table in use.
    pub preset: usize,
    pub times: FrameTimes,
    /// The panels are on a hand in a headset, out of reach of keyboard and mouse.
    pub in_headset: bool,
    /// The ways in which a headset can blend pictures with the surroundings; empty without a headset.
    pub blends: &'a [BlendMode],
    /// Whether the window can have one layer per eye.
    pub quad_buffered: bool,
    /// Name of the Vulkan device.
    pub device: &'a str,
    /// Distance between two lines of the floor grid and of the ground.
    pub line_spacing_vx: u32,
    /// Directions of the grid's axes in the picture: x right, y up, z to the viewer.
    pub axes_in_picture: [glam::Vec3; 3],
    /// The voxel under the pointer.
    pub pointed_vx: Option<glam::UVec3>,
    /// The active gamepad, if there is one.
    pub pad: Option<PadStatus<'a>>,
    pub head: HeadStatus,
    pub ar: ArStatus,
    pub video: VideoStatus,
}

impl UiContext<'_> {
    /// Returns the bindings in use.
    pub fn bindings(&self) -> Option<&Bindings> {
        self.presets.get(self.preset)
    }

    /// Returns the first key or button for an action as text; `None` in a headset.
    pub fn shortcut(&self, action: Action) -> Option<String> {
        self.bindings().filter(|_| !self.in_headset).and_then(|b| b.shortcut(action))
    }
}
