//! The final picture of a sculpture as a file: traced, denoised, and written as PNG, JPEG or OpenEXR.
//!
//! Takes contents, a camera and options, so that it can run on any thread; writes nothing unless everything succeeds.
//! Knows no documents and no windows.

use std::path::Path;

use image::RgbImage;

use super::exr::{self, Channel, Samples};
use super::{PictureError, encoded};
use crate::format::store;
use crate::gpu::{Device, DeviceOptions, Headless};
use crate::progress::Progress;
use crate::render::{DeviceTraceError, trace_on_device};
use crate::sculpture::history::{Contents, SurfaceKind};
use crate::sculpture::{Grid, Limits};
use crate::shade::{LevelSet, NormalField, ShadeSource};
use crate::trace::{self, Film, PixelSum, TraceCamera, TraceError, TraceOptions};

/// The extension of pictures of linear light.
pub const LINEAR_ENDING: &str = "exr";

/// The processor of the path tracer.
#[derive(Clone, Debug, Default)]
pub enum TraceOn {
    /// All cores: the same picture on every run.
    #[default]
    Cpu,
    /// A Vulkan device: the same picture except for rounding.
    Gpu(DeviceOptions),
}

/// The options of a final picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FinalOptions {
    pub trace: TraceOptions,
    /// Shows the smooth surface where a voxel covers more than a pixel, for sculptures not shown as cubes. Not on a
    /// device.
    pub smooth_surface: bool,
    /// Removes the remaining noise.
    pub denoise: bool,
    /// Doubles the light of PNG and JPEG with each unit.
    pub exposure_ev: f32,
}

impl Default for FinalOptions {
    fn default() -> Self {
        let trace = TraceOptions::default();
        FinalOptions { trace, smooth_surface: true, denoise: true, exposure_ev: 0.0 }
    }
}

/// A final picture to be made.
#[derive(Clone, Copy)]
pub struct FinalPicture<'a> {
    pub contents: &'a Contents,
    pub camera: &'a TraceCamera,
    pub options: &'a FinalOptions,
    pub on: &'a TraceOn,
}

/// Makes a final picture and writes it to `path`, in the format of its extension. `watch` receives the sums so far and
/// their number of samples after each pass on the CPU.
pub fn write_final(
    picture: FinalPicture,
    path: &Path,
    progress: &dyn Progress,
    watch: &mut dyn FnMut(&Film, u32),
) -> Result<(), PictureError> {
    let FinalPicture { contents, camera, options, on } = picture;
    let is_smooth = options.smooth_surface && contents.surface == SurfaceKind::Smooth;
    if is_smooth && matches!(on, TraceOn::Gpu(_)) {
        return Err(PictureError::SmoothOnDevice);
    }
    let normals = normals_of(contents, progress)?;
    let Contents { grid, material, .. } = contents;
    let source = ShadeSource { grid, material, normals: &normals, mask: None };
    let mut film = match on {
        TraceOn::Cpu => {
            let rays = camera.eye.pixel_rays(&camera.world_from_grid);
            let is_smooth = is_smooth && LevelSet::shows(grid, &rays);
            let levels = if is_smooth { smooth_surface(grid, &normals) } else { None };
            let subject = (&source, levels.as_ref());
            trace::trace_watched(subject, camera, &options.trace, progress, watch)?
        }
        TraceOn::Gpu(device) => on_device(&source, camera, &options.trace, device, progress)?,
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
    camera: &TraceCamera,
    options: &TraceOptions,
    device: &DeviceOptions,
    progress: &dyn Progress,
) -> Result<Film, PictureError> {
    let device = Device::new(&mut Headless, device).map_err(PictureError::TraceDevice)?;
    let film =
        trace_on_device(&device, source, camera, options, progress).map_err(
            |error| match error {
                DeviceTraceError::Gpu(error) => PictureError::TraceDevice(error),
                DeviceTraceError::Trace(error) => PictureError::Trace(error),
            },
        )?;
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

/// Returns the smooth surface; `None` for a grid that is too large for it, as in pictures of the window.
fn smooth_surface(grid: &Grid, normals: &NormalField) -> Option<LevelSet> {
    let made = LevelSet::whole(grid, Limits::default().grid_bytes);
    let mut levels =
        made.inspect_err(|error| tracing::warn!("{error}; the final picture shows voxels")).ok()?;
    levels.update(grid, normals, &mut Vec::new());
    Some(levels)
}

fn screen_picture(film: &Film, exposure_ev: f32) -> RgbImage {
    let pixels = trace::display_pixels(film, exposure_ev);
    let width = pixels.size.x;
    RgbImage::from_fn(width, pixels.size.y, |x, y| {
        let [r, g, b, _] = pixels.rgba[(x + y * width) as usize];
        image::Rgb([r, g, b])
    })
}

/// Returns a file with light, distance, and the inputs of compositing and other filters: colours, normals, and the
/// sculpture's share of each pixel.
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
    use crate::progress::ProgressReport;
    use crate::sculpture::{ColourDepth, Material, Rgb};
    use crate::view::Camera;

    fn subject() -> (Contents, TraceCamera) {
        let grid = crate::scenes::solid_cube(16).unwrap();
        let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(200, 100, 50));
        let eye = Camera::framing(14.0, Vec3::ONE, Vec3::Y).eye(UVec2::new(24, 18));
        let world_from_grid = Affine3A::from_translation(Vec3::splat(-8.0));
        (Contents::new(grid, material), TraceCamera { eye, world_from_grid, up: Vec3::Y })
    }

    fn write(
        path: &Path,
        options: &FinalOptions,
        on: &TraceOn,
        progress: &dyn Progress,
    ) -> Result<(), PictureError> {
        let (contents, camera) = subject();
        let picture = FinalPicture { contents: &contents, camera: &camera, options, on };
        write_final(picture, path, progress, &mut |_, _| {})
    }

    fn options(samples: u32) -> FinalOptions {
        let trace = TraceOptions { samples, ..TraceOptions::default() };
        FinalOptions { trace, ..FinalOptions::default() }
    }

    #[test]
    fn the_linear_file_has_the_light_that_the_other_shows() {
        let folder = tempfile::tempdir().unwrap();
        let (_, camera) = subject();
        let [png, exr] = ["a.png", "a.EXR"].map(|name| folder.path().join(name));
        for path in [&png, &exr] {
            write(path, &options(4), &TraceOn::Cpu, &()).unwrap();
        }
        let (size, channels) = exr::tests::read(&std::fs::read(&exr).unwrap());
        assert_eq!(size, camera.eye.size);
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
        let expected = f64::from(camera.eye.position().length()) - 14.0;
        assert!((channels["Z"][middle] - expected).abs() < 3.0, "{}", channels["Z"][middle]);
    }

    #[test]
    fn a_cancelled_picture_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let report = ProgressReport::default();
        report.cancel();
        let path = folder.path().join("a.png");
        let result = write(&path, &options(4), &TraceOn::Cpu, &report);
        assert!(matches!(result, Err(PictureError::Trace(TraceError::Cancelled))), "{result:?}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn each_pass_is_shown_and_the_last_is_the_picture() {
        let folder = tempfile::tempdir().unwrap();
        let (contents, camera) = subject();
        let options = FinalOptions { denoise: false, ..options(3) };
        let path = folder.path().join("a.png");
        let mut shown = Vec::new();
        let watch = &mut |film: &Film, samples| {
            shown.push((samples, trace::preview_pixels(film, samples, 0.0)));
        };
        let (contents, camera, on) = (&contents, &camera, &TraceOn::Cpu);
        let picture = FinalPicture { contents, camera, options: &options, on };
        write_final(picture, &path, &(), watch).unwrap();
        assert_eq!(shown.iter().map(|(samples, _)| *samples).collect::<Vec<_>>(), [1, 2, 3]);
        let file = image::open(&path).unwrap().to_rgb8();
        let differs = |preview: &crate::shade::Pixels| {
            let pairs = preview.rgba.iter().zip(file.pixels());
            pairs.filter(|(a, b)| (0..3).any(|c| a[c].abs_diff(b[c]) > 1)).count()
        };
        assert_eq!(differs(&shown[2].1), 0);
        assert!(differs(&shown[0].1) > 100);
    }

    #[test]
    fn a_device_refuses_the_smooth_surface_by_naming_what_helps() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let on = TraceOn::Gpu(DeviceOptions::default());
        let error = write(&path, &options(1), &on, &()).unwrap_err();
        assert!(matches!(error, PictureError::SmoothOnDevice));
        assert!(error.to_string().contains("--voxels"), "{error}");
        assert!(!path.exists());
    }
}
