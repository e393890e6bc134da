//! The dialog of a film: a turntable of the sculpture, or the time lapse of the work.
//!
//! Asks with a [`FilmRequest`]; knows neither files nor how films are made.

use egui::{ComboBox, DragValue, Grid, Id, Key, Modal, Slider, Ui};
use glam::UVec2;

use crate::ui::dialogs::picture_size::PictureSize;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::pictures::{FilmForm, FilmRequest, FilmSubject};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;
use crate::view::MAX_SAMPLES;

/// The longest side of a frame, in pixels.
const MOST_PX: u32 = 4096;
const MOST_FRAMES: u32 = 100_000;
/// Most frames per second; viewers of GIF slow faster films down.
const MOST_FPS: u16 = 240;
const MOST_FPS_OF_GIF: u16 = 50;
const WIDTH: f32 = 360.0;

/// The options chosen so far.
#[derive(Clone, PartialEq, Debug)]
pub struct FilmDialog {
    pub open: bool,
    pub kind: FilmSubject,
    pub frames: u32,
    pub fps: u16,
    /// The angle by which the sculpture turns: in a turntable, and in a time lapse.
    pub spin_deg: [f32; 2],
    pub size: PictureSize,
    pub samples: u32,
    pub form: FilmForm,
}

impl Default for FilmDialog {
    fn default() -> FilmDialog {
        FilmDialog {
            open: false,
            kind: FilmSubject::default(),
            frames: 120,
            fps: 30,
            spin_deg: [360.0, 0.0],
            size: PictureSize::Usual(UVec2::new(640, 480)),
            samples: 4,
            form: FilmForm::default(),
        }
    }
}

impl FilmDialog {
    fn spin_deg(&mut self) -> &mut f32 {
        &mut self.spin_deg[self.kind as usize]
    }

    fn most_fps(&self) -> u16 {
        if self.form == FilmForm::Gif { MOST_FPS_OF_GIF } else { MOST_FPS }
    }

    fn wanted(&mut self, view_px: UVec2) -> FilmRequest {
        FilmRequest {
            kind: self.kind,
            frames: self.frames,
            fps: self.fps.min(self.most_fps()),
            spin_deg: *self.spin_deg(),
            size: self.size.px(view_px),
            samples: self.samples,
            form: self.form,
        }
    }
}

impl Dialog for FilmDialog {
    fn is_open(&self) -> bool {
        self.open
    }

    fn close(&mut self) -> bool {
        std::mem::take(&mut self.open)
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let DialogContext { context, requests, .. } = shared;
        if !self.open {
            return;
        }
        let response = Modal::new(Id::new("film")).show(root.ctx(), |ui| {
            ui.set_width(WIDTH);
            ui.heading("Film");
            ui.weak("The whole sculpture, seen from the direction of the view.");
            ui.add_space(4.0);
            let undos = context.document.history().undo_count();
            let can_lapse = context.recording.is_some() || undos > 0;
            if !can_lapse {
                self.kind = FilmSubject::Turntable;
            }
            // A focused field or button uses Enter itself.
            let free = ui.memory(|memory| memory.focused().is_none());
            let enter = free && ui.input(|input| input.key_pressed(Key::Enter));
            Grid::new("film").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
                what(ui, self, can_lapse, context.recording.is_some());
                self.size.row(ui, context.picture_px, MOST_PX);
                length(ui, self);
                form(ui, self);
            });
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                let make = ui.add(theme::primary(ui.visuals(), "Make film"));
                let make = make.on_hover_text(
                    "Saved next to the sculpture under a new name; can be cancelled",
                );
                if make.clicked() || enter {
                    requests.push(UiRequest::Film(self.wanted(context.picture_px)));
                    self.open = false;
                }
                if ui.button("Cancel").clicked() {
                    self.open = false;
                }
            });
        });
        if response.should_close() {
            self.open = false;
        }
    }
}

fn what(ui: &mut Ui, dialog: &mut FilmDialog, can_lapse: bool, is_recording: bool) {
    let lapse = match is_recording {
        true => "How the sculpture was made, as recorded since the start",
        false => "How the sculpture was made, step by step, as far back as undo goes",
    };
    ui.label("Kind");
    ui.horizontal(|ui| {
        ui.radio_value(&mut dialog.kind, FilmSubject::Turntable, "Turntable")
            .on_hover_text("The sculpture turns; a full turn loops without a jump");
        ui.add_enabled_ui(can_lapse, |ui| {
            ui.radio_value(&mut dialog.kind, FilmSubject::Lapse, "Time lapse")
                .on_hover_text(lapse)
                .on_disabled_hover_text("There is nothing yet for a time lapse to show");
        });
    });
    ui.end_row();
}

fn length(ui: &mut Ui, dialog: &mut FilmDialog) {
    let label = ui.label("Frames");
    ui.add(DragValue::new(&mut dialog.frames).range(1..=MOST_FRAMES).speed(1.0))
        .labelled_by(label.id)
        .on_hover_text("Number of pictures in the whole film");
    ui.end_row();
    let (most_fps, has_rate) = (dialog.most_fps(), dialog.form != FilmForm::Folder);
    let label = ui.label("Frames per second");
    ui.add_enabled(has_rate, DragValue::new(&mut dialog.fps).range(1..=most_fps).speed(0.2))
        .labelled_by(label.id)
        .on_hover_text("Playback speed")
        .on_disabled_hover_text("A folder of pictures has no playback speed");
    ui.end_row();
    let label = ui.label("Turn");
    let spin = DragValue::new(dialog.spin_deg()).range(-3600.0..=3600.0).suffix("°").speed(1.0);
    ui.add(spin).labelled_by(label.id).on_hover_text(
        "Angle by which the sculpture turns in the film; negative turns it the other way",
    );
    ui.end_row();
    let label = ui.label("Samples");
    ui.add(Slider::new(&mut dialog.samples, 1..=MAX_SAMPLES).logarithmic(true))
        .labelled_by(label.id)
        .on_hover_text(
            "Per pixel: more samples make edges smoother and take proportionally longer",
        );
    ui.end_row();
}

fn form(ui: &mut Ui, dialog: &mut FilmDialog) {
    let label = ui.label("File");
    ComboBox::from_id_salt("film form")
        .width(150.0)
        .selected_text(dialog.form.name())
        .show_ui(ui, |ui| {
            for form in FilmForm::ALL {
                let choice = ui.selectable_value(&mut dialog.form, form, form.name());
                choice.on_hover_text(form.help());
            }
        })
        .response
        .labelled_by(label.id)
        .on_hover_text(dialog.form.help());
    ui.end_row();
}
