//! Compares what an eye sees with what it should see: a cube in the room, projected from the head pose that the test
//! has set, not from the one that the program reports.

use std::path::Path;

use glam::{Quat, Vec2, Vec3};
use image::RgbaImage;

use super::remote::{ANGLES, EYES};

/// A screenshot of both eyes.
pub struct Screenshot {
    pub eyes: [RgbaImage; 2],
    head: (Vec3, Quat),
}

/// A cube that should be seen.
pub struct Predicted {
    pub centre: Vec3,
    /// In metres.
    pub edge: f32,
    pub rotation: Quat,
}

impl Screenshot {
    /// The pictures in a folder, taken with this head.
    pub fn read(folder: &Path, head: (Vec3, Quat)) -> Option<Screenshot> {
        let eye = |name: &str| Some(image::open(folder.join(name)).ok()?.into_rgba8());
        Some(Screenshot { eyes: [eye("left.png")?, eye("right.png")?], head })
    }

    /// The pixel at which an eye sees a point of the room.
    fn pixel(&self, eye: usize, point: Vec3) -> Vec2 {
        let (position, rotation) = self.head;
        let own = rotation.inverse() * (point - position) - EYES[eye];
        let [left, right, up, down] = ANGLES[eye].map(f32::tan);
        let (x, y) = (own.x / -own.z, own.y / -own.z);
        let (width, height) = self.eyes[eye].dimensions();
        Vec2::new((x - left) / (right - left), (up - y) / (up - down))
            * Vec2::new(width as f32, height as f32)
    }

    /// Asserts that the eye sees the cube exactly where it should be.
    pub fn assert_shows(&self, cube: &Predicted, eye: usize) {
        let corner = |i: usize| {
            let side = |bit: usize| if i >> bit & 1 == 0 { -0.5 } else { 0.5 };
            let own = Vec3::new(side(0), side(1), side(2)) * cube.edge;
            self.pixel(eye, cube.centre + cube.rotation * own)
        };
        let hull = hull((0..8).map(corner).collect());
        let picture = &self.eyes[eye];
        let (mut inside, mut wrong) = (0, Vec::new());
        for (x, y, pixel) in picture.enumerate_pixels() {
            let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let depth = depth_in(&hull, at);
            // Stone is warm or bright, the background and the lines on the floor are neither. The
            // red line to the tool is in front of both.
            let [r, g, b, _] = pixel.0.map(i32::from);
            if r > g + 10 {
                continue;
            }
            let stone = r > b + 8 || r > 85;
            inside += u32::from(depth > 2.0);
            if depth > 2.0 && !stone || depth < -2.5 && stone {
                wrong.push((x, y, pixel.0));
            }
        }
        assert!(inside > 1500, "the cube is in the picture: {inside} pixels");
        if wrong.len() > 20 {
            let path = std::env::temp_dir().join(format!("wrong-eye-{eye}.png"));
            picture.save(&path).unwrap();
            let some = &wrong[..wrong.len().min(8)];
            panic!("{} of {inside} pixels: {some:?}, {hull:?}, {}", wrong.len(), path.display());
        }
    }
}

/// The convex hull of points, in order (Andrew's monotone chain).
fn hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut points.iter().copied());
    lower.extend(half(&mut points.iter().rev().copied()));
    lower
}

/// How far inside the hull a point is, in pixels; outside below 0.
fn depth_in(hull: &[Vec2], at: Vec2) -> f32 {
    let next = hull.iter().cycle().skip(1);
    hull.iter()
        .zip(next)
        .map(|(a, b)| (*b - *a).normalize().perp_dot(at - *a))
        .fold(f32::INFINITY, f32::min)
}
