//! The frame of a sculpture's canvas: where its box of voxels lies in the sculpture's own, signed coordinates, and where
//! it began.
//!
//! Scripts and panels use signed coordinates: they stay what they are when the box grows to a lower side. The home box
//! has its lowest corner at 0 and never moves; its centre is the pivot of the placement and of the mirror planes. Knows
//! no voxels.

use glam::{IVec3, UVec3, Vec3};

use super::orientation::Orientation;
use super::region::VoxelBox;
use crate::refusal::InvalidValue;

/// Edge of the cubes by which a box moves at its lower sides: that of a leaf, in voxels.
pub const CANVAS_STEP_VX: u32 = 64;
/// Greatest distance of a box from its home, in voxels.
const FURTHEST_VX: i32 = 1 << 19;

/// Where the voxels of a grid lie in signed coordinates, and whether the box grows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct CanvasFrame {
    /// The signed coordinates of the grid's voxel (0, 0, 0).
    pub origin: IVec3,
    /// The size of the box with which the sculpture began, without the room around it.
    pub home: UVec3,
    /// Whether tools that reach beyond the box make it grow.
    pub grows: bool,
}

/// The box of a sculpture: its size and its frame.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Canvas {
    /// Size in voxels.
    pub dims: UVec3,
    /// Where it lies.
    pub frame: CanvasFrame,
}

/// The sides of a box.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct CanvasSides {
    /// The lower side of each axis.
    pub low: [bool; 3],
    /// The upper side of each axis.
    pub high: [bool; 3],
}

impl CanvasSides {
    /// All six sides.
    pub const ALL: CanvasSides = CanvasSides { low: [true; 3], high: [true; 3] };
}

impl CanvasFrame {
    /// Returns the frame of a sculpture that began with `dims` voxels and has not grown.
    pub fn of(dims: UVec3) -> CanvasFrame {
        CanvasFrame { origin: IVec3::ZERO, home: dims, grows: false }
    }

    /// Returns the centre of the home box in grid coordinates.
    pub fn centre_vx(&self) -> Vec3 {
        self.home.as_vec3() * 0.5 - self.origin.as_vec3()
    }

    /// Returns the frame after the grid, of `dims` voxels, was reoriented.
    pub fn oriented(&self, orientation: Orientation, dims: UVec3) -> CanvasFrame {
        let first = -self.origin;
        let ends = [first, first + self.home.as_ivec3() - 1];
        let ends = ends.map(|v| orientation.destination(v, dims));
        let origin = -ends[0].min(ends[1]);
        CanvasFrame { origin, home: orientation.size(self.home), grows: self.grows }
    }

    /// Returns an error if the frame cannot be that of a sculpture.
    pub fn check(&self) -> Result<(), InvalidValue> {
        let is_near = self.origin.abs().cmple(IVec3::splat(FURTHEST_VX)).all();
        let rule = "is too far from where the sculpture began; save it and open it anew";
        InvalidValue::check(is_near, "canvas", rule, self.origin)?;
        let is_box =
            self.home.min_element() > 0 && self.home.cmple(UVec3::splat(FURTHEST_VX as u32)).all();
        let rule = "must be at least one voxel long on every axis";
        InvalidValue::check(is_box, "home of the canvas", rule, self.home)
    }
}

impl Canvas {
    /// Returns whether the sculpture has neither grown nor may grow.
    pub fn is_plain(&self) -> bool {
        self.frame == CanvasFrame::of(self.dims)
    }

    /// Returns the box in signed coordinates.
    pub fn bounds_vx(&self) -> VoxelBox {
        let min = self.frame.origin;
        VoxelBox { min, max: min + self.dims.as_ivec3() }
    }

    /// Returns the canvas with `by_vx` more voxels at the given sides: at the lower ones rounded up to a multiple of
    /// [`CANVAS_STEP_VX`].
    pub fn grown(&self, by_vx: u32, sides: CanvasSides) -> Canvas {
        let by = |is_wanted: bool| if is_wanted { by_vx } else { 0 };
        self.grown_by(UVec3::from(sides.low.map(by)), UVec3::from(sides.high.map(by)))
    }

    /// Returns the canvas with more voxels at its lower and upper sides; see [`Canvas::grown`]. No size overflows, but
    /// it may be more than a grid can have.
    pub fn grown_by(&self, low: UVec3, high: UVec3) -> Canvas {
        // Far more than a grid can have, and far from the largest number.
        let most = UVec3::splat(1 << 24);
        let low = low.min(most).map(|low| low.next_multiple_of(CANVAS_STEP_VX));
        let origin = self.frame.origin - low.as_ivec3();
        Canvas {
            dims: self.dims + low + high.min(most),
            frame: CanvasFrame { origin, ..self.frame },
        }
    }

    /// Returns the smallest canvas within this one that holds a box of it, in grid coordinates. Its lower sides lie at
    /// whole steps from those of this one.
    pub fn cropped(&self, min: UVec3, max: UVec3) -> Canvas {
        let low = min / CANVAS_STEP_VX * CANVAS_STEP_VX;
        let origin = self.frame.origin + low.as_ivec3();
        Canvas { dims: max - low, frame: CanvasFrame { origin, ..self.frame } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lower_sides_move_by_whole_steps() {
        let canvas = Canvas { dims: UVec3::new(9, 70, 5), frame: CanvasFrame::of(UVec3::splat(9)) };
        let grown = canvas.grown(1, CanvasSides::ALL);
        assert_eq!(grown.dims, UVec3::new(74, 135, 70));
        assert_eq!(grown.frame.origin, IVec3::splat(-64));
        let back = grown.cropped(UVec3::new(64, 127, 65), UVec3::new(73, 128, 69));
        assert_eq!(back.dims, UVec3::new(9, 64, 5));
        assert_eq!(back.frame.origin, IVec3::ZERO);
        let far = canvas.grown(u32::MAX, CanvasSides::ALL);
        assert!(far.frame.check().is_err());
    }

    #[test]
    fn the_home_follows_the_axes() {
        let dims = UVec3::new(100, 90, 80);
        let frame = CanvasFrame {
            origin: IVec3::new(-64, 3, -10),
            home: UVec3::new(20, 30, 40),
            grows: true,
        };
        for orientation in Orientation::all() {
            let turned = frame.oriented(orientation, dims);
            let corner = orientation.destination(-frame.origin, dims) + turned.origin;
            assert!(corner.cmpge(IVec3::ZERO).all() && corner.as_uvec3().cmplt(turned.home).all());
            let back = turned.oriented(orientation.inverse(), orientation.size(dims));
            assert_eq!(back, frame);
        }
    }
}
