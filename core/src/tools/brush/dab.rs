//! A use of a brush by a hand, from its options and the place on the surface. The brush's file makes a [`BrushUse`] of it.

use std::path::Path;

use glam::Vec3;

use super::footprint::Footprint;
use super::keys::{COLOUR, ONCE_PER_STROKE, RADIUS, STRENGTH};
use super::limits::MAX_HEIGHT;
use super::options::BrushOptions;
use super::{Ball, BrushSurface, BrushUse, Contact, Frame};
use crate::sculpture::Rgb;

/// Height to which the surface is raised with full strength, as a share of the radius.
const HEIGHT_SHARE: f32 = 0.5;

/// A use of a brush by a hand.
#[derive(Clone, Copy, Debug)]
pub struct Dab<'a> {
    /// The options; of a brush in a ball with the radius in units of the smallest edge of a voxel.
    pub options: &'a BrushOptions,
    /// Where it is used.
    pub place: DabPlace<'a>,
}

/// An image in place of the colour of a brush.
#[derive(Clone, Copy, Debug)]
pub struct BrushImage<'a> {
    /// Its file.
    pub path: &'a Path,
    /// The colour goes through it where it is bright.
    pub lets_colour_through: bool,
}

/// The place where a hand uses a brush.
#[derive(Clone, Copy, Debug)]
pub enum DabPlace<'a> {
    /// Under an outline in a picture.
    Picture {
        /// The outline.
        footprint: Footprint,
        /// The colour in hand.
        colour: Rgb,
        /// The image in hand, for brushes that take one.
        image: Option<BrushImage<'a>>,
        /// Uses of the stroke before it.
        uses: u32,
    },
    /// On the surface.
    Surface {
        /// The middle of the ball, in voxels.
        at_vx: Vec3,
        /// That of the use before, in voxels.
        from_vx: Vec3,
        /// Out of the clay, of length 1.
        normal: Vec3,
        /// Voxel edges in units of the smallest.
        edges: Vec3,
        /// 1, or -1 if the brush works in the other sense.
        sense: f32,
    },
    /// In a ball of clay that is held.
    Held {
        /// Where it was taken hold of, in voxels.
        start_vx: Vec3,
        /// How far it has been led from there, in voxels.
        by_vx: Vec3,
        /// Out of the clay, of length 1.
        normal: Vec3,
        /// To the right, as it is seen, of length 1 in units of the smallest edge.
        right: Vec3,
        /// Voxel edges in units of the smallest.
        edges: Vec3,
    },
}

impl Dab<'_> {
    /// Returns a use with the values of the options that have the names of its parameters. `frame`: in which it works
    /// in a ball.
    pub(super) fn used(&self, frame: Frame) -> BrushUse {
        let brush = self.options.brush();
        let radius = self.options.get(RADIUS);
        let (contact, surface, colour) = match self.place {
            DabPlace::Picture { footprint, colour, .. } => {
                let surface = match self.options.get(ONCE_PER_STROKE) {
                    true => BrushSurface::Stroke,
                    false => BrushSurface::Now,
                };
                let colour = brush.spec().gives_colour.then_some(colour);
                (Contact::Footprint(footprint), surface, colour)
            }
            DabPlace::Surface { at_vx: centre_vx, .. }
            | DabPlace::Held { start_vx: centre_vx, .. } => {
                (Contact::Ball(Ball { centre_vx, radius, frame }), BrushSurface::Stroke, None)
            }
        };
        let mut used = BrushUse::new(brush, contact).on(surface);
        self.options.iter().for_each(|(param, value)| used.set_value(param.key, value));
        match colour {
            Some(colour) => used.with(COLOUR, colour),
            None => used,
        }
    }

    /// Returns the same along the normal.
    pub(super) fn along_normal(&self) -> BrushUse {
        self.used(Frame::Normal(self.normal()))
    }

    /// Out of the clay, of length 1.
    pub(super) fn normal(&self) -> Vec3 {
        match self.place {
            DabPlace::Surface { normal, .. } | DabPlace::Held { normal, .. } => normal,
            DabPlace::Picture { footprint, .. } => -footprint.aim.normalize_or(Vec3::NEG_Y),
        }
    }

    /// Returns how far the surface is raised with the strength of the options, in units of the smallest edge; below 0
    /// in the other sense.
    pub(super) fn height(&self) -> f32 {
        let height = self.options.get(STRENGTH) * HEIGHT_SHARE * self.options.get(RADIUS);
        self.sense() * height.min(MAX_HEIGHT)
    }

    /// 1, or -1 in the other sense.
    pub(super) fn sense(&self) -> f32 {
        match self.place {
            DabPlace::Surface { sense, .. } => sense,
            DabPlace::Picture { .. } | DabPlace::Held { .. } => 1.0,
        }
    }
}
