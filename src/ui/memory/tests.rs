//! Tests of the remembered state.

use glam::UVec3;
use proptest::prelude::*;

use super::*;
use crate::config::Config;
use crate::input::Side;
use crate::sculpture::canvas_frame::CanvasFrame;
use crate::tools::brush::footprint::Outline;
use crate::tools::brush::keys::{OUTLINE, RADIUS, REACH};
use crate::tools::brush::options::BrushOptions;
use crate::ui::references::Reference;

fn state() -> (UiState, ToolState) {
    (
        UiState::new(&Config::default().ui_options()),
        ToolState::new(&CanvasFrame::of(UVec3::splat(64))),
    )
}

fn changed() -> (UiState, ToolState) {
    let (mut state, mut tool) = state();
    state.appearance.theme = Theme::Light;
    state.appearance.scale.set(1.3);
    state.layout.windows.main = Some([1111, 777]);
    state.layout.windows.maximised = true;
    state.layout.detached.insert(Panel::History);
    let place = PanelPlace { corner_px: Some([-40, 20]), size_px: [300, 500] };
    state.layout.windows.panels.insert(Panel::History, place);
    state.layout.sections.insert("Light".to_string(), true);
    state.dialogs.files.set_folder(PathBuf::from("/a folder/\"of\" mine"));
    state.known_files.recent.note(&"open \"/a/ä b.vsc\"".parse().unwrap());
    state.references.push(Reference::new("/a/plan.png".into(), None, Side::Top, 50.0));
    tool.kind = ToolKind::Brush(BrushId::Clay);
    tool.solid = Solid::Pyramid;
    tool.mode = ToolMode::Recolour;
    tool.stand = true;
    tool.follow = false;
    tool.colour = Rgb::new(1, 2, 3);
    tool.used_colour();
    tool.brushes.unit = SizeUnit::Sculpture;
    let clay = tool.brushes.of_mut(BrushId::Clay);
    *clay = clay.with(RADIUS, 33.3).with(OUTLINE, Outline::Square).with(REACH, 7.5);
    (state, tool)
}

#[test]
fn choices_are_found_again() {
    let config = Config::default();
    let (before, tool_before) = changed();
    let text = to_text(&before, &tool_before, &config.window);
    let (mut after, mut tool) = state();
    recall(&text, &mut after, &mut tool, &config.window);
    assert_eq!(after.appearance.theme, Theme::Light);
    assert_eq!(after.appearance.scale.factor(), 1.3);
    assert_eq!(after.layout.windows, before.layout.windows);
    assert_eq!(
        (&after.layout.detached, &after.layout.sections),
        (&before.layout.detached, &before.layout.sections)
    );
    assert_eq!(after.dialogs.files.folder(), before.dialogs.files.folder());
    assert_eq!(after.known_files.recent, before.known_files.recent);
    assert_eq!(after.references, before.references);
    assert_eq!(tool, tool_before);
    assert_eq!(to_text(&after, &tool, &config.window), text);
    // The scale of the settings still defines "as in the settings".
    after.appearance.scale.reset();
    assert_eq!(after.appearance.scale.factor(), 1.0);
}

#[test]
fn a_setting_that_was_changed_since_wins() {
    let (state, mut tool) = changed();
    let text = to_text(&state, &tool, &WindowOptions::default());
    let mut config = Config::default();
    config.window.scale = 2.0;
    let mut after = UiState::new(&config.ui_options());
    recall(&text, &mut after, &mut tool, &config.window);
    assert_eq!((after.appearance.theme, after.appearance.scale.factor()), (Theme::Light, 2.0));
    assert_eq!(after.layout.windows.main, Some([1111, 777]));
    config.window.size = [800, 600];
    let mut after = UiState::new(&config.ui_options());
    recall(&text, &mut after, &mut tool, &config.window);
    assert_eq!((after.layout.windows.main, after.layout.windows.maximised), (None, false));
}

#[test]
fn damaged_values_are_left_out_and_the_rest_is_used() {
    let config = Config::default();
    for text in ["", "theme", "= = =", "\u{0}", "[[recent]]\n", "[tool]\nkind = [1]\n"] {
        let (mut after, mut tool) = state();
        recall(text, &mut after, &mut tool, &config.window);
        let (fresh, fresh_tool) = state();
        let usual = to_text(&fresh, &fresh_tool, &config.window);
        assert_eq!(to_text(&after, &tool, &config.window), usual, "{text}");
    }
    let text = "theme = 7\nscale = nan\nwindow = [0, 99999999]\ntorn = [\"Options\", \"Stove\"]\n\
                recent = [1, \"clear\", \"open \\\"/x\\\"\"]\nolder = true\n\
                [tool]\nkind = \"hammer\"\nsolid = \"cuboid\"\nmode = 3\ncolour = \"red\"\n\
                used_colours = [\"#010203\", \"x\"]\n[sprays.clay]\nradius_px = -inf\n\
                reach_vx = 5\nthreshold = -1\n[panels.Options]\nsize_px = [1, 1]\n";
    let (mut after, mut tool) = state();
    recall(text, &mut after, &mut tool, &config.window);
    assert_eq!((after.appearance.theme, after.appearance.scale.factor()), (Theme::Dark, 1.0));
    assert_eq!(after.layout.windows, state().0.layout.windows);
    assert_eq!(after.layout.detached.iter().collect::<Vec<_>>(), [&Panel::Options]);
    assert_eq!(after.known_files.recent.paths().count(), 1);
    assert_eq!((tool.kind, tool.solid), (ToolKind::Solid, Solid::Cuboid));
    assert_eq!(tool.recent(), [Rgb::new(1, 2, 3)]);
    let clay = tool.brushes.of(BrushId::Clay);
    assert_eq!(*clay, BrushOptions::first(BrushId::Clay).with(REACH, 5.0));
}

/// Checks a file of November 2026 without default values: a value that is written again was read.
#[test]
fn the_memory_of_earlier_versions_is_still_read() {
    let text = include_str!("../../../tests/fixtures/state-2026-11.toml");
    let (mut state, mut tool) = state();
    let window = Config::default().window;
    recall(text, &mut state, &mut tool, &window);
    let again = to_text(&state, &tool, &window);
    let table = |text: &str| text.parse::<toml::Table>().unwrap();
    let (mut then, mut now) = (table(text), table(&again));
    // These tables have other names today.
    let [sprays, deforms] = ["sprays", "deforms"].map(|key| then.remove(key).unwrap());
    then["tool"].as_table_mut().unwrap().remove("deform");
    let brushes = now.remove("brushes").unwrap();
    // Brushes that did not exist then get their defaults.
    let old_of = |name: &str| sprays.get(name).or(deforms.get(name));
    let leads = now["pens"]["leads"].as_table_mut().unwrap();
    leads.retain(|name, _| name == "solid" || old_of(name).is_some());
    assert_eq!(now, then);
    assert_eq!(sprays.as_table().unwrap().len() + deforms.as_table().unwrap().len(), 19);
    for &brush in BrushId::ALL {
        let name = brush.spec().name;
        let Some(old) = old_of(name) else { continue };
        let kept = &brushes[name];
        let names = [
            ("radius", "radius_px"),
            ("reach", "reach_vx"),
            ("threshold", "threshold"),
            ("strength", "cover"),
            ("strength", "strength"),
            ("once_per_stroke", "once_a_stroke"),
            ("falloff", "falloff"),
            ("steady", "steady_px"),
        ];
        let both = names.iter().filter_map(|(now, then)| Some((kept.get(now)?, old.get(then)?)));
        assert!(both.clone().count() > 0 && both.clone().all(|(now, then)| now == then), "{name}");
        if let Some(outline) = kept.get("outline") {
            assert_eq!((outline.as_str(), old["square"].as_bool()), (Some("square"), Some(true)));
        }
        if let Some(bite) = kept.get("bite") {
            assert_eq!((bite.as_str(), old["bites_cubes"].as_bool()), (Some("square"), Some(true)));
        }
    }
}

/// Checks the tool in hand of earlier versions: one that deforms had two names.
#[test]
fn a_brush_in_hand_of_earlier_versions_is_in_hand_again() {
    for (text, expected) in [
        ("kind = \"deform\"\ndeform = \"crease\"", ToolKind::Brush(BrushId::Crease)),
        ("kind = \"erosion\"\ndeform = \"crease\"", ToolKind::Brush(BrushId::Erode)),
        ("kind = \"smear\"", ToolKind::Brush(BrushId::Smear)),
        ("kind = \"deform\"", ToolKind::Solid),
    ] {
        let (mut after, mut tool) = state();
        let text = format!("[tool]\n{text}\n");
        recall(&text, &mut after, &mut tool, &Config::default().window);
        assert_eq!(tool.kind, expected, "{text}");
    }
}

proptest! {
    /// Checks that lost, doubled or changed bytes leave every value in its range.
    #[test]
    fn any_damage_is_survived(at in 0usize..2000, with in "\\PC{0,6}", gone in 0usize..400) {
        let config = Config::default();
        let (changed, changed_tool) = changed();
        let mut text = to_text(&changed, &changed_tool, &config.window);
        let floor = |at: usize, text: &str| (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
        let (from, to) = (floor(at, &text), floor(at + gone, &text));
        text.replace_range(from..to, &with);
        let (mut after, mut tool) = state();
        recall(&text, &mut after, &mut tool, &config.window);
        prop_assert!(SCALE_RANGE.contains(&after.appearance.scale.factor()));
        prop_assert!(after.layout.windows.main.is_none_or(|size| is_side(&size)));
        for &brush in BrushId::ALL {
            for (param, value) in tool.brushes.of(brush).iter() {
                prop_assert!(param.allows(value, tool.brushes.unit.radii()), "{brush:?} {param:?}");
            }
        }
    }
}
