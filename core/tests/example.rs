//! Runs the example `carve` and checks its picture.

#[allow(dead_code, reason = "its `main` is the example's own")]
#[path = "../examples/carve.rs"]
mod carve;

use glam::UVec2;

#[test]
fn the_example_shows_a_frame_of_stone_around_a_red_ball() {
    let picture = carve::picture(UVec2::new(160, 120)).unwrap();
    let share = |wanted: fn([u8; 3]) -> bool| {
        let count = picture.pixels().filter(|p| wanted([p[0], p[1], p[2]])).count();
        count as f32 / (160.0 * 120.0)
    };
    let red = share(|[r, g, b]| i32::from(r) > 2 * i32::from(g) && i32::from(r) > 2 * i32::from(b));
    let background = share(|colour| colour == [230, 233, 238]);
    assert!((0.02..0.1).contains(&red), "{red}");
    assert!((0.3..0.8).contains(&background), "{background}");
    assert!(1.0 - red - background > 0.1, "the frame");
}
