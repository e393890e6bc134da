//! Reads images: PNG and JPEG files to a [`Texture`] to colour solids with, or to a [`Matcap`] to shade with.

use std::io::{BufRead, BufReader, Cursor, Seek};
use std::path::Path;

use glam::Vec2;
use image::{ImageReader, Limits};

use super::error::FormatError;
use super::store;
use crate::sculpture::Rgb;
use crate::shade::Matcap;
use crate::shade::look::MATCAP_EDGE;
use crate::tools::texture::{MAX_SIDE, Texture};

/// Greatest size of an image file.
const PICTURE_LIMIT_BYTES: u64 = 1 << 30;

/// Reads an image. Its format is detected from its first bytes, not its name. Transparency is ignored.
///
/// # Errors
/// If it cannot be read, is neither PNG nor JPEG, or is longer than [`MAX_SIDE`] on a side.
pub fn load_picture(path: &Path) -> Result<Texture, FormatError> {
    decode(BufReader::new(store::open(path)?))
}

/// Reads an image as [`load_picture`] does, and returns the bytes of the file as well.
pub fn load_picture_file(path: &Path) -> Result<(Texture, Vec<u8>), FormatError> {
    let file = store::read(path, PICTURE_LIMIT_BYTES, |_| Ok(()), &())?;
    Ok((picture_of(&file)?, file))
}

/// Reads an image file in memory as [`load_picture`] does.
pub fn picture_of(file: &[u8]) -> Result<Texture, FormatError> {
    decode(Cursor::new(file))
}

fn decode(file: impl BufRead + Seek) -> Result<Texture, FormatError> {
    let mut reader = ImageReader::new(file).with_guessed_format()?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| FormatError::Picture(e.to_string()))?.into_rgb8();
    let pixels = picture.pixels().map(|p| Rgb(p.0)).collect();
    Texture::new(picture.width(), pixels)
        .ok_or_else(|| FormatError::Picture("it has no pixels".to_string()))
}

/// Reads the picture of a lit ball that touches all four edges.
///
/// # Errors
/// As for [`load_picture`], and if it is not square, or too small to shade with.
pub fn load_matcap(path: &Path) -> Result<Matcap, FormatError> {
    const LEAST_PX: u32 = 16;
    let picture = load_picture(path)?;
    let [width, height] = picture.size();
    let refused = |rule: &str| {
        let size = format!("it has {width} x {height} pixels");
        Err(FormatError::Picture(format!("{size}, but a matcap {rule}")))
    };
    if width != height {
        return refused("is square: a ball that touches all four edges");
    }
    if width < LEAST_PX {
        return refused(&format!("needs at least {LEAST_PX} a side"));
    }
    // The mean of the pixels of a texel, or an interpolation in a smaller picture.
    let samples = width.div_ceil(MATCAP_EDGE as u32).min(8);
    let texel = 2.0 / (MATCAP_EDGE - 1) as f32;
    Ok(Matcap::from_fn(|at| {
        let mut sum = [0u32; 3];
        for i in 0..samples * samples {
            let part = Vec2::new((i % samples) as f32, (i / samples) as f32) + 0.5;
            let offset = (part / samples as f32 - 0.5) * texel;
            let colour = picture.sample((at + offset) * 0.5 + 0.5);
            sum.iter_mut().zip(colour.0).for_each(|(sum, c)| *sum += u32::from(c));
        }
        let count = samples * samples;
        Rgb(sum.map(|sum| ((sum + count / 2) / count) as u8))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matcap_is_read_at_any_size_and_what_is_no_square_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let save = |width: u32, height: u32| {
            let path = folder.path().join(format!("{width}x{height}.png"));
            let upper = |_, y| image::Rgb(if y < height / 2 { [200, 100, 50] } else { [9, 8, 7] });
            image::RgbImage::from_fn(width, height, upper).save(&path).unwrap();
            path
        };
        for edge in [16, 128, 500] {
            let matcap = load_matcap(&save(edge, edge)).unwrap();
            let texel = |x: usize, y: usize| matcap.texels()[x + y * MATCAP_EDGE].to_le_bytes();
            assert_eq!(texel(5, 20), [200, 100, 50, 255], "{edge}");
            assert_eq!(texel(120, 110), [9, 8, 7, 255], "{edge}");
        }
        for (path, message) in
            [(save(40, 30), "it has 40 x 30 pixels"), (save(8, 8), "at least 16")]
        {
            let error = load_matcap(&path).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn a_picture_is_read_and_what_is_none_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.png");
        let picture = image::RgbaImage::from_raw(2, 1, vec![1, 2, 3, 255, 4, 5, 6, 0]).unwrap();
        picture.save(&path).unwrap();
        let texture = load_picture(&path).unwrap();
        let pixels = vec![Rgb::new(1, 2, 3), Rgb::new(4, 5, 6)];
        assert_eq!(texture, Texture::new(2, pixels).unwrap());
        std::fs::write(&path, "no picture").unwrap();
        assert!(matches!(load_picture(&path), Err(FormatError::Picture(_))));
        assert!(matches!(load_picture(folder.path()), Err(FormatError::NotAFile)));
        assert!(matches!(load_picture(&folder.path().join("none")), Err(FormatError::Io(_))));
    }
}
