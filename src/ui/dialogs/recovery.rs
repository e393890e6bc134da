//! The dialog at the start that lists the work of earlier sessions that did not end normally, each with its picture,
//! name, time and number of steps.
//!
//! Asks with requests; knows no journal and no thread.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use egui::{ColorImage, Id, Image, Modal, ScrollArea, TextureHandle, TextureOptions, Ui, Vec2};

use crate::shade::Pixels;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

const WIDTH: f32 = 460.0;
/// Size of a picture, in points.
const PICTURE: Vec2 = Vec2::new(128.0, 96.0);
/// Height of the parts above and below the list, in points.
const BESIDE: f32 = 170.0;

/// The work left by one session.
#[derive(Clone, Debug)]
pub struct LeftSession {
    /// The number of its journal.
    pub number: u64,
    /// Time of the last write, in seconds since 1970, and as text.
    pub changed_unix_s: u64,
    pub time: String,
    /// The work, or why it cannot be restored.
    pub work: Result<LeftWork, String>,
}

/// The sculpture left by a session.
#[derive(Clone, Debug)]
pub struct LeftWork {
    /// The name of its file, or a substitute.
    pub name: String,
    pub path: Option<PathBuf>,
    /// Steps that can be undone.
    pub steps: usize,
    /// Size in voxels.
    pub dims: [u32; 3],
    /// Whether its file is complete.
    pub saved: bool,
    /// How a replay differs from the recording.
    pub differs: Option<String>,
    pub picture: Pixels,
}

/// A session in the list.
struct RecoveryRow {
    left: LeftSession,
    picture: Option<TextureHandle>,
}

type News = Arc<Mutex<Option<Vec<LeftSession>>>>;

/// The list, open or not.
#[derive(Default)]
pub struct RecoveryDialog {
    news: News,
    rows: Vec<RecoveryRow>,
    /// The journal whose removal is being confirmed.
    discards: Option<u64>,
}

impl RecoveryDialog {
    /// Returns the slot for the list of sessions.
    pub fn news(&self) -> Arc<Mutex<Option<Vec<LeftSession>>>> {
        self.news.clone()
    }

    /// Closes the dialog; its rows reappear at the next start. Returns false if it was closed already.
    pub fn close(&mut self) -> bool {
        let was_open = self.is_open();
        self.rows.clear();
        self.discards = None;
        was_open
    }

    /// Removes the row of a deleted journal.
    pub fn remove(&mut self, number: u64) {
        self.rows.retain(|row| row.left.number != number);
    }

    fn take_news(&mut self) {
        let news = self.news.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(found) = news {
            self.rows = found.into_iter().map(|left| RecoveryRow { left, picture: None }).collect();
        }
    }
}

impl Dialog for RecoveryDialog {
    fn is_open(&self) -> bool {
        !self.rows.is_empty()
    }

    fn close(&mut self) -> bool {
        RecoveryDialog::close(self)
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let requests = &mut *shared.requests;
        self.take_news();
        if !self.is_open() {
            return;
        }
        let mut later = false;
        let response = Modal::new(Id::new("recovery")).show(root.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.heading("Unsaved work was found");
        ui.weak("These sessions did not end properly. Nothing is lost: choose one to continue.");
        ui.add_space(6.0);
        let room = (ui.ctx().content_rect().height() - BESIDE).max(110.0);
        ScrollArea::vertical().max_height(room).show(ui, |ui| {
            let RecoveryDialog { rows, discards, .. } = self;
            for row in rows {
                ui.push_id(row.left.number, |ui| show_row(ui, row, discards, requests));
                ui.separator();
            }
        });
        ui.add_space(4.0);
        later = ui
            .button("Later")
            .on_hover_text("Keeps everything and asks again at the next start; “Unsaved work” in the menu lists it until then")
            .clicked();
    });
        if later || response.should_close() {
            self.close();
        }
    }
}

fn show_row(
    ui: &mut Ui,
    RecoveryRow { left, picture }: &mut RecoveryRow,
    discards: &mut Option<u64>,
    requests: &mut Vec<UiRequest>,
) {
    let number = left.number;
    ui.horizontal(|ui| {
        match &left.work {
            Ok(work) => {
                let texture = picture.get_or_insert_with(|| {
                    let size = [work.picture.size.x as usize, work.picture.size.y as usize];
                    let pixels = work.picture.rgba.as_flattened();
                    let image = ColorImage::from_rgba_unmultiplied(size, pixels);
                    ui.load_texture("left", image, TextureOptions::LINEAR)
                });
                ui.add(Image::new(&*texture).fit_to_exact_size(PICTURE));
            }
            Err(_) => drop(ui.allocate_space(PICTURE)),
        }
        ui.vertical(|ui| {
            match &left.work {
                Ok(work) => facts(ui, work, &left.time),
                Err(error) => {
                    ui.strong("Cannot be recovered");
                    ui.label(error);
                }
            }
            ui.add_space(4.0);
            ui.horizontal(|ui| {
                if *discards == Some(number) {
                    ui.label("Remove it for good?");
                    if ui.button("Discard it").clicked() {
                        requests.push(UiRequest::DiscardLeft(number));
                        *discards = None;
                    }
                    if ui.button("Keep it").clicked() {
                        *discards = None;
                    }
                    return;
                }
                if left.work.is_ok() {
                    let recover = ui.add(theme::primary(ui.visuals(), "Recover"));
                    let recover = recover.on_hover_text(
                        "Continues it as it was, with undo and redo; no file is overwritten",
                    );
                    if recover.clicked() {
                        requests.push(UiRequest::Recover(number));
                    }
                }
                if ui
                    .button("Discard …")
                    .on_hover_text("Deletes the journal of this session")
                    .clicked()
                {
                    *discards = Some(number);
                }
            });
        });
    });
}

fn facts(ui: &mut Ui, work: &LeftWork, time: &str) {
    let name = ui.strong(&work.name);
    if let Some(path) = &work.path {
        name.on_hover_text(path.display().to_string());
    }
    ui.label(time);
    let plural = if work.steps == 1 { "" } else { "s" };
    let saved = if work.saved { ", saved" } else { "" };
    let [x, y, z] = work.dims;
    ui.label(format!("{} step{plural}{saved}, {x} × {y} × {z} voxels", work.steps));
    if let Some(differs) = &work.differs {
        ui.colored_label(ui.visuals().warn_fg_color, "Differs from the original work")
            .on_hover_text(differs);
    }
}
