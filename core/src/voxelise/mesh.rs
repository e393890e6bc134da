//! A mesh as a triangle soup, with its colours: of corners, of a texture, or one for all.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use crate::sculpture::Rgb;
use crate::tools::texture::Texture;

/// Triangles with colours.
#[derive(Clone, Debug, Default)]
pub struct InputMesh {
    /// Corners.
    pub positions: Vec<Vec3>,
    /// Three positions each, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// sRGB colours of the corners of each triangle. Empty, or as many as triangles.
    pub corner_colours: Vec<[Rgb; 3]>,
    /// Texture coordinates of the corners of each triangle, (0, 0) the lower left corner. Empty, or as many as
    /// triangles.
    pub corner_uvs: Vec<[Vec2; 3]>,
    /// Colours and textures that triangles may have.
    pub skins: Vec<Skin>,
    /// The skin of each triangle; an index beyond the last skin means none. Empty, or as many as triangles.
    pub skin_of: Vec<u32>,
}

/// The colour of a part of a mesh.
#[derive(Clone, Debug)]
pub struct Skin {
    /// sRGB colour, which multiplies the texture and the colours of corners.
    pub colour: Rgb,
    /// The texture, which repeats beyond its edges.
    pub texture: Option<Arc<Texture>>,
}

impl InputMesh {
    /// Returns whether it has any colours.
    pub fn has_colours(&self) -> bool {
        !self.corner_colours.is_empty() || !self.skin_of.is_empty()
    }

    /// Returns the colour of all triangles, if they have the same and no texture.
    pub(crate) fn only_colour(&self) -> Option<Rgb> {
        let first = self.skins.get(*self.skin_of.first()? as usize)?;
        let is_plain = first.texture.is_none() && self.corner_colours.is_empty();
        let same = self.skin_of.iter().all(|skin| *skin == self.skin_of[0]);
        (is_plain && same).then_some(first.colour)
    }

    /// Returns the colour of a triangle at the point with these barycentric weights.
    pub fn colour(&self, triangle: usize, weights: Vec3) -> Rgb {
        let [a, b, c] = weights.to_array();
        let mut colour = Vec3::splat(255.0);
        let skin = self.skin_of.get(triangle).and_then(|skin| self.skins.get(*skin as usize));
        let times = |by: Vec3, colour: &mut Vec3| *colour *= by / 255.0;
        match skin {
            Some(Skin { colour: own, texture }) => {
                times(Vec3::from(own.0.map(f32::from)), &mut colour);
                if let (Some(texture), Some(uvs)) = (texture, self.corner_uvs.get(triangle)) {
                    let at = uvs[0] * a + uvs[1] * b + uvs[2] * c;
                    let at = if at.is_finite() { at - at.floor() } else { Vec2::ZERO };
                    times(Vec3::from(texture.sample(at).0.map(f32::from)), &mut colour);
                }
            }
            None if self.corner_colours.is_empty() => return Rgb::STONE,
            None => {}
        }
        if let Some(corners) = self.corner_colours.get(triangle) {
            let [p, q, r] = corners.map(|corner| Vec3::from(corner.0.map(f32::from)));
            times(p * a + q * b + r * c, &mut colour);
        }
        Rgb(colour.to_array().map(|level| level.clamp(0.0, 255.0).round() as u8))
    }
}
