//! The dialog of a final picture: how large and exact, what lights it, what is sharp, and the file that it becomes.
//! While the picture is made, its [`Preview`] is shown in the sign of long work.
//!
//! Asks with a [`FinalRequest`]; knows neither files nor how light is traced.

use std::sync::{Arc, Mutex, PoisonError};

use egui::{
    Checkbox, ColorImage, ComboBox, DragValue, Grid, Id, Image, Key, Modal, ScrollArea, Slider,
    TextureHandle, TextureOptions, Ui,
};
use glam::UVec2;

use super::picture_size::PictureSize;
use super::{UiContext, UiRequest, UiState, theme};
use crate::sculpture::Rgb;
use crate::shade::Pixels;
use crate::trace::{Ground, LightOptions, MAX_FINAL_SAMPLES, Sun, TraceOptions};

/// The longest side of a picture, in pixels.
const MOST_PX: u32 = 8192;
/// The largest preview, in points.
const PREVIEW: [f32; 2] = [420.0, 300.0];
const WIDTH: f32 = 400.0;
/// Height of what is above and below the options, in points.
const BESIDE: f32 = 170.0;

/// The file that a final picture becomes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum FinalFile {
    #[default]
    Png,
    Jpeg,
    Exr,
}

impl FinalFile {
    const ALL: [FinalFile; 3] = [FinalFile::Png, FinalFile::Jpeg, FinalFile::Exr];

    /// The ending of its name.
    pub const fn ending(self) -> &'static str {
        match self {
            FinalFile::Png => "png",
            FinalFile::Jpeg => "jpg",
            FinalFile::Exr => "exr",
        }
    }

    const fn name(self) -> &'static str {
        match self {
            FinalFile::Png => "PNG",
            FinalFile::Jpeg => "JPEG",
            FinalFile::Exr => "OpenEXR",
        }
    }

    const fn help(self) -> &'static str {
        match self {
            FinalFile::Png => "For screens, without loss",
            FinalFile::Jpeg => "For screens, small",
            FinalFile::Exr => "Linear light with distance, colour and normals, for compositing",
        }
    }
}

/// A final picture that is asked for.
#[derive(Clone, PartialEq, Debug)]
pub struct FinalRequest {
    /// Pixels.
    pub size: UVec2,
    pub trace: TraceOptions,
    pub denoise: bool,
    pub exposure_ev: f32,
    pub file: FinalFile,
    /// On the graphics device, which shows voxels.
    pub on_gpu: bool,
}

/// What is chosen so far.
#[derive(Clone, PartialEq, Debug)]
pub struct FinalDialog {
    pub open: bool,
    pub size: PictureSize,
    pub trace: TraceOptions,
    /// The ground's colour, also while there is none.
    pub ground: Rgb,
    pub denoise: bool,
    pub exposure_ev: f32,
    pub file: FinalFile,
    pub on_gpu: bool,
}

impl Default for FinalDialog {
    fn default() -> FinalDialog {
        let trace = TraceOptions::default();
        FinalDialog {
            open: false,
            size: PictureSize::OfView,
            ground: trace.ground.map_or(Rgb::STONE, |ground| ground.colour),
            trace,
            denoise: true,
            exposure_ev: 0.0,
            file: FinalFile::default(),
            on_gpu: false,
        }
    }
}

impl FinalDialog {
    fn wanted(&self, view_px: UVec2) -> FinalRequest {
        FinalRequest {
            size: self.size.px(view_px),
            trace: self.trace,
            denoise: self.denoise,
            exposure_ev: self.exposure_ev,
            file: self.file,
            on_gpu: self.on_gpu,
        }
    }
}

/// A picture in progress, as the thread that makes it shows it.
#[derive(Default)]
pub struct Preview {
    news: Arc<Mutex<Option<Pixels>>>,
    texture: Option<TextureHandle>,
}

impl Preview {
    /// Where the picture so far is put.
    pub fn news(&self) -> Arc<Mutex<Option<Pixels>>> {
        self.news.clone()
    }

    /// Shows what has been put there last.
    pub fn show(&mut self, ui: &mut Ui) {
        let news = self.news.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(Pixels { size, rgba }) = news {
            let size = [size.x as usize, size.y as usize];
            let picture = ColorImage::from_rgba_unmultiplied(size, rgba.as_flattened());
            match &mut self.texture {
                Some(texture) => texture.set(picture, TextureOptions::LINEAR),
                none => {
                    let load = ui.load_texture("final picture", picture, TextureOptions::LINEAR);
                    *none = Some(load);
                }
            }
        }
        if let Some(texture) = &self.texture {
            ui.vertical_centered(|ui| ui.add(Image::new(texture).max_size(PREVIEW.into())));
            ui.add_space(4.0);
        }
    }
}

pub fn show(root: &Ui, state: &mut UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    if !state.dialogs.final_picture.open {
        return;
    }
    let response = Modal::new(Id::new("final picture")).show(root.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.heading("Final picture");
        ui.weak("Traces light through the sculpture as the view shows it.");
        ui.add_space(4.0);
        let dialog = &mut state.dialogs.final_picture;
        // While a field or a button has the keyboard, Enter is its own.
        let free = ui.memory(|memory| memory.focused().is_none());
        let enter = free && ui.input(|input| input.key_pressed(Key::Enter));
        ui.spacing_mut().slider_width = 190.0;
        // In a small window it scrolls, and the buttons stay.
        let room = (ui.ctx().content_rect().height() - BESIDE).max(80.0);
        ScrollArea::vertical().max_height(room).show(ui, |ui| {
            Grid::new("final picture").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
                dialog.size.row(ui, context.picture_px, MOST_PX);
                quality(ui, dialog);
                light(ui, &mut dialog.trace.light);
                ground(ui, dialog);
                lens(ui, dialog);
                file(ui, dialog);
            });
        });
        if dialog.on_gpu {
            ui.weak("The graphics device traces the voxels' cubes, and shows no preview.");
        }
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            let make = ui.add(theme::primary(ui.visuals(), "Make picture"));
            let make = make.on_hover_text(
                "Saved beside the sculpture, under a name of its own; can be cancelled",
            );
            if make.clicked() || enter {
                let wanted = dialog.wanted(context.picture_px);
                requests.push(UiRequest::FinalPicture(Box::new(wanted)));
                dialog.open = false;
            }
            if ui.button("Cancel").clicked() {
                dialog.open = false;
            }
            if ui.button("Defaults").on_hover_text("Back to a clear day at 64 samples").clicked() {
                *dialog = FinalDialog { open: true, ..FinalDialog::default() };
            }
        });
    });
    if response.should_close() {
        state.dialogs.final_picture.open = false;
    }
}

fn quality(ui: &mut Ui, dialog: &mut FinalDialog) {
    let label = ui.label("Samples");
    let samples = Slider::new(&mut dialog.trace.samples, 1..=MAX_FINAL_SAMPLES).logarithmic(true);
    ui.add(samples)
        .labelled_by(label.id)
        .on_hover_text("Rays of each pixel: four times as many halve the noise");
    ui.end_row();
    ui.label("");
    ui.checkbox(&mut dialog.denoise, "Remove noise")
        .on_hover_text("Filters what noise remains, without blurring edges");
    ui.end_row();
    let label = ui.label("Exposure");
    let exposure = Slider::new(&mut dialog.exposure_ev, -10.0..=10.0).suffix(" EV").max_decimals(1);
    ui.add(exposure)
        .labelled_by(label.id)
        .on_hover_text("Doubles the light of PNG and JPEG with each unit");
    ui.end_row();
}

fn light(ui: &mut Ui, light: &mut LightOptions) {
    let LightOptions::Outdoors { sun, sky, .. } = light else { return };
    let Sun { azimuth_deg, elevation_deg, size_deg, strength } = sun;
    for (name, value, range, suffix, help) in [
        (
            "Sun azimuth",
            azimuth_deg,
            -180.0..=180.0,
            "°",
            "Where the sun stands: 0 is behind the viewer, more is to the right",
        ),
        (
            "Sun elevation",
            elevation_deg,
            0.0..=90.0,
            "°",
            "Height of the sun above the horizon; at 0 it has set",
        ),
        ("Sun size", size_deg, 0.2..=60.0, "°", "The larger, the softer the shadows"),
        ("Sun strength", strength, 0.0..=10.0, "", "1 is a clear day"),
        ("Sky", sky, 0.0..=10.0, "", "Strength of the light of the sky; 1 is a clear day"),
    ] {
        let label = ui.label(name);
        let slider = Slider::new(value, range).suffix(suffix).max_decimals(1);
        ui.add(slider).labelled_by(label.id).on_hover_text(help);
        ui.end_row();
    }
}

fn ground(ui: &mut Ui, dialog: &mut FinalDialog) {
    ui.label("");
    ui.horizontal(|ui| {
        let mut has_ground = dialog.trace.ground.is_some();
        ui.checkbox(&mut has_ground, "Ground")
            .on_hover_text("An even ground that the sculpture stands on and throws its shadow on");
        ui.add_enabled_ui(has_ground, |ui| {
            ui.color_edit_button_srgb(&mut dialog.ground.0).on_hover_text("Colour of the ground");
        });
        dialog.trace.ground = has_ground.then_some(Ground { colour: dialog.ground });
    });
    ui.end_row();
}

fn lens(ui: &mut Ui, dialog: &mut FinalDialog) {
    let lens = &mut dialog.trace.lens;
    let label = ui.label("Depth of field");
    let mut percent = lens.aperture * 100.0;
    let slider = Slider::new(&mut percent, 0.0..=50.0).suffix(" %").max_decimals(1);
    let slider = ui.add(slider).labelled_by(label.id).on_hover_text(
        "Diameter of the lens over the distance of what is sharp; at 0 all is sharp, 4 shows it",
    );
    if slider.changed() {
        lens.aperture = percent / 100.0;
    }
    ui.end_row();
    let label = ui.label("Focus");
    let has_focus = lens.aperture > 0.0;
    ui.horizontal(|ui| {
        for (share, prefix, help) in [
            (&mut lens.focus.x, "X ", "What is sharp: a place in the picture, from the left"),
            (&mut lens.focus.y, "Y ", "What is sharp: a place in the picture, from the top"),
        ] {
            let mut shown = *share * 100.0;
            let value = DragValue::new(&mut shown)
                .range(0.0..=100.0)
                .prefix(prefix)
                .suffix(" %")
                .max_decimals(0);
            let field = ui.add_enabled(has_focus, value).labelled_by(label.id);
            if field.on_hover_text(help).changed() {
                *share = shown / 100.0;
            }
        }
    });
    ui.end_row();
}

fn file(ui: &mut Ui, dialog: &mut FinalDialog) {
    let label = ui.label("File");
    ComboBox::from_id_salt("final file")
        .width(150.0)
        .selected_text(dialog.file.name())
        .show_ui(ui, |ui| {
            for file in FinalFile::ALL {
                let choice = ui.selectable_value(&mut dialog.file, file, file.name());
                choice.on_hover_text(file.help());
            }
        })
        .response
        .labelled_by(label.id)
        .on_hover_text(dialog.file.help());
    ui.end_row();
    ui.label("");
    ui.add(Checkbox::new(&mut dialog.on_gpu, "Trace on the graphics device")).on_hover_text(
        "Much faster on a GPU, but shows the voxels' cubes instead of the smooth surface",
    );
    ui.end_row();
}
