//! Reference pictures: reads their files, and gives the renderer those of the window's next picture.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;
use image::{DynamicImage, ImageReader, Limits};

use crate::input::Side;
use crate::render::{MAX_REFERENCES, ReferencePicture};
use crate::sculpture::Grid;
use crate::shade::Pixels;
use crate::ui::UiState;
use crate::ui::references::{Reference, side_seen};
use crate::ui::widgets::toasts::Toasts;

/// The longest side of a file that is read, in pixels.
const MAX_FILE_SIDE: u32 = 16_384;
/// The longest side that is shown; larger ones are made smaller.
const MAX_SIDE: u32 = 2048;

/// Adds a picture on the side facing the viewer, or else the front. Reports a file that cannot be read. `axes`: those
/// of the grid in the picture.
pub(super) fn add(ui: &mut UiState, path: PathBuf, grid: &Grid, axes: &[Vec3; 3]) {
    if ui.references.len() >= MAX_REFERENCES {
        return ui.toasts.error(format!(
            "There are {MAX_REFERENCES} reference pictures already; remove one of them first"
        ));
    }
    match read(&path) {
        Ok(pixels) => {
            let side = side_seen(ui.view.up, axes).unwrap_or(Side::Front);
            let height = grid.dims().max_element() as f32;
            ui.references.push(Reference::new(path, Some(pixels), side, height));
            ui.dialogs.references.open = true;
        }
        Err(text) => ui.toasts.error(text),
    }
}

/// Reads the files of remembered pictures.
pub(super) fn read_remembered(list: &mut [Reference], toasts: &mut Toasts) {
    for reference in list {
        match read(&reference.path) {
            Ok(pixels) => reference.pixels = Some(pixels),
            Err(text) => toasts.error(text),
        }
    }
}

/// Returns the reference pictures of the window's next picture. `axes`: those of the grid in it.
pub(super) fn pictures(
    list: &[Reference],
    grid: &Grid,
    up: Vec3,
    axes: &[Vec3; 3],
) -> Vec<ReferencePicture> {
    let placed = |one: &Reference| one.placed(grid.dims(), grid.voxel_size(), up, axes);
    list.iter().filter_map(placed).collect()
}

/// Hides all reference pictures, since the device has no memory for them.
pub(super) fn hide(list: &mut [Reference], toasts: &mut Toasts, reason: &str) {
    list.iter_mut().for_each(|reference| reference.pixels = None);
    toasts.error(format!("The reference pictures cannot be shown: {reason}"));
}

/// Reads a PNG or JPEG file, made smaller if it is large.
fn read(path: &Path) -> Result<Arc<Pixels>, String> {
    let failed = |error: &dyn std::fmt::Display| format!("Cannot read {}: {error}", path.display());
    let mut reader = ImageReader::open(path)
        .and_then(ImageReader::with_guessed_format)
        .map_err(|error| failed(&error))?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_FILE_SIDE), Some(MAX_FILE_SIDE));
    reader.limits(limits);
    let mut picture: DynamicImage = reader.decode().map_err(|error| failed(&error))?;
    if picture.width().max(picture.height()) > MAX_SIDE {
        picture = picture.thumbnail(MAX_SIDE, MAX_SIDE);
    }
    let picture = picture.into_rgba8();
    let size = glam::UVec2::new(picture.width(), picture.height());
    let rgba = picture.pixels().map(|pixel| pixel.0).collect();
    Ok(Arc::new(Pixels { size, rgba }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::workspace::Workspace;
    use crate::config::Config;
    use crate::input::{Action, Bindings};
    use crate::session::Session;
    use crate::ui::widgets::toasts::Tone;

    fn workspace() -> Workspace {
        let mut config = Config::default();
        config.new.dims = [32; 3];
        let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        Workspace::new(session, &config, Bindings::presets().unwrap())
    }

    #[test]
    fn a_picture_is_added_on_the_side_that_is_seen_and_made_smaller_if_it_is_large() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.png");
        image::RgbaImage::from_pixel(3000, 30, image::Rgba([9, 8, 7, 255])).save(&path).unwrap();
        let mut workspace = workspace();
        workspace.act(Action::LookFrom(Side::Top));
        workspace.add_reference(path.clone());
        let [reference] = &workspace.ui.references[..] else { panic!("one picture") };
        assert_eq!((reference.side, reference.height_vx), (Side::Top, 32.0));
        let pixels = reference.pixels.as_ref().unwrap();
        assert_eq!((pixels.size.x, pixels.rgba[5]), (MAX_SIDE, [9, 8, 7, 255]));
        assert_eq!(workspace.reference_pictures().len(), 1);
        assert!(workspace.reference_pictures() == workspace.reference_pictures());
    }

    #[test]
    fn a_file_that_cannot_be_read_is_said_and_a_remembered_one_keeps_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("none.png");
        let mut workspace = workspace();
        workspace.add_reference(path.clone());
        assert!(workspace.ui.references.is_empty());
        workspace.ui.references.push(Reference::new(path, None, Side::Left, 9.0));
        read_remembered(&mut workspace.ui.references, &mut workspace.ui.toasts);
        assert_eq!(workspace.ui.references.len(), 1);
        assert!(workspace.reference_pictures().is_empty());
        let errors = workspace
            .ui
            .toasts
            .texts()
            .filter(|(tone, text)| *tone == Tone::Error && text.contains("none.png"));
        assert!(errors.count() >= 1);
    }
}
