//! The dialog after choosing a file to export to. It asks for the options of the file's format and remembers the
//! answers. Formats without options are written at once.
//!
//! Takes a path; asks with a command to save; knows no file's contents.

use std::path::{Path, PathBuf};

use egui::{Checkbox, ComboBox, DragValue, Grid, Id, Key, Modal, Ui};
use glam::Vec3;

use crate::command::Command;
use crate::format::options::{ExportForm, ExportOptions};
use crate::format::{
    MeshOptions, MeshTraits, MeshUp, is_mesh, is_volume, mesh_traits, usual_surface,
};
use crate::mesh::MeshKind;
use crate::sculpture::history::SurfaceKind;
use crate::ui::context::UiContext;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::names::capital;
use crate::ui::widgets::theme;

const WIDTH: f32 = 360.0;
/// Number of triangles to which a mesh is simplified by default.
const TRIANGLES: u64 = 100_000;
const MOST_TRIANGLES: u64 = 100_000_000;
/// Edges of a voxel that can be chosen, in millimetres.
const VOXEL_MM: std::ops::RangeInclusive<f32> = 0.001..=1000.0;

/// The options chosen so far, and the file for them.
#[derive(Clone, PartialEq, Debug)]
pub struct ExportDialog {
    /// The file while the dialog is open.
    path: Option<PathBuf>,
    /// Extent of the existing voxels, determined when the dialog opens.
    size_vx: Option<Vec3>,
    form: ExportForm,
    /// The surface that the sculpture shows.
    surface: SurfaceKind,
    /// Surface of a mesh of sculptures shown smooth.
    pub kind: MeshKind,
    /// Surface of a mesh of sculptures shown as cubes.
    kind_of_cubes: MeshKind,
    points_only: bool,
    /// `None`: the format's usual axis.
    up: Option<MeshUp>,
    simplify: bool,
    triangles: u64,
    /// Edge of a voxel along x; `None`: that of the sculpture.
    voxel_mm: Option<f32>,
}

impl Default for ExportDialog {
    fn default() -> ExportDialog {
        ExportDialog {
            path: None,
            size_vx: None,
            form: ExportForm::default(),
            surface: SurfaceKind::default(),
            kind: usual_surface(SurfaceKind::Smooth),
            kind_of_cubes: usual_surface(SurfaceKind::Cubes),
            points_only: false,
            up: None,
            simplify: false,
            triangles: TRIANGLES,
            voxel_mm: None,
        }
    }
}

impl ExportDialog {
    /// Asks for the options of a file, or to write it if its format has none.
    pub fn open(&mut self, path: PathBuf, requests: &mut Vec<UiRequest>) {
        self.size_vx = None;
        match is_mesh(&path) || is_volume(&path) {
            true => self.path = Some(path),
            false => requests.push(self.command(path)),
        }
    }

    fn chosen_kind(&self) -> MeshKind {
        match self.surface {
            SurfaceKind::Smooth => self.kind,
            SurfaceKind::Cubes => self.kind_of_cubes,
        }
    }

    fn command(&self, path: PathBuf) -> UiRequest {
        let export = self.options(&path);
        UiRequest::Run(Command::Save { path, export })
    }

    /// Returns the chosen options that apply to the format of `path`.
    fn options(&self, path: &Path) -> ExportOptions {
        if is_volume(path) {
            return self.form.into();
        }
        let Some(traits) = mesh_traits(path) else { return ExportOptions::default() };
        let mesh = MeshOptions {
            kind: self.chosen_kind(),
            points_only: self.points_only && traits.holds_points,
            up: self.up.filter(|_| !traits.is_up_fixed),
            voxel_mm: self.voxel_mm,
            triangles: self.simplify.then_some(self.triangles),
        };
        ExportOptions { mesh, ..ExportOptions::default() }
    }
}

impl Dialog for ExportDialog {
    fn is_open(&self) -> bool {
        self.path.is_some()
    }

    fn close(&mut self) -> bool {
        self.path.take().is_some()
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let DialogContext { context, requests, .. } = shared;
        let Some(path) = self.path.clone() else { return };
        self.surface = context.document.contents().surface;
        let response = Modal::new(Id::new("export")).show(root.ctx(), |ui| {
            ui.set_width(WIDTH);
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            ui.heading(format!("Export {name}"));
            ui.add_space(4.0);
            // A focused field or button uses Enter itself.
            let free = ui.memory(|memory| memory.focused().is_none());
            let enter = free && ui.input(|input| input.key_pressed(Key::Enter));
            match mesh_traits(&path) {
                Some(traits) => mesh_options(ui, self, &path, traits, context),
                None => volume_options(ui, self),
            }
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                if ui.add(theme::primary(ui.visuals(), "Export")).clicked() || enter {
                    requests.push(self.command(path.clone()));
                    self.path = None;
                }
                if ui.button("Cancel").clicked() {
                    self.path = None;
                }
            });
        });
        if response.should_close() {
            self.path = None;
        }
    }
}

fn volume_options(ui: &mut Ui, dialog: &mut ExportDialog) {
    for (form, text) in [
        (ExportForm::Auto, "Shape, plus colours if there are any"),
        (ExportForm::Densities, "Shape only, one byte per voxel, for any volume viewer"),
        (ExportForm::Rgba, "Red, green, blue and opacity, one byte each"),
        (ExportForm::Packed, "Colours packed into 8, 16 or 24 bits"),
    ] {
        ui.radio_value(&mut dialog.form, form, capital(&form.to_string())).on_hover_text(text);
    }
}

fn mesh_options(
    ui: &mut Ui,
    dialog: &mut ExportDialog,
    path: &Path,
    traits: &MeshTraits,
    context: &UiContext,
) {
    let grid = context.document.grid();
    let own_mm = grid.voxel_size();
    let size_vx = *dialog.size_vx.get_or_insert_with(|| {
        grid.opaque_bounds().map_or(Vec3::ZERO, |(low, high)| (high - low).as_vec3())
    });
    Grid::new("export").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
        let label = ui.label("Surface");
        let chosen = match dialog.surface {
            SurfaceKind::Smooth => &mut dialog.kind,
            SurfaceKind::Cubes => &mut dialog.kind_of_cubes,
        };
        ComboBox::from_id_salt("surface")
            .width(150.0)
            .selected_text(capital(&chosen.to_string()))
            .show_ui(ui, |ui| {
                for (kind, name) in MeshKind::NAMED {
                    ui.selectable_value(chosen, kind, capital(name)).on_hover_text(help(kind));
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text(help(*chosen));
        ui.end_row();

        ui.checkbox(&mut dialog.simplify, "Simplify to").on_hover_text(
            "Collapses edges where the surface changes least; the mesh stays closed",
        );
        let triangles = DragValue::new(&mut dialog.triangles).range(12..=MOST_TRIANGLES);
        ui.add_enabled(dialog.simplify, triangles.speed(1000.0).suffix(" triangles"))
            .on_hover_text("Largest number of triangles in the mesh");
        ui.end_row();

        let label = ui.label("Voxel");
        let mut edge_mm = dialog.voxel_mm.unwrap_or(own_mm.x);
        let field = DragValue::new(&mut edge_mm).range(VOXEL_MM).speed(0.01).suffix(" mm");
        if ui
            .add(field)
            .labelled_by(label.id)
            .on_hover_text("Edge length of a voxel along x")
            .changed()
        {
            dialog.voxel_mm = (edge_mm != own_mm.x).then_some(edge_mm);
        }
        ui.end_row();

        ui.label("Size");
        let size_mm = size_vx * own_mm * (edge_mm / own_mm.x);
        let Vec3 { x, y, z } = size_mm;
        ui.label(format!("{x:.1} × {y:.1} × {z:.1} mm"))
            .on_hover_text("Width, height and depth of the sculpture");
        ui.end_row();

        up_axis(ui, dialog, path, traits);
        ui.end_row();

        if traits.holds_points {
            ui.label("");
            ui.add(Checkbox::new(&mut dialog.points_only, "Points only")).on_hover_text(
                "The vertices without triangles, for programs that read point clouds",
            );
            ui.end_row();
        }
    });
}

/// Shows the up axis of the file.
fn up_axis(ui: &mut Ui, dialog: &mut ExportDialog, path: &Path, traits: &MeshTraits) {
    let label = ui.label("Up");
    let MeshTraits { up: usual, is_up_fixed: is_fixed, .. } = *traits;
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let mut up = dialog.up.filter(|_| !is_fixed).unwrap_or(usual);
    ui.add_enabled_ui(!is_fixed, |ui| {
        ui.horizontal(|ui| {
            for (axis, name) in MeshUp::NAMED {
                if ui.radio_value(&mut up, axis, name).labelled_by(label.id).changed() {
                    dialog.up = (up != usual).then_some(up);
                }
            }
        })
        .response
        .on_hover_text("The axis of the file that points up")
        .on_disabled_hover_text(format!("In .{ending} it is always {usual}"));
    });
}

fn help(kind: MeshKind) -> &'static str {
    match kind {
        MeshKind::Faces => "The exposed faces of the voxels, two triangles each",
        MeshKind::Greedy => "The same faces, merged into rectangles: far fewer triangles",
        MeshKind::Smooth => "The smooth surface that pictures show, for printing and modelling",
    }
}
