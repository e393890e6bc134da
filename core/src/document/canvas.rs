//! The box of the sculpture: changes it by commands, and lets it grow before a tool that reaches beyond it.
//!
//! A use that may reach beyond the box is tried on a copy first, which shares almost everything; the box grows only if
//! the use puts voxels there, as far as the limits allow. Growth and edit are one undo step.

use glam::{IVec3, UVec3, Vec3};

use super::apply::ChangeCounters;
use super::edit_target::{EditTarget, SetAside};
use super::strokes::Strokes;
use super::{Applied, CommandError, Document, areas, brush, clipboard, solids};
use crate::command::{Area, CanvasChange, Command};
use crate::sculpture::Grid;
use crate::sculpture::canvas_frame::{CANVAS_STEP_VX, Canvas, CanvasFrame};
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::grid::{MAX_AXIS_VX, voxels_at_walls};
use crate::sculpture::history::Contents;
use crate::sculpture::reframe::{check_canvas, keeps_all, reframed, reframed_bits};
use crate::sculpture::region::{Region, VoxelBox};
use crate::sculpture::selection::{MARKER_LIMIT_VX, Selection};
use crate::tools::brush::spec::BrushGroup;
use crate::tools::brush::{BrushBall, BrushDirection, Contact};
use crate::tools::drawn::region::PlacedDrawnSolid;
use crate::tools::symmetry::SymmetryTransform;

/// How far a brush under an outline may reach beyond the surface, in voxels.
const BRUSH_REACH_VX: i32 = 64;

/// A growth before an edit.
#[derive(Debug)]
pub(super) struct Growth {
    counts: ChangeCounters,
    /// The edits that the next one replaces.
    aside: Option<SetAside>,
    /// The surface at the beginning of the stroke, in the former box.
    surface: Option<Grid>,
}

/// Changes the box as one undo step, unless it is so already.
pub(super) fn change_canvas(
    document: &mut Document,
    change: &CanvasChange,
    command: &Command,
) -> Result<Applied, CommandError> {
    document.require_no_stroke("canvas")?;
    let now = document.contents().canvas();
    let to = match *change {
        CanvasChange::Size(dims) => Canvas { dims, ..now },
        CanvasChange::Grow { by_vx, sides } => now.grown(by_vx, sides),
        CanvasChange::Crop => {
            let (min, max) = document.grid().opaque_bounds().ok_or(CommandError::NothingToCrop)?;
            now.cropped(min, max)
        }
        CanvasChange::Auto(grows) => Canvas { frame: CanvasFrame { grows, ..now.frame }, ..now },
    };
    if to == now {
        return Ok(Applied::default());
    }
    let contents = reframed(&document.target.contents, &to, document.limits())?;
    let is_exact = keeps_all(&document.target.contents, &contents);
    let bytes = if is_exact { 0 } else { document.target.contents.kept_bytes() };
    document.timeline.require_room(&command.label(), bytes)?;
    let change = document.target.swap_canvas(contents);
    document.timeline.push_change(command.label(), change);
    Ok(Applied::default())
}

/// Lets the box grow for a command that puts voxels beyond it, if it may grow. [`settle_growth`]
/// must follow.
pub(super) fn grow_for(document: &mut Document, command: &Command) -> Option<Growth> {
    if !document.contents().frame.grows || !may_add(command) {
        return None;
    }
    let now = document.contents().canvas();
    let in_grid = command.translated(-now.frame.origin);
    let reach = reach_of(document, &in_grid)?;
    let outside = beyond(reach, now.dims);
    if outside == [UVec3::ZERO; 2] {
        return None;
    }
    let room = fitting(&document.target, outside)?;
    let counts = document.counts();
    let replaces = matches!(command, Command::Brush(used) if used.replaces_stroke());
    let aside = replaces.then(|| document.target.set_aside());
    match needed(document, command, &room) {
        Some(contents) => {
            let to = contents.canvas();
            let surface = document.strokes.surface().map(|bits| reframed_bits(bits, &now, &to));
            let surface = document.strokes.swap_surface(surface);
            document.target.grow(contents);
            Some(Growth { counts, aside, surface })
        }
        None => {
            if let Some(aside) = aside {
                document.target.put_again(aside);
                document.return_to(counts);
            }
            None
        }
    }
}

/// Takes a growth back if the edit for which it was made has failed or changed nothing.
pub(super) fn settle_growth(
    document: &mut Document,
    growth: Growth,
    done: &Result<Applied, CommandError>,
) {
    let Growth { counts, aside, surface } = growth;
    if done.as_ref().is_ok_and(|applied| applied.stats.bricks_changed > 0) {
        return;
    }
    document.target.take_growth_back();
    document.strokes.swap_surface(surface);
    match (aside, done) {
        (Some(aside), Err(_)) => {
            document.target.put_again(aside);
            document.return_to(counts);
        }
        (None, _) => document.return_to(counts),
        // The edits set aside have been replaced by none.
        (Some(_), Ok(_)) => {}
    }
}

/// Tries a command in a larger box. Returns the contents in a box that is as large as its new voxels need, unless
/// none of them lies beyond the present one.
fn needed(document: &Document, command: &Command, room: &Canvas) -> Option<Contents> {
    let now = document.contents().canvas();
    let limits = document.limits();
    let contents = reframed(document.contents(), room, limits).ok()?;
    let shift = now.frame.origin - room.frame.origin;
    let mut probe = EditTarget::new(contents, *limits);
    probe.selection = document.target.selection.shifted(shift);
    probe.symmetry = document.target.symmetry;
    let surface = document.strokes.surface().map(|bits| reframed_bits(bits, &now, room));
    let in_grid = command.translated(-room.frame.origin);
    try_on(&mut probe, document, surface, &in_grid).ok()?;
    let (min, max) = probe.grid().opaque_bounds()?;
    let new = VoxelBox { min: min.as_ivec3() - shift, max: max.as_ivec3() - shift };
    let outside = beyond(new, now.dims);
    if outside == [UVec3::ZERO; 2] {
        return None;
    }
    // No further than the room, which fits into the limits.
    let most = [shift.as_uvec3(), room.dims - now.dims - shift.as_uvec3()];
    let step = |v: UVec3| v.map(|v| v.next_multiple_of(CANVAS_STEP_VX));
    let [low, high] = [0, 1].map(|side| step(outside[side]).min(most[side]));
    reframed(document.contents(), &now.grown_by(low, high), limits).ok()
}

/// Returns whether a command can put voxels where none were.
fn may_add(command: &Command) -> bool {
    match command {
        Command::Construct { op: EditOp::Add(_), .. }
        | Command::DrawnSolid { op: EditOp::Add(_), .. }
        | Command::Paste { .. }
        | Command::Move { .. }
        | Command::Fill { area: Area::Marker | Area::Selection, .. } => true,
        Command::Brush(used) => {
            let spec = used.brush().spec();
            spec.adds && spec.group != BrushGroup::Mask
        }
        _ => false,
    }
}

/// Returns a box around the voxels that a command in grid coordinates may add. `None` if it is refused, or adds without
/// end.
fn reach_of(document: &Document, command: &Command) -> Option<VoxelBox> {
    let target = &document.target;
    let voxel_size = target.grid().voxel_size();
    let images = target.images();
    let reach = match command {
        Command::Construct { primitive, to_vx, .. } => {
            primitive.check().ok()?;
            let bounds = |image| primitive.image_in_grid(*to_vx, voxel_size, image).bounds_vx();
            union(images.iter().map(bounds))
        }
        Command::DrawnSolid { drawn, .. } => {
            drawn.check().ok()?;
            let bounds = |image| PlacedDrawnSolid::bounds_of(drawn, voxel_size, image);
            let all: Option<Vec<VoxelBox>> = images.into_iter().map(bounds).collect();
            union(all?.into_iter())
        }
        Command::Paste { at, orientation } => {
            let is_near = at.cmple(IVec3::splat(MARKER_LIMIT_VX)).all();
            document.clip().filter(|_| is_near).map(|clip| clip.bounds(*at, *orientation))
        }
        Command::Move { by, orientation } => {
            let marked = target.selection.marker().intersect(VoxelBox::of_grid(target.grid()));
            let (size, turned) = (marked.size(), orientation.size(marked.size()));
            let to = marked
                .min
                .saturating_add(*by)
                .saturating_add((size.as_ivec3() - turned.as_ivec3()) / 2);
            let moved = VoxelBox { min: to, max: to.saturating_add(turned.as_ivec3()) };
            Selection::check_marker(moved).ok().map(|()| moved)
        }
        Command::Fill { area: Area::Marker, .. } => Some(target.selection.marker()),
        Command::Fill { .. } => Some(target.selection.stack().bounds_vx()),
        Command::Brush(used) => match &used.contact {
            Contact::Ball(ball) => {
                used.check().ok()?;
                let reach = |image| ball_reach(ball, voxel_size, image);
                union(images.iter().map(reach))
            }
            Contact::Footprint(_) => (voxels_at_walls(target.grid()) > 0).then(|| {
                let VoxelBox { min, max } = VoxelBox::of_grid(target.grid());
                VoxelBox { min: min - BRUSH_REACH_VX, max: max + BRUSH_REACH_VX }
            }),
        },
        _ => None,
    }?;
    let reach = match target.selection.limit() {
        Some(stack) => reach.intersect(stack.bounds_vx()),
        None => reach,
    };
    (!reach.is_empty()).then_some(reach)
}

/// Returns a box around an image of a ball and of its way.
fn ball_reach(ball: &BrushBall, voxel_size: Vec3, image: &SymmetryTransform) -> VoxelBox {
    let half = ball.radius * voxel_size.min_element() / voxel_size + 1.0;
    let centre = image.point(ball.centre_vx);
    let end = match ball.frame {
        BrushDirection::Displacement(by) => image.point(ball.centre_vx + by),
        BrushDirection::None | BrushDirection::Normal(_) => centre,
    };
    VoxelBox {
        min: (centre.min(end) - half).floor().as_ivec3(),
        max: (centre.max(end) + half).ceil().as_ivec3(),
    }
}

fn union(boxes: impl Iterator<Item = VoxelBox>) -> Option<VoxelBox> {
    boxes.reduce(|a, b| VoxelBox { min: a.min.min(b.min), max: a.max.max(b.max) })
}

/// Returns how far a box reaches beyond the lower and upper sides of a grid of `dims` voxels.
fn beyond(reach: VoxelBox, dims: UVec3) -> [UVec3; 2] {
    let zero = IVec3::ZERO;
    let low = zero.saturating_sub(reach.min).max(zero);
    let high = reach.max.saturating_sub(dims.as_ivec3()).max(zero);
    [low.as_uvec3(), high.as_uvec3()]
}

/// Returns a box with so many more voxels at its lower and upper sides, or with as many as an axis can have.
fn fitting(target: &EditTarget, outside: [UVec3; 2]) -> Option<Canvas> {
    let now = target.contents.canvas();
    let left = UVec3::splat(MAX_AXIS_VX).saturating_sub(now.dims);
    let [low, high] =
        outside.map(|side| side.min(left).map(|side_vx| side_vx.next_multiple_of(CANVAS_STEP_VX)));
    let low = low.min(left / CANVAS_STEP_VX * CANVAS_STEP_VX);
    let to = now.grown_by(low, high.min(left - low));
    check_canvas(&target.contents, &to).is_ok().then_some(to).filter(|to| *to != now)
}

/// Executes a command that adds voxels on a copy.
fn try_on(
    probe: &mut EditTarget,
    document: &Document,
    surface: Option<Grid>,
    command: &Command,
) -> Result<EditStats, CommandError> {
    match command {
        Command::Construct { op, primitive, to_vx } => {
            solids::construct(probe, *op, primitive, *to_vx)
        }
        Command::DrawnSolid { op, drawn } => solids::draw(probe, *op, drawn),
        Command::Brush(used) => {
            let mut strokes = Strokes::with_surface(surface);
            brush::use_brush(probe, &mut strokes, &document.pictures, used)
        }
        Command::Paste { at, orientation } => {
            let clip = document.clip().ok_or(CommandError::NothingToPaste)?;
            clipboard::paste(probe, clip, *at, *orientation)
        }
        Command::Move { by, orientation } => clipboard::move_marked(probe, *by, *orientation),
        Command::Fill { area, colour } => areas::edit(probe, *area, EditOp::Add(*colour)),
        _ => Ok(EditStats::default()),
    }
}
