//! The tools that deform clay, and the brushes among them: a ball in which the surface is moved, given with all its
//! numbers.

use glam::Vec3;

use super::grab::{Falloff, MAX_RADIUS, MIN_RADIUS};
use super::offset::{MAX_HEIGHT, Offset, Target};

/// A tool that deforms clay, without its options.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum DeformKind {
    /// Takes hold of a ball of clay and pulls it along.
    #[default]
    Grab,
    /// Moves the surface outwards.
    Inflate,
    /// Moves the surface to a plane.
    Flatten,
    /// Removes what stands out of a plane.
    Scrape,
    /// Fills what lies below a plane.
    Fill,
}

impl DeformKind {
    /// All kinds, in the order in which interfaces offer them.
    pub const ALL: [DeformKind; 5] = [
        DeformKind::Grab,
        DeformKind::Inflate,
        DeformKind::Flatten,
        DeformKind::Scrape,
        DeformKind::Fill,
    ];

    /// Its name in the text form and the interface.
    pub const fn name(self) -> &'static str {
        match self {
            DeformKind::Grab => "grab",
            DeformKind::Inflate => "inflate",
            DeformKind::Flatten => "flatten",
            DeformKind::Scrape => "scrape",
            DeformKind::Fill => "fill",
        }
    }
}

/// What a brush does to the surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Brush {
    /// Moves it along its normals.
    Inflate {
        /// How far in the middle, in units of the smallest edge of a voxel: outwards above 0, at most [`MAX_HEIGHT`].
        height: f32,
    },
    /// Moves it to a plane through the middle of the ball.
    Flatten(Plane),
    /// Moves what stands before the plane to it.
    Scrape(Plane),
    /// Moves what lies behind the plane to it.
    Fill(Plane),
}

/// A plane through the middle of the ball.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plane {
    /// Out of the clay, of any length.
    pub normal: Vec3,
    /// Share of the way to the plane in the middle of the ball, 0 to 1.
    pub strength: f32,
}

/// A brush, used once.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Deform {
    /// What it does.
    pub brush: Brush,
    /// Middle of the ball, in voxel coordinates.
    pub centre_vx: Vec3,
    /// Its radius in units of the smallest edge of a voxel, from [`MIN_RADIUS`] to [`MAX_RADIUS`].
    pub radius: f32,
    /// How the effect falls off from the middle to the rim.
    pub falloff: Falloff,
}

impl Brush {
    /// The kind, without its parameters.
    pub const fn kind(self) -> DeformKind {
        match self {
            Brush::Inflate { .. } => DeformKind::Inflate,
            Brush::Flatten(_) => DeformKind::Flatten,
            Brush::Scrape(_) => DeformKind::Scrape,
            Brush::Fill(_) => DeformKind::Fill,
        }
    }
}

impl Deform {
    /// An error that names the first invalid field, if there is one.
    pub fn check(&self) -> Result<(), &'static str> {
        if !self.centre_vx.is_finite() || self.centre_vx.abs().max_element() > 1e6 {
            return Err("the middle of the ball must lie near the grid");
        }
        if !(self.radius >= MIN_RADIUS && self.radius <= MAX_RADIUS) {
            return Err("the radius of the ball must be from 0.5 to 96 voxels");
        }
        match self.brush {
            Brush::Inflate { height } if height.is_nan() || height.abs() > MAX_HEIGHT => {
                Err("the height must be at most 16 voxels")
            }
            Brush::Inflate { .. } => Ok(()),
            Brush::Flatten(plane) | Brush::Scrape(plane) | Brush::Fill(plane) => {
                if plane.normal.try_normalize().is_none() {
                    return Err("the normal must be a direction");
                }
                match (0.0..=1.0).contains(&plane.strength) {
                    true => Ok(()),
                    false => Err("the strength must be from 0 to 1"),
                }
            }
        }
    }

    /// As a move of the surface along its normals.
    pub(crate) fn offset(&self) -> Offset {
        let plane = |plane: Plane, lowers, raises| {
            let normal = plane.normal.normalize_or(Vec3::Y);
            Target::Plane { normal, strength: plane.strength, lowers, raises }
        };
        let target = match self.brush {
            Brush::Inflate { height } => Target::Along(height),
            Brush::Flatten(to) => plane(to, true, true),
            Brush::Scrape(to) => plane(to, true, false),
            Brush::Fill(to) => plane(to, false, true),
        };
        let Deform { centre_vx, radius, falloff, .. } = *self;
        Offset { centre_vx, radius, falloff, target }
    }
}
