//! Measures how long it takes to find a printed marker in a picture of 640 x 480 with clutter.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use virtual_sculpture::fiducial::{Grey, detect, family, poses};
use virtual_sculpture::video::Intrinsics;

/// A marker of 12 pixels a cell on paper, among chequers with noise.
fn picture() -> Grey {
    let mut state = 0x9e37_79b9_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 27) as u8
    };
    let pixels = (0..480i32)
        .flat_map(|y| (0..640i32).map(move |x| (x, y)))
        .map(|(x, y)| {
            let (cx, cy) = ((x - 260) as f32 / 12.0, (y - 190) as f32 / 12.0);
            let on_paper = (-1.0..9.0).contains(&cx) && (-1.0..9.0).contains(&cy);
            let printed = (0.0..8.0).contains(&cx) && (0.0..8.0).contains(&cy);
            let white = match (on_paper, printed) {
                (_, true) => family::is_white(0, cx as usize, cy as usize) == Some(true),
                (true, false) => true,
                (false, false) => (x / 24 + y / 24) % 2 == 0,
            };
            noise() + if white { 190 } else { 40 }
        })
        .collect();
    Grey { width: 640, height: 480, pixels }
}

fn marker(c: &mut Criterion) {
    let (grey, lens) = (picture(), Intrinsics::pinhole(640, 480, 0.8));
    let seen = detect(&grey, &lens);
    assert_eq!(seen.len(), 1, "the marker is found");
    c.bench_function("find in 640x480", |b| b.iter(|| detect(black_box(&grey), &lens)));
    c.bench_function("pose", |b| b.iter(|| poses(black_box(&seen[0].corners), 0.08, lens.fx)));
}

criterion_group!(benches, marker);
criterion_main!(benches);
