//! Owns where the tool stands on the surface: it goes with the pointer, and stays on its ground
//! when a choice of tool, size or turn would lift or sink it, without waiting for the pointer.

use glam::{Vec2, Vec3};

use super::aim::SurfacePoint;
use super::workspace::Workspace;
use crate::input::Action;
use crate::tools::construct::Solid;
use crate::ui::{Hand, Tool};

/// Where the tool was put on the surface, and with which choices.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct Footing {
    /// None once something else than the pointer has moved the tool.
    ground: Option<SurfacePoint>,
    choices: Option<Choices>,
}

/// What the place of a tool depends on, besides the pointer.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Choices {
    tool: Tool,
    solid: Solid,
    half: Vec3,
    /// None if the surface gives it.
    turn_deg: Option<Vec3>,
    follow: bool,
    snap: bool,
    stand: bool,
}

impl Choices {
    fn of(hand: &Hand) -> Choices {
        let &Hand { tool, solid, follow, snap, stand, .. } = hand;
        let turn_deg = (!hand.lean).then(|| hand.turn_deg());
        Choices { tool, solid, half: hand.half(), turn_deg, follow, snap, stand }
    }

    /// Whether the tool is another than before, or begins to follow.
    fn is_taken_anew(&self, before: &Choices) -> bool {
        (self.tool, self.solid, self.follow) != (before.tool, before.solid, before.follow)
    }
}

impl Workspace {
    /// The pointer moves with nothing held.
    pub(super) fn hover(&mut self, at: Vec2) {
        if let Tool::Spray(_) = self.ui.hand.tool {
            // A spray that a key holds down goes with the pointer.
            self.lead_spray(at);
        }
        if self.ui.hand.follow
            && self.follows_pointer()
            && let Some(point) = self.target(at)
        {
            self.lead_tool_to(at, point);
            if self.ui.hand.tool == Tool::Solid {
                self.tool_moved();
            }
        }
    }

    /// Puts the tool at a point of the surface, which is seen at `at`.
    pub(super) fn lead_tool_to(&mut self, at: Vec2, point: Vec3) {
        self.stand_on(SurfacePoint { point, face: self.normal(at) });
    }

    /// A stroke has led the tool over the surface to `point`.
    pub(super) fn led_over(&mut self, point: Vec3) {
        if let Some(ground) = &mut self.footing.ground {
            ground.point = point;
        }
    }

    fn stand_on(&mut self, ground: SurfacePoint) {
        self.footing.ground = Some(ground);
        if self.ui.hand.tool == Tool::Solid {
            let voxel_size = self.session.document().grid().voxel_size();
            self.ui.hand.place_on(ground.point, ground.face, voxel_size);
            self.footing.choices = Some(Choices::of(&self.ui.hand));
        }
    }

    /// The tool is where it is meant to be, wherever the pointer is.
    pub(super) fn leave_ground(&mut self) {
        self.footing = Footing { ground: None, choices: Some(Choices::of(&self.ui.hand)) };
    }

    /// Lets the tool follow at once what was chosen about it.
    pub(super) fn keep_footing(&mut self) {
        let choices = Choices::of(&self.ui.hand);
        let Some(before) = self.footing.choices.replace(choices) else { return };
        let led = self.stroke.is_some() || self.hand_pose.is_some();
        let led = led || !choices.follow || !self.follows_pointer();
        if choices == before || choices.tool != Tool::Solid || led {
            return;
        }
        let taken = choices.is_taken_anew(&before);
        match (self.pointer.filter(|_| !self.is_dragging()), self.footing.ground) {
            (Some(at), ground) if taken || ground.is_some() => self.hover(at),
            (None, Some(ground)) => self.stand_on(ground),
            _ => {}
        }
    }

    /// In a table of bindings without `Sculpt` the tool is moved by drags alone.
    fn follows_pointer(&self) -> bool {
        self.presets
            .get(self.ui.preset)
            .is_some_and(|bindings| bindings.triggers(Action::Sculpt).next().is_some())
    }
}
