//! Images on solids: maps an image onto a solid and samples its colour at a voxel.
//!
//! Takes decoded pixels and points of tool space, where a solid fills [-1, 1] and the image is upright along the y
//! axis. Image coordinates are (0, 0) in the lower left corner and (1, 1) in the upper right one. Knows no files and no
//! solids.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3, vec2};

use crate::sculpture::Rgb;

/// Longest side of an image, in pixels.
pub const MAX_SIDE: u32 = 8192;

/// An image, top row first.
#[derive(Clone, PartialEq, Debug)]
pub struct Texture {
    width: u32,
    pixels: Vec<Rgb>,
}

impl Texture {
    /// Creates an image from rows of `width` pixels. Returns `None` if there is no pixel or the last row is incomplete.
    pub fn new(width: u32, pixels: Vec<Rgb>) -> Option<Texture> {
        let whole = width > 0 && !pixels.is_empty() && pixels.len().is_multiple_of(width as usize);
        whole.then_some(Texture { width, pixels })
    }

    /// Returns width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, (self.pixels.len() / self.width as usize) as u32]
    }

    /// Returns the colour at `at`: (0, 0) is the lower left corner, (1, 1) the upper right one. Interpolates
    /// bilinearly, and clamps at the edges.
    pub fn sample(&self, at: Vec2) -> Rgb {
        let [width, height] = self.size();
        let x = at.x * width as f32 - 0.5;
        let y = (1.0 - at.y) * height as f32 - 0.5;
        let column = |x: f32| x.clamp(0.0, width as f32 - 1.0) as usize;
        let row = |y: f32| y.clamp(0.0, height as f32 - 1.0) as usize;
        let pixel = |x: f32, y: f32| {
            let [r, g, b] = self.pixels[row(y) * width as usize + column(x)].0;
            Vec3::new(r.into(), g.into(), b.into())
        };
        let (left, top) = (x.floor(), y.floor());
        let upper = pixel(left, top).lerp(pixel(left + 1.0, top), x - left);
        let lower = pixel(left, top + 1.0).lerp(pixel(left + 1.0, top + 1.0), x - left);
        let mixed = upper.lerp(lower, y - top).round();
        Rgb(mixed.to_array().map(|v| v as u8))
    }
}

/// Maps a point of tool space to an image wrapped once around a ball, by longitude and latitude.
pub(crate) fn around_ball(p: Vec3) -> Vec2 {
    let length = p.length().max(f32::MIN_POSITIVE);
    let longitude = p.x.atan2(p.z);
    vec2(0.5 + longitude / TAU, 0.5 + (p.y / length).clamp(-1.0, 1.0).asin() / PI)
}

/// Maps a point of tool space to an image wrapped once around the side; the caps show its upper or lower edge.
pub(crate) fn around_side(p: Vec3) -> Vec2 {
    vec2(0.5 + p.x.atan2(p.z) / TAU, 0.5 * p.y + 0.5)
}

/// Maps a point of tool space to an image on each face of a cuboid.
pub(crate) fn on_faces(p: Vec3) -> Vec2 {
    let a = p.abs();
    let on_face = match a.y > a.x.max(a.z) {
        true => vec2(p.x, -p.z * p.y.signum()),
        false => vec2(on_side(p), p.y),
    };
    on_face * 0.5 + 0.5
}

/// Returns how far to the right a point is on the nearest of four sides. Each is seen from outside, so that writing is
/// not mirrored.
pub(crate) fn on_side(p: Vec3) -> f32 {
    match p.x.abs() > p.z.abs() {
        true => -p.z * p.x.signum(),
        false => p.x * p.z.signum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::solid::Solid;

    fn picture_point(solid: Solid, p: Vec3) -> Vec2 {
        (solid.spec().image_point)(p)
    }

    #[test]
    fn colours_are_mixed_between_pixels_and_kept_beyond_edges() {
        let texture = Texture::new(
            2,
            vec![
                Rgb::new(0, 0, 0),
                Rgb::new(200, 0, 0),
                Rgb::new(0, 100, 0),
                Rgb::new(200, 100, 50),
            ],
        )
        .unwrap();
        assert_eq!(texture.size(), [2, 2]);
        assert_eq!(texture.sample(vec2(0.25, 0.75)), Rgb::new(0, 0, 0));
        assert_eq!(texture.sample(vec2(0.75, 0.25)), Rgb::new(200, 100, 50));
        assert_eq!(texture.sample(vec2(0.5, 0.75)), Rgb::new(100, 0, 0));
        assert_eq!(texture.sample(vec2(0.5, 0.5)), Rgb::new(100, 50, 13));
        assert_eq!(texture.sample(vec2(-5.0, 9.0)), Rgb::new(0, 0, 0));
        assert!(Texture::new(0, vec![]).is_none());
        assert!(Texture::new(2, vec![Rgb::STONE; 3]).is_none());
    }

    #[test]
    fn the_picture_stands_upright_on_every_solid() {
        for solid in Solid::ALL {
            // Seen from the front (+z): right is right, up is up.
            let low = picture_point(solid, Vec3::new(-0.3, -0.9, 0.95));
            let high = picture_point(solid, Vec3::new(0.02, 0.9, 0.05));
            let right = picture_point(solid, Vec3::new(0.3, -0.9, 0.95));
            assert!(high.y > low.y && right.x > low.x, "{solid:?}");
            // Seen from the right (+x): towards -z is right.
            let left = picture_point(solid, Vec3::new(0.95, -0.9, 0.3));
            let right = picture_point(solid, Vec3::new(0.95, -0.9, -0.3));
            assert!(right.x > left.x, "{solid:?}");
        }
        assert_eq!(picture_point(Solid::Cuboid, Vec3::new(1.0, 1.0, 1.0)), vec2(1.0, 1.0));
        assert_eq!(picture_point(Solid::Ellipsoid, Vec3::Z), vec2(0.5, 0.5));
        assert_eq!(picture_point(Solid::Pyramid, Vec3::new(0.5, 0.0, 0.5)), vec2(1.0, 0.5));
    }
}
