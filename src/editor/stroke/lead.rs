//! The lead of a stroke: from where the pointer, a hand or a key takes the tool to the commands that are due.
//!
//! Each kind of tool has its own, in a file of its own. A lead sees a part of the editor, moves the tool in it and gives
//! commands; it carries out none.

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
pub struct Scene<'a> {
    pub document: &'a Document,
    pub tool: &'a mut ToolState,
    pub anchor: &'a mut SurfaceAnchor,
    pub grip: &'a mut Grip,
}

impl Scene<'_> {
    pub fn grid(&self) -> &Grid {
        self.document.grid()
    }

    /// Voxel edges in units of the smallest.
    pub fn edges(&self) -> Vec3 {
        let size = self.grid().voxel_size();
        size / size.min_element()
    }

    /// Returns the colour that nothing has been painted over.
    pub fn bare_colour(&self) -> Rgb {
        self.document.contents().material.base()
    }

    /// Returns the direction out of the clay around a place, of length 1. `radius`: of the ball that is looked at, in
    /// units of the smallest edge; `at`: where the place is seen (pixels), if it is.
    pub fn normal_at(&self, place: Vec3, radius: f32, at: Option<Vec2>, picker: &Picker) -> Vec3 {
        let grid = self.grid();
        normal_around(grid, place, radius)
            .or_else(|| at.map(|at| picker.normal(grid, at, true)))
            .and_then(Vec3::try_normalize)
            .unwrap_or(Vec3::Y)
    }
}

/// Leads a stroke.
pub trait Lead {
    /// The pointer goes to a point of the picture, in pixels.
    fn point_at(&mut self, to: Vec2, scene: &mut Scene, picker: &Picker);

    /// Something else than the pointer has moved the tool.
    fn tool_moved(&mut self, scene: &mut Scene, picker: &Picker);

    /// The pointer has put the tool on a point of the surface, which is seen at `at` (pixels).
    fn tool_put(&mut self, _at: Vec2, _point: Vec3, _scene: &mut Scene, _picker: &Picker) {}

    /// A hand has led the cone in which it works.
    fn aim(&mut self, _cone: Footprint) {}

    /// A picture is due: what is too slow to be done for every event becomes due.
    fn catch_up(&mut self) {}

    /// The stroke is about to end: the tool arrives where it has been led.
    fn finish(&mut self, _scene: &mut Scene) {
        self.catch_up();
    }

    /// Returns whether it is used again where it is held. `in_hand`: a hand in a headset holds it.
    fn repeats(&self, _in_hand: bool) -> bool {
        false
    }

    /// The same use once more becomes due.
    fn repeat(&mut self, _scene: &mut Scene) {}

    /// Uses of the tool so far.
    fn uses(&self) -> u32;

    /// Returns the next command that is due. `picker`: the last picture, for those that work in it.
    fn next(&mut self, scene: &mut Scene, picker: Option<&Picker>) -> Option<Command>;

    /// Returns the manner in which the pointer leads it.
    fn pointer(&self) -> PointerLead;

    /// Returns whether the pointer, as the picture is now, leads a solid over the surface.
    fn is_led_over(&self, _picker: &Picker) -> bool {
        false
    }

    /// Returns whether where it goes depends on what the picture shows under the pointer.
    fn depends_on_picture(&self) -> bool;

    /// Returns whether it has taken hold of clay and not moved it.
    fn is_still(&self) -> bool {
        false
    }
}

/// The manner in which the pointer leads a stroke.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PointerLead {
    /// Not at all: a drag moves the tool, and the stroke follows that.
    None,
    /// Drags lead it.
    Drag,
    /// Drags lead it, and the pointer without a button.
    Always,
}
