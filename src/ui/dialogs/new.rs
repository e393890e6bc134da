//! The window for a new sculpture: size, colours, solid or empty, and the memory that it takes.

use egui::{ComboBox, DragValue, Grid, Id, Key, Modal, Ui};
use glam::{UVec3, Vec3};

use crate::command::{Command, NewSculpture};
use crate::remedy::told;
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::{ColourDepth, Grid as VoxelGrid, Rgb};
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

/// The values typed so far.
#[derive(Clone, PartialEq, Debug)]
pub struct NewDialog {
    pub open: bool,
    pub dims: UVec3,
    pub depth: ColourDepth,
    pub base: Rgb,
    pub solid: bool,
    /// Empty voxels at every side of the block.
    pub room_vx: u32,
    /// The box grows with tools that reach beyond it.
    pub grows: bool,
}

impl NewDialog {
    pub fn new(sculpture: &NewSculpture) -> NewDialog {
        NewDialog {
            open: false,
            dims: sculpture.dims,
            depth: sculpture.colour_depth,
            base: sculpture.base,
            solid: true,
            room_vx: sculpture.room_vx,
            grows: sculpture.grows,
        }
    }

    /// Returns the size with the room around the block.
    fn canvas(&self) -> UVec3 {
        self.dims + 2 * self.room_vx
    }

    fn wanted(&self) -> NewSculpture {
        NewSculpture {
            room_vx: self.room_vx,
            grows: self.grows,
            dims: self.dims,
            voxel_size: Vec3::ONE,
            colour_depth: self.depth,
            base: self.base,
            solid: self.solid,
        }
    }
}

impl Dialog for NewDialog {
    fn is_open(&self) -> bool {
        self.open
    }

    fn close(&mut self) -> bool {
        std::mem::take(&mut self.open)
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let DialogContext { requests, .. } = shared;
        if !self.open {
            return;
        }
        let response = Modal::new(Id::new("new dialog")).show(root.ctx(), |ui| {
            ui.set_width(340.0);
            ui.heading("New sculpture");
            ui.add_space(4.0);
            // A focused field or button uses Enter itself.
            let free = ui.memory(|memory| memory.focused().is_none());
            let enter = free && ui.input(|input| input.key_pressed(Key::Enter));
            fields(ui, self);
            ui.add_space(4.0);
            let refusal = VoxelGrid::check_size(self.canvas(), Vec3::ONE).err();
            match &refusal {
                None => memory(ui, self),
                Some(error) => {
                    ui.colored_label(theme::error_colour(ui.visuals()), told(error));
                }
            }
            ui.weak("You can get the current sculpture back with Undo.");
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                let create = theme::primary(ui.visuals(), "Create");
                let is_possible = refusal.is_none();
                if ui.add_enabled(is_possible, create).clicked() || enter && is_possible {
                    requests.push(UiRequest::Run(Command::New(self.wanted())));
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

fn fields(ui: &mut Ui, dialog: &mut NewDialog) {
    Grid::new("new").num_columns(2).spacing([12.0, 8.0]).show(ui, |ui| {
        ui.label("Preset");
        ui.horizontal(|ui| {
            for edge in [64, 128, 256, 512] {
                let chosen = dialog.dims == UVec3::splat(edge);
                if ui.selectable_label(chosen, edge.to_string()).clicked() {
                    dialog.dims = UVec3::splat(edge);
                }
            }
        });
        ui.end_row();
        ui.label("Size");
        ui.horizontal(|ui| {
            for (axis, name) in ["X ", "Y ", "Z "].into_iter().enumerate() {
                let value = DragValue::new(&mut dialog.dims[axis])
                    .range(1..=MAX_AXIS_VX)
                    .speed(1.0)
                    .prefix(name);
                ui.add(value);
            }
        });
        ui.end_row();
        ui.label("Room");
        let room = DragValue::new(&mut dialog.room_vx).range(0..=MAX_AXIS_VX).speed(1.0);
        ui.horizontal(|ui| {
            ui.add(room.suffix(" voxels"))
                .on_hover_text("Empty voxels at every side of the block, for what is added to it");
            ui.checkbox(&mut dialog.grows, "Grow as needed").on_hover_text(
                "Tools that add beyond the box make it larger, in the same step of undo",
            );
        });
        ui.end_row();
        ui.label("Colours");
        ComboBox::from_id_salt("depth")
            .width(190.0)
            .selected_text(depth_name(dialog.depth))
            .show_ui(ui, |ui| {
                for depth in ColourDepth::ALL {
                    ui.selectable_value(&mut dialog.depth, depth, depth_name(depth));
                }
            });
        ui.end_row();
        let label = ui.label("Base colour");
        ui.color_edit_button_srgb(&mut dialog.base.0).labelled_by(label.id);
        ui.end_row();
        ui.label("Start with");
        ui.horizontal(|ui| {
            ui.radio_value(&mut dialog.solid, true, "a solid block");
            ui.radio_value(&mut dialog.solid, false, "an empty grid");
        });
        ui.end_row();
    });
}

fn depth_name(depth: ColourDepth) -> &'static str {
    match depth {
        ColourDepth::None => "One for all voxels",
        ColourDepth::Bits8 => "256 (8 bits per voxel)",
        ColourDepth::Bits16 => "65 536 (16 bits per voxel)",
        ColourDepth::Bits24 => "16 million (24 bits per voxel)",
    }
}

fn memory(ui: &mut Ui, dialog: &NewDialog) {
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    let shape = VoxelGrid::bytes_for(dialog.canvas());
    let voxels = dialog.canvas().as_u64vec3().element_product();
    let colours = voxels * dialog.depth.bytes() as u64;
    let text = if colours == 0 {
        format!("Takes up to {:.0} MiB of memory as you carve", mib(shape))
    } else {
        format!(
            "Takes up to {:.0} MiB of memory as you carve, and {:.0} MiB once painted",
            mib(shape),
            mib(colours)
        )
    };
    ui.label(text);
}
