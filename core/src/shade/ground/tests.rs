use glam::{IVec3, UVec2};

use super::*;
use crate::scenes;
use crate::shade::{Light, LightFrame, ToneMapping};
use crate::view::Camera;

/// Returns a wall 20 voxels high that stands on the ground at y = 8.
fn wall() -> Grid {
    let mut grid = Grid::new(UVec3::splat(64), Vec3::ONE, 1 << 20).unwrap();
    for (y, z) in (8..28).flat_map(|y| (20..44).map(move |z| (y, z))) {
        (30..34).for_each(|x| grid.set(IVec3::new(x, y, z), true));
    }
    grid
}

/// Returns a lighting with a sun towards negative x, at 45 degrees.
fn lighting() -> Lighting {
    let sun = Light {
        frame: LightFrame::World,
        source: LightSource::Direction(Vec3::new(-1.0, 1.0, 0.0)),
        colour: Rgb::new(255, 255, 255),
        intensity: 0.5,
    };
    let grey = Rgb::new(128, 128, 128);
    let lights = [Some(sun), None, None, None];
    Lighting { lights, sky: grey, ground: grey, tone: ToneMapping::Off, ..Lighting::default() }
}

fn ground() -> Ground {
    let colour = Rgb::new(255, 255, 255);
    Ground { up: Vec3::Y, colour, shadow_only: false, sun_deg: 8.0, sample: 0 }
}

fn light_of(ground: &Ground, plane: &GroundPlane) -> GroundLight {
    GroundLight::new(ground, plane, &lighting(), &Affine3A::IDENTITY, &Affine3A::IDENTITY)
}

/// Returns the map of `ground` below the wall.
fn map_of(ground: &Ground) -> (GroundPlane, LightMap) {
    let grid = wall();
    let plane = GroundPlane::below(&grid, ground.up).unwrap();
    let mut map = LightMap::default();
    let openness = Openness::new(&grid, &plane);
    map.update(&grid, &plane, &openness, light_of(ground, &plane).sun.as_ref());
    (plane, map)
}

/// Returns the texel below a point of the grid.
fn texel(plane: &GroundPlane, map: &LightMap, point: Vec3) -> [u8; 2] {
    let place = (across(plane.axis, point) - plane.centre) / plane.half;
    let at = ((place * 0.5 + 0.5) * MAP_EDGE as f32).as_uvec2();
    map.texels[at.x as usize + MAP_EDGE * at.y as usize]
}

#[test]
fn the_spacing_of_lines_is_round_and_neither_dense_nor_coarse() {
    let spacing = |edge| line_spacing_vx(UVec3::new(edge, 1, edge / 2));
    assert_eq!([1, 16, 17, 32, 33, 96].map(spacing), [1, 1, 2, 2, 5, 10]);
    assert_eq!([256, 512, 1024, 4096].map(spacing), [20, 50, 100, 500]);
}

#[test]
fn the_plane_touches_the_lowest_voxel_whatever_points_up() {
    let grid = wall();
    for (up, height) in [
        (Vec3::X, 30.0),
        (Vec3::NEG_X, 34.0),
        (Vec3::Y, 8.0),
        (Vec3::NEG_Y, 28.0),
        (Vec3::Z, 20.0),
        (Vec3::NEG_Z, 44.0),
    ] {
        let plane = GroundPlane::below(&grid, up).unwrap();
        assert_eq!((plane.height, plane.up()), (height, up));
        let middle = plane.point(Vec2::ZERO) + up * up.dot(Vec3::new(32.0, 18.0, 32.0));
        let beside = Vec3::ONE - up.abs();
        assert_eq!(middle * beside, Vec3::new(32.0, 18.0, 32.0) * beside);
    }
    let empty = Grid::new(UVec3::splat(64), Vec3::ONE, 1 << 20).unwrap();
    assert_eq!(GroundPlane::below(&empty, Vec3::Y), None);
}

#[test]
fn a_wall_throws_a_shadow_as_long_as_it_is_high_and_soft_in_the_mean() {
    let (plane, map) = map_of(&ground());
    for x in -5..70 {
        let point = Vec3::new(x as f32 + 0.5, 8.0, 32.0);
        let lit = !(30..54).contains(&x);
        if ![29, 30, 53, 54].contains(&x) {
            assert_eq!(texel(&plane, &map, point)[0] == 255, lit, "{x}");
        }
    }
    // Where the shadow of its upper edge ends, the sun is partly hidden.
    let mut means = [0; 12];
    for sample in 0..16 {
        let (plane, map) = map_of(&ground().of_sample(sample));
        for (mean, x) in means.iter_mut().zip(48..) {
            *mean += u32::from(texel(&plane, &map, Vec3::new(x as f32 + 0.5, 8.0, 32.0))[0] == 255);
        }
    }
    let partly = means.iter().filter(|mean| (1..16).contains(*mean)).count();
    assert!(means[0] == 0 && means[11] == 16 && partly >= 3, "{means:?}");
}

#[test]
fn the_ground_is_dark_where_the_sculpture_takes_the_sky() {
    let (plane, map) = map_of(&ground());
    let open = |x: f32| i32::from(texel(&plane, &map, Vec3::new(x, 8.0, 32.0))[1]);
    let places = [32.0, 38.0, 50.0, 70.0].map(open);
    assert!(places.is_sorted(), "{places:?}");
    assert!(places[0] < 100 && places[1] < 190 && places[3] > 235, "{places:?}");
    // Equally open on both sides.
    assert!((open(24.0) - open(40.0)).abs() < 16);
}

#[test]
fn pixels_show_the_place_on_the_plane_that_the_eye_sees() {
    let (plane, map) = map_of(&ground());
    let light = light_of(&ground(), &plane);
    let eye = Camera::framing(40.0, Vec3::new(0.3, 0.8, 1.0), Vec3::Y).eye(UVec2::new(200, 150));
    let at = Affine3A::from_translation(-Vec3::new(32.0, 18.0, 32.0));
    let rays = eye.pixel_rays(&at);
    let of = |ground: &Ground, map: &LightMap, point: Vec3| {
        let picture = GroundPicture::new(ground, &plane, &light, &rays, 1000).unwrap();
        let clip = eye.clip_from_grid(&at) * point.extend(1.0);
        let pixel = (Vec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5) * rays.size.as_vec2();
        picture.pixel(pixel, map)
    };
    // Half the light of white from the ambient light, and the sun's.
    let lit = |open: f32, sunlit: f32| {
        let grey = (128.0f32 / 255.0).powi(2);
        (grey * open + 0.5 * 0.5f32.sqrt() * sunlit).sqrt()
    };
    let mut bright = map.clone();
    bright.texels.fill([255, 255]);
    let mut dark = map.clone();
    dark.texels.fill([0, 0]);
    for x in [20.0, 40.0, 60.0] {
        let point = Vec3::new(x, 8.0, 50.0);
        let place = (across(1, point) - plane.centre) / plane.half;
        let inside = 1.0 - place.length_squared();
        let fade = inside * inside * (3.0 - 2.0 * inside);
        let [red, _, _, alpha] = of(&ground(), &bright, point);
        assert!((red - lit(1.0, 1.0)).abs() < 1e-3 && (alpha - fade).abs() < 1e-3, "{red} {alpha}");
        let caught = of(&Ground { shadow_only: true, ..ground() }, &bright, point);
        assert!(caught[3].abs() < 1e-3, "nothing is darker");
        let caught = of(&Ground { shadow_only: true, ..ground() }, &dark, point);
        assert!(caught[..3] == [0.0; 3] && (caught[3] - fade).abs() < 1e-3, "{caught:?}");
    }
    let [in_shadow, ..] = of(&ground(), &map, Vec3::new(46.0, 8.0, 32.0));
    assert!((lit(0.3, 0.0)..lit(1.0, 0.0)).contains(&in_shadow), "{in_shadow}");
    // From below, no ground is visible.
    let below = Camera::framing(40.0, Vec3::new(0.3, -0.8, 1.0), Vec3::Y).eye(UVec2::splat(9));
    let rays = below.pixel_rays(&at);
    assert_eq!(GroundPicture::new(&ground(), &plane, &light, &rays, 10), None);
}

#[test]
fn lines_stand_at_round_places_and_every_fifth_is_stronger() {
    let grid = scenes::solid_cube(32).unwrap();
    let plane = GroundPlane::below(&grid, Vec3::Y).unwrap();
    let light = light_of(&ground(), &plane);
    // Straight from above, with pixels of a tenth of a voxel.
    let rays = PixelRaysFromAbove { height: 100.0 }.rays();
    let picture = GroundPicture::new(&ground(), &plane, &light, &rays, 4).unwrap();
    let map = LightMap { texels: vec![[255; 2]; MAP_EDGE * MAP_EDGE] };
    let red = |x: f32| {
        let [red, _, _, alpha] = picture.pixel(Vec2::new(x * 10.0, 21.0), &map);
        assert!(alpha > 0.3);
        red
    };
    let plain = red(2.0);
    for voxel in 0..24 {
        let expected = match voxel {
            0 | 20 => 0.6,
            _ if voxel % 4 == 0 => 0.8,
            _ => 1.0,
        };
        let found = red(voxel as f32) / plain;
        assert!((found - expected).abs() < 1e-3, "{voxel}: {found}");
    }
}

/// Rays down to the plane y = 0, with ten pixels per voxel, from the corner x = z = 0.
struct PixelRaysFromAbove {
    height: f32,
}

impl PixelRaysFromAbove {
    fn rays(&self) -> crate::view::PixelRays {
        let per_pixel = 0.1 / self.height;
        crate::view::PixelRays {
            origin: Vec3::new(0.0, self.height, 0.0),
            corner: Vec3::NEG_Y,
            step_x: Vec3::X * per_pixel,
            step_y: Vec3::Z * per_pixel,
            size: UVec2::new(320, 320),
        }
    }
}
