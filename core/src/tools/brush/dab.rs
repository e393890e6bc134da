//! An interactive use of a brush, from its options and the place on the surface. The brush's file turns it into a
//! [`BrushUse`].

use std::path::Path;

use glam::Vec3;

use super::footprint::Footprint;
use super::keys::{COLOUR, ONCE_PER_STROKE, RADIUS, STRENGTH};
use super::limits::MAX_HEIGHT;
use super::options::BrushOptions;
use super::{BrushBall, BrushDirection, BrushSurface, BrushUse, Contact};
use crate::sculpture::Rgb;

/// Height by which the surface is raised at full strength, as a share of the radius.
const HEIGHT_SHARE: f32 = 0.5;

/// An interactive use of a brush.
#[derive(Clone, Copy, Debug)]
pub struct Dab<'a> {
    /// The options; for a brush in a ball with the radius in units of the smallest voxel edge.
    pub options: &'a BrushOptions,
    /// Where it is used.
    pub place: DabPlace<'a>,
}

/// An image that replaces the colour of a brush.
#[derive(Clone, Copy, Debug)]
pub struct BrushImage<'a> {
    /// Its file.
    pub path: &'a Path,
    /// Whether the colour shows where the image is bright.
    pub lets_colour_through: bool,
}

/// The place of an interactive use.
#[derive(Clone, Copy, Debug)]
pub enum DabPlace<'a> {
    /// Under an outline in a picture.
    Picture {
        /// The outline.
        footprint: Footprint,
        /// The current colour.
        colour: Rgb,
        /// The current image, for brushes that take one.
        image: Option<BrushImage<'a>>,
        /// Number of previous uses in the stroke.
        uses: u32,
    },
    /// On the surface.
    Surface {
        /// The centre of the ball, in voxels.
        at_vx: Vec3,
        /// The centre of the previous use, in voxels.
        from_vx: Vec3,
        /// The outward unit normal.
        normal: Vec3,
        /// Voxel edges in units of the smallest.
        edges: Vec3,
        /// 1, or -1 if the brush is inverted.
        sense: f32,
    },
    /// In a grabbed ball of clay.
    Held {
        /// The point where it was grabbed, in voxels.
        start_vx: Vec3,
        /// The displacement from there, in voxels.
        by_vx: Vec3,
        /// The outward unit normal.
        normal: Vec3,
        /// The direction to the right in the view, of length 1 in units of the smallest edge.
        right: Vec3,
        /// Voxel edges in units of the smallest.
        edges: Vec3,
    },
}

impl Dab<'_> {
    /// Returns a use with the values of the options that have the names of its parameters. `frame`: the direction in
    /// which it works in a ball.
    pub(super) fn used(&self, frame: BrushDirection) -> BrushUse {
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
                (Contact::Ball(BrushBall { centre_vx, radius, frame }), BrushSurface::Stroke, None)
            }
        };
        let mut used = BrushUse::new(brush, contact).on(surface);
        self.options.iter().for_each(|(param, value)| used.set_value(param.key, value));
        match colour {
            Some(colour) => used.with(COLOUR, colour),
            None => used,
        }
    }

    /// Returns a use in a ball along the normal.
    pub(super) fn along_normal(&self) -> BrushUse {
        self.used(BrushDirection::Normal(self.normal()))
    }

    /// Returns the outward unit normal.
    pub(super) fn normal(&self) -> Vec3 {
        match self.place {
            DabPlace::Surface { normal, .. } | DabPlace::Held { normal, .. } => normal,
            DabPlace::Picture { footprint, .. } => -footprint.aim.normalize_or(Vec3::NEG_Y),
        }
    }

    /// Returns how far the surface is raised with the strength of the options, in units of the smallest edge; negative
    /// if the brush is inverted.
    pub(super) fn height(&self) -> f32 {
        let height = self.options.get(STRENGTH) * HEIGHT_SHARE * self.options.get(RADIUS);
        self.sense() * height.min(MAX_HEIGHT)
    }

    /// Returns 1, or -1 if the brush is inverted.
    pub(super) fn sense(&self) -> f32 {
        match self.place {
            DabPlace::Surface { sense, .. } => sense,
            DabPlace::Picture { .. } | DabPlace::Held { .. } => 1.0,
        }
    }
}
