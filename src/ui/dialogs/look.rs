//! The choice of a look: the materials of the surface, each with a small picture of a ball in the present light, and
//! the matcap's file.
//!
//! Changes the look in the [`ViewState`]; reads the chosen matcap file. Must not know how it is chosen.

use std::path::PathBuf;

use egui::{Button, ColorImage, Grid, Id, Image, TextureHandle, TextureOptions, Ui, vec2};

use crate::format::load_matcap;
use crate::render::light::MatcapFile;
use crate::shade::ball::ball;
use crate::shade::{Lighting, Look};
use crate::ui::view_state::ViewState;
use crate::ui::widgets::toasts::Toasts;

/// Edge of a picture, in points and in pixels.
const PICTURE: f32 = 32.0;
const PICTURE_PX: u32 = 64;
const COLUMNS: usize = 2;
/// The width of the longest name, so that the columns are even.
const BUTTON_WIDTH: f32 = 127.0;

/// Shows buttons for all looks, and for the picture of the matcap if that is the look. Returns true if the person wants
/// to choose the file of another matcap.
pub fn show(ui: &mut Ui, view: &mut ViewState) -> bool {
    let pictures = pictures(ui, view.lighting());
    let light = &mut view.light;
    let mut another = false;
    Grid::new("looks").num_columns(COLUMNS).show(ui, |ui| {
        for (i, (look, picture)) in Look::ALL.into_iter().zip(&pictures).enumerate() {
            let (name, meaning) = words(look);
            let image = Image::new((picture.id(), vec2(PICTURE, PICTURE)));
            let button = Button::image_and_text(image, name)
                .selected(light.look == look)
                .min_size(vec2(BUTTON_WIDTH, PICTURE));
            if ui.add(button).on_hover_text(meaning).clicked() {
                light.look = look;
            }
            if i % COLUMNS == COLUMNS - 1 {
                ui.end_row();
            }
        }
    });
    if light.look == Look::Matcap {
        ui.horizontal(|ui| {
            another = ui
                .button("Choose a matcap …")
                .on_hover_text("A square PNG or JPEG of a lit ball that touches all four edges")
                .clicked();
            let reset = ui.add_enabled(light.matcap.path().is_some(), Button::new("Built-in"));
            if reset.on_hover_text("The matcap that comes with the program").clicked() {
                light.matcap = MatcapFile::default();
            }
        });
        if let Some((path, name)) =
            light.matcap.path().and_then(|path| Some((path, path.file_name()?)))
        {
            ui.weak(name.to_string_lossy()).on_hover_text(path.to_string_lossy());
        }
    }
    another
}

/// Uses the picture of a file as the matcap, or reports why it cannot.
pub fn take_matcap(view: &mut ViewState, toasts: &mut Toasts, path: PathBuf) {
    match load_matcap(&path) {
        Ok(matcap) => {
            let light = &mut view.light;
            (light.look, light.matcap) = (Look::Matcap, MatcapFile::new(path, matcap));
        }
        Err(error) => {
            let name = path.display();
            toasts.error(format!("{name} cannot be used as a matcap: {error}"));
        }
    }
}

fn words(look: Look) -> (&'static str, &'static str) {
    match look {
        Look::Colours => ("True colours", "The colours of the voxels, in the light of the lamps"),
        Look::Clay => ("Clay", "Matt clay, whatever colours the voxels have"),
        Look::Stone => ("Stone", "Pale stone, whatever colours the voxels have"),
        Look::Matcap => ("Matcap", "Lighting from an image of a ball, instead of all lamps"),
    }
}

/// The balls of a context, and the light in which they were rendered.
#[derive(Clone)]
struct Pictures {
    lighting: Lighting,
    textures: [TextureHandle; Look::ALL.len()],
}

fn picture(ui: &Ui, look: Look, lighting: &Lighting) -> TextureHandle {
    let pixels = ball(&Lighting { look, ..*lighting }, PICTURE_PX);
    let size = [PICTURE_PX as usize; 2];
    let image = ColorImage::from_rgba_unmultiplied(size, pixels.bytes());
    ui.ctx().load_texture(words(look).0, image, TextureOptions::LINEAR)
}

/// Returns a picture of each look in this light.
fn pictures(ui: &Ui, lighting: Lighting) -> [TextureHandle; Look::ALL.len()] {
    let lighting = Lighting { look: Look::default(), ..lighting };
    let id = Id::new("pictures of looks");
    if let Some(made) = ui.data(|data| data.get_temp::<Pictures>(id))
        && made.lighting == lighting
    {
        return made.textures;
    }
    let textures = Look::ALL.map(|look| picture(ui, look, &lighting));
    let made = Pictures { lighting, textures: textures.clone() };
    ui.data_mut(|data| data.insert_temp(id, made));
    textures
}
