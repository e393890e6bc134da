//! The choices about how the sculpture is shown.
//!
//! Panels change them; renderers read them. None of it belongs to the sculpture. Knows no panel.

use glam::Vec3;

use crate::render::{Finish, LightOptions, RenderMode, StereoOptions};
use crate::shade::Lighting;
use crate::video::VideoOptions;

/// How the sculpture is shown.
#[derive(Clone, PartialEq, Debug)]
pub struct ViewState {
    pub mode: RenderMode,
    /// The person has not chosen the mode.
    pub mode_is_automatic: bool,
    pub light: LightOptions,
    pub finish: Finish,
    /// The surface between near voxels instead of their cubes, of sculptures that are to be shown so.
    pub smooth_surface: bool,
    /// Smooth edges while nothing moves.
    pub refine: bool,
    /// Smooth edges in pictures that are not refined.
    pub smooth_edges: bool,
    /// The person has not chosen that.
    pub smooth_edges_is_automatic: bool,
    pub stereo: StereoOptions,
    pub video: VideoOptions,
    /// Parallel lines stay parallel; not before a tracked head or a printed marker.
    pub orthographic: bool,
    /// The axis gizmo.
    pub gizmo: bool,
    /// The floor grid.
    pub floor: bool,
    /// The ground with the sculpture's shadow; it has lines of its own.
    pub ground: bool,
    /// The axis of the grid that is up when the view is reset.
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
    /// Takes the mode that the person wants.
    pub fn choose_mode(&mut self, mode: RenderMode) {
        self.mode = mode;
        self.mode_is_automatic = false;
    }

    /// Takes the mode that suits a device to draw with, unless the person has chosen one, and likewise smooth edges. A
    /// choice that suits a GPU stays: the window may draw without one while a headset has one.
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

    /// Returns the lighting as the shaders take it.
    pub fn lighting(&self) -> Lighting {
        self.finish.of(self.light.lighting())
    }
}
