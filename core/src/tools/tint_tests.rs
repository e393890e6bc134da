use proptest::prelude::*;

use super::*;

fn tinted(tint: Tint, v: UVec3, now: Rgb) -> Rgb {
    tint.check().unwrap();
    Tinter::new(&tint, Vec3::ONE, Rgb::STONE).colour(v, now)
}

fn adjust(hue_deg: f32, saturation: f32, value: f32) -> Tint {
    Tint::Adjust { hue_deg, saturation, value }
}

const RED: Rgb = Rgb::new(255, 0, 0);
const BLUE: Rgb = Rgb::new(0, 0, 255);

proptest! {
    #[test]
    fn neutral_tints_keep_every_colour(rgb in prop::array::uniform3(any::<u8>()), at in prop::array::uniform3(0u32..4096)) {
        let (v, now) = (UVec3::from(at), Rgb(rgb));
        prop_assert_eq!(tinted(adjust(0.0, 1.0, 1.0), v, now), now);
        prop_assert_eq!(tinted(adjust(360.0, 1.0, 1.0), v, now), now);
        let (from_vx, to_vx) = (Vec3::ZERO, Vec3::new(3.0, 4000.0, 9.0));
        let none = Tint::Gradient { from_vx, to_vx, colours: [RED, BLUE], strength: 0.0 };
        prop_assert_eq!(tinted(none, v, now), now);
        prop_assert_eq!(tinted(Tint::Noise { colour: RED, size: 9.0, amount: 0.0, seed: 3 }, v, now), now);
    }

    #[test]
    fn oklab_and_back_is_the_colour(rgb in prop::array::uniform3(any::<u8>())) {
        prop_assert_eq!(oklab_to_rgb(oklab_of(Rgb(rgb))), Rgb(rgb));
    }
}

#[test]
fn hue_saturation_and_value_do_what_they_say() {
    let tints = [
        (adjust(120.0, 1.0, 1.0), RED, Rgb::new(0, 255, 0)),
        (adjust(-120.0, 1.0, 1.0), RED, BLUE),
        (adjust(60.0, 1.0, 1.0), Rgb::new(200, 100, 100), Rgb::new(200, 200, 100)),
        (adjust(0.0, 0.0, 1.0), Rgb::new(200, 100, 50), Rgb::new(200, 200, 200)),
        (adjust(0.0, 0.5, 1.0), RED, Rgb::new(255, 128, 128)),
        (adjust(0.0, 8.0, 1.0), Rgb::new(200, 199, 180), Rgb::new(200, 192, 40)),
        (adjust(0.0, 1.0, 0.5), Rgb::new(200, 100, 50), Rgb::new(100, 50, 25)),
        (adjust(0.0, 1.0, 8.0), Rgb::new(100, 50, 0), Rgb::new(255, 128, 0)),
        (adjust(77.0, 3.0, 2.0), Rgb::new(0, 0, 0), Rgb::new(0, 0, 0)),
    ];
    for (tint, now, expected) in tints {
        assert_eq!(tinted(tint, UVec3::ZERO, now), expected, "{tint:?}");
    }
}

#[test]
fn a_gradient_goes_from_one_colour_to_the_other_along_its_axis() {
    let gradient = |from: Vec3, to: Vec3, strength| Tint::Gradient {
        from_vx: from,
        to_vx: to,
        colours: [RED, BLUE],
        strength,
    };
    let along_y = gradient(Vec3::new(7.0, 10.0, 3.0), Vec3::new(7.0, 50.0, 3.0), 1.0);
    let colour = |y| tinted(along_y, UVec3::new(90, y, 2), Rgb::STONE);
    assert_eq!([colour(0), colour(9), colour(50), colour(99)], [RED, RED, BLUE, BLUE]);
    let blues: Vec<u8> = (10..50).map(|y| colour(y).0[2]).collect();
    assert!(blues.is_sorted() && blues[20] > 60 && blues[20] < 220, "{blues:?}");
    // Mirrored ends give mirrored colours.
    let back = gradient(Vec3::new(7.0, 50.0, 3.0), Vec3::new(7.0, 10.0, 3.0), 1.0);
    for y in 0..60 {
        let mirrored = tinted(back, UVec3::new(90, 59 - y, 2), Rgb::STONE);
        assert_eq!(colour(y), mirrored, "{y}");
    }
    let half = gradient(Vec3::ZERO, Vec3::Y, 0.5);
    assert_eq!(tinted(half, UVec3::new(0, 5, 0), Rgb::new(100, 100, 100)), Rgb::new(50, 50, 178));
    // Planes of one colour are perpendicular to the gradient in space, also where voxels are elongated.
    let long = Vec3::new(1.0, 2.0, 1.0);
    let slanted = gradient(Vec3::ZERO, Vec3::new(8.0, 4.0, 0.0), 1.0);
    let tinter = Tinter::new(&slanted, long, Rgb::STONE);
    let at = |x, y| tinter.colour(UVec3::new(x, y, 0), Rgb::STONE);
    assert_eq!(at(6, 1), at(4, 2));
}

#[test]
fn noise_has_patches_of_its_size_and_depends_on_its_seed() {
    let colour = |v: UVec3, size, seed| {
        tinted(Tint::Noise { colour: BLUE, size, amount: 1.0, seed }, v, RED).0[2]
    };
    let line = |size, seed| -> Vec<u8> {
        (0..512).map(|x| colour(UVec3::new(x, 31, 77), size, seed)).collect()
    };
    let roughness = |line: &[u8]| -> u32 {
        line.windows(2).map(|pair| u32::from(pair[0].abs_diff(pair[1]))).sum()
    };
    let (fine, coarse) = (line(8.0, 1), line(64.0, 1));
    assert!(roughness(&fine) > 3 * roughness(&coarse));
    assert!(coarse.iter().max().unwrap() - coarse.iter().min().unwrap() > 60);
    assert_ne!(coarse, line(64.0, 2));
    assert_eq!(coarse, line(64.0, 1));
    let mean: u32 = fine.iter().map(|&blue| u32::from(blue)).sum::<u32>() / 512;
    assert!((100..156).contains(&mean), "{mean}");
}

#[test]
fn numbers_out_of_range_are_refused() {
    let gradient = |to_vx, strength| Tint::Gradient {
        from_vx: Vec3::ZERO,
        to_vx,
        colours: [RED, BLUE],
        strength,
    };
    let noise = |size, amount| Tint::Noise { colour: RED, size, amount, seed: 0 };
    for tint in [
        adjust(f32::NAN, 1.0, 1.0),
        adjust(361.0, 1.0, 1.0),
        adjust(0.0, -0.1, 1.0),
        adjust(0.0, 1.0, f32::INFINITY),
        gradient(Vec3::ZERO, 1.0),
        gradient(Vec3::splat(f32::NAN), 1.0),
        gradient(Vec3::splat(1e30), 1.0),
        gradient(Vec3::ONE, 1.1),
        noise(0.5, 1.0),
        noise(f32::NAN, 1.0),
        noise(8.0, -0.1),
    ] {
        assert!(tint.check().is_err(), "{tint:?}");
    }
}
