//! The window of lights: up to four lamps, the light of sky and ground, exposure, and the look of the surface.
//!
//! Changes the lights of the view at once; a panel shows some of them, too ([`surface`]). Reads no file: it asks for
//! the choice of one.

use std::path::Path;

use egui::{Button, ComboBox, DragValue, Grid, Response, RichText, Slider, Ui, Window, pos2};
use glam::Vec3;

use crate::render::light::{
    Lamp, LampFrame, LampKind, MAX_EXPOSURE_EV, MAX_INTENSITY, MAX_SUN_DEG,
};
use crate::render::{Finish, LightOptions};
use crate::shade::{MAX_LIGHTS, Smoothing, ToneMapping};
use crate::ui::dialogs::look;
use crate::ui::dialogs::shared::{Dialog, DialogContext, FileTask, Opening};
use crate::ui::view_state::ViewState;
use crate::ui::widgets::spot::{self, Spot};
use crate::ui::widgets::theme;

const WIDTH: f32 = 270.0;
/// Least width of the names before sliders, which aligns the sliders of all groups.
const NAME_WIDTH: f32 = 72.0;

/// Positions of added lamps, on opposite sides.
const PLACES: [[f32; 3]; MAX_LIGHTS] =
    [[-0.4, 0.7, 0.6], [0.8, 0.2, 0.5], [0.0, -0.8, 0.4], [0.0, 0.6, -0.8]];

/// The state that the window remembers.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct LightWindow {
    pub open: bool,
    /// The lamp whose position is shown.
    pub lamp: usize,
    /// The lights of the settings, which *Reset lights* restores.
    pub usual: (LightOptions, Finish),
}

impl Dialog for LightWindow {
    fn is_open(&self) -> bool {
        self.open
    }

    fn is_modal(&self) -> bool {
        false
    }

    fn close(&mut self) -> bool {
        std::mem::take(&mut self.open)
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        if !self.open {
            return;
        }
        let (mut open, mut another) = (true, false);
        Window::new("Lights")
            .open(&mut open)
            .resizable(false)
            .default_width(WIDTH)
            .default_pos(pos2(theme::TOOLBOX_WIDTH + 28.0, 52.0))
            .show(root.ctx(), |ui| {
                ui.set_width(WIDTH);
                lamps(ui, self, shared.view);
                ui.separator();
                another = surface(ui, shared.view);
            });
        self.open &= open;
        if another {
            let path = shared.view.light.matcap.path().map(Path::to_path_buf);
            shared.openings.push(Opening::Files(FileTask::Matcap, path));
        }
    }
}

/// Shows ambient light, highlights and shading quality. Returns true if the person wants to choose the file of another
/// matcap.
pub fn surface(ui: &mut Ui, view: &mut ViewState) -> bool {
    let looks = ui.scope(|ui| look::show(ui, view));
    spot::mark(&looks.response, Spot::Looks);
    ui.add_space(4.0);
    ambient_light(ui, &mut view.light);
    tone_and_shadows(ui, view);
    ui.add_space(4.0);
    highlights(ui, &mut view.light);
    let software = view.mode.shading() == crate::render::Shading::Software;
    filters(ui, &mut view.finish, software);
    looks.inner
}

/// Shows the ambient light and the exposure.
fn ambient_light(ui: &mut Ui, light: &mut LightOptions) {
    Grid::new("light").num_columns(2).min_col_width(NAME_WIDTH).show(ui, |ui| {
        percent(ui, "Ambient", &mut light.ambient, 1.0)
            .on_hover_text("Light from everywhere: from the sky above and the ground below");
        ui.label("Sky, ground");
        ui.horizontal(|ui| {
            let sky = ui.color_edit_button_srgb(&mut light.sky.0);
            sky.on_hover_text("Colour of the ambient light on surfaces that face up");
            let ground = ui.color_edit_button_srgb(&mut light.ground.0);
            ground.on_hover_text("Colour of the ambient light on surfaces that face down");
        });
        ui.end_row();
        let label = ui.label("Exposure");
        let range = -MAX_EXPOSURE_EV..=MAX_EXPOSURE_EV;
        let exposure = Slider::new(&mut light.exposure, range).suffix(" EV").max_decimals(2);
        ui.add(exposure)
            .labelled_by(label.id)
            .on_hover_text("Brightness of the whole picture: each step doubles the light");
        ui.end_row();
    });
}

/// Shows the tone mapping of the picture and the effects that darken parts of it.
fn tone_and_shadows(ui: &mut Ui, view: &mut ViewState) {
    let ViewState { light, finish, ground, .. } = view;
    let mut filmic = light.tone == ToneMapping::Filmic;
    let tone = ui.checkbox(&mut filmic, "Filmic tone mapping").on_hover_text(
        "Lifts dark tones and lets bright light fade into white; without it, bright light is cut off",
    );
    if tone.changed() {
        light.tone = if filmic { ToneMapping::Filmic } else { ToneMapping::Off };
    }
    let occlusion = ui
        .checkbox(&mut finish.occlusion, "Ambient occlusion")
        .on_hover_text("Darkens corners and crevices, which get less ambient light");
    spot::mark(&occlusion, Spot::Occlusion);
    ui.checkbox(&mut light.shadow, "Shadows").on_hover_text(
        "The first distant light casts shadows: sharp while something moves, soft in the refined picture",
    );
    if light.shadow || *ground {
        ui.horizontal(|ui| {
            let label = ui.label("Size of the sun");
            let slider =
                Slider::new(&mut light.sun_deg, 0.0..=MAX_SUN_DEG).max_decimals(1).suffix("°");
            ui.add(slider).labelled_by(label.id).on_hover_text(
                "The larger, the softer the shadows, including the one on the ground",
            );
        });
    }
}

/// Shows the highlights of the stone.
fn highlights(ui: &mut Ui, light: &mut LightOptions) {
    Grid::new("surface").num_columns(2).min_col_width(NAME_WIDTH).show(ui, |ui| {
        percent(ui, "Specular", &mut light.specular, 1.0)
            .on_hover_text("Strength of the highlights");
        let label = ui.label("Shininess");
        let slider = Slider::new(&mut light.shininess, 1..=256).logarithmic(true);
        ui.add(slider)
            .labelled_by(label.id)
            .on_hover_text("The larger, the smaller the highlights");
        ui.end_row();
    });
}

/// Shows the averages over neighbouring pixels, which only the software shader computes.
fn filters(ui: &mut Ui, finish: &mut Finish, software: bool) {
    let filters = ui.add_enabled_ui(software, |ui| {
        Grid::new("filters").num_columns(2).show(ui, |ui| {
            for (title, smoothing) in [
                ("Smooth normals", &mut finish.smooth_normals),
                ("Smooth colours", &mut finish.smooth_colours),
            ] {
                let label = ui.label(title);
                ComboBox::from_id_salt(title)
                    .width(96.0)
                    .selected_text(name(*smoothing))
                    .show_ui(ui, |ui| {
                        for choice in Smoothing::ALL {
                            ui.selectable_value(smoothing, choice, name(choice));
                        }
                    })
                    .response
                    .labelled_by(label.id)
                    .on_hover_text("Average over neighbouring pixels of the same surface");
                ui.end_row();
            }
        });
    });
    filters.response.on_disabled_hover_text("Only available with the software shader");
}

fn name(smoothing: Smoothing) -> &'static str {
    match smoothing {
        Smoothing::Off => "Off",
        Smoothing::Near => "3 × 3",
        Smoothing::Wide => "5 × 5",
    }
}

fn lamps(ui: &mut Ui, window: &mut LightWindow, view: &mut ViewState) {
    let (lamps, chosen) = (&mut view.light.lamps, &mut window.lamp);
    let (mut removed, mut reset) = (None, false);
    ui.horizontal(|ui| {
        let add = ui.add_enabled(lamps.len() < MAX_LIGHTS, Button::new("Add light"));
        let add = add.on_hover_text("Add a lamp that lights another side");
        if add.on_disabled_hover_text("There can be at most four lights").clicked() {
            let place = PLACES[lamps.len()];
            *chosen = lamps.len();
            lamps.push(Lamp { place, intensity: 0.5, ..Lamp::default() });
        }
        let all = ui.button("Reset lights");
        reset =
            all.on_hover_text("Reset lamps, look and everything below to the settings").clicked();
    });
    for (i, lamp) in lamps.iter_mut().enumerate() {
        ui.push_id(i, |ui| {
            ui.horizontal(|ui| {
                ui.checkbox(&mut lamp.on, RichText::new(format!("Light {}", i + 1)).strong())
                    .on_hover_text("Turn this lamp on or off");
                ui.color_edit_button_srgb(&mut lamp.colour.0).on_hover_text("Colour of its light");
                ui.selectable_value(chosen, i, "Edit")
                    .on_hover_text("Show its position and brightness below");
                if ui.button("Remove").on_hover_text("Remove this lamp").clicked() {
                    removed = Some(i);
                }
            });
        });
    }
    if let Some(lamp) = lamps.get_mut(*chosen) {
        ui.add_space(4.0);
        ui.add_enabled_ui(lamp.on, |ui| one(ui, lamp));
    }
    if let Some(i) = removed {
        lamps.remove(i);
        *chosen -= usize::from(*chosen >= i && *chosen > 0);
    }
    if reset {
        window.lamp = 0;
        let (light, finish) = &window.usual;
        (view.light, view.finish) = (light.clone(), *finish);
    }
}

/// Shows the position and brightness of a lamp.
fn one(ui: &mut Ui, lamp: &mut Lamp) {
    ui.horizontal(|ui| {
        let before = lamp.kind;
        ui.radio_value(&mut lamp.kind, LampKind::Direction, "Distant")
            .on_hover_text("As far away as the sun: its light comes from one direction");
        ui.radio_value(&mut lamp.kind, LampKind::Position, "Point")
            .on_hover_text("Near the sculpture: its light comes from one point");
        if lamp.kind != before {
            // A visible position, about the size of the sculpture away; a direction has length 1.
            let towards = Vec3::from(lamp.place).normalize_or(Vec3::Z);
            let far = if lamp.kind == LampKind::Position { 200.0 } else { 1.0 };
            lamp.place = (towards * far).to_array();
        }
    });
    ui.horizontal(|ui| {
        ui.label("Fixed to");
        ui.radio_value(&mut lamp.frame, LampFrame::Eye, "viewer")
            .on_hover_text("The lamp moves with the eye, like a headlamp");
        ui.radio_value(&mut lamp.frame, LampFrame::World, "world")
            .on_hover_text("The lamp stays where it is when the eye moves");
    });
    Grid::new("place").num_columns(2).min_col_width(NAME_WIDTH).show(ui, |ui| {
        match lamp.kind {
            LampKind::Direction => direction(ui, &mut lamp.place),
            LampKind::Position => {
                ui.label("Position");
                ui.horizontal(|ui| {
                    for (value, axis) in lamp.place.iter_mut().zip(["x ", "y ", "z "]) {
                        let range = -1e5..=1e5;
                        ui.add(DragValue::new(value).prefix(axis).range(range).speed(1.0))
                            .on_hover_text("In voxel edges from the centre of the world");
                    }
                });
                ui.end_row();
            }
        }
        percent(ui, "Brightness", &mut lamp.intensity, MAX_INTENSITY)
            .on_hover_text("Strength of this lamp");
    });
}

/// Shows a direction as two angles.
fn direction(ui: &mut Ui, place: &mut [f32; 3]) {
    let direction = Vec3::from(*place).normalize_or(Vec3::Z);
    // Within the ranges of the sliders, so that none moves a lamp on its own.
    let mut side_deg = direction.x.atan2(direction.z).to_degrees().clamp(-180.0, 180.0);
    let mut height_deg = direction.y.clamp(-1.0, 1.0).asin().to_degrees().clamp(-89.0, 89.0);
    let mut moved = false;
    let mut row = |label: &str, meaning: &str, value: &mut f32, range| {
        let label = ui.label(label);
        let slider = Slider::new(value, range).custom_formatter(whole).suffix("°");
        moved |= ui.add(slider).labelled_by(label.id).on_hover_text(meaning).changed();
        ui.end_row();
    };
    row("Azimuth", "To the right of straight ahead", &mut side_deg, -180.0..=180.0);
    row("Elevation", "Above the horizon", &mut height_deg, -89.0..=89.0);
    if moved {
        let (side, height) = (side_deg.to_radians(), height_deg.to_radians());
        let across = height.cos();
        *place = [side.sin() * across, height.sin(), side.cos() * across];
    }
}

/// Shows a row for a share, up to `most`.
fn percent(ui: &mut Ui, title: &str, share: &mut f32, most: f32) -> Response {
    let mut shown = *share * 100.0;
    let label = ui.label(title);
    let slider = Slider::new(&mut shown, 0.0..=most * 100.0).custom_formatter(whole).suffix("%");
    let response = ui.add(slider).labelled_by(label.id);
    if response.changed() {
        *share = shown / 100.0;
    }
    ui.end_row();
    response
}

/// Formats a value as shown. (A slider with fixed decimals would round an untouched value.)
fn whole(value: f64, _: std::ops::RangeInclusive<usize>) -> String {
    format!("{value:.0}")
}
