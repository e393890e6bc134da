//! Changes of a sculpture's box, and the translation of commands between signed coordinates and those of the grid.

use std::borrow::Cow;

use glam::{IVec3, UVec3};

use super::{Command, MaskArea, MaskChange};
use crate::sculpture::canvas_frame::CanvasSides;
use crate::tools::tint::Tint;

/// A change of the sculpture's box.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CanvasChange {
    /// The upper sides move until the box has this size in voxels. Voxels beyond them are cut off.
    Size(UVec3),
    /// Sides move outwards.
    Grow {
        /// By this many voxels, at lower sides rounded up to a multiple of 64.
        by_vx: u32,
        /// The sides that move.
        sides: CanvasSides,
    },
    /// Sides move inwards to the existing voxels, lower ones by a multiple of 64.
    Crop,
    /// Whether tools that reach beyond the box make it grow.
    Auto(bool),
}

impl CanvasChange {
    /// Returns its name in the text form.
    pub const fn name(&self) -> &'static str {
        match self {
            CanvasChange::Size(_) => "size",
            CanvasChange::Grow { .. } => "grow",
            CanvasChange::Crop => "crop",
            CanvasChange::Auto(_) => "auto",
        }
    }
}

impl Command {
    /// Returns the same command with its coordinates moved by a number of voxels: all places in the sculpture that it
    /// names, but not its distances. Symmetry stays, since documents keep it in signed coordinates.
    pub fn translated(&self, by: IVec3) -> Cow<'_, Command> {
        if by == IVec3::ZERO {
            return Cow::Borrowed(self);
        }
        if let Some(shifted) = self.shifted(by) {
            return Cow::Owned(shifted);
        }
        Cow::Owned(match self {
            Command::Mark(marker) => Command::Mark(marker.shifted(by)),
            Command::Flood { at, colour, tolerance } => {
                Command::Flood { at: at.saturating_add(by), colour: *colour, tolerance: *tolerance }
            }
            Command::Tint { area, tint: Tint::Gradient { from_vx, to_vx, colours, strength } } => {
                let moved = |point: glam::Vec3| point + by.as_vec3();
                let (from_vx, to_vx) = (moved(*from_vx), moved(*to_vx));
                let tint =
                    Tint::Gradient { from_vx, to_vx, colours: *colours, strength: *strength };
                Command::Tint { area: *area, tint }
            }
            Command::Mask(MaskChange::Put { adds, what }) => {
                Command::Mask(MaskChange::Put { adds: *adds, what: translated_area(what, by) })
            }
            _ => return Cow::Borrowed(self),
        })
    }
}

fn translated_area(what: &MaskArea, by: IVec3) -> MaskArea {
    let mut moved = what.clone();
    match &mut moved {
        MaskArea::Solid { primitive, to_vx } => {
            primitive.centre_vx += by.as_vec3();
            *to_vx = to_vx.map(|to| to + by.as_vec3());
        }
        MaskArea::DrawnSolid(drawn) => *drawn = drawn.shifted(by.as_vec3()),
        MaskArea::Patch { at, .. } | MaskArea::Piece { at } => *at = at.saturating_add(by),
        MaskArea::Area(_) | MaskArea::Colour { .. } | MaskArea::Cavities { .. } => {}
    }
    moved
}
