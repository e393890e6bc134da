//! Changes the mask: the voxels that are protected from all tools. Mirror planes and the limit to the selection apply
//! to it as to tools; each change is undone like any other.

use std::sync::Arc;

use glam::UVec3;

use super::error::check_drawn_solid;
use super::{Applied, CommandError, Document};
use crate::command::{Area, Command, MaskArea, MaskChange, PatchRule};
use crate::refusal::InvalidValue;
use crate::sculpture::edit::{EditStats, edit_mask};
use crate::sculpture::edit_scope::{EditScope, ScopedRegion};
use crate::sculpture::region::{Everywhere, ListedBricks, Region};
use crate::sculpture::{Grid, Rgb};
use crate::tools::drawn::region::PlacedDrawnSolid;
use crate::tools::flood;
use crate::tools::mask::{self, MAX_GROWTH_VX, MAX_REACH_VX};
use crate::tools::pieces::{Part, pieces};
use crate::tools::solid::check_way;

impl Document {
    /// The voxels that are protected, if any are.
    pub fn mask(&self) -> Option<&Grid> {
        self.contents.mask.as_deref()
    }

    pub(super) fn change_mask(
        &mut self,
        change: &MaskChange,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        let check = |field, by: u32, most, rule| {
            let checked = InvalidValue::check((1..=most).contains(&by), field, rule, by);
            checked.map_err(|error| error.of("mask"))
        };
        let stats = match change {
            MaskChange::Clear => self.edit_mask(&Everywhere, false)?,
            MaskChange::Invert => self.invert_mask()?,
            MaskChange::Grow(by) | MaskChange::Shrink(by) => {
                let is_growth = matches!(change, MaskChange::Grow(_));
                let field = if is_growth { "growth" } else { "shrinking" };
                check(field, *by, MAX_GROWTH_VX, "must be by 1 to 64 voxels at a time")?;
                let Some(now) = self.mask() else { return Ok(Applied::default()) };
                match is_growth {
                    true => {
                        let added = mask::grown(now, *by);
                        self.edit_mask(&added, true)?
                    }
                    false => {
                        let removed = mask::shrunk(now, *by);
                        self.edit_mask(&removed, false)?
                    }
                }
            }
            MaskChange::Smooth(around) => {
                check("evening", *around, 8, "must be within 1 to 8 voxels")?;
                let Some(now) = self.mask() else { return Ok(Applied::default()) };
                let (added, removed) = mask::evened(now, *around);
                let mut stats = self.edit_mask(&added, true)?;
                stats += self.edit_mask(&removed, false)?;
                stats
            }
            MaskChange::Put { adds, what } => self.put_in_mask(what, *adds)?,
        };
        self.applied(stats, command)
    }

    fn invert_mask(&mut self) -> Result<EditStats, CommandError> {
        let Some(before) = self.contents.mask.clone() else {
            return self.edit_mask(&Everywhere, true);
        };
        let scope = EditScope { stack: None, mask: Some(&before) };
        let mut stats = self.edit_mask(&ScopedRegion { region: &Everywhere, scope }, true)?;
        stats += self.edit_mask(&mask::listed(&before), false)?;
        Ok(stats)
    }

    fn put_in_mask(&mut self, what: &MaskArea, adds: bool) -> Result<EditStats, CommandError> {
        let images = self.images();
        let mut stats = EditStats::default();
        match what {
            MaskArea::Area(Area::Grid) => stats += self.edit_mask(&Everywhere, adds)?,
            MaskArea::Area(Area::Marker) => {
                stats += self.edit_mask(&self.selection.marker(), adds)?;
            }
            MaskArea::Area(Area::Selection) if self.selection.stack().is_empty() => {
                return Err(CommandError::NothingSelected);
            }
            MaskArea::Area(Area::Selection) => {
                stats += self.edit_mask(&self.selection.stack().clone(), adds)?;
            }
            MaskArea::Solid { primitive, to_vx } => {
                primitive.check().and_then(|()| check_way(*to_vx))?;
                let voxel_size = self.grid().voxel_size();
                for image in images {
                    stats +=
                        self.edit_mask(&primitive.image_in_grid(*to_vx, voxel_size, &image), adds)?;
                }
            }
            MaskArea::DrawnSolid(drawn) => {
                check_drawn_solid(drawn)?;
                for image in images {
                    let placed = PlacedDrawnSolid::new(drawn, self.grid(), image);
                    stats += self.edit_mask(&placed, adds)?;
                }
            }
            MaskArea::Colour { colour, tolerance } => {
                let voxels = self.voxels_of_colour(*colour, *tolerance)?;
                stats += self.edit_mask(&voxels, adds)?;
            }
            MaskArea::Cavities { reach_vx, depth_vx } => {
                let rule = "within which cavities are looked for must be 1 to 4 voxels";
                let is_reach = (1..=MAX_REACH_VX).contains(reach_vx);
                InvalidValue::check(is_reach, "reach", rule, reach_vx)?;
                let found = mask::cavities(self.grid(), *reach_vx);
                stats += self.edit_mask(&self.thickened(&found, *depth_vx)?, adds)?;
            }
            MaskArea::Patch { at, by, depth_vx } => {
                let patch = self.patch(*at, *by)?;
                stats += self.edit_mask(&self.thickened(&patch, *depth_vx)?, adds)?;
            }
            MaskArea::Piece { at } => {
                let voxels = self.piece_at(*at)?;
                stats += self.edit_mask(&voxels, adds)?;
            }
        }
        Ok(stats)
    }

    fn voxels_of_colour(&self, colour: Rgb, tolerance: f32) -> Result<ListedBricks, CommandError> {
        InvalidValue::check_share("tolerance", tolerance)?;
        if !self.has_colour() {
            return Err(CommandError::NoColour);
        }
        Ok(flood::of_colour(&self.contents, colour, tolerance))
    }

    /// The patch of the surface around a voxel, and those around its mirror images.
    fn patch(&self, at: UVec3, by: PatchRule) -> Result<ListedBricks, CommandError> {
        match by {
            PatchRule::Colour(tolerance) => InvalidValue::check_share("tolerance", tolerance)?,
            PatchRule::Flat(angle_deg) => {
                let is_angle = (0.0..=180.0).contains(&angle_deg);
                let rule = "must be from 0 to 180 degrees";
                InvalidValue::check(is_angle, "angle of a patch", rule, angle_deg)?;
            }
        }
        let starts = self.surface_images(at)?;
        Ok(match by {
            PatchRule::Colour(tolerance) => flood::patch(&self.contents, &starts, tolerance),
            PatchRule::Flat(angle_deg) => ListedBricks::union(
                starts.iter().map(|start| mask::flat_patch(self.grid(), *start, angle_deg)),
            ),
        })
    }

    /// All that hangs together with a voxel, and with its mirror images.
    fn piece_at(&self, at: UVec3) -> Result<ListedBricks, CommandError> {
        let grid = self.grid();
        let starts = self.surface_images(at)?;
        let found = pieces(grid, Part::Solid, self.limits.grid_bytes, &())
            .map_err(crate::tools::repair::RepairError::from)?;
        let wanted: Vec<u32> = starts.iter().filter_map(|v| found.at(v.as_ivec3())).collect();
        let bricks = grid
            .nonempty_bricks()
            .map(|(b, _)| (b, found.chosen(grid.brick_index(b), &|piece| wanted.contains(&piece))));
        Ok(ListedBricks::new(bricks.filter(|(_, brick)| !brick.is_empty()).collect()))
    }

    /// A voxel of the surface, and those of its mirror images that are of the surface.
    pub(super) fn surface_images(&self, at: UVec3) -> Result<Vec<UVec3>, CommandError> {
        let grid = self.grid();
        if at.cmpge(grid.dims()).any() || !flood::is_on_surface(grid, at.as_ivec3()) {
            return Err(CommandError::NotOnSurface(at));
        }
        let centre = at.as_vec3() + 0.5;
        let images = self.images().into_iter();
        let voxels = images.map(|image| image.point(centre).floor().as_ivec3());
        Ok(voxels.filter(|v| flood::is_on_surface(grid, *v)).map(|v| v.as_uvec3()).collect())
    }

    fn thickened(&self, voxels: &ListedBricks, by: u32) -> Result<ListedBricks, CommandError> {
        let rule = "reaches up to 4 voxels from the surface";
        InvalidValue::check(by <= MAX_REACH_VX, "depth of a patch", rule, by)?;
        Ok(mask::thickened(voxels, self.grid().brick_dims(), by))
    }

    /// Adds voxels to the mask or takes them out of it, within the selection if tools are limited to it.
    pub(super) fn edit_mask(
        &mut self,
        region: &impl Region,
        adds: bool,
    ) -> Result<EditStats, CommandError> {
        let grid = self.grid();
        match self.contents.mask.is_none() {
            true if !adds => return Ok(EditStats::default()),
            true => {
                let left = self.limits.grid_bytes.saturating_sub(grid.heap_bytes());
                Grid::check(grid.dims(), grid.voxel_size(), left)?;
            }
            false => {}
        }
        let new = match self.contents.mask {
            None => Some(Box::new(self.grid().try_emptied()?)),
            Some(_) => None,
        };
        let contents = Arc::make_mut(&mut self.contents);
        let recorder = self.recorder.for_mask(&contents.grid);
        let Some(mut bits) = contents.mask.take().or(new) else { return Ok(EditStats::default()) };
        let scope = EditScope { stack: self.selection.limit(), mask: None };
        let stats = match scope.is_everywhere() {
            true => edit_mask(&mut bits, region, adds, recorder, &mut self.dirty),
            false => {
                let region = ScopedRegion { region, scope };
                edit_mask(&mut bits, &region, adds, recorder, &mut self.dirty)
            }
        };
        contents.mask = Some(bits);
        contents.drop_empty_mask();
        Ok(stats)
    }
}
