//! Explains why a tool has changed nothing, or only part of what was meant. It finds the reason by a trial without each
//! obstacle.
//!
//! Takes the tried commands; gives messages. Changes nothing.

use super::outcome::Outcome;
use super::tool::{ToolKind, ToolState};
use crate::command::{Area, Command, MaskArea, MaskChange};
use crate::document::{Document, Heeds};
use crate::notice::Notice;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::grid::voxels_at_walls;
use crate::sculpture::region::{Region, VoxelBox};
use crate::sculpture::{Grid, Rgb};
use crate::tools::brush::footprint::Footprint;
use crate::tools::brush::keys::{REACH, STRENGTH};
use crate::tools::brush::{BrushBall, BrushId, BrushUse, Contact};
use crate::tools::drawn::region::PlacedDrawnSolid;
use crate::tools::solid::{Primitive, Solid};

/// Most commands that are tried again.
const MOST_TRIED: usize = 16;
/// Largest excess of a solid's bounds over the solid, in voxels.
const BOUNDS_MARGIN: i32 = 2;

/// The effect of a stroke so far.
#[derive(Default)]
pub(super) struct StrokeTally {
    /// Number of voxels that it has changed.
    pub changed: u64,
    /// The first commands, until one changes something.
    pub tried: Vec<Command>,
    /// It has added voxels, and would have gone beyond the walls of the grid.
    pub beyond: bool,
}

impl StrokeTally {
    /// Counts the changes of a command of the stroke.
    pub fn count(&mut self, command: &Command, changed: u64, document: &Document) {
        self.changed += changed;
        self.beyond |= changed > 0 && goes_beyond(document, command);
        if self.changed == 0 && self.tried.len() < MOST_TRIED {
            self.tried.push(command.clone());
        }
    }
}

/// Whether additions have met the walls of the grid, and whether that was reported.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Walls {
    /// Voxels at the walls before the present stroke, if it may add some there.
    before: Option<u64>,
    /// It was reported that the last use of a tool was cut off.
    said: bool,
}

impl Walls {
    /// Begins a stroke at whose end added voxels at the walls are noticed. `adds`: it may add some.
    pub fn begin(&mut self, adds: bool, grid: &Grid) {
        self.before = adds.then(|| voxels_at_walls(grid));
    }

    /// Returns whether to report that added voxels were cut off: once, until a tool is used within the grid again.
    /// `beyond`: it is known to have gone beyond the walls.
    pub fn is_cut_off_anew(&mut self, beyond: bool, grid: &Grid) -> bool {
        let before = self.before.take();
        let met = before.is_some_and(|before| voxels_at_walls(grid) > before);
        let cut_off = beyond || met;
        let was_said = std::mem::replace(&mut self.said, cut_off);
        cut_off && !was_said
    }
}

/// Returns whether the tool in hand is a brush that adds voxels, and so may reach the walls of the grid.
pub(super) fn may_add(tool: &ToolState) -> bool {
    tool.brush().is_some_and(|brush| brush.spec().adds)
}

/// The reasons in the tool itself for changing nothing. None of them by default.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct IdleTool {
    /// It rests on the surface under the pointer.
    rests: bool,
    /// It is a brush of no strength.
    is_weak: bool,
}

impl IdleTool {
    /// Returns those of the tool in hand. `in_hand`: a hand in a headset holds it.
    pub fn of(tool: &ToolState, in_hand: bool) -> IdleTool {
        IdleTool {
            rests: tool.kind == ToolKind::Solid && tool.stand && tool.follow && !in_hand,
            is_weak: tool.brush_options().is_some_and(|options| options.get(STRENGTH) == 0.0),
        }
    }
}

/// Tries commands that have changed nothing under other conditions.
pub(super) struct Trial<'a> {
    document: &'a mut Document,
    tool: IdleTool,
}

impl Trial<'_> {
    pub fn new(document: &mut Document, tool: IdleTool) -> Trial<'_> {
        Trial { document, tool }
    }

    /// Explains why commands have changed nothing; returns `None` if there are no commands.
    pub fn explain(&mut self, tried: &[Command]) -> Option<Outcome> {
        let first = tried.first()?;
        let limited = self.document.selection().limit().is_some();
        let masked = self.document.mask().is_some();
        let note = |why: &str| Some(Outcome::Notice(Notice::note(why)));
        if (limited || masked) && self.trial(tried, Heeds::NOTHING).voxels_changed() > 0 {
            let without_limit = Heeds { limit: false, mask: true };
            if limited && self.trial(tried, without_limit).voxels_changed() > 0 || !masked {
                return Some(Outcome::Limited);
            }
            return note(
                "Nothing changed: the voxels there are masked (Ctrl+Shift+J clears the mask)",
            );
        }
        note(&self.why_idle(first))
    }

    fn trial(&mut self, commands: &[Command], heeds: Heeds) -> EditStats {
        self.document.would_change(commands, heeds)
    }

    /// Returns whether commands would change something without the mask and the limits of tools.
    fn meets(&mut self, commands: &[Command]) -> bool {
        self.trial(commands, Heeds::NOTHING).voxels_changed() > 0
    }

    fn why_idle(&mut self, command: &Command) -> String {
        let rest = match self.tool.rests {
            true => {
                "the tool rests on the surface and does not reach into it (Rest on the surface)"
            }
            false => "there is nothing where the tool was",
        };
        match command {
            Command::Construct { op: EditOp::Add(_), .. }
            | Command::DrawnSolid { op: EditOp::Add(_), .. } => {
                // The part within the grid can be cut, once it is added.
                let cut = with_op(command, EditOp::Subtract);
                let covered = self.trial(&[cut, command.clone()], Heeds::NOTHING).voxels_added;
                match covered {
                    0 => "Nothing was added: the tool was outside the grid",
                    _ => "Nothing was added: this part of the grid is full",
                }
                .to_string()
            }
            Command::Construct { op: EditOp::Subtract, .. }
            | Command::DrawnSolid { op: EditOp::Subtract, .. } => {
                format!("Nothing was cut: {rest}")
            }
            Command::Construct { op: EditOp::Recolour(colour), .. }
            | Command::DrawnSolid { op: EditOp::Recolour(colour), .. } => {
                match self.meets(&[with_op(command, EditOp::Recolour(opposite(*colour)))]) {
                    true => HAS_COLOUR.to_string(),
                    false => format!("Nothing was painted: {rest}"),
                }
            }
            Command::Texture { primitive, .. } => match self.meets(&[cut(primitive)]) {
                true => "Nothing was painted: the surface shows this image already".to_string(),
                false => format!("Nothing was painted: {rest}"),
            },
            Command::Brush(used) => self.why_brush_is_idle(used),
            Command::Fill { .. } => "Nothing was added: the area is full".to_string(),
            Command::Clear { .. } => "Nothing was deleted: the area is empty".to_string(),
            Command::Dye { area, colour } => {
                let other = Command::Dye { area: *area, colour: opposite(*colour) };
                match self.meets(&[other]) {
                    true => HAS_COLOUR.to_string(),
                    false => "Nothing was painted: the area is empty".to_string(),
                }
            }
            Command::Flood { .. } => HAS_COLOUR.to_string(),
            Command::Paste { at, orientation } => {
                let inside = self.document.clip().is_some_and(|clip| {
                    let all = whole(self.document.grid());
                    !clip.bounds(*at, *orientation).intersect(all).is_empty()
                });
                match inside {
                    true => "Nothing changed: the same voxels are there already",
                    false => "Nothing was pasted: the place is outside the grid",
                }
                .to_string()
            }
            Command::Mask(change) => self.why_mask_is_idle(change).to_string(),
            Command::Tint { .. } => {
                "Nothing was painted: the area is empty, or has these colours already".to_string()
            }
            _ => "Nothing changed".to_string(),
        }
    }

    fn why_mask_is_idle(&mut self, change: &MaskChange) -> &'static str {
        match change {
            MaskChange::Put { adds, what } => {
                let other = MaskChange::Put { adds: !adds, what: what.clone() };
                match (self.meets(&[Command::Mask(other)]), adds, what) {
                    (true, true, _) => "Nothing changed: it is masked already",
                    (true, false, _) => "Nothing changed: it is not masked",
                    (false, _, MaskArea::Colour { .. }) => {
                        "Nothing changed: no voxel has this colour within the tolerance"
                    }
                    (false, _, MaskArea::Cavities { .. }) => {
                        "Nothing changed: there are no cavities within this distance"
                    }
                    (false, ..) => "Nothing changed: it lies outside the grid",
                }
            }
            MaskChange::Grow(_) => "Nothing changed: the mask fills the grid already",
            MaskChange::Shrink(_) => "Nothing changed: the mask has no outline within the grid",
            MaskChange::Smooth(_) => "Nothing changed: the outline of the mask is even already",
            MaskChange::Clear => "Nothing changed: nothing is masked",
            MaskChange::Invert => "Nothing changed",
        }
    }

    fn why_brush_is_idle(&mut self, used: &BrushUse) -> String {
        let idle = used.brush().spec().idle;
        match &used.contact {
            Contact::Footprint(footprint) if !self.meets(&[bite(footprint)]) => NO_SURFACE,
            Contact::Footprint(_) if used.picture.is_some() => {
                "Nothing was painted: the surface shows this image already, or the image is dark here"
            }
            Contact::Footprint(_) => idle,
            Contact::Ball(ball) => self.why_ball_is_idle(ball, idle),
        }
        .to_string()
    }

    fn why_ball_is_idle(&mut self, ball: &BrushBall, idle: &'static str) -> &'static str {
        if self.tool.is_weak {
            return "Nothing changed: the strength of the brush is 0";
        }
        let ball = Primitive {
            solid: Solid::Ellipsoid,
            centre_vx: ball.centre_vx,
            half: glam::Vec3::splat(ball.radius),
            rotation: glam::Quat::IDENTITY,
        };
        if !self.meets(&[cut(&ball)]) {
            return "Nothing changed: there is no clay under the brush";
        }
        match goes_beyond(self.document, &with_op(&cut(&ball), EditOp::Add(None))) {
            true => {
                "Nothing changed: the grid ends here, or the clay already has the shape that the brush makes"
            }
            false => idle,
        }
    }
}

fn whole(grid: &Grid) -> VoxelBox {
    VoxelBox { min: glam::IVec3::ZERO, max: grid.dims().as_ivec3() }
}

/// Returns whether a command adds, or would add, beyond the walls of the grid.
pub(super) fn goes_beyond(document: &Document, command: &Command) -> bool {
    let grid = document.grid();
    let all = whole(grid);
    let leaves = |bounds: VoxelBox, margin: i32| {
        (bounds.min + margin).cmplt(all.min).any() || (bounds.max - margin).cmpgt(all.max).any()
    };
    match command {
        Command::Construct { op: EditOp::Add(_), primitive, to_vx } => {
            let size = grid.voxel_size();
            document.images().iter().any(|image| {
                leaves(primitive.image_in_grid(*to_vx, size, image).bounds_vx(), BOUNDS_MARGIN)
            })
        }
        Command::DrawnSolid { op: EditOp::Add(_), drawn } => document
            .images()
            .iter()
            .any(|image| PlacedDrawnSolid::new(drawn, grid, *image).leaves_grid()),
        Command::Paste { at, orientation } => {
            document.clip().is_some_and(|clip| leaves(clip.bounds(*at, *orientation), 0))
        }
        _ => false,
    }
}

/// Returns whether a command without effect is explained, outside of strokes.
pub(super) fn is_explained(command: &Command) -> bool {
    matches!(
        command,
        Command::Fill { area: Area::Marker | Area::Selection, .. }
            | Command::Clear { area: Area::Marker | Area::Selection }
            | Command::Dye { area: Area::Marker | Area::Selection, .. }
            | Command::Flood { .. }
            | Command::Paste { .. }
            | Command::Mask(_)
            | Command::Tint { .. }
    )
}

const HAS_COLOUR: &str = "Nothing was painted: it has this colour already";
const NO_SURFACE: &str = "Nothing changed: the brush met no surface";

fn opposite(colour: Rgb) -> Rgb {
    Rgb(colour.0.map(|channel| !channel))
}

fn cut(primitive: &Primitive) -> Command {
    Command::Construct { op: EditOp::Subtract, primitive: *primitive, to_vx: None }
}

/// Returns a command that removes the voxels that a brush sees.
fn bite(footprint: &Footprint) -> Command {
    Command::Brush(BrushUse::under(BrushId::Devour, *footprint).with(REACH, 0.0))
}

/// Returns the same solid with another operation.
fn with_op(command: &Command, op: EditOp) -> Command {
    match command.clone() {
        Command::Construct { primitive, to_vx, .. } => Command::Construct { op, primitive, to_vx },
        Command::DrawnSolid { drawn, .. } => Command::DrawnSolid { op, drawn },
        other => other,
    }
}
