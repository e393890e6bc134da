//! The voxels of a [`DrawnSolid`] in a grid, as a [`Region`].
//!
//! [`PlacedDrawnSolid::contains_voxel`] is the definition: the distance of a voxel's centre from the surface, below 0
//! inside. No nearer point is on the other side, so that bricks and their eighths far from the surface are decided as a
//! whole.

use fearless_simd::Simd;
use glam::{DVec3, IVec3, UVec3, Vec3};

use super::plane_rows::{LinearDistance, PlaneRow};
use super::spec::Surface;
use super::{DrawnSolid, DrawnSurface, FURTHEST_VX};
use crate::sculpture::Brick;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::grid::Grid;
use crate::sculpture::region::{BoxCoverage, Region, RowReach, VoxelBox};
use crate::tools::parallelepiped::Parallelepiped;
use crate::tools::solid::spans::RowSpans;
use crate::tools::symmetry::SymmetryTransform;

/// A drawn solid, or an image of it, in the voxel coordinates of one grid.
#[derive(Clone, Debug)]
pub struct PlacedDrawnSolid {
    surface: DrawnSurface,
    /// Edges of a voxel in units of the smallest.
    stretch: DVec3,
    image: SymmetryTransform,
    bounds: VoxelBox,
    /// Whether it ends, and extends more than a voxel beyond the grid.
    leaves_grid: bool,
    /// Bound on the error of distances.
    rounding: f64,
    /// The distances from its surface, if that is a plane.
    plane: Option<LinearDistance>,
}

impl PlacedDrawnSolid {
    /// Returns a box around an image of `solid`, which must be valid, in voxels of these edges. `None` if it does not
    /// end.
    pub fn bounds_of(
        solid: &DrawnSolid,
        voxel_size: Vec3,
        image: SymmetryTransform,
    ) -> Option<VoxelBox> {
        let voxel_size = voxel_size.as_dvec3();
        let stretch = voxel_size / voxel_size.min_element();
        let [low, high] = solid.surface(stretch).bounds();
        if !low.is_finite() || !high.is_finite() {
            return None;
        }
        let ends = [low / stretch, high / stretch];
        let [low, high] = around(ends, |p| image.point_exactly(p));
        Some(VoxelBox { min: (low - 1.0).floor().as_ivec3(), max: (high + 1.0).ceil().as_ivec3() })
    }

    /// Creates an image of `solid`, which must be valid. Covers exactly the mirrored voxels if all mirror planes lie
    /// along the grid, between voxels or through their centres.
    pub fn new(solid: &DrawnSolid, grid: &Grid, image: SymmetryTransform) -> PlacedDrawnSolid {
        let voxel_size = grid.voxel_size().as_dvec3();
        let stretch = voxel_size / voxel_size.min_element();
        let surface = solid.surface(stretch);
        let [low, high] = surface.bounds();
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
        let leaves_grid = low.cmplt(DVec3::splat(-2.0)).any() || high.cmpgt(dims + 2.0).any();
        let bounds = VoxelBox {
            min: low.clamp(DVec3::ZERO, dims).as_ivec3(),
            max: high.clamp(DVec3::ZERO, dims).as_ivec3(),
        };
        // Both the size of the grid and the solid, which may be far away, determine the rounding error.
        let longest = (dims * stretch).length() + surface.longest();
        let rounding = 1e-13 * longest;
        let mut placed = PlacedDrawnSolid {
            surface,
            stretch,
            image,
            bounds,
            leaves_grid,
            rounding,
            plane: None,
        };
        if placed.surface.is_plane() {
            let (size, error) = (grid.dims().as_ivec3(), placed.margin((dims * stretch).length()));
            placed.plane = Some(LinearDistance::new(|p| placed.distance(p, &[]), size, error));
        }
        placed
    }

    /// Returns whether it ends, and extends more than a voxel beyond the grid.
    pub fn leaves_grid(&self) -> bool {
        self.leaves_grid
    }

    /// Returns a bound on the error of distances of points up to so far away, with much to spare.
    fn margin(&self, furthest: f64) -> f64 {
        // The planes and axes of an image may be as far away as a solid.
        let largest = 4.0 * f64::from(FURTHEST_VX) * self.stretch.max_element() + furthest;
        1e3 * self.rounding + 1e-10 * largest
    }

    /// Returns the distance of a point (voxel coordinates) from the surface, below 0 inside. For a solid in pieces:
    /// from the pieces in `near`.
    fn distance(&self, p_vx: DVec3, near: &[u32]) -> f64 {
        self.surface.distance(self.image.origin_of(p_vx) * self.stretch, near)
    }

    /// Returns whether the centre of a voxel lies inside: the definition that every row matches.
    pub fn contains_voxel(&self, v: IVec3) -> bool {
        let all = self.surface.pieces_near(DVec3::NEG_INFINITY, DVec3::INFINITY);
        self.distance(v.as_dvec3() + 0.5, &all) <= 0.0
    }

    /// Returns the pieces that reach a box of voxels; none for a solid in one piece.
    fn near(&self, min: UVec3, max: UVec3) -> Vec<u32> {
        let corners = [min, max].map(|corner| corner.as_dvec3());
        let [min, max] = around(corners, |p| self.image.origin_of(p) * self.stretch);
        self.surface.pieces_near(min - self.rounding, max + self.rounding)
    }

    /// Returns whether all or none of the voxels of a cube are inside; `None` if it may be a part of them.
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

    /// Sets the voxels inside, of a cube of the brick at `origin`. A cube that is not decided as a whole is divided
    /// into eighths.
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

/// Returns a box around the images of the corners of a box, each given by its lowest and highest point.
fn around([low, high]: [DVec3; 2], image: impl Fn(DVec3) -> DVec3) -> [DVec3; 2] {
    let corner =
        |i: u32| DVec3::select(glam::BVec3::new(i & 1 == 0, i & 2 == 0, i & 4 == 0), low, high);
    let images = (0..8).map(|i| image(corner(i)));
    images.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
}

/// The part of a drawn solid in a row of bricks.
#[derive(Clone, Debug, Default)]
pub struct DrawnRow {
    y_vx: u32,
    z_vx: u32,
    /// The pieces that reach the row.
    near: Vec<u32>,
    /// The voxels of the row, if the surface is a plane; otherwise unknown.
    spans: RowSpans,
    has_spans: bool,
}

impl Region for PlacedDrawnSolid {
    type Row = DrawnRow;

    fn bounds_vx(&self) -> VoxelBox {
        self.bounds
    }

    #[inline(always)]
    fn cut_row<S: Simd>(&self, simd: S, y_vx: u32, z_vx: u32, row: &mut DrawnRow) -> RowReach {
        let edge = BRICK_EDGE_VX;
        let (from, to) =
            (self.bounds.min.x as u32 / edge, (self.bounds.max.x as u32).div_ceil(edge));
        if let Some(plane) = &self.plane {
            let (low, end) = (IVec3::new(0, y_vx as i32, z_vx as i32), (to * edge) as i32);
            let is_covered = |v| self.contains_voxel(v);
            (row.y_vx, row.z_vx, row.has_spans) = (y_vx, z_vx, true);
            match plane.cut_row(simd, low, end, &mut row.spans, &is_covered) {
                PlaneRow::Uniform(false) => return RowReach::NONE,
                PlaneRow::Uniform(true) => return RowReach { touched: from..to, whole: from..to },
                PlaneRow::Spans(reach) => return reach,
                PlaneRow::Unknown => {}
            }
        }
        let (low, high) =
            (UVec3::new(from * edge, y_vx, z_vx), UVec3::new(to * edge, y_vx + edge, z_vx + edge));
        *row = DrawnRow { y_vx, z_vx, near: self.near(low, high), ..DrawnRow::default() };
        let mut reach = RowReach::NONE;
        let mut run = from..from;
        for x in from..to {
            let covered = self.covers(UVec3::new(x * edge, y_vx, z_vx), edge, &row.near);
            if covered != Some(false) {
                let first = if reach.touched.is_empty() { x } else { reach.touched.start };
                reach.touched = first..x + 1;
            }
            // The longest run of whole bricks is reported as such.
            run = if covered == Some(true) { run.start..x + 1 } else { x + 1..x + 1 };
            if run.len() > reach.whole.len() {
                reach.whole = run.clone();
            }
        }
        reach
    }

    #[inline(always)]
    fn mask<S: Simd>(&self, simd: S, row: &DrawnRow, _: &RowReach, brick_x: u32) -> Brick {
        if row.has_spans {
            return row.spans.mask(simd, brick_x);
        }
        let origin = UVec3::new(brick_x * BRICK_EDGE_VX, row.y_vx, row.z_vx);
        let mut mask = Brick::EMPTY;
        self.test_cube(origin, UVec3::ZERO, BRICK_EDGE_VX, &row.near, &mut mask);
        mask
    }

    fn coverage(&self, bounds: VoxelBox) -> BoxCoverage {
        if let Some(coverage) = self.plane.and_then(|plane| plane.coverage(bounds)) {
            return coverage;
        }
        let map = |p: DVec3| self.image.origin_of(p) * self.stretch;
        let Some(points) = Parallelepiped::of_voxels(bounds, map) else {
            return BoxCoverage::None;
        };
        // The box may be larger than the grid.
        let margin = self.margin(points.middle.length() + points.radius());
        self.surface.coverage(&points, margin)
    }
}
