use super::*;
use crate::scenes::{self, Random};
use crate::sculpture::brick::{BRICK_EDGE_VX, local_index};
use crate::sculpture::{Brick, ColourDepth, Grid, Material, Placement};
use crate::shade::{Light, LightFrame, LightSource, ToneMapping};
use crate::shade::{NormalField, mask_tint, normal};
use crate::surface::VoxelNamer;
use crate::surface::raycast;
use crate::surface::raycast::tests::levels;
use crate::view::Camera;
use glam::{Mat3, Quat, UVec2, Vec3};

#[test]
fn a_lit_face_is_brighter_than_its_ambient_light_and_nothing_is_transparent() {
    let mut grid = Grid::new(UVec3::splat(16), Vec3::ONE, 1 << 20).unwrap();
    grid.fill_bricks(|_| Brick::FULL);
    let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(200, 100, 50));
    let eye = Camera::framing(16.0, Vec3::Z, Vec3::Y).eye(UVec2::new(64, 48));
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    let rays = eye.pixel_rays(&world_from_grid);
    let mut map = IndexMap::new(rays);
    raycast::sample(&grid, &rays, &mut map);
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    let normals = NormalField::of(&grid);
    let source = ShadeSource { grid: &grid, material: &material, normals: &normals, mask: None };
    let mut lit = Pixels::default();
    shade(&map, &source, &pose, &Lighting::default(), &mut lit);
    let dark = Lighting { lights: [None; 4], ..Lighting::default() };
    let mut unlit = Pixels::default();
    shade(&map, &source, &pose, &dark, &mut unlit);
    let seen = lit.rgba.iter().filter(|p| p[3] == 255).count();
    assert_eq!(seen, map.covered());
    let centre = 24 * 64 + 32;
    assert!(lit.rgba[centre][0] > unlit.rgba[centre][0] + 50);
    assert_eq!(lit.rgba[0], [0; 4]);
    // Colour times ambient light, 200 * 80 / 255 and so on.
    assert_eq!(unlit.rgba[centre][..3], [63, 31, 17]);
}

/// A pixel has the same shade alone and beside others: its neighbours in a vector must not affect it.
#[test]
fn a_pixel_is_shaded_the_same_whatever_is_beside_it() {
    let grid = scenes::cheese(64, 30, 7).unwrap();
    let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(200, 180, 160));
    let normals = NormalField::of(&grid);
    let source = ShadeSource { grid: &grid, material: &material, normals: &normals, mask: None };
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    for direction in [Vec3::new(0.8, 0.6, 1.0), Vec3::new(-1.0, 0.1, 0.2)] {
        let eye = Camera::framing(50.0, direction, Vec3::Y).eye(UVec2::new(160, 120));
        let rays = eye.pixel_rays(&world_from_grid);
        let mut map = IndexMap::new(rays);
        raycast::sample(&grid, &rays, &mut map);
        let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
        let lighting = Lighting::default();
        let mut whole = Pixels::default();
        shade(&map, &source, &pose, &lighting, &mut whole);
        let mut columns = Pixels::new(map.rays.size);
        for x in 0..160 {
            let rect = PixelRect { min: UVec2::new(x, 0), max: UVec2::new(x + 1, 120) };
            shade_rect(&map, &source, &pose, &lighting, rect, &mut columns);
        }
        assert!(columns == whole);
    }
}

#[test]
fn places_are_those_of_the_grid() {
    let mut random = crate::scenes::Random(9);
    for dims in [
        [1, 1, 1],
        [1, 7, 3],
        [4096, 1, 5],
        [1000, 3, 77],
        [4096, 4095, 255],
        [4096; 3],
        [8192; 3],
        [8192, 8191, 63],
        [4096, 1024, 1024],
    ] {
        let dims = UVec3::from(dims);
        let numbering = VoxelNumbering::new(dims, 20_000);
        let places = VoxelPlaces::of(&numbering);
        for _ in 0..1000 {
            let mut voxels: [UVec3; 16] = std::array::from_fn(|_| random.voxel(dims).as_uvec3());
            voxels[0] = dims - 1;
            let mut namer = VoxelNamer::new(&numbering);
            let indices = voxels.map(|v| namer.number(v));
            let found = dispatch!(Level::new(), simd => {
                let indices = u32x16::load_array_ref(simd, &indices);
                places.coords(simd, indices).map(|v| v.to_array())
            });
            for (lane, v) in voxels.into_iter().enumerate() {
                assert_eq!(found.map(|v| v[lane] as u32), v.to_array());
            }
        }
    }
}

/// Computes a pixel of the picture by its definition, in another form.
fn reference(source: &ShadeSource, pose: &ShadePose, lighting: &Lighting, voxel: u32) -> [f32; 3] {
    let ShadeSource { grid, material, normals, mask } = *source;
    let linear = |c: Rgb| Vec3::from(c.0.map(|c| (f32::from(c) / 255.0).powi(2)));
    let v = grid.voxel_coords(voxel);
    let eye = pose.eye_from_world.inverse().translation;
    let position = pose.world_from_grid.transform_point3(v.as_vec3() + 0.5);
    let to_eye = (Vec3::from(eye) - position).normalize();
    let normal = match normals.normal(v) {
        None if !normals.is_complete() => normal::gradient(grid, v),
        normal => normal.unwrap_or_default(),
    };
    let world_from_gradient = Mat3::from(pose.world_from_grid.matrix3).inverse().transpose();
    let normal = (world_from_gradient * normal).normalize_or(to_eye);
    let normal = (normal - to_eye * normal.dot(to_eye).min(0.0)).normalize_or(to_eye);
    let colour = material.rgb(v / BRICK_EDGE_VX, local_index(v.x & 7, v.y & 7, v.z & 7));
    let is_masked = mask.is_some_and(|mask| mask.get(v.as_ivec3()));
    let albedo = linear(if is_masked { mask_tint(colour, v) } else { colour });
    let upwards = 0.5 + 0.5 * normal.dot(lighting.up.normalize());
    let sky = linear(lighting.ground).lerp(linear(lighting.sky), upwards);
    let mut sum = albedo * sky * lighting.ambient;
    for light in lighting.lights.iter().flatten() {
        let to_world = match light.frame {
            LightFrame::World => Affine3A::IDENTITY,
            LightFrame::Eye => pose.eye_from_world.inverse(),
        };
        let to_light = match light.source {
            LightSource::Direction(d) => to_world.transform_vector3(d).normalize(),
            LightSource::Position(p) => (to_world.transform_point3(p) - position).normalize(),
        };
        let lambert = normal.dot(to_light);
        if lambert > 0.0 {
            let half = (to_light + to_eye).normalize();
            let highlight = normal.dot(half).max(0.0).powi(lighting.shininess as i32);
            let reflected = albedo * lambert + lighting.specular * highlight;
            sum += reflected * linear(light.colour) * light.intensity;
        }
    }
    let tone = |light: f32| match lighting.tone {
        ToneMapping::Off => light,
        ToneMapping::Filmic => {
            light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14)
        }
    };
    let exposed = sum * 2f32.powf(lighting.exposure_ev);
    exposed.to_array().map(|c| tone(c).clamp(0.0, 1.0).sqrt() * 255.0)
}

#[test]
fn pictures_are_as_defined_for_all_lights_colours_and_voxel_shapes() {
    let mut random = Random(3);
    let mut grid = Grid::new(UVec3::new(61, 47, 90), Vec3::new(1.0, 2.5, 0.4), 1 << 30).unwrap();
    let cheese = scenes::cheese(96, 60, 8).unwrap();
    grid.fill_bricks(|b| *cheese.brick(b));
    let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(180, 170, 150));
    for brick in (0..grid.brick_count()).step_by(3) {
        let colour = Rgb(std::array::from_fn(|_| random.next_u64() as u8));
        material.paint(grid.brick_coords(brick), &Brick::FULL, colour);
    }
    let light = |frame, source, colour: [u8; 3]| {
        Some(Light { frame, source, colour: Rgb(colour), intensity: 0.7 })
    };
    let towards = LightSource::Direction(Vec3::new(0.3, 2.0, 1.0));
    let lamp = LightSource::Position(Vec3::new(30.0, 50.0, -10.0));
    let one_colour = Lighting {
        lights: [
            light(LightFrame::Eye, towards, [255, 255, 255]),
            light(LightFrame::World, towards, [0, 200, 90]),
            light(LightFrame::Eye, lamp, [90, 0, 200]),
            light(LightFrame::World, lamp, [200, 90, 0]),
        ],
        shininess: 21,
        ..Lighting::default()
    };
    let filmic = Lighting {
        ambient: 0.6,
        sky: Rgb::new(150, 190, 255),
        ground: Rgb::new(120, 80, 40),
        up: Vec3::new(0.2, 3.0, -1.0),
        exposure_ev: 0.7,
        tone: ToneMapping::Filmic,
        ..one_colour
    };
    let placement = Placement {
        rotation: Quat::from_scaled_axis(Vec3::new(0.4, 1.1, -0.5)),
        translation: Vec3::new(3.0, -2.0, 5.0),
        scale: 0.01,
    };
    let world_from_grid = placement.world_from_grid(grid.dims(), grid.voxel_size());
    // A width that is no multiple of sixteen.
    let camera = Camera {
        eye: Vec3::new(3.7, -1.3, 5.8),
        target: placement.translation,
        ..Camera::default()
    };
    let eye = camera.eye(UVec2::new(203, 150));
    let rays = eye.pixel_rays(&world_from_grid);
    let mut map = IndexMap::new(rays);
    raycast::sample(&grid, &rays, &mut map);
    // As between two slices: voxels from inside the solid.
    for index in (0..map.voxels.len()).step_by(17) {
        let v = random.voxel(grid.dims());
        if grid.get(v) {
            map.voxels[index] = grid.voxel_index(v.as_uvec3());
        }
    }
    assert!(map.covered() > 5000 && map.covered() < 203 * 150, "{}", map.covered());
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    let (complete, mut incomplete) = (NormalField::of(&grid), NormalField::default());
    incomplete.follow(&grid, None);
    let whole = PixelRect::of_picture(rays.size);
    let mut mask = grid.emptied();
    mask.fill_bricks(|b| if b.element_sum() % 2 == 0 { *cheese.brick(b) } else { Brick::EMPTY });
    for (level, normals, lighting, mask) in levels().into_iter().flat_map(|level| {
        [
            (level, &complete, one_colour, None),
            (level, &incomplete, one_colour, Some(&mask)),
            (level, &complete, filmic, None),
        ]
    }) {
        let source = ShadeSource { grid: &grid, material: &material, normals, mask };
        let mut out = Pixels::default();
        Shader::new(&map, &source, &pose, &lighting).shade_rect(level, whole, &mut out);
        for (&voxel, pixel) in map.voxels.iter().zip(&out.rgba) {
            if voxel == NO_VOXEL {
                assert_eq!(*pixel, [0; 4]);
                continue;
            }
            let expected = reference(&source, &pose, &lighting, voxel);
            assert_eq!(pixel[3], 255);
            for (&value, expected) in pixel.iter().zip(expected) {
                let off = (f32::from(value) - expected).abs();
                assert!(off < 0.75, "{pixel:?} is not {expected:?}, {level:?}");
            }
        }
    }
}
