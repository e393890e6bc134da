//! Changes that commands make to the mask: the voxels that all tools leave alone.

use glam::{UVec3, Vec3};

use super::Area;
use crate::sculpture::Rgb;
use crate::tools::drawn::DrawnSolid;
use crate::tools::solid::Primitive;

/// A change of the mask.
#[derive(Clone, PartialEq, Debug)]
pub enum MaskChange {
    /// Nothing is protected any more.
    Clear,
    /// Protected voxels become unprotected, and the other way round.
    Invert,
    /// Its outline moves outwards by so many voxels.
    Grow(u32),
    /// Its outline moves inwards by so many voxels.
    Shrink(u32),
    /// Its outline is evened by the majority of the cube that reaches so many voxels around each
    /// voxel.
    Smooth(u32),
    /// Voxels are added to it, or taken out of it.
    Put {
        /// Added, or taken out.
        adds: bool,
        /// Which.
        what: MaskArea,
    },
}

/// Voxels that are added to the mask or taken out of it.
#[derive(Clone, PartialEq, Debug)]
pub enum MaskArea {
    /// Those of an area, existing or not.
    Area(Area),
    /// Those inside a solid, existing or not.
    Solid {
        /// The solid.
        primitive: Primitive,
        /// Where its centre goes, as of [`Command::Construct`](super::Command::Construct).
        to_vx: Option<Vec3>,
    },
    /// Those inside a solid that is drawn, existing or not.
    DrawnSolid(DrawnSolid),
    /// Existing ones of a colour.
    Colour {
        /// The colour.
        colour: Rgb,
        /// How far colours may differ from it: a share of the range of each channel.
        tolerance: f32,
    },
    /// Cavities of the surface.
    Cavities {
        /// How far around a voxel they are looked for.
        reach_vx: u32,
        /// How far from the surface voxels are protected with them.
        depth_vx: u32,
    },
    /// A patch of the surface.
    Patch {
        /// A voxel of it.
        at: UVec3,
        /// Which voxels belong to it.
        by: PatchRule,
        /// How far from the surface voxels are protected with it.
        depth_vx: u32,
    },
    /// All that hangs together with a voxel.
    Piece {
        /// The voxel.
        at: UVec3,
    },
}

/// Rule for the voxels that belong to a patch of the surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum PatchRule {
    /// Colours that differ from the first voxel's by at most a share of the range of each channel.
    Colour(f32),
    /// Normals that differ from the first voxel's by at most so many degrees.
    Flat(f32),
}

impl MaskChange {
    /// Its name in the text form.
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
    /// Its name in the text form.
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
