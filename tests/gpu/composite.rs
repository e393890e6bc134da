//! The composite pass: colours and depth on the target.

use std::sync::Arc;

use ash::vk;
use glam::{Affine3A, UVec2, Vec3};
use virtual_sculpture::gpu::{
    Attachment, Device, Frames, Image, ImageInfo, Load, ResourceUse, Staging, read_image_once,
    run_once,
};
use virtual_sculpture::render::{
    Background, Composite, CompositeEye, EyeTask, IndexReadback, IndexTarget, Slicing, Volume,
};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::{FORMAT, Offscreen};
use virtual_sculpture::sculpture::Grid;
use virtual_sculpture::shade::Pixels;
use virtual_sculpture::shade::composed::Composition;
use virtual_sculpture::surface::slices::SliceAreas;
use virtual_sculpture::surface::{IndexMap, PixelRect, raycast};
use virtual_sculpture::view::{Camera, Eye};

use super::fixture::with_device;

const SIZE: UVec2 = UVec2::new(120, 90);

fn world_from_grid(grid: &Grid) -> Affine3A {
    Affine3A::from_translation(grid.dims().as_vec3() * -0.5)
}

fn eye_at(direction: Vec3, grid: &Grid) -> Eye {
    let radius = 0.5 * grid.dims().as_vec3().length();
    Camera::framing(radius, direction, Vec3::Y).eye(SIZE)
}

/// A picture whose colours encode the voxel of each pixel.
fn colours_of(map: &IndexMap) -> Pixels {
    let rgba = map.voxels.iter().map(|v| {
        let [r, g, b, _] = v.wrapping_mul(0x9E37_79B1).to_le_bytes();
        [r, g, b, 255]
    });
    Pixels { size: map.rays.size, rgba: rgba.collect() }
}

fn view_of(map: &IndexMap, eye: &Eye, grid: &Grid, background: Background) -> CompositeEye {
    CompositeEye {
        eye: 0,
        rays: map.rays,
        projection: eye.projection,
        dims: grid.dims(),
        corner: UVec2::ZERO,
        size: eye.size,
        background,
        scissor: PixelRect::of_picture(map.rays.size),
        visible: PixelRect::of_picture(map.rays.size),
    }
}

fn sampled(grid: &Grid, eye: &Eye) -> IndexMap {
    let rays = eye.pixel_rays(&world_from_grid(grid));
    let mut map = IndexMap::new(rays);
    raycast::sample(grid, &rays, &mut map);
    map
}

/// Uploads an index map made by the CPU.
fn upload(device: &Arc<Device>, maps: &mut IndexTarget, eye: u32, map: &IndexMap) {
    let usage = vk::BufferUsageFlags::TRANSFER_SRC;
    let mut staging = Staging::new(device, "map", usage, 1 << 16).unwrap();
    run_once(device, |recorder| {
        let piece = staging.push(&map.voxels, 4)?;
        maps.upload(recorder, eye, piece, 0..map.rays.size.y);
        Ok(())
    })
    .unwrap();
}

/// The depth at which a pixel's ray enters the voxel that it sees, or a brick that it sees as a whole, with the largest
/// relative error.
fn depth_of(map: &IndexMap, eye: &Eye, grid: &Grid, x: u32, y: u32) -> Option<(f32, f32)> {
    let voxel = map.voxel(x, y)?;
    let mut hit = raycast::cast_pixel(grid, &map.rays, x, y).unwrap();
    let first = raycast::cast(grid, map.rays.origin, map.rays.direction(x, y));
    let mut error = 1e-4;
    match first.filter(|first| first.voxel == voxel) {
        Some(first) => hit = first,
        // The voxel lies anywhere in its brick.
        None => error += 8.0 * 3f32.sqrt() / (map.rays.direction(x, y).length() * hit.t),
    }
    let point = map.rays.origin + map.rays.direction(x, y) * hit.t;
    let clip = eye.clip_from_grid(&world_from_grid(grid)) * point.extend(1.0);
    Some((clip.z / clip.w, error))
}

#[test]
fn slice_read_back_shade_and_composite_two_eyes() {
    with_device(|device| {
        let grid = scenes::cheese(64, 12, 3).unwrap();
        let eyes = [Vec3::new(0.7, 0.6, 1.0), Vec3::new(-0.4, 0.9, -1.0)].map(|d| eye_at(d, &grid));
        let volume = Volume::new(device, &grid).unwrap();
        let mut areas = SliceAreas::default();
        areas.update(&grid, None);
        let mut frames = Frames::new(device).unwrap();
        let mut slicing = Slicing::new(device).unwrap();
        let mut composite = Composite::new(device, FORMAT, 2).unwrap();
        let mut maps = IndexTarget::new(device, SIZE, 2).unwrap();
        let mut readbacks = [IndexReadback::new(device), IndexReadback::new(device)];
        let mut screen = Offscreen::new(device, SIZE, 2).unwrap();
        let mut map = IndexMap::new(eyes[0].pixel_rays(&world_from_grid(&grid)));
        let (top, bottom) = (Vec3::new(0.2, 0.4, 0.6), Vec3::new(0.2, 0.4, 0.6));
        // Several frames, so that both slots are used again.
        for _ in 0..4 {
            let mut recorder = frames.begin().unwrap();
            let slot = frames.slot();
            slicing.begin(slot, &volume);
            for (i, eye) in (0..).zip(&eyes) {
                let rays = eye.pixel_rays(&world_from_grid(&grid));
                let task = EyeTask::whole(i, rays);
                slicing.record(&mut recorder, &volume, &mut areas, &task, &mut maps).unwrap();
                readbacks[i as usize].record(&mut recorder, slot, &mut maps, &task).unwrap();
            }
            let serial = frames.submit(recorder, &[], &[]).unwrap();
            let mut pictures = Vec::new();
            for (readback, eye) in readbacks.iter_mut().zip(&eyes) {
                readback.submitted(slot, serial);
                readback.fetch(slot, grid.dims(), &mut map).unwrap();
                assert!(map == sampled(&grid, eye));
                pictures.push(colours_of(&map));
            }
            let mut recorder = frames.begin().unwrap();
            composite.begin(frames.slot());
            for (i, eye) in (0..).zip(&eyes) {
                let visible = PixelRect::of_picture(SIZE);
                composite.upload(&mut recorder, i, &pictures[i as usize], visible, None).unwrap();
                maps.make_readable(&mut recorder, i);
                screen.begin(&mut recorder, i);
                let background = Background::Gradient { top, bottom };
                let view = view_of(&sampled(&grid, eye), eye, &grid, background);
                composite.draw(&mut recorder, &maps, &CompositeEye { eye: i, ..view });
                screen.end(&mut recorder);
            }
            frames.submit(recorder, &[], &[]).unwrap();
        }
        for (i, eye) in (0..).zip(&eyes) {
            let map = sampled(&grid, eye);
            let mut expected = colours_of(&map);
            for (pixel, voxel) in expected.rgba.iter_mut().zip(&map.voxels) {
                if *voxel == u32::MAX {
                    *pixel = [51, 102, 153, 255];
                }
            }
            assert!(screen.read_back(i).unwrap() == expected, "eye {i}");
        }
    });
}

/// Draws `map` (as if of `eye`) to a target of `format` that is red at depth 0; returns colour and depth.
fn composite_once(
    device: &Arc<Device>,
    format: vk::Format,
    grid: &Grid,
    map: &IndexMap,
    eye: &Eye,
    background: Background,
) -> (Vec<[u8; 4]>, Vec<f32>) {
    use vk::ImageUsageFlags as Usage;
    let size = eye.size.to_array();
    let image = |format, usage| {
        let info = ImageInfo::plane("screen", size, format, usage | Usage::TRANSFER_SRC);
        Image::new(device, &info).unwrap()
    };
    let colour = image(format, Usage::COLOR_ATTACHMENT);
    let depth = image(vk::Format::D32_SFLOAT, Usage::DEPTH_STENCIL_ATTACHMENT);
    let mut maps = IndexTarget::new(device, map.rays.size, 1).unwrap();
    upload(device, &mut maps, 0, map);
    let mut composite = Composite::new(device, format, 1).unwrap();
    composite.begin(0);
    run_once(device, |recorder| {
        let visible = PixelRect::of_picture(map.rays.size);
        composite.upload(recorder, 0, &colours_of(map), visible, None)?;
        recorder.image_barrier(colour.whole(), ResourceUse::NOTHING, ResourceUse::COLOUR_TARGET);
        recorder.image_barrier(depth.whole(), ResourceUse::NOTHING, ResourceUse::DEPTH_TARGET);
        let red = Load::Colour([1.0, 0.0, 0.0, 1.0]);
        recorder.begin_rendering(
            size,
            Some(Attachment { view: colour.view(), load: red, store: true }),
            Some(Attachment { view: depth.view(), load: Load::Depth(0.0), store: true }),
        );
        composite.draw(recorder, &maps, &view_of(map, eye, grid, background));
        recorder.end_rendering();
        Ok(())
    })
    .unwrap();
    let read = |image: &Image, from| {
        read_image_once(device, image.whole(), image.size(), 4, from).unwrap()
    };
    let colours = bytemuck::pod_collect_to_vec(&read(&colour, ResourceUse::COLOUR_TARGET));
    let depths = bytemuck::pod_collect_to_vec(&read(&depth, ResourceUse::DEPTH_TARGET));
    (colours, depths)
}

#[test]
fn the_depth_is_that_of_the_surface() {
    with_device(|device| {
        let mut large = Grid::new(glam::UVec3::new(1500, 1200, 1800), Vec3::ONE, 1 << 30).unwrap();
        for i in 0..400 {
            for j in 0..400 {
                large.set(glam::IVec3::new(1100 + i, 800 + j, 1799 - (i + j) / 3), true);
            }
        }
        for (grid, direction) in [
            (scenes::cheese(64, 12, 3).unwrap(), Vec3::new(0.7, 0.6, 1.0)),
            // Indices of nearly 32 bits.
            (large, Vec3::new(0.4, 0.3, 1.0)),
        ] {
            let eye = eye_at(direction, &grid);
            let map = sampled(&grid, &eye);
            assert!(map.covered() > 100);
            let (colours, depths) =
                composite_once(device, FORMAT, &grid, &map, &eye, Background::Keep);
            let expected = colours_of(&map);
            for y in 0..SIZE.y {
                for x in 0..SIZE.x {
                    let i = (x + y * SIZE.x) as usize;
                    match depth_of(&map, &eye, &grid, x, y) {
                        Some((depth, most)) => {
                            assert_eq!(colours[i], expected.rgba[i]);
                            let error = (depths[i] - depth).abs() / depth;
                            assert!(error < most, "{} for {depth} at {x}, {y}", depths[i]);
                        }
                        None => assert_eq!((colours[i], depths[i]), ([255, 0, 0, 255], 0.0)),
                    }
                }
            }
        }
    });
}

/// The pictures of the CPU are those that are drawn: colours to a level, depths to rounding.
#[test]
fn a_picture_composed_without_a_rasterizer_is_as_the_device_draws_it() {
    with_device(|device| {
        let grid = scenes::cheese(64, 12, 3).unwrap();
        let eye = eye_at(Vec3::new(0.7, 0.6, 1.0), &grid);
        let map = sampled(&grid, &eye);
        let pixels = colours_of(&map);
        let (top, bottom) = (Vec3::new(0.1, 0.5, 0.9), Vec3::new(1.0, 0.3, 0.0));
        for (format, is_bgra, is_linear) in [
            (FORMAT, false, false),
            (vk::Format::R8G8B8A8_SRGB, false, true),
            (vk::Format::B8G8R8A8_UNORM, true, false),
        ] {
            let background = Background::Gradient { top, bottom };
            let (colours, depths) = composite_once(device, format, &grid, &map, &eye, background);
            let picture = PixelRect::of_picture(SIZE);
            let composition = Composition {
                map: &map,
                pixels: &pixels,
                projection: eye.projection,
                background: Some([top, bottom]),
                is_linear,
                is_bgra,
                visible: picture,
            };
            let mut composed = vec![[0; 4]; colours.len()];
            let mut composed_depths = vec![0.0; depths.len()];
            composition.compose(picture, &mut composed, &mut composed_depths);
            for (drawn, composed) in colours.iter().zip(&composed) {
                for (a, b) in drawn.iter().zip(composed) {
                    assert!(a.abs_diff(*b) <= 1, "{format:?}: {composed:?}, not {drawn:?}");
                }
            }
            for (drawn, composed) in depths.iter().zip(&composed_depths) {
                assert!((drawn - composed).abs() <= 1e-6 * drawn, "{composed}, not {drawn}");
            }
        }
    });
}

#[test]
fn a_smaller_map_fills_the_target_and_the_background_runs_from_top_to_bottom() {
    with_device(|device| {
        let grid = scenes::solid_cube(32).unwrap();
        let small = Eye { size: SIZE / 3, ..eye_at(Vec3::new(0.2, 0.3, 1.0), &grid) };
        let map = sampled(&grid, &small);
        let large = Eye { size: SIZE, ..small };
        let background = Background::Gradient { top: Vec3::ZERO, bottom: Vec3::ONE };
        let (colours, _) = composite_once(device, FORMAT, &grid, &map, &large, background);
        let picture = colours_of(&map);
        for y in 0..SIZE.y {
            for x in 0..SIZE.x {
                let colour = colours[(x + y * SIZE.x) as usize];
                let texel = (x / 3 + y / 3 * small.size.x) as usize;
                if map.get(x / 3, y / 3).is_some() {
                    assert_eq!(colour, picture.rgba[texel]);
                } else {
                    let grey = (y as f32 + 0.5) / SIZE.y as f32 * 255.0;
                    assert!((f32::from(colour[0]) - grey).abs() <= 1.0);
                }
            }
        }
    });
}

#[test]
fn a_target_that_encodes_holds_the_same_colours() {
    with_device(|device| {
        let grid = scenes::cheese(64, 12, 3).unwrap();
        let eye = eye_at(Vec3::new(0.7, 0.6, 1.0), &grid);
        let map = sampled(&grid, &eye);
        let draw = |format| composite_once(device, format, &grid, &map, &eye, Background::Keep).0;
        let (plain, encoded) = (draw(FORMAT), draw(vk::Format::R8G8B8A8_SRGB));
        assert_eq!(plain.len(), encoded.len());
        for (plain, encoded) in plain.iter().zip(&encoded) {
            let near = plain.iter().zip(encoded).all(|(a, b)| a.abs_diff(*b) <= 1);
            assert!(near, "{encoded:?} for {plain:?}");
        }
    });
}
