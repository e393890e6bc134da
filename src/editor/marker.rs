//! The marker under a pointer: drawing a box over the surface, sliding it, pulling its faces; and all its key commands,
//! with the selection and the clipboard.
//!
//! Gives marker boxes and commands; executes none.

use glam::{IVec3, Vec2, Vec3};

use super::tool::{ToolKind, ToolState};
use super::tool_view::ToolView;
use crate::command::{Area, Command, SelectOp};
use crate::document::Document;
use crate::input::Action;
use crate::picking::Picker;
use crate::picking::geometry::entered_face;
use crate::sculpture::Grid;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::region::VoxelBox;
use crate::sculpture::selection::{SelectedBox, Selection};

/// The effect of a drag on the marker.
#[derive(Clone, Copy, PartialEq, Debug)]
enum MarkerDrag {
    /// Slides it in the plane of a face; `normal` points out of it.
    Slide { normal: Vec3, grabbed: Vec3, start: VoxelBox },
    /// Pulls a face along its normal.
    Pull { normal: Vec3, grabbed: Vec3, start: VoxelBox },
    /// Spans a box between two voxels of the surface.
    Span { from: IVec3 },
}

/// The state of the marker between events.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct MarkerTool {
    /// The drag in progress.
    drag: Option<MarkerDrag>,
    /// The movement by drags that whole voxels leave over.
    rest: Vec3,
    /// The box that was selected only to limit tools to the marker, in signed coordinates.
    lent_to_limit: Option<VoxelBox>,
}

impl MarkerTool {
    /// Returns whether there is a drag.
    pub fn is_dragged(&self) -> bool {
        self.drag.is_some()
    }

    /// Ends the drag. Returns true if there was one.
    pub fn release(&mut self) -> bool {
        self.drag.take().is_some()
    }

    /// Handles a press with the marker in hand: begins a drag unless it was beside everything. Returns the new box.
    pub fn press(
        &mut self,
        at: Vec2,
        pull: bool,
        view: &ToolView,
        picker: &Picker,
    ) -> Option<VoxelBox> {
        let start = view.document.selection().marker();
        let rays = picker.sight().rays;
        let direction = rays.direction_at(at.x, at.y);
        let (min, max) = (start.min.as_vec3(), start.max.as_vec3());
        let face = entered_face(rays.origin, direction, min, max);
        let surface = view.target(at, picker);
        let depth = |p: Vec3| (p - rays.origin).dot(direction) / direction.length_squared();
        // A face hidden by the sculpture cannot be meant, unless the surface lies in the box. The void hides nothing.
        let seen = surface.filter(|_| view.grid().opaque_count() > 0);
        let hidden = |enter: f32| {
            seen.is_some_and(|p| depth(p) < enter - 1e-3 && !start.contains(p.floor().as_ivec3()))
        };
        self.drag = match (face.filter(|(enter, _)| !hidden(*enter)), surface) {
            (Some((enter, normal)), _) => {
                let grabbed = rays.origin + direction * enter;
                Some(match pull {
                    true => MarkerDrag::Pull { normal, grabbed, start },
                    false => MarkerDrag::Slide { normal, grabbed, start },
                })
            }
            (None, Some(point)) => {
                let from = voxel_behind(point, at, view, picker);
                Some(MarkerDrag::Span { from })
            }
            (None, None) => None,
        };
        match self.drag {
            Some(MarkerDrag::Span { from }) => Some(VoxelBox { min: from, max: from + 1 }),
            _ => None,
        }
    }

    /// Drags the marker to a pixel. Returns the new box.
    pub fn drag_to(&self, at: Vec2, view: &ToolView, picker: &Picker) -> Option<VoxelBox> {
        let reach = Reach::of(view.grid());
        let rays = picker.sight().rays;
        let direction = rays.direction_at(at.x, at.y);
        match self.drag? {
            MarkerDrag::Slide { normal, grabbed, start } => {
                // The point of the face's plane under the pointer.
                let along = direction.dot(normal);
                if along.abs() < 1e-6 {
                    return None;
                }
                let t = (grabbed - rays.origin).dot(normal) / along;
                (t > 0.0).then(|| {
                    let by = (rays.origin + direction * t - grabbed).round();
                    let by = reach.slid(start, by - normal * by.dot(normal));
                    VoxelBox { min: start.min + by, max: start.max + by }
                })
            }
            MarkerDrag::Pull { normal, grabbed, start } => {
                let pulled = nearest_on_line(grabbed, normal, rays.origin, direction)?;
                let longest = reach.longest_vx();
                let pulled = pulled.round().clamp(-longest, longest) as i32;
                Some(pulled_face(start, normal, pulled))
            }
            MarkerDrag::Span { from } => {
                let to = voxel_behind(view.target(at, picker)?, at, view, picker);
                Some(VoxelBox { min: from.min(to), max: from.max(to) + 1 })
            }
        }
    }

    /// Returns the guide of a drag: the plane in which the marker moves, as lines of a lattice, or the line along which
    /// a face is pulled.
    pub fn guide(&self, document: &Document) -> Vec<[Vec3; 2]> {
        let marker = document.selection().marker();
        let (low, high) = (marker.min.as_vec3(), marker.max.as_vec3());
        let far = high.max(Reach::of(document.grid()).dims);
        let near = low.min(Vec3::ZERO);
        let outer = |normal: Vec3| if normal.max_element() > 0.5 { high } else { low };
        match self.drag {
            Some(MarkerDrag::Slide { normal, .. }) => {
                let plane = outer(normal) * normal.abs();
                lattice(normal, plane, near, far)
            }
            Some(MarkerDrag::Pull { normal, .. }) => {
                let along = normal.abs();
                let beside = (low + high) * 0.5 * (Vec3::ONE - along);
                vec![[beside + near * along, beside + far * along]]
            }
            Some(MarkerDrag::Span { .. }) | None => Vec::new(),
        }
    }

    /// Moves the marker like a drag of things at its depth. Returns the new box.
    pub fn shift(&mut self, marker: VoxelBox, by: Vec3) -> Option<VoxelBox> {
        let moved = self.rest + by;
        let whole = moved.round();
        self.rest = moved - whole;
        let by = whole.as_ivec3();
        (whole != Vec3::ZERO).then(|| VoxelBox {
            min: marker.min.saturating_add(by),
            max: marker.max.saturating_add(by),
        })
    }

    /// Returns the commands of an action about the marker, the selection or the copy, and changes the tool accordingly.
    pub fn act(
        &mut self,
        action: Action,
        document: &Document,
        tool: &mut ToolState,
        picker: &Picker,
    ) -> Vec<Command> {
        let marker = document.selection().marker();
        let colour = tool.colour;
        let area = Area::Marker;
        match action {
            Action::Marker => {
                tool.kind = ToolKind::Marker;
                Vec::new()
            }
            Action::SelectMarker => vec![Command::Select(SelectOp::Add)],
            Action::DeselectMarker => vec![Command::Select(SelectOp::Subtract)],
            Action::DropBox => vec![Command::Select(SelectOp::Drop)],
            Action::ClearSelection => vec![Command::Select(SelectOp::Clear)],
            Action::ToggleLimit => {
                let (selection, origin) = (document.selection(), document.origin());
                let (limits, empty) = (selection.limits(), selection.boxes().is_empty());
                let lent = self.lent_to_limit.take();
                let lent = lent.map(|bounds| bounds.shifted(-origin));
                let lent = lent.map(|bounds| SelectedBox { bounds, adds: true });
                let only_lent = lent.is_some_and(|lent| selection.boxes() == [lent]);
                // Limiting tools without a selection means the marker, and the next time the marker at its position by
                // then.
                let limit = Command::Limit(!limits);
                if !limits && empty {
                    self.lent_to_limit = Some(marker.shifted(origin));
                    vec![Command::Select(SelectOp::Add), limit]
                } else if limits && only_lent {
                    vec![Command::Select(SelectOp::Clear), limit]
                } else {
                    vec![limit]
                }
            }
            Action::FillMarker => {
                tool.used_colour();
                vec![Command::Fill { area, colour: Some(colour) }]
            }
            Action::ClearMarker => vec![Command::Clear { area }],
            Action::DyeMarker => {
                tool.used_colour();
                vec![Command::Dye { area, colour }]
            }
            Action::Copy | Action::Cut => {
                tool.paste_orientation = Orientation::UPRIGHT;
                vec![if action == Action::Cut { Command::Cut } else { Command::Copy }]
            }
            Action::Paste => {
                let orientation = tool.paste_orientation;
                vec![Command::Paste { at: marker.min, orientation }]
            }
            Action::TurnClip(axis) => {
                let turn = Orientation::quarter_turn(axis.index());
                tool.paste_orientation = tool.paste_orientation.then(turn);
                Vec::new()
            }
            Action::MirrorClip(axis) => {
                let mirror = Orientation::mirroring(axis.index());
                tool.paste_orientation = tool.paste_orientation.then(mirror);
                Vec::new()
            }
            Action::MoveContents(step) => {
                let by = picker.sight().screen_axes().step(step).as_ivec3();
                vec![Command::Move { by, orientation: Orientation::UPRIGHT }]
            }
            _ => Vec::new(),
        }
    }
}

/// Returns the voxel at a face on which a surface point lies.
fn voxel_behind(point: Vec3, at: Vec2, view: &ToolView, picker: &Picker) -> IVec3 {
    let grid = view.grid();
    let normal = picker.normal(grid, at, view.tool.lean);
    let dims = grid.dims().as_ivec3();
    (point - normal * 0.5).floor().as_ivec3().clamp(IVec3::ZERO, dims - 1)
}

/// Returns the default marker, in the middle of a grid.
pub(super) fn first(grid: &Grid) -> VoxelBox {
    Selection::new(grid.dims()).marker()
}

/// Returns a marker larger by a twentieth on every side, by at least a voxel.
pub(super) fn scaled(marker: VoxelBox, notches: f32) -> VoxelBox {
    let by = (marker.size() / 20).max(glam::UVec3::ONE).as_ivec3();
    let by = by * notches.round().clamp(-8.0, 8.0) as i32;
    let (mut min, mut max) = (marker.min - by, marker.max + by);
    for axis in 0..3 {
        if min[axis] >= max[axis] {
            let middle = (marker.min[axis] + marker.max[axis]).div_euclid(2);
            (min[axis], max[axis]) = (middle, middle + 1);
        }
    }
    VoxelBox { min, max }
}

/// Returns a marker longer by a voxel towards a side.
pub(super) fn stretched(marker: VoxelBox, side: Vec3) -> VoxelBox {
    pulled_face(marker, side, 1)
}

/// Limits drags of the marker to the grid's length around the grid. Rays that almost miss its plane meet it at any
/// distance.
#[derive(Clone, Copy)]
struct Reach {
    dims: Vec3,
}

impl Reach {
    fn of(grid: &Grid) -> Reach {
        Reach { dims: grid.dims().as_vec3() }
    }

    /// Returns the displacement of a box that should move by `by` voxels. If it is already farther off, it can come
    /// back.
    fn slid(self, start: VoxelBox, by: Vec3) -> IVec3 {
        let least = (-self.dims - start.max.as_vec3()).min(Vec3::ZERO);
        let most = (2.0 * self.dims - start.min.as_vec3()).max(Vec3::ZERO);
        by.clamp(least, most).as_ivec3()
    }

    /// Returns the most voxels that a face is pulled by at once.
    fn longest_vx(self) -> f32 {
        3.0 * self.dims.max_element()
    }
}

/// Returns evenly spaced lines in a plane across the axis `normal`, within a box.
fn lattice(normal: Vec3, plane: Vec3, low: Vec3, high: Vec3) -> Vec<[Vec3; 2]> {
    const FIELDS: u32 = 8;
    let across = Vec3::AXES.into_iter().filter(|axis| axis.dot(normal) == 0.0);
    let across: Vec<Vec3> = across.collect();
    let mut lines = Vec::new();
    for (i, along) in across.iter().enumerate() {
        let side = across[1 - i];
        for step in 0..=FIELDS {
            let beside = low.lerp(high, step as f32 / FIELDS as f32) * side;
            lines.push([low, high].map(|end| plane + beside + end * *along));
        }
    }
    lines
}

/// Returns a box with one face moved by `by` voxels along its normal, at least a voxel long.
fn pulled_face(start: VoxelBox, normal: Vec3, by: i32) -> VoxelBox {
    let mut marker = start;
    let axis = (0..3).find(|axis| normal[*axis] != 0.0).unwrap_or(0);
    if normal[axis] > 0.0 {
        marker.max[axis] = marker.max[axis].saturating_add(by).max(marker.min[axis] + 1);
    } else {
        marker.min[axis] = marker.min[axis].saturating_sub(by).min(marker.max[axis] - 1);
    }
    marker
}

/// Returns the position along a line (through `point` along the unit vector `axis`) that is nearest to a ray; `None` if
/// they are almost parallel.
fn nearest_on_line(point: Vec3, axis: Vec3, origin: Vec3, direction: Vec3) -> Option<f32> {
    let direction = direction.try_normalize()?;
    let across = axis.dot(direction);
    let rest = 1.0 - across * across;
    let between = origin - point;
    (rest > 1e-4).then(|| (between.dot(axis) - between.dot(direction) * across) / rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pulled_face_moves_alone_and_leaves_a_voxel() {
        let start = VoxelBox { min: IVec3::ZERO, max: IVec3::splat(4) };
        let right = pulled_face(start, Vec3::X, 3);
        assert_eq!(right, VoxelBox { min: IVec3::ZERO, max: IVec3::new(7, 4, 4) });
        let low = pulled_face(start, Vec3::NEG_Y, 2);
        assert_eq!(low, VoxelBox { min: IVec3::new(0, -2, 0), max: IVec3::splat(4) });
        let thin = pulled_face(start, Vec3::NEG_Y, -9);
        assert_eq!(thin, VoxelBox { min: IVec3::new(0, 3, 0), max: IVec3::splat(4) });
    }

    #[test]
    fn a_marker_is_led_no_farther_than_the_grid_is_long_and_can_always_come_back() {
        let reach = Reach { dims: Vec3::splat(64.0) };
        let start = VoxelBox { min: IVec3::splat(10), max: IVec3::splat(14) };
        assert_eq!(reach.slid(start, Vec3::new(3.0, 0.0, -5.0)), IVec3::new(3, 0, -5));
        let far = reach.slid(start, Vec3::new(f32::INFINITY, -1e30, 0.0));
        assert_eq!(far, IVec3::new(118, -78, 0));
        let outside = VoxelBox { min: IVec3::splat(1 << 19), max: IVec3::splat((1 << 19) + 1) };
        assert_eq!(reach.slid(outside, Vec3::X * 9.0), IVec3::ZERO);
        assert_eq!(reach.slid(outside, Vec3::X * -9.0), IVec3::X * -9);
    }

    #[test]
    fn a_lattice_lies_in_its_plane() {
        let (low, high) = (Vec3::new(-2.0, 0.0, 0.0), Vec3::new(8.0, 4.0, 16.0));
        let lines = lattice(Vec3::NEG_Y, Vec3::Y * 3.0, low, high);
        assert_eq!(lines.len(), 18);
        for end in lines.iter().flatten() {
            assert_eq!(end.y, 3.0);
            assert!(end.cmpge(low).all() && end.cmple(high).all(), "{end}");
        }
        assert!(lines.contains(&[Vec3::new(-2.0, 3.0, 2.0), Vec3::new(8.0, 3.0, 2.0)]));
    }

    #[test]
    fn a_line_is_met_where_it_comes_nearest() {
        let at = nearest_on_line(Vec3::ZERO, Vec3::X, Vec3::new(5.0, 3.0, 9.0), Vec3::NEG_Z * 2.0);
        assert!((at.unwrap() - 5.0).abs() < 1e-5);
        assert!(nearest_on_line(Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X).is_none());
    }
}
