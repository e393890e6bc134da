//! The tools that deform clay, and the brushes among them: a ball in which the surface is moved, given with all its
//! numbers.

use glam::Vec3;

use super::BrushId;
use super::kernel::grab::{Falloff, MAX_RADIUS, MIN_RADIUS};
use super::kernel::offset::{MAX_HEIGHT, Offset, Profile, Target};

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
    /// Moves the surface along one direction.
    Draw,
    /// The same in a narrow profile: a furrow or a ridge.
    Crease,
    /// Brings clay together at the axis of the brush.
    Pinch,
    /// Takes hold of a ball of clay and turns it.
    Twist,
    /// Takes clay along with the brush.
    Smear,
}

impl DeformKind {
    /// All kinds, in the order in which interfaces offer them.
    pub const ALL: [DeformKind; 10] = [
        DeformKind::Grab,
        DeformKind::Inflate,
        DeformKind::Flatten,
        DeformKind::Scrape,
        DeformKind::Fill,
        DeformKind::Draw,
        DeformKind::Crease,
        DeformKind::Pinch,
        DeformKind::Twist,
        DeformKind::Smear,
    ];

    /// As a brush.
    pub const fn brush(self) -> BrushId {
        match self {
            DeformKind::Grab => BrushId::Grab,
            DeformKind::Inflate => BrushId::Inflate,
            DeformKind::Flatten => BrushId::Flatten,
            DeformKind::Scrape => BrushId::Scrape,
            DeformKind::Fill => BrushId::Fill,
            DeformKind::Draw => BrushId::Draw,
            DeformKind::Crease => BrushId::Crease,
            DeformKind::Pinch => BrushId::Pinch,
            DeformKind::Twist => BrushId::Twist,
            DeformKind::Smear => BrushId::Smear,
        }
    }

    /// Its name in the text form.
    pub const fn name(self) -> &'static str {
        self.brush().spec().name
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
    /// Moves it along a direction.
    Draw(Draw),
    /// Moves it along a direction, the square of the falloff's share of the way: a furrow or a ridge.
    Crease(Draw),
}

/// A way along which the surface is moved.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Draw {
    /// Out of the clay, of any length.
    pub normal: Vec3,
    /// How far in the middle, in units of the smallest edge of a voxel: along the normal above 0, at most [`MAX_HEIGHT`].
    pub height: f32,
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
            Brush::Draw(_) => DeformKind::Draw,
            Brush::Crease(_) => DeformKind::Crease,
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
        let check_height = |height: f32| match height.abs() <= MAX_HEIGHT {
            true => Ok(()),
            false => Err("the height must be at most 16 voxels"),
        };
        let check_normal = |normal: Vec3| match normal.try_normalize() {
            Some(_) => Ok(()),
            None => Err("the normal must be a direction"),
        };
        match self.brush {
            Brush::Inflate { height } => check_height(height),
            Brush::Draw(draw) | Brush::Crease(draw) => {
                check_normal(draw.normal)?;
                check_height(draw.height)
            }
            Brush::Flatten(plane) | Brush::Scrape(plane) | Brush::Fill(plane) => {
                check_normal(plane.normal)?;
                match (0.0..=1.0).contains(&plane.strength) {
                    true => Ok(()),
                    false => Err("the strength must be from 0 to 1"),
                }
            }
        }
    }

    /// As a move of the surface.
    pub(crate) fn offset(&self) -> Offset {
        let plane = |plane: Plane, lowers, raises| {
            let normal = plane.normal.normalize_or(Vec3::Y);
            Target::Plane { normal, strength: plane.strength, lowers, raises }
        };
        let along = |Draw { normal, height }: Draw, profile| {
            let normal = normal.normalize_or(Vec3::Y);
            Target::Drawn { normal, height, profile }
        };
        let target = match self.brush {
            Brush::Inflate { height } => Target::Along(height),
            Brush::Flatten(to) => plane(to, true, true),
            Brush::Scrape(to) => plane(to, true, false),
            Brush::Fill(to) => plane(to, false, true),
            Brush::Draw(way) => along(way, Profile::Falloff),
            Brush::Crease(way) => along(way, Profile::Squared),
        };
        let Deform { centre_vx, radius, falloff, .. } = *self;
        Offset { centre_vx, radius, falloff, target }
    }
}
