//! The sum of squared distances from planes, as a quadratic form (Garland and Heckbert, "Surface simplification using
//! quadric error metrics", 1997). Pure; knows no mesh.

use glam::{DMat3, DVec3, Vec3};

/// Determinants below this share of the largest possible are treated as 0: then no single point is the best.
const LEAST_DETERMINANT: f64 = 1e-4;

/// `x A x + 2 b x + c`, summed over planes and weighted by area.
#[derive(Clone, Copy, Default, Debug)]
pub struct ErrorQuadric {
    /// The elements xx, xy, xz, yy, yz, zz.
    square: [f64; 6],
    linear: DVec3,
    constant: f64,
}

impl ErrorQuadric {
    /// Returns the quadric of the plane of a triangle, weighted by its area.
    pub(crate) fn of_triangle([a, b, c]: [Vec3; 3]) -> ErrorQuadric {
        let [a, b, c] = [a, b, c].map(|corner| corner.as_dvec3());
        let cross = (b - a).cross(c - a);
        let twice_area = cross.length();
        if twice_area <= 0.0 {
            return ErrorQuadric::default();
        }
        let (n, weight) = (cross / twice_area, 0.5 * twice_area);
        let distance = -n.dot(a);
        let square = [n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z];
        ErrorQuadric {
            square: square.map(|value| value * weight),
            linear: n * (distance * weight),
            constant: distance * distance * weight,
        }
    }

    /// Returns the sum of both.
    pub fn plus(&self, other: &ErrorQuadric) -> ErrorQuadric {
        let mut sum = *self;
        sum.square.iter_mut().zip(other.square).for_each(|(sum, value)| *sum += value);
        sum.linear += other.linear;
        sum.constant += other.constant;
        sum
    }

    /// Returns the area of all planes' triangles.
    pub fn area(&self) -> f64 {
        self.square[0] + self.square[3] + self.square[5]
    }

    fn matrix(&self) -> DMat3 {
        let [xx, xy, xz, yy, yz, zz] = self.square;
        DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
    }

    /// Returns the error of a point.
    pub fn error(&self, place: DVec3) -> f64 {
        let value = place.dot(self.matrix() * place + 2.0 * self.linear) + self.constant;
        value.max(0.0)
    }

    /// Returns the point with the least error, if there is one.
    pub fn best(&self) -> Option<DVec3> {
        let matrix = self.matrix();
        let determinant = matrix.determinant();
        let third = self.area() / 3.0;
        (determinant > LEAST_DETERMINANT * third * third * third)
            .then(|| matrix.inverse() * -self.linear)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_the_best_place_and_one_has_none() {
        let place = Vec3::new(4.0, 100.0, -3.0);
        let triangle = |u: Vec3, v: Vec3| ErrorQuadric::of_triangle([place, place + u, place + v]);
        let floor = triangle(Vec3::X, Vec3::Z * 2.0);
        assert!((floor.area() - 1.0).abs() < 1e-12);
        assert!(floor.best().is_none());
        let above = place.as_dvec3() + DVec3::new(5.0, 3.0, 1.0);
        assert!((floor.error(above) - 9.0).abs() < 1e-9);
        let sum = floor.plus(&triangle(Vec3::X, Vec3::Y)).plus(&triangle(Vec3::Y, Vec3::Z));
        assert!(sum.best().unwrap().distance(place.as_dvec3()) < 1e-9);
        assert!(sum.error(place.as_dvec3()) < 1e-9);
    }
}
