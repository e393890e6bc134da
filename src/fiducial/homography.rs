//! The projective map of a square: from the marker's plane to the picture.

use glam::{DMat3, DVec2, DVec3};

/// Returns the map from (-1, -1), (1, -1), (1, 1), (-1, 1) to `corners`; `None` if three of them are collinear. (P.
/// Heckbert: "Fundamentals of Texture Mapping and Image Warping", 1989.)
pub fn from_square(corners: &[DVec2; 4]) -> Option<DMat3> {
    let [a, b, c, d] = *corners;
    // First from the unit square.
    let (e, f, g) = (b - c, d - c, a - b + c - d);
    let det = e.perp_dot(f);
    let spread = (c - a).length_squared().max((d - b).length_squared());
    if det.is_nan() || det.abs() < 1e-9 * spread {
        return None;
    }
    let (p, q) = (g.perp_dot(f) / det, e.perp_dot(g) / det);
    let unit =
        DMat3::from_cols((b - a + p * b).extend(p), (d - a + q * d).extend(q), a.extend(1.0));
    let halve = DMat3::from_cols(
        DVec3::new(0.5, 0.0, 0.0),
        DVec3::new(0.0, 0.5, 0.0),
        DVec3::new(0.5, 0.5, 1.0),
    );
    let map = unit * halve;
    map.is_finite().then_some(map)
}

/// Returns the image of a point.
pub fn project(map: &DMat3, point: DVec2) -> DVec2 {
    let p = *map * point.extend(1.0);
    p.truncate() / p.z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_go_to_corners_and_lines_are_refused() {
        let corners = [
            DVec2::new(10.0, 12.0),
            DVec2::new(90.0, 5.0),
            DVec2::new(80.0, 60.0),
            DVec2::new(20.0, 70.0),
        ];
        let map = from_square(&corners).unwrap();
        let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        for (corner, (x, y)) in corners.into_iter().zip(square) {
            assert!(project(&map, DVec2::new(x, y)).distance(corner) < 1e-9);
        }
        // The diagonals cross in the image of the centre.
        let middle = project(&map, DVec2::ZERO);
        let along = (middle - corners[0]).perp_dot(corners[2] - corners[0]);
        assert!(along.abs() < 1e-6);
        let mut line = corners;
        line[2] = line[1] + 2.0 * (line[3] - line[1]);
        assert!(from_square(&line).is_none());
    }
}
