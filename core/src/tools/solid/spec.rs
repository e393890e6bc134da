//! Describes a solid: its texts, its proportions, the computation of its rows, the image mapping, and its surface for
//! drawing. Each description is written once, in the file of the solid.

use glam::{DVec3, Vec2, Vec3};

use super::body::Body;
use super::parts::MinkowskiParts;
use super::planes::FaceHalfSpace;

/// The description of a solid. In tool space it lies in [-1, 1] on every axis.
#[derive(Clone, Copy, Debug)]
pub struct SolidSpec {
    /// Used in scripts, in stored settings and in tables of keys.
    pub name: &'static str,
    /// Shown in the interface, on a narrow button.
    pub label: &'static str,
    /// Explains its tool in one sentence without full stop.
    pub help: &'static str,
    /// Search terms from other programs, besides the words of `help`, separated by spaces.
    pub synonyms: &'static str,
    /// Returns the Minkowski sum for some half extents, in any unit.
    pub(super) parts: fn(half: DVec3) -> MinkowskiParts,
    /// The method that computes its voxels.
    pub(super) rows: RowMethod,
    /// Whether it fills its bounding box: axis-aligned, it covers a box of voxels.
    pub fills_its_box: bool,
    /// Whether it contains every straight line between its points.
    pub is_convex: bool,
    /// Maps a point of tool space to the image: (0, 0) is the lower left corner, (1, 1) the upper right one.
    pub image_point: fn(Vec3) -> Vec2,
    /// Its surface, for drawing.
    pub body: Body,
}

/// The method that computes the rows of voxels in a solid.
#[derive(Clone, Copy, Debug)]
pub enum RowMethod {
    /// By the roots of a quadratic form: the ellipsoid alone.
    Quadric,
    /// By the half spaces whose intersection it is.
    Planes(&'static [FaceHalfSpace]),
    /// No rows: each brick is tested by itself.
    Bricks,
}
