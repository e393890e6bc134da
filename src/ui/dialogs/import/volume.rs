//! The questions about a volume: the channel or time, the existing densities, colours, region, voxel size, and the
//! pieces to keep, shown with slices and a histogram.
//!
//! Takes the contents of the file; changes the options of the import.

use egui::{ComboBox, DragValue, Grid, RichText, ScrollArea, Ui, Vec2};
use glam::UVec3;

use super::widths::OPTIONS_WIDTH;
use super::{histogram, slices};
use crate::format::options::{Colouring, Cubic, Existence, ImportOptions, Ordinal, ScanRegion};
use crate::format::{ChosenVolume, Samples, VolumeStudy, Volumes};
use crate::sculpture::orientation::Up;
use crate::ui::memory::upright;
use crate::ui::widgets::names::capital;

/// In windows narrower than this, the options are below the slices.
const BESIDE: f32 = 600.0;
/// The largest slice, in points.
const MOST_SIDE: f32 = 220.0;
/// Height of histogram, sliders and lines of text, in points.
const BELOW: f32 = 210.0;
/// Edges of a voxel that can be chosen, in millimetres.
const EDGE_MM: std::ops::RangeInclusive<f32> = 0.001..=1000.0;

/// Shows all questions in `room` points. Returns true if another channel or time, which must be read, was chosen.
pub fn show(
    ui: &mut Ui,
    study: &VolumeStudy,
    options: &mut ImportOptions,
    at: &mut UVec3,
    room: Vec2,
) -> bool {
    facts(ui, study);
    let is_wide = room.x >= BESIDE;
    let left = if is_wide { room.x - OPTIONS_WIDTH - 16.0 } else { room.x - 12.0 };
    let gap = ui.spacing().item_spacing.x;
    let side = ((left - 2.0 * gap) / 3.0).min(room.y - BELOW).clamp(60.0, MOST_SIDE);
    let pictures = |ui: &mut Ui, options: &mut ImportOptions, at: &mut UVec3| {
        slices::show(ui, study, options, at, side);
        ui.add_enabled_ui(options.colouring != Colouring::Packed, |ui| {
            histogram::show(ui, study, options, 3.0 * side + 2.0 * gap);
        });
    };
    let mut is_chosen = false;
    if is_wide {
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(3.0 * side + 2.0 * gap);
                pictures(ui, options, at);
            });
            ui.add_space(4.0);
            ui.vertical(|ui| {
                ScrollArea::vertical()
                    .max_height(room.y)
                    .show(ui, |ui| is_chosen = questions(ui, study, options, at));
            });
        });
    } else {
        ScrollArea::vertical().max_height(room.y).show(ui, |ui| {
            pictures(ui, options, at);
            is_chosen = questions(ui, study, options, at);
        });
    }
    is_chosen
}

/// Returns the ways to colour such a volume.
fn colourings(study: &VolumeStudy) -> Vec<Colouring> {
    let samples = study.volume.samples;
    let is_possible = |colouring: &Colouring| match colouring {
        Colouring::Auto | Colouring::None => true,
        Colouring::Grey | Colouring::Tissue | Colouring::Labels => samples.is_density(),
        Colouring::Packed => {
            matches!(samples, Samples::U8 | Samples::U16Be | Samples::U16Le | Samples::Rgb8)
        }
    };
    Colouring::NAMED.into_iter().map(|(colouring, _)| colouring).filter(is_possible).collect()
}

/// Drops choices from another file that are impossible in this one.
pub fn allow(study: &VolumeStudy, options: &mut ImportOptions) {
    if !colourings(study).contains(&options.colouring) {
        options.colouring = Colouring::Auto;
    }
    if options.colouring == Colouring::Packed {
        options.existence = Existence::Auto;
    }
}

/// Shows the facts that the file states.
fn facts(ui: &mut Ui, study: &VolumeStudy) {
    let UVec3 { x, y, z } = study.volume.dims;
    let samples = samples_text(study.volume.samples);
    let mut text = format!("{}, {x} × {y} × {z} voxels, {samples}", study.kind);
    if let Some(orientation) = study.orientation() {
        text += &format!("; {orientation}");
    }
    ui.weak(text);
    for note in &study.notes {
        ui.label(RichText::new(capital(note)).small());
    }
}

/// Returns the type of a voxel in words; scripts and `--raw` use a letter and the number of bits.
fn samples_text(samples: Samples) -> String {
    match samples {
        Samples::U8 => "8 bits each".to_string(),
        Samples::U16Le | Samples::U16Be => "16 bits each".to_string(),
        Samples::I16Le | Samples::I16Be => "16 bits each, with a sign".to_string(),
        Samples::F32Le | Samples::F32Be => "32-bit floating point each".to_string(),
        Samples::Rgb8 => "red, green and blue".to_string(),
        Samples::Rgba8 => "red, green, blue and opacity".to_string(),
        other => other.to_string(),
    }
}

fn questions(
    ui: &mut Ui,
    study: &VolumeStudy,
    options: &mut ImportOptions,
    at: &mut UVec3,
) -> bool {
    ui.set_width(OPTIONS_WIDTH - 12.0);
    let mut is_chosen = false;
    Grid::new("import volume").num_columns(2).spacing([10.0, 6.0]).show(ui, |ui| {
        let Volumes { channel, time } = study.volumes;
        is_chosen = one_of(ui, "Channel", channel, &mut options.channel);
        is_chosen |= one_of(ui, "Time", time, &mut options.time);
        colours(ui, study, options);
        if !study.knows_up() {
            up(ui, study, options, at);
        }
        cubic(ui, study, options);
    });
    region(ui, study, options);
    ui.add_space(4.0);
    ui.checkbox(&mut options.largest_piece, "Largest piece only").on_hover_text(
        "Leaves out noise and everything not connected to the largest piece. Not shown in the slices",
    );
    ui.checkbox(&mut options.fill_holes, "Fill holes")
        .on_hover_text("Fills empty spaces enclosed by voxels. Not shown in the slices");
    is_chosen
}

/// Asks for one of several channels or times. Returns true if another one than `taken` was chosen.
fn one_of(ui: &mut Ui, name: &str, taken: ChosenVolume, chosen: &mut Option<Ordinal>) -> bool {
    if taken.count < 2 {
        return false;
    }
    let help = match name {
        "Channel" => "Channel of the file to read",
        _ => "Time point of the file to read; or phase, echo, or volume along a fourth axis",
    };
    let label = ui.label(name);
    let field = ui.horizontal(|ui| {
        let most = u32::try_from(taken.count).unwrap_or(u32::MAX);
        let mut number = chosen.map_or(taken.number as u32, Ordinal::get);
        let field = DragValue::new(&mut number).range(1..=most).speed(0.05);
        let field = ui.add(field).labelled_by(label.id).on_hover_text(help);
        if field.changed() {
            *chosen = Ordinal::new(number);
        }
        ui.weak(format!("of {}", taken.count));
        field
    });
    ui.end_row();
    let is_settled = !field.inner.has_focus() && !field.inner.dragged();
    is_settled && chosen.is_some_and(|chosen| u64::from(chosen.get()) != taken.number)
}

fn colours(ui: &mut Ui, study: &VolumeStudy, options: &mut ImportOptions) {
    let name = |colouring: Colouring| match colouring {
        Colouring::Auto if study.is_label => "By label".to_owned(),
        Colouring::Auto if study.volume.samples.is_density() => "One for all".to_owned(),
        Colouring::Auto => "As in the file".to_owned(),
        other => capital(&other.to_string()),
    };
    let label = ui.label("Colours");
    ComboBox::from_id_salt("colouring")
        .width(120.0)
        .selected_text(name(options.colouring))
        .show_ui(ui, |ui| {
            for colouring in colourings(study) {
                let help = colouring_help(colouring);
                ui.selectable_value(&mut options.colouring, colouring, name(colouring))
                    .on_hover_text(help);
            }
        })
        .response
        .labelled_by(label.id)
        .on_hover_text(colouring_help(options.colouring));
    if options.colouring == Colouring::Packed {
        options.existence = Existence::Auto;
    }
    ui.end_row();
}

fn colouring_help(colouring: Colouring) -> &'static str {
    match colouring {
        Colouring::Auto => "Colours of the file; densities get the base colour and can be painted",
        Colouring::None => "No colours: the sculpture cannot be painted, and takes less memory",
        Colouring::Grey => "Densities as grey: the brighter, the denser",
        Colouring::Tissue => "Densities as skin, flesh and bone",
        Colouring::Labels => "Whole numbers that label parts: one colour each; 0 is empty",
        Colouring::Packed => "Packed colours of a sculpture, 0 is empty; thresholds do not apply",
    }
}

fn up(ui: &mut Ui, study: &VolumeStudy, options: &mut ImportOptions, at: &mut UVec3) {
    let label = ui.label("Up");
    let mut up = options.upright.unwrap_or_default();
    let before = up;
    ComboBox::from_id_salt("up")
        .width(120.0)
        .selected_text(upright::label(up))
        .show_ui(ui, |ui| {
            for (axis, _) in Up::NAMED {
                ui.selectable_value(&mut up, axis, upright::label(axis));
            }
        })
        .response
        .labelled_by(label.id)
        .on_hover_text("The axis of the file that points up; the slices show it");
    if up != before {
        options.upright = Some(up);
        *at = study.upright_dims(study.turn(options)) / 2;
    }
    ui.end_row();
}

fn cubic(ui: &mut Ui, study: &VolumeStudy, options: &mut ImportOptions) {
    let label = ui.label("Voxels");
    let finest = study.volume.voxel_size.min_element();
    let edge = match options.cubic {
        Cubic::EdgeMm(edge) => edge,
        _ => finest.clamp(*EDGE_MM.start(), *EDGE_MM.end()),
    };
    let choices = [
        (Cubic::No, "As in the file", "Voxels keep their edge lengths, which may differ"),
        (Cubic::Finest, "Cubes, finest", "Resampled to the shortest edge of the file"),
        (Cubic::EdgeMm(edge), "Cubes of", "Resampled to an edge length in millimetres"),
    ];
    let same = |a: Cubic, b: Cubic| std::mem::discriminant(&a) == std::mem::discriminant(&b);
    let name = choices.iter().find(|(cubic, ..)| same(*cubic, options.cubic));
    ui.horizontal(|ui| {
        ComboBox::from_id_salt("cubic")
            .width(120.0)
            .selected_text(name.map_or("", |(_, name, _)| name))
            .show_ui(ui, |ui| {
                for (cubic, name, help) in choices {
                    let is_chosen = same(cubic, options.cubic);
                    if ui.selectable_label(is_chosen, name).on_hover_text(help).clicked() {
                        options.cubic = cubic;
                    }
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text("Resampling of the voxels to cubes");
        if let Cubic::EdgeMm(edge) = &mut options.cubic {
            ui.add(DragValue::new(edge).range(EDGE_MM).speed(0.01).suffix(" mm"));
        }
    });
    ui.end_row();
}

/// Shows the region to read, along the axes of the volume in its final orientation.
fn region(ui: &mut Ui, study: &VolumeStudy, options: &mut ImportOptions) {
    let turn = study.turn(options);
    let dims = study.upright_dims(turn);
    let mut region = study.upright_region(turn, options.region.unwrap_or(study.whole()));
    let before = region;
    ui.horizontal(|ui| {
        ui.label(RichText::new("Part to read").strong()).on_hover_text(
            "Voxels from the first to the last, as the slices show them: x to the right, y up, z to the front",
        );
        let part = ui.add_enabled(options.region.is_some(), egui::Button::new("All"));
        if part.on_hover_text("Read the whole file").clicked() {
            region = ScanRegion { low: UVec3::ZERO, high: dims - 1 };
        }
    });
    Grid::new("region").num_columns(4).spacing([6.0, 4.0]).show(ui, |ui| {
        for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
            let label = ui.label(name);
            let (low, high) = (&mut region.low[axis], &mut region.high[axis]);
            ui.add(DragValue::new(low).range(0..=*high)).labelled_by(label.id);
            let to = ui.label("to");
            ui.add(DragValue::new(high).range(*low..=dims[axis] - 1)).labelled_by(to.id);
            ui.end_row();
        }
    });
    if region != before {
        let region = study.region_in_file(turn, region);
        options.region = (region != study.whole()).then_some(region);
    }
}
