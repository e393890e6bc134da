//! Sessions with files and pictures.

use super::*;
use crate::sculpture::{ColourDepth, Rgb};

#[test]
fn a_picture_is_read_anew_with_every_stroke() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("colour.png");
    let write = |rgb: [u8; 3]| {
        image::RgbImage::from_pixel(2, 2, image::Rgb(rgb)).save(&path).unwrap();
    };
    let new = NewSculpture {
        dims: glam::UVec3::splat(16),
        voxel_size: glam::Vec3::ONE,
        colour_depth: ColourDepth::Bits24,
        base: Rgb([128; 3]),
        solid: true,
    };
    let mut session = Session::new(&new, Limits::default()).unwrap();
    let paint = format!("texture \"{}\" cuboid at=8,8,8 half=4", path.display());
    for rgb in [[200, 10, 20], [30, 220, 40]] {
        write(rgb);
        for line in ["begin", &paint, "end"] {
            session.execute(&line.parse().unwrap(), &()).unwrap();
        }
        let contents = session.document().contents();
        assert_eq!(contents.rgb(glam::UVec3::splat(8)).0, rgb);
    }
    // An empty stroke forgets the picture, but not that it was used.
    for line in ["begin", "end", "array count=1 step=4,0,0"] {
        session.execute(&line.parse().unwrap(), &()).unwrap();
    }
    assert_eq!(session.document().contents().rgb(glam::UVec3::splat(11)).0, [30, 220, 40]);
    std::fs::remove_file(&path).unwrap();
    session.execute(&Command::Begin { label: String::new() }, &()).unwrap();
    let error = session.execute(&paint.parse().unwrap(), &()).unwrap_err();
    assert!(error.to_string().contains("colour.png"), "{error}");
}
