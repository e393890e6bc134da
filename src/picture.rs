//! Pictures of a document without a screen: sample, shade, compose with the background, write.
//!
//! Uses the samplers and the software shader of the window. A mode that samples on the GPU needs a
//! Vulkan device; the ray casters need none.

use std::path::{Path, PathBuf};

use glam::{Affine3A, Quat, UVec2, UVec3, Vec3};
use image::codecs::jpeg::JpegEncoder;
use image::{ImageError, Rgb, RgbImage};
use thiserror::Error;

use crate::document::Document;
use crate::format::store;
use crate::gpu::{Device, DeviceOptions, Frames, GpuError, Headless};
use crate::render::{Background, Fallback, FrameDesc, RenderMode, Renderer, StereoOptions};
use crate::screen::offscreen;
use crate::sculpture::Grid;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::shade::{Lighting, NormalField, Pixels, ShadePose, ShadeSource, SoftwareShader};
use crate::surface::{IndexMap, quickstep, raycast};
use crate::view::{Camera, Eye, StereoLayout};

/// Colours of the background at the upper and the lower edge, sRGB.
pub const BACKGROUND: [[u8; 3]; 2] = [[58, 64, 76], [24, 26, 31]];

/// Extensions of picture files.
pub const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// JPEG quality, of 100: keeps lines clean.
const JPEG_QUALITY: u8 = 92;

/// Why a picture could not be made.
#[derive(Debug, Error)]
pub enum PictureError {
    #[error("{0}; `--mode ray` renders without Vulkan")]
    Gpu(#[from] GpuError),
    #[error("Vulkan's validation layers complain:\n{0}")]
    Validation(String),
    #[error("cannot write the image {path}: {error}")]
    Write { path: PathBuf, error: std::io::Error },
    #[error("cannot encode the picture: {0}")]
    Encode(#[from] ImageError),
}

/// What pictures depend on besides document and view.
#[derive(Clone, Debug)]
pub struct PictureOptions {
    pub stereo: StereoOptions,
    pub lighting: Lighting,
    /// The device to make for a mode that needs one.
    pub device: DeviceOptions,
}

/// The view of a picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct View {
    pub size: UVec2,
    pub mode: RenderMode,
    /// From the centre of the bounding box to the eye, where `up` is y.
    pub direction: Vec3,
    /// The axis that points up in the picture.
    pub up: Vec3,
    /// The angle by which the sculpture is turned about `up`.
    pub turn_rad: f32,
    /// 1 fits the bounding box; more is closer.
    pub zoom: f32,
    pub fov_y_rad: f32,
    /// The layout of two eyes, which are those of [`PictureOptions::stereo`].
    pub stereo: StereoLayout,
}

impl View {
    /// The eye that frames the sculpture of `document`, and the pose of its grid.
    fn frame(&self, document: &Document) -> (Eye, Affine3A) {
        let world_from_grid = Affine3A::from_quat(Quat::from_axis_angle(self.up, self.turn_rad))
            * document.world_from_grid();
        let mut corners = outline(document.grid());
        corners.iter_mut().for_each(|corner| *corner = world_from_grid.transform_point3(*corner));
        let direction = Quat::from_rotation_arc(Vec3::Y, self.up) * self.direction;
        let aspect = self.size.x as f32 / self.size.y as f32;
        let (up, fov) = (self.up, self.fov_y_rad);
        let camera = Camera::framing_points(&corners, direction, up, fov, aspect, self.zoom);
        (camera.eye(self.size), world_from_grid)
    }
}

/// Points around the sculpture, in grid coordinates: the corners of the first and the last brick in
/// use of every row, clipped to the bounding box. The corners of the grid if it is empty.
fn outline(grid: &Grid) -> Vec<Vec3> {
    let (min, max) = grid.opaque_bounds().unwrap_or((UVec3::ZERO, grid.dims()));
    let corners = |low: UVec3, high: UVec3| {
        (0..8).map(move |i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
            UVec3::new(pick(0), pick(1), pick(2)).as_vec3()
        })
    };
    let mut points = Vec::new();
    let UVec3 { y: height, z: depth, .. } = grid.brick_dims();
    for (y, z) in (0..depth).flat_map(|z| (0..height).map(move |y| (y, z))) {
        let mut row = grid.nonempty_in_row(y, z).map(|(x, _)| x);
        for x in row.next().into_iter().chain(row.last()) {
            let low = UVec3::new(x, y, z) * BRICK_EDGE_VX;
            points.extend(corners(low.max(min), (low + BRICK_EDGE_VX).min(max)));
        }
    }
    if points.is_empty() {
        points.extend(corners(min, max));
    }
    points
}

/// Renders `document`: one picture, or with [`StereoLayout::Layers`] one for each eye.
pub fn render(
    document: &mut Document,
    view: &View,
    options: &PictureOptions,
) -> Result<Vec<RgbImage>, PictureError> {
    let (mono, world_from_grid) = view.frame(document);
    let eyes = match view.stereo {
        StereoLayout::Mono => vec![mono],
        _ => {
            let centre = world_from_grid.transform_point3(outline_middle(document.grid()));
            let distance = -mono.eye_from_world.transform_point3(centre).z;
            options.stereo.rig(distance.max(f32::MIN_POSITIVE)).eyes(&mono).to_vec()
        }
    };
    let pictures = match view.mode.needs_device() {
        true => render_on_device(document, view, &eyes, world_from_grid, options)?,
        false => render_by_casting(document, view.mode, &eyes, world_from_grid, &options.lighting),
    };
    Ok(match (view.stereo, pictures.as_slice()) {
        (StereoLayout::Mono | StereoLayout::Layers, _) => pictures,
        (layout, [left, right]) => {
            let seen = |eye: usize, at: UVec2| [left, right][eye].get_pixel(at.x, at.y).0;
            let pixel = |x, y| Rgb(layout.pixel(UVec2::new(x, y), view.size, 0, seen));
            vec![RgbImage::from_fn(view.size.x, view.size.y, pixel)]
        }
        _ => pictures,
    })
}

/// Renders to a file, PNG or JPEG by its extension, or to two with `.left` and `.right` before it;
/// a file appears only when it is complete. Returns the paths.
pub fn render_to_file(
    document: &mut Document,
    view: &View,
    options: &PictureOptions,
    path: &Path,
) -> Result<Vec<PathBuf>, PictureError> {
    let pictures = render(document, view, options)?;
    let ending = path.extension().unwrap_or("png".as_ref()).to_string_lossy().into_owned();
    let of_eye = |eye: &str| path.with_extension(format!("{eye}.{ending}"));
    let names = match pictures.len() {
        1 => vec![path.to_path_buf()],
        _ => vec![of_eye("left"), of_eye("right")],
    };
    for (picture, path) in pictures.iter().zip(&names) {
        store::write_atomically(path, &encoded(picture, &ending)?)
            .map_err(|error| PictureError::Write { path: path.clone(), error })?;
    }
    Ok(names)
}

fn encoded(picture: &RgbImage, ending: &str) -> Result<Vec<u8>, ImageError> {
    let mut file = std::io::Cursor::new(Vec::new());
    match ending.to_ascii_lowercase().as_str() {
        "jpg" | "jpeg" => {
            picture.write_with_encoder(JpegEncoder::new_with_quality(&mut file, JPEG_QUALITY))?;
        }
        _ => picture.write_to(&mut file, image::ImageFormat::Png)?,
    }
    Ok(file.into_inner())
}

/// Renders without Vulkan.
fn render_by_casting(
    document: &Document,
    mode: RenderMode,
    eyes: &[Eye],
    world_from_grid: Affine3A,
    lighting: &Lighting,
) -> Vec<RgbImage> {
    let normals = NormalField::of(document.grid());
    let cast = |eye| cast_eye(document, &normals, mode, eye, world_from_grid, lighting);
    eyes.iter().map(cast).collect()
}

fn cast_eye(
    document: &Document,
    normals: &NormalField,
    mode: RenderMode,
    eye: &Eye,
    world_from_grid: Affine3A,
    lighting: &Lighting,
) -> RgbImage {
    let rays = eye.pixel_rays(&world_from_grid);
    let mut map = IndexMap::new(rays);
    match mode {
        RenderMode::Quickstep => quickstep::sample(document.grid(), &rays, &mut map),
        _ => raycast::sample(document.grid(), &rays, &mut map),
    }
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    let mut pixels = Pixels::new(eye.size);
    let source = ShadeSource { grid: document.grid(), material: document.material(), normals };
    SoftwareShader::default().shade(&map, &source, &pose, lighting, &mut pixels);
    over_background(&pixels)
}

/// Renders on a device made for this picture. A sculpture that is too large for the device in this
/// mode is rendered in the fallback mode.
fn render_on_device(
    document: &mut Document,
    view: &View,
    eyes: &[Eye],
    world_from_grid: Affine3A,
    options: &PictureOptions,
) -> Result<Vec<RgbImage>, PictureError> {
    let device = Device::new(&mut Headless, &options.device)?;
    let mut renderer = Renderer::new(&device, offscreen::FORMAT)?;
    let mut frames = Frames::new(&device)?;
    let [top, bottom] = BACKGROUND.map(|rgb| Vec3::from(rgb.map(f32::from)) / 255.0);
    let desc = FrameDesc {
        eyes,
        world_from_grid,
        mode: view.mode,
        lighting: options.lighting,
        background: Background::Gradient { top, bottom },
        video: None,
        previews: &[],
        lines: &[],
    };
    let mut recorder = frames.begin()?;
    // What needs no device is cast without the limits of this one.
    let paints = RenderMode::needs_device;
    let slot = frames.slot();
    let report = renderer.paint_with_fallback(&mut recorder, slot, document, &desc, paints)?;
    for Fallback { reason, to } in &report.fallbacks {
        tracing::warn!("{reason}; rendering by {}", to.label());
    }
    if !report.painted {
        return Ok(render_by_casting(
            document,
            report.mode,
            eyes,
            world_from_grid,
            &options.lighting,
        ));
    }
    frames.submit(recorder, &[], &[])?;
    let pictures = renderer.read_back()?;
    match device.validation_messages() {
        messages if messages.is_empty() => {}
        messages => return Err(PictureError::Validation(messages.join("\n"))),
    }
    Ok(pictures.iter().map(without_alpha).collect())
}

fn without_alpha(pixels: &Pixels) -> RgbImage {
    let UVec2 { x: width, y: height } = pixels.size;
    RgbImage::from_fn(width, height, |x, y| {
        let [r, g, b, _] = pixels.rgba[(x + y * width) as usize];
        Rgb([r, g, b])
    })
}

/// The centre of the bounding box, in grid coordinates.
fn outline_middle(grid: &Grid) -> Vec3 {
    let (min, max) = grid.opaque_bounds().unwrap_or((UVec3::ZERO, grid.dims()));
    (min.as_vec3() + max.as_vec3()) * 0.5
}

/// Composes shaded pixels with the background gradient.
fn over_background(pixels: &Pixels) -> RgbImage {
    let UVec2 { x: width, y: height } = pixels.size;
    RgbImage::from_fn(width, height, |x, y| {
        let [r, g, b, a] = pixels.rgba[(x + y * width) as usize];
        let share = (y as f32 + 0.5) / height as f32;
        let behind = |c: usize| {
            let [top, bottom] = BACKGROUND.map(|colour| f32::from(colour[c]));
            (top + (bottom - top) * share).round() as u8
        };
        let mix = |front: u8, c: usize| {
            let (front, behind, a) = (u32::from(front), u32::from(behind(c)), u32::from(a));
            ((front * a + behind * (255 - a) + 127) / 255) as u8
        };
        Rgb([mix(r, 0), mix(g, 1), mix(b, 2)])
    })
}
