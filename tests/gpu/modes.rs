//! Modes that shade on the device, compared with the software shader pixel by pixel: for both eyes, with colours, several
//! lights, ambient occlusion and anisotropic voxels.

use std::sync::Arc;

use ash::vk;
use glam::{Affine3A, Quat, UVec2, UVec3, Vec3};
use virtual_sculpture::command::Command;
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::{Background, FrameDesc, Renderer, SmoothSurface};
use virtual_sculpture::render::{RenderMode, Shading};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{Brick, ColourDepth, Grid, Material, Placement, Rgb};
use virtual_sculpture::shade::{
    Light, LightFrame, LightSource, Lighting, Look, NormalField, Pixels, ShadePose, ShadeSource,
    Shadow, SoftwareShader, ToneMapping,
};
use virtual_sculpture::surface::{IndexMap, raycast};
use virtual_sculpture::view::{Camera, Eye};

use super::fixture::with_device;

const SIZE: UVec2 = UVec2::new(203, 150);
const RED: Vec3 = Vec3::new(1.0, 0.0, 0.0);

/// A block of 96³ voxels with holes, painted in patches.
fn document(depth: ColourDepth, voxel_size: Vec3) -> Document {
    let cheese = scenes::cheese(96, 60, 8).unwrap();
    let mut grid = Grid::new(UVec3::new(96, 91, 85), voxel_size, 1 << 30).unwrap();
    grid.fill_bricks(|b| *cheese.brick(b));
    let mut material = Material::for_grid(&grid, depth, Rgb::new(180, 170, 150));
    for brick in (0..grid.brick_count()).step_by(3) {
        material.paint_each(grid.brick_coords(brick), &Brick::FULL, |i| {
            let hash = (brick as u32 * 512 + i).wrapping_mul(0x9E37_79B1);
            let [r, g, b, _] = hash.to_le_bytes();
            Rgb([r, g, b])
        });
    }
    Document::from_contents(Contents::new(grid, material), Limits::default())
}

fn lighting(occlusion: bool, look: Look) -> Lighting {
    let light = |frame, source, colour: [u8; 3]| {
        Some(Light { frame, source, colour: Rgb(colour), intensity: 0.7 })
    };
    let towards = LightSource::Direction(Vec3::new(0.3, 2.0, 1.0));
    let lamp = LightSource::Position(Vec3::new(30.0, 50.0, -10.0));
    Lighting {
        lights: [
            light(LightFrame::Eye, towards, [255, 255, 255]),
            None,
            light(LightFrame::World, towards, [0, 200, 90]),
            light(LightFrame::World, lamp, [200, 90, 0]),
        ],
        look,
        ambient: 0.5,
        sky: Rgb::new(150, 190, 255),
        ground: Rgb::new(120, 80, 40),
        up: Vec3::new(0.2, 3.0, -1.0),
        exposure_ev: 0.6,
        tone: if occlusion { ToneMapping::Filmic } else { ToneMapping::Off },
        shininess: 21,
        occlusion,
        shadow: (look == Look::Clay).then_some(Shadow { sun_deg: 20.0, sample: 5 }),
        ..Lighting::default()
    }
}

/// Pairs of eyes: at the usual distance and so near that a voxel covers dozens of pixels; so far that
/// a pixel covers several voxels, and a little beside that; orthographic, all and a part.
fn eyes(document: &Document, world: &Affine3A) -> [[Eye; 2]; 3] {
    let scale = world.matrix3.determinant().cbrt();
    let radius = scale * 0.5 * document.grid().dims().as_vec3().length();
    let direction = Vec3::new(0.8, 0.6, 1.0);
    let usual = Camera::framing(radius, direction, Vec3::Y);
    let rays = usual.eye(SIZE).pixel_rays(world);
    let hit = raycast::cast(document.grid(), rays.origin, rays.direction(100, 70)).unwrap();
    let surface = world.transform_point3(rays.origin + rays.direction(100, 70) * hit.t);
    let near = Camera {
        eye: surface + direction.normalize() * 4.0 * scale,
        target: surface + Vec3::new(0.5, -0.3, 0.0) * scale,
        fov_y_rad: 1.6,
        near: 0.01 * scale,
        ..usual
    };
    let far = Camera { eye: usual.eye * 9.0, fov_y_rad: 0.5 * usual.fov_y_rad, ..usual };
    let beside = Camera { eye: far.eye + Vec3::X * 0.3 * scale, ..far };
    let parallel = usual.orthographic(2.0 * radius, 2.0 * radius / scale);
    let nearer = Camera { eye: usual.eye * 0.2, ..usual };
    let magnified = nearer.orthographic(2.0 * radius, 2.0 * radius / scale);
    [[usual, near], [far, beside], [parallel, magnified]]
        .map(|pair| pair.map(|camera| camera.eye(SIZE)))
}

/// The picture of the ray caster and the software shader, over red.
fn expected(
    (document, normals): (&Document, &NormalField),
    eye: &Eye,
    world: &Affine3A,
    lighting: &Lighting,
    show_mask: bool,
) -> Pixels {
    let rays = eye.pixel_rays(world);
    let mut map = IndexMap::new(rays);
    raycast::sample(document.grid(), &rays, &mut map);
    assert!(map.covered() > 300, "{}", map.covered());
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid: *world };
    let mut pixels = Pixels::default();
    let Contents { grid, material, mask, .. } = document.contents();
    let mask = mask.as_deref().filter(|_| show_mask);
    let source = ShadeSource { grid, material, normals, mask };
    SoftwareShader::default().shade(&map, &source, &pose, lighting, &mut pixels);
    for pixel in pixels.rgba.iter_mut().filter(|pixel| pixel[3] == 0) {
        *pixel = [255, 0, 0, 255];
    }
    pixels
}

/// The pictures of both eyes by `renderer`.
pub(crate) fn painted(
    frames: &mut Frames,
    renderer: &mut Renderer,
    document: &mut Document,
    desc: &FrameDesc,
) -> Vec<Pixels> {
    let mut recorder = frames.begin().unwrap();
    renderer.paint(&mut recorder, frames.slot(), document, desc).unwrap();
    frames.submit(recorder, &[], &[]).unwrap();
    renderer.read_back().unwrap()
}

/// Off by `allowed` levels in a channel is rounding. The share of pixels that differ more.
fn share_off(what: &str, found: &Pixels, expected: &Pixels, allowed: u8) -> f32 {
    assert_eq!(found.size, expected.size);
    let off = |(a, b): (&[u8; 4], &[u8; 4])| {
        a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
    };
    let offs: Vec<u8> = found.rgba.iter().zip(&expected.rgba).map(off).collect();
    let wrong = offs.iter().filter(|&&off| off > allowed).count();
    trials::note!("{what}: largest difference {:?}, {wrong} pixels off", offs.iter().max());
    wrong as f32 / offs.len() as f32
}

/// No voxel painted.
fn plain(document: &Document) -> Material {
    let base = document.material().base();
    Material::for_grid(document.grid(), ColourDepth::Bits24, base)
}

/// The voxels alone, over red.
fn desc(eyes: &[Eye], world: Affine3A, mode: RenderMode, lighting: Lighting) -> FrameDesc<'_> {
    FrameDesc {
        eyes,
        world_from_grid: world,
        smooth_surface: SmoothSurface::Never,
        sample: 0,
        mode,
        lighting,
        show_mask: false,
        background: Background::Gradient { top: RED, bottom: RED },
        ground: None,
        smooth_edges: false,
        video: None,
        previews: &[],
        lines: &[],
    }
}

fn on_device(mode: &RenderMode) -> bool {
    mode.shading() != Shading::Software
}

/// With the mask, if there is one.
fn compare_all(device: &Arc<Device>, document: &mut Document, lighting: Lighting, scale: f32) {
    let mut frames = Frames::new(device).unwrap();
    let mut renderer = Renderer::new(device, FORMAT).unwrap();
    let placement = Placement {
        rotation: Quat::from_scaled_axis(Vec3::new(0.4, 1.1, -0.5)),
        translation: Vec3::ZERO,
        scale,
    };
    let world = placement.world_from_grid(document.grid().dims(), document.grid().voxel_size());
    let contents = Contents { material: plain(document), ..document.contents().clone() };
    let one_colour = Document::from_contents(contents, Limits::default());
    let normals = NormalField::of(document.grid());
    for eyes in eyes(document, &world) {
        let [in_colour, in_one] = [&*document, &one_colour]
            .map(|of| eyes.map(|eye| expected((of, &normals), &eye, &world, &lighting, true)));
        for mode in RenderMode::ALL.into_iter().filter(on_device) {
            let desc = FrameDesc { show_mask: true, ..desc(&eyes, world, mode, lighting) };
            let pictures = painted(&mut frames, &mut renderer, document, &desc);
            let expected = if mode == RenderMode::Gpu { &in_one } else { &in_colour };
            for (i, (picture, expected)) in pictures.iter().zip(expected).enumerate() {
                let what = format!("{mode:?}, eye {i}");
                let share = share_off(&what, picture, expected, 1);
                assert!(share <= 1e-3, "{what}: {share} of the pixels are off");
            }
        }
    }
}

#[test]
fn the_device_shades_the_same_picture_as_the_software_shader() {
    with_device(|device| {
        for (depth, occlusion, look, voxel_size, scale) in [
            (ColourDepth::Bits24, false, Look::Colours, Vec3::ONE, 1.0),
            (ColourDepth::Bits16, true, Look::Colours, Vec3::new(1.0, 1.4, 0.6), 0.01),
            (ColourDepth::Bits8, false, Look::Clay, Vec3::ONE, 1.0),
            (ColourDepth::None, true, Look::Matcap, Vec3::ONE, 30.0),
        ] {
            trials::note!("{depth:?}");
            let mut document = document(depth, voxel_size);
            compare_all(device, &mut document, lighting(occlusion, look), scale);
        }
    });
}

/// The document with patches of it protected: with and without colours of their own, and everything behind a plane.
fn masked(document: Document) -> Document {
    let holes = scenes::cheese(96, 60, 5).unwrap();
    let mut contents = document.contents().clone();
    let mut mask = contents.grid.emptied();
    mask.fill_bricks(|b| if b.x > 6 { Brick::FULL } else { *holes.brick(b) });
    contents.mask = Some(Box::new(mask));
    Document::from_contents(contents, Limits::default())
}

#[test]
fn every_mode_shows_the_mask_as_the_software_shader_does() {
    with_device(|device| {
        for (depth, occlusion, look) in [
            (ColourDepth::Bits24, false, Look::Colours),
            (ColourDepth::Bits16, true, Look::Colours),
            (ColourDepth::Bits8, false, Look::Colours),
            (ColourDepth::None, false, Look::Colours),
            (ColourDepth::Bits8, true, Look::Clay),
            (ColourDepth::Bits24, true, Look::Matcap),
        ] {
            trials::note!("{depth:?}, {look:?}");
            let mut document = masked(document(depth, Vec3::ONE));
            compare_all(device, &mut document, lighting(occlusion, look), 1.0);
        }
    });
}

#[test]
fn the_mask_is_seen_while_it_is_asked_for_and_goes_with_undo() {
    with_device(|device| {
        let mut document = masked(document(ColourDepth::Bits24, Vec3::ONE));
        let world = Placement::default().world_from_grid(document.grid().dims(), Vec3::ONE);
        let [[eye, _], ..] = eyes(&document, &world);
        let mut without = Document::from_contents(
            Contents { mask: None, ..document.contents().clone() },
            Limits::default(),
        );
        for mode in RenderMode::ALL {
            let mut frames = Frames::new(device).unwrap();
            let mut renderer = Renderer::new(device, FORMAT).unwrap();
            let eyes = [eye];
            let mut paint = |document: &mut Document, show_mask, look| {
                let desc = desc(&eyes, world, mode, lighting(false, look));
                let desc = FrameDesc { show_mask, ..desc };
                painted(&mut frames, &mut renderer, document, &desc).remove(0)
            };
            let bare = paint(&mut without, true, Look::Colours);
            let hidden = paint(&mut document, false, Look::Colours);
            assert!(hidden == bare, "{mode:?}");
            let shown = paint(&mut document, true, Look::Colours);
            let differing =
                |other: &Pixels| shown.rgba.iter().zip(&other.rgba).filter(|(a, b)| a != b).count();
            let seen = differing(&bare);
            assert!(seen > 2000, "{mode:?}: {seen} pixels");
            // Another look and back, as well as hidden and shown again.
            assert!(differing(&paint(&mut document, true, Look::Stone)) > 2000, "{mode:?}");
            assert!(paint(&mut document, true, Look::Colours) == shown, "{mode:?}");
            assert!(paint(&mut document, false, Look::Colours) == bare, "{mode:?}");
            assert!(paint(&mut document, true, Look::Colours) == shown, "{mode:?}");
            // A step that takes the mask along, and back.
            document.apply(&"new dims=96,91,85 colour=24".parse().unwrap()).unwrap();
            paint(&mut document, true, Look::Colours);
            document.apply(&"undo".parse().unwrap()).unwrap();
            assert!(paint(&mut document, true, Look::Colours) == shown, "{mode:?}");
        }
    });
}

#[test]
fn bits_and_colours_follow_edits_undo_and_other_sculptures_in_every_mode() {
    with_device(|device| {
        let mut document = document(ColourDepth::Bits24, Vec3::ONE);
        let mut frames = Frames::new(device).unwrap();
        let mut renderer = Renderer::new(device, FORMAT).unwrap();
        let start = Placement::default().world_from_grid(document.grid().dims(), Vec3::ONE);
        let [[eye, _], ..] = eyes(&document, &start);
        let commands = [
            "recolour ellipsoid at=60,60,80 half=20 colour=#ff0010",
            "subtract cuboid at=70,80,70 half=16",
            "add pyramid at=48,90,40 half=20 colour=#20ff40",
            "undo",
            "recolour cuboid at=48,48,48 half=90 colour=#3060ff",
            "undo",
            "undo",
            "undo",
            "redo",
            "new dims=40,30,50 colour=16 base=#806040 fill=solid",
            "recolour ellipsoid at=20,15,25 half=15 colour=#2060c0",
            "undo",
        ];
        for (i, command) in commands.iter().enumerate() {
            let command: Command = command.parse().unwrap_or_else(|e| panic!("{command}: {e}"));
            document.apply(&command).unwrap_or_else(|e| panic!("{command}: {e}"));
            let world = Placement::default().world_from_grid(document.grid().dims(), Vec3::ONE);
            let eyes = [eye];
            for step in 0..2 {
                // Each mode in turn, so that each starts from the state that others have left.
                let modes =
                    [RenderMode::MarchGpu, RenderMode::GpuColour, RenderMode::SlicingPoints];
                let mode = modes[(i / 2 + step) % modes.len()];
                let desc = desc(&eyes, world, mode, lighting(false, Look::Colours));
                let picture = painted(&mut frames, &mut renderer, &mut document, &desc);
                let normals = NormalField::of(document.grid());
                let expected = expected((&document, &normals), &eye, &world, &desc.lighting, false);
                let share =
                    share_off(&format!("{mode:?} after {command}"), &picture[0], &expected, 1);
                assert!(share <= 1e-3, "{mode:?} after {command}: {share}");
            }
        }
    });
}

#[test]
fn a_window_of_10_bits_a_colour_shows_the_same_picture() {
    with_device(|device| {
        let mut document = document(ColourDepth::Bits24, Vec3::ONE);
        let world = Placement::default().world_from_grid(document.grid().dims(), Vec3::ONE);
        let [[eye, _], ..] = eyes(&document, &world);
        let modes = [
            RenderMode::Slicing,
            RenderMode::SlicingPoints,
            RenderMode::MarchGpu,
            RenderMode::GpuColour,
        ];
        for mode in modes {
            let desc = FrameDesc {
                eyes: &[eye],
                world_from_grid: world,
                smooth_surface: SmoothSurface::Never,
                sample: 0,
                mode,
                lighting: lighting(false, Look::Colours),
                show_mask: false,
                background: Background::Gradient { top: RED, bottom: RED },
                ground: None,
                smooth_edges: false,
                video: None,
                previews: &[],
                lines: &[],
            };
            let mut seen = |format| {
                let mut frames = Frames::new(device).unwrap();
                let mut renderer = Renderer::new(device, format).unwrap();
                painted(&mut frames, &mut renderer, &mut document, &desc).remove(0)
            };
            let plain = seen(FORMAT);
            let ten = seen(vk::Format::A2B10G10R10_UNORM_PACK32);
            let channel = |pixel: &[u8; 4], i: usize| {
                let bits = u32::from_le_bytes(*pixel) >> (10 * i) & 0x3ff;
                (bits as f32 * 255.0 / 1023.0).round() as u8
            };
            let most = std::iter::zip(&plain.rgba, &ten.rgba)
                .flat_map(|(a, b)| (0..3).map(move |i| a[i].abs_diff(channel(b, i))))
                .max();
            assert!(most <= Some(1), "{mode:?}: {most:?} levels");
        }
    });
}
