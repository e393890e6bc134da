//! Carries out uses of brushes: the changes that a brush's file describes, limited to the selection and kept off the
//! mask.
//!
//! As all tools it changes voxels through [`Document::edit`] and [`Document::paint`] alone.

use std::path::Path;
use std::sync::Arc;

use glam::UVec3;

use super::{CommandError, Document};
use crate::sculpture::Grid;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::inherit::Inherited;
use crate::sculpture::region::ListedBricks;
use crate::tools::brush::change::{Change, NewClay, Paint, Site};
use crate::tools::brush::spec::BrushGroup;
use crate::tools::brush::{BrushSurface, BrushUse};
use crate::tools::texture::Texture;

impl Document {
    /// Uses a brush and its mirror images, all at once.
    pub(super) fn brush(&mut self, used: &BrushUse) -> Result<EditStats, CommandError> {
        used.check()?;
        let needs_colours = used.brush().spec().script.is_some_and(|script| script.needs_colours);
        if needs_colours && !self.has_colour() {
            return Err(CommandError::NoColour);
        }
        match used.replaces_stroke() {
            true => self.instead_of_stroke(|document| document.carry_out(used)),
            false => self.carry_out(used),
        }
    }

    fn carry_out(&mut self, used: &BrushUse) -> Result<EditStats, CommandError> {
        let Change { remove, add, new_clay, paint } = self.change_of(used)?;
        let keeps_surface = used.surface == BrushSurface::Stroke && !used.replaces_stroke();
        if used.brush().spec().group == BrushGroup::Mask {
            let mut stats = self.edit_mask(&add, true)?;
            stats += self.edit_mask(&remove, false)?;
            if keeps_surface {
                self.keep_stroke_surface()?;
            }
            return Ok(stats);
        }
        let inherited = match new_clay {
            NewClay::Inherited => self.inherited(&add),
            NewClay::Base | NewClay::Colour(_) => Inherited::default(),
        };
        let colour = match new_clay {
            NewClay::Colour(colour) => Some(colour),
            NewClay::Base | NewClay::Inherited => None,
        };
        self.check_colour_memory(|document, exact| {
            let painted = paint.iter().map(|(voxels, paint)| match paint {
                Paint::Carried(_) => document.unpainted_bricks(voxels),
                Paint::Mix(_) | Paint::Stencil(_) => {
                    document.new_pages(voxels, EditOp::Recolour(document.new_colour()), exact)
                }
            });
            document.new_pages(&add, EditOp::Add(colour), exact)
                + painted.sum::<u64>()
                + inherited.new_pages(document.contents())
        })?;
        if keeps_surface {
            self.keep_stroke_surface()?;
        }
        let mut stats = self.edit(&remove, EditOp::Subtract);
        stats += self.edit(&add, EditOp::Add(colour));
        if !inherited.is_empty() {
            self.paint(&add, |v, now| inherited.colour(v).unwrap_or(now));
        }
        for (voxels, paint) in &paint {
            stats += match paint {
                Paint::Mix(mix) => self.paint(voxels, |v, now| mix.colour(v, now)),
                Paint::Stencil(stencil) => self.paint(voxels, |v, now| stencil.colour(v, now)),
                Paint::Carried(pulled) => {
                    self.paint(voxels, |v, now| pulled.colour(v).unwrap_or(now))
                }
            };
        }
        Ok(stats)
    }

    fn change_of(&self, used: &BrushUse) -> Result<Change, CommandError> {
        let surface = match used.surface {
            BrushSurface::Stroke if !used.replaces_stroke() => self.stroke_surface(),
            BrushSurface::Stroke | BrushSurface::Now => self.grid(),
        };
        let picture = used.picture.as_deref().map(|name| self.picture(name)).transpose()?;
        let images = self.images();
        let site = Site {
            contents: &self.contents,
            surface,
            symmetry: &self.symmetry,
            images: &images,
            picture: picture.as_ref(),
        };
        Ok(Change::of(used, &site)?)
    }

    /// The surface on which uses of a brush with [`BrushSurface::Stroke`] work: as it was when the stroke began.
    pub fn stroke_surface(&self) -> &Grid {
        self.stroke_surface.as_deref().unwrap_or(self.grid())
    }

    /// The number of bricks among those of a list that have no page of colours.
    fn unpainted_bricks(&self, voxels: &ListedBricks) -> u64 {
        if !self.has_colour() {
            return 0;
        }
        let unpainted = |b: &UVec3| self.material().page(self.grid().brick_index(*b)).is_none();
        voxels.bricks().iter().filter(|(b, _)| unpainted(b)).count() as u64
    }

    pub(super) fn picture(&self, name: &Path) -> Result<Arc<Texture>, CommandError> {
        let texture = self.pictures.get(name).cloned();
        texture.ok_or_else(|| CommandError::NoPicture(name.to_path_buf()))
    }

    /// Does `work` in place of all that the open stroke has done so far. If it is refused, the stroke is as it was.
    fn instead_of_stroke(
        &mut self,
        work: impl FnOnce(&mut Document) -> Result<EditStats, CommandError>,
    ) -> Result<EditStats, CommandError> {
        let (revision, state) = (self.revision, self.state);
        let record = self.recorder.finish();
        let done = match self.try_swap_bricks(record) {
            Ok(done) => done,
            Err(refused) => {
                let (record, error) = *refused;
                self.recorder.resume(record, &self.contents.grid);
                return Err(error);
            }
        };
        self.state = self.settled;
        let stats = work(self);
        if stats.is_err() {
            // Nothing has changed since, so this gives the same record again.
            let record = self.swap_bricks(done);
            self.recorder.resume(record, &self.contents.grid);
            (self.revision, self.state) = (revision, state);
        }
        stats
    }
}
