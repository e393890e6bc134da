//! The choices about the display of the sculpture.
//!
//! Panels change them; renderers read them. None of it belongs to the sculpture. Knows no panel.

use glam::Vec3;

use crate::render::{Finish, LightOptions, RenderMode, StereoOptions};
use crate::shade::Lighting;
use crate::video::VideoOptions;

/// The display of the sculpture.
#[derive(Clone, PartialEq, Debug)]
pub struct ViewState {
    pub mode: RenderMode,
    /// The person has not chosen the mode.
    pub mode_is_automatic: bool,
    pub light: LightOptions,
    pub finish: Finish,
    /// Shows a smooth surface instead of the cubes of near voxels, for sculptures that want it.
    pub smooth_surface: bool,
    /// Antialiases while nothing moves.
    pub refine: bool,
    /// Antialiases pictures that are not refined.
    pub smooth_edges: bool,
    /// The person has not chosen `smooth_edges`.
    pub smooth_edges_is_automatic: bool,
    pub stereo: StereoOptions,
    pub video: VideoOptions,
    /// Uses parallel projection, except with a tracked head or a printed marker.
    pub orthographic: bool,
    /// The axis gizmo.
    pub gizmo: bool,
    /// The floor grid.
    pub floor: bool,
    /// The ground with the sculpture's shadow; it has lines of its own.
    pub ground: bool,
    /// The grid axis that points up after a reset of the view.
    pub up: Vec3,
    /// The edges of the grid.
    pub bounds: bool,
    /// Protected voxels are tinted.
    pub mask: bool,
    /// The line from the grid's centre to the tool.
    pub line: bool,
    /// The tool itself.
    pub tool: bool,
}

impl ViewState {
    /// Sets the mode chosen by the person.
    pub fn choose_mode(&mut self, mode: RenderMode) {
        self.mode = mode;
        self.mode_is_automatic = false;
    }

    /// Sets the mode that suits a device, and likewise smooth edges, unless the person has chosen them. A choice that
    /// suits a GPU stays: the window may render without one while a headset has one.
    pub fn suit_device(&mut self, software: bool) {
        if self.mode_is_automatic && !software {
            self.choose_mode(RenderMode::usual(software));
        }
        self.smooth_edges |= self.smooth_edges_is_automatic && !software;
    }

    /// Returns the name of the feature that draws lines below the sculpture, if one does.
    pub fn has_lines(&self) -> Option<&'static str> {
        match (self.ground, self.floor) {
            (true, _) => Some("Ground lines"),
            (false, true) => Some("Floor grid"),
            (false, false) => None,
        }
    }

    /// Returns the lighting for the shaders.
    pub fn lighting(&self) -> Lighting {
        self.finish.of(self.light.lighting())
    }
}
