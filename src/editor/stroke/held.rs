//! Strokes of the brushes that grab clay.
//!
//! A stroke of `grab` or `twist` moves the clay as it was when the stroke began. Each command replaces the one before,
//! so that even a long drag resamples the clay once. Events only set the displacement; [`Lead::catch_up`] makes it due,
//! once per picture.

use glam::{Vec2, Vec3};

use super::lead::{Lead, PointerLead, StrokeScene};
use crate::command::Command;
use crate::picking::Picker;
use crate::tools::brush::dab::{Dab, DabPlace};
use crate::tools::brush::keys::RADIUS;
use crate::tools::brush::options::BrushOptions;

/// A stroke that holds clay.
pub struct HeldStroke {
    options: BrushOptions,
    /// It rotates instead of moving.
    turns: bool,
    /// Position of the grab, in voxels.
    start: Vec3,
    /// Unit vector out of the clay there.
    normal: Vec3,
    /// Unit vector to the right in the picture, in units of the smallest edge.
    right: Vec3,
    /// Voxel edges in units of the smallest.
    edges: Vec3,
    /// From there to the surface point under the pointer, in voxels; `None` while a key or a hand holds it away from
    /// the pointer.
    aside: Option<Vec3>,
    /// Displacement of the tool, in voxels.
    by: Vec3,
    /// Displacement at the last pull of the clay.
    done: Vec3,
    is_due: bool,
    uses: u32,
}

impl HeldStroke {
    /// Grabs the clay around the tool. `options`: with the radius in units of the smallest edge; `at`: the pointer
    /// (pixels).
    pub fn new(
        options: BrushOptions,
        turns: bool,
        at: Option<Vec2>,
        scene: &StrokeScene,
        picker: &Picker,
    ) -> HeldStroke {
        let start = scene.tool.centre_vx;
        let edges = scene.edges();
        let beside = |at| in_plane_of(start, at + Vec2::X, picker) - in_plane_of(start, at, picker);
        let right = picker.sight().pixel_of(start).map(beside);
        let right = right.and_then(|right| (right * edges).try_normalize()).unwrap_or(Vec3::X);
        HeldStroke {
            options,
            turns,
            start,
            normal: scene.normal_at(start, options.get(RADIUS), at, picker),
            right,
            edges,
            aside: at.map(|at| in_plane_of(start, at, picker) - start),
            by: Vec3::ZERO,
            done: Vec3::ZERO,
            is_due: false,
            uses: 0,
        }
    }
}

impl Lead for HeldStroke {
    /// Moves in the view plane through the grab.
    fn point_at(&mut self, to: Vec2, scene: &mut StrokeScene, picker: &Picker) {
        let Some(aside) = self.aside else { return };
        let by = in_plane_of(self.start, to, picker) - self.start - aside;
        if by.is_finite() {
            self.by = by;
            if !self.turns {
                scene.tool.centre_vx = self.start + by;
            }
            scene.anchor.leave(scene.tool);
        }
    }

    fn tool_moved(&mut self, scene: &mut StrokeScene, _: &Picker) {
        let to = scene.tool.centre_vx;
        if to.is_finite() {
            self.by = to - self.start;
        }
    }

    fn catch_up(&mut self) {
        self.is_due |= self.done != self.by;
        self.done = self.by;
    }

    /// Returns `None` if it would change nothing.
    fn next(&mut self, _: &mut StrokeScene, _: Option<&Picker>) -> Option<Command> {
        if !std::mem::take(&mut self.is_due) {
            return None;
        }
        self.uses += 1;
        let &mut HeldStroke { options, start: start_vx, by: by_vx, normal, right, edges, .. } =
            self;
        let place = DabPlace::Held { start_vx, by_vx, normal, right, edges };
        (options.brush().spec().dab)(&Dab { options: &options, place }).map(Command::Brush)
    }

    fn shift(&mut self, by_vx: Vec3) {
        self.start += by_vx;
    }

    fn uses(&self) -> u32 {
        self.uses
    }

    fn pointer(&self) -> PointerLead {
        PointerLead::Always
    }

    fn depends_on_picture(&self) -> bool {
        self.aside.is_some()
    }

    fn is_still(&self) -> bool {
        self.by == Vec3::ZERO
    }
}

/// Returns the point at `at` (pixels) in the view plane through `point`.
fn in_plane_of(point: Vec3, at: Vec2, picker: &Picker) -> Vec3 {
    let sight = picker.sight();
    sight.at_depth(at, sight.depth(point))
}
