//! The marker under the pointer: it stays in the plane that it was taken in, wherever the pointer goes.

use egui::{Event, Modifiers, PointerButton, Pos2, pos2, vec2};
use glam::{IVec3, Vec3};
use virtual_sculpture::input::{Action, Side};
use virtual_sculpture::sculpture::region::VoxelBox;

use super::bench::{Bench, bench_of, config, drag, look, run, screen, send, voxels};

const EDGE: u32 = 64;

fn marker(harness: &Bench) -> VoxelBox {
    harness.state().session().document().selection().marker()
}

fn act(harness: &mut Bench, action: Action) {
    harness.state_mut().act(action);
    harness.run_steps(2);
    look(harness);
}

fn button(harness: &mut Bench, pos: Pos2, pressed: bool) {
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    send(harness, Event::PointerButton { pos, button, pressed, modifiers });
}

/// Where the ray under the pointer meets the plane of a face; none behind the eye.
fn met(harness: &Bench, pos: Pos2, axis: usize, plane: f32) -> Option<Vec3> {
    let bench = harness.state();
    let rays = bench.eye().pixel_rays(&bench.world_from_grid());
    let at = pos - bench.picture().min;
    let direction = rays.direction_at(at.x, at.y);
    let t = (plane - rays.origin[axis]) / direction[axis];
    (t > 0.0 && t.is_finite()).then(|| rays.origin + direction * t)
}

/// Takes the marker in the middle of its face across `axis` and leads it along a way all over the picture, the sculpture
/// and the void, to and fro. False if the eye does not see the face.
fn leads_in_plane(harness: &mut Bench, axis: usize, up: bool, seed: u32) -> bool {
    let start = marker(harness);
    let mut middle = (start.min + start.max).as_vec3() * 0.5;
    let plane = if up { start.max[axis] } else { start.min[axis] } as f32;
    middle[axis] = plane;
    let normal = Vec3::AXES[axis] * if up { 1.0 } else { -1.0 };
    let taken = screen(harness, middle);
    let picture = harness.state().picture().shrink(2.0);
    let eye = {
        let bench = harness.state();
        bench.eye().pixel_rays(&bench.world_from_grid()).origin
    };
    if (eye - middle).dot(normal) <= 1.0 || !picture.contains(taken) {
        return false;
    }
    send(harness, Event::PointerMoved(taken));
    look(harness);
    button(harness, taken, true);
    if marker(harness) != start {
        // The sculpture hides this face: a box is spanned over its surface instead.
        assert!(voxels(harness) > 0, "the void hides nothing");
        button(harness, taken, false);
        run(
            harness,
            &format!("mark at={} size={}", words(start.min), words(start.max - start.min)),
        );
        return false;
    }
    let guide = harness.state().editor.marker_guide();
    assert!(!guide.is_empty(), "the plane is shown");
    assert!(guide.iter().flatten().all(|end| end[axis] == plane), "{guide:?}");
    let mut random = seed;
    for _ in 0..24 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (x, y) = ((random >> 8 & 0xfff) as f32 / 4095.0, (random >> 20) as f32 / 4095.0);
        let to = pos2(picture.left() + x * picture.width(), picture.top() + y * picture.height());
        send(harness, Event::PointerMoved(to));
        look(harness);
        let now = marker(harness);
        assert_eq!(now.size(), start.size(), "it is not deformed");
        assert_eq!(now.min[axis], start.min[axis], "it stays in its plane at {to:?}");
        let edge = EDGE as f32;
        let Some(point) = met(harness, to, axis, plane) else { continue };
        let by = (now.min - start.min).as_vec3();
        let wanted = point - met(harness, taken, axis, plane).unwrap();
        for other in (0..3).filter(|other| *other != axis) {
            let is_near = (-edge..=2.0 * edge).contains(&(start.min[other] as f32 + wanted[other]))
                && (-edge..=2.0 * edge).contains(&(start.max[other] as f32 + wanted[other]));
            let off = (by[other] - wanted[other]).abs();
            assert!(!is_near || off <= 0.51, "{off} voxels off the pointer at {to:?}");
        }
    }
    // Back where it was taken it is where it was.
    send(harness, Event::PointerMoved(taken));
    assert_eq!(marker(harness), start);
    button(harness, taken, false);
    assert!(harness.state().editor.marker_guide().is_empty());
    true
}

fn words(v: IVec3) -> String {
    format!("{},{},{}", v.x, v.y, v.z)
}

#[test]
fn a_marker_stays_in_the_plane_that_it_was_taken_in() {
    let mut taken = [0; 3];
    for (is_full, ground) in [(true, false), (true, true), (false, true)] {
        let mut harness = bench_of(&config(EDGE), vec2(1280.0, 800.0));
        harness.state_mut().ui.view.ground = ground;
        if !is_full {
            run(&mut harness, "clear");
        }
        act(&mut harness, Action::Marker);
        for (i, side) in [Side::Corner, Side::Front, Side::Top, Side::Left].into_iter().enumerate()
        {
            act(&mut harness, Action::LookFrom(side));
            for (at, size) in [
                ([16, 40, 16], [20, 24, 20]),
                ([40, 64, 30], [9, 5, 12]),
                ([-20, 0, 50], [30, 10, 30]),
                ([0, 0, 0], [64, 64, 64]),
            ] {
                let (at, size) = (IVec3::from(at), IVec3::from(size));
                run(&mut harness, &format!("mark at={} size={}", words(at), words(size)));
                harness.run_steps(1);
                for (axis, taken) in taken.iter_mut().enumerate() {
                    for up in [false, true] {
                        let seed = (i * 7 + axis) as u32 * 2 + u32::from(up) + 1;
                        *taken += u32::from(leads_in_plane(&mut harness, axis, up, seed));
                    }
                }
            }
        }
    }
    assert!(taken.iter().all(|count| *count > 5), "{taken:?}");
}

#[test]
fn a_pointer_almost_along_the_plane_leads_the_marker_no_farther_than_the_grid_is_long() {
    let mut harness = bench_of(&config(EDGE), vec2(1280.0, 800.0));
    run(&mut harness, "clear");
    act(&mut harness, Action::Marker);
    act(&mut harness, Action::LookFrom(Side::Front));
    // Seen from in front and a little above, so that the horizon of the upper face is in the picture.
    let beside = harness.state().picture().min + vec2(60.0, 200.0);
    let path = [beside, beside + vec2(0.0, 25.0)];
    drag(&mut harness, PointerButton::Secondary, Modifiers::NONE, &path);
    run(&mut harness, "mark at=24,20,24 size=16,4,16");
    let taken = screen(&harness, Vec3::new(32.0, 24.0, 32.0));
    send(&mut harness, Event::PointerMoved(taken));
    button(&mut harness, taken, true);
    let picture = harness.state().picture();
    let mut farthest = 0;
    for step in 0..400 {
        let y = taken.y + (picture.top() + 1.0 - taken.y) * step as f32 / 399.0;
        send(&mut harness, Event::PointerMoved(pos2(taken.x, y)));
        let now = marker(&harness);
        assert_eq!(now.min.y, 20);
        farthest = farthest.max(now.min.abs().max_element());
    }
    button(&mut harness, taken, false);
    assert!(farthest <= 2 * EDGE as i32 + 20, "{farthest}");
    assert!(harness.state().ui.toasts.texts().next().is_none(), "nothing to complain of");
}
