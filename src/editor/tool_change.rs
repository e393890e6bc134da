//! The effect of a mode of solids on the voxels that they cover: the command for each solid.

use glam::Vec3;

use super::stroke::sweep::SweepSegment;
use super::tool::ToolState;
use crate::command::{Command, MaskArea, MaskChange};
use crate::input::ToolMode;
use crate::sculpture::edit::EditOp;
use crate::tools::drawn::DrawnSolid;
use crate::tools::solid::Primitive;

/// The effect of a mode on the voxels of a solid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum ToolChange {
    /// Adds, cuts or paints them.
    Voxels(EditOp),
    /// Protects or releases them.
    Mask { adds: bool },
}

impl From<EditOp> for ToolChange {
    fn from(op: EditOp) -> ToolChange {
        ToolChange::Voxels(op)
    }
}

impl ToolChange {
    /// Returns a command about the voxels of a solid, or of its straight sweep to the centre `to_vx`.
    pub fn by_solid(self, primitive: Primitive, to_vx: Option<Vec3>) -> Command {
        match self {
            ToolChange::Voxels(op) => Command::Construct { op, primitive, to_vx },
            ToolChange::Mask { adds } => mask(adds, MaskArea::Solid { primitive, to_vx }),
        }
    }

    /// Returns a command about the voxels of a drawn solid.
    pub fn by_drawn_solid(self, drawn: DrawnSolid) -> Command {
        match self {
            ToolChange::Voxels(op) => Command::DrawnSolid { op, drawn },
            ToolChange::Mask { adds } => mask(adds, MaskArea::DrawnSolid(drawn)),
        }
    }
}

impl ToolState {
    /// Sets the mode of solids. A solid that rests on the surface cuts nothing. A tool that begins to cut therefore
    /// rests only if that is chosen while it cuts; afterwards it rests as before.
    pub fn set_mode(&mut self, mode: ToolMode) {
        match (self.mode == ToolMode::Subtract, mode == ToolMode::Subtract) {
            (false, true) => self.rested = std::mem::take(&mut self.stand),
            (true, false) => self.stand |= std::mem::take(&mut self.rested),
            _ => {}
        }
        self.mode = mode;
    }

    /// Returns the change that a mode makes to voxels.
    pub fn change(&self, mode: ToolMode) -> ToolChange {
        match mode {
            ToolMode::Add => ToolChange::Voxels(EditOp::Add(Some(self.colour))),
            ToolMode::Subtract => ToolChange::Voxels(EditOp::Subtract),
            ToolMode::Recolour => ToolChange::Voxels(EditOp::Recolour(self.colour)),
            ToolMode::Protect => ToolChange::Mask { adds: true },
            ToolMode::Release => ToolChange::Mask { adds: false },
        }
    }

    /// Returns the command of a solid along a segment of its path. An image is stamped at the segment's end.
    pub fn command(&self, mode: ToolMode, segment: &SweepSegment) -> Command {
        let at =
            |centre_vx| Primitive { centre_vx, rotation: segment.rotation, ..self.primitive() };
        if let (ToolMode::Recolour, Some(picture)) = (mode, &self.picture) {
            return Command::Texture { primitive: at(segment.end()), picture: picture.clone() };
        }
        self.change(mode).by_solid(at(segment.from), segment.to)
    }
}

fn mask(adds: bool, what: MaskArea) -> Command {
    Command::Mask(MaskChange::Put { adds, what })
}
