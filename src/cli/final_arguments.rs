//! The arguments of `render --quality final`.

use std::path::Path;

use clap::{Args, ValueEnum};
use glam::Vec2;

use super::PictureArgs;
use super::error::ArgumentError;
use crate::picture::{FinalOptions, LINEAR_ENDING};
use crate::trace::{
    AreaLight, Lens, LightOptions, MAX_BOUNCES, SunLight, TraceGround, TraceOptions,
};

/// How much time a picture may take.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, ValueEnum)]
pub enum Quality {
    /// As the window shows it
    #[default]
    Normal,
    /// By tracing light: shadows, reflected light, a lens
    Final,
}

/// The processor that traces light.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Tracer {
    /// All cores: the same picture on every run
    Cpu,
    /// The Vulkan device of the settings, with --voxels: the same picture except for rounding
    Gpu,
}

/// A final picture.
#[derive(Args, Debug, Clone, Default)]
#[command(next_help_heading = "Final picture")]
pub struct FinalArgs {
    /// How the picture is made; in final quality, `--samples` is the number of rays per pixel, 1 to 4096
    /// (default: 64)
    #[arg(long, value_enum, default_value_t)]
    pub quality: Quality,
    /// Direction of the sun: degrees from behind the viewer to the right, degrees above the horizon
    /// (default: -50,42)
    #[arg(long, value_name = "AZIMUTH,ELEVATION", allow_hyphen_values = true, value_parser = parse_sun)]
    pub sun: Option<[f32; 2]>,
    /// Diameter of the sun in degrees, 0.2 to 60: the larger, the softer its shadows (default: 2)
    #[arg(long, value_name = "DEG", value_parser = |text: &str| parse_number(text, 0.2, 60.0))]
    pub sun_size: Option<f32>,
    /// Strength of the sun, 0 to 10 (default: 1)
    #[arg(long, value_name = "FACTOR", value_parser = |text: &str| parse_number(text, 0.0, 10.0))]
    pub sun_strength: Option<f32>,
    /// Strength of the sky, 0 to 10 (default: 1)
    #[arg(long, value_name = "FACTOR", value_parser = |text: &str| parse_number(text, 0.0, 10.0))]
    pub sky: Option<f32>,
    /// A square lamp: azimuth and elevation as for the sun, edge in radii of the sculpture, and strength, where 1
    /// is about that of the sun
    #[arg(long, value_name = "AZIMUTH,ELEVATION,SIZE,STRENGTH", allow_hyphen_values = true,
          value_parser = parse_area_light)]
    pub area_light: Option<AreaLight>,
    /// Depth of field: diameter of the lens in percent of the focus distance, 0 to 50 (default: 0)
    #[arg(long, value_name = "PERCENT", value_parser = |text: &str| parse_number(text, 0.0, 50.0))]
    pub aperture: Option<f32>,
    /// Focus point in the picture, as shares of its width and height from the upper left
    /// (default: 0.5,0.5)
    #[arg(long, value_name = "X,Y", value_parser = parse_focus)]
    pub focus: Option<Vec2>,
    /// Maximum number of reflections of light, 0 to 64 (default: 8)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(MAX_BOUNCES)))]
    pub bounces: Option<u32>,
    /// Exposure of .png and .jpg: each unit doubles the light, -10 to 10 (default: 0)
    #[arg(long, value_name = "EV", allow_hyphen_values = true,
          value_parser = |text: &str| parse_number(text, -10.0, 10.0))]
    pub exposure: Option<f32>,
    /// Processor that traces light (default: cpu); a GPU traces voxels only: add --voxels
    #[arg(long, value_enum)]
    pub trace_on: Option<Tracer>,
    /// Do not filter the remaining noise
    #[arg(long)]
    pub no_denoise: bool,
}

impl FinalArgs {
    /// Returns the options of a final picture; `None` for normal quality.
    pub fn options(
        &self,
        picture: &PictureArgs,
        out: &Path,
    ) -> Result<Option<FinalOptions>, ArgumentError> {
        if self.quality == Quality::Normal {
            let linear = out.extension().is_some_and(|e| e.eq_ignore_ascii_case(LINEAR_ENDING));
            return match self.first_given() {
                Some(name) => Err(ArgumentError::FinalOnly(name)),
                None if linear => Err(ArgumentError::LinearFile),
                None => Ok(None),
            };
        }
        for (given, name) in
            [(picture.mode.is_some(), "mode"), (picture.stereo.is_some(), "stereo")]
        {
            if given {
                return Err(ArgumentError::NotFinal(name));
            }
        }
        let mut options = FinalOptions::default();
        let TraceOptions { samples, bounces, ground, lens, light } = &mut options.trace;
        *samples = picture.samples.unwrap_or(*samples);
        *bounces = self.bounces.unwrap_or(*bounces);
        if let Some(choice) = picture.ground {
            *ground = choice.colour().map(|colour| TraceGround { colour });
        }
        *lens = Lens {
            aperture: self.aperture.map_or(lens.aperture, |percent| percent / 100.0),
            focus: self.focus.unwrap_or(lens.focus),
        };
        if let LightOptions::Outdoors { sun, sky, area_light } = light {
            let [azimuth_deg, elevation_deg] =
                self.sun.unwrap_or([sun.azimuth_deg, sun.elevation_deg]);
            *sun = SunLight {
                azimuth_deg,
                elevation_deg,
                size_deg: self.sun_size.unwrap_or(sun.size_deg),
                strength: self.sun_strength.unwrap_or(sun.strength),
            };
            *sky = self.sky.unwrap_or(*sky);
            *area_light = self.area_light.or(*area_light);
        }
        options.exposure_ev = self.exposure.unwrap_or(options.exposure_ev);
        options.denoise &= !self.no_denoise;
        Ok(Some(options))
    }

    /// Returns the name of an argument that was given, if any.
    fn first_given(&self) -> Option<&'static str> {
        let given = [
            (self.sun.is_some(), "sun"),
            (self.sun_size.is_some(), "sun-size"),
            (self.sun_strength.is_some(), "sun-strength"),
            (self.sky.is_some(), "sky"),
            (self.area_light.is_some(), "area-light"),
            (self.aperture.is_some(), "aperture"),
            (self.focus.is_some(), "focus"),
            (self.bounces.is_some(), "bounces"),
            (self.exposure.is_some(), "exposure"),
            (self.trace_on.is_some(), "trace-on"),
            (self.no_denoise, "no-denoise"),
        ];
        given.into_iter().find(|(given, _)| *given).map(|(_, name)| name)
    }
}

fn parse_number(text: &str, least: f32, most: f32) -> Result<f32, String> {
    match text.trim().parse::<f32>() {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => Err(format!("must be {least} to {most}")),
    }
}

/// Parses as many numbers as there are ranges, separated by commas.
fn parse_numbers<const N: usize>(text: &str, ranges: [[f32; 2]; N]) -> Option<[f32; N]> {
    let parts: Vec<&str> = text.split(',').collect();
    let parts = <[&str; N]>::try_from(parts).ok()?;
    let mut numbers = [0.0; N];
    for ((number, part), [least, most]) in numbers.iter_mut().zip(parts).zip(ranges) {
        *number = parse_number(part, least, most).ok()?;
    }
    Some(numbers)
}

fn parse_sun(text: &str) -> Result<[f32; 2], String> {
    let wrong = "write it as AZIMUTH,ELEVATION: -360 to 360 and 0 to 90 degrees";
    parse_numbers(text, [[-360.0, 360.0], [0.0, 90.0]]).ok_or_else(|| wrong.to_string())
}

fn parse_area_light(text: &str) -> Result<AreaLight, String> {
    let ranges = [[-360.0, 360.0], [-90.0, 90.0], [0.01, 5.0], [0.0, 100.0]];
    let wrong = "write it as AZIMUTH,ELEVATION,SIZE,STRENGTH: -360 to 360 and -90 to 90 degrees, 0.01 to 5 radii, \
                 0 to 100";
    let [azimuth_deg, elevation_deg, size, strength] =
        parse_numbers(text, ranges).ok_or_else(|| wrong.to_string())?;
    Ok(AreaLight { azimuth_deg, elevation_deg, size, strength })
}

fn parse_focus(text: &str) -> Result<Vec2, String> {
    let wrong = "write it as X,Y: 0 to 1 each";
    parse_numbers(text, [[0.0, 1.0]; 2]).map(Vec2::from).ok_or_else(|| wrong.to_string())
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Arguments {
        #[command(flatten)]
        picture: PictureArgs,
        #[command(flatten)]
        last: FinalArgs,
    }

    fn options(arguments: &str) -> Result<Option<FinalOptions>, String> {
        let words = ["program"].into_iter().chain(arguments.split_whitespace());
        let arguments = Arguments::try_parse_from(words).map_err(|error| error.to_string())?;
        let out = Path::new("a.png");
        arguments.last.options(&arguments.picture, out).map_err(|error| error.to_string())
    }

    #[test]
    fn final_pictures_have_their_own_defaults() {
        assert_eq!(options(""), Ok(None));
        assert_eq!(options("--quality final"), Ok(Some(FinalOptions::default())));
        let given = options(
            "--quality final --samples 4096 --sun -20,0 --sun-size 5 --area-light 10,-20,2,3 --ground none \
             --aperture 4 --focus 0,1 --no-denoise",
        );
        let FinalOptions { trace, denoise, .. } = given.unwrap().unwrap();
        assert_eq!((trace.samples, trace.ground, denoise), (4096, None, false));
        assert_eq!(trace.lens, Lens { aperture: 0.04, focus: Vec2::Y });
        let LightOptions::Outdoors { sun, area_light: Some(lamp), .. } = trace.light else {
            panic!("sun and lamp")
        };
        assert_eq!((sun.azimuth_deg, sun.elevation_deg, sun.size_deg), (-20.0, 0.0, 5.0));
        assert_eq!((lamp.size, lamp.strength), (2.0, 3.0));
    }

    #[test]
    fn senseless_arguments_are_refused_by_name() {
        for (arguments, why) in [
            ("--sun 1,2", "--sun applies to final pictures only"),
            ("--trace-on gpu", "--trace-on applies to final pictures only"),
            ("--no-denoise", "--no-denoise applies to final pictures only"),
            ("--quality final --mode ray", "--mode does not apply to final pictures"),
            ("--quality final --stereo anaglyph", "--stereo does not apply"),
            ("--quality final --samples 4097", "4097 is not in 1..=4096"),
            ("--quality final --sun 1", "AZIMUTH,ELEVATION"),
            ("--quality final --sun 1,-5", "0 to 90"),
            ("--quality final --sun NaN,5", "-360 to 360"),
            ("--quality final --sun-size 0", "must be 0.2 to 60"),
            ("--quality final --aperture inf", "must be 0 to 50"),
            ("--quality final --focus 0.5,1.5", "0 to 1 each"),
            ("--quality final --ground blue", "or none"),
            ("--quality final --area-light 1,2,3", "SIZE,STRENGTH"),
            ("--quality final --bounces 65", "65 is not in 0..=64"),
            ("--quality best", "possible values: normal, final"),
        ] {
            let error = options(arguments).unwrap_err();
            assert!(error.contains(why), "{arguments}: {error}");
        }
    }
}
