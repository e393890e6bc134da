//! Pictures that are refined while nothing moves, compared with the mean of the same samples made one by one, and
//! with those of a new renderer once something has moved.

use std::sync::Arc;

use ash::vk;
use glam::{Affine3A, IVec3, Quat, UVec2, UVec3, Vec3};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::overlay::{OverlayLine, ToolPreview};
use virtual_sculpture::render::{
    Background, FrameDesc, FrameReport, RenderMode, Renderer, SmoothSurface, Volume,
};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::grid::MAX_AXIS_VX;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material, Rgb};
use virtual_sculpture::shade::{Ground, Lighting, Pixels, Shadow};
use virtual_sculpture::surface::IndexMap;
use virtual_sculpture::tools::solid::{Primitive, Solid};
use virtual_sculpture::view::{Camera, Eye};

use super::fixture::with_device;

const SIZE: UVec2 = UVec2::new(120, 90);
const SAMPLES: u32 = 5;
/// The frames within which a resting picture is to be complete.
const MOST_FRAMES: usize = 20;

pub struct Painter {
    pub renderer: Renderer,
    frames: Frames,
}

impl Painter {
    /// That does not refine.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Painter {
        let renderer = Renderer::new(device, format).unwrap();
        Painter { renderer, frames: Frames::new(device).unwrap() }
    }

    fn refining(device: &Arc<Device>) -> Painter {
        let mut painter = Painter::new(device, FORMAT);
        painter.renderer.set_refinement(SAMPLES);
        painter
    }

    pub fn paint(
        &mut self,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> (FrameReport, Vec<Pixels>) {
        let mut recorder = self.frames.begin().unwrap();
        let slot = self.frames.slot();
        let report = self
            .renderer
            .paint_with_fallback(&mut recorder, slot, document, desc, |_| true)
            .unwrap();
        assert!(report.fallbacks.is_empty());
        self.frames.submit(recorder, &[], &[]).unwrap();
        (report, self.renderer.read_back().unwrap())
    }

    /// The complete pictures, after the first ones and their maps, which must stay the same meanwhile.
    fn rest(&mut self, document: &mut Document, desc: &FrameDesc) -> (Vec<Pixels>, Vec<Pixels>) {
        let (report, first) = self.paint(document, desc);
        self.rest_from(report, first, document, desc)
    }

    /// The same, after the first frame.
    fn rest_from(
        &mut self,
        report: FrameReport,
        first: Vec<Pixels>,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> (Vec<Pixels>, Vec<Pixels>) {
        assert!(!report.complete, "{:?}", desc.mode);
        let maps: Vec<IndexMap> = report.pick_maps.iter().map(|map| (**map).clone()).collect();
        for (map, eye) in maps.iter().zip(desc.eyes) {
            assert_eq!(map.rays, eye.pixel_rays(&desc.world_from_grid));
        }
        for _ in 0..MOST_FRAMES {
            let (report, pictures) = self.paint(document, desc);
            assert!(report.pick_maps.iter().map(|map| &**map).eq(&maps), "what is picked stays");
            if report.complete {
                let (report, again) = self.paint(document, desc);
                assert!(report.complete && again == pictures, "nothing is left to do");
                return (first, pictures);
            }
        }
        panic!("{:?} is not refined within {MOST_FRAMES} frames", desc.mode);
    }
}

fn sculpture() -> Document {
    let grid = scenes::cheese(80, 14, 5).unwrap();
    let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(200, 180, 160));
    let mut document = Document::from_contents(Contents::new(grid, material), Limits::default());
    let paint = "recolour ellipsoid at=60,60,68 half=14,14,14 colour=#2060c0";
    document.apply(&paint.parse().unwrap()).unwrap();
    document
}

fn eyes() -> [Eye; 2] {
    [Vec3::new(0.8, 0.6, 1.0), Vec3::new(0.7, 0.6, 1.1)]
        .map(|from| Camera::framing(69.0, from, Vec3::Y).eye(SIZE))
}

fn preview(at: Vec3) -> ToolPreview {
    let primitive = Primitive {
        solid: Solid::Ellipsoid,
        centre_vx: at,
        half: Vec3::new(9.0, 6.0, 7.0),
        rotation: Quat::from_rotation_z(0.4),
    };
    let colour = Rgb::new(250, 200, 40);
    ToolPreview { primitive, voxel_size: Vec3::ONE, colour, opacity: [0.5, 0.2] }
}

pub fn desc<'a>(mode: RenderMode, eyes: &'a [Eye]) -> FrameDesc<'a> {
    let grey = Vec3::splat(0.2);
    FrameDesc {
        eyes,
        world_from_grid: Affine3A::from_translation(Vec3::splat(-40.0)),
        smooth_surface: SmoothSurface::Never,
        sample: 0,
        mode,
        lighting: Lighting::default(),
        show_mask: false,
        background: Background::Gradient { top: Vec3::ONE, bottom: grey },
        ground: None,
        smooth_edges: false,
        video: None,
        previews: &[],
        lines: &[],
    }
}

/// The mean of pictures of `format` that a new renderer makes of each sample, in the light that the format decodes to.
fn mean(
    device: &Arc<Device>,
    format: vk::Format,
    document: &mut Document,
    desc: &FrameDesc,
) -> Vec<Vec<[u8; 3]>> {
    mean_by(&mut Painter::new(device, format), format, document, desc)
}

/// The same by a renderer that refines nothing.
fn mean_by(
    painter: &mut Painter,
    format: vk::Format,
    document: &mut Document,
    desc: &FrameDesc,
) -> Vec<Vec<[u8; 3]>> {
    let encodes = format == vk::Format::R8G8B8A8_SRGB;
    let light = |value: f64| match encodes {
        true if value <= 0.04045 => value / 12.92,
        true => ((value + 0.055) / 1.055).powf(2.4),
        false => value * value,
    };
    let value = |light: f64| match encodes {
        true if light <= 0.0031308 => light * 12.92,
        true => 1.055 * light.powf(1.0 / 2.4) - 0.055,
        false => light.sqrt(),
    };
    let pixels = desc.eyes[0].size.element_product() as usize;
    let mut sums = vec![vec![[0f64; 3]; pixels]; desc.eyes.len()];
    for index in 0..SAMPLES {
        let shifted: Vec<Eye> = desc.eyes.iter().map(|eye| eye.sample(index)).collect();
        let lighting = desc.lighting.of_sample(index);
        let ground = desc.ground.map(|ground| ground.of_sample(index));
        let desc = FrameDesc { eyes: &shifted, sample: index, lighting, ground, ..*desc };
        let (_, pictures) = painter.paint(document, &desc);
        for (sums, picture) in sums.iter_mut().zip(&pictures) {
            for (sum, rgba) in sums.iter_mut().zip(&picture.rgba) {
                for (sum, value) in sum.iter_mut().zip(rgba) {
                    *sum += light(f64::from(*value) / 255.0);
                }
            }
        }
    }
    let mean = |sum: f64| (255.0 * value(sum / f64::from(SAMPLES))).round() as u8;
    sums.iter().map(|sums| sums.iter().map(|sum| sum.map(mean)).collect()).collect()
}

fn assert_near(what: &str, found: &[Pixels], expected: &[Vec<[u8; 3]>]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        for (i, ([r, g, b, a], expected)) in found.rgba.iter().zip(expected).enumerate() {
            let off = [r, g, b].into_iter().zip(expected).map(|(f, e)| f.abs_diff(*e)).max();
            let at = UVec2::new(i as u32 % found.size.x, i as u32 / found.size.x);
            assert!(off <= Some(1) && *a == 255, "{what} at {at}: {r} {g} {b}, {expected:?}");
        }
    }
}

#[test]
fn a_resting_picture_becomes_the_mean_of_its_samples_in_every_mode() {
    with_device(|device| {
        let mut document = sculpture();
        let eyes = eyes();
        let line = OverlayLine {
            from: Vec3::ZERO,
            to: Vec3::splat(80.0),
            colour: Rgb::new(20, 240, 250),
            width_px: 3.0,
            opacity: [1.0, 0.3],
        };
        let previews = [preview(Vec3::new(60.0, 70.0, 70.0))];
        for mode in RenderMode::ALL {
            let desc = FrameDesc { previews: &previews, lines: &[line], ..desc(mode, &eyes) };
            let (first, refined) = Painter::refining(device).rest(&mut document, &desc);
            let mut other = Painter::new(device, FORMAT);
            let (_, plain) = other.paint(&mut document, &desc);
            assert!(first == plain, "{mode:?}: refinement begins with the picture itself");
            if matches!(mode, RenderMode::Ray | RenderMode::GpuColour) {
                let smooth = FrameDesc { smooth_edges: true, ..desc };
                let (first, same) = Painter::refining(device).rest(&mut document, &smooth);
                assert!(first != plain && same == refined, "{mode:?}: samples have sharp edges");
            }
            assert!(refined != plain, "{mode:?}");
            assert_near(
                &format!("{mode:?}"),
                &refined,
                &mean_by(&mut other, FORMAT, &mut document, &desc),
            );
        }
    });
}

/// Shadows are those of the same point of the sun in the first picture, and of other points in each sample.
#[test]
fn shadows_of_a_resting_picture_become_soft() {
    with_device(|device| {
        let mut document = sculpture();
        let eyes = &eyes()[..1];
        let light = |sun_deg| {
            let shadow = Some(Shadow { sun_deg, sample: 0 });
            let lighting = Lighting { shadow, ..Lighting::default() };
            let (up, colour) = (Vec3::Y, Rgb::new(200, 200, 200));
            (lighting, Some(Ground { up, colour, shadow_only: false, sun_deg, sample: 0 }))
        };
        for mode in [RenderMode::Ray, RenderMode::MarchGpu, RenderMode::GpuColour] {
            let [soft, sharp] = [14.0, 0.0].map(|sun_deg| {
                let (lighting, ground) = light(sun_deg);
                FrameDesc { lighting, ground, ..desc(mode, eyes) }
            });
            let (first, refined) = Painter::refining(device).rest(&mut document, &soft);
            let (_, plain) = Painter::new(device, FORMAT).paint(&mut document, &sharp);
            assert!(first == plain, "{mode:?}: the first picture has the middle of the sun");
            let name = format!("{mode:?}");
            let means = [&soft, &sharp].map(|desc| mean(device, FORMAT, &mut document, desc));
            assert_near(&name, &refined, &means[0]);
            let differ = |on_ground: bool| {
                let pairs = means[0][0].iter().zip(&means[1][0]).enumerate();
                let rows =
                    pairs.filter(|(i, _)| (*i as u32 / SIZE.x > SIZE.y * 3 / 4) == on_ground);
                rows.filter(|(_, (a, b))| a[0].abs_diff(b[0]) > 8).count()
            };
            assert!(differ(false) > 50 && differ(true) > 20, "{name}: the shadows are sharp");
        }
    });
}

/// While it moves the picture shows the voxels, at rest the surface between them; what is picked stays.
#[test]
fn a_resting_picture_becomes_smooth() {
    with_device(|device| {
        // So near that a voxel covers some pixels, and so large that a sample takes two frames.
        let near = [Camera::framing(12.0, Vec3::new(0.3, 0.5, 1.0), Vec3::Y).eye(3 * SIZE)];
        let at = Affine3A::from_translation(Vec3::new(-50.0, -44.0, -76.0));
        for mode in [RenderMode::Slicing, RenderMode::MarchGpu] {
            let mut document = sculpture();
            let voxels = FrameDesc { world_from_grid: at, ..desc(mode, &near) };
            let at_rest = FrameDesc { smooth_surface: SmoothSurface::AtRest, ..voxels };
            let always = FrameDesc { smooth_surface: SmoothSurface::Always, ..voxels };
            let mut painter = Painter::refining(device);
            let (first, refined) = painter.rest(&mut document, &at_rest);
            // A GPU shows it at once.
            let at_once = mode.shades_on_device() && !device.is_software();
            let begins = if at_once { &always } else { &voxels };
            let (_, plain) = Painter::new(device, FORMAT).paint(&mut document, begins);
            assert!(first == plain, "{mode:?}: what refinement begins with");
            let expected = mean(device, FORMAT, &mut document, &always);
            assert!(expected != mean(device, FORMAT, &mut document, &voxels));
            assert_near(&format!("{mode:?}"), &refined, &expected);
            // An edit is followed.
            document.apply(&"add ellipsoid at=46,46,80 half=6,6,6".parse().unwrap()).unwrap();
            let (_, refined) = painter.rest(&mut document, &at_rest);
            assert_near(
                &format!("{mode:?}"),
                &refined,
                &mean(device, FORMAT, &mut document, &always),
            );
        }
    });
}

/// The memory of grids in a document that has none to spare for a smooth surface.
const NARROW_BYTES: u64 = 64;

/// Returns a grid of this size with some voxels in its lowest corner, and the eye and the pose that show them.
fn corner_of(dims: UVec3, grid_bytes: u64) -> (Document, Eye, Affine3A) {
    let mut grid = Grid::of_size(dims, Vec3::ONE).unwrap();
    for i in 0..60 {
        grid.set(IVec3::new(i % 8, i / 2 % 8, i / 8), true);
    }
    let material = Material::for_grid(&grid, ColourDepth::None, Rgb::new(200, 180, 160));
    let limits = Limits { grid_bytes, ..Limits::default() };
    let document = Document::from_contents(Contents::new(grid, material), limits);
    let eye = Camera::framing(8.0, Vec3::new(0.3, 0.5, 1.0), Vec3::Y).eye(SIZE);
    (document, eye, Affine3A::from_translation(Vec3::splat(-4.0)))
}

/// The smooth surface would take more memory than is allowed; or a device cannot name its cells, of which there is one
/// more on each axis than of voxels.
#[test]
fn a_grid_too_large_for_the_smooth_surface_shows_its_voxels() {
    with_device(|device| {
        let (long, default) = (UVec3::new(4096, 1024, 1023), Limits::default().grid_bytes);
        // Some devices have no images of this length, so that all modes cast rays.
        let fits = Volume::new(device, corner_of(long, default).0.grid()).is_ok();
        let on_device = fits.then_some((default, RenderMode::MarchGpu));
        for (bytes, mode) in [(NARROW_BYTES, RenderMode::Ray)].into_iter().chain(on_device) {
            let (mut document, eye, at) = corner_of(long, bytes);
            let near = [eye];
            let voxels = FrameDesc { world_from_grid: at, ..desc(mode, &near) };
            let expected = mean(device, FORMAT, &mut document, &voxels);
            let at_rest = FrameDesc { smooth_surface: SmoothSurface::AtRest, ..voxels };
            let (_, refined) = Painter::refining(device).rest(&mut document, &at_rest);
            assert_near(&format!("{mode:?} at rest"), &refined, &expected);
            let always = FrameDesc { smooth_surface: SmoothSurface::Always, ..voxels };
            let always = mean(device, FORMAT, &mut document, &always);
            assert_near(&format!("{mode:?} always"), &refined, &always);
        }
    });
}

/// The CPU names cells beyond what 32 bits can count.
#[test]
fn the_longest_grids_are_refined_to_their_smooth_surface() {
    with_device(|device| {
        for dims in [UVec3::new(4096, 1024, 1023), UVec3::new(MAX_AXIS_VX, MAX_AXIS_VX, 512)] {
            let (mut document, eye, at) = corner_of(dims, Limits::default().grid_bytes);
            let near = [eye];
            let voxels = FrameDesc { world_from_grid: at, ..desc(RenderMode::Ray, &near) };
            let at_rest = FrameDesc { smooth_surface: SmoothSurface::AtRest, ..voxels };
            let (first, refined) = Painter::refining(device).rest(&mut document, &at_rest);
            let differing = first[0].rgba.iter().zip(&refined[0].rgba).filter(|(a, b)| a != b);
            assert!(differing.count() > 500, "{dims}");
            let always = FrameDesc { smooth_surface: SmoothSurface::Always, ..voxels };
            assert_near("always", &refined, &mean(device, FORMAT, &mut document, &always));
        }
    });
}

#[test]
fn whatever_moves_is_shown_at_once_and_refined_anew() {
    with_device(|device| {
        let eyes = eyes();
        let moved = eyes.map(|eye| eye.shifted_by_px(glam::Vec2::new(7.0, 3.0)));
        let previews = [preview(Vec3::new(60.0, 70.0, 70.0))];
        for mode in [
            RenderMode::Slicing,
            RenderMode::MarchGpu,
            RenderMode::GpuColour,
            RenderMode::Ray,
            RenderMode::RayPoints,
        ] {
            let mut document = sculpture();
            let mut follower = Painter::refining(device);
            let still = desc(mode, &eyes);
            let mut dark = still;
            dark.lighting.ambient = 0.0;
            let black = Background::Gradient { top: Vec3::ZERO, bottom: Vec3::ZERO };
            follower.rest(&mut document, &still);
            let edit = "subtract ellipsoid at=50,60,70 half=12,9,14 turn=20,30,40";
            // Each differs from the one before.
            for (what, edit, desc) in [
                ("tool", None, FrameDesc { previews: &previews, ..still }),
                ("no tool", None, still),
                ("edit", Some(edit), still),
                ("undo", Some("undo 1"), still),
                ("view", None, desc(mode, &moved)),
                ("light", None, FrameDesc { eyes: &moved, ..dark }),
                ("background", None, FrameDesc { eyes: &moved, background: black, ..dark }),
                ("one eye", None, desc(mode, &eyes[1..])),
                ("edit before one eye", Some(edit), desc(mode, &eyes[1..])),
            ] {
                if let Some(edit) = edit {
                    document.apply(&edit.parse().unwrap()).unwrap();
                }
                let (report, shown) = follower.paint(&mut document, &desc);
                let mut other = Painter::new(device, FORMAT);
                let (anew, expected) = other.paint(&mut document, &desc);
                assert!(!report.complete && anew.complete, "{mode:?}: {what}");
                assert!(shown == expected, "{mode:?}: {what} is shown at once");
                assert_eq!(report.pick_maps, anew.pick_maps, "{mode:?}: {what}");
                let (_, refined) = follower.rest_from(report, shown, &mut document, &desc);
                let what = format!("{mode:?}: {what}");
                assert_near(&what, &refined, &mean_by(&mut other, FORMAT, &mut document, &desc));
            }
        }
    });
}

#[test]
fn transparent_pictures_are_not_refined_and_none_are_if_it_is_switched_off() {
    with_device(|device| {
        let mut document = sculpture();
        let eyes = eyes();
        let desc = desc(RenderMode::Ray, &eyes);
        let mut painter = Painter::refining(device);
        let (plain, refined) = painter.rest(&mut document, &desc);
        assert!(refined != plain);
        painter.renderer.set_refinement(1);
        let (report, pictures) = painter.paint(&mut document, &desc);
        assert!(report.complete && pictures == plain, "without refinement it is the plain picture");
        painter.renderer.set_refinement(SAMPLES);
        let transparent = FrameDesc { background: Background::Keep, ..desc };
        let (_, plain) = painter.paint(&mut document, &transparent);
        for _ in 0..MOST_FRAMES {
            let (report, pictures) = painter.paint(&mut document, &transparent);
            assert!(report.complete && pictures == plain);
        }
    });
}

#[test]
fn a_picture_that_is_refined_at_once_need_not_rest_first() {
    with_device(|device| {
        let mut document = sculpture();
        let eyes = eyes();
        let desc = desc(RenderMode::Ray, &eyes);
        let mut painter = Painter::refining(device);
        let (_, refined) = painter.rest(&mut document, &desc);
        let mut painter = Painter::refining(device);
        painter.renderer.refine_at_once(true);
        // The picture itself, and then the samples, of which it is the first.
        for frame in 0..SAMPLES {
            let (report, _) = painter.paint(&mut document, &desc);
            assert!(!report.complete, "frame {frame}");
        }
        let (report, pictures) = painter.paint(&mut document, &desc);
        assert!(report.complete && pictures == refined);
    });
}

#[test]
fn on_a_target_that_encodes_light_is_what_the_device_decodes() {
    with_device(|device| {
        let format = vk::Format::R8G8B8A8_SRGB;
        let mut document = sculpture();
        let eyes = eyes();
        let desc = desc(RenderMode::Ray, &eyes);
        let mut painter = Painter::new(device, format);
        painter.renderer.set_refinement(SAMPLES);
        let (_, refined) = painter.rest(&mut document, &desc);
        assert_near("sRGB", &refined, &mean(device, format, &mut document, &desc));
    });
}
