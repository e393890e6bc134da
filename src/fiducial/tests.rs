//! Tests detection on markers drawn like camera pictures.

use glam::{DQuat, DVec2, DVec3};

use super::*;
use crate::video::Intrinsics;

const SIZE_M: f64 = 0.08;

/// A picture of a marker, with its true pose.
struct Snapshot {
    lens: Intrinsics,
    truth: MarkerPose,
    blur: bool,
    /// Standard deviation of the noise, of 255.
    noise: f64,
    /// Brightness of ink and paper.
    ink: [f64; 2],
}

fn lens() -> Intrinsics {
    Intrinsics::pinhole(640, 480, 48f64.to_radians())
}

fn wide_lens() -> Intrinsics {
    Intrinsics { k1: -0.28, k2: 0.09, p1: 0.0008, p2: -0.0006, cx: 325.0, cy: 232.0, ..lens() }
}

fn pose(tilt_deg: f64, azimuth_deg: f64, spin_deg: f64, place_m: [f64; 3]) -> MarkerPose {
    let azimuth = azimuth_deg.to_radians();
    let axis = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
    MarkerPose {
        rotation: DQuat::from_axis_angle(axis, tilt_deg.to_radians())
            * DQuat::from_rotation_z(spin_deg.to_radians()),
        translation_m: place_m.into(),
        error_px: 0.0,
    }
}

/// A deterministic random generator (xorshift).
struct Dice(u64);

impl Dice {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns an approximately normal number: the sum of twelve uniform ones.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

impl Snapshot {
    fn new(lens: Intrinsics, truth: MarkerPose) -> Snapshot {
        Snapshot { lens, truth, blur: true, noise: 2.0, ink: [30.0, 215.0] }
    }

    /// Returns the brightness from a direction: a marker on a sheet of paper on a chequered table.
    fn light(&self, ray: DVec2, id: u32) -> f64 {
        let inverse = self.truth.rotation.inverse();
        let eye = inverse * -self.truth.translation_m;
        let along = inverse * DVec3::new(ray.x, -ray.y, -1.0);
        let t = -eye.z / along.z;
        if t <= 0.0 {
            return 0.5 * self.ink[1];
        }
        let p = eye + along * t;
        let cell = |v: f64| (v / SIZE_M + 0.5) * family::CELLS as f64;
        let (x, y) = (cell(p.x), cell(-p.y));
        let [black, white] = self.ink;
        let lit = 1.0 - 0.25 * (p.x / SIZE_M).clamp(-1.0, 1.0);
        if (-1.5..9.5).contains(&x) && (-1.5..9.5).contains(&y) {
            let inside = x >= 0.0 && y >= 0.0;
            let printed = inside && x < 8.0 && y < 8.0;
            let is_white = !printed || family::is_white(id, x as usize, y as usize).unwrap_or(true);
            return lit * if is_white { white } else { black };
        }
        let chequer = ((p.x / 0.13).floor() + (p.y / 0.13).floor()).rem_euclid(2.0);
        (0.3 + 0.4 * chequer) * white
    }

    fn take(&self, id: u32) -> Grey {
        let (w, h) = (self.lens.width as usize, self.lens.height as usize);
        let ray = |x: f64, y: f64| self.lens.ray_from_pixel(DVec2::new(x, y)).unwrap();
        // Rays at the corners of pixels; nearly straight between them.
        let rays: Vec<DVec2> = (0..=h)
            .flat_map(|y| (0..=w).map(move |x| (x, y)))
            .map(|(x, y)| ray(x as f64 - 0.5, y as f64 - 0.5))
            .collect();
        const PARTS: usize = 4;
        let mut linear = vec![0.0; w * h];
        for y in 0..h {
            for x in 0..w {
                let at = |i: usize, j: usize| rays[(y + j) * (w + 1) + x + i];
                let mut sum = 0.0;
                for part in 0..PARTS * PARTS {
                    let share = |k: usize| (k as f64 + 0.5) / PARTS as f64;
                    let (u, v) = (share(part % PARTS), share(part / PARTS));
                    let ray = at(0, 0).lerp(at(1, 0), u).lerp(at(0, 1).lerp(at(1, 1), u), v);
                    sum += self.light(ray, id);
                }
                linear[y * w + x] = sum / (PARTS * PARTS) as f64;
            }
        }
        if self.blur {
            // The lens is not sharp: a blur before the noise.
            let pixels: Vec<u8> = linear.iter().map(|v| v.round() as u8).collect();
            let soft = Grey { width: w, height: h, pixels }.blurred().blurred();
            linear = soft.pixels.iter().map(|&p| f64::from(p)).collect();
        }
        let mut dice = Dice(0x9e37_79b9_7f4a_7c15);
        let noisy = |v: &f64| (v + self.noise * dice.normal()).round().clamp(0.0, 255.0) as u8;
        Grey { width: w, height: h, pixels: linear.iter().map(noisy).collect() }
    }

    /// Returns the largest distance in pixels between the true position of a box on the marker and the one by the found
    /// pose: the visible error.
    fn registration_px(&self, found: &MarkerPose) -> f64 {
        let pixel = |pose: &MarkerPose, point| {
            let p = pose.apply(point);
            self.lens.pixel_from_ray(DVec2::new(p.x, -p.y) / -p.z)
        };
        let half = 0.5 * SIZE_M;
        (0..8)
            .map(|i| {
                let side = |bit: u32| if i >> bit & 1 == 0 { -half } else { half };
                let point = DVec3::new(side(0), side(1), side(2) + half);
                pixel(&self.truth, point).distance(pixel(found, point))
            })
            .fold(0.0, f64::max)
    }

    fn check(&self, id: u32, limit_px: f64) {
        let seen = detect(&self.take(id), &self.lens);
        assert_eq!(seen.len(), 1, "{:?}", self.truth);
        assert_eq!((seen[0].id, seen[0].wrong), (id, 0));
        let found = poses(&seen[0].corners, SIZE_M, self.lens.fx);
        let error_px = self.registration_px(&found[0]);
        assert!(error_px < limit_px, "{error_px} px: {:?}\n{:?}", self.truth, found);
    }
}

#[test]
fn markers_are_found_and_registered_within_two_pixels() {
    let places = [
        pose(35.0, 0.0, 10.0, [0.0, 0.0, -0.35]),
        pose(-55.0, 20.0, 100.0, [0.06, -0.04, -0.4]),
        pose(50.0, 90.0, -80.0, [-0.08, 0.05, -0.5]),
        pose(40.0, 200.0, 170.0, [0.1, 0.1, -0.6]),
    ];
    for (id, truth) in (0..).zip(places) {
        for lens in [lens(), wide_lens()] {
            Snapshot::new(lens, truth).check(id * 7, 2.0);
        }
    }
}

#[test]
fn dim_light_and_noise_are_borne() {
    let truth = pose(45.0, 10.0, 30.0, [0.02, -0.03, -0.4]);
    let snapshot = Snapshot::new(lens(), truth);
    Snapshot { ink: [40.0, 95.0], noise: 3.0, ..snapshot }.check(11, 2.0);
    let snapshot = Snapshot::new(lens(), truth);
    Snapshot { noise: 9.0, blur: false, ..snapshot }.check(5, 2.0);
}

#[test]
fn nothing_is_found_where_nothing_is() {
    let lens = lens();
    let (w, h) = (lens.width as usize, lens.height as usize);
    let mut dice = Dice(42);
    for round in 0..6 {
        // Noise of several grains, from single pixels to blots.
        let grain = 1 << round;
        let coarse: Vec<u8> = (0..w * h).map(|_| (dice.unit() * 256.0) as u8).collect();
        let pixels = (0..w * h).map(|i| coarse[i / w / grain * w + i % w / grain]).collect();
        let mut grey = Grey { width: w, height: h, pixels };
        assert_eq!(detect(&grey, &lens), []);
        grey = grey.blurred();
        assert_eq!(detect(&grey, &lens), []);
    }
    for pixels in [vec![0; w * h], vec![255; w * h]] {
        assert_eq!(detect(&Grey { width: w, height: h, pixels }, &lens), []);
    }
    assert_eq!(detect(&Grey { width: 0, height: 0, pixels: Vec::new() }, &lens), []);
}

#[test]
fn a_wrong_square_and_a_cut_marker_are_not_markers() {
    let truth = pose(20.0, 0.0, 0.0, [0.0, 0.0, -0.3]);
    let snapshot = Snapshot::new(lens(), truth);
    // A plain black square: all cells dark.
    let mut grey = snapshot.take(0);
    for pixel in &mut grey.pixels {
        *pixel = if *pixel < 128 { 0 } else { 255 };
    }
    assert_eq!(detect(&grey, &snapshot.lens).len(), 1, "still a marker in black and white");
    let filled = |value: u8| {
        let mut grey = grey.clone();
        for y in 150..330 {
            for x in 250..390 {
                grey.pixels[y * 640 + x] = value;
            }
        }
        grey
    };
    assert_eq!(detect(&filled(0), &snapshot.lens), []);
    let off = pose(20.0, 0.0, 0.0, [0.19, 0.0, -0.3]);
    assert_eq!(detect(&Snapshot::new(lens(), off).take(0), &snapshot.lens), [], "cut by the rim");
}
