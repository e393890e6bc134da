//! The options of a final picture, shown by its dialog and remembered for the next start.
//!
//! Composes the [`FinalRequest`]; shows nothing and traces no light.

use glam::UVec2;

use crate::sculpture::Rgb;
use crate::trace::{AreaLight, TraceOptions};
use crate::ui::dialogs::picture_size::PictureSize;
use crate::ui::pictures::{FinalFile, FinalRequest};

/// A lamp to the left of the viewer that fills the sun's shadows.
const USUAL_LAMP: AreaLight =
    AreaLight { azimuth_deg: -60.0, elevation_deg: 30.0, size: 1.0, strength: 0.5 };

/// The options chosen so far.
#[derive(Clone, PartialEq, Debug)]
pub struct FinalDialog {
    pub open: bool,
    pub size: PictureSize,
    pub trace: TraceOptions,
    /// The ground's colour, kept even without a ground.
    pub ground: Rgb,
    /// The lamp, kept even while it is off.
    pub lamp: AreaLight,
    pub denoise: bool,
    pub exposure_ev: f32,
    pub file: FinalFile,
    pub on_gpu: bool,
}

impl Default for FinalDialog {
    fn default() -> FinalDialog {
        let trace = TraceOptions::default();
        FinalDialog {
            open: false,
            size: PictureSize::OfView,
            ground: trace.ground.map_or(Rgb::STONE, |ground| ground.colour),
            lamp: USUAL_LAMP,
            trace,
            denoise: true,
            exposure_ev: 0.0,
            file: FinalFile::default(),
            on_gpu: false,
        }
    }
}

impl FinalDialog {
    pub fn wanted(&self, view_px: UVec2) -> FinalRequest {
        FinalRequest {
            size: self.size.px(view_px),
            trace: self.trace,
            denoise: self.denoise,
            exposure_ev: self.exposure_ev,
            file: self.file,
            on_gpu: self.on_gpu,
        }
    }
}
