//! The tools on the left, in two columns: solids and their modes, the marker, brushes. Each kind folds away under its
//! title.

use egui::{Frame, Margin, Rect, RichText, ScrollArea, Sense, Ui, WidgetInfo, WidgetType, vec2};

use crate::editor::tool::ToolKind;
use crate::input::{Action, DrawKind, Panel, ToolMode};
use crate::tools::brush::BrushId;
use crate::tools::brush::spec::BrushGroup;
use crate::tools::solid::Solid;
use crate::ui::context::UiContext;
use crate::ui::panel_head;
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::widgets::buttons::explain;
use crate::ui::widgets::names::mode_name;
use crate::ui::widgets::{brush_icons, draw_icons, icons, section, theme};

const ICON: f32 = 24.0;
/// Least width of a button without a name.
const BARE_WIDTH: f32 = theme::LEAST_TARGET;
/// Height of a title.
const TITLE: f32 = theme::LEAST_TARGET;
/// Least height of a toolbox of two columns that has room for all tools with their names.
const ROOMY: f32 = 900.0;

pub fn show(
    root: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    if state.layout.detached.contains(&Panel::Toolbox) {
        return;
    }
    let frame = Frame::side_top_panel(root.style()).inner_margin(Margin::symmetric(6, 8));
    egui::Panel::left("toolbox")
        .frame(frame)
        .resizable(false)
        .exact_size(theme::toolbox_width(root.ctx().content_rect().width()))
        .show(root, |ui| {
            panel_head::head(ui, Panel::Toolbox, &state.layout, context, requests);
            ScrollArea::vertical()
                .auto_shrink(false)
                .show(ui, |ui| content(ui, state, context, requests));
        });
}

/// Shows the tools.
pub fn content(
    ui: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    ui.spacing_mut().item_spacing = vec2(2.0, 2.0);
    ui.spacing_mut().interact_size.y = TITLE;
    let tool = context.tool;
    // Drops names before tools go out of sight.
    let wide = theme::toolbox_columns(ui.available_width()) > 2;
    let look =
        if wide || ui.clip_rect().height() > ROOMY { ButtonStyle::Full } else { ButtonStyle::Bare };
    let solids = Solid::ALL.map(|solid| ToolEntry {
        name: solid.spec().label.to_string(),
        chosen: tool.kind == ToolKind::Solid && tool.solid == solid,
        action: Action::Solid(solid),
    });
    let shows_mode = matches!(tool.kind, ToolKind::Solid | ToolKind::Draw(_));
    let modes = ToolMode::ALL.map(|mode| ToolEntry {
        name: mode_name(mode).to_string(),
        chosen: shows_mode && tool.mode == mode,
        action: Action::Mode(mode),
    });
    group(ui, state, "Solids", |ui| {
        tools(ui, context, &solids, look, requests);
        ui.add_space(2.0);
        tools(ui, context, &modes, ButtonStyle::Bare, requests);
    });
    let drawn: Vec<ToolEntry> = DrawKind::ALL
        .into_iter()
        .filter(|kind| !context.in_headset || kind.spec().by_hand)
        .map(|kind| ToolEntry {
            name: kind.spec().label.to_string(),
            chosen: tool.kind == ToolKind::Draw(kind),
            action: Action::Draw(kind),
        })
        .collect();
    group(ui, state, "Drawn solids", |ui| tools(ui, context, &drawn, ButtonStyle::Bare, requests));
    let brush = |brush: BrushId| ToolEntry {
        name: brush.spec().label.to_string(),
        chosen: tool.kind == ToolKind::Brush(brush),
        action: Action::Brush(brush),
    };
    let of_group = |group: BrushGroup| -> Vec<ToolEntry> {
        let all = BrushId::ALL.iter().copied();
        all.filter(|brush| brush.spec().group == group).map(brush).collect()
    };
    let marker = ToolEntry {
        name: "Marker".to_string(),
        chosen: tool.kind == ToolKind::Marker,
        action: Action::Marker,
    };
    // The inverse of the mask's brush removes protection.
    let selecting = [marker, brush(BrushId::Mask)];
    group(ui, state, "Selection", |ui| tools(ui, context, &selecting, ButtonStyle::Full, requests));
    let brushes = of_group(BrushGroup::Surface);
    group(ui, state, "Brushes", |ui| tools(ui, context, &brushes, ButtonStyle::Full, requests));
    let deforming = of_group(BrushGroup::Deform);
    group(ui, state, "Deform", |ui| tools(ui, context, &deforming, look, requests));
}

/// A tool to choose.
struct ToolEntry {
    name: String,
    chosen: bool,
    action: Action,
}

/// The parts of a tool shown on its button.
#[derive(Clone, Copy, PartialEq)]
enum ButtonStyle {
    /// Its picture over its name.
    Full,
    /// Its picture; the name is in the tooltip.
    Bare,
}

/// Shows tools under a title that folds them away.
fn group(ui: &mut Ui, state: &mut UiState, title: &str, content: impl FnOnce(&mut Ui)) {
    section::show(ui, RichText::new(title).small().weak(), true, state, |ui, _| content(ui));
}

/// Shows tools, as many in a row as fit.
fn tools(
    ui: &mut Ui,
    context: &UiContext,
    entries: &[ToolEntry],
    look: ButtonStyle,
    requests: &mut Vec<UiRequest>,
) {
    let gap = ui.spacing().item_spacing.x;
    let fitting = |least: f32| ((ui.available_width() + gap) / (least + gap)) as usize;
    let columns = match look {
        ButtonStyle::Full => theme::toolbox_columns(ui.available_width()),
        ButtonStyle::Bare => fitting(BARE_WIDTH).clamp(1, entries.len().max(1)),
    };
    let gaps = gap * (columns - 1) as f32;
    let width = (ui.available_width() - gaps) / columns as f32;
    for row in entries.chunks(columns) {
        ui.horizontal(|ui| {
            row.iter().for_each(|entry| tool(ui, context, width, entry, look, requests));
        });
    }
}

/// Shows a button with a picture over its name.
fn tool(
    ui: &mut Ui,
    context: &UiContext,
    width: f32,
    entry: &ToolEntry,
    look: ButtonStyle,
    requests: &mut Vec<UiRequest>,
) {
    let ToolEntry { name, chosen, action } = entry;
    let (chosen, action) = (*chosen, *action);
    let size = vec2(width, if look == ButtonStyle::Bare { ICON + 6.0 } else { ICON + 22.0 });
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| {
        WidgetInfo::selected(WidgetType::SelectableLabel, ui.is_enabled(), chosen, name)
    });
    let visuals = ui.style().interact_selectable(&response, chosen);
    if chosen || response.hovered() || response.has_focus() {
        ui.painter().rect(
            rect,
            visuals.corner_radius,
            if chosen { visuals.bg_fill } else { visuals.weak_bg_fill },
            visuals.bg_stroke,
            egui::StrokeKind::Inside,
        );
    }
    let middle = if look == ButtonStyle::Bare { rect.height() / 2.0 } else { 5.0 + ICON / 2.0 };
    let icon = Rect::from_center_size(rect.center_top() + vec2(0.0, middle), vec2(ICON, ICON));
    let colour = visuals.text_color();
    match action {
        Action::Solid(solid) => icons::solid(ui.painter(), icon, solid, colour),
        Action::Mode(mode) => {
            let tint = if mode == ToolMode::Recolour && !chosen {
                let [r, g, b] = context.tool.colour.0;
                egui::Color32::from_rgb(r, g, b)
            } else {
                colour
            };
            icons::mode(ui.painter(), icon.shrink(2.0), mode, tint);
        }
        Action::Brush(brush) => brush_icons::draw(ui.painter(), icon, brush, colour),
        Action::Draw(kind) => draw_icons::draw(ui.painter(), icon.shrink(3.0), kind, colour),
        Action::Marker => icons::marker(ui.painter(), icon.shrink(2.0), colour),
        _ => {}
    }
    if look != ButtonStyle::Bare {
        let below = rect.center_bottom() - vec2(0.0, 4.0);
        let font = egui::TextStyle::Small.resolve(ui.style());
        ui.painter().text(below, egui::Align2::CENTER_BOTTOM, name, font, colour);
    }
    if explain(response, context, action).clicked() {
        requests.push(UiRequest::Do(action));
    }
}
