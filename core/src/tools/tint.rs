//! Recolours all voxels of an area by position and present colour: adjusted colours, a gradient, noise.
//!
//! Takes voxels and their present colours; gives their new ones. Knows no document and changes nothing.

use glam::{IVec3, UVec3, Vec3};

use crate::refusal::InvalidValue;
use crate::sculpture::Rgb;

/// Greatest coordinate of a gradient's ends, in voxels.
const FARTHEST_VX: f32 = 1.0e6;
/// Largest factor on saturation and value.
pub const MAX_FACTOR: f32 = 8.0;
/// Range of the patch size of noise, in units of the smallest voxel edge.
pub const SIZE_RANGE: std::ops::RangeInclusive<f32> = 1.0..=1024.0;
/// Number of precomputed gradient colours: more than 8 bits can show.
const STEPS: usize = 1024;
/// Octaves of noise; each has half the size and half the weight of the one before.
const OCTAVES: u32 = 3;

/// A change to the colours of an area.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Tint {
    /// Changes hue, saturation and value.
    Adjust {
        /// Added to the hue, in degrees.
        hue_deg: f32,
        /// Factor on the saturation.
        saturation: f32,
        /// Factor on the value, the brightest channel.
        value: f32,
    },
    /// Blends from one colour to another between two planes.
    Gradient {
        /// A point of the plane where the first colour ends, in voxel coordinates.
        from_vx: Vec3,
        /// A point of the plane where the second begins; both planes are perpendicular to the line between the points.
        to_vx: Vec3,
        /// The colours.
        colours: [Rgb; 2],
        /// Opacity of the gradient, 0 to 1.
        strength: f32,
    },
    /// Blends a colour in patches.
    Noise {
        /// The colour.
        colour: Rgb,
        /// Size of the largest patches, in units of the smallest voxel edge.
        size: f32,
        /// Greatest opacity of the colour, 0 to 1.
        amount: f32,
        /// Seed of the pattern.
        seed: u32,
    },
}

impl Tint {
    /// Returns the verb of the text form.
    pub const fn verb(&self) -> &'static str {
        match self {
            Tint::Adjust { .. } => "adjust",
            Tint::Gradient { .. } => "gradient",
            Tint::Noise { .. } => "noise",
        }
    }

    /// Returns an error that names the number out of range, if there is one.
    pub fn check(&self) -> Result<(), InvalidValue> {
        match *self {
            Tint::Adjust { hue_deg, saturation, value } => {
                let is_turn = (-360.0..=360.0).contains(&hue_deg);
                let rule = "must be turned by -360 to 360 degrees";
                InvalidValue::check(is_turn, "hue", rule, hue_deg)?;
                [("saturation", saturation), ("value", value)].into_iter().try_for_each(
                    |(field, factor)| {
                        let is_factor = (0.0..=MAX_FACTOR).contains(&factor);
                        InvalidValue::check(is_factor, field, "is a factor from 0 to 8", factor)
                    },
                )
            }
            Tint::Gradient { from_vx, to_vx, strength, .. } => {
                let is_near = |end: &Vec3| end.abs().cmple(Vec3::splat(FARTHEST_VX)).all();
                if let Some(end) = [from_vx, to_vx].into_iter().find(|end| !is_near(end)) {
                    let error = InvalidValue::new("ends", "are too far away", end);
                    return Err(error.of("gradient"));
                }
                let is_gradient = from_vx.distance(to_vx) >= 1e-3;
                let rule = "must go from one point to another";
                InvalidValue::check(
                    is_gradient,
                    "gradient",
                    rule,
                    format_args!("{from_vx} to {to_vx}"),
                )?;
                InvalidValue::check_share("strength", strength)
            }
            Tint::Noise { size, amount, .. } => {
                let rule = "must be 1 to 1024 voxels large";
                let checked =
                    InvalidValue::check(SIZE_RANGE.contains(&size), "patches", rule, size);
                checked.map_err(|error| error.of("noise"))?;
                InvalidValue::check_share("amount of noise", amount)
            }
        }
    }
}

/// A tint, prepared for many voxels of a grid.
pub struct Tinter {
    tint: PreparedTint,
    /// The signed coordinates of the grid's first voxel, to which the patches of noise are fixed.
    origin: Vec3,
}

enum PreparedTint {
    Adjust {
        /// As in [`Tint::Adjust`].
        change: [f32; 3],
        /// The colour of most voxels, and its adjusted value.
        base: [Rgb; 2],
    },
    Gradient {
        start: Vec3,
        /// Share of the gradient for a step along each axis.
        per_voxel: Vec3,
        table: Vec<Rgb>,
        strength: f32,
    },
    Noise {
        colour: Rgb,
        /// Number of patches in a voxel along each axis.
        scale: Vec3,
        amount: f32,
        seed: u32,
    },
}

impl Tinter {
    /// Prepares `tint` for a sculpture of voxels of this size, most of them of the colour `base`.
    pub fn new(tint: &Tint, voxel_size: Vec3, base: Rgb) -> Tinter {
        let edges = voxel_size / voxel_size.min_element();
        let tint = match *tint {
            Tint::Adjust { hue_deg, saturation, value } => {
                let change = [hue_deg, saturation, value];
                PreparedTint::Adjust { change, base: [base, adjusted(base, change)] }
            }
            Tint::Gradient { from_vx, to_vx, colours, strength } => {
                let span = (to_vx - from_vx) * edges;
                let per_voxel = span * edges / span.length_squared();
                let [first, last] = colours.map(oklab_of);
                let at = |i| oklab_to_rgb(first.lerp(last, i as f32 / (STEPS - 1) as f32));
                let mut table: Vec<Rgb> = (0..STEPS).map(at).collect();
                // The ends are exactly the requested colours.
                (table[0], table[STEPS - 1]) = (colours[0], colours[1]);
                PreparedTint::Gradient { start: from_vx, per_voxel, table, strength }
            }
            Tint::Noise { colour, size, amount, seed } => {
                PreparedTint::Noise { colour, scale: edges / size, amount, seed }
            }
        };
        Tinter { tint, origin: Vec3::ZERO }
    }

    /// Returns the same for a grid whose first voxel has these signed coordinates.
    pub(crate) fn shifted_by(self, origin: IVec3) -> Tinter {
        Tinter { origin: origin.as_vec3(), ..self }
    }

    /// Returns whether voxels of the base colour are certain to keep it.
    pub(crate) fn keeps_base(&self) -> bool {
        match &self.tint {
            PreparedTint::Adjust { base: [base, adjusted], .. } => base == adjusted,
            PreparedTint::Gradient { strength: share, .. }
            | PreparedTint::Noise { amount: share, .. } => *share == 0.0,
        }
    }

    /// Returns the new colour of the voxel `v`.
    pub fn colour(&self, v: UVec3, now: Rgb) -> Rgb {
        let centre = v.as_vec3() + 0.5;
        match &self.tint {
            PreparedTint::Adjust { change, base: [base, adjusted_base] } => match now == *base {
                true => *adjusted_base,
                false => adjusted(now, *change),
            },
            PreparedTint::Gradient { start, per_voxel, table, strength } => {
                let share = (centre - start).dot(*per_voxel).clamp(0.0, 1.0);
                let colour = table[(share * (STEPS - 1) as f32 + 0.5) as usize];
                blended(now, colour, *strength)
            }
            PreparedTint::Noise { colour, scale, amount, seed } => {
                blended(now, *colour, amount * noise((centre + self.origin) * scale, *seed))
            }
        }
    }
}

/// Returns `now` blended with `share` of another colour, in stored values, as brushes blend.
fn blended(now: Rgb, other: Rgb, share: f32) -> Rgb {
    let channel = |i: usize| {
        let (a, b) = (f32::from(now.0[i]), f32::from(other.0[i]));
        // Rounds by hand; a call of `round` would take longer than the rest.
        (a + (b - a) * share + 0.5) as u8
    };
    Rgb([channel(0), channel(1), channel(2)])
}

/// Returns a colour with adjusted hue, saturation and value. (HSV: Smith, "Color gamut transform pairs", 1978.)
fn adjusted(Rgb(rgb): Rgb, [hue_deg, saturation_factor, value_factor]: [f32; 3]) -> Rgb {
    let [r, g, b] = rgb.map(|channel| f32::from(channel) / 255.0);
    let value = r.max(g).max(b);
    let chroma = value - r.min(g).min(b);
    let sextant = match chroma {
        0.0 => 0.0,
        _ if value == r => (g - b) / chroma,
        _ if value == g => (b - r) / chroma + 2.0,
        _ => (r - g) / chroma + 4.0,
    };
    let saturation = if value > 0.0 { chroma / value } else { 0.0 };
    let value = (value * value_factor).min(1.0);
    let chroma = value * (saturation * saturation_factor).min(1.0);
    let hue = sextant + hue_deg / 60.0;
    // The channel whose hue is `place` sextants away from red.
    let channel = |place: f32| {
        let k = (place + hue).rem_euclid(6.0);
        let level = value - chroma * k.min(4.0 - k).clamp(0.0, 1.0);
        (level * 255.0).round() as u8
    };
    Rgb([channel(5.0), channel(3.0), channel(1.0)])
}

/// Returns lightness and two opponent colour axes, in which equal distances look equal. (Oklab: Ottosson, "A perceptual
/// color space for image processing", 2020.)
fn oklab_of(Rgb(rgb): Rgb) -> Vec3 {
    let linear = |channel: u8| {
        let s = f32::from(channel) / 255.0;
        if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
    };
    let rgb = Vec3::from(rgb.map(linear));
    let cones = [
        Vec3::new(0.412_221_47, 0.536_332_55, 0.051_445_995),
        Vec3::new(0.211_903_5, 0.680_699_5, 0.107_396_96),
        Vec3::new(0.088_302_46, 0.281_718_85, 0.629_978_7),
    ];
    let cones = Vec3::from(cones.map(|weights| weights.dot(rgb).cbrt()));
    Vec3::new(
        Vec3::new(0.210_454_26, 0.793_617_8, -0.004_072_047).dot(cones),
        Vec3::new(1.977_998_5, -2.428_592_2, 0.450_593_7).dot(cones),
        Vec3::new(0.025_904_037, 0.782_771_77, -0.808_675_77).dot(cones),
    )
}

/// Inverts [`oklab_of`], clamped to displayable colours.
fn oklab_to_rgb(lab: Vec3) -> Rgb {
    let cones = [
        Vec3::new(1.0, 0.396_337_78, 0.215_803_76),
        Vec3::new(1.0, -0.105_561_346, -0.063_854_17),
        Vec3::new(1.0, -0.089_484_18, -1.291_485_5),
    ];
    let cones = Vec3::from(cones.map(|weights| weights.dot(lab).powi(3)));
    let rgb = [
        Vec3::new(4.076_741_7, -3.307_711_6, 0.230_969_93),
        Vec3::new(-1.268_438, 2.609_757_4, -0.341_319_4),
        Vec3::new(-0.004_196_086, -0.703_418_6, 1.707_614_7),
    ];
    Rgb(rgb.map(|weights| {
        let linear = weights.dot(cones).clamp(0.0, 1.0);
        let s = match linear <= 0.003_130_8 {
            true => linear * 12.92,
            false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
        };
        (s * 255.0).round() as u8
    }))
}

/// Returns smooth noise from 0 to 1 with patches of size 1 and smaller ones.
fn noise(p: Vec3, seed: u32) -> f32 {
    let (mut sum, mut weight, mut all, mut p) = (0.0, 1.0, 0.0, p);
    for octave in 0..OCTAVES {
        sum += weight * gradient_noise(p, seed.wrapping_add(octave));
        all += weight;
        (weight, p) = (weight * 0.5, p * 2.0);
    }
    // Gradient noise seldom exceeds 0.7.
    (0.5 + 0.7 * sum / all).clamp(0.0, 1.0)
}

/// The gradients at cell corners: towards the midpoints of a cube's edges, four of them twice.
const GRADIENTS: [Vec3; 16] = [
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(-1.0, 1.0, 0.0),
    Vec3::new(1.0, -1.0, 0.0),
    Vec3::new(-1.0, -1.0, 0.0),
    Vec3::new(1.0, 0.0, 1.0),
    Vec3::new(-1.0, 0.0, 1.0),
    Vec3::new(1.0, 0.0, -1.0),
    Vec3::new(-1.0, 0.0, -1.0),
    Vec3::new(0.0, 1.0, 1.0),
    Vec3::new(0.0, -1.0, 1.0),
    Vec3::new(0.0, 1.0, -1.0),
    Vec3::new(0.0, -1.0, -1.0),
    Vec3::new(1.0, 1.0, 0.0),
    Vec3::new(-1.0, 1.0, 0.0),
    Vec3::new(0.0, -1.0, 1.0),
    Vec3::new(0.0, -1.0, -1.0),
];

/// Returns gradient noise at a non-negative position, about -1 to 1. (Perlin, "Improving noise", 2002, with hashes for
/// its table.)
fn gradient_noise(p: Vec3, seed: u32) -> f32 {
    let cell = p.floor();
    let within = p - cell;
    let fade = within * within * within * (within * (within * 6.0 - 15.0) + 10.0);
    let [x, y, z] = cell.as_ivec3().as_uvec3().to_array();
    // The contribution of each axis to the hashes of the corners at its lower and upper end.
    let ends =
        |i: u32, factor: u32| [i.wrapping_mul(factor), (i.wrapping_add(1)).wrapping_mul(factor)];
    let [xs, ys, zs] = [ends(x, 0x8DA6_B343), ends(y, 0xD816_3841), ends(z, 0xCB1A_B31F)];
    let seed = seed.wrapping_mul(0x9E37_79B9);
    let corner = |i: usize, j: usize, k: usize| {
        let gradient = GRADIENTS[hash(xs[i] ^ ys[j] ^ zs[k] ^ seed) as usize >> 28];
        gradient.dot(within - Vec3::new(i as f32, j as f32, k as f32))
    };
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let along_x = |j, k| lerp(corner(0, j, k), corner(1, j, k), fade.x);
    let along_y = |k| lerp(along_x(0, k), along_x(1, k), fade.y);
    lerp(along_y(0), along_y(1), fade.z)
}

/// Returns a pseudo-random number. (The finaliser of MurmurHash3, Appleby 2011.)
#[inline(always)]
fn hash(mixed: u32) -> u32 {
    let mixed = (mixed ^ mixed >> 16).wrapping_mul(0x85EB_CA6B);
    let mixed = (mixed ^ mixed >> 13).wrapping_mul(0xC2B2_AE35);
    mixed ^ mixed >> 16
}

#[cfg(test)]
#[path = "tint_tests.rs"]
mod tests;
