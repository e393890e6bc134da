//! Applies brushes: makes the changes that a brush's file describes, limited to the selection and outside the mask.
//!
//! Like all tools, it changes voxels only through [`EditTarget::edit`] and [`EditTarget::paint`].

use super::CommandError;
use super::edit_target::EditTarget;
use super::pictures::LoadedPictures;
use super::strokes::Strokes;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::inherit::Inherited;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::to_paint::PaintedWith;
use crate::tools::brush::change::{BrushChange, NewClay, Paint, Site};
use crate::tools::brush::spec::BrushGroup;
use crate::tools::brush::{BrushSurface, BrushUse};

/// Applies a brush and its mirror images together. Replaces the stroke so far if the brush works that way.
pub(super) fn use_brush(
    target: &mut EditTarget,
    strokes: &mut Strokes,
    pictures: &LoadedPictures,
    used: &BrushUse,
) -> Result<EditStats, CommandError> {
    used.check()?;
    if used.brush().spec().script.is_some_and(|script| script.needs_colours) {
        target.require_colours()?;
    }
    match used.replaces_stroke() {
        true => target.instead_of_recorded(|target| carry_out(target, strokes, pictures, used)),
        false => carry_out(target, strokes, pictures, used),
    }
}

fn carry_out(
    target: &mut EditTarget,
    strokes: &mut Strokes,
    pictures: &LoadedPictures,
    used: &BrushUse,
) -> Result<EditStats, CommandError> {
    let BrushChange { remove, add, new_clay, paint } = change_of(target, strokes, pictures, used)?;
    let keeps_surface = used.surface == BrushSurface::Stroke && !used.replaces_stroke();
    if used.brush().spec().group == BrushGroup::Mask {
        let mut stats = target.edit_mask(&add, true)?;
        stats += target.edit_mask(&remove, false)?;
        if keeps_surface {
            strokes.keep_surface(target.grid())?;
        }
        return Ok(stats);
    }
    let inherited = match new_clay {
        NewClay::Inherited => inherited(target, &add),
        NewClay::Base | NewClay::Colour(_) => Inherited::default(),
    };
    let colour = match new_clay {
        NewClay::Colour(colour) => Some(colour),
        NewClay::Base | NewClay::Inherited => None,
    };
    target.check_bits_memory(|is_close| {
        target.bits_growth(&remove, EditOp::Subtract, is_close)
            + target.bits_growth(&add, EditOp::Add(colour), is_close)
    })?;
    target.check_colour_memory(|is_close| {
        let painted = paint.iter().map(|(voxels, paint)| match paint {
            Paint::Carried(_) => target.growth_of_bricks(voxels),
            Paint::Mix(_) | Paint::Stencil(_) => target.colour_growth(
                voxels,
                PaintedWith::AnyColours { keeps_base: false },
                is_close,
            ),
        });
        target.colour_growth(&add, PaintedWith::Edit(EditOp::Add(colour)), is_close)
            + painted.sum::<u64>()
            + inherited.growth(&target.contents)
    })?;
    if keeps_surface {
        strokes.keep_surface(target.grid())?;
    }
    let mut stats = target.edit(&remove, EditOp::Subtract);
    stats += target.edit(&add, EditOp::Add(colour));
    if !inherited.is_empty() {
        target.paint(&add, |v, now| inherited.colour(v).unwrap_or(now));
    }
    for (voxels, paint) in &paint {
        stats += match paint {
            Paint::Mix(mix) => target.paint(voxels, |v, now| mix.colour(v, now)),
            Paint::Stencil(stencil) => target.paint(voxels, |v, now| stencil.colour(v, now)),
            Paint::Carried(pulled) => {
                target.paint(voxels, |v, now| pulled.colour(v).unwrap_or(now))
            }
        };
    }
    Ok(stats)
}

fn change_of(
    target: &EditTarget,
    strokes: &Strokes,
    pictures: &LoadedPictures,
    used: &BrushUse,
) -> Result<BrushChange, CommandError> {
    let surface = match used.surface {
        BrushSurface::Stroke if !used.replaces_stroke() => strokes.surface(),
        BrushSurface::Stroke | BrushSurface::Now => None,
    };
    let site = Site {
        contents: &target.contents,
        surface: surface.unwrap_or(target.grid()),
        symmetry: &target.symmetry,
        images: &target.images(),
        picture: used.picture.as_deref().map(|name| pictures.get(name)).transpose()?,
    };
    Ok(BrushChange::of(used, &site)?)
}

/// Returns the colours that added voxels take from the voxels around them.
fn inherited(target: &EditTarget, add: &ListedBricks) -> Inherited {
    if add.bricks().is_empty() {
        return Inherited::default();
    }
    let scope = target.scope();
    Inherited::colours(&target.contents, add, |v| scope.allows(v))
}
