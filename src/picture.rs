//! Pictures of a document without a screen: sample, shade, compose with the background, write.
//!
//! An antialiased picture is the mean ([`mean`]) of samples, each a picture of its own by the same mode.
//! Uses the samplers and the software shader of the window. A mode that samples on the GPU needs a
//! Vulkan device; the ray casters need none.

use std::path::{Path, PathBuf};

use glam::{Affine3A, Quat, UVec2, UVec3, Vec2, Vec3};
use image::codecs::jpeg::JpegEncoder;
use image::{ImageError, Rgb, RgbImage};
use thiserror::Error;

use crate::document::Document;
use crate::format::store;
use crate::gpu::{DeviceOptions, GpuError, Readback};
use crate::render::{Background, Fallback, FrameDesc, RenderMode, SmoothSurface, StereoOptions};
use crate::sculpture::Grid;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::history::SurfaceKind;
use crate::shade::ground::GroundShader;
use crate::shade::{
    Ground, LevelSampler, LevelSet, Lighting, Pixels, ShadePose, ShadeSource, SoftwareShader,
};
use crate::surface::{IndexMap, quickstep, raycast};
use crate::trace::TraceError;
use crate::view::{Camera, Eye, FRAME_MARGIN, StereoLayout};

mod exr;
mod final_picture;
mod maker;
mod mean;

pub use final_picture::{FinalOptions, FinalPicture, LINEAR_ENDING, TraceOn, write_final};
pub use maker::PictureMaker;

use maker::{FollowedNormals, PictureDevice};
use mean::PictureMean;

/// Colours of the background at the upper and the lower edge, sRGB.
pub const BACKGROUND: [[u8; 3]; 2] = [[58, 64, 76], [24, 26, 31]];

/// Extensions of picture files.
pub const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// Extensions of files of final pictures.
pub const FINAL_ENDINGS: [&str; 4] = ["png", "jpg", "jpeg", LINEAR_ENDING];

/// JPEG quality, of 100: keeps lines clean.
const JPEG_QUALITY: u8 = 92;

/// The reason why a picture could not be made.
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
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// `--trace-on gpu` without a suitable device.
    #[error("{0}; `--trace-on cpu` needs no Vulkan")]
    TraceDevice(GpuError),
    #[error(
        "`--trace-on gpu` traces voxels, not the smooth surface between them; add `--voxels`, or trace on the CPU"
    )]
    SmoothOnDevice,
}

/// The options of pictures, besides document and view.
#[derive(Clone, Debug)]
pub struct PictureOptions {
    pub stereo: StereoOptions,
    pub lighting: Lighting,
    /// The device to make for a mode that needs one.
    pub device: DeviceOptions,
}

/// The view of a picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PictureView {
    pub size: UVec2,
    pub mode: RenderMode,
    /// Draws the smooth surface where a voxel covers more than a pixel, in modes that can.
    pub smooth_surface: bool,
    /// From the centre of the bounding box to the eye, with y along `up`.
    pub direction: Vec3,
    /// The axis that points up in the picture, to the sky.
    pub up: Vec3,
    /// The angle by which the sculpture is turned about `up`.
    pub turn_rad: f32,
    /// 1 fits the bounding box; more is closer.
    pub zoom: f32,
    /// Uses parallel projection.
    pub orthographic: bool,
    pub fov_y_rad: f32,
    /// The layout of the two eyes of [`PictureOptions::stereo`].
    pub stereo: StereoLayout,
    /// The ground below the sculpture.
    pub ground: Option<Ground>,
    /// The picture is the mean of so many samples: from 1, without antialiasing, to [`crate::view::MAX_SAMPLES`].
    pub samples: u32,
}

/// The camera of a picture, relative to the sculpture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct CameraPlacement {
    /// In a stereo picture, the one between the two.
    pub eye: Eye,
    pub world_from_grid: Affine3A,
    /// From the eye to the middle of the sculpture, along the line of sight.
    pub distance: f32,
}

impl PictureView {
    /// Returns the placement of the camera that frames the sculpture of `document`.
    pub fn placement(&self, document: &Document) -> CameraPlacement {
        let world_from_grid = Affine3A::from_quat(Quat::from_axis_angle(self.up, self.turn_rad))
            * document.world_from_grid();
        let mut corners = outline(document.grid());
        corners.iter_mut().for_each(|corner| *corner = world_from_grid.transform_point3(*corner));
        let eye = self.camera(&corners, voxel_edge(&world_from_grid)).eye(self.size);
        let centre = world_from_grid.transform_point3(outline_middle(document.grid()));
        CameraPlacement {
            eye,
            world_from_grid,
            distance: -eye.eye_from_world.transform_point3(centre).z,
        }
    }

    /// Returns the lighting of the options, with the sky along this view's `up`.
    fn lighting(&self, options: &PictureOptions) -> Lighting {
        Lighting { up: self.up, ..options.lighting }
    }

    /// Returns the camera that frames points of the world, for voxels with edges of this length.
    pub fn camera(&self, points: &[Vec3], voxel_edge: f32) -> Camera {
        let direction = Quat::from_rotation_arc(Vec3::Y, self.up) * self.direction;
        let aspect = self.size.x as f32 / self.size.y as f32;
        let (up, fov) = (self.up, self.fov_y_rad);
        let camera = Camera::framing_points(points, direction, up, fov, aspect, self.zoom);
        match self.orthographic {
            true => self.orthographic_camera(&camera, points, voxel_edge),
            false => camera,
        }
    }

    /// Returns the orthographic camera that looks like `camera` and frames the same points: with parallel rays, points
    /// behind the middle look as large as those before it.
    fn orthographic_camera(&self, camera: &Camera, points: &[Vec3], voxel_edge: f32) -> Camera {
        let Eye { eye_from_world, projection, .. } = camera.eye(self.size);
        let scale = Vec2::new(projection.x_axis.x, projection.y_axis.y).abs();
        let reach = |point: &Vec3| {
            (eye_from_world.transform_point3(*point).truncate().abs() * scale).max_element()
        };
        let distance = points.iter().map(reach).fold(f32::MIN_POSITIVE, f32::max);
        let towards_eye = (camera.eye - camera.target).normalize_or(Vec3::Z);
        let eye = camera.target + towards_eye * (distance * FRAME_MARGIN / self.zoom);
        let radii = points.iter().map(|point| point.distance(camera.target));
        let diameter = 2.0 * radii.fold(f32::MIN_POSITIVE, f32::max);
        Camera { eye, ..*camera }.orthographic(diameter, diameter / voxel_edge)
    }
}

/// Returns the mean length of a voxel's edges in the world.
pub fn voxel_edge(world_from_grid: &Affine3A) -> f32 {
    world_from_grid.matrix3.determinant().abs().cbrt().max(f32::MIN_POSITIVE)
}

/// Returns points around the sculpture, in grid coordinates: the corners of the first and the last brick in use of
/// every row, clipped to the bounding box. For an empty grid, returns its corners.
pub fn outline(grid: &Grid) -> Vec<Vec3> {
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
    view: &PictureView,
    options: &PictureOptions,
) -> Result<Vec<RgbImage>, PictureError> {
    PictureMaker::new(options).make(document, view, &view.placement(document))
}

/// Combines the pictures of two eyes into one, unless the layout keeps them apart.
fn compose_eyes(pictures: Vec<RgbImage>, view: &PictureView) -> Vec<RgbImage> {
    match (view.stereo, pictures.as_slice()) {
        (StereoLayout::Mono | StereoLayout::Layers, _) => pictures,
        (layout, [left, right]) => {
            let seen = |eye: usize, at: UVec2| [left, right][eye].get_pixel(at.x, at.y).0;
            let pixel = |x, y| Rgb(layout.pixel(UVec2::new(x, y), view.size, 0, seen));
            vec![RgbImage::from_fn(view.size.x, view.size.y, pixel)]
        }
        _ => pictures,
    }
}

/// Renders to a file, PNG or JPEG by its extension, or to two with `.left` and `.right` before it. A file appears only
/// when it is complete. Returns the paths.
pub fn render_to_file(
    document: &mut Document,
    view: &PictureView,
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

/// Returns the bytes of a picture file of this extension.
pub fn encoded(picture: &RgbImage, ending: &str) -> Result<Vec<u8>, ImageError> {
    let mut file = std::io::Cursor::new(Vec::new());
    match ending.to_ascii_lowercase().as_str() {
        "jpg" | "jpeg" => {
            picture.write_with_encoder(JpegEncoder::new_with_quality(&mut file, JPEG_QUALITY))?;
        }
        _ => picture.write_to(&mut file, image::ImageFormat::Png)?,
    }
    Ok(file.into_inner())
}

/// The eyes of a picture, and the placement of the sculpture before them.
#[derive(Clone, Copy)]
struct PlacedEyes<'a> {
    eyes: &'a [Eye],
    world_from_grid: Affine3A,
}

/// Renders without Vulkan, in `mode`.
fn render_by_casting(
    document: &mut Document,
    followed: &mut FollowedNormals,
    view: &PictureView,
    mode: RenderMode,
    seen: &PlacedEyes,
    options: &PictureOptions,
) -> Vec<RgbImage> {
    let PlacedEyes { eyes, world_from_grid } = *seen;
    let smooth = view.smooth_surface
        && document.contents().surface == SurfaceKind::Smooth
        && mode.can_be_smooth()
        && eyes
            .iter()
            .any(|eye| LevelSet::shows(document.grid(), &eye.pixel_rays(&world_from_grid)));
    followed.follow(document);
    let (grid, material) = (document.grid(), document.material());
    if smooth {
        followed.prepare_surface(grid, document.limits());
    }
    let lighting = view.lighting(options);
    let mut shader = SoftwareShader::default();
    let mut pixels = Pixels::default();
    let mut sampler = LevelSampler::default();
    let mut ground =
        view.ground.and_then(|ground| Some((ground, GroundShader::new(grid, ground.up)?)));
    let mut picture_of = |eye: &Eye| {
        let mut map = IndexMap::new(eye.pixel_rays(&world_from_grid));
        let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
        let mut mean = PictureMean::new(eye.size);
        for sample in 0..view.samples {
            let rays = eye.sample(sample).pixel_rays(&world_from_grid);
            sampler.sample = sample;
            if !(smooth && followed.sample_surface(grid, &mut sampler, &rays, &mut map)) {
                match mode {
                    RenderMode::Quickstep => quickstep::sample(grid, &rays, &mut map),
                    _ => raycast::sample(grid, &rays, &mut map),
                }
            }
            followed.complete_seen(grid, &map);
            let source = ShadeSource { grid, material, normals: followed.field(), mask: None };
            let lighting = lighting.of_sample(sample);
            shader.shade(&map, &source, &pose, &lighting, &mut pixels);
            if let Some((ground, below)) = &mut ground {
                let ground = ground.of_sample(sample);
                below.put_behind(&ground, &lighting, &pose, &rays, &mut pixels);
            }
            mean.add(over_background(&pixels));
        }
        mean.picture()
    };
    eyes.iter().map(&mut picture_of).collect()
}

/// Renders on the painter's device. A sculpture that is too large for the device in this
/// mode is rendered in the fallback mode.
fn render_on_device(
    document: &mut Document,
    painter: &mut PictureDevice,
    followed: &mut FollowedNormals,
    view: &PictureView,
    seen: &PlacedEyes,
    options: &PictureOptions,
) -> Result<Vec<RgbImage>, PictureError> {
    let PlacedEyes { eyes, world_from_grid } = *seen;
    let PictureDevice { device, renderer, frames, warned } = painter;
    let [top, bottom] = BACKGROUND.map(|rgb| Vec3::from(rgb.map(f32::from)) / 255.0);
    let desc = FrameDesc {
        eyes,
        world_from_grid,
        mode: view.mode,
        sample: 0,
        smooth_surface: match view.smooth_surface {
            true => SmoothSurface::Always,
            false => SmoothSurface::Never,
        },
        lighting: view.lighting(options),
        show_mask: false,
        background: Background::Gradient { top, bottom },
        ground: view.ground,
        smooth_edges: false,
        video: None,
        previews: &[],
        lines: &[],
    };
    let mut means: Vec<PictureMean> = eyes.iter().map(|eye| PictureMean::new(eye.size)).collect();
    let mut readbacks: Vec<Readback> =
        eyes.iter().map(|_| Readback::new(device, "samples of a picture")).collect();
    let mut shifted = eyes.to_vec();
    let mut mode = view.mode;
    for sample in 0..view.samples {
        shifted.iter_mut().zip(eyes).for_each(|(shifted, eye)| *shifted = eye.sample(sample));
        let desc = FrameDesc { mode, ..desc.of_sample(&shifted, sample) };
        let mut recorder = frames.begin()?;
        // Modes without a device are cast without the limits of this one.
        let paints = RenderMode::needs_device;
        let slot = frames.slot();
        let report = renderer.paint_with_fallback(&mut recorder, slot, document, &desc, paints)?;
        for Fallback { reason, to } in report.fallbacks.iter().filter(|_| !*warned) {
            tracing::warn!("{reason}; rendering by {}", to.label());
        }
        *warned |= !report.fallbacks.is_empty();
        mode = report.mode;
        if !report.painted {
            return Ok(render_by_casting(document, followed, view, mode, seen, options));
        }
        if let Some(pictures) = renderer.pictures() {
            let image = pictures.colour.image();
            for (eye, readback) in (0..).zip(&mut readbacks) {
                readback.record(&mut recorder, slot, image.layer(eye), image.size(), 4)?;
            }
        }
        let serial = frames.submit(recorder, &[], &[])?;
        for (readback, mean) in readbacks.iter_mut().zip(&mut means) {
            readback.submitted(slot, serial);
            let bytes = readback.wait(slot)?;
            mean.add(bytes.chunks_exact(4).map(|rgba| [rgba[0], rgba[1], rgba[2]]));
        }
    }
    match device.validation_messages() {
        messages if messages.is_empty() => {}
        messages => return Err(PictureError::Validation(messages.join("\n"))),
    }
    Ok(means.iter().map(PictureMean::picture).collect())
}

/// Returns the centre of the bounding box, in grid coordinates.
pub fn outline_middle(grid: &Grid) -> Vec3 {
    let (min, max) = grid.opaque_bounds().unwrap_or((UVec3::ZERO, grid.dims()));
    (min.as_vec3() + max.as_vec3()) * 0.5
}

/// Composes shaded pixels with the background gradient.
fn over_background(pixels: &Pixels) -> impl Iterator<Item = [u8; 3]> {
    let UVec2 { x: width, y: height } = pixels.size;
    pixels.rgba.chunks(width.max(1) as usize).zip(0..height).flat_map(move |(row, y)| {
        let share = (y as f32 + 0.5) / height as f32;
        let behind = [0, 1, 2].map(|c| {
            let [top, bottom] = BACKGROUND.map(|colour| f32::from(colour[c]));
            (top + (bottom - top) * share).round() as u8
        });
        let mix = |front: u8, behind: u8, a: u8| {
            let (front, behind, a) = (u32::from(front), u32::from(behind), u32::from(a));
            ((front * a + behind * (255 - a) + 127) / 255) as u8
        };
        row.iter().map(move |&[r, g, b, a]| {
            [mix(r, behind[0], a), mix(g, behind[1], a), mix(b, behind[2], a)]
        })
    })
}
