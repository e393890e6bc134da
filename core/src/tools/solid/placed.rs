//! The construction solids at any pose, and the volumes that they sweep in straight motion.
//!
//! From a pose in voxel coordinates to a [`Region`] of the voxels whose centres lie inside, or that the solid passes
//! over. [`PlacedSolid::contains_voxel`] is the definition; the rows of the region equal it on every voxel. Knows no
//! document.

use std::fmt::Display;
use std::ops::Range;

use fearless_simd::Simd;
use glam::{DMat3, DVec3, IVec3, Quat, UVec3, Vec3};

use super::ends::{Magnitudes, RowBlock, solve};
use super::kind::Solid;
use super::planes::{Faces, PlaneRows};
use super::quadric::EllipsoidRows;
use super::shape::SolidShape;
use super::spans::RowSpans;
use super::spec::RowMethod;
use super::swept::SweptQuadric;
use crate::refusal::InvalidValue;
use crate::sculpture::Brick;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::region::{BoxCoverage, Region, RowReach, VoxelBox};
use crate::tools::drawn::is_place;
use crate::tools::symmetry::SymmetryTransform;

/// A solid at a pose.
///
/// Lengths are in units of the smallest voxel edge, so that a ball is a ball in the world even where voxels are not
/// cubes; with cubic voxels the unit is a voxel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Primitive {
    /// Its kind.
    pub solid: Solid,
    /// Centre in voxel coordinates (the centre of voxel 0 is 0.5).
    pub centre_vx: Vec3,
    /// Half the extent along each axis of the tool, before rotation.
    pub half: Vec3,
    /// Rotation from the tool's axes to the grid's.
    pub rotation: Quat,
}

impl Primitive {
    /// Returns an error that names the first invalid field, if there is one.
    pub fn check(&self) -> Result<(), InvalidValue> {
        let Primitive { centre_vx, half, rotation, .. } = *self;
        let check = |is_valid, field, rule, value: &dyn Display| {
            InvalidValue::check(is_valid, field, rule, value).map_err(|error| error.of("solid"))
        };
        check(is_place(centre_vx), "centre", "must be within a million voxels", &centre_vx)?;
        let is_extent = half.is_finite() && half.min_element() > 0.0;
        check(is_extent, "half extent", "must be finite and above zero", &half)?;
        let is_rotation = rotation.is_finite() && rotation.is_normalized();
        check(is_rotation, "rotation", "must be a quaternion of length 1", &rotation)
    }

    /// Returns the region that this solid covers in a grid whose voxels have edges of `voxel_size`.
    pub fn in_grid(&self, voxel_size: Vec3) -> PlacedSolid {
        self.swept_in_grid(None, voxel_size)
    }

    /// Returns the region that this solid sweeps as its centre moves straight to `to_vx`, without rotation; without
    /// `to_vx`, that of the solid alone.
    pub fn swept_in_grid(&self, to_vx: Option<Vec3>, voxel_size: Vec3) -> PlacedSolid {
        PlacedSolid::new(self, to_vx, voxel_size, &SymmetryTransform::of_planes([None; 3]))
    }

    /// Returns the shape in tool space.
    pub fn shape(&self) -> SolidShape {
        SolidShape::new(self.solid, self.half.as_dvec3())
    }

    /// Returns the image of [`Primitive::swept_in_grid`]. Mirrored at axis-aligned planes that lie between voxels or
    /// pass through their centres, it covers exactly the mirrored voxels.
    pub fn image_in_grid(
        &self,
        to_vx: Option<Vec3>,
        voxel_size: Vec3,
        image: &SymmetryTransform,
    ) -> PlacedSolid {
        PlacedSolid::new(self, to_vx, voxel_size, image)
    }

    /// Returns the mirrored solid, for drawing.
    pub fn image(&self, image: &SymmetryTransform) -> Primitive {
        let rotation = image.rotation(self.rotation);
        Primitive { centre_vx: image.point(self.centre_vx), rotation, ..*self }
    }
}

/// Returns an error if the end of a sweep is not a valid position.
pub fn check_sweep_end(to_vx: Option<Vec3>) -> Result<(), InvalidValue> {
    match to_vx {
        Some(to) if !is_place(to) => {
            let rule = "must be within a million voxels";
            Err(InvalidValue::new("end of the sweep", rule, to).of("solid"))
        }
        _ => Ok(()),
    }
}

/// A solid in the voxel coordinates of one grid.
#[derive(Clone, Copy, Debug)]
pub struct PlacedSolid {
    pub(super) shape: SolidShape,
    /// Centre at the start.
    pub(super) centre_vx: DVec3,
    /// Linear part of the map from voxel coordinates (less the centre) to tool space.
    pub(super) tool_from_vx: DMat3,
    /// The displacement of a sweep, in tool space; `None` for a solid at rest.
    pub(super) displacement: Option<DVec3>,
    bounds: VoxelBox,
    /// The part of the bounds that a grid can contain.
    pub(super) reachable: VoxelBox,
    cut: SolidRows,
}

/// The method that computes rows.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "one for each use of a solid, never many at once")]
enum SolidRows {
    Quadric(EllipsoidRows),
    SweptQuadric(SweptQuadric),
    Planes(PlaneRows),
    /// An axis-aligned cuboid: a box of voxels.
    Box(VoxelBox),
    /// No rows: each brick is tested by itself.
    Bricks,
}

impl PlacedSolid {
    fn new(
        primitive: &Primitive,
        to_vx: Option<Vec3>,
        voxel_size: Vec3,
        image: &SymmetryTransform,
    ) -> PlacedSolid {
        let Primitive { centre_vx, half, rotation, .. } = *primitive;
        let shape = primitive.shape();
        let displacement_vx = to_vx.map(|to| to.as_dvec3() - centre_vx.as_dvec3());
        let displacement_vx = displacement_vx.filter(|displacement| *displacement != DVec3::ZERO);
        let (centre_vx, half) = (image.point_exactly(centre_vx.as_dvec3()), half.as_dvec3());
        let stretch = voxel_size.as_dvec3() / voxel_size.as_dvec3().min_element();
        let rotation = DMat3::from_quat(rotation.as_dquat().normalize());
        // Signs are changed after all rounding, so that an image is rounded like the solid.
        let (tool_from_world, world_from_tool) = (
            DMat3::from_diagonal(half.recip()) * rotation.transpose(),
            rotation * DMat3::from_diagonal(half),
        );
        let (stretched, shrunk) =
            (DMat3::from_diagonal(stretch), DMat3::from_diagonal(stretch.recip()));
        // An image of the solid moves along the image of the displacement, which in tool space is the same.
        let displacement =
            displacement_vx.map(|displacement| tool_from_world * stretched * displacement);
        let linear = image.linear();
        let (tool_from_vx, vx_from_tool) = match image.is_along_grid() {
            true => (tool_from_world * stretched * linear, linear * shrunk * world_from_tool),
            false => (
                tool_from_world * linear.transpose() * stretched,
                shrunk * linear * world_from_tool,
            ),
        };

        let axes = vx_from_tool.transpose();
        let support = |sign: f64| {
            let along = |axis: DVec3| {
                let reach = shape.support(axis * sign) * (1.0 + 1e-9) + 1.0;
                let Some(displacement) = displacement else { return reach };
                // Far from its start, a sweep is rounded like the large coordinates there.
                let rounding = 1e-12
                    * (centre_vx.abs().max_element()
                        + (axis.abs() * displacement.abs()).element_sum());
                reach + (axis.dot(displacement) * sign).max(0.0) + rounding
            };
            DVec3::new(along(axes.x_axis), along(axes.y_axis), along(axes.z_axis))
        };
        let limit = DVec3::splat(1e9);
        let bounds = VoxelBox {
            min: (centre_vx - support(-1.0)).clamp(-limit, limit).floor().as_ivec3(),
            max: (centre_vx + support(1.0)).clamp(-limit, limit).ceil().as_ivec3(),
        };
        let longest = IVec3::splat(MAX_AXIS_VX as i32);
        let reachable = bounds.intersect(VoxelBox { min: IVec3::ZERO, max: longest });

        let mut placed = PlacedSolid {
            shape,
            centre_vx,
            tool_from_vx,
            displacement,
            bounds,
            reachable,
            cut: SolidRows::Box(VoxelBox { min: IVec3::ZERO, max: IVec3::ZERO }),
        };
        if !reachable.is_empty() {
            placed.cut = placed.prepare();
        }
        placed
    }

    fn prepare(&self) -> SolidRows {
        let spec = self.shape.solid().spec();
        let m = self.tool_from_vx;
        let VoxelBox { min, max } = self.reachable;
        let off_axis = m - DMat3::from_diagonal(DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z));
        let along_grid = off_axis == DMat3::ZERO;
        if spec.fills_its_box && along_grid && self.displacement.is_none() {
            let axis = |axis: usize| {
                // A cuboid is its own mirror image, so an axis reversed by a mirror plane or a half turn makes no
                // difference.
                let scale = m.col(axis)[axis].abs();
                let place = |v: i32| scale * (f64::from(v) + 0.5 - self.centre_vx[axis]);
                // The position along the axis increases with the voxel, rounded or not.
                let first = first_where(min[axis]..max[axis], |v| place(v) >= -1.0);
                first..first_where(first..max[axis], |v| place(v) > 1.0)
            };
            let (x, y, z) = (axis(0), axis(1), axis(2));
            return SolidRows::Box(VoxelBox {
                min: IVec3::new(x.start, y.start, z.start),
                max: IVec3::new(x.end, y.end, z.end),
            });
        }
        // Queries are by whole bricks, so they reach up to 7 voxels beyond the box.
        let edge = f64::from(BRICK_EDGE_VX);
        let distance_vx = (min.as_dvec3() - edge - self.centre_vx)
            .abs()
            .max((max.as_dvec3() + edge - self.centre_vx).abs())
            .max(DVec3::ONE);
        let largest = |column: DVec3, distance: f64| column.abs().element_sum() * distance;
        let sizes = Magnitudes {
            distance_vx,
            width_vx: f64::from(max.x - min.x),
            coordinate_vx: f64::from(MAX_AXIS_VX) + self.centre_vx.abs().max_element(),
            position: largest(m.x_axis, distance_vx.x)
                + largest(m.y_axis, distance_vx.y)
                + largest(m.z_axis, distance_vx.z),
        };
        match spec.rows {
            RowMethod::Quadric => match self.displacement {
                None => SolidRows::Quadric(EllipsoidRows::new(&m, self.centre_vx, &sizes)),
                Some(displacement) => SolidRows::SweptQuadric(SweptQuadric::new(
                    &m,
                    self.centre_vx,
                    displacement,
                    &sizes,
                )),
            },
            RowMethod::Planes(half_spaces) => {
                let faces = Faces::swept(half_spaces, self.displacement.unwrap_or_default());
                SolidRows::Planes(PlaneRows::new(&faces, &m, self.centre_vx, &sizes))
            }
            RowMethod::Bricks => SolidRows::Bricks,
        }
    }

    /// Returns whether the centre of a voxel lies inside, or the solid passes over it: the definition that every row
    /// equals.
    #[inline(always)]
    pub fn contains_voxel(&self, v: IVec3) -> bool {
        let p = self.tool_from_vx * (v.as_dvec3() + 0.5 - self.centre_vx);
        match self.displacement {
            None => self.shape.contains(p),
            Some(displacement) => self.shape.passes(p, displacement, 0.0),
        }
    }

    /// Maps a point in voxel coordinates to tool space, where the solid at its start fills [-1, 1].
    pub fn tool_point(&self, p: Vec3) -> Vec3 {
        (self.tool_from_vx * (p.as_dvec3() - self.centre_vx)).as_vec3()
    }
}

/// Returns the first of `range` where `p` holds, or its end. `p` must hold from there on.
fn first_where(range: Range<i32>, p: impl Fn(i32) -> bool) -> i32 {
    let Range { mut start, mut end } = range;
    while start < end {
        let middle = start + (end - start) / 2;
        if p(middle) { end = middle } else { start = middle + 1 }
    }
    start
}

/// Sets `spans` to the part of a box of voxels in a row of bricks.
fn cut_box(inside: &VoxelBox, y_vx: u32, z_vx: u32, spans: &mut RowSpans) {
    let VoxelBox { min, max } = inside;
    for z in 0..8 {
        let within_z = (min.z..max.z).contains(&(z_vx as i32 + z));
        for y in 0..8 {
            let within = within_z && (min.y..max.y).contains(&(y_vx as i32 + y));
            spans.set_row(y as usize, z as usize, if within { min.x..max.x } else { 0..0 });
        }
    }
}

/// The part of a solid in a row of bricks.
#[derive(Clone, Debug, Default)]
pub struct SolidRow {
    spans: RowSpans,
    /// Set where the voxels of some row are not contiguous or may not be, and so do not fit into a span. Bricks of the
    /// row at this y, z are then tested one by one.
    torn: Option<[u32; 2]>,
}

impl SolidRow {
    /// Returns whether the voxels of some row are tested one by one.
    #[cfg(test)]
    pub(crate) fn is_torn(&self) -> bool {
        self.torn.is_some()
    }
}

impl Region for PlacedSolid {
    type Row = SolidRow;

    fn bounds_vx(&self) -> VoxelBox {
        self.bounds
    }

    #[inline(always)]
    fn cut_row<S: Simd>(&self, simd: S, y_vx: u32, z_vx: u32, row: &mut SolidRow) -> RowReach {
        let VoxelBox { min, max } = self.reachable;
        let rows = RowBlock { x: min.x..max.x, y: y_vx, z: z_vx };
        let spans = &mut row.spans;
        let exact = |v| self.contains_voxel(v);
        let connected = match &self.cut {
            SolidRows::Quadric(quadric) => solve(simd, quadric, &rows, exact, spans),
            SolidRows::SweptQuadric(swept) => solve(simd, swept, &rows, exact, spans),
            SolidRows::Planes(planes) => solve(simd, planes, &rows, exact, spans),
            SolidRows::Box(inside) => {
                cut_box(inside, y_vx, z_vx, spans);
                true
            }
            SolidRows::Bricks => false,
        };
        row.torn = (!connected).then_some([y_vx, z_vx]);
        if connected {
            return row.spans.reach(simd);
        }
        let all = min.x as u32 / BRICK_EDGE_VX..(max.x as u32).div_ceil(BRICK_EDGE_VX);
        let unknown = RowReach { touched: all, whole: 0..0 };
        self.reach_of_row(simd, y_vx, z_vx).unwrap_or(unknown)
    }

    #[inline(always)]
    fn mask<S: Simd>(&self, simd: S, row: &SolidRow, _: &RowReach, brick_x: u32) -> Brick {
        match row.torn {
            None => row.spans.mask(simd, brick_x),
            Some([y, z]) => self.test_brick(simd, UVec3::new(brick_x * BRICK_EDGE_VX, y, z)),
        }
    }

    fn coverage(&self, bounds: VoxelBox) -> BoxCoverage {
        match &self.cut {
            // Unless it is cut off at the border of the largest grid.
            SolidRows::Box(inside) if self.reachable == self.bounds => inside.coverage(bounds),
            _ => self.coverage_by_values(bounds),
        }
    }
}
