//! Two eyes: the renderer's layers, and every layout compared pixel by pixel with its twin on the CPU.

use ash::vk;
use glam::{Affine3A, IVec2, UVec2, Vec3};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{
    Attachment, EyeImage, Frames, Load, ResourceUse, Staging, read_image_once, run_once,
};
use virtual_sculpture::render::RenderMode;
use virtual_sculpture::render::{
    Background, FrameDesc, Renderer, SmoothSurface, Stereo, StereoSources,
};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Material, Rgb};
use virtual_sculpture::shade::{Lighting, NormalField, Pixels, ShadePose, ShadeSource, shade};
use virtual_sculpture::surface::{IndexMap, raycast};
use virtual_sculpture::view::{Camera, Eye, StereoLayout, StereoRig};

use super::fixture::with_device;

const WINDOW: UVec2 = UVec2::new(61, 43);
const PICTURE: UVec2 = UVec2::new(40, 30);
const CORNER: IVec2 = IVec2::new(9, 7);

fn noise(size: UVec2, seed: u64, alpha: impl Fn(u8) -> u8) -> Pixels {
    let mut random = scenes::Random(seed);
    let mut pixels = Pixels::new(size);
    for pixel in &mut pixels.rgba {
        let [r, g, b, a, ..] = random.next_u64().to_le_bytes();
        let a = alpha(a);
        // Premultiplied colours are at most their alpha.
        *pixel = [r.min(a), g.min(a), b.min(a), a];
    }
    pixels
}

#[test]
fn every_layout_is_its_twin_and_layers_are_drawn_one_by_one() {
    with_device(|device| {
        let eyes = [noise(PICTURE, 1, |_| 255), noise(PICTURE, 2, |_| 255)];
        // Opaque, clear and in between.
        let interface = noise(WINDOW, 3, |a| if a < 90 { 0 } else { a });
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        let image =
            |size, layers| EyeImage::new(device, "a source", size, layers, FORMAT, usage).unwrap();
        let (mut pictures, mut over) = (image(PICTURE, 2), image(WINDOW, 1));
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let mut staging = Staging::new(device, "sources", usage, 1 << 16).unwrap();
        run_once(device, |recorder| {
            for (eye, pixels) in (0..).zip(&eyes) {
                let piece = staging.push(&pixels.rgba, 4)?;
                pictures.upload_rows(recorder, eye, piece, 0..PICTURE.y);
            }
            let piece = staging.push(&interface.rgba, 4)?;
            over.upload_rows(recorder, 0, piece, 0..WINDOW.y);
            Ok(())
        })
        .unwrap();

        // The colour that an eye sees at a pixel of the window.
        let seen = |eye: usize, at: UVec2| -> [u8; 3] {
            let [r, g, b, a] = interface.rgba[(at.x + at.y * WINDOW.x) as usize];
            let place = at.as_ivec2() - CORNER;
            let inside = place.cmpge(IVec2::ZERO).all() && place.cmplt(PICTURE.as_ivec2()).all();
            let behind = match inside {
                true => eyes[eye].rgba[(place.x + place.y * PICTURE.x as i32) as usize],
                false => [0; 4],
            };
            let mix = |over: u8, behind: u8| {
                let share = f32::from(255 - a) / 255.0;
                (f32::from(over) + f32::from(behind) * share).round() as u8
            };
            [mix(r, behind[0]), mix(g, behind[1]), mix(b, behind[2])]
        };
        let mut stereo = Stereo::new(device, FORMAT).unwrap();
        // As the images of a quad-buffered window are: two layers.
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC;
        let mut screen = EyeImage::new(device, "screen", WINDOW, 2, FORMAT, usage).unwrap();
        let mut frames = Frames::new(device).unwrap();
        for layout in StereoLayout::ALL {
            let mut recorder = frames.begin().unwrap();
            let sources = StereoSources { pictures: &pictures, corner: CORNER, interface: &over };
            stereo.begin(frames.slot(), &sources);
            for eye in 0..2 {
                screen.begin_overwrite(&mut recorder, eye, ResourceUse::COLOUR_TARGET);
                let view = screen.image().layer_view(eye);
                let attachment = Attachment { view, load: Load::Forget, store: true };
                recorder.begin_rendering(WINDOW.to_array(), Some(attachment), None);
                stereo.draw(&mut recorder, layout, eye, &sources).unwrap();
                recorder.end_rendering();
            }
            frames.submit(recorder, &[], &[]).unwrap();
            for layer in 0..2 {
                let (part, size) = (screen.image().layer(layer), screen.image().size());
                let bytes =
                    read_image_once(device, part, size, 4, ResourceUse::COLOUR_TARGET).unwrap();
                let drawn: &[[u8; 4]] = bytemuck::cast_slice(&bytes);
                for y in 0..WINDOW.y {
                    for x in 0..WINDOW.x {
                        let at = UVec2::new(x, y);
                        let layer = if layout == StereoLayout::Mono { 0 } else { layer as usize };
                        let twin = layout.pixel(at, WINDOW, layer, seen);
                        let [r, g, b, _] = drawn[(x + y * WINDOW.x) as usize];
                        let off = [r, g, b].iter().zip(twin).map(|(a, b)| a.abs_diff(b)).max();
                        // A squeezed pixel is rounded twice here, once there.
                        assert!(off <= Some(1), "{layout:?} {at}: {:?} {twin:?}", [r, g, b]);
                    }
                }
            }
        }
    });
}

#[test]
fn both_eyes_of_the_renderer_are_what_each_eye_sees() {
    with_device(|device| {
        let grid = scenes::cheese(64, 12, 3).unwrap();
        let world_from_grid = Affine3A::from_translation(Vec3::splat(-32.0));
        let mono = Camera::framing(55.0, Vec3::new(0.8, 0.6, 1.0), Vec3::Y).eye(UVec2::new(96, 72));
        let rig = StereoRig { eye_distance: 12.0, convergence: 140.0, swap: false };
        let eyes = rig.eyes(&mono);
        let base = Rgb::new(200, 180, 160);
        let material = Material::for_grid(&grid, ColourDepth::Bits24, base);
        let contents = Contents::new(grid, material);
        let mut document = Document::from_contents(contents, Limits::default());
        let lighting = Lighting::default();
        let background = Vec3::new(0.2, 0.4, 0.6);
        let mut renderer = Renderer::new(device, FORMAT).unwrap();
        let mut frames = Frames::new(device).unwrap();
        let mut paint = |eyes: &[Eye], mode, document: &mut Document| {
            let desc = FrameDesc {
                eyes,
                world_from_grid,
                smooth_surface: SmoothSurface::Never,
                sample: 0,
                mode,
                lighting,
                show_mask: false,
                background: Background::Gradient { top: background, bottom: background },
                ground: None,
                smooth_edges: false,
                video: None,
                previews: &[],
                lines: &[],
            };
            let mut recorder = frames.begin().unwrap();
            renderer.paint(&mut recorder, frames.slot(), document, &desc).unwrap();
            frames.submit(recorder, &[], &[]).unwrap();
            renderer.read_back().unwrap()
        };
        for mode in RenderMode::ALL {
            // From one eye to two and back, so that images are made anew.
            let alone = paint(&eyes[1..], mode, &mut document);
            let both = paint(&eyes, mode, &mut document);
            assert_eq!((alone.len(), both.len()), (1, 2));
            assert!(alone[0] == both[1], "{mode:?}: an eye sees the same beside another");
            assert!(both[0] != both[1], "{mode:?}: two eyes see two pictures");
            if mode == RenderMode::Quickstep {
                continue;
            }
            for (eye, picture) in eyes.iter().zip(&both) {
                let rays = eye.pixel_rays(&world_from_grid);
                let mut map = IndexMap::new(rays);
                raycast::sample(document.grid(), &rays, &mut map);
                let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
                let mut expected = Pixels::new(eye.size);
                let (grid, material) = (document.grid(), document.material());
                let source =
                    ShadeSource { grid, material, normals: &NormalField::of(grid), mask: None };
                shade(&map, &source, &pose, &lighting, &mut expected);
                let differ = picture.rgba.iter().zip(&expected.rgba).filter(|(is, should)| {
                    **is != if should[3] == 0 { [51, 102, 153, 255] } else { **should }
                });
                assert_eq!(differ.count(), 0, "{mode:?}");
            }
        }
    });
}
