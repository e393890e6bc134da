//! Carves a block by commands and renders it to a PNG file, with the CPU sampler and the software shader: `cargo run
//! --package sculpture-core --example carve -- carved.png`

use std::error::Error;

use image::{Rgba, RgbaImage, imageops};
use sculpture_core::glam::{UVec2, UVec3, Vec3};
use sculpture_core::{
    Camera, ColourDepth, Document, IndexMap, Lighting, Limits, NewSculpture, NormalField, Pixels,
    Rgb, ShadePose, ShadeSource, Smoothing, SoftwareShader, parse_script, raycast,
};

const SCRIPT: &str = "
add cuboid at=128,128,128 half=112
subtract ellipsoid at=128,128,128 half=142
add ellipsoid at=128,128,128 half=80 colour=#c8553c
subtract cuboid at=168,168,168 half=40
add ellipsoid at=128,128,128 half=44 colour=#d8b44a
";

/// Returns the carved sculpture, `size` pixels large.
pub fn picture(size: UVec2) -> Result<RgbaImage, Box<dyn Error>> {
    let (dims, voxel_size) = (UVec3::splat(256), Vec3::ONE);
    let (colour_depth, base) = (ColourDepth::Bits24, Rgb::STONE);
    let new = NewSculpture {
        dims,
        voxel_size,
        colour_depth,
        base,
        solid: false,
        room_vx: 0,
        grows: false,
    };
    let mut document = Document::new(&new, Limits::default())?;
    for (_, command) in parse_script(SCRIPT)? {
        document.apply(&command)?;
    }

    // Supersampled by 2, to be averaged.
    let eye = Camera::framing(190.0, Vec3::new(0.8, 0.6, 1.0), Vec3::Y).eye(size * 2);
    let (eye_from_world, world_from_grid) = (eye.eye_from_world, document.world_from_grid());
    let rays = eye.pixel_rays(&world_from_grid);
    let (mut map, mut pixels) = (IndexMap::new(rays), Pixels::default());
    raycast::sample(document.grid(), &rays, &mut map);
    let (pose, lighting) = (
        ShadePose { eye_from_world, world_from_grid },
        Lighting { smooth_normals: Smoothing::Near, occlusion: true, ..Lighting::default() },
    );
    let (grid, material) = (document.grid(), document.material());
    let source = ShadeSource { grid, material, normals: &NormalField::of(grid), mask: None };
    SoftwareShader::default().shade(&map, &source, &pose, &lighting, &mut pixels);
    let large = RgbaImage::from_fn(size.x * 2, size.y * 2, |x, y| {
        let [r, g, b, alpha] = pixels.rgba[(x + y * size.x * 2) as usize];
        Rgba(if alpha == 0 { [230, 233, 238, 255] } else { [r, g, b, 255] })
    });
    Ok(imageops::thumbnail(&large, size.x, size.y))
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "carved.png".to_string());
    picture(UVec2::new(800, 600))?.save(&path)?;
    println!("{path}");
    Ok(())
}
