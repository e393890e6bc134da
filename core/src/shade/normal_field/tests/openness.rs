//! Tests that the openness of stepped shapes equals that of the surface that the steps approximate.

use super::*;

/// Returns the openness of the surface voxels of a grid that are `wanted`, from 0 to 1: the least and the greatest.
fn range(grid: &Grid, wanted: impl Fn(Vec3) -> bool) -> [f32; 2] {
    let field = NormalField::of(grid);
    let mut range = [f32::INFINITY, f32::NEG_INFINITY];
    for (v, _) in surface(grid, &field).into_iter().filter(|(v, _)| wanted(v.as_vec3() + 0.5)) {
        let record = field.record(v / 8, v % 8).unwrap();
        let open = f32::from(record.openness()) / 255.0;
        range = [range[0].min(open), range[1].max(open)];
    }
    range
}

/// No terrace darkens the next one: neither rings around the flats of a ball, nor stripes on slopes.
#[test]
fn steps_of_slopes_and_balls_are_as_open_as_faces() {
    let mut random = Random(6);
    for slope_deg in [0.0f32, 1.0, 2.0, 4.0, 8.0, 16.0, 30.0, 45.0, 54.7] {
        let towards = random.unit() * std::f32::consts::TAU;
        let (sin, cos) = slope_deg.to_radians().sin_cos();
        let out = Vec3::new(sin * towards.cos(), cos, sin * towards.sin());
        let at = Vec3::splat(32.0) + random.unit();
        let grid = grid_of(64, |p| (p - at).dot(out) <= 0.0);
        let inner = |p: Vec3| p.cmpge(Vec3::splat(14.0)).all() && p.cmple(Vec3::splat(50.0)).all();
        let [least, _] = range(&grid, inner);
        assert!(least >= 0.96, "{slope_deg} degrees: {least}");
    }
    for radius in [30.0f32, 70.0] {
        let edge = 2 * radius as u32 + 8;
        let centre = Vec3::splat(edge as f32 / 2.0) + random.unit();
        let grid = grid_of(edge, |p| p.distance(centre) <= radius);
        let [least, _] = range(&grid, |_| true);
        assert!(least >= 0.96, "ball of {radius}: {least}");
    }
}

/// The inside of a rotated vessel has no streaks: it is equally open all around.
#[test]
fn the_inside_of_a_tube_is_equally_open_all_around() {
    for (radius, wall) in [(30.0f32, 6.0f32), (60.0, 8.0)] {
        let edge = 2 * (radius + wall) as u32 + 8;
        let centre = Vec3::splat(edge as f32 / 2.0);
        let from_axis = |p: Vec3| (p - centre).with_y(0.0).length();
        let grid = grid_of(edge, |p| (radius..=radius + wall).contains(&from_axis(p)));
        let middle = 16.0..edge as f32 - 16.0;
        let inside = |p: Vec3| from_axis(p) < radius + 2.0 && middle.contains(&p.y);
        let [least, most] = range(&grid, inside);
        assert!(most - least <= 0.06, "radius {radius}: {least} to {most}");
    }
}
