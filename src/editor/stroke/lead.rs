//! The control of a stroke: turns the path of the tool under the pointer, a hand or a key into due commands.
//!
//! Each kind of tool implements it in a file of its own. A lead sees part of the editor, moves the tool there and gives
//! commands; it executes none.

use glam::{Vec2, Vec3};

use crate::command::Command;
use crate::document::Document;
use crate::editor::pressure::Grip;
use crate::editor::surface_anchor::SurfaceAnchor;
use crate::editor::surface_guide::normal_around;
use crate::editor::tool::ToolState;
use crate::picking::Picker;
use crate::sculpture::{Grid, Rgb};
use crate::tools::brush::footprint::Footprint;

/// The part of the editor that a lead sees.
pub struct StrokeScene<'a> {
    pub document: &'a Document,
    pub tool: &'a mut ToolState,
    pub anchor: &'a mut SurfaceAnchor,
    pub grip: &'a mut Grip,
}

impl StrokeScene<'_> {
    pub fn grid(&self) -> &Grid {
        self.document.grid()
    }

    /// Voxel edges in units of the smallest.
    pub fn edges(&self) -> Vec3 {
        let size = self.grid().voxel_size();
        size / size.min_element()
    }

    /// Returns the colour of unpainted clay.
    pub fn bare_colour(&self) -> Rgb {
        self.document.contents().material.base()
    }

    /// Returns the unit vector out of the clay around a point. `radius`: of the examined ball, in units of the smallest
    /// edge; `at`: the point's pixel, if it is visible.
    pub fn normal_at(&self, place: Vec3, radius: f32, at: Option<Vec2>, picker: &Picker) -> Vec3 {
        let grid = self.grid();
        normal_around(grid, place, radius)
            .or_else(|| at.map(|at| picker.normal(grid, at, true)))
            .and_then(Vec3::try_normalize)
            .unwrap_or(Vec3::Y)
    }
}

/// Controls a stroke.
pub trait Lead {
    /// Moves the pointer to a point of the picture, in pixels.
    fn point_at(&mut self, to: Vec2, scene: &mut StrokeScene, picker: &Picker);

    /// Follows a tool moved by something other than the pointer.
    fn tool_moved(&mut self, scene: &mut StrokeScene, picker: &Picker);

    /// Follows the tool that the pointer has put on a surface point, seen at `at` (pixels).
    fn tool_put(&mut self, _at: Vec2, _point: Vec3, _scene: &mut StrokeScene, _picker: &Picker) {}

    /// Moves the cone of a hand.
    fn aim(&mut self, _cone: Footprint) {}

    /// Makes the work due that is too slow for every event. Called once per picture.
    fn catch_up(&mut self) {}

    /// Lets the tool arrive at its target before the stroke ends.
    fn finish(&mut self, _scene: &mut StrokeScene) {
        self.catch_up();
    }

    /// Returns whether it repeats while held in place. `in_hand`: in a hand of a headset.
    fn repeats(&self, _in_hand: bool) -> bool {
        false
    }

    /// Makes the same use due once more.
    fn repeat(&mut self, _scene: &mut StrokeScene) {}

    /// Moves all points by a number of voxels, since the grid's box has moved.
    fn shift(&mut self, by_vx: Vec3);

    /// Returns the number of uses so far.
    fn uses(&self) -> u32;

    /// Returns the next due command. `picker`: the last picture, for tools that work in it.
    fn next(&mut self, scene: &mut StrokeScene, picker: Option<&Picker>) -> Option<Command>;

    /// Returns how the pointer controls it.
    fn pointer(&self) -> PointerLead;

    /// Returns whether the pointer guides a solid over the surface in the present picture.
    fn is_led_over(&self, _picker: &Picker) -> bool {
        false
    }

    /// Returns whether its path depends on the surface under the pointer.
    fn depends_on_picture(&self) -> bool;

    /// Returns whether it has grabbed clay and not moved it.
    fn is_still(&self) -> bool {
        false
    }
}

/// The ways in which the pointer controls a stroke.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PointerLead {
    /// Not at all: a drag moves the tool, and the stroke follows the tool.
    None,
    /// By drags.
    Drag,
    /// By drags, and by movements without a button.
    Always,
}
