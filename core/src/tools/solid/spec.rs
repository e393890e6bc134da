//! Describes a solid: its texts, its proportions, the computation of its rows, the mapping of images to it, and its
//! surface for pictures, each written once in the file of the solid.

use glam::{DVec3, Vec2, Vec3};

use super::body::Body;
use super::parts::Parts;
use super::planes::HalfSpace;

/// The description of a solid. In tool space it lies in [-1, 1] on every axis.
#[derive(Clone, Copy, Debug)]
pub struct SolidSpec {
    /// In scripts, in what is remembered and in tables of keys.
    pub name: &'static str,
    /// In the interface, on a narrow button.
    pub label: &'static str,
    /// Explains its tool in one sentence without full stop.
    pub help: &'static str,
    /// Words of other programs that find it, besides those of `help`, separated by spaces.
    pub synonyms: &'static str,
    /// The sum that it is at some half extents, in any unit.
    pub(super) parts: fn(half: DVec3) -> Parts,
    /// The computation of its voxels.
    pub(super) rows: Rows,
    /// It fills the box around it: along the grid it covers a box of voxels.
    pub fills_its_box: bool,
    /// The position on an image of a point of tool space: (0, 0) is the lower left corner, (1, 1) the upper right one.
    pub image_point: fn(Vec3) -> Vec2,
    /// Its surface, for pictures of it.
    pub body: Body,
}

/// The computation of the rows of voxels in a solid.
#[derive(Clone, Copy, Debug)]
pub enum Rows {
    /// By the roots of a quadratic form: the ellipsoid alone.
    Quadric,
    /// By the half spaces that meet in it.
    Planes(&'static [HalfSpace]),
    /// Not at all: each brick is looked at by itself.
    Bricks,
}
