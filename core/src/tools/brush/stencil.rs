//! Stencils: an image that replaces a brush's colour, or lets a colour through where it is bright.
//!
//! From voxels under the brush to their colours. The image stands upright over the brush in the view, its longer side
//! as long as the brush is wide. Changes nothing; knows no files.

use std::sync::Arc;

use glam::{Mat3, UVec3, Vec2, Vec3};

use super::footprint::Footprint;
use crate::sculpture::Rgb;
use crate::tools::texture::Texture;

/// An image over a brush.
pub struct Stencil {
    texture: Arc<Texture>,
    eye_vx: Vec3,
    /// Maps the offset of a point from the eye to its ray: the number of rays to the right and down, times
    /// the third component.
    rays_from_grid: Mat3,
    /// Half the width and height of the image, in rays.
    half: Vec2,
    colour: Option<Rgb>,
    cover: f32,
}

impl Stencil {
    /// Creates a stencil. `colour` shows through the bright parts of the image; `None` for the image's own colours.
    /// `cover`: its opacity.
    pub fn new(
        texture: &Arc<Texture>,
        footprint: &Footprint,
        colour: Option<Rgb>,
        cover: f32,
    ) -> Stencil {
        let Footprint { eye_vx, aim, across, down, radius, .. } = *footprint;
        let size = Vec2::from(texture.size().map(|side| side as f32));
        // Half a ray more on each side, the share of the outermost rays.
        let half = size / size.max_element() * (radius + 0.5);
        let rays_from_grid = Mat3::from_cols(across, down, aim).inverse();
        Stencil { texture: texture.clone(), eye_vx, rays_from_grid, half, colour, cover }
    }

    /// Returns the new colour of a voxel from its present one.
    pub fn colour(&self, v: UVec3, now: Rgb) -> Rgb {
        let ray = self.rays_from_grid * (v.as_vec3() + 0.5 - self.eye_vx);
        let place = ray.truncate() / ray.z / self.half;
        if !place.abs().cmple(Vec2::ONE).all() {
            return now;
        }
        let pixel = self.texture.sample(Vec2::new(place.x, -place.y) * 0.5 + 0.5);
        let (wanted, share) = match self.colour {
            Some(colour) => (colour, self.cover * brightness(pixel)),
            None => (pixel, self.cover),
        };
        Rgb(std::array::from_fn(|i| {
            let (from, to) = (f32::from(now.0[i]), f32::from(wanted.0[i]));
            (from + (to - from) * share).round() as u8
        }))
    }
}

/// Returns the perceived brightness of a colour (luma of BT.709), 0 to 1.
fn brightness(Rgb([r, g, b]): Rgb) -> f32 {
    (0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)) / 255.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::brush::footprint::{Coverage, Outline};

    /// Returns a footprint that looks straight down the z axis, with rays a voxel apart at z = 0.
    fn looking_down(radius: f32) -> Footprint {
        Footprint {
            eye_vx: Vec3::new(10.0, 10.0, 100.0),
            aim: Vec3::new(0.0, 0.0, -100.0),
            across: Vec3::X,
            down: Vec3::NEG_Y,
            radius,
            outline: Outline::Square,
            coverage: Coverage::Visible,
        }
    }

    #[test]
    fn the_image_stands_upright_and_keeps_its_shape() {
        let [red, green] = [Rgb::new(255, 0, 0), Rgb::new(0, 255, 0)];
        // Twice as wide as high; the upper row is red, the lower one green.
        let texture = Texture::new(4, [[red; 4], [green; 4]].concat()).unwrap();
        let stencil = Stencil::new(&Arc::new(texture), &looking_down(8.0), None, 1.0);
        let grey = Rgb::new(9, 9, 9);
        let at = |x, y| stencil.colour(UVec3::new(x, y, 0), grey);
        assert_eq!((at(10, 13), at(10, 6)), (red, green));
        assert_eq!((at(3, 13), at(16, 6)), (red, green));
        assert_eq!((at(10, 16), at(1, 10)), (grey, grey), "beyond the image nothing changes");
    }

    #[test]
    fn a_colour_goes_through_where_the_image_is_bright() {
        let texture = Texture::new(1, vec![Rgb::new(255, 255, 255), Rgb::new(0, 0, 0)]).unwrap();
        let blue = Rgb::new(0, 0, 200);
        let stencil = Stencil::new(&Arc::new(texture), &looking_down(8.0), Some(blue), 0.5);
        let at = |y| stencil.colour(UVec3::new(10, y, 0), Rgb::new(100, 100, 100));
        assert_eq!(at(17), Rgb::new(50, 50, 150));
        assert_eq!(at(2), Rgb::new(100, 100, 100));
        // Rays that do not span a picture, as a script may give them, paint nothing.
        let flat = Footprint { down: Vec3::X, ..looking_down(8.0) };
        let white = Texture::new(1, vec![Rgb::new(255, 255, 255)]).unwrap();
        let stencil = Stencil::new(&Arc::new(white), &flat, None, 1.0);
        assert_eq!(stencil.colour(UVec3::new(10, 10, 0), blue), blue);
    }
}
