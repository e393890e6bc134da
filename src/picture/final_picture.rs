//! The final picture of a sculpture as a file: traced, denoised, and written as PNG, JPEG or OpenEXR.
//!
//! Takes contents, a shot and options, so that it can run on any thread; writes nothing unless all of it went well.
//! Knows no documents and no windows.

use std::path::Path;

use image::RgbImage;

use super::exr::{self, Channel, Samples};
use super::{PictureError, encoded};
use crate::format::store;
use crate::gpu::{Device, DeviceOptions, Headless};
use crate::progress::Progress;
use crate::render::{DeviceTraceError, trace_on_device};
use crate::sculpture::history::Contents;
use crate::shade::{NormalField, ShadeSource};
use crate::trace::{self, Film, PixelSum, TraceError, TraceOptions, TraceShot};

/// The extension of pictures of linear light.
pub const LINEAR_ENDING: &str = "exr";

/// What traces light.
#[derive(Clone, Debug, Default)]
pub enum TraceOn {
    /// All cores: the same picture on every run.
    #[default]
    Cpu,
    /// A Vulkan device: the same picture but for rounding.
    Gpu(DeviceOptions),
}

/// How a final picture is made.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FinalOptions {
    pub trace: TraceOptions,
    /// Whether the noise that remains is removed.
    pub denoise: bool,
    /// Doubles the light of PNG and JPEG with each unit.
    pub exposure_ev: f32,
}

impl Default for FinalOptions {
    fn default() -> Self {
        FinalOptions { trace: TraceOptions::default(), denoise: true, exposure_ev: 0.0 }
    }
}

/// Makes a final picture of `contents` and writes it to `path`, in the format of its extension.
pub fn write_final(
    contents: &Contents,
    shot: &TraceShot,
    options: &FinalOptions,
    on: &TraceOn,
    path: &Path,
    progress: &dyn Progress,
) -> Result<(), PictureError> {
    let normals = normals_of(contents, progress)?;
    let Contents { grid, material } = contents;
    let source = ShadeSource { grid, material, normals: &normals };
    let mut film = match on {
        TraceOn::Cpu => trace::trace(&source, shot, &options.trace, progress)?,
        TraceOn::Gpu(device) => on_device(&source, shot, &options.trace, device, progress)?,
    };
    if options.denoise {
        progress.begin("removing noise");
        film = trace::denoise(film);
        progress.end();
    }
    let ending = path.extension().unwrap_or("png".as_ref()).to_string_lossy().to_lowercase();
    let bytes = match ending == LINEAR_ENDING {
        true => linear_file(&film),
        false => encoded(&screen_picture(&film, options.exposure_ev), &ending)?,
    };
    if progress.is_cancelled() {
        return Err(TraceError::Cancelled.into());
    }
    store::write_atomically(path, &bytes)
        .map_err(|error| PictureError::Write { path: path.to_path_buf(), error })
}

fn on_device(
    source: &ShadeSource,
    shot: &TraceShot,
    options: &TraceOptions,
    device: &DeviceOptions,
    progress: &dyn Progress,
) -> Result<Film, PictureError> {
    let device = Device::new(&mut Headless, device).map_err(PictureError::TraceDevice)?;
    let film =
        trace_on_device(&device, source, shot, options, progress).map_err(|error| match error {
            DeviceTraceError::Gpu(error) => PictureError::TraceDevice(error),
            DeviceTraceError::Trace(error) => PictureError::Trace(error),
        })?;
    match device.validation_messages() {
        messages if messages.is_empty() => Ok(film),
        messages => Err(PictureError::Validation(messages.join("\n"))),
    }
}

fn normals_of(contents: &Contents, progress: &dyn Progress) -> Result<NormalField, TraceError> {
    progress.begin("finding normals");
    let mut normals = NormalField::default();
    normals.follow(&contents.grid, None);
    normals.update(&contents.grid, &mut Vec::new(), || !progress.is_cancelled());
    progress.end();
    if normals.is_complete() { Ok(normals) } else { Err(TraceError::Cancelled) }
}

fn screen_picture(film: &Film, exposure_ev: f32) -> RgbImage {
    let pixels = trace::display_pixels(film, exposure_ev);
    let width = pixels.size.x;
    RgbImage::from_fn(width, pixels.size.y, |x, y| {
        let [r, g, b, _] = pixels.rgba[(x + y * width) as usize];
        image::Rgb([r, g, b])
    })
}

/// Light, distance, and what compositing and other filters need: colours, normals, and the sculpture's share of each
/// pixel.
fn linear_file(film: &Film) -> Vec<u8> {
    let channel = |name, of: &dyn Fn(&PixelSum) -> f32| {
        let values = film.pixels().iter().map(of).collect();
        let samples = if name == "Z" { Samples::Float(values) } else { Samples::Half(values) };
        Channel { name, samples }
    };
    let channels = vec![
        channel("R", &|pixel| pixel.radiance.x),
        channel("G", &|pixel| pixel.radiance.y),
        channel("B", &|pixel| pixel.radiance.z),
        channel("Z", &|pixel| pixel.depth),
        channel("albedo.R", &|pixel| pixel.albedo.x),
        channel("albedo.G", &|pixel| pixel.albedo.y),
        channel("albedo.B", &|pixel| pixel.albedo.z),
        channel("normal.X", &|pixel| pixel.normal.x),
        channel("normal.Y", &|pixel| pixel.normal.y),
        channel("normal.Z", &|pixel| pixel.normal.z),
        channel("sculpture.A", &|pixel| pixel.alpha),
    ];
    exr::encoded(film.size(), channels)
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, UVec2, Vec3};

    use super::*;
    use crate::progress::Report;
    use crate::sculpture::{ColourDepth, Material, Rgb};
    use crate::view::Camera;

    fn subject() -> (Contents, TraceShot) {
        let grid = crate::scenes::solid_cube(16).unwrap();
        let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(200, 100, 50));
        let eye = Camera::framing(14.0, Vec3::ONE, Vec3::Y).eye(UVec2::new(24, 18));
        let world_from_grid = Affine3A::from_translation(Vec3::splat(-8.0));
        (Contents { grid, material }, TraceShot { eye, world_from_grid, up: Vec3::Y })
    }

    fn options(samples: u32) -> FinalOptions {
        let trace = TraceOptions { samples, ..TraceOptions::default() };
        FinalOptions { trace, ..FinalOptions::default() }
    }

    #[test]
    fn the_linear_file_has_the_light_that_the_other_shows() {
        let folder = tempfile::tempdir().unwrap();
        let (contents, shot) = subject();
        let [png, exr] = ["a.png", "a.EXR"].map(|name| folder.path().join(name));
        for path in [&png, &exr] {
            write_final(&contents, &shot, &options(4), &TraceOn::Cpu, path, &()).unwrap();
        }
        let (size, channels) = exr::tests::read(&std::fs::read(&exr).unwrap());
        assert_eq!(size, shot.eye.size);
        let shown = image::open(&png).unwrap().to_rgb8();
        let middle = (size.x / 2 + size.y / 2 * size.x) as usize;
        let pixel = shown.get_pixel(size.x / 2, size.y / 2).0;
        for (name, value) in ["R", "G", "B"].into_iter().zip(pixel) {
            let light = channels[name][middle];
            assert!(light < 0.8, "compressed otherwise");
            let expected = match light <= 0.003_130_8 {
                true => light * 12.92,
                false => 1.055 * light.powf(1.0 / 2.4) - 0.055,
            };
            assert!((expected * 255.0 - f64::from(value)).abs() < 1.0, "{name}: {light} {value}");
        }
        assert_eq!(channels["sculpture.A"][middle], 1.0);
        assert!((channels["albedo.R"][middle] - 0.578).abs() < 0.01);
        let expected = f64::from(shot.eye.position().length()) - 14.0;
        assert!((channels["Z"][middle] - expected).abs() < 3.0, "{}", channels["Z"][middle]);
    }

    #[test]
    fn a_cancelled_picture_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let (contents, shot) = subject();
        let report = Report::default();
        report.cancel();
        let path = folder.path().join("a.png");
        let result = write_final(&contents, &shot, &options(4), &TraceOn::Cpu, &path, &report);
        assert!(matches!(result, Err(PictureError::Trace(TraceError::Cancelled))), "{result:?}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
