//! The row of a dialog that chooses the size of a picture: that of the view, a usual one, or any.

use egui::{ComboBox, DragValue, Ui};
use glam::UVec2;

/// Common sizes of screens and films, in pixels.
const USUAL: [[u32; 2]; 5] = [[640, 480], [1280, 720], [1920, 1080], [2560, 1440], [3840, 2160]];

/// The chosen size of a picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PictureSize {
    OfView,
    Usual(UVec2),
    Custom(UVec2),
}

impl PictureSize {
    /// Returns the size in pixels for a view of `view_px`.
    pub fn px(self, view_px: UVec2) -> UVec2 {
        match self {
            PictureSize::OfView => view_px,
            PictureSize::Usual(size) | PictureSize::Custom(size) => size,
        }
    }

    fn name(self, view_px: UVec2) -> String {
        let UVec2 { x, y } = self.px(view_px);
        match self {
            PictureSize::OfView => format!("View ({x} × {y})"),
            PictureSize::Usual(_) => format!("{x} × {y}"),
            PictureSize::Custom(_) => "Custom".to_string(),
        }
    }

    /// Shows a row of a grid. The longest side of a picture is at most `most_px`.
    pub fn row(&mut self, ui: &mut Ui, view_px: UVec2, most_px: u32) {
        let label = ui.label("Size");
        ui.horizontal(|ui| {
            let custom = PictureSize::Custom(self.px(view_px));
            let usual = USUAL.map(|size| PictureSize::Usual(size.into()));
            ComboBox::from_id_salt("picture size")
                .width(150.0)
                .selected_text(self.name(view_px))
                .show_ui(ui, |ui| {
                    for size in [PictureSize::OfView].into_iter().chain(usual).chain([custom]) {
                        ui.selectable_value(self, size, size.name(view_px));
                    }
                })
                .response
                .labelled_by(label.id)
                .on_hover_text("Width and height in pixels");
            if let PictureSize::Custom(size) = self {
                for (value, what) in [(&mut size.x, "Width"), (&mut size.y, "Height")] {
                    ui.add(DragValue::new(value).range(16..=most_px).speed(4.0))
                        .on_hover_text(format!("{what} in pixels"));
                }
            }
        });
        ui.end_row();
    }
}
