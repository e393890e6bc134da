//! The change that a use of a brush makes: voxels to remove, to add and to paint. Documents apply it.

use std::sync::Arc;

use super::BrushUse;
use super::kernel::pulled::Pulled;
use super::kernel::stamp::Stamp;
use super::mix::Mix;
use super::stencil::Stencil;
use crate::refusal::InvalidValue;
use crate::sculpture::history::Contents;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::{ColourDepth, Grid, Rgb};
use crate::tools::symmetry::{Symmetry, SymmetryTransform};
use crate::tools::texture::Texture;

/// The sculpture on which a brush is used.
pub struct Site<'a> {
    /// The sculpture in its present state.
    pub contents: &'a Contents,
    /// The surface on which the brush works: the same grid, or that at the start of the stroke.
    pub surface: &'a Grid,
    /// The symmetry of tools.
    pub symmetry: &'a Symmetry,
    /// The images by symmetry, including the use itself.
    pub images: &'a [SymmetryTransform],
    /// The image with which the brush paints.
    pub picture: Option<&'a Arc<Texture>>,
}

/// The change that a use of a brush makes.
#[derive(Default)]
pub struct BrushChange {
    /// Voxels to remove; from the mask if the brush changes the mask.
    pub remove: ListedBricks,
    /// Voxels to add, likewise.
    pub add: ListedBricks,
    /// The colour of added voxels.
    pub new_clay: NewClay,
    /// Voxels to paint after that.
    pub paint: Vec<(ListedBricks, Paint)>,
}

/// The colour of voxels that a brush adds.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub enum NewClay {
    /// The base colour.
    #[default]
    Base,
    /// A given colour.
    Colour(Rgb),
    /// The colour of the voxels around them.
    Inherited,
}

/// The new colours of voxels.
pub enum Paint {
    /// Mixed with the present ones.
    Mix(Mix),
    /// Taken from an image.
    Stencil(Stencil),
    /// Carried along with moved clay.
    Carried(Pulled),
}

impl Site<'_> {
    /// Returns the number of colour bits of the sculpture.
    pub fn depth(&self) -> ColourDepth {
        self.contents.material.depth()
    }
}

impl BrushChange {
    /// Returns the voxels that a use changes. The use must have been checked.
    pub fn of(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
        match used.brush().spec().script {
            Some(script) => (script.apply)(used, site),
            None => Ok(BrushChange::default()),
        }
    }

    /// Returns a change that adds and removes clay; added clay inherits the colour around it.
    pub(super) fn of_clay(stamp: Stamp) -> BrushChange {
        let Stamp { add, remove, .. } = stamp;
        BrushChange { add, remove, new_clay: NewClay::Inherited, ..BrushChange::default() }
    }

    /// Returns a change that paints.
    pub(super) fn painted(voxels: ListedBricks, paint: Paint) -> BrushChange {
        BrushChange { paint: vec![(voxels, paint)], ..BrushChange::default() }
    }
}
