//! Owns rows cut by a solid with flat faces at any pose: each face that a row can cross gives
//! one end of it, linear in the row's coordinates; a face along the row leaves it whole or empty.

use glam::{DMat3, DVec3};
use wide::f64x4;

use super::construct_ends::{Bracket, Ends, Magnitudes, ROUNDING, RowSolver};

/// A face along which a row moves by less than this, of the half extent, is along the row.
const FLAT: f64 = 1e-6;

/// No voxel index is as large.
const FAR: f64 = 1e300;

/// A half space of tool space: `normal . p <= distance`.
#[derive(Clone, Copy, Debug)]
pub struct HalfSpace {
    pub normal: DVec3,
    pub distance: f64,
}

/// A number that is linear in the distances of a row from the centre, with its error.
#[derive(Clone, Copy, Debug, Default)]
struct Linear {
    constant: f64,
    y: f64,
    z: f64,
    error: f64,
}

impl Linear {
    fn at(&self, dy: f64, dz: f64) -> f64 {
        self.constant + self.z * dz + self.y * dy
    }
}

/// At most as many as a solid has faces.
#[derive(Clone, Copy, Debug, Default)]
struct Faces {
    faces: [Linear; 6],
    len: usize,
}

impl Faces {
    fn push(&mut self, face: Linear) {
        self.faces[self.len] = face;
        self.len += 1;
    }

    fn iter(&self) -> impl Iterator<Item = &Linear> {
        self.faces[..self.len].iter()
    }
}

/// A solid of up to six faces prepared for its rows.
#[derive(Clone, Copy, Debug)]
pub struct Planes {
    centre: DVec3,
    /// Faces that end a row from below: the voxel index from which on it is inside.
    from: Faces,
    /// Faces that end a row from above: the voxel index up to which it is inside.
    to: Faces,
    /// Faces along the row: it is inside where the number is at or below 0.
    along: Faces,
    margin: f64,
}

impl Planes {
    pub fn new(
        half_spaces: &[HalfSpace],
        tool_from_vx: &DMat3,
        centre_vx: DVec3,
        sizes: &Magnitudes,
    ) -> Planes {
        let mut planes = Planes {
            centre: centre_vx - 0.5,
            from: Faces::default(),
            to: Faces::default(),
            along: Faces::default(),
            margin: 0.0,
        };
        for HalfSpace { normal, distance } in half_spaces {
            // distance of the row's points beyond the face: x * dx + y * dy + z * dz - distance
            let slope = tool_from_vx.transpose() * *normal;
            let error = sizes.linear_error();
            if slope.x.abs() * sizes.distance_vx.x <= FLAT {
                planes.along.push(Linear {
                    constant: -distance,
                    y: slope.y,
                    z: slope.z,
                    error: error + slope.x.abs() * sizes.distance_vx.x,
                });
                continue;
            }
            let face = Linear {
                constant: distance / slope.x + planes.centre.x,
                y: -slope.y / slope.x,
                z: -slope.z / slope.x,
                error: 2.0 * error / slope.x.abs() + 32.0 * ROUNDING * sizes.coordinate_vx,
            };
            planes.margin = planes.margin.max(face.error);
            if slope.x > 0.0 { planes.to.push(face) } else { planes.from.push(face) }
        }
        planes
    }
}

impl RowSolver for Planes {
    #[inline(always)]
    fn ends(&self, y: f64, z: f64) -> Ends {
        let dz = z - self.centre.z;
        let far = f64x4::splat(FAR);
        let mut ends = Ends { from: [-far; 2], to: [far; 2], doubtful: [f64x4::ZERO; 2] };
        let step = f64x4::new([0.0, 1.0, 2.0, 3.0]);
        let dy = [0.0, 4.0].map(|quad| f64x4::splat(y - self.centre.y + quad) + step);
        let at = |face: &Linear, quad: usize| {
            f64x4::splat(face.constant + face.z * dz) + f64x4::splat(face.y) * dy[quad]
        };
        for face in self.from.iter() {
            for quad in 0..2 {
                ends.from[quad] = ends.from[quad].fast_max(at(face, quad));
            }
        }
        for face in self.to.iter() {
            for quad in 0..2 {
                ends.to[quad] = ends.to[quad].fast_min(at(face, quad));
            }
        }
        for face in self.along.iter() {
            let error = f64x4::splat(face.error);
            for quad in 0..2 {
                let beyond = at(face, quad);
                let outside = beyond.simd_gt(error);
                ends.to[quad] = outside.bitselect(-far, ends.to[quad]);
                ends.doubtful[quad] |= !beyond.abs().simd_gt(error);
            }
        }
        ends
    }

    fn margin(&self) -> f64 {
        self.margin
    }

    fn bracket(&self, y: f64, z: f64) -> Bracket {
        let (dy, dz) = (y - self.centre.y, z - self.centre.z);
        let mut bracket = Bracket { outer: [-FAR, FAR], inner: [-FAR, FAR] };
        for face in self.from.iter() {
            let end = face.at(dy, dz);
            bracket.outer[0] = bracket.outer[0].max(end - face.error);
            bracket.inner[0] = bracket.inner[0].max(end + face.error);
        }
        for face in self.to.iter() {
            let end = face.at(dy, dz);
            bracket.outer[1] = bracket.outer[1].min(end + face.error);
            bracket.inner[1] = bracket.inner[1].min(end - face.error);
        }
        for face in self.along.iter() {
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
