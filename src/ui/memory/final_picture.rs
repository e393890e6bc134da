//! Remembers the options of the dialog of a final picture: quality and light. The size is not remembered: it is that of
//! the view.

use serde::{Deserialize, Serialize};

use crate::trace::{
    AreaLight, LightOptions, MAX_BOUNCES, MAX_FINAL_SAMPLES, SunLight, TraceGround, TraceOptions,
};
use crate::ui::dialogs::final_choices::FinalDialog;
use crate::ui::memory::values::{neat, within};
use crate::ui::pictures::FinalFile;

/// All choices. Missing or invalid ones get their defaults.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptFinal {
    samples: Option<u32>,
    bounces: Option<u32>,
    denoise: Option<bool>,
    exposure_ev: Option<f64>,
    file: Option<String>,
    on_gpu: Option<bool>,
    /// Azimuth, elevation and size in degrees, strength.
    sun: Option<[f64; 4]>,
    sky: Option<f64>,
    has_lamp: Option<bool>,
    /// Azimuth and elevation in degrees, size, strength.
    lamp: Option<[f64; 4]>,
    has_ground: Option<bool>,
    ground: Option<String>,
    aperture: Option<f64>,
}

impl KeptFinal {
    pub fn of(dialog: &FinalDialog) -> KeptFinal {
        let TraceOptions { samples, bounces, light, ground, lens } = dialog.trace;
        let AreaLight { azimuth_deg, elevation_deg, size, strength } = dialog.lamp;
        let mut kept = KeptFinal {
            samples: Some(samples),
            bounces: Some(bounces),
            denoise: Some(dialog.denoise),
            exposure_ev: Some(neat(dialog.exposure_ev)),
            file: Some(dialog.file.ending().to_string()),
            on_gpu: Some(dialog.on_gpu),
            lamp: Some([azimuth_deg, elevation_deg, size, strength].map(neat)),
            has_ground: Some(ground.is_some()),
            ground: Some(dialog.ground.to_string()),
            aperture: Some(neat(lens.aperture)),
            ..KeptFinal::default()
        };
        if let LightOptions::Outdoors { sun, sky, area_light } = light {
            let SunLight { azimuth_deg, elevation_deg, size_deg, strength } = sun;
            kept.sun = Some([azimuth_deg, elevation_deg, size_deg, strength].map(neat));
            kept.sky = Some(neat(sky));
            kept.has_lamp = Some(area_light.is_some());
        }
        kept
    }

    /// Restores the choices.
    pub fn recall(self, dialog: &mut FinalDialog) {
        let TraceOptions { samples, bounces, light, ground, lens } = &mut dialog.trace;
        let count = |kept: Option<u32>, range: std::ops::RangeInclusive<u32>, usual: u32| {
            kept.filter(|kept| range.contains(kept)).unwrap_or(usual)
        };
        *samples = count(self.samples, 1..=MAX_FINAL_SAMPLES, *samples);
        *bounces = count(self.bounces, 0..=MAX_BOUNCES, *bounces);
        dialog.denoise = self.denoise.unwrap_or(dialog.denoise);
        dialog.exposure_ev = within(self.exposure_ev, -10.0..=10.0, dialog.exposure_ev);
        let of_name = |file: &FinalFile| self.file.as_deref() == Some(file.ending());
        dialog.file = FinalFile::ALL.into_iter().find(of_name).unwrap_or(dialog.file);
        dialog.on_gpu = self.on_gpu.unwrap_or(dialog.on_gpu);
        lens.aperture = within(self.aperture, 0.0..=0.5, lens.aperture);

        let nth = |kept: &Option<[f64; 4]>, i: usize| kept.map(|values| values[i]);
        let AreaLight { azimuth_deg, elevation_deg, size, strength } = &mut dialog.lamp;
        *azimuth_deg = within(nth(&self.lamp, 0), -180.0..=180.0, *azimuth_deg);
        *elevation_deg = within(nth(&self.lamp, 1), -90.0..=90.0, *elevation_deg);
        *size = within(nth(&self.lamp, 2), 0.01..=5.0, *size);
        *strength = within(nth(&self.lamp, 3), 0.0..=10.0, *strength);
        if let LightOptions::Outdoors { sun, sky, area_light } = light {
            let SunLight { azimuth_deg, elevation_deg, size_deg, strength } = sun;
            *azimuth_deg = within(nth(&self.sun, 0), -180.0..=180.0, *azimuth_deg);
            *elevation_deg = within(nth(&self.sun, 1), 0.0..=90.0, *elevation_deg);
            *size_deg = within(nth(&self.sun, 2), 0.2..=60.0, *size_deg);
            *strength = within(nth(&self.sun, 3), 0.0..=10.0, *strength);
            *sky = within(self.sky, 0.0..=10.0, *sky);
            *area_light = self.has_lamp.unwrap_or(false).then_some(dialog.lamp);
        }
        let colour = self.ground.and_then(|text| text.parse().ok());
        dialog.ground = colour.unwrap_or(dialog.ground);
        let has_ground = self.has_ground.unwrap_or(ground.is_some());
        *ground = has_ground.then_some(TraceGround { colour: dialog.ground });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed() -> FinalDialog {
        let mut dialog = FinalDialog { denoise: false, exposure_ev: -1.5, ..Default::default() };
        dialog.trace.samples = 300;
        dialog.trace.bounces = 3;
        dialog.trace.ground = None;
        dialog.trace.lens.aperture = 0.04;
        dialog.file = FinalFile::Exr;
        dialog.lamp.strength = 2.5;
        let LightOptions::Outdoors { sun, area_light, .. } = &mut dialog.trace.light else {
            panic!()
        };
        sun.elevation_deg = 12.5;
        *area_light = Some(dialog.lamp);
        dialog
    }

    #[test]
    fn choices_are_restored() {
        let before = changed();
        let text = toml::to_string(&KeptFinal::of(&before)).unwrap();
        let mut after = FinalDialog::default();
        toml::from_str::<KeptFinal>(&text).unwrap().recall(&mut after);
        assert_eq!(after, before);
    }

    #[test]
    fn nonsense_is_as_usual() {
        let text = "samples = 0\nbounces = 65\nexposure_ev = nan\nfile = \"x\"\nsky = -1.0\n\
                    aperture = inf\nsun = [1e9, -1.0, 0.0, nan]\nground = \"none\"\n\
                    lamp = [nan, 100.0, 0.0, -1.0]";
        let mut after = FinalDialog::default();
        toml::from_str::<KeptFinal>(text).unwrap().recall(&mut after);
        assert_eq!(after, FinalDialog::default());
    }
}
