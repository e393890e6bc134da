//! Reference pictures in the scene: what hides them, what they hide, and their colours.

use std::sync::Arc;

use glam::{Affine3A, UVec2, UVec3, Vec3};
use virtual_sculpture::command::NewSculpture;
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::Frames;
use virtual_sculpture::render::{
    Background, FrameDesc, ReferencePicture, RenderMode, Renderer, SmoothSurface,
};
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::{ColourDepth, Placement, Rgb};
use virtual_sculpture::shade::{Lighting, Pixels};
use virtual_sculpture::view::{Camera, Eye};

use super::fixture::with_device;

const SIZE: UVec2 = UVec2::new(201, 151);

/// Left half red, right half blue and transparent below.
fn picture() -> Arc<Pixels> {
    let size = UVec2::new(40, 40);
    let texel = |i: u32| match (i % size.x < 20, i / size.x < 20) {
        (true, _) => [255, 0, 0, 255],
        (false, true) => [0, 0, 255, 255],
        (false, false) => [0, 255, 0, 0],
    };
    Arc::new(Pixels { size, rgba: (0..size.element_product()).map(texel).collect() })
}

/// 120 voxels wide and high in the plane z, its middle before that of the grid.
fn reference(pixels: &Arc<Pixels>, z: f32, opacity: f32) -> ReferencePicture {
    let grid_from_picture = Affine3A::from_translation(Vec3::new(-44.0, 76.0, z))
        * Affine3A::from_scale(Vec3::new(120.0, -120.0, 1.0));
    ReferencePicture { pixels: pixels.clone(), grid_from_picture, opacity }
}

#[test]
fn a_reference_picture_stands_in_the_scene_and_is_hidden_by_what_is_before_it() {
    with_device(|device| {
        let new = NewSculpture {
            dims: UVec3::splat(32),
            voxel_size: Vec3::ONE,
            colour_depth: ColourDepth::Bits24,
            base: Rgb::STONE,
            solid: true,
            room_vx: 0,
            grows: false,
        };
        let mut document = Document::new(&new, Limits::default()).unwrap();
        let world_from_grid = Placement::default().world_from_grid(UVec3::splat(32), Vec3::ONE);
        let camera = Camera { eye: Vec3::new(0.0, 0.0, 120.0), near: 0.1, ..Camera::default() };
        let eyes: [Eye; 1] = [camera.eye(SIZE)];
        let grey = Vec3::splat(0.5);
        let desc = FrameDesc {
            eyes: &eyes,
            world_from_grid,
            smooth_surface: SmoothSurface::Never,
            sample: 0,
            mode: RenderMode::Ray,
            lighting: Lighting::default(),
            show_mask: false,
            background: Background::Gradient { top: grey, bottom: grey },
            ground: None,
            smooth_edges: false,
            video: None,
            previews: &[],
            lines: &[],
        };
        let mut renderer = Renderer::new(device, FORMAT).unwrap();
        let mut frames = Frames::new(device).unwrap();
        let mut paint = |references: &[ReferencePicture]| -> Pixels {
            let mut recorder = frames.begin().unwrap();
            let slot = frames.slot();
            renderer.set_references(&mut recorder, slot, references).unwrap();
            renderer.paint(&mut recorder, slot, &mut document, &desc).unwrap();
            frames.submit(recorder, &[], &[]).unwrap();
            renderer.read_back().unwrap().remove(0)
        };
        let at = |pixels: &Pixels, x: u32, y: u32| pixels.rgba[(x + y * SIZE.x) as usize];
        let near = |a: [u8; 4], b: [u8; 4]| a.iter().zip(&b).all(|(a, b)| a.abs_diff(*b) <= 2);
        let (left, right, below) = ([60, 75], [140, 30], [140, 120]);
        let plain = paint(&[]);
        let stone = at(&plain, 100, 75);
        let background = at(&plain, left[0], left[1]);
        assert!(near(background, [128, 128, 128, 255]) && !near(stone, background));

        // Behind the sculpture: seen beside it, in the sculpture's place only by its absence.
        let pixels = picture();
        let behind = paint(&[reference(&pixels, -2.0, 1.0)]);
        assert!(near(at(&behind, left[0], left[1]), [255, 0, 0, 255]));
        assert!(near(at(&behind, right[0], right[1]), [0, 0, 255, 255]), "not mirrored, upright");
        assert_eq!(
            at(&behind, below[0], below[1]),
            background,
            "what is transparent has no colour"
        );
        assert_eq!(at(&behind, 100, 75), stone);
        assert_eq!(at(&behind, 95, 75), at(&plain, 95, 75));

        // In front it covers as far as it is opaque.
        let before = paint(&[reference(&pixels, 34.0, 0.5)]);
        let mixed = |under: [u8; 4]| {
            [(u16::from(under[0]) + 255) / 2, u16::from(under[1]) / 2, u16::from(under[2]) / 2, 255]
                .map(|channel| channel as u8)
        };
        assert!(near(at(&before, left[0], left[1]), mixed(background)));
        assert!(near(at(&before, 95, 75), mixed(at(&plain, 95, 75))));

        // One in front and one behind are blended in order, whatever theirs is.
        let both = [reference(&pixels, 34.0, 0.5), reference(&pixels, -2.0, 1.0)];
        let in_order = paint(&both);
        let [first, second] = both;
        assert_eq!(paint(&[second, first]).rgba, in_order.rgba);

        assert_eq!(paint(&[reference(&pixels, 34.0, 0.0)]).rgba, plain.rgba, "hidden");
        assert_eq!(paint(&[]).rgba, plain.rgba, "taken away");
    });
}
