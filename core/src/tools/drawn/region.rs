//! The voxels of a [`DrawnSolid`] in a grid, as a [`Region`].
//!
//! [`PlacedDrawnSolid::contains_voxel`] is the definition: the distance of a voxel's centre from the surface, below 0 inside.
//! No point nearer than that is on the other side, so that bricks and their eighths far from the surface are decided as
//! a whole. Knows no document.

use fearless_simd::Simd;
use glam::{DQuat, DVec2, DVec3, DVec4, IVec3, UVec3, Vec3};

use super::curve::{Piece, pieces};
use super::drawn_solid::{DrawnSolid, Pose};
use super::outline::Outlines;
use crate::sculpture::Brick;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::grid::Grid;
use crate::sculpture::region::{Region, RowReach, VoxelBox};
use crate::tools::symmetry::SymmetryTransform;

/// A form, or an image of it, in the voxel coordinates of one grid.
#[derive(Clone, Debug)]
pub struct PlacedDrawnSolid {
    kind: Kind,
    /// Edges of a voxel in units of the smallest.
    stretch: DVec3,
    image: SymmetryTransform,
    bounds: VoxelBox,
    /// It ends, and by more than a voxel outside the grid.
    leaves_grid: bool,
    /// Bound on the error of distances.
    rounding: f64,
}

/// A form prepared for computing distances, in units of the smallest edge of a voxel.
#[derive(Clone, Debug)]
enum Kind {
    HalfSpace { at: DVec3, normal: DVec3 },
    Ring { frame: Frame, radius: f64, tube: f64 },
    Tube(Vec<Piece>),
    Lathe { frame: Frame, profile: Outlines },
    Extrusion { frame: Frame, outlines: Outlines, half_depth: f64 },
}

/// A pose.
#[derive(Clone, Copy, Debug)]
struct Frame {
    at: DVec3,
    rotation: DQuat,
}

impl Frame {
    fn new(pose: &Pose, stretch: DVec3) -> Frame {
        let Pose { at_vx, rotation } = pose;
        Frame { at: at_vx.as_dvec3() * stretch, rotation: rotation.as_dquat().normalize() }
    }

    /// A point, seen from the form.
    fn local(&self, p: DVec3) -> DVec3 {
        self.rotation.inverse() * (p - self.at)
    }

    /// Lowest and highest point of a box around the origin.
    fn bounds(&self, low: DVec3, high: DVec3) -> [DVec3; 2] {
        let middle = self.at + self.rotation * ((low + high) * 0.5);
        let half = (high - low) * 0.5;
        let reach = [DVec3::X, DVec3::Y, DVec3::Z]
            .map(|axis| (self.rotation * (axis * half)).abs())
            .into_iter()
            .sum::<DVec3>();
        [middle - reach, middle + reach]
    }
}

/// Distances from the axis and heights of a point about the y axis.
fn around_y(p: DVec3) -> DVec2 {
    DVec2::new(p.x.hypot(p.z), p.y)
}

impl PlacedDrawnSolid {
    /// An image of `form`, which must be valid. Covers exactly the mirrored voxels where all planes lie along the grid,
    /// between voxels or through their centres.
    pub fn new(form: &DrawnSolid, grid: &Grid, image: SymmetryTransform) -> PlacedDrawnSolid {
        let voxel_size = grid.voxel_size().as_dvec3();
        let stretch = voxel_size / voxel_size.min_element();
        let flat =
            |points: &[glam::Vec2]| -> Vec<DVec2> { points.iter().map(|p| p.as_dvec2()).collect() };
        let everywhere = [DVec3::NEG_INFINITY, DVec3::INFINITY];
        let (kind, [low, high]) = match form {
            DrawnSolid::HalfSpace { at_vx, normal } => {
                let at = at_vx.as_dvec3() * stretch;
                (Kind::HalfSpace { at, normal: normal.as_dvec3().normalize() }, everywhere)
            }
            DrawnSolid::Ring { pose, radius, tube } => {
                let (frame, radius, tube) =
                    (Frame::new(pose, stretch), f64::from(*radius), f64::from(*tube));
                let out = DVec3::new(radius + tube, tube, radius + tube);
                (Kind::Ring { frame, radius, tube }, frame.bounds(-out, out))
            }
            DrawnSolid::Tube { control_points } => {
                let ball = |at: Vec3, radius: f32| -> DVec4 {
                    (at.as_dvec3() * stretch).extend(f64::from(radius))
                };
                let balls: Vec<_> =
                    control_points.iter().map(|b| ball(b.at_vx, b.radius)).collect();
                let pieces = pieces(&balls);
                let bounds = pieces.iter().map(Piece::bounds);
                let bounds = bounds.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
                (Kind::Tube(pieces), bounds.unwrap_or(everywhere))
            }
            DrawnSolid::Lathe { pose, profile } => {
                let (frame, points) = (Frame::new(pose, stretch), flat(profile));
                let mut outline = Outlines::default();
                outline.join(&points);
                if let [first, .., last] = points[..] {
                    outline.join(&[DVec2::new(0.0, first.y), first]);
                    outline.join(&[last, DVec2::new(0.0, last.y)]);
                }
                let [low, high] = outline.bounds();
                let bounds = frame.bounds(
                    DVec3::new(-high.x, low.y, -high.x),
                    DVec3::new(high.x, high.y, high.x),
                );
                (Kind::Lathe { frame, profile: outline }, bounds)
            }
            DrawnSolid::Extrusion { pose, outlines, depth } => {
                let (frame, half_depth) = (Frame::new(pose, stretch), f64::from(*depth) * 0.5);
                let mut all = Outlines::default();
                outlines.iter().for_each(|outline| all.close(&flat(outline)));
                let [low, high] = all.bounds();
                let bounds = frame.bounds(low.extend(-half_depth), high.extend(half_depth));
                (Kind::Extrusion { frame, outlines: all, half_depth }, bounds)
            }
        };
        let mut form = PlacedDrawnSolid {
            kind,
            stretch,
            image,
            bounds: VoxelBox { min: IVec3::ZERO, max: IVec3::ZERO },
            leaves_grid: false,
            rounding: 0.0,
        };
        let dims = grid.dims().as_dvec3();
        let (low, high) = match low.is_finite() && high.is_finite() {
            true => {
                let [low, high] =
                    around([low / stretch, high / stretch], |p| image.point_exactly(p));
                ((low - 1.0).floor(), (high + 1.0).ceil())
            }
            false => (DVec3::ZERO, dims),
        };
        // The bounds have a voxel to spare.
        form.leaves_grid = low.cmplt(DVec3::splat(-2.0)).any() || high.cmpgt(dims + 2.0).any();
        form.bounds = VoxelBox {
            min: low.clamp(DVec3::ZERO, dims).as_ivec3(),
            max: high.clamp(DVec3::ZERO, dims).as_ivec3(),
        };
        // Lengths are those of the grid and of the form, which may be far away.
        let longest = (dims * stretch).length() + form.anchor();
        form.rounding = 1e-13 * longest;
        form
    }

    /// Whether it ends, and by more than a voxel outside the grid.
    pub fn leaves_grid(&self) -> bool {
        self.leaves_grid
    }

    /// As long as the longest number that distances are made of.
    fn anchor(&self) -> f64 {
        match &self.kind {
            Kind::HalfSpace { at, .. } => at.length(),
            Kind::Ring { frame, radius, tube } => frame.at.length() + radius + tube,
            Kind::Tube(pieces) => {
                let furthest = |piece: &Piece| piece.bounds().map(DVec3::length);
                pieces.iter().flat_map(furthest).fold(0.0, f64::max)
            }
            Kind::Lathe { frame, profile: outlines } => {
                let [low, high] = outlines.bounds();
                frame.at.length() + low.length() + high.length()
            }
            Kind::Extrusion { frame, outlines, half_depth } => {
                let [low, high] = outlines.bounds();
                frame.at.length() + low.length() + high.length() + half_depth
            }
        }
    }

    /// The distance of a point (voxel coordinates) from the surface, below 0 inside. Of a tube: from those of its pieces
    /// that are named.
    fn distance(&self, p_vx: DVec3, near: &[u32]) -> f64 {
        let p = self.image.origin_of(p_vx) * self.stretch;
        match &self.kind {
            Kind::HalfSpace { at, normal } => (*at - p).dot(*normal),
            Kind::Ring { frame, radius, tube } => {
                let p = around_y(frame.local(p));
                (p.x - radius).hypot(p.y) - tube
            }
            Kind::Tube(pieces) => {
                near.iter().map(|i| pieces[*i as usize].distance(p)).fold(f64::INFINITY, f64::min)
            }
            Kind::Lathe { frame, profile } => profile.distance(around_y(frame.local(p))),
            Kind::Extrusion { frame, outlines, half_depth } => {
                let p = frame.local(p);
                outlines.distance(p.truncate()).max(p.z.abs() - half_depth)
            }
        }
    }

    /// Whether the centre of a voxel lies inside: the definition that every row equals.
    pub fn contains_voxel(&self, v: IVec3) -> bool {
        let all: Vec<u32> = match &self.kind {
            Kind::Tube(pieces) => (0..pieces.len() as u32).collect(),
            _ => Vec::new(),
        };
        self.distance(v.as_dvec3() + 0.5, &all) <= 0.0
    }

    /// The pieces of a tube that reach a box of voxels; none of other forms.
    fn near(&self, min: UVec3, max: UVec3) -> Vec<u32> {
        let Kind::Tube(pieces) = &self.kind else { return Vec::new() };
        let corners = [min, max].map(|corner| corner.as_dvec3());
        let [min, max] = around(corners, |p| self.image.origin_of(p) * self.stretch);
        let reaches = |piece: &Piece| {
            let [low, high] = piece.bounds();
            low.cmple(max + self.rounding).all() && high.cmpge(min - self.rounding).all()
        };
        (0..).zip(pieces).filter(|(_, piece)| reaches(piece)).map(|(i, _)| i).collect()
    }

    /// Whether all or none of the voxels of a cube are inside; None where it may be a part.
    fn covers(&self, min: UVec3, edge: u32, near: &[u32]) -> Option<bool> {
        let distance = self.distance(min.as_dvec3() + 0.5 * f64::from(edge), near);
        if edge == 1 {
            return Some(distance <= 0.0);
        }
        let reach = 0.5 * f64::from(edge - 1) * self.stretch.length() + self.rounding;
        match distance.abs() > reach {
            true => Some(distance < 0.0),
            false => None,
        }
    }

    /// Sets the voxels inside of a cube of the brick at `origin`, by eighths where it is not decided as a whole.
    fn test_cube(&self, origin: UVec3, local: UVec3, edge: u32, near: &[u32], mask: &mut Brick) {
        match self.covers(origin + local, edge, near) {
            Some(false) => {}
            Some(true) => {
                for z in local.z..local.z + edge {
                    for y in local.y..local.y + edge {
                        for x in local.x..local.x + edge {
                            mask.set(x, y, z, true);
                        }
                    }
                }
            }
            None => {
                let half = edge / 2;
                for eighth in 0..8u32 {
                    let corner = UVec3::new(eighth & 1, eighth >> 1 & 1, eighth >> 2);
                    self.test_cube(origin, local + corner * half, half, near, mask);
                }
            }
        }
    }
}

/// A box around the images of the corners of a box, which has a lowest and a highest one.
fn around([low, high]: [DVec3; 2], image: impl Fn(DVec3) -> DVec3) -> [DVec3; 2] {
    let corner =
        |i: u32| DVec3::select(glam::BVec3::new(i & 1 == 0, i & 2 == 0, i & 4 == 0), low, high);
    let images = (0..8).map(|i| image(corner(i)));
    images.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
}

/// The part of a form in a row of bricks.
#[derive(Clone, Debug, Default)]
pub struct FormRow {
    y_vx: u32,
    z_vx: u32,
    /// The pieces of a tube that reach the row.
    near: Vec<u32>,
}

impl Region for PlacedDrawnSolid {
    type Row = FormRow;

    fn bounds_vx(&self) -> VoxelBox {
        self.bounds
    }

    fn cut_row<S: Simd>(&self, _: S, y_vx: u32, z_vx: u32, row: &mut FormRow) -> RowReach {
        let edge = BRICK_EDGE_VX;
        let (from, to) =
            (self.bounds.min.x as u32 / edge, (self.bounds.max.x as u32).div_ceil(edge));
        let (low, high) =
            (UVec3::new(from * edge, y_vx, z_vx), UVec3::new(to * edge, y_vx + edge, z_vx + edge));
        *row = FormRow { y_vx, z_vx, near: self.near(low, high) };
        let mut reach = RowReach::NONE;
        let mut run = from..from;
        for x in from..to {
            let covered = self.covers(UVec3::new(x * edge, y_vx, z_vx), edge, &row.near);
            if covered != Some(false) {
                let first = if reach.touched.is_empty() { x } else { reach.touched.start };
                reach.touched = first..x + 1;
            }
            // The longest run of whole bricks is known as such.
            run = if covered == Some(true) { run.start..x + 1 } else { x + 1..x + 1 };
            if run.len() > reach.whole.len() {
                reach.whole = run.clone();
            }
        }
        reach
    }

    fn mask<S: Simd>(&self, _: S, row: &FormRow, _: &RowReach, brick_x: u32) -> Brick {
        let origin = UVec3::new(brick_x * BRICK_EDGE_VX, row.y_vx, row.z_vx);
        let mut mask = Brick::EMPTY;
        self.test_cube(origin, UVec3::ZERO, BRICK_EDGE_VX, &row.near, &mut mask);
        mask
    }
}
