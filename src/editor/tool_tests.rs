//! Tests of the state of the tool.

use glam::UVec3;

use super::*;

#[test]
fn sizes_stay_in_range_and_in_proportion() {
    let mut tool = ToolState::new(&CanvasFrame::of(UVec3::splat(100)));
    assert_eq!((tool.half(), tool.centre_vx), (Vec3::splat(6.0), Vec3::splat(50.0)));
    tool.uniform = false;
    tool.set_half(1, 12.0);
    assert_eq!(tool.half(), Vec3::new(6.0, 12.0, 6.0));
    tool.uniform = true;
    tool.set_half(0, 3.0);
    assert_eq!(tool.half(), Vec3::new(3.0, 6.0, 3.0));
    tool.scale_by(1e-9);
    assert_eq!(tool.half().min_element(), *HALF_RANGE.start());
    tool.scale_by(1e9);
    assert_eq!(tool.half(), Vec3::new(1024.0, 2048.0, 1024.0));
    tool.scale_by(f32::NAN);
    assert_eq!(tool.half().max_element(), *HALF_RANGE.end());
}

#[test]
fn degrees_and_rotation_agree() {
    let mut tool = ToolState::new(&CanvasFrame::of(UVec3::splat(64)));
    tool.set_turn_deg(Vec3::new(20.0, -30.0, 40.0));
    let rotation = tool.rotation();
    tool.turn_by(Quat::IDENTITY);
    assert!(tool.turn_deg().abs_diff_eq(Vec3::new(20.0, -30.0, 40.0), 1e-3));
    let script = format!("subtract cuboid at=1,2,3 half=4 turn={},{},{}", 20, -30, 40);
    let Ok(Command::Construct { primitive, .. }) = script.parse() else { panic!() };
    assert!(primitive.rotation.abs_diff_eq(rotation, 1e-6));
    assert!(tool.primitive().check().is_ok());
}

#[test]
fn a_tool_stands_on_the_surface_and_leans_with_it() {
    let mut tool = ToolState::new(&CanvasFrame::of(UVec3::splat(100)));
    tool.solid = Solid::Pyramid;
    tool.uniform = false;
    tool.set_half(0, 3.0);
    tool.set_half(1, 5.0);
    tool.set_half(2, 4.0);
    tool.stand = true;
    let point = Vec3::new(10.0, 20.0, 30.0);
    tool.place_on(point, Vec3::Y, Vec3::ONE);
    assert!(tool.centre_vx.abs_diff_eq(point + Vec3::Y * 5.0, 1e-4));
    tool.place_on(point, Vec3::X, Vec3::ONE);
    assert!(tool.centre_vx.abs_diff_eq(point + Vec3::X * 3.0, 1e-4));
    // Voxels that are long along y: fewer of them.
    tool.place_on(point, Vec3::Y, Vec3::new(1.0, 2.0, 1.0));
    assert!(tool.centre_vx.abs_diff_eq(point + Vec3::Y * 2.5, 1e-4));
    tool.lean = true;
    tool.place_on(point, Vec3::NEG_X, Vec3::ONE);
    assert!((tool.rotation() * Vec3::Y).abs_diff_eq(Vec3::NEG_X, 1e-4));
    assert!(tool.centre_vx.abs_diff_eq(point - Vec3::X * 5.0, 1e-3));
    assert!(tool.primitive().check().is_ok());
}

#[test]
fn stretching_keeps_the_other_side() {
    let mut tool = ToolState::new(&CanvasFrame::of(UVec3::splat(100)));
    tool.stretch(Vec3::NEG_X, 1.0);
    assert_eq!((tool.half(), tool.centre_vx.x), (Vec3::new(6.5, 6.0, 6.0), 49.5));
    tool.stretch(Vec3::Z, -100.0);
    assert_eq!(tool.half().z, *HALF_RANGE.start());
}

#[test]
fn the_latest_colours_come_first_and_once() {
    let mut tool = ToolState::new(&CanvasFrame::of(UVec3::splat(10)));
    let first = tool.colour;
    tool.used_colour();
    (0..30).for_each(|i| {
        tool.colour = Rgb::new(i, 0, 0);
        tool.used_colour();
    });
    assert_eq!(tool.recent().len(), RECENT);
    assert!(!tool.recent().contains(&first));
    tool.colour = Rgb::new(20, 0, 0);
    tool.used_colour();
    assert_eq!(tool.recent()[..2], [Rgb::new(20, 0, 0), Rgb::new(29, 0, 0)]);
    assert_eq!(tool.recent().len(), RECENT);
}

#[test]
fn a_snapping_tool_sits_on_voxel_centres() {
    let mut tool = ToolState::new(&CanvasFrame::of(UVec3::splat(64)));
    tool.snap = true;
    tool.move_to(Vec3::new(1.2, 3.9, -0.1));
    assert_eq!(tool.centre_vx, Vec3::new(1.5, 3.5, -0.5));
    tool.move_to(Vec3::NAN);
    assert_eq!(tool.centre_vx, Vec3::new(1.5, 3.5, -0.5));
}
