//! Shading: from an index map to a picture. Pure CPU code.
//!
//! A pixel is shaded in two independent steps. The first finds the surface: its normal from the [`normal_field`], its
//! colour from the material, [`mod@mask_tint`]ed if it is protected, its share of ambient light by [`occlusion`]. The
//! second computes the light it sends to the eye (`illumination`), as a picture shows it ([`tone`]). Filters of normals
//! and colours (`smooth`) come between the two, and cost time only if they are enabled ([`refined`]).

#[doc(hidden)]
pub mod ball;
#[doc(hidden)]
pub mod composed;
pub mod ground;
mod illumination;
pub mod level_set;
pub mod light;
pub mod look;
pub mod mask_tint;
mod moments;
pub mod normal;
pub mod normal_field;
pub mod occlusion;
#[cfg(test)]
mod partial_tests;
mod per_leaf;
pub mod pixels;
#[doc(hidden)]
pub mod points;
mod portrait;
pub mod refined;
pub mod shadow;
mod smooth;
mod smooth_field;
pub mod software;
mod source;
pub mod tone;

pub use ground::{Ground, GroundLight, GroundPicture, GroundPlane};
pub use illumination::Illumination;
pub use level_set::{LevelLayer, LevelSampler, LevelSet};
pub use light::{
    Light, LightFrame, LightSource, Lighting, MAX_LIGHTS, MAX_SHININESS, Shadow, Smoothing,
};
pub use look::{Look, Matcap};
pub use mask_tint::{ShownColours, mask_tint};
pub use normal::NORMAL_REACH_VX;
pub use normal_field::{NormalField, Precision};
pub use pixels::Pixels;
pub use portrait::portrait;
pub use refined::SoftwareShader;
pub(crate) use smooth_field::SmoothField;
pub use software::{ShadePose, shade, shade_rect};
pub use source::ShadeSource;
pub use tone::ToneMapping;
