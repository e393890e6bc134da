//! Changes that commands make to the mask, which protects voxels from all tools.

use glam::{IVec3, Vec3};

use super::Area;
use crate::sculpture::Rgb;
use crate::tools::drawn::DrawnSolid;
use crate::tools::solid::Primitive;

/// A change of the mask.
#[derive(Clone, PartialEq, Debug)]
pub enum MaskChange {
    /// Nothing is protected any more.
    Clear,
    /// Protected voxels become unprotected, and vice versa.
    Invert,
    /// Its outline moves outwards by this many voxels.
    Grow(u32),
    /// Its outline moves inwards by this many voxels.
    Shrink(u32),
    /// Its outline is smoothed: each voxel follows the majority of the cube that extends this many voxels around it.
    Smooth(u32),
    /// Voxels are added to it or removed from it.
    Put {
        /// Whether they are added.
        adds: bool,
        /// The voxels.
        what: MaskArea,
    },
}

/// Voxels that are added to the mask or removed from it.
#[derive(Clone, PartialEq, Debug)]
pub enum MaskArea {
    /// The voxels of an area, existing or not.
    Area(Area),
    /// The voxels inside a solid, existing or not.
    Solid {
        /// The solid.
        primitive: Primitive,
        /// The point to which its centre moves, as in [`Command::Construct`](super::Command::Construct).
        to_vx: Option<Vec3>,
    },
    /// The voxels inside a drawn solid, existing or not.
    DrawnSolid(DrawnSolid),
    /// Existing voxels of a colour.
    Colour {
        /// The colour.
        colour: Rgb,
        /// How far colours may differ from it: a share of the range of each channel.
        tolerance: f32,
    },
    /// Cavities of the surface.
    Cavities {
        /// The distance around a voxel that decides whether it lies in a cavity.
        reach_vx: u32,
        /// The depth below the surface to which voxels are protected.
        depth_vx: u32,
    },
    /// A patch of the surface.
    Patch {
        /// A voxel of it.
        at: IVec3,
        /// The rule for its voxels.
        by: PatchRule,
        /// The depth below the surface to which voxels are protected.
        depth_vx: u32,
    },
    /// All voxels connected to a voxel.
    Piece {
        /// The voxel.
        at: IVec3,
    },
}

/// Rule for the voxels that belong to a patch of the surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum PatchRule {
    /// Colours that differ from the first voxel's by at most this share of the range of each channel.
    Colour(f32),
    /// Normals that differ from the first voxel's by at most this many degrees.
    Flat(f32),
}

impl MaskChange {
    /// Returns its name in the text form.
    pub const fn name(&self) -> &'static str {
        match self {
            MaskChange::Clear => "clear",
            MaskChange::Invert => "invert",
            MaskChange::Grow(_) => "grow",
            MaskChange::Shrink(_) => "shrink",
            MaskChange::Smooth(_) => "smooth",
            MaskChange::Put { adds: true, .. } => "add",
            MaskChange::Put { adds: false, .. } => "subtract",
        }
    }
}

impl MaskArea {
    /// Returns its name in the text form.
    pub const fn name(&self) -> &'static str {
        match self {
            MaskArea::Area(area) => area.name(),
            MaskArea::Solid { primitive, .. } => primitive.solid.name(),
            MaskArea::DrawnSolid(drawn) => drawn.name(),
            MaskArea::Colour { .. } => "colour",
            MaskArea::Cavities { .. } => "cavities",
            MaskArea::Patch { .. } => "patch",
            MaskArea::Piece { .. } => "piece",
        }
    }
}
