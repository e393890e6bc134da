//! Compares shading on the device, by compute and by fragment shaders, with the software shader. Which of the two the
//! renderer uses depends on the device; both are tested on every device.

use ash::vk;
use glam::{Affine3A, UVec2, Vec3};
use virtual_sculpture::gpu::{EyeImage, ResourceUse, Staging, read_image_once, run_once};
use virtual_sculpture::render::{
    EyeTask, IndexTarget, LitSurface, Normals, PixelStage, ShadingImages, SurfaceShade, Volume,
};
use virtual_sculpture::scenes;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material, Rgb};
use virtual_sculpture::shade::{
    Light, LightFrame, LightSource, Lighting, NormalField, Pixels, ShadePose, ShadeSource, shade,
};
use virtual_sculpture::surface::{IndexMap, pixels_of_grid, raycast};
use virtual_sculpture::view::{Camera, Eye};

use super::fixture::with_device;

/// Neither a multiple of the squares of invocations.
const SIZE: UVec2 = UVec2::new(131, 93);

#[test]
fn both_kinds_of_shaders_give_the_software_shaders_picture() {
    let world_from_grid = Affine3A::from_translation(Vec3::splat(-32.0));
    let eye = Camera::framing(55.0, Vec3::new(0.7, 0.6, 1.0), Vec3::Y).eye(SIZE);
    let map = assert_shaders_agree(&eye, world_from_grid, &Lighting::default());
    assert!(map.covered() > 2000 && map.covered() < map.voxels.len());
}

/// The way to the eye, or to a lamp, has no length: a device without denormal numbers must not divide
/// by the root of one.
#[test]
fn an_eye_and_a_lamp_in_the_middle_of_a_voxel_give_the_software_shaders_picture() {
    let grid = cheese();
    let from = |x: i32| Vec3::new(x as f32 + 0.5, 31.5, 90.5);
    let mut columns = (20..64).map(from);
    let seen = columns.find_map(|from| raycast::cast(&grid, from, -Vec3::Z)).unwrap().voxel;
    let middle = seen.as_vec3() + 0.5;
    // Before the voxel, and in it; places are whole numbers, so that nothing is rounded.
    for eye in [middle.with_z(90.5), middle] {
        let world_from_grid = Affine3A::from_translation(-eye);
        let camera = Camera { eye: Vec3::ZERO, target: -Vec3::Z, near: 0.01, ..Camera::default() };
        let mut lighting = Lighting::default();
        lighting.lights[0] = Some(Light {
            source: LightSource::Position(middle - eye),
            frame: LightFrame::World,
            colour: Rgb::new(255, 255, 255),
            intensity: 1.0,
        });
        let map = assert_shaders_agree(&camera.eye(SIZE), world_from_grid, &lighting);
        assert!(map.voxels.contains(&grid.voxel_index(seen)));
    }
}

fn cheese() -> Grid {
    scenes::cheese(64, 12, 3).unwrap()
}

/// Shades what `eye` sees of the cheese in each of the ways. Returns what it sees.
fn assert_shaders_agree(eye: &Eye, world_from_grid: Affine3A, lighting: &Lighting) -> IndexMap {
    let grid = cheese();
    let base = Rgb::new(190, 180, 160);
    let material = Material::for_grid(&grid, ColourDepth::None, base);
    let rays = eye.pixel_rays(&world_from_grid);
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    let mut map = IndexMap::new(rays);
    raycast::sample(&grid, &rays, &mut map);
    let mut expected = Pixels::new(SIZE);
    let field = NormalField::of(&grid);
    let source = ShadeSource { grid: &grid, material: &material, normals: &field, mask: None };
    shade(&map, &source, &pose, lighting, &mut expected);

    with_device(|device| {
        let volume = Volume::new(device, &grid).unwrap();
        let normals = Normals::new(device, &field).unwrap();
        let format = vk::Format::R8G8B8A8_UNORM;
        use vk::ImageUsageFlags as Usage;
        let usage = Usage::SAMPLED | Usage::STORAGE | Usage::COLOR_ATTACHMENT | Usage::TRANSFER_SRC;
        for stage in PixelStage::ALL {
            let mut maps = IndexTarget::new(device, SIZE, 1).unwrap();
            let mut pictures = EyeImage::new(device, "picture", SIZE, 1, format, usage).unwrap();
            let mut pass = SurfaceShade::new(device, stage, 1).unwrap();
            let buffers = vk::BufferUsageFlags::TRANSFER_SRC;
            let mut staging = Staging::new(device, "map", buffers, 1 << 16).unwrap();
            pass.begin(0);
            run_once(device, |recorder| {
                let piece = staging.push(&map.voxels, 4)?;
                maps.upload(recorder, 0, piece, 0..SIZE.y);
                let dims = grid.dims();
                let normals = Some(&normals);
                let estimates = false;
                let surface =
                    LitSurface { dims, colours: None, base, normals, estimates, pose, lighting };
                let visible = pixels_of_grid(&grid, &rays);
                let task = EyeTask { visible, ..EyeTask::whole(0, rays) };
                let images = ShadingImages { maps: &mut maps, pictures: &mut pictures };
                pass.record(recorder, &volume, &surface, images, &task)
            })
            .unwrap();
            let image = pictures.image();
            let bytes =
                read_image_once(device, image.layer(0), image.size(), 4, ResourceUse::SHADER_READ)
                    .unwrap();
            let found: Vec<[u8; 4]> = bytemuck::pod_collect_to_vec(&bytes);
            for (i, (found, expected)) in found.iter().zip(&expected.rgba).enumerate() {
                let off = (0..4).map(|c| found[c].abs_diff(expected[c])).max().unwrap();
                let seen = expected[3] != 0;
                assert_eq!(found[3], expected[3], "{stage:?}, pixel {i}");
                assert!(off <= u8::from(seen), "{stage:?}, pixel {i}: {found:?}, {expected:?}");
            }
        }
    });
    map
}
