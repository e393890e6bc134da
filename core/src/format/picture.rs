//! Reads images to colour solids with: PNG and JPEG files to a [`Texture`].

use std::io::BufReader;
use std::path::Path;

use image::{ImageReader, Limits};

use super::error::FormatError;
use super::store;
use crate::sculpture::Rgb;
use crate::tools::texture::{MAX_SIDE, Texture};

/// Reads an image. Its format is detected from its first bytes, not its name. Transparency is ignored.
///
/// # Errors
/// If it cannot be read, is neither PNG nor JPEG, or is longer than [`MAX_SIDE`] on a side.
pub fn load_picture(path: &Path) -> Result<Texture, FormatError> {
    let file = store::open(path)?;
    let mut reader = ImageReader::new(BufReader::new(file)).with_guessed_format()?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| FormatError::Picture(e.to_string()))?.into_rgb8();
    let pixels = picture.pixels().map(|p| Rgb(p.0)).collect();
    Texture::new(picture.width(), pixels)
        .ok_or_else(|| FormatError::Picture("it has no pixels".to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

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
