//! Owns the tool in hand: which solid, what it does, how large, how turned, which colour, where.
//!
//! It belongs to the person, not to the sculpture: changing it changes no voxel, and the command
//! that it gives is what does.

use glam::{EulerRot, Quat, UVec3, Vec3};

use crate::command::Command;
use crate::input::ToolMode;
use crate::sculpture::Rgb;
use crate::sculpture::edit::EditOp;
use crate::tools::construct::{Primitive, Solid};

/// Smallest and largest half extent that the interface offers.
pub const HALF_RANGE: std::ops::RangeInclusive<f32> = 0.5..=2048.0;
/// The tool's first half extent as a share of the grid's shortest side.
const FIRST_HALF: f32 = 0.06;

/// The tool in hand. Lengths are in edges of the sculpture's smallest voxel edge, as in
/// [`Primitive`].
#[derive(Clone, PartialEq, Debug)]
pub struct Hand {
    pub solid: Solid,
    pub mode: ToolMode,
    half: Vec3,
    /// A change of one half extent changes all in proportion.
    pub uniform: bool,
    rotation: Quat,
    turn_deg: Vec3,
    pub colour: Rgb,
    /// Centre in voxel coordinates.
    pub centre_vx: Vec3,
    /// The tool goes where the pointer meets the surface.
    pub follow: bool,
    /// The tool's centre is kept at centres of voxels.
    pub snap: bool,
}

impl Hand {
    /// A ball that cuts, in the middle of a grid of `dims` voxels.
    pub fn new(dims: UVec3) -> Hand {
        let mut hand = Hand {
            solid: Solid::Ellipsoid,
            mode: ToolMode::default(),
            half: Vec3::ONE,
            uniform: true,
            rotation: Quat::IDENTITY,
            turn_deg: Vec3::ZERO,
            colour: Rgb::new(0xd0, 0x5a, 0x32),
            centre_vx: Vec3::ZERO,
            follow: true,
            snap: false,
        };
        hand.reset_pose(dims);
        hand
    }

    /// Back to the middle, upright, at a size that suits a grid of `dims` voxels.
    pub fn reset_pose(&mut self, dims: UVec3) {
        self.centre_vx = dims.as_vec3() * 0.5;
        self.half = Vec3::splat((dims.min_element() as f32 * FIRST_HALF).max(*HALF_RANGE.start()));
        self.uniform = true;
        self.set_turn_deg(Vec3::ZERO);
    }

    pub fn half(&self) -> Vec3 {
        self.half
    }

    /// Sets one half extent; with `uniform` the others follow in proportion.
    pub fn set_half(&mut self, axis: usize, half: f32) {
        let half = half.clamp(*HALF_RANGE.start(), *HALF_RANGE.end());
        if self.uniform {
            self.scale_by(half / self.half[axis]);
        } else {
            self.half[axis] = half;
        }
    }

    /// Scales all half extents, as far as the range allows.
    pub fn scale_by(&mut self, factor: f32) {
        let least = HALF_RANGE.start() / self.half.min_element();
        let most = HALF_RANGE.end() / self.half.max_element();
        if factor.is_finite() && factor > 0.0 {
            self.half *= factor.clamp(least.min(1.0), most.max(1.0));
        }
    }

    /// Makes all half extents equal to their mean.
    pub fn even_out(&mut self) {
        self.half = Vec3::splat(self.half.element_sum() / 3.0);
    }

    pub fn rotation(&self) -> Quat {
        self.rotation
    }

    /// The rotation as degrees about x, then y, then z of the grid, as scripts write it.
    pub fn turn_deg(&self) -> Vec3 {
        self.turn_deg
    }

    pub fn set_turn_deg(&mut self, turn_deg: Vec3) {
        self.turn_deg = turn_deg;
        let turn = turn_deg * (std::f32::consts::PI / 180.0);
        self.rotation = Quat::from_euler(EulerRot::XYZEx, turn.x, turn.y, turn.z).normalize();
    }

    /// Turns the tool further, about axes of the grid.
    pub fn turn_by(&mut self, turn: Quat) {
        self.rotation = (turn * self.rotation).normalize();
        let (x, y, z) = self.rotation.to_euler(EulerRot::XYZEx);
        self.turn_deg = Vec3::new(x, y, z) * (180.0 / std::f32::consts::PI);
    }

    /// Puts the tool somewhere, at a voxel's centre if it snaps.
    pub fn move_to(&mut self, centre_vx: Vec3) {
        if centre_vx.is_finite() {
            self.centre_vx = if self.snap { centre_vx.floor() + 0.5 } else { centre_vx };
        }
    }

    pub fn primitive(&self) -> Primitive {
        Primitive {
            solid: self.solid,
            centre_vx: self.centre_vx,
            half: self.half,
            rotation: self.rotation,
        }
    }

    /// What the tool does where it is.
    pub fn command(&self, mode: ToolMode) -> Command {
        let op = match mode {
            ToolMode::Add => EditOp::Add(self.colour),
            ToolMode::Subtract => EditOp::Subtract,
            ToolMode::Recolour => EditOp::Recolour(self.colour),
        };
        Command::Construct { op, primitive: self.primitive() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_stay_in_range_and_in_proportion() {
        let mut hand = Hand::new(UVec3::splat(100));
        assert_eq!((hand.half(), hand.centre_vx), (Vec3::splat(6.0), Vec3::splat(50.0)));
        hand.uniform = false;
        hand.set_half(1, 12.0);
        assert_eq!(hand.half(), Vec3::new(6.0, 12.0, 6.0));
        hand.uniform = true;
        hand.set_half(0, 3.0);
        assert_eq!(hand.half(), Vec3::new(3.0, 6.0, 3.0));
        hand.scale_by(1e-9);
        assert_eq!(hand.half().min_element(), *HALF_RANGE.start());
        hand.scale_by(1e9);
        assert_eq!(hand.half(), Vec3::new(1024.0, 2048.0, 1024.0));
        hand.scale_by(f32::NAN);
        assert_eq!(hand.half().max_element(), *HALF_RANGE.end());
    }

    #[test]
    fn degrees_and_rotation_agree() {
        let mut hand = Hand::new(UVec3::splat(64));
        hand.set_turn_deg(Vec3::new(20.0, -30.0, 40.0));
        let rotation = hand.rotation();
        hand.turn_by(Quat::IDENTITY);
        assert!(hand.turn_deg().abs_diff_eq(Vec3::new(20.0, -30.0, 40.0), 1e-3));
        let script = format!("subtract cuboid at=1,2,3 half=4 turn={},{},{}", 20, -30, 40);
        let Ok(Command::Construct { primitive, .. }) = script.parse() else { panic!() };
        assert!(primitive.rotation.abs_diff_eq(rotation, 1e-6));
        assert!(hand.primitive().check().is_ok());
    }

    #[test]
    fn a_snapping_tool_sits_on_voxel_centres() {
        let mut hand = Hand::new(UVec3::splat(64));
        hand.snap = true;
        hand.move_to(Vec3::new(1.2, 3.9, -0.1));
        assert_eq!(hand.centre_vx, Vec3::new(1.5, 3.5, -0.5));
        hand.move_to(Vec3::NAN);
        assert_eq!(hand.centre_vx, Vec3::new(1.5, 3.5, -0.5));
    }
}
