//! Says why a tool has changed nothing, or only a part of what it was meant to: the reason, found by trying the
//! same without what stands in the way.
//!
//! Takes the commands that were tried; gives messages. Changes nothing.

use super::tool::ToolKind;
use super::{Editor, Outcome};
use crate::command::{Area, Command, MaskArea, MaskChange};
use crate::document::Heeds;
use crate::sculpture::Rgb;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::grid::voxels_at_walls;
use crate::sculpture::region::{Region, VoxelBox};
use crate::tools::brush::footprint::Footprint;
use crate::tools::brush::keys::{REACH, STRENGTH};
use crate::tools::brush::{Ball, BrushId, BrushUse, Contact};
use crate::tools::drawn::region::PlacedDrawnSolid;
use crate::tools::solid::{Primitive, Solid};

/// Most commands that are tried again.
pub(super) const MOST_TRIED: usize = 16;
/// The bounds of a solid may be larger than the solid by this much, in voxels.
const BOUNDS_MARGIN: i32 = 2;

/// The state of commands that change nothing, or meet the walls of the grid.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Walls {
    /// Voxels at the walls before the stroke under way, if it may add some there.
    before: Option<u64>,
    /// It has been said that the last use of a tool was cut off.
    said: bool,
}

impl Editor {
    /// Says why commands have changed nothing.
    pub(super) fn explain_idle(&mut self, tried: &[Command]) {
        let Some(first) = tried.first() else { return };
        let limited = self.document().selection().limit().is_some();
        let masked = self.document().mask().is_some();
        if (limited || masked) && self.trial(tried, Heeds::NOTHING).voxels_changed() > 0 {
            let without_limit = Heeds { limit: false, mask: true };
            if limited && self.trial(tried, without_limit).voxels_changed() > 0 || !masked {
                self.outcomes.push(Outcome::Limited);
            } else {
                self.note(
                    "Nothing changed: the voxels there are masked (Ctrl+Shift+J clears the mask)",
                );
            }
            return;
        }
        let why = self.why_idle(first);
        self.note(why);
    }

    fn trial(&mut self, commands: &[Command], heeds: Heeds) -> EditStats {
        self.session.document_mut().would_change(commands, heeds)
    }

    /// Whether commands would change something if tools worked everywhere.
    fn meets(&mut self, commands: &[Command]) -> bool {
        self.trial(commands, Heeds::NOTHING).voxels_changed() > 0
    }

    fn why_idle(&mut self, command: &Command) -> String {
        let rests = self.tool.kind == ToolKind::Solid
            && self.tool.stand
            && self.tool.follow
            && !self.hand.is_leading();
        let rest = match rests {
            true => {
                "the tool rests on the surface and does not reach into it (Rest on the surface)"
            }
            false => "there is nothing where the tool was",
        };
        match command {
            Command::Construct { op: EditOp::Add(_), .. }
            | Command::DrawnSolid { op: EditOp::Add(_), .. } => {
                // The part that is in the grid can be cut, once it is added.
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
                let inside = self.document().clip().is_some_and(|clip| {
                    let all = self.whole();
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

    fn why_ball_is_idle(&mut self, ball: &Ball, idle: &'static str) -> &'static str {
        if self.tool.brush_options().is_some_and(|options| options.get(STRENGTH) == 0.0) {
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
        match self.goes_beyond(&with_op(&cut(&ball), EditOp::Add(None))) {
            true => {
                "Nothing changed: the grid ends here, or the clay already has the shape that the brush makes"
            }
            false => idle,
        }
    }

    fn whole(&self) -> VoxelBox {
        VoxelBox { min: glam::IVec3::ZERO, max: self.document().grid().dims().as_ivec3() }
    }

    /// Whether a command adds, or would add, beyond the walls of the grid.
    pub(super) fn goes_beyond(&self, command: &Command) -> bool {
        let document = self.document();
        let all = self.whole();
        let leaves = |bounds: VoxelBox, margin: i32| {
            (bounds.min + margin).cmplt(all.min).any() || (bounds.max - margin).cmpgt(all.max).any()
        };
        let grid = document.grid();
        match command {
            Command::Construct { op: EditOp::Add(_), primitive, to_vx } => {
                let size = grid.voxel_size();
                document.images().iter().any(|image| {
                    leaves(primitive.image_in_grid(*to_vx, size, image).bounds_vx(), BOUNDS_MARGIN)
                })
            }
            Command::DrawnSolid { op: EditOp::Add(_), form } => document
                .images()
                .iter()
                .any(|image| PlacedDrawnSolid::new(form, grid, *image).leaves_grid()),
            Command::Paste { at, orientation } => {
                document.clip().is_some_and(|clip| leaves(clip.bounds(*at, *orientation), 0))
            }
            _ => false,
        }
    }

    /// A stroke begins: voxels that it adds at the walls are noticed at its end.
    pub(super) fn note_walls(&mut self) {
        let adds = match self.tool.kind {
            ToolKind::Brush(brush) => brush.spec().adds,
            _ => false,
        };
        self.walls.before = adds.then(|| voxels_at_walls(self.document().grid()));
    }

    /// Says, once until a tool is used within the grid again, that what a tool has added was cut off. `beyond`: it is
    /// known to have gone beyond the walls.
    pub(super) fn note_cut_off(&mut self, beyond: bool) {
        let before = self.walls.before.take();
        let met = before.is_some_and(|before| voxels_at_walls(self.document().grid()) > before);
        let cut_off = beyond || met;
        if cut_off && !self.walls.said {
            self.note("The grid ends there: everything outside it was left out");
        }
        self.walls.said = cut_off;
    }

    /// Counts what a command has changed: within a stroke for its end, else says why it has changed nothing.
    pub(super) fn note_changes(&mut self, command: &Command, changed: u64) {
        if let Command::Begin { .. } = command {
            return self.note_walls();
        }
        if let Some(mut stroke) = self.stroke.take() {
            stroke.changed += changed;
            stroke.beyond |= changed > 0 && self.goes_beyond(command);
            if stroke.changed == 0 && stroke.tried.len() < MOST_TRIED {
                stroke.tried.push(command.clone());
            }
            self.stroke = Some(stroke);
            return;
        }
        if self.document().stroke_open() {
            return;
        }
        let asked = matches!(
            command,
            Command::Fill { area: Area::Marker | Area::Selection, .. }
                | Command::Clear { area: Area::Marker | Area::Selection }
                | Command::Dye { area: Area::Marker | Area::Selection, .. }
                | Command::Flood { .. }
                | Command::Paste { .. }
                | Command::Mask(_)
                | Command::Tint { .. }
        );
        match changed {
            0 if asked => self.explain_idle(std::slice::from_ref(command)),
            0 => {}
            _ if matches!(command, Command::Paste { .. }) => {
                self.note_cut_off(self.goes_beyond(command));
            }
            _ => {}
        }
    }
}

const HAS_COLOUR: &str = "Nothing was painted: it has this colour already";
const NO_SURFACE: &str = "Nothing changed: the brush met no surface";

fn opposite(colour: Rgb) -> Rgb {
    Rgb(colour.0.map(|channel| !channel))
}

fn cut(primitive: &Primitive) -> Command {
    Command::Construct { op: EditOp::Subtract, primitive: *primitive, to_vx: None }
}

/// Takes off the voxels that a brush sees.
fn bite(footprint: &Footprint) -> Command {
    Command::Brush(BrushUse::under(BrushId::Devour, *footprint).with(REACH, 0.0))
}

/// The same solid with another operation.
fn with_op(command: &Command, op: EditOp) -> Command {
    match command.clone() {
        Command::Construct { primitive, to_vx, .. } => Command::Construct { op, primitive, to_vx },
        Command::DrawnSolid { form, .. } => Command::DrawnSolid { op, form },
        other => other,
    }
}
