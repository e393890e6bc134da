//! The state of the tool: its kind, mode, size, rotation, colour and position.
//!
//! It belongs to the person, not to the sculpture: changing it changes no voxel; only the commands that it returns do.

use std::path::PathBuf;

use glam::{DMat3, EulerRot, IVec3, Quat, Vec3};

use super::brushes::Brushes;
use super::draw::options::DrawOptions;
use super::pen_use::{PenTool, PenUse, PenUses};
use super::sizes::SizeUnit;
use super::symmetry::SymmetryPart;
use super::wand::Wand;
use crate::command::Command;
use crate::input::{DrawKind, ToolMode};
use crate::sculpture::Rgb;
use crate::sculpture::canvas_frame::CanvasFrame;
use crate::sculpture::orientation::Orientation;
use crate::tools::brush::BrushId;
use crate::tools::brush::dab::{BrushImage, Dab, DabPlace};
use crate::tools::brush::footprint::Footprint;
use crate::tools::brush::options::BrushOptions;
use crate::tools::solid::{Primitive, Solid};

/// Smallest and largest half extent offered by the interface.
pub const HALF_RANGE: std::ops::RangeInclusive<f32> = 0.5..=2048.0;
/// Initial half extent as a share of the grid's shortest side.
const FIRST_HALF: f32 = 0.06;

/// Number of recent colours kept.
pub const RECENT: usize = 14;

/// The kinds of tools.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum ToolKind {
    /// The solid of [`ToolState::solid`].
    Solid,
    Brush(BrushId),
    Draw(DrawKind),
    /// The marker, which belongs to the document.
    Marker,
}

/// The tool in hand. Lengths are in edges of the sculpture's smallest voxel edge, as in
/// [`Primitive`].
#[derive(Clone, PartialEq, Debug)]
pub struct ToolState {
    pub kind: ToolKind,
    pub solid: Solid,
    pub brushes: Brushes,
    pub draws: DrawOptions,
    /// The effects of a pen on each brush.
    pub pens: PenUses,
    pub mode: ToolMode,
    half: Vec3,
    /// Changing one half extent changes all in proportion.
    pub uniform: bool,
    rotation: Quat,
    turn_deg: Vec3,
    pub colour: Rgb,
    /// Colours used, latest first.
    recent: Vec<Rgb>,
    /// The picture with which a solid paints instead of the colour.
    pub picture: Option<PathBuf>,
    /// The picture with which the brush paints instead of the colour, or through which it paints the colour.
    pub stencil: Option<PathBuf>,
    /// The colour passes through the stencil where that is bright.
    pub through_stencil: bool,
    /// Centre in voxel coordinates.
    pub centre_vx: Vec3,
    /// The tool follows the pointer over the surface.
    pub follow: bool,
    /// The tool's centre snaps to centres of voxels.
    pub snap: bool,
    /// The action of the next press, instead of a use of the tool.
    pub next_press: Option<NextPress>,
    /// Largest difference of colours from that of a flood's first voxel, as a share of the range.
    pub flood_tolerance: f32,
    pub wand: Wand,
    /// A tool that follows the pointer rests on the surface instead of being half in it.
    pub stand: bool,
    /// It rested before it was set to cut.
    pub(super) rested: bool,
    /// A tool that follows the pointer turns its y axis out of the surface.
    pub lean: bool,
    /// Orientation of the copy when it is pasted.
    pub paste_orientation: Orientation,
    /// Number and distance of repetitions of the last operation.
    pub array: ArrayOptions,
}

/// A one-time action of a press, instead of a use of the tool.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NextPress {
    /// Takes the colour of the voxel.
    Pick,
    /// Recolours the voxel's patch of one colour.
    Flood,
    /// Protects the voxels connected to it.
    Wand,
    /// Places the mirror plane or the axis of rotation.
    Symmetry(SymmetryPart),
}

/// An array of the last operation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ArrayOptions {
    pub count: u32,
    /// In voxels.
    pub step: IVec3,
}

/// A change of the tool requested by a panel.
#[derive(Clone, PartialEq, Debug)]
pub enum ToolEdit {
    /// Half extent along an axis of the tool; with `uniform`, the others follow.
    Half {
        axis: usize,
        half: f32,
    },
    /// Factor on all half extents.
    Scale(f32),
    EvenOut,
    Uniform(bool),
    /// Degrees about x, then y, then z of the grid.
    Turn(Vec3),
    /// Its centre in voxel coordinates, which it keeps from then on.
    Place(Vec3),
    Colour(Rgb),
    NextPress(Option<NextPress>),
    /// A share of the range of colours.
    FloodTolerance(f32),
    Wand(Wand),
    /// The picture with which a solid or the brush in hand paints instead of the colour.
    Picture(Option<PathBuf>),
    ThroughStencil(bool),
    Snap(bool),
    Follow(bool),
    Stand(bool),
    Lean(bool),
    SizeUnit(SizeUnit),
    Brush(BrushOptions),
    Draw(DrawOptions),
    /// The effect of a pen on the brush in hand.
    Pen(PenUse),
    Array(ArrayOptions),
}

impl ToolState {
    /// Returns a cutting ball in the middle of a grid of `dims` voxels.
    pub fn new(frame: &CanvasFrame) -> ToolState {
        let mut tool = ToolState {
            kind: ToolKind::Solid,
            solid: Solid::Ellipsoid,
            brushes: Brushes::default(),
            draws: DrawOptions::default(),
            pens: PenUses::default(),
            mode: ToolMode::default(),
            half: Vec3::ONE,
            uniform: true,
            rotation: Quat::IDENTITY,
            turn_deg: Vec3::ZERO,
            colour: Rgb::new(0xd0, 0x5a, 0x32),
            recent: Vec::new(),
            picture: None,
            stencil: None,
            through_stencil: false,
            centre_vx: Vec3::ZERO,
            follow: true,
            snap: false,
            next_press: None,
            flood_tolerance: 0.04,
            wand: Wand::default(),
            stand: false,
            rested: false,
            lean: false,
            paste_orientation: Orientation::UPRIGHT,
            array: ArrayOptions { count: 3, step: IVec3::new(16, 0, 0) },
        };
        tool.reset_pose(frame);
        tool
    }

    /// Applies a change requested by a panel.
    pub fn edit(&mut self, edit: ToolEdit) {
        match edit {
            ToolEdit::Half { axis, half } => self.set_half(axis, half),
            ToolEdit::Scale(factor) => self.scale_by(factor),
            ToolEdit::EvenOut => self.even_out(),
            ToolEdit::Uniform(uniform) => self.uniform = uniform,
            ToolEdit::Turn(turn_deg) => self.set_turn_deg(turn_deg),
            ToolEdit::Place(centre_vx) => {
                self.follow = false;
                self.move_to(centre_vx);
            }
            ToolEdit::Colour(colour) => self.colour = colour,
            ToolEdit::NextPress(next) => self.next_press = next,
            ToolEdit::FloodTolerance(share) => self.flood_tolerance = share.clamp(0.0, 1.0),
            ToolEdit::Wand(wand) => self.wand = wand,
            ToolEdit::Picture(picture) => match self.kind {
                ToolKind::Brush(_) => self.stencil = picture,
                _ => self.picture = picture,
            },
            ToolEdit::ThroughStencil(through) => self.through_stencil = through,
            ToolEdit::Snap(snap) => self.snap = snap,
            ToolEdit::Follow(follow) => self.follow = follow,
            ToolEdit::Stand(stand) => self.stand = stand,
            ToolEdit::Lean(lean) => self.lean = lean,
            ToolEdit::SizeUnit(unit) => self.brushes.set_unit(unit),
            ToolEdit::Brush(options) => *self.brushes.of_mut(options.brush()) = options,
            ToolEdit::Draw(options) => self.draws = options,
            ToolEdit::Pen(chosen) => {
                if let Some(tool) = self.pen_tool() {
                    self.pens.set(tool, chosen);
                }
            }
            ToolEdit::Array(array) => self.array = array,
        }
    }

    /// Moves the tool back to the middle, upright, at a size that suits the box with which a sculpture began.
    pub fn reset_pose(&mut self, frame: &CanvasFrame) {
        self.centre_vx = frame.centre_vx();
        let half = frame.home.min_element() as f32 * FIRST_HALF;
        self.half = Vec3::splat(half.max(*HALF_RANGE.start()));
        self.uniform = true;
        self.set_turn_deg(Vec3::ZERO);
    }

    pub fn half(&self) -> Vec3 {
        self.half
    }

    /// Sets one half extent; with `uniform`, the others follow in proportion.
    pub fn set_half(&mut self, axis: usize, half: f32) {
        let half = half.clamp(*HALF_RANGE.start(), *HALF_RANGE.end());
        if self.uniform {
            self.scale_by(half / self.half[axis]);
        } else {
            self.half[axis] = half;
        }
    }

    /// Scales all half extents within the valid range.
    pub fn scale_by(&mut self, factor: f32) {
        let least = HALF_RANGE.start() / self.half.min_element();
        let most = HALF_RANGE.end() / self.half.max_element();
        if factor.is_finite() && factor > 0.0 {
            self.half *= factor.clamp(least.min(1.0), most.max(1.0));
        }
    }

    /// Sets all half extents to their mean.
    pub fn even_out(&mut self) {
        self.half = Vec3::splat(self.half.element_sum() / 3.0);
    }

    pub fn rotation(&self) -> Quat {
        self.rotation
    }

    /// Returns the rotation as degrees about x, then y, then z of the grid, as scripts write it.
    pub fn turn_deg(&self) -> Vec3 {
        self.turn_deg
    }

    pub fn set_turn_deg(&mut self, turn_deg: Vec3) {
        self.turn_deg = turn_deg;
        let turn = turn_deg * (std::f32::consts::PI / 180.0);
        self.rotation = Quat::from_euler(EulerRot::XYZEx, turn.x, turn.y, turn.z).normalize();
    }

    /// Turns the tool further, about axes of the grid.
    pub fn turn_by(&mut self, turn: Quat) {
        self.rotation = (turn * self.rotation).normalize();
        self.update_degrees();
    }

    fn update_degrees(&mut self) {
        let (x, y, z) = self.rotation.to_euler(EulerRot::XYZEx);
        self.turn_deg = Vec3::new(x, y, z) * (180.0 / std::f32::consts::PI);
    }

    /// Moves the tool, to a voxel's centre if it snaps.
    pub fn move_to(&mut self, centre_vx: Vec3) {
        if centre_vx.is_finite() {
            self.centre_vx = self.snapped(centre_vx);
        }
    }

    /// Returns a point, or the middle of the voxel there if the tool snaps.
    pub(super) fn snapped(&self, centre_vx: Vec3) -> Vec3 {
        if self.snap { centre_vx.floor() + 0.5 } else { centre_vx }
    }

    /// Puts the tool at the surface under the pointer, with the normal `normal` (a unit vector in the coordinates of
    /// voxels of `voxel_size`), respecting `stand` and `lean`.
    pub fn place_on(&mut self, point: Vec3, normal: Vec3, voxel_size: Vec3) {
        if self.lean && normal.is_normalized() {
            self.rotation = Quat::from_rotation_arc(Vec3::Y, normal);
            self.update_degrees();
        }
        let lift =
            if self.stand { normal * self.extent_along(normal, voxel_size) } else { Vec3::ZERO };
        let wanted = point + lift;
        self.move_to(wanted);
        // The nearest voxel's centre may be deeper, but not below the surface.
        if self.stand && self.snap && (self.centre_vx - wanted).dot(normal) < -1e-3 {
            let axis = normal.abs().max_position();
            self.centre_vx[axis] += normal[axis].signum();
        }
    }

    /// Returns the extent of the tool from its centre against `normal`, in voxels.
    fn extent_along(&self, normal: Vec3, voxel_size: Vec3) -> f32 {
        let tool_from_vx = DMat3::from_quat(self.rotation.as_dquat()).transpose();
        let direction = tool_from_vx * -normal.as_dvec3() * self.half.as_dvec3();
        let extent = self.primitive().shape().support(direction) as f32;
        let shortest = voxel_size.min_element();
        extent * shortest / (normal * voxel_size).length().max(f32::MIN_POSITIVE)
    }

    /// Extends the tool by `by` voxels towards a side along a grid axis; the other side stays in place.
    pub fn stretch(&mut self, side: Vec3, by: f32) {
        let along = (self.rotation.inverse() * side).abs();
        let axis = (0..3).max_by(|a, b| along[*a].total_cmp(&along[*b])).unwrap_or(0);
        let before = self.half[axis];
        let range = *HALF_RANGE.start()..=*HALF_RANGE.end();
        self.half[axis] = (before + 0.5 * by).clamp(*range.start(), *range.end());
        self.centre_vx += side * (self.half[axis] - before);
    }

    /// Returns the brush in hand, if it is one.
    pub fn brush(&self) -> Option<BrushId> {
        match self.kind {
            ToolKind::Brush(brush) => Some(brush),
            ToolKind::Solid | ToolKind::Draw(_) | ToolKind::Marker => None,
        }
    }

    /// Returns the options of the brush in hand.
    pub fn brush_options(&self) -> Option<&BrushOptions> {
        self.brush().map(|brush| self.brushes.of(brush))
    }

    /// Returns the brush in hand, if it works under a picture outline.
    pub fn picture_brush(&self) -> Option<BrushId> {
        self.brush().filter(|brush| brush.spec().is_in_picture())
    }

    /// Returns the brush in hand, if it works in a ball of clay.
    pub fn ball_brush(&self) -> Option<BrushId> {
        self.brush().filter(|brush| !brush.spec().is_in_picture())
    }

    /// Records a use of the colour.
    pub fn used_colour(&mut self) {
        self.recent.retain(|colour| *colour != self.colour);
        self.recent.insert(0, self.colour);
        self.recent.truncate(RECENT);
    }

    /// Returns the colours used, latest first.
    pub fn recent(&self) -> &[Rgb] {
        &self.recent
    }

    /// Restores recent colours, latest first.
    pub fn set_recent(&mut self, colours: impl Iterator<Item = Rgb>) {
        self.recent = colours.take(RECENT).collect();
    }

    pub fn primitive(&self) -> Primitive {
        Primitive {
            solid: self.solid,
            centre_vx: self.centre_vx,
            half: self.half,
            rotation: self.rotation,
        }
    }

    /// Returns the image with which the tool in hand paints.
    pub fn picture_in_use(&self) -> Option<&PathBuf> {
        match self.kind {
            ToolKind::Brush(brush) => {
                self.stencil.as_ref().filter(|_| brush.spec().image_spacing.is_some())
            }
            _ => self.picture.as_ref(),
        }
    }

    /// Returns the use of a brush under a footprint. `uses`: number of earlier uses in the stroke.
    pub fn brush_under(
        &self,
        options: &BrushOptions,
        footprint: Footprint,
        uses: u32,
    ) -> Option<Command> {
        let spec = options.brush().spec();
        let image = self.stencil.as_deref().filter(|_| spec.image_spacing.is_some());
        let image =
            image.map(|path| BrushImage { path, lets_colour_through: self.through_stencil });
        let place = DabPlace::Picture { footprint, colour: self.colour, image, uses };
        (spec.dab)(&Dab { options, place }).map(Command::Brush)
    }

    /// Returns the tool in hand, if a pen has an effect on it.
    pub fn pen_tool(&self) -> Option<PenTool> {
        match self.kind {
            ToolKind::Solid => Some(PenTool::Solid),
            ToolKind::Brush(brush) => (!brush.spec().is_held()).then_some(PenTool::Brush(brush)),
            ToolKind::Draw(_) | ToolKind::Marker => None,
        }
    }

    /// Returns the ball of a deforming brush at the tool.
    pub fn ball(&self, brush: BrushId) -> Primitive {
        Primitive {
            solid: Solid::Ellipsoid,
            centre_vx: self.centre_vx,
            half: Vec3::splat(self.brushes.ball_radius(brush)),
            rotation: Quat::IDENTITY,
        }
    }
}

#[cfg(test)]
#[path = "tool_tests.rs"]
mod tests;
