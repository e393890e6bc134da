//! Intersects rows with a flat-faced solid at any pose, or with the volume that it sweeps in straight motion. Each face
//! that a row can cross determines one end, linear in the row's coordinates; a face along the row leaves it whole or
//! empty.

use std::ops::Range;

use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::{DMat3, DVec3};

use super::ends::{Bracket, Ends, Magnitudes, ROUNDING, ROUNDING_32, RowSolver, STEPS};

/// A face counts as parallel to a row if its distance changes along the whole row by less than this, in half extents. A
/// smaller limit would make ends that move too fast from row to row for `f32`.
const FLAT: f64 = 1e-4;

/// Larger than any voxel index.
const FAR: f64 = 1e30;

/// Greatest number of faces of a flat-faced solid and of its swept volume: a cuboid has six, and up to six of its edges
/// are silhouette edges that sweep a face each.
const MOST_FACES: usize = 12;

/// A half space of tool space: `normal . p <= distance`.
#[derive(Clone, Copy, Default, Debug)]
pub struct FaceHalfSpace {
    pub normal: DVec3,
    pub distance: f64,
}

impl FaceHalfSpace {
    /// Creates a half space with the normal `x`, `y`, `z`.
    pub const fn new(x: f64, y: f64, z: f64, distance: f64) -> FaceHalfSpace {
        FaceHalfSpace { normal: DVec3::new(x, y, z), distance }
    }
}

/// The half spaces whose intersection is a solid, or its swept volume.
#[derive(Clone, Copy, Debug)]
pub struct Faces {
    faces: [FaceHalfSpace; MOST_FACES],
    len: usize,
}

impl Faces {
    /// Returns the half spaces of the volume that a solid sweeps when it moves by `displacement`. A point is in it if
    /// at some time t from 0 to 1 it is in all half spaces of the solid moved by `t displacement`. Fourier-Motzkin
    /// elimination removes t: each lower bound of t is at most each upper bound.
    pub fn swept(solid: &[FaceHalfSpace], displacement: DVec3) -> Faces {
        let mut swept = Faces { faces: [FaceHalfSpace::default(); MOST_FACES], len: 0 };
        for face in solid {
            let distance = face.distance + face.normal.dot(displacement).max(0.0);
            swept.push(FaceHalfSpace { distance, ..*face });
        }
        for ahead in solid {
            for behind in solid {
                let (rise, fall) =
                    (ahead.normal.dot(displacement), -behind.normal.dot(displacement));
                if rise <= 0.0 || fall <= 0.0 {
                    continue;
                }
                // The face through their common edge along the displacement.
                let share = fall / (rise + fall);
                let normal = ahead.normal * share + behind.normal * (1.0 - share);
                let distance = ahead.distance * share + behind.distance * (1.0 - share);
                // Opposite faces have no common edge and add no bound.
                if ahead.normal != -behind.normal {
                    swept.push(FaceHalfSpace { normal, distance });
                }
            }
        }
        swept
    }

    fn push(&mut self, face: FaceHalfSpace) {
        self.faces[self.len] = face;
        self.len += 1;
    }
}

/// A number that is linear in the offset of a row from the centre, with its error.
#[derive(Clone, Copy, Debug, Default)]
struct Linear {
    constant: f64,
    y: f64,
    z: f64,
    error: f64,
}

impl Linear {
    #[inline(always)]
    fn at(&self, dy: f64, dz: f64) -> f64 {
        self.constant + self.z * dz + self.y * dy
    }
}

/// The effect of a face on the rows that it meets.
#[derive(Clone, Copy, PartialEq, Eq)]
enum RowBound {
    /// Bounds them from below: the number is the voxel index from which on they are inside.
    From,
    /// Bounds them from above: the number is the voxel index up to which they are inside.
    To,
    /// Is parallel to them: they are inside where the number is at most 0.
    Along,
}

/// A solid prepared for its rows.
#[derive(Clone, Copy, Debug)]
pub struct PlaneRows {
    centre: DVec3,
    /// The faces of [`RowBound::From`], then of [`RowBound::To`], then of [`RowBound::Along`].
    faces: [Linear; MOST_FACES],
    first_to: usize,
    first_along: usize,
    len: usize,
    /// Margins of the ends in voxels, and of the numbers of the parallel faces.
    margin: f32,
    margin_along: f32,
}

/// Planes in one row of bricks: the numbers of the faces at the first of eight rows, for each step along z.
#[derive(Clone, Copy, Debug)]
pub struct LocalPlanes {
    at: [[f32; MOST_FACES]; 8],
    /// The change of the numbers over the steps of eight rows along y.
    of_step: [[f32; 8]; MOST_FACES],
}

impl PlaneRows {
    pub fn new(
        solid: &Faces,
        tool_from_vx: &DMat3,
        centre_vx: DVec3,
        sizes: &Magnitudes,
    ) -> PlaneRows {
        let mut planes = PlaneRows {
            centre: centre_vx - 0.5,
            faces: [Linear::default(); MOST_FACES],
            first_to: 0,
            first_along: 0,
            len: 0,
            margin: 0.0,
            margin_along: 0.0,
        };
        for kind in [RowBound::From, RowBound::To, RowBound::Along] {
            match kind {
                RowBound::From => {}
                RowBound::To => planes.first_to = planes.len,
                RowBound::Along => planes.first_along = planes.len,
            }
            for FaceHalfSpace { normal, distance } in &solid.faces[..solid.len] {
                // The signed distance of a row's points from the face: slope . (dx, dy, dz) - distance.
                let slope = tool_from_vx.transpose() * *normal;
                let kind_of_face = match slope.x {
                    x if x.abs() * sizes.distance_vx.x <= FLAT => RowBound::Along,
                    x if x > 0.0 => RowBound::To,
                    _ => RowBound::From,
                };
                if kind_of_face == kind {
                    planes.push(kind, slope, *distance, sizes);
                }
            }
        }
        planes
    }

    fn push(&mut self, kind: RowBound, slope: DVec3, distance: f64, sizes: &Magnitudes) {
        let error = sizes.linear_error();
        let face = if kind == RowBound::Along {
            let face = Linear {
                constant: -distance,
                y: slope.y,
                z: slope.z,
                error: error + slope.x.abs() * sizes.distance_vx.x,
            };
            // Where the number of one row is near 0, those of its neighbours are no larger than the steps to them.
            let in_f32 = 4.0 * ROUNDING_32 * (1.0 + 8.0 * face.y.abs());
            self.margin_along = self.margin_along.max((face.error + in_f32) as f32);
            face
        } else {
            let face = Linear {
                constant: distance / slope.x + self.centre.x,
                y: -slope.y / slope.x,
                z: -slope.z / slope.x,
                error: 2.0 * error / slope.x.abs() + 32.0 * ROUNDING * sizes.coordinate_vx,
            };
            // Only ends among the requested voxels matter, and the first of eight rows is no further from those than
            // seven steps.
            let in_f32 = 4.0 * ROUNDING_32 * (sizes.width_vx + 16.0 * face.y.abs());
            self.margin = self.margin.max((face.error + in_f32) as f32);
            face
        };
        self.faces[self.len] = face;
        self.len += 1;
    }

    #[inline(always)]
    fn range(&self, kind: RowBound) -> Range<usize> {
        match kind {
            RowBound::From => 0..self.first_to,
            RowBound::To => self.first_to..self.first_along,
            RowBound::Along => self.first_along..self.len,
        }
    }

    fn faces(&self, kind: RowBound) -> &[Linear] {
        &self.faces[self.range(kind)]
    }

    /// Returns the numbers of a face at eight rows.
    #[inline(always)]
    fn number<S: Simd>(&self, simd: S, local: &LocalPlanes, step_z: usize, i: usize) -> f32x8<S> {
        f32x8::load_array_ref(simd, &local.of_step[i]) + local.at[step_z][i]
    }
}

impl RowSolver for PlaneRows {
    type Local = LocalPlanes;

    #[inline(always)]
    fn local(&self, origin: f64, y: f64, z: f64) -> Option<(LocalPlanes, f32)> {
        let (dy, dz) = (y - self.centre.y, z - self.centre.z);
        let mut local = LocalPlanes { at: [[0.0; MOST_FACES]; 8], of_step: [[0.0; 8]; MOST_FACES] };
        for (i, face) in self.faces[..self.len].iter().enumerate() {
            let origin = if i < self.first_along { origin } else { 0.0 };
            let first = face.at(dy, dz) - origin;
            for (step, at) in local.at.iter_mut().enumerate() {
                at[i] = (first + face.z * step as f64) as f32;
            }
            for (of_step, step) in local.of_step[i].iter_mut().zip(STEPS) {
                *of_step = step * face.y as f32;
            }
        }
        Some((local, self.margin))
    }

    #[inline(always)]
    fn ends<S: Simd>(&self, simd: S, local: &LocalPlanes, step_z: usize) -> Ends<S> {
        let far = f32x8::splat(simd, FAR as f32);
        let (mut from, mut to) = (-far, far);
        let mut doubtful = mask32x8::splat(simd, false);
        for i in self.range(RowBound::From) {
            from = from.max(self.number(simd, local, step_z, i));
        }
        for i in self.range(RowBound::To) {
            to = to.min(self.number(simd, local, step_z, i));
        }
        for i in self.range(RowBound::Along) {
            let beyond = self.number(simd, local, step_z, i);
            to = beyond.simd_gt(self.margin_along).select(-far, to);
            doubtful |= !beyond.abs().simd_gt(self.margin_along);
        }
        Ends { from, to, doubtful }
    }

    fn bracket(&self, y: f64, z: f64) -> Bracket {
        let (dy, dz) = (y - self.centre.y, z - self.centre.z);
        let mut bracket = Bracket { outer: [-FAR, FAR], inner: [-FAR, FAR] };
        for face in self.faces(RowBound::From) {
            let end = face.at(dy, dz);
            bracket.outer[0] = bracket.outer[0].max(end - face.error);
            bracket.inner[0] = bracket.inner[0].max(end + face.error);
        }
        for face in self.faces(RowBound::To) {
            let end = face.at(dy, dz);
            bracket.outer[1] = bracket.outer[1].min(end + face.error);
            bracket.inner[1] = bracket.inner[1].min(end - face.error);
        }
        for face in self.faces(RowBound::Along) {
            let beyond = face.at(dy, dz);
            if beyond > face.error {
                return Bracket::OUTSIDE;
            }
            if beyond >= -face.error {
                bracket.inner = Bracket::NONE;
            }
        }
        bracket
    }
}
