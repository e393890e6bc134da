//! The wand protects or releases the voxels connected to a surface voxel.

use glam::UVec3;

use crate::command::{Command, MaskArea, MaskChange, PatchRule};

/// The rule of the wand by which voxels are connected.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum WandRule {
    /// Surface voxels of nearly the same colour.
    Colour,
    /// Surface voxels with nearly the same normal.
    Flat,
    /// All voxels joined to it.
    Piece,
}

/// The settings that decide which voxels the wand protects.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Wand {
    pub rule: WandRule,
    /// Largest difference of normals, in degrees.
    pub angle_deg: f32,
    /// Depth below the surface of the voxels protected with it.
    pub depth_vx: u32,
    /// Protects; otherwise releases.
    pub adds: bool,
}

impl Default for Wand {
    fn default() -> Wand {
        Wand { rule: WandRule::Flat, angle_deg: 15.0, depth_vx: 2, adds: true }
    }
}

impl Wand {
    /// Returns the command that protects or releases the voxels connected to a surface voxel. `tolerance`: largest
    /// difference of colours, as a share of the range.
    pub(super) fn command(&self, at: UVec3, tolerance: f32) -> Command {
        let Wand { rule, angle_deg, depth_vx, adds } = *self;
        let at = at.as_ivec3();
        let what = match rule {
            WandRule::Colour => MaskArea::Patch { at, by: PatchRule::Colour(tolerance), depth_vx },
            WandRule::Flat => MaskArea::Patch { at, by: PatchRule::Flat(angle_deg), depth_vx },
            WandRule::Piece => MaskArea::Piece { at },
        };
        Command::Mask(MaskChange::Put { adds, what })
    }
}
