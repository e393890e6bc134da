//! Pictures on a screen: for two eyes, and for a moving head.

use ash::vk;
use glam::{Affine3A, IVec2, Quat, UVec2, Vec2, Vec3};
use virtual_sculpture::gpu::{Attachment, EyeImage, Load, ResourceUse, read_image_once};
use virtual_sculpture::render::RenderMode;
use virtual_sculpture::render::overlay::ToolPreview;
use virtual_sculpture::render::{Stereo, StereoSources};
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::Rgb;
use virtual_sculpture::shade::Pixels;
use virtual_sculpture::tools::solid::{Primitive, Solid};
use virtual_sculpture::view::off_axis::{ScreenInWorld, ScreenPlane};
use virtual_sculpture::view::{Camera, StereoLayout, StereoRig};

use super::paint::{Painter, Scene, document};
use super::record::assert_recorded;
use crate::gpu::fixture::with_device;

const SIZE: UVec2 = UVec2::new(160, 120);

#[test]
fn two_eyes_side_by_side_and_in_red_and_cyan() {
    with_device(|device| {
        let mut document = document(
            "new dims=48,48,48 colour=24 base=#c8b48c fill=empty\n\
             add cuboid at=24,4,24 half=24,4,24 colour=#5078b4\n\
             add ellipsoid at=24,24,20 half=16,18,16 colour=#c8b48c\n\
             subtract ellipsoid at=30,30,36 half=9,9,9\n",
        );
        let mono = Camera::framing(38.0, Vec3::new(0.4, 0.5, 1.0), Vec3::Y).eye(SIZE);
        let distance = mono.position().length();
        let rig = StereoRig { eye_distance: 0.08 * distance, convergence: distance, swap: false };
        let tool = Primitive {
            solid: Solid::Ellipsoid,
            centre_vx: Vec3::new(30.0, 30.0, 44.0),
            half: Vec3::splat(6.0),
            rotation: Quat::IDENTITY,
        };
        let preview = ToolPreview {
            primitive: tool,
            voxel_size: Vec3::ONE,
            colour: Rgb::new(230, 120, 60),
            opacity: [0.5, 0.2],
        };
        let scene = Scene {
            eyes: &rig.eyes(&mono),
            world_from_grid: Affine3A::from_translation(Vec3::splat(-24.0)),
            mode: RenderMode::Ray,
            video: None,
            previews: &[preview],
        };
        let mut painter = Painter::new(device);
        painter.paint(&mut document, &scene);

        let mut pass = Stereo::new(device, FORMAT).unwrap();
        let used = vk::ImageUsageFlags::COLOR_ATTACHMENT
            | vk::ImageUsageFlags::SAMPLED
            | vk::ImageUsageFlags::TRANSFER_SRC;
        let image = |name| EyeImage::new(device, name, SIZE, 1, FORMAT, used).unwrap();
        let (mut interface, mut screen) = (image("no interface"), image("screen"));
        for (layout, name) in [
            (StereoLayout::SideBySide, "stereo-side-by-side.png"),
            (StereoLayout::Anaglyph, "stereo-anaglyph.png"),
        ] {
            let mut recorder = painter.frames.begin().unwrap();
            let slot = painter.frames.slot();
            let clear = |image: &EyeImage, load| {
                let view = image.image().layer_view(0);
                Some(Attachment { view, load, store: true })
            };
            interface.begin_overwrite(&mut recorder, 0, ResourceUse::COLOUR_TARGET);
            let nothing = clear(&interface, Load::Colour([0.0; 4]));
            recorder.begin_rendering(SIZE.to_array(), nothing, None);
            recorder.end_rendering();
            interface.transition(&mut recorder, 0, ResourceUse::SHADER_READ);
            let pictures = &mut painter.renderer.pictures().unwrap().colour;
            (0..2)
                .for_each(|eye| pictures.transition(&mut recorder, eye, ResourceUse::SHADER_READ));
            let corner = IVec2::ZERO;
            let sources = StereoSources { pictures, corner, interface: &interface };
            pass.begin(slot, &sources);
            screen.begin_overwrite(&mut recorder, 0, ResourceUse::COLOUR_TARGET);
            recorder.begin_rendering(SIZE.to_array(), clear(&screen, Load::Forget), None);
            pass.draw(&mut recorder, layout, 0, &sources).unwrap();
            recorder.end_rendering();
            painter.frames.submit(recorder, &[], &[]).unwrap();
            let part = screen.image().layer(0);
            let bytes =
                read_image_once(device, part, screen.image().size(), 4, ResourceUse::COLOUR_TARGET)
                    .unwrap();
            let rgba = bytemuck::pod_collect_to_vec(&bytes);
            assert_recorded(name, &Pixels { size: SIZE, rgba });
        }
    });
}

/// Metres; 160 voxels fill its width.
const SCREEN: ScreenPlane = ScreenPlane { centre_m: Vec2::ZERO, width_m: 0.4, height_m: 0.3 };
const VOXEL_M: f32 = 0.4 / 160.0;

#[test]
fn the_screen_is_a_window_for_a_head_on_the_left_and_on_the_right() {
    with_device(|device| {
        // An orange bar whose front lies in the plane of the screen, a blue post behind it.
        let mut document = document(
            "new dims=96,64,64 colour=24 base=#ffffff fill=empty\n\
             add cuboid at=48,8,63 half=48,8,1 colour=#d07828\n\
             add cuboid at=48,32,12 half=6,32,6 colour=#3050c0\n\
             add ellipsoid at=20,36,40 half=10,10,10 colour=#60a040\n",
        );
        let world = ScreenInWorld {
            centre: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            units_per_m: VOXEL_M.recip(),
        };
        let mut painter = Painter::new(device);
        for (head_m, name) in [
            (Vec3::new(-0.25, 0.08, 0.5), "head-left.png"),
            (Vec3::new(0.25, 0.08, 0.5), "head-right.png"),
        ] {
            let scene = Scene {
                eyes: &[SCREEN.eye(head_m, &world, SIZE, 0.1)],
                world_from_grid: Affine3A::from_translation(Vec3::new(-48.0, -32.0, -64.0)),
                mode: RenderMode::Ray,
                video: None,
                previews: &[],
            };
            let picture = painter.paint(&mut document, &scene).remove(0);
            // The pixel where the line from the head to a point of the grid goes through the screen.
            let crossing = |voxel: Vec3| {
                let at = (voxel - Vec3::new(48.0, 32.0, 64.0)) * VOXEL_M;
                let share = head_m.z / (head_m.z - at.z);
                let on_screen = (head_m + (at - head_m) * share).truncate();
                (on_screen * Vec2::new(1.0, -1.0) + Vec2::new(0.2, 0.15)) * 400.0
            };
            let colour = |x: u32, y: u32| {
                let [r, g, b, _] = picture.rgba[(x + y * SIZE.x) as usize].map(i32::from);
                (r > b + 30, b > r + 30, g)
            };
            // The bar's front is where it is, whoever looks.
            for (x, y) in [(33, 90), (33, 78), (126, 90), (126, 78)] {
                assert!(colour(x, y).0, "{name} {x} {y}");
            }
            for (x, y) in [(30, 84), (129, 84), (80, 94)] {
                assert!(!colour(x, y).0, "{name} {x} {y}");
            }
            // The post moves with the head.
            let row = 60;
            let blue: Vec<u32> = (0..SIZE.x).filter(|x| colour(*x, row).1).collect();
            let edges = [(42.0, 6.0), (54.0, 6.0), (42.0, 18.0), (54.0, 18.0)]
                .map(|(x, z)| crossing(Vec3::new(x, 40.0, z)).x);
            let low = edges.into_iter().fold(f32::MAX, f32::min);
            let high = edges.into_iter().fold(f32::MIN, f32::max);
            assert!((blue[0] as f32 - low).abs() < 1.5, "{name}: {blue:?} {low}");
            assert!((blue[blue.len() - 1] as f32 + 1.0 - high).abs() < 1.5, "{name}: {high}");
            assert_eq!(head_m.x < 0.0, low + high < SIZE.x as f32, "it goes with the head");
            assert_recorded(name, &picture);
        }
    });
}
