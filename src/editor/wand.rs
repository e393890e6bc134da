//! The wand: the voxels that hang together with a voxel of the surface are protected, or released.

use glam::UVec3;

use crate::command::{Command, MaskArea, MaskChange, PatchRule};

/// The rule by which voxels hang together with a voxel for the wand.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum WandRule {
    /// Voxels of the surface of nearly the same colour.
    Colour,
    /// Voxels of the surface that face nearly the same way.
    Flat,
    /// All voxels that are joined to it.
    Piece,
}

/// The settings that decide which voxels the wand protects.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Wand {
    pub rule: WandRule,
    /// How far normals may turn, in degrees.
    pub angle_deg: f32,
    /// How far from the surface voxels are protected with it.
    pub depth_vx: u32,
    /// It protects, or releases.
    pub adds: bool,
}

impl Default for Wand {
    fn default() -> Wand {
        Wand { rule: WandRule::Flat, angle_deg: 15.0, depth_vx: 2, adds: true }
    }
}

impl Wand {
    /// Returns the command that protects what hangs together with a voxel of the surface, or releases it. `tolerance`:
    /// how far colours may differ, as a share of the range.
    pub(super) fn command(&self, at: UVec3, tolerance: f32) -> Command {
        let Wand { rule, angle_deg, depth_vx, adds } = *self;
        let what = match rule {
            WandRule::Colour => MaskArea::Patch { at, by: PatchRule::Colour(tolerance), depth_vx },
            WandRule::Flat => MaskArea::Patch { at, by: PatchRule::Flat(angle_deg), depth_vx },
            WandRule::Piece => MaskArea::Piece { at },
        };
        Command::Mask(MaskChange::Put { adds, what })
    }
}
