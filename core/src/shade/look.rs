//! Looks: the material of the surface in a picture, whatever colours its voxels have.
//!
//! True colours, clay and stone are lit by the lights. A matcap is a picture of a lit ball: a surface has the light of
//! the point of the ball with its normal (Sloan, Martin, Gooch and Gooch, "The lit sphere: a model for capturing NPR
//! shading from art", 2001).

use std::sync::{Mutex, OnceLock, PoisonError};

use glam::{Vec2, Vec3};

use crate::sculpture::Rgb;

/// The look of a surface: its material.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Look {
    /// The voxels' own colours.
    #[default]
    Colours,
    /// Matt clay.
    Clay,
    /// Pale stone.
    Stone,
    /// The light of a [`Matcap`] instead of the lights'.
    Matcap,
}

/// A material in place of the voxels' colours.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Substance {
    /// Colour in sRGB.
    pub colour: Rgb,
    /// As in [`super::Lighting`].
    pub specular: f32,
    /// As in [`super::Lighting`].
    pub shininess: u32,
}

impl Look {
    /// All values.
    pub const ALL: [Look; 4] = [Look::Colours, Look::Clay, Look::Stone, Look::Matcap];

    /// Returns the material that replaces the voxels' colours.
    pub fn substance(self) -> Option<Substance> {
        match self {
            Look::Colours => None,
            Look::Clay => {
                Some(Substance { colour: Rgb::new(178, 112, 84), specular: 0.06, shininess: 10 })
            }
            Look::Stone => {
                Some(Substance { colour: Rgb::new(196, 194, 188), specular: 0.03, shininess: 6 })
            }
            // Multiplied with the light of the matcap.
            Look::Matcap => {
                Some(Substance { colour: Rgb::new(255, 255, 255), specular: 0.0, shininess: 1 })
            }
        }
    }
}

/// Edge of a matcap in texels.
pub const MATCAP_EDGE: usize = 128;

/// The ball's radius as a fraction of the picture's half edge: its outermost texels are blended with those around it.
pub const MATCAP_RADIUS: f32 = 0.98;

/// The texels of a matcap, upper row first: sRGB, red in the lowest byte. 255 in the highest.
pub type MatcapTexels = [u32; MATCAP_EDGE * MATCAP_EDGE];

/// A picture of a lit ball. A handle: each distinct picture is kept once until the program ends, so that descriptions
/// of pictures remain plain values. There are few of them, of 64 KiB each.
#[derive(Clone, Copy)]
pub struct Matcap(&'static MatcapTexels);

impl Matcap {
    /// Returns the built-in matcap: grey wax under a warm lamp and a cool rim light.
    pub fn built_in() -> Matcap {
        static BUILT_IN: OnceLock<Matcap> = OnceLock::new();
        *BUILT_IN.get_or_init(|| {
            Matcap::from_fn(|at| {
                // Beyond the ball, its edge colour continues.
                let flat = at.clamp_length_max(1.0);
                let z = (1.0 - flat.length_squared()).max(0.0).sqrt();
                wax(flat.extend(z))
            })
        })
    }

    /// Returns a matcap of the colour at each place: (-1, -1) to (1, 1) from the lower left to the upper right corner.
    pub fn from_fn(mut colour: impl FnMut(Vec2) -> Rgb) -> Matcap {
        static KEPT: Mutex<Vec<&'static MatcapTexels>> = Mutex::new(Vec::new());
        let mut texels = Box::new([0; MATCAP_EDGE * MATCAP_EDGE]);
        for (i, texel) in texels.iter_mut().enumerate() {
            let texel_at = Vec2::new((i % MATCAP_EDGE) as f32, (i / MATCAP_EDGE) as f32);
            let at = texel_at / (0.5 * (MATCAP_EDGE - 1) as f32) - 1.0;
            let Rgb([r, g, b]) = colour(Vec2::new(at.x, -at.y));
            *texel = u32::from_le_bytes([r, g, b, 255]);
        }
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(equal) = kept.iter().find(|other| ***other == *texels) {
            return Matcap(equal);
        }
        kept.push(Box::leak(texels));
        Matcap(kept[kept.len() - 1])
    }

    /// Returns the picture.
    pub fn texels(&self) -> &'static MatcapTexels {
        self.0
    }

    /// Returns the linear colour at a position in texels, from 0 to the edge less 1 on both axes, downwards;
    /// interpolated.
    #[inline(always)]
    pub(super) fn sample(&self, x: f32, y: f32) -> Vec3 {
        let last = (MATCAP_EDGE - 2) as f32;
        let (left, top) = (x.floor().clamp(0.0, last), y.floor().clamp(0.0, last));
        let at = left as usize + top as usize * MATCAP_EDGE;
        let texel = |at: usize| {
            let [r, g, b, _] = self.0[at].to_le_bytes().map(|c| f32::from(c) * (1.0 / 255.0));
            Vec3::new(r * r, g * g, b * b)
        };
        let mix = |a: Vec3, b: Vec3, share: f32| a + (b - a) * share;
        let upper = mix(texel(at), texel(at + 1), x - left);
        let lower = mix(texel(at + MATCAP_EDGE), texel(at + MATCAP_EDGE + 1), x - left);
        mix(upper, lower, y - top)
    }
}

impl Default for Matcap {
    fn default() -> Self {
        Matcap::built_in()
    }
}

impl PartialEq for Matcap {
    /// Compares handles: equal pictures are kept once.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl std::fmt::Debug for Matcap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Matcap({:p})", self.0)
    }
}

/// Returns the colour of wax with this normal, seen along z.
fn wax(normal: Vec3) -> Rgb {
    let lit_from = |x: f32, y: f32, z: f32| normal.dot(Vec3::new(x, y, z).normalize());
    // Light is scattered below the surface of wax, so that it wraps around.
    let key = (lit_from(-0.5, 0.7, 0.6) * 0.75 + 0.25).max(0.0);
    let sky = lit_from(0.0, 1.0, 0.2) * 0.5 + 0.5;
    let rim = (1.0 - normal.z).powi(3) * (lit_from(0.8, 0.3, -0.2) * 0.5 + 0.5);
    let gloss = lit_from(-0.28, 0.4, 0.87).max(0.0).powi(40);
    let light = Vec3::new(0.62, 0.55, 0.48) * key
        + Vec3::new(0.10, 0.12, 0.16) * sky
        + Vec3::new(0.35, 0.45, 0.60) * rim
        + Vec3::splat(0.30) * gloss
        + Vec3::new(0.035, 0.025, 0.025);
    let light = light.clamp(Vec3::ZERO, Vec3::ONE);
    Rgb(light.to_array().map(|c| (c.sqrt() * 255.0 + 0.5) as u8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_matcaps_are_one_and_others_differ() {
        let grey = |level: u8| Matcap::from_fn(|_| Rgb::new(level, level, level));
        assert_eq!(grey(7), grey(7));
        assert!(std::ptr::eq(grey(7).texels(), grey(7).texels()));
        assert_ne!(grey(7), grey(8));
        assert_eq!(Matcap::default(), Matcap::built_in());
    }

    #[test]
    fn texels_lie_as_in_the_picture_and_are_interpolated_in_linear_light() {
        let ramp = Matcap::from_fn(|at| {
            Rgb::new(if at.x > 0.99 { 255 } else { 0 }, if at.y > 0.99 { 255 } else { 0 }, 9)
        });
        let last = (MATCAP_EDGE - 1) as f32;
        let close =
            |found: Vec3, expected: Vec3| assert!(found.abs_diff_eq(expected, 1e-5), "{found}");
        let blue = (9.0f32 / 255.0).powi(2);
        close(ramp.sample(0.0, last), Vec3::new(0.0, 0.0, blue));
        close(ramp.sample(last, 0.0), Vec3::new(1.0, 1.0, blue));
        close(ramp.sample(last - 0.25, last), Vec3::new(0.75, 0.0, blue));
        close(ramp.sample(0.0, 0.5), Vec3::new(0.0, 0.5, blue));
    }

    #[test]
    fn the_built_in_ball_is_lit_from_the_upper_left() {
        let matcap = Matcap::built_in();
        let sum = |x: f32, y: f32| matcap.sample(x, y).element_sum();
        assert!(sum(40.0, 35.0) > 2.0 * sum(75.0, 100.0));
    }
}
