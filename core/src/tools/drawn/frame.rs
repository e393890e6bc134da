//! The frame of a posed solid: maps world points to points of the solid's frame, and boxes of the solid to boxes in the
//! world.
//!
//! Pure geometry in units of the smallest edge of a voxel.

use glam::{DQuat, DVec2, DVec3};

use super::fields::SolidPose;
use crate::tools::parallelepiped::Parallelepiped;

/// A pose, prepared for computing distances.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    at: DVec3,
    rotation: DQuat,
}

impl Frame {
    /// Creates the frame of a pose. `stretch`: edges of a voxel in units of the smallest.
    pub fn new(pose: &SolidPose, stretch: DVec3) -> Frame {
        let SolidPose { at_vx, rotation } = pose;
        Frame { at: at_vx.as_dvec3() * stretch, rotation: rotation.as_dquat().normalize() }
    }

    /// Maps a world point to the frame of the solid.
    pub fn local(&self, p: DVec3) -> DVec3 {
        self.rotation.inverse() * (p - self.at)
    }

    /// Maps a box in the world to the frame of the solid.
    pub fn local_box(&self, points: &Parallelepiped) -> Parallelepiped {
        let turn = self.rotation.inverse();
        Parallelepiped {
            middle: self.local(points.middle),
            half_edges: points.half_edges.map(|edge| turn * edge),
        }
    }

    /// Returns a point's distance from the y axis and its height.
    pub fn around_y(&self, p: DVec3) -> DVec2 {
        let p = self.local(p);
        DVec2::new(p.x.hypot(p.z), p.y)
    }

    /// Returns the distance of its origin from that of the grid.
    pub fn length(&self) -> f64 {
        self.at.length()
    }

    /// Returns the lowest and the highest point of a box around a box of the solid.
    pub fn bounds(&self, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
        let middle = self.at + self.rotation * ((low + high) * 0.5);
        let half = (high - low) * 0.5;
        let reach = [DVec3::X, DVec3::Y, DVec3::Z]
            .map(|axis| (self.rotation * (axis * half)).abs())
            .into_iter()
            .sum::<DVec3>();
        [middle - reach, middle + reach]
    }
}
