//! Files dragged onto the window: a sculpture, volume or model is opened, an image becomes a reference picture. While a
//! file is over the window, a sign shows the effect of dropping it.
//!
//! Takes the drag events of the window system and the open dialog; gives requests. Reads no file: its contents are
//! judged when it is opened.

use std::path::{Path, PathBuf};

use egui::{Align2, Area, Frame, Id, LayerId, Order, Rect, Stroke, StrokeKind, Ui};

use crate::format::options::ImportOptions;
use crate::format::{READ_ENDINGS, can_be_read};
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::widgets::theme;

/// Extensions of images that can be reference pictures.
const PICTURE_ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// The use of dropped files.
#[derive(PartialEq, Eq, Debug)]
enum DroppedUse {
    Open(PathBuf),
    References(Vec<PathBuf>),
    /// Nothing, for this reason.
    Refused(String),
}

pub fn show(root: &Ui, state: &mut UiState, within: Rect, requests: &mut Vec<UiRequest>) {
    let (hovered, dropped) = root.input(|input| {
        let hovered = input.raw.hovered_files.iter().filter_map(|file| file.path.clone());
        let dropped = input.raw.dropped_files.iter().map(|file| file.path().to_path_buf());
        (once(hovered), once(dropped))
    });
    let is_modal = state.dialogs.is_modal();
    if !hovered.is_empty() {
        sign(root, within, &use_of(&hovered, is_modal));
    }
    if dropped.is_empty() {
        return;
    }
    if let Some(gone) = dropped.iter().find(|path| !path.try_exists().unwrap_or(true)) {
        let (name, folder) = (name_of(gone), gone.parent().unwrap_or(gone).display());
        let text = format!(
            "{name} is not in {folder}: it was moved or deleted, or its disk is not connected"
        );
        return state.toasts.error(text);
    }
    match use_of(&dropped, is_modal) {
        DroppedUse::Open(path) => {
            let upright = state.known_files.upright.of(&path);
            let import = ImportOptions { upright, ..ImportOptions::default() };
            let at_once = root.input(|input| input.modifiers.shift);
            state.dialogs.import.open(path, import, at_once, requests);
        }
        DroppedUse::References(paths) => {
            requests.extend(paths.into_iter().map(UiRequest::AddReference));
        }
        DroppedUse::Refused(why) => state.toasts.error(why),
    }
}

/// Returns each path once: X11 may name a file again whenever the pointer moves.
fn once(paths: impl Iterator<Item = PathBuf>) -> Vec<PathBuf> {
    let mut seen = Vec::new();
    for path in paths {
        if !seen.contains(&path) {
            seen.push(path);
        }
    }
    seen
}

fn use_of(paths: &[PathBuf], is_modal: bool) -> DroppedUse {
    if is_modal {
        return DroppedUse::Refused("Close the open dialog before dropping files".to_owned());
    }
    let is_picture = |path: &PathBuf| {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        ending.is_some_and(|ending| PICTURE_ENDINGS.contains(&ending.as_str()))
    };
    if paths.iter().all(is_picture) {
        return DroppedUse::References(paths.to_vec());
    }
    match paths {
        [path] if can_be_read(path) => DroppedUse::Open(path.clone()),
        [path] => {
            let name = name_of(path);
            DroppedUse::Refused(format!(
                "{name} cannot be opened; drop a file that ends in .{}, a folder of DICOM files, or an image",
                READ_ENDINGS.join(", .")
            ))
        }
        _ => DroppedUse::Refused("Drop one sculpture at a time, or only images".to_owned()),
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn sign(root: &Ui, within: Rect, what: &DroppedUse) {
    let text = match what {
        DroppedUse::Open(path) => format!("Drop to open {}", name_of(path)),
        DroppedUse::References(paths) if paths.len() == 1 => {
            "Drop as a reference picture".to_owned()
        }
        DroppedUse::References(paths) => format!("Drop as {} reference pictures", paths.len()),
        DroppedUse::Refused(why) => why.clone(),
    };
    let visuals = &root.style().visuals;
    let colour = match what {
        DroppedUse::Refused(_) => theme::error_colour(visuals),
        _ => visuals.hyperlink_color,
    };
    let layer = LayerId::new(Order::Foreground, Id::new("drop target"));
    let edge = within.shrink(5.0);
    root.ctx().layer_painter(layer).rect_stroke(
        edge,
        6.0,
        Stroke::new(3.0, colour),
        StrokeKind::Inside,
    );
    Area::new(Id::new("dropped"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(within.center())
        .interactable(false)
        .show(root.ctx(), |ui| Frame::popup(ui.style()).show(ui, |ui| ui.heading(text)));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uses(names: &[&str]) -> DroppedUse {
        use_of(&names.iter().map(PathBuf::from).collect::<Vec<_>>(), false)
    }

    #[test]
    fn one_sculpture_is_opened_and_images_are_references() {
        assert_eq!(uses(&["/a/b.vsc"]), DroppedUse::Open("/a/b.vsc".into()));
        assert_eq!(uses(&["head.PVM"]), DroppedUse::Open("head.PVM".into()));
        assert_eq!(uses(&["/a/brain.nii.gz"]), DroppedUse::Open("/a/brain.nii.gz".into()));
        assert_eq!(
            uses(&["a.png", "b.JPG"]),
            DroppedUse::References(vec!["a.png".into(), "b.JPG".into()])
        );
        for names in
            [&["a.vsc", "b.vsc"][..], &["a.vsc", "b.png"], &["a.txt"], &["a.gz"], &["folder"]]
        {
            assert!(matches!(uses(names), DroppedUse::Refused(_)), "{names:?}");
        }
        assert!(matches!(use_of(&["a.vsc".into()], true), DroppedUse::Refused(_)));
    }
}
