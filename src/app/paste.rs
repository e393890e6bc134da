//! Pictures from the system's clipboard. Each is kept as a file, since reference pictures and tools name files.
//!
//! Takes what the clipboard gives, and returns the file. Knows no window.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Cursor;
use std::path::{Path, PathBuf};

use arboard::{Clipboard, ImageData};
use image::{ImageFormat, RgbaImage};

use crate::folders;
use crate::format::store;

/// Folder of the pictures in the program's state folder.
const FOLDER: &str = "pasted";
const NO_PICTURE: &str = "The clipboard has no picture; copy one in another program first";

/// Keeps the picture on the clipboard, which it opens if needed. Returns the picture's file, or the reason why there is
/// none.
pub(super) fn picture_file(clipboard: &mut Option<Clipboard>) -> Result<PathBuf, String> {
    let opened = match clipboard {
        Some(clipboard) => Ok(clipboard),
        none => Clipboard::new().map(|new| none.insert(new)),
    };
    kept(opened.and_then(Clipboard::get_image), &folders::state_folder().join(FOLDER))
}

fn kept(picture: Result<ImageData, arboard::Error>, folder: &Path) -> Result<PathBuf, String> {
    match picture {
        Ok(picture) => keep(folder, picture),
        Err(arboard::Error::ContentNotAvailable) => Err(NO_PICTURE.to_string()),
        Err(error) => Err(format!("The clipboard cannot be read: {error}")),
    }
}

/// Writes a picture under a name derived from its contents, so that equal pictures share a file.
fn keep(folder: &Path, picture: ImageData) -> Result<PathBuf, String> {
    let (width, height) = (picture.width as u32, picture.height as u32);
    let bytes = picture.bytes.into_owned();
    let mut hasher = DefaultHasher::new();
    (width, height, &bytes).hash(&mut hasher);
    let path = folder.join(format!("pasted-{:016x}.png", hasher.finish()));
    let image = RgbaImage::from_raw(width, height, bytes).filter(|_| width > 0 && height > 0);
    let image = image.ok_or(NO_PICTURE)?;
    if path.is_file() {
        return Ok(path);
    }
    let failed = |error: &dyn std::fmt::Display| {
        format!("The pasted picture cannot be kept in {}: {error}", folder.display())
    };
    let mut png = Cursor::new(Vec::new());
    image.write_to(&mut png, ImageFormat::Png).map_err(|error| failed(&error))?;
    std::fs::create_dir_all(folder).map_err(|error| failed(&error))?;
    store::write_atomically(&path, png.get_ref()).map_err(|error| failed(&error))?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::workspace::Workspace;
    use crate::config::Config;
    use crate::input::{Action, Bindings};
    use crate::session::Session;
    use crate::ui::tasks::PasteAs;

    fn workspace() -> Workspace {
        let mut config = Config::default();
        config.new.dims = [16; 3];
        let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        Workspace::new(session, &config, Bindings::presets().unwrap())
    }

    fn picture(level: u8) -> ImageData<'static> {
        ImageData { width: 3, height: 2, bytes: vec![level; 24].into() }
    }

    #[test]
    fn pasted_pictures_are_files_kept_once_and_stand_as_references_or_are_painted_with() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("not there yet");
        let mut workspace = workspace();
        for level in [9, 9, 200] {
            workspace.use_pasted(kept(Ok(picture(level)), &folder), PasteAs::Reference);
        }
        let list = &workspace.ui.references;
        assert_eq!(list.len(), 3);
        assert!(list[0].path == list[1].path && list[0].path != list[2].path);
        assert_eq!(list[2].pixels.as_ref().unwrap().rgba[5], [200; 4]);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2);
        workspace.use_pasted(kept(Ok(picture(9)), &folder), PasteAs::ToolPicture);
        assert_eq!(workspace.editor.tool.picture, Some(workspace.ui.references[0].path.clone()));
    }

    #[test]
    fn there_are_no_more_references_than_can_be_shown() {
        let folder = tempfile::tempdir().unwrap();
        let mut workspace = workspace();
        (0..12).for_each(|level| {
            workspace.use_pasted(kept(Ok(picture(level)), folder.path()), PasteAs::Reference);
        });
        assert_eq!(workspace.ui.references.len(), crate::render::MAX_REFERENCES);
        assert!(workspace.ui.toasts.texts().any(|(_, text)| text.contains("remove one")));
    }

    #[test]
    fn pasting_something_else_than_a_picture_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let empty = ImageData { width: 0, height: 0, bytes: Vec::new().into() };
        let short = ImageData { width: 3, height: 2, bytes: vec![1].into() };
        for picture in [Ok(empty), Ok(short), Err(arboard::Error::ContentNotAvailable)] {
            let mut workspace = workspace();
            workspace.use_pasted(kept(picture, folder.path()), PasteAs::Reference);
            assert!(workspace.ui.toasts.texts().any(|(_, text)| text == NO_PICTURE));
            assert!(workspace.ui.references.is_empty());
        }
        let file = folder.path().join("file");
        std::fs::write(&file, "in the way").unwrap();
        let mut workspace = workspace();
        workspace.use_pasted(kept(Ok(picture(1)), &file), PasteAs::Reference);
        let named = file.display().to_string();
        assert!(workspace.ui.toasts.texts().any(|(_, text)| text.contains(&named)));
    }

    #[test]
    fn voxels_that_were_copied_are_pasted_first() {
        let mut workspace = workspace();
        workspace.act(Action::Paste);
        assert_eq!(workspace.ui.window_tasks.paste.take(), Some(PasteAs::Reference));
        workspace.act(Action::Copy);
        workspace.act(Action::ClearMarker);
        workspace.act(Action::Paste);
        assert_eq!(workspace.ui.window_tasks.paste, None);
        assert_eq!(workspace.session().document().history().undo_count(), 2);
    }
}
