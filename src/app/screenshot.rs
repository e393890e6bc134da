//! Pictures of the view, saved as PNG files or copied to the system's clipboard when a person asks
//! for one: the sculpture over its background, without tool, lines and panels.
//!
//! Takes pixels as they were read back from the device; returns what to tell the person. Knows no
//! window.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use arboard::{Clipboard, ImageData};
use ash::vk;
use directories::UserDirs;
use image::{DynamicImage, ImageFormat, Rgb, RgbImage};

use crate::format::store;
use crate::picture::PictureError;
use crate::shade::Pixels;

/// Number of names that are tried before the last is used again.
const MOST: u32 = 10_000;

/// Saves the pictures of one view, one per eye, without replacing a file: beside the sculpture's file, or in the
/// person's picture folder if there is none. Returns a sentence about it.
pub fn save(
    sculpture: Option<&Path>,
    format: vk::Format,
    eyes: &[Pixels],
) -> Result<String, PictureError> {
    let paths = save_beside(sculpture, format, eyes)?;
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    Ok(format!("Saved {}", names.join(" and ")))
}

/// Copies the pictures of one view to the system's clipboard, those of two eyes side by side. Returns a sentence about
/// it. Opens the clipboard if needed: egui's own also copies pictures, but does not report failures.
pub fn copy(
    clipboard: &mut Option<Clipboard>,
    format: vk::Format,
    eyes: &[Pixels],
) -> Result<String, arboard::Error> {
    let clipboard = match clipboard {
        Some(clipboard) => clipboard,
        none => none.insert(Clipboard::new()?),
    };
    let picture = DynamicImage::from(side_by_side(format, eyes)).into_rgba8();
    let (width, height) = picture.dimensions();
    let bytes = Cow::Owned(picture.into_raw());
    clipboard.set_image(ImageData { width: width as usize, height: height as usize, bytes })?;
    Ok(format!("Copied a picture of {width} × {height} pixels"))
}

/// Returns the pictures of the eyes in one, from left to right.
fn side_by_side(format: vk::Format, eyes: &[Pixels]) -> RgbImage {
    let width = eyes.iter().map(|pixels| pixels.size.x).sum();
    let height = eyes.iter().map(|pixels| pixels.size.y).max().unwrap_or(0);
    let mut all = RgbImage::new(width, height);
    let mut left = 0;
    for pixels in eyes {
        for (x, y, rgb) in picture(format, pixels).enumerate_pixels() {
            all.put_pixel(left + x, y, *rgb);
        }
        left += pixels.size.x;
    }
    all
}

fn save_beside(
    sculpture: Option<&Path>,
    format: vk::Format,
    eyes: &[Pixels],
) -> Result<Vec<PathBuf>, PictureError> {
    let (folder, name) = place(sculpture);
    save_in(&folder, &name, format, eyes)
}

/// Returns an unused name for a picture that takes time to make.
pub fn free_path(sculpture: Option<&Path>, kind: &str, ending: &str) -> PathBuf {
    let (folder, name) = place(sculpture);
    let dot = if ending.is_empty() { "" } else { "." };
    let path = |n: u32| folder.join(format!("{name}-{kind}-{n}{dot}{ending}"));
    (1..MOST).map(path).find(|path| !path.exists()).unwrap_or_else(|| path(MOST))
}

/// Returns the folder for pictures of a sculpture, and how their names begin.
fn place(sculpture: Option<&Path>) -> (PathBuf, String) {
    let beside = sculpture.and_then(Path::parent).filter(|folder| *folder != Path::new(""));
    let folder = beside.map_or_else(pictures_folder, Path::to_path_buf);
    let name = sculpture.and_then(Path::file_stem).map(|name| name.to_string_lossy().into_owned());
    (folder, name.unwrap_or_else(|| "sculpture".to_string()))
}

fn save_in(
    folder: &Path,
    name: &str,
    format: vk::Format,
    eyes: &[Pixels],
) -> Result<Vec<PathBuf>, PictureError> {
    let endings: &[&str] = if eyes.len() == 1 { &["png"] } else { &["left.png", "right.png"] };
    let names = |n: u32| -> Vec<PathBuf> {
        endings.iter().map(|ending| folder.join(format!("{name}-{n}.{ending}"))).collect()
    };
    let free = |paths: &Vec<PathBuf>| paths.iter().all(|path| !path.exists());
    let paths = (1..MOST).map(names).find(free).unwrap_or_else(|| names(MOST));
    for (path, pixels) in paths.iter().zip(eyes) {
        let mut png = std::io::Cursor::new(Vec::new());
        picture(format, pixels).write_to(&mut png, ImageFormat::Png)?;
        store::write_atomically(path, png.get_ref())
            .map_err(|error| PictureError::Write { path: path.clone(), error })?;
    }
    Ok(paths)
}

fn pictures_folder() -> PathBuf {
    let of = |user: UserDirs| user.picture_dir().unwrap_or(user.home_dir()).to_path_buf();
    UserDirs::new().map_or_else(|| PathBuf::from("."), of)
}

/// Returns the picture with the channel order of a file. Windows have their own orders.
fn picture(format: vk::Format, pixels: &Pixels) -> RgbImage {
    let ten_bits = |word: u32, at: u32| (((word >> at & 0x3ff) * 255 + 511) / 1023) as u8;
    let rgb = |pixel: [u8; 4]| {
        let [a, b, c, _] = pixel;
        let word = u32::from_le_bytes(pixel);
        Rgb(match format {
            vk::Format::B8G8R8A8_UNORM | vk::Format::B8G8R8A8_SRGB => [c, b, a],
            vk::Format::A2B10G10R10_UNORM_PACK32 => [0, 10, 20].map(|at| ten_bits(word, at)),
            vk::Format::A2R10G10B10_UNORM_PACK32 => [20, 10, 0].map(|at| ten_bits(word, at)),
            _ => [a, b, c],
        })
    };
    let width = pixels.size.x;
    RgbImage::from_fn(width, pixels.size.y, |x, y| rgb(pixels.rgba[(x + y * width) as usize]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    fn pixels(rgba: [u8; 4]) -> Pixels {
        Pixels { size: UVec2::new(2, 1), rgba: vec![rgba; 2] }
    }

    fn seen(path: &Path) -> [u8; 3] {
        image::open(path).unwrap().to_rgb8().get_pixel(1, 0).0
    }

    #[test]
    fn every_picture_gets_a_name_of_its_own_beside_the_sculpture() {
        let folder = tempfile::tempdir().unwrap();
        let sculpture = folder.path().join("head.vsc");
        let format = vk::Format::R8G8B8A8_UNORM;
        let one = save_beside(Some(&sculpture), format, &[pixels([1, 2, 3, 255])]).unwrap();
        let two = save_beside(Some(&sculpture), format, &[pixels([4, 5, 6, 255])]).unwrap();
        assert_eq!(
            [&one[..], &two[..]].concat(),
            ["head-1.png", "head-2.png"].map(|name| folder.path().join(name))
        );
        assert_eq!((seen(&one[0]), seen(&two[0])), ([1, 2, 3], [4, 5, 6]));
        let eyes = [pixels([7, 7, 7, 255]), pixels([8, 8, 8, 255])];
        let both = save_beside(Some(&sculpture), format, &eyes).unwrap();
        assert_eq!(
            both,
            ["head-1.left.png", "head-1.right.png"].map(|name| folder.path().join(name))
        );
        assert_eq!((seen(&both[0]), seen(&both[1])), ([7; 3], [8; 3]));
    }

    #[test]
    fn a_copy_has_both_eyes_side_by_side() {
        let eyes = [pixels([7, 8, 9, 255]), pixels([1, 2, 3, 255])];
        let both = side_by_side(vk::Format::B8G8R8A8_UNORM, &eyes);
        assert_eq!(both.dimensions(), (4, 1));
        assert_eq!([0, 1, 2, 3].map(|x| both.get_pixel(x, 0).0[0]), [9, 9, 3, 3]);
    }

    #[test]
    fn channels_are_in_the_order_of_the_windows_format() {
        let shown = |format, rgba| picture(format, &pixels(rgba)).get_pixel(0, 0).0;
        assert_eq!(shown(vk::Format::B8G8R8A8_SRGB, [3, 2, 1, 0]), [1, 2, 3]);
        assert_eq!(shown(vk::Format::R8G8B8A8_SRGB, [1, 2, 3, 0]), [1, 2, 3]);
        let word = 1023u32 | 512 << 10 | 3 << 30;
        assert_eq!(shown(vk::Format::A2B10G10R10_UNORM_PACK32, word.to_le_bytes()), [255, 128, 0]);
        assert_eq!(shown(vk::Format::A2R10G10B10_UNORM_PACK32, word.to_le_bytes()), [0, 128, 255]);
    }

    #[test]
    fn a_folder_that_is_not_there_is_named() {
        let error = save_beside(
            Some(Path::new("/there/is/no.vsc")),
            vk::Format::R8G8B8A8_UNORM,
            &[pixels([0; 4])],
        );
        assert!(error.unwrap_err().to_string().contains("/there/is/no-1.png"));
    }
}
