//! The window of the print check: the requirements of a print, the findings, and buttons that repair it.
//!
//! Asks with [`UiRequest::PrintCheck`]; the result comes from a thread through [`PrintCheck::news`]. Gives the lines
//! that show the findings in the view. Changes no sculpture.

use std::sync::{Arc, Mutex, PoisonError};

use egui::{Color32, DragValue, Grid, RichText, ScrollArea, Sense, Ui, Window, pos2, vec2};
use glam::{IVec3, Vec3};

use crate::command::Command;
use crate::document::Document;
use crate::print_check::{CheckOptions, Checked, FaultKind, FaultLocation, Finding};
use crate::render::overlay::OverlayLine;
use crate::sculpture::Rgb;
use crate::sculpture::region::VoxelBox;
use crate::tools::repair::Repair;
use crate::ui::context::UiContext;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::names::capital;
use crate::ui::widgets::theme;

const WIDTH: f32 = 310.0;
/// Largest height of the list of findings.
const HEIGHT: f32 = 300.0;
/// Number of places listed for each kind.
const LISTED: usize = 50;
/// Most lines that hatch the voxels of a kind.
const MOST_HATCHES: usize = 1200;
/// Valid lengths in the window, in millimetres.
const LENGTHS_MM: std::ops::RangeInclusive<f32> = 0.01..=10_000.0;

/// The findings of a check, and their display.
#[derive(Debug)]
pub struct ShownFindings {
    pub checked: Checked,
    /// The revision of the document that was checked.
    revision: u64,
    /// Lines along x through the voxels of each finding.
    hatches: Vec<(FaultKind, Vec3, Vec3)>,
}

impl ShownFindings {
    pub fn new(checked: Checked, revision: u64) -> ShownFindings {
        let hatches = checked.findings.iter().flat_map(hatches).collect();
        ShownFindings { checked, revision, hatches }
    }
}

/// A thread's slot for its findings.
pub type FindingsSlot = Arc<Mutex<Option<ShownFindings>>>;

/// The window's own state.
#[derive(Debug)]
pub struct PrintCheck {
    pub open: bool,
    pub options: CheckOptions,
    /// The view shows the findings.
    pub shown: bool,
    found: Option<ShownFindings>,
    /// The place that was clicked.
    chosen: Option<VoxelBox>,
    news: FindingsSlot,
}

impl Default for PrintCheck {
    fn default() -> PrintCheck {
        let options = CheckOptions::default();
        let (found, chosen, news) = (None, None, FindingsSlot::default());
        PrintCheck { open: false, options, shown: true, found, chosen, news }
    }
}

impl PrintCheck {
    /// Returns the slot for the next result.
    pub fn news(&self) -> FindingsSlot {
        self.news.clone()
    }

    /// Takes a new result, if there is one.
    fn take_news(&mut self) {
        let news = self.news.lock().unwrap_or_else(PoisonError::into_inner).take();
        if news.is_some() {
            self.found = news;
            self.chosen = None;
        }
    }

    /// Returns whether the present state of the sculpture has been checked.
    pub fn is_current(&self, document: &Document) -> bool {
        self.current(document).is_some()
    }

    /// Returns the findings if they are of the present state of the sculpture.
    fn current(&self, document: &Document) -> Option<&ShownFindings> {
        self.found.as_ref().filter(|found| found.revision == document.revision())
    }

    /// Returns the lines that show the findings in the view, while the window is open and they are current.
    pub fn lines(&self, document: &Document) -> Vec<OverlayLine> {
        let mut lines = Vec::new();
        let Some(found) = self.current(document).filter(|_| self.open && self.shown) else {
            return lines;
        };
        for (kind, from, to) in &found.hatches {
            let colour = colour(*kind);
            lines.push(OverlayLine {
                from: *from,
                to: *to,
                colour,
                width_px: 2.0,
                opacity: [1.0, 0.45],
            });
        }
        let places = found.checked.findings.iter();
        for (kind, place) in
            places.flat_map(|f| f.places.iter().take(LISTED).map(|place| (f.kind, place)))
        {
            frame(&mut lines, place.bounds, colour(kind), 1.4, [0.9, 0.5]);
        }
        if let Some(chosen) = self.chosen {
            frame(&mut lines, chosen, Rgb::new(0xff, 0xff, 0xff), 3.0, [1.0, 0.8]);
        }
        lines
    }
}

/// Returns the colour of a kind in the view and in the list.
fn colour(kind: FaultKind) -> Rgb {
    match kind {
        FaultKind::Islands => Rgb::new(0xe0, 0x50, 0xc0),
        FaultKind::Cavities => Rgb::new(0x38, 0x98, 0xff),
        FaultKind::ThinWalls => Rgb::new(0xf0, 0x40, 0x30),
        FaultKind::Overhangs => Rgb::new(0xf8, 0xa8, 0x10),
    }
}

/// Returns lines through runs of voxels along x, skipping rows of a large finding.
fn hatches(finding: &Finding) -> Vec<(FaultKind, Vec3, Vec3)> {
    // Overhangs are seen from below: the line would lie inside the voxels.
    let lift = if finding.kind == FaultKind::Overhangs { -0.05 } else { 0.5 };
    let mut runs: Vec<(Vec3, Vec3)> = Vec::new();
    for (b, mask) in finding.marked.bricks() {
        let corner = (*b * 8).as_vec3();
        for (z, rows) in (0..).zip(mask.to_rows()) {
            for y in 0..8 {
                let mut row = (rows >> (8 * y) & 0xFF) as u32;
                while row != 0 {
                    let first = row.trailing_zeros();
                    let length = (row >> first).trailing_ones();
                    row &= !(((1 << length) - 1) << first);
                    let at = |x: u32| corner + Vec3::new(x as f32, y as f32 + lift, z as f32 + 0.5);
                    runs.push((at(first), at(first + length)));
                }
            }
        }
    }
    let stride = runs.len().div_ceil(MOST_HATCHES).max(1);
    runs.into_iter().step_by(stride).map(|(from, to)| (finding.kind, from, to)).collect()
}

/// Adds the twelve edges of a box.
fn frame(
    lines: &mut Vec<OverlayLine>,
    bounds: VoxelBox,
    colour: Rgb,
    width_px: f32,
    opacity: [f32; 2],
) {
    let (min, max) = (bounds.min.as_vec3(), bounds.max.as_vec3());
    for axis in 0..3 {
        for corner in 0..4 {
            let mut from = min;
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            from[u] = if corner & 1 == 0 { min[u] } else { max[u] };
            from[v] = if corner & 2 == 0 { min[v] } else { max[v] };
            let mut to = from;
            to[axis] = max[axis];
            lines.push(OverlayLine { from, to, colour, width_px, opacity });
        }
    }
}

impl Dialog for PrintCheck {
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
        let DialogContext { context, requests, .. } = shared;
        self.take_news();
        if !self.open {
            return;
        }
        let mut open = true;
        Window::new("Print check")
            .open(&mut open)
            .resizable(false)
            .default_width(WIDTH)
            .default_pos(pos2(theme::TOOLBOX_WIDTH + 32.0, 60.0))
            .show(root.ctx(), |ui| {
                ui.set_width(WIDTH);
                Grid::new("print options").num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
                    options(ui, &mut self.options, context);
                });
                ui.add_space(4.0);
                ui.horizontal(|ui| {
                    let again = self.found.is_some();
                    let label = if again { "Check again" } else { "Check" };
                    let check = ui.add(theme::primary(ui.visuals(), label));
                    if check.on_hover_text("In the background; can be cancelled").clicked() {
                        requests.push(UiRequest::PrintCheck(self.options));
                    }
                    ui.checkbox(&mut self.shown, "Show in the view")
                        .on_hover_text("Mark the findings with lines and boxes");
                });
                findings(ui, self, context, requests);
            });
        self.open &= open;
    }
}

fn options(ui: &mut Ui, options: &mut CheckOptions, context: &UiContext) {
    let length = |ui: &mut Ui, label: &str, value: &mut f32, help: &str| {
        let label = ui.label(label);
        ui.add(DragValue::new(value).range(LENGTHS_MM).speed(0.02).suffix(" mm"))
            .labelled_by(label.id)
            .on_hover_text(help);
        ui.end_row();
    };
    length(
        ui,
        "Walls",
        &mut options.wall_mm,
        "Minimum wall thickness; about 1.2 mm for a 0.4 mm nozzle",
    );
    let mut voxel_mm = options.voxel_mm_of(context.document.grid()).x;
    let before = voxel_mm;
    length(ui, "Voxel", &mut voxel_mm, "Edge length of a voxel in the print");
    if voxel_mm != before {
        options.voxel_mm = Some(voxel_mm);
    }
    let label = ui.label("Overhang");
    ui.add(DragValue::new(&mut options.overhang_deg).range(0.0..=90.0).speed(0.5).suffix("°"))
        .labelled_by(label.id)
        .on_hover_text("Surfaces that lean further out from the vertical need support");
    ui.end_row();
    let label = ui.label("Bridge");
    ui.add(DragValue::new(&mut options.bridge_mm).range(0.0..=1000.0).speed(0.1).suffix(" mm"))
        .labelled_by(label.id)
        .on_hover_text("Gaps up to this length need no support");
    ui.end_row();
    ui.label("Bed");
    ui.horizontal(|ui| {
        let bed = &mut options.bed_mm;
        for (value, help) in [
            (&mut bed.x, "Width of the bed in mm"),
            (&mut bed.z, "Depth of the bed in mm"),
            (&mut bed.y, "Height available above the bed in mm"),
        ] {
            ui.add(DragValue::new(value).range(1.0..=10_000.0).speed(1.0)).on_hover_text(help);
        }
        ui.weak("mm");
    });
    ui.end_row();
}

fn findings(
    ui: &mut Ui,
    window: &mut PrintCheck,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    let (is_current, origin) = (window.is_current(context.document), context.document.origin());
    let PrintCheck { found: Some(found), chosen, .. } = window else { return };
    ui.separator();
    if !is_current {
        ui.label(RichText::new("The sculpture has changed since: check again.").strong());
    }
    let checked = &found.checked;
    let size = sizes(checked.size_mm);
    ui.label(match (checked.size_mm == Vec3::ZERO, checked.fits) {
        (true, _) => RichText::new("Nothing to print: there are no voxels"),
        (_, true) => RichText::new(format!("{size}: fits the bed")),
        (_, false) => {
            let text = RichText::new(format!("{size}: does not fit the bed"));
            text.color(theme::error_colour(ui.visuals()))
        }
    })
    .on_hover_text(format!("{:.1} mm² stand on the bed", checked.contact_mm2));
    if checked.findings.is_empty() && checked.is_printable() {
        ui.label("No faults found: it can be printed without support.");
    }
    // Otherwise the list would keep its height from before.
    let list = ScrollArea::vertical().max_height(HEIGHT).min_scrolled_height(HEIGHT);
    list.auto_shrink([false, true]).show(ui, |ui| {
        for finding in &checked.findings {
            ui.push_id(finding.kind, |ui| {
                of_kind(ui, finding, checked, (is_current, origin), chosen, requests);
            });
        }
    });
}

fn of_kind(
    ui: &mut Ui,
    finding: &Finding,
    checked: &Checked,
    (is_current, origin): (bool, IVec3),
    chosen: &mut Option<VoxelBox>,
    requests: &mut Vec<UiRequest>,
) {
    ui.horizontal(|ui| {
        let (swatch, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
        let [r, g, b] = colour(finding.kind).0;
        ui.painter().rect_filled(swatch, 3.0, Color32::from_rgb(r, g, b));
        let title = format!("{}: {}", capital(finding.kind.name()), finding.count);
        ui.label(RichText::new(title).strong()).on_hover_text(format!(
            "{}; {} voxels",
            meaning(finding.kind),
            finding.voxels
        ));
    });
    ui.horizontal_wrapped(|ui| {
        for repair in &finding.repairs {
            let command = Command::Repair(*repair);
            let button = ui.add_enabled(is_current, egui::Button::new(name_of(repair)));
            let button = button.on_hover_text(format!("Runs `{command}`, which can be undone"));
            let button = button.on_disabled_hover_text("The sculpture has changed: check again");
            if button.clicked() {
                requests.push(UiRequest::Run(command));
            }
        }
        if finding.repairs.is_empty() {
            ui.weak("The slicer adds support here");
        }
    });
    for FaultLocation { voxels, bounds } in finding.places.iter().take(LISTED) {
        let size = sizes((bounds.max - bounds.min).as_vec3() * checked.voxel_mm);
        let is_chosen = *chosen == Some(*bounds);
        let label = ui.selectable_label(is_chosen, format!("{size}, {voxels} voxels"));
        let at = bounds.min + origin;
        let label = label.on_hover_text(format!(
            "At voxel {}, {}, {}; a click puts the marker around it",
            at.x, at.y, at.z
        ));
        if label.clicked() && is_current {
            *chosen = Some(*bounds);
            requests.push(UiRequest::Run(Command::Mark(*bounds)));
        }
    }
    if finding.count > LISTED {
        ui.weak(format!("and {} smaller ones", finding.count - LISTED));
    }
    ui.add_space(4.0);
}

/// Describes a kind of finding, for tooltips.
const fn meaning(kind: FaultKind) -> &'static str {
    match kind {
        FaultKind::Islands => "Floating pieces, connected to nothing",
        FaultKind::Cavities => "Enclosed empty spaces",
        FaultKind::ThinWalls => "Walls below the minimum thickness",
        FaultKind::Overhangs => "Surfaces that need support",
    }
}

const fn name_of(repair: &Repair) -> &'static str {
    match repair {
        Repair::RemoveIslands { .. } => "Remove islands",
        Repair::FillCavities { .. } => "Fill cavities",
        Repair::Thicken { .. } => "Thicken walls",
        Repair::Drain { .. } => "Drill drain holes",
    }
}

fn sizes(mm: Vec3) -> String {
    format!("{:.1} x {:.1} x {:.1} mm", mm.x, mm.y, mm.z)
}
