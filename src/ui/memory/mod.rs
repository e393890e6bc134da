//! Owns the state restored at the next start, as text: the look of the interface, the positions of panels, the tool in
//! hand with its colours, the last folder and the last files.
//!
//! Takes and gives text; knows no file. An unreadable entry is skipped and never stops a start. A setting changed since
//! then overrides the remembered value.

mod brushes;
mod check;
mod draw;
mod final_picture;
mod pen;
pub mod recent;
mod references;
pub mod upright;
mod values;

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize};

use crate::editor::sizes::SizeUnit;
use crate::editor::tool::{ToolKind, ToolState};
use crate::input::{DrawKind, Panel, ToolMode};
use crate::sculpture::Rgb;
use crate::tools::brush::BrushId;
use crate::tools::solid::Solid;
use crate::ui::dialogs::import::Remembered;
use crate::ui::layout::PanelPlace;
use crate::ui::memory::check::KeptCheck;
use crate::ui::memory::draw::KeptDraw;
use crate::ui::memory::final_picture::KeptFinal;
use crate::ui::memory::pen::KeptPens;
use crate::ui::memory::recent::Recent;
use crate::ui::memory::upright::Upright;
use crate::ui::memory::values::neat;
use crate::ui::state::UiState;
use crate::ui::window_options::{SCALE_RANGE, Theme, WindowOptions};

const HEAD: &str = "\
# What Virtual Sculpture remembers from one start to the next. Settings stand in config.toml; this
# file may be deleted.
";
/// Longest autosave interval, in minutes.
const MOST_AUTOSAVE_MIN: u32 = 1440;
/// Valid sides of windows, in points.
const SIDES: std::ops::RangeInclusive<u32> = 64..=16384;

#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct KeptState {
    #[serde(deserialize_with = "lenient")]
    theme: Option<Theme>,
    #[serde(deserialize_with = "lenient")]
    scale: Option<f64>,
    /// Width and height of the main window in points.
    #[serde(deserialize_with = "lenient")]
    window: Option<[u32; 2]>,
    #[serde(deserialize_with = "lenient")]
    maximised: Option<bool>,
    /// Panels in windows of their own.
    #[serde(deserialize_with = "lenient")]
    #[serde(rename = "torn")]
    detached: Option<Vec<String>>,
    #[serde(deserialize_with = "lenient")]
    folder: Option<String>,
    /// The extension of the last exported file.
    #[serde(deserialize_with = "lenient")]
    export: Option<String>,
    #[serde(deserialize_with = "lenient")]
    recent: Option<Vec<toml::Value>>,
    /// The looks of the settings at the time of writing.
    #[serde(deserialize_with = "lenient")]
    settings: Option<Looks>,
    #[serde(deserialize_with = "lenient")]
    sections: Option<BTreeMap<String, bool>>,
    /// The up axis of files by extension.
    #[serde(deserialize_with = "lenient")]
    upright: Option<BTreeMap<String, String>>,
    #[serde(deserialize_with = "lenient")]
    panels: Option<BTreeMap<String, PanelPlace>>,
    #[serde(deserialize_with = "lenient")]
    tool: Option<KeptTool>,
    #[serde(deserialize_with = "lenient")]
    brushes: Option<toml::Table>,
    /// The options of brushes as earlier versions wrote them.
    #[serde(deserialize_with = "lenient", skip_serializing)]
    sprays: Option<toml::Table>,
    #[serde(deserialize_with = "lenient", skip_serializing)]
    deforms: Option<toml::Table>,
    #[serde(deserialize_with = "lenient")]
    draws: Option<KeptDraw>,
    #[serde(deserialize_with = "lenient")]
    pens: Option<KeptPens>,
    #[serde(deserialize_with = "lenient")]
    references: Option<Vec<toml::Value>>,
    /// Whether the import dialog asks, and the last answers.
    #[serde(deserialize_with = "lenient")]
    ask_import: Option<bool>,
    /// Minutes between automatic saves, as chosen and as the settings said then.
    #[serde(deserialize_with = "lenient")]
    autosave_min: Option<[u32; 2]>,
    #[serde(deserialize_with = "lenient")]
    imports: Option<Vec<toml::Value>>,
    #[serde(deserialize_with = "lenient")]
    final_picture: Option<KeptFinal>,
    #[serde(deserialize_with = "lenient")]
    print_check: Option<KeptCheck>,
}

#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Looks {
    theme: Theme,
    scale: f64,
    window: [u32; 2],
}

impl Looks {
    fn of(window: &WindowOptions) -> Looks {
        Looks { theme: window.theme, scale: neat(window.scale), window: window.size }
    }
}

#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct KeptTool {
    #[serde(deserialize_with = "lenient")]
    kind: Option<String>,
    /// The brush in hand, if an earlier version stored one that deforms.
    #[serde(deserialize_with = "lenient", skip_serializing)]
    deform: Option<String>,
    /// The unit of the sizes of brushes; missing in earlier versions.
    #[serde(deserialize_with = "lenient")]
    sizes: Option<String>,
    #[serde(deserialize_with = "lenient")]
    solid: Option<String>,
    #[serde(deserialize_with = "lenient")]
    mode: Option<String>,
    #[serde(deserialize_with = "lenient")]
    follow: Option<bool>,
    #[serde(deserialize_with = "lenient")]
    snap: Option<bool>,
    #[serde(deserialize_with = "lenient")]
    stand: Option<bool>,
    #[serde(deserialize_with = "lenient")]
    lean: Option<bool>,
    #[serde(deserialize_with = "lenient")]
    colour: Option<String>,
    #[serde(deserialize_with = "lenient")]
    used_colours: Option<Vec<String>>,
}

impl KeptTool {
    fn size_unit(&self) -> Option<SizeUnit> {
        SizeUnit::ALL.into_iter().find(|unit| self.sizes.as_deref() == Some(unit.name()))
    }
}

/// Returns the text to remember.
pub fn to_text(state: &UiState, tool: &ToolState, window: &WindowOptions) -> String {
    let names = |panels: &mut dyn Iterator<Item = &Panel>| {
        panels.map(|panel| panel.title().to_string()).collect()
    };
    let places = state.layout.windows.panels.iter();
    let kept = KeptState {
        theme: Some(state.appearance.theme),
        scale: Some(neat(state.appearance.scale.factor())),
        window: state.layout.windows.main,
        maximised: Some(state.layout.windows.maximised),
        detached: Some(names(&mut state.layout.detached.iter())),
        folder: state.dialogs.files.folder().and_then(|folder| folder.to_str()).map(String::from),
        export: Some(state.dialogs.files.export_ending().to_string()),
        recent: Some(state.known_files.recent.lines().map(toml::Value::String).collect()),
        settings: Some(Looks::of(window)),
        sections: Some(state.layout.sections.clone()),
        upright: Some(state.known_files.upright.to_texts()),
        panels: Some(places.map(|(panel, place)| (panel.title().to_string(), *place)).collect()),
        tool: Some(kept_tool(tool)),
        brushes: Some(brushes::kept(&tool.brushes)),
        sprays: None,
        deforms: None,
        draws: Some(KeptDraw::of(&tool.draws)),
        pens: Some(KeptPens::of(&state.pen, &tool.pens)),
        references: Some(references::to_values(&state.references)),
        ask_import: Some(state.dialogs.import.ask),
        autosave_min: Some([state.autosave.minutes, state.autosave.usual_min]),
        imports: Some(state.dialogs.import.remembered.lines().map(toml::Value::String).collect()),
        final_picture: Some(KeptFinal::of(&state.dialogs.final_picture)),
        print_check: Some(KeptCheck::of(&state.dialogs.print_check.options)),
    };
    match toml::to_string(&kept) {
        Ok(text) => format!("{HEAD}{text}"),
        Err(error) => {
            tracing::warn!("the state cannot be written as text: {error}");
            HEAD.to_string()
        }
    }
}

/// Restores the state of the interface from a text.
pub fn recall(text: &str, state: &mut UiState, tool: &mut ToolState, window: &WindowOptions) {
    let kept: KeptState = match toml::from_str(text) {
        Ok(kept) => kept,
        Err(error) => {
            tracing::warn!("the remembered state cannot be read: {error}");
            return;
        }
    };
    let now = Looks::of(window);
    let then = kept.settings.unwrap_or(now);
    if let Some(theme) = kept.theme.filter(|_| then.theme == now.theme) {
        state.appearance.theme = theme;
    }
    let scale = kept.scale.map(|scale| scale as f32).filter(|scale| SCALE_RANGE.contains(scale));
    if let Some(scale) = scale.filter(|_| then.scale == now.scale) {
        state.appearance.scale.set(scale);
    }
    if then.window == now.window {
        state.layout.windows.main = kept.window.filter(is_side);
        state.layout.windows.maximised = kept.maximised.unwrap_or(false);
    }
    let panel = |name: &String| Panel::ALL.into_iter().find(|panel| panel.title() == name);
    state.layout.detached.extend(kept.detached.iter().flatten().filter_map(panel));
    let places = kept.panels.into_iter().flatten();
    state.layout.windows.panels.extend(
        places
            .filter(|(_, place)| is_side(&place.size_px))
            .filter_map(|(name, place)| Some((panel(&name)?, place))),
    );
    if let Some(folder) = kept.folder {
        state.dialogs.files.set_folder(PathBuf::from(folder));
    }
    if let Some(ending) = &kept.export {
        state.dialogs.files.set_export_ending(ending);
    }
    let lines = kept.recent.iter().flatten().filter_map(toml::Value::as_str);
    state.known_files.recent = Recent::from_lines(lines);
    state.known_files.upright = kept.upright.as_ref().map(Upright::from_texts).unwrap_or_default();
    state.references = references::from_values(kept.references.unwrap_or_default());
    state.dialogs.import.ask = kept.ask_import.unwrap_or(true);
    if let Some([chosen, usual]) = kept.autosave_min
        && usual == state.autosave.usual_min
    {
        state.autosave.minutes = chosen.min(MOST_AUTOSAVE_MIN);
    }
    let imports = kept.imports.iter().flatten().filter_map(toml::Value::as_str);
    state.dialogs.import.remembered = Remembered::from_lines(imports);
    if let Some(choices) = kept.print_check {
        choices.recall(&mut state.dialogs.print_check.options);
    }
    if let Some(choices) = kept.final_picture {
        choices.recall(&mut state.dialogs.final_picture);
    }
    state.layout.sections.extend(kept.sections.into_iter().flatten().take(64));
    recall_tool(kept.tool.as_ref().unwrap_or(&KeptTool::default()), tool);
    let unit = kept.tool.as_ref().and_then(KeptTool::size_unit);
    tool.brushes.unit = unit.unwrap_or(tool.brushes.unit);
    if let Some(sprays) = &kept.sprays {
        brushes::recall_sprays(sprays, unit, &mut tool.brushes);
    }
    if let Some(deforms) = &kept.deforms {
        brushes::recall_deforms(deforms, unit, &mut tool.brushes);
    }
    if let Some(brushes) = &kept.brushes {
        brushes::recall(brushes, tool.brushes.unit, &mut tool.brushes);
    }
    if let Some(draws) = &kept.draws {
        draws.recall(&mut tool.draws);
    }
    if let Some(pens) = &kept.pens {
        pens.recall(&mut state.pen, &mut tool.pens);
    }
}

/// Returns the remembered answers about up axes.
pub fn upright(text: &str) -> Upright {
    let kept: KeptState = toml::from_str(text).unwrap_or_default();
    kept.upright.as_ref().map(Upright::from_texts).unwrap_or_default()
}

fn kept_tool(tool: &ToolState) -> KeptTool {
    let kind = match tool.kind {
        ToolKind::Solid => SOLID,
        ToolKind::Draw(kind) => kind.name(),
        ToolKind::Marker => MARKER,
        ToolKind::Brush(brush) => brush.spec().name,
    };
    KeptTool {
        kind: Some(kind.to_string()),
        deform: None,
        sizes: Some(tool.brushes.unit.name().to_string()),
        solid: Some(tool.solid.name().to_string()),
        mode: Some(mode_name(tool.mode).to_string()),
        follow: Some(tool.follow),
        snap: Some(tool.snap),
        stand: Some(tool.stand),
        lean: Some(tool.lean),
        colour: Some(tool.colour.to_string()),
        used_colours: Some(tool.recent().iter().map(Rgb::to_string).collect()),
    }
}

fn recall_tool(kept: &KeptTool, tool: &mut ToolState) {
    let draw = |name: &str| DrawKind::ALL.into_iter().find(|kind| kind.name() == name);
    let brush = |name: &str| {
        let found = BrushId::ALL.iter().find(|brush| brush.spec().name == name);
        found.map(|brush| ToolKind::Brush(*brush))
    };
    let kind = match kept.kind.as_deref() {
        Some(SOLID) => Some(ToolKind::Solid),
        Some(MARKER) => Some(ToolKind::Marker),
        Some(DEFORM) => kept.deform.as_deref().and_then(brush),
        other => other.and_then(brush).or(other.and_then(draw).map(ToolKind::Draw)),
    };
    tool.kind = kind.unwrap_or(tool.kind);
    let solid = Solid::named;
    tool.solid = kept.solid.as_deref().and_then(solid).unwrap_or(tool.solid);
    let mode = |name: &str| ToolMode::ALL.into_iter().find(|mode| mode_name(*mode) == name);
    tool.mode = kept.mode.as_deref().and_then(mode).unwrap_or(tool.mode);
    tool.follow = kept.follow.unwrap_or(tool.follow);
    tool.snap = kept.snap.unwrap_or(tool.snap);
    tool.stand = kept.stand.unwrap_or(tool.stand);
    tool.lean = kept.lean.unwrap_or(tool.lean);
    let colour = |text: &String| text.parse().ok();
    tool.colour = kept.colour.as_ref().and_then(colour).unwrap_or(tool.colour);
    tool.set_recent(kept.used_colours.iter().flatten().filter_map(colour));
}

const SOLID: &str = "solid";
/// A name from earlier versions.
const DEFORM: &str = "deform";
const MARKER: &str = "marker";

const fn mode_name(mode: ToolMode) -> &'static str {
    match mode {
        ToolMode::Add => "add",
        ToolMode::Subtract => "subtract",
        ToolMode::Recolour => "recolour",
        ToolMode::Protect | ToolMode::Release => "protect",
    }
}

fn is_side(size: &[u32; 2]) -> bool {
    size.iter().all(|side| SIDES.contains(side))
}

/// Reads an invalid value as `None`.
fn lenient<'de, D: Deserializer<'de>, T: DeserializeOwned>(from: D) -> Result<Option<T>, D::Error> {
    let value = toml::Value::deserialize(from)?;
    let text = value.to_string();
    Ok(value.try_into().inspect_err(|error| tracing::warn!("not remembered: {text}: {error}")).ok())
}

#[cfg(test)]
mod tests;
