//! Applies tools to a document: solids, images on them, brushes and pastes, each with its mirror images,
//! limited to the selection, kept off the mask, and repeated in arrays.
//!
//! All changes go through [`Document::edit`] and [`Document::paint`], which apply selection and mask. Memory is checked before the first change.

use std::sync::Arc;

use glam::{IVec3, UVec3, Vec3};

use super::error::check_drawn_solid;
use super::{Applied, CommandError, Document};
use crate::command::Command;
use crate::refusal::{InvalidValue, MemoryBudget, OverBudget};
use crate::sculpture::clip::Clip;
use crate::sculpture::edit::{self, EditOp, EditStats};
use crate::sculpture::edit_scope::{EditScope, ScopedRegion};
use crate::sculpture::history::Contents;
use crate::sculpture::inherit::Inherited;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::paint::paint_each;
use crate::sculpture::region::{ListedBricks, Region};
use crate::sculpture::selection::MARKER_LIMIT_VX;
use crate::sculpture::{Brick, Rgb};
use crate::tools::brush::BrushSurface;
use crate::tools::drawn::DrawnSolid;
use crate::tools::drawn::region::PlacedDrawnSolid;
use crate::tools::solid::{PlacedSolid, Primitive, check_way};
use crate::tools::symmetry::SymmetryTransform;

/// Most copies in an array.
pub const MAX_ARRAY: u32 = 1024;
/// Most uses of tools that an array repeats or makes.
pub const MAX_REPEATED: usize = 1 << 14;

impl Document {
    /// Uses a tool once and remembers it for arrays.
    pub(super) fn use_tool(&mut self, command: &Command) -> Result<Applied, CommandError> {
        let stats = match command {
            Command::Construct { op, primitive, to_vx } => {
                self.construct(*op, primitive, *to_vx)?
            }
            Command::DrawnSolid { op, drawn } => self.construct_drawn(*op, drawn)?,
            Command::Texture { primitive, picture } => self.texture(primitive, picture)?,
            Command::Brush(used) => self.brush(used)?,
            Command::Paste { at, orientation } => self.paste(*at, *orientation)?,
            _ => EditStats::default(),
        };
        let applied = self.applied(stats, command)?;
        let replaces = matches!(command, Command::Brush(used) if used.replaces_stroke());
        let used = match command {
            // A copy in an array does not take the place of those before it.
            Command::Brush(used) if replaces => Command::Brush(used.clone().on(BrushSurface::Now)),
            _ => command.clone(),
        };
        let uses = if self.stroke.is_none() { &mut self.last_uses } else { &mut self.uses };
        if replaces || self.stroke.is_none() {
            uses.clear();
        }
        if uses.len() <= MAX_REPEATED {
            uses.push(used);
        }
        Ok(applied)
    }

    /// Makes the stroke that has just ended the last operation, if a tool was used in it.
    pub(super) fn remember_stroke(&mut self) {
        if !self.uses.is_empty() {
            std::mem::swap(&mut self.uses, &mut self.last_uses);
            self.uses.clear();
        }
    }

    /// Repeats the last operation, each time further; all copies together become the last operation.
    pub(super) fn array(
        &mut self,
        count: u32,
        step: IVec3,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.require_no_stroke("array")?;
        let uses = match self.last_uses.len() {
            0 => return Err(CommandError::NothingToRepeat),
            n if n > MAX_REPEATED => return Err(CommandError::TooLongToRepeat),
            n if count == 0 || count > MAX_ARRAY || n * count as usize > MAX_REPEATED => {
                let rule = format!(
                    "must have 1 to {MAX_ARRAY} copies and at most {MAX_REPEATED} uses of a tool in all"
                );
                return Err(InvalidValue::new("array", rule, count).into());
            }
            _ => std::mem::take(&mut self.last_uses),
        };
        let mut stats = EditStats::default();
        let (revision, states) = (self.revision, self.states);
        self.stroke = Some(command.label());
        for i in 1..=count {
            for used in &uses {
                let done = used
                    .shifted(step.saturating_mul(IVec3::splat(i as i32)))
                    .ok_or(CommandError::NothingToRepeat)
                    .and_then(|shifted| self.apply(&shifted));
                match done {
                    Ok(applied) => stats += applied.stats,
                    Err(error) => {
                        self.apply(&Command::Cancel)?;
                        // Reverted to the state before: copies elsewhere stay current.
                        (self.revision, self.states) = (revision, states);
                        self.last_uses = uses;
                        return Err(error);
                    }
                }
            }
        }
        if let Err(error) = self.apply(&Command::End) {
            self.apply(&Command::Cancel)?;
            (self.revision, self.states) = (revision, states);
            self.last_uses = uses;
            return Err(error);
        }
        self.last_uses.splice(0..0, uses);
        Ok(Applied { stats, steps: 0 })
    }

    /// The images of tools by the symmetry in use, the identity first.
    pub fn images(&self) -> Vec<SymmetryTransform> {
        self.symmetry.images(self.grid().dims(), self.grid().voxel_size())
    }

    fn construct(
        &mut self,
        op: EditOp,
        primitive: &Primitive,
        to_vx: Option<Vec3>,
    ) -> Result<EditStats, CommandError> {
        primitive.check().and_then(|()| check_way(to_vx))?;
        if matches!(op, EditOp::Recolour(_)) && !self.has_colour() {
            return Err(CommandError::NoColour);
        }
        let regions = self.images_of(primitive, to_vx, op)?;
        let mut stats = EditStats::default();
        regions.iter().for_each(|(_, region)| stats += self.edit(region, op));
        Ok(stats)
    }

    fn construct_drawn(
        &mut self,
        op: EditOp,
        drawn: &DrawnSolid,
    ) -> Result<EditStats, CommandError> {
        check_drawn_solid(drawn)?;
        if matches!(op, EditOp::Recolour(_)) && !self.has_colour() {
            return Err(CommandError::NoColour);
        }
        let images = self.images();
        let regions: Vec<_> =
            images.iter().map(|image| PlacedDrawnSolid::new(drawn, self.grid(), *image)).collect();
        self.check_colour_memory(|document, exact| {
            regions.iter().map(|region| document.new_pages(region, op, exact)).sum()
        })?;
        let mut stats = EditStats::default();
        regions.iter().for_each(|region| stats += self.edit(region, op));
        Ok(stats)
    }

    /// Colours the voxels inside a solid by an image. Mirror images show the image mirrored.
    fn texture(
        &mut self,
        primitive: &Primitive,
        picture: &std::path::Path,
    ) -> Result<EditStats, CommandError> {
        primitive.check()?;
        if !self.has_colour() {
            return Err(CommandError::NoColour);
        }
        let texture = self.picture(picture)?;
        let placed = primitive.in_grid(self.grid().voxel_size());
        let image_point = primitive.solid.spec().image_point;
        let mut stats = EditStats::default();
        for (image, region) in
            self.images_of(primitive, None, EditOp::Recolour(self.new_colour()))?
        {
            stats += self.paint(&region, |v, _| {
                let p = placed.tool_point(image.origin_of(v.as_dvec3() + 0.5).as_vec3());
                texture.sample(image_point(p))
            });
        }
        Ok(stats)
    }

    /// A solid and its mirror images, placed in the grid; an error if memory does not suffice for the colours that `op`
    /// paints.
    fn images_of(
        &self,
        primitive: &Primitive,
        to_vx: Option<Vec3>,
        op: EditOp,
    ) -> Result<Vec<(SymmetryTransform, PlacedSolid)>, CommandError> {
        let voxel_size = self.grid().voxel_size();
        let placed =
            |image: SymmetryTransform| (image, primitive.image_in_grid(to_vx, voxel_size, &image));
        let images = self.images();
        let solids: Vec<_> = images.into_iter().map(placed).collect();
        self.check_colour_memory(|document, exact| {
            solids.iter().map(|(_, region)| document.new_pages(region, op, exact)).sum()
        })?;
        Ok(solids)
    }

    /// The colours that voxels to be added take from those around them.
    pub(super) fn inherited(&self, add: &ListedBricks) -> Inherited {
        if add.bricks().is_empty() {
            return Inherited::default();
        }
        let scope = self.scope();
        Inherited::colours(&self.contents, add, |v| scope.allows(v))
    }

    /// Keeps the present surface for what follows in the open stroke, unless an earlier one is kept.
    pub(super) fn keep_stroke_surface(&mut self) -> Result<(), CommandError> {
        if self.stroke_open() && self.stroke_surface.is_none() {
            self.stroke_surface = Some(Box::new(self.grid().copied()?));
        }
        Ok(())
    }

    /// Pastes the clipboard: its voxels exist afterwards, in its colours.
    pub(super) fn paste(
        &mut self,
        at: IVec3,
        orientation: Orientation,
    ) -> Result<EditStats, CommandError> {
        let Some(clip) = self.clip.take() else { return Err(CommandError::NothingToPaste) };
        let voxels = self.pasted(&clip, at, orientation);
        let done = voxels.map(|voxels| {
            let (existing, new) = self.parted(&voxels);
            let colour = |v: UVec3, _| clip.colour(at, orientation, v);
            let mut stats = self.paint(&existing, colour);
            stats += self.edit(&new, EditOp::Add(None));
            self.paint(&new, colour);
            stats
        });
        self.clip = Some(clip);
        done
    }

    /// The voxels that a clip would fill; an error if memory does not suffice for their colours.
    pub(super) fn pasted(
        &self,
        clip: &Clip,
        at: IVec3,
        orientation: Orientation,
    ) -> Result<ListedBricks, CommandError> {
        let far = IVec3::splat(MARKER_LIMIT_VX);
        if at.cmplt(-far).any() || at.cmpgt(far).any() {
            return Err(
                InvalidValue::new("place to paste at", "is too far from the grid", at).into()
            );
        }
        let voxels = clip.voxels(at, orientation, self.grid().brick_dims());
        if self.has_colour() {
            let unpainted = |b: &UVec3| self.material().page(self.grid().brick_index(*b)).is_none();
            let pages = voxels.bricks().iter().filter(|(b, _)| unpainted(b)).count() as u64;
            self.check_colour_memory(|_, _| pages)?;
        }
        Ok(voxels)
    }

    /// Splits voxels into those that exist and those that do not.
    fn parted(&self, voxels: &ListedBricks) -> (ListedBricks, ListedBricks) {
        let grid = self.grid();
        let part = |keep: fn(&Brick, &Brick) -> Brick| {
            let bricks = voxels.bricks().iter().map(|(b, mask)| (*b, keep(mask, grid.brick(*b))));
            ListedBricks::new(bricks.collect())
        };
        (part(|mask, bits| mask.and(bits)), part(|mask, bits| mask.and_not(bits)))
    }

    /// Where tools may work.
    pub(super) fn scope(&self) -> EditScope<'_> {
        EditScope { stack: self.selection.limit(), mask: self.contents.mask.as_deref() }
    }

    /// One edit, where tools may work.
    pub(super) fn edit(&mut self, region: &impl Region, op: EditOp) -> EditStats {
        let (contents, recorder, dirty) =
            (Arc::make_mut(&mut self.contents), &mut self.recorder, &mut self.dirty);
        let mask = contents.mask.take();
        let scope = EditScope { stack: self.selection.limit(), mask: mask.as_deref() };
        let stats = match scope.is_everywhere() {
            true => edit::edit(contents, region, op, recorder, dirty),
            false => edit::edit(contents, &ScopedRegion { region, scope }, op, recorder, dirty),
        };
        contents.mask = mask;
        stats
    }

    /// Paints voxel by voxel, where tools may work.
    pub(super) fn paint(
        &mut self,
        region: &impl Region,
        colour: impl Fn(UVec3, Rgb) -> Rgb + Sync,
    ) -> EditStats {
        let (contents, recorder, dirty) =
            (Arc::make_mut(&mut self.contents), &mut self.recorder, &mut self.dirty);
        let mask = contents.mask.take();
        let scope = EditScope { stack: self.selection.limit(), mask: mask.as_deref() };
        let stats = match scope.is_everywhere() {
            true => paint_each(contents, region, colour, recorder, dirty),
            false => paint_each(contents, &ScopedRegion { region, scope }, colour, recorder, dirty),
        };
        contents.mask = mask;
        stats
    }

    /// The number of new colour pages of an edit: a quick upper bound, or exact.
    pub(super) fn new_pages(&self, region: &impl Region, op: EditOp, exact: bool) -> u64 {
        let (contents, scope) = (&self.contents, self.scope());
        match scope.is_everywhere() {
            true => pages_of(contents, region, op, exact),
            false => pages_of(contents, &ScopedRegion { region, scope }, op, exact),
        }
    }

    /// Refuses a change that would take more memory for colours than is allowed. `pages`: how many new pages it takes,
    /// at most (`false`) or as exactly as can be known (`true`).
    pub(super) fn check_colour_memory(
        &self,
        pages: impl Fn(&Document, bool) -> u64,
    ) -> Result<(), CommandError> {
        let needed = |exact| self.material().bytes_with(pages(self, exact));
        let budget = self.limits.colour_bytes;
        if needed(false) <= budget {
            return Ok(());
        }
        let (what, purpose) = ("this may need", MemoryBudget::Colours);
        Ok(OverBudget::check(what, needed(true), purpose, budget)?)
    }

    /// A colour that unpainted voxels do not have.
    pub(super) fn new_colour(&self) -> Rgb {
        Rgb(self.material().base().0.map(|v| !v))
    }
}

fn pages_of(contents: &Contents, region: &impl Region, op: EditOp, exact: bool) -> u64 {
    match edit::max_new_pages(contents, region, op) {
        Some(_) if exact => edit::count_new_pages(contents, region, op),
        at_most => at_most.unwrap_or(0),
    }
}

impl Command {
    /// The same use of a tool, moved by `step` voxels. None if the command does not use a tool.
    fn shifted(&self, step: IVec3) -> Option<Command> {
        let by = step.as_vec3();
        let solid =
            |primitive: &Primitive| Primitive { centre_vx: primitive.centre_vx + by, ..*primitive };
        Some(match self {
            Command::Construct { op, primitive, to_vx } => Command::Construct {
                op: *op,
                primitive: solid(primitive),
                to_vx: to_vx.map(|to| to + by),
            },
            Command::DrawnSolid { op, drawn } => {
                Command::DrawnSolid { op: *op, drawn: drawn.shifted(by) }
            }
            Command::Texture { primitive, picture } => {
                Command::Texture { primitive: solid(primitive), picture: picture.clone() }
            }
            Command::Brush(used) => Command::Brush(used.shifted(by)),
            Command::Paste { at, orientation } => {
                Command::Paste { at: at.saturating_add(step), orientation: *orientation }
            }
            _ => return None,
        })
    }
}
