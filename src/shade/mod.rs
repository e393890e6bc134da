//! Shading: from an index map to a picture. Pure CPU code.
//!
//! A pixel goes through two steps that know nothing of each other: what surface is there (its
//! normal from [`normal`], its colour from the material), and what light it sends to the eye
//! ([`illumination`]). Filters of normals and colours and ambient occlusion belong between the two.

mod illumination;
pub mod light;
pub mod normal;
pub mod pixels;
pub mod software;

pub use light::{Light, LightFrame, LightSource, Lighting};
pub use normal::NORMAL_REACH_VX;
pub use pixels::Pixels;
pub use software::{ShadePose, shade, shade_rect};
