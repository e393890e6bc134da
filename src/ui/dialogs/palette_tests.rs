//! Tests of the palette: the entries listed for a text, and the chosen entry.

use super::*;
use crate::input::{Axis, DrawKind, Panel, Side, ToolMode};
use crate::sculpture::orientation::Up;
use crate::tools::brush::BrushId;
use crate::tools::solid::Solid;
use crate::ui::widgets::filter::british;

fn direct() -> Bindings {
    Bindings::presets().unwrap().remove(0)
}

fn listed(typed: &str) -> Vec<PaletteEntry> {
    entries(typed, Some(&direct())).0
}

#[test]
fn without_words_everything_is_listed() {
    assert_eq!(listed("").len(), Action::ALL.len() + COMMANDS.len());
}

#[test]
fn words_choose_by_text_name_key_and_usage() {
    assert_eq!(listed("step undo last")[0], PaletteEntry::Do(Action::Undo));
    assert!(listed("ctrl+z").contains(&PaletteEntry::Do(Action::Undo)));
    assert!(listed("next-render").contains(&PaletteEntry::Do(Action::NextRenderMode)));
    assert!(matches!(listed("mirror planes centre fly")[..], []));
    assert!(
        matches!(listed("off even odd")[..], [PaletteEntry::Complete(c)] if c.verb == "symmetry")
    );
}

/// Checks the words of people who know other programs, and the action that must come first.
#[test]
fn typed_words_find_the_action() {
    let expected = [
        ("rotate", Action::TurnSculpture),
        ("orbit", Action::TurnSculpture),
        ("pan", Action::PanSculpture),
        ("zoom", Action::Zoom),
        ("magnify", Action::ZoomIn),
        ("zoom out", Action::Zoom),
        ("move", Action::MoveTool),
        ("resize", Action::ResizeTool),
        ("radius", Action::ResizeTool),
        ("bigger", Action::Grow),
        ("smaller", Action::Shrink),
        ("erase", Action::Mode(ToolMode::Subtract)),
        ("eraser", Action::Mode(ToolMode::Subtract)),
        ("remove", Action::Mode(ToolMode::Subtract)),
        ("cut", Action::Mode(ToolMode::Subtract)),
        ("add", Action::Mode(ToolMode::Add)),
        ("build", Action::Mode(ToolMode::Add)),
        ("paint", Action::Mode(ToolMode::Recolour)),
        ("delete", Action::ClearMarker),
        ("sphere", Action::Solid(Solid::Ellipsoid)),
        ("ball", Action::Solid(Solid::Ellipsoid)),
        ("cube", Action::Solid(Solid::Cuboid)),
        ("cone", Action::Solid(Solid::Cone)),
        ("donut", Action::Solid(Solid::Torus)),
        ("brush", Action::Brush(BrushId::Paint)),
        ("airbrush", Action::Brush(BrushId::Paint)),
        ("carve", Action::Brush(BrushId::Devour)),
        ("dig", Action::Brush(BrushId::Devour)),
        ("clay", Action::Brush(BrushId::Clay)),
        ("inflate", Action::Brush(BrushId::Inflate)),
        ("smooth", Action::Brush(BrushId::Smooth)),
        ("blur", Action::Brush(BrushId::Smooth)),
        ("colour", Action::PickColour),
        ("color", Action::PickColour),
        ("eyedropper", Action::PickColour),
        ("marquee", Action::Marker),
        ("select", Action::Marker),
        ("deselect", Action::ClearSelection),
        ("mask", Action::Brush(BrushId::Mask)),
        ("mirror", Action::Mirror(Axis::X)),
        ("symmetry", Action::Mirror(Axis::X)),
        ("flip", Action::Mirror(Axis::X)),
        ("array", Action::Repeat),
        ("duplicate", Action::Copy),
        ("clone", Action::Copy),
        ("paste", Action::Paste),
        ("snap", Action::ToggleSnap),
        ("undo", Action::Undo),
        ("revert", Action::Undo),
        ("redo", Action::Redo),
        ("clear", Action::Clear),
        ("clear grid", Action::Clear),
        ("turn upright", Action::TurnUpright(Up::Z)),
        ("scan", Action::TurnUpright(Up::Z)),
        ("upside down", Action::TurnUpright(Up::MinusY)),
        ("rotate 90", Action::RotateGrid(Axis::X)),
        ("fit", Action::ResetView),
        ("frame", Action::ResetView),
        ("reset view", Action::ResetView),
        ("center", Action::ResetTool),
        ("front", Action::LookFrom(Side::Front)),
        ("top", Action::LookFrom(Side::Top)),
        ("corner", Action::LookFrom(Side::Corner)),
        ("perspective", Action::ToggleOrthographic),
        ("orthographic", Action::ToggleOrthographic),
        ("projection", Action::ToggleOrthographic),
        ("gizmo", Action::ToggleGizmo),
        ("ground", Action::ToggleGround),
        ("floor", Action::ToggleFloor),
        ("blueprint", Action::References),
        ("reference", Action::References),
        ("hide panels", Action::TogglePanels),
        ("copy picture", Action::CopyScreenshot),
        ("grid", Action::ToggleBounds),
        ("show mask", Action::ToggleMask),
        ("fullscreen", Action::Fullscreen),
        ("full screen", Action::Fullscreen),
        ("screenshot", Action::Screenshot),
        ("snapshot", Action::Screenshot),
        ("picture", Action::Screenshot),
        ("final picture", Action::FinalPicture),
        ("path trace", Action::FinalPicture),
        ("dark mode", Action::ToggleTheme),
        ("theme", Action::ToggleTheme),
        ("font", Action::ScaleUp),
        ("panel", Action::Detach(Panel::Toolbox)),
        ("lighting", Action::Lights),
        ("shadow", Action::Lights),
        ("3d", Action::NextStereo),
        ("webcam", Action::ToggleVideo),
        ("augmented reality", Action::ToggleAr),
        ("quality", Action::NextRenderMode),
        ("vibration", Action::ToggleRumble),
        ("controller", Action::NextPadMode),
        ("new", Action::New),
        ("open", Action::Open),
        ("import", Action::Open),
        ("load", Action::Open),
        ("save", Action::Save),
        ("save as", Action::SaveAs),
        ("export", Action::Export),
        ("convert", Action::SaveAs),
        ("search", Action::Palette),
        ("help", Action::Help),
        ("hotkeys", Action::Help),
        ("shortcuts", Action::Help),
        ("keyboard", Action::Help),
        ("preferences", Action::Help),
        ("settings", Action::Help),
        ("tutorial", Action::Guide),
        ("quit", Action::Quit),
        ("exit", Action::Quit),
        ("home", Action::ResetView),
        ("ctrl+z", Action::Undo),
    ];
    let first = |typed: &str| {
        listed(typed).into_iter().find_map(|entry| match entry {
            PaletteEntry::Do(action) => Some(action),
            _ => None,
        })
    };
    let found: Vec<_> = expected.iter().map(|(typed, _)| (*typed, first(typed))).collect();
    let wanted = expected.map(|(typed, action)| (typed, Some(action)));
    let wrong: Vec<_> = found.iter().zip(&wanted).filter(|(a, b)| a != b).collect();
    assert!(wrong.is_empty(), "found and wanted: {wrong:#?}");
    // No entry for other words precedes it, unless intended.
    let led: Vec<&str> = expected
        .iter()
        .filter(|(typed, _)| matches!(listed(typed)[0], PaletteEntry::See(_)))
        .map(|(typed, _)| *typed)
        .collect();
    assert_eq!(led, ["array", "gizmo"]);
}

#[test]
fn synonyms_are_as_searches_are_brought_into() {
    for &action in Action::ALL {
        let words = action.help().synonyms;
        assert_eq!(words, british(words), "{action:?}");
        let list: Vec<&str> = words.split_whitespace().collect();
        let twice = |(i, word): (usize, &&str)| list[..i].contains(word);
        assert!(!list.iter().enumerate().any(twice), "{action:?}");
    }
}

#[test]
fn a_verb_alone_comes_after_the_actions_that_are_called_so() {
    for (typed, first) in [("undo", Action::Undo), ("clear", Action::Clear)] {
        assert_eq!(listed(typed)[0], PaletteEntry::Do(first));
        let run = PaletteEntry::Run(Box::new(typed.parse().unwrap()));
        assert!(listed(typed).contains(&run), "{typed}");
    }
}

#[test]
fn a_typed_command_comes_first_and_a_wrong_one_says_why() {
    let line = "subtract cuboid at=8,8,8 half=2";
    let (list, error) = entries(line, None);
    assert_eq!(list[0], PaletteEntry::Run(Box::new(line.parse().unwrap())));
    assert_eq!(error, None);
    let (list, error) = entries("subtract sponge at=8,8,8", None);
    assert!(matches!(list[..], [PaletteEntry::Complete(c)] if c.verb == "subtract"), "{list:?}");
    assert!(error.unwrap().contains("sponge"));
    assert_eq!(entries("sponge", None).1, None, "no command at all");
}

#[test]
fn actions_of_the_mouse_come_last_and_are_passed_over() {
    let mut palette = CommandPalette::default();
    let list = listed("");
    palette.go(&list, 0);
    assert_eq!(list[palette.chosen], PaletteEntry::Do(Action::PickHere));
    palette.go(&list, -1);
    assert_eq!(list[palette.chosen], PaletteEntry::Do(Action::PickHere));
    palette.go(&list, 1);
    assert_eq!(list[palette.chosen], PaletteEntry::Do(Action::Flood));
    palette.go(&list, 1);
    assert_eq!(list[palette.chosen], PaletteEntry::Do(Action::Cancel));
    palette.go(&list, 1000);
    let last = &list[palette.chosen];
    assert!(matches!(last, PaletteEntry::Complete(c) if c.verb == "place"), "{last:?}");
    assert!(!palette.go(&[], 1) || palette.chosen == 0);
}

/// Returns the first entry that Enter chooses.
fn chosen(typed: &str) -> Option<PaletteEntry> {
    let mut palette = CommandPalette { text: typed.to_string(), ..CommandPalette::default() };
    let list = listed(typed);
    palette.go(&list, 0);
    list.get(palette.chosen).filter(|entry| entry.can_be_chosen()).cloned()
}

#[test]
fn the_name_of_an_action_beats_a_command() {
    assert_eq!(chosen("symmetry"), Some(PaletteEntry::Do(Action::Mirror(Axis::X))));
    assert_eq!(chosen("mask"), Some(PaletteEntry::Do(Action::Brush(BrushId::Mask))));
    assert_eq!(chosen("noise"), Some(PaletteEntry::Do(Action::Tints)));
    assert!(matches!(
        chosen("array"),
        Some(PaletteEntry::See(it)) if it.target == SearchTarget::Option(Spot::Array)
    ));
    for help in COMMANDS.iter() {
        let (list, error) = entries(help.verb, Some(&direct()));
        assert_eq!(error, None, "{} is not wrong because it is not complete", help.verb);
        let is_command = |entry: &PaletteEntry| {
            matches!(entry, PaletteEntry::Run(_) | PaletteEntry::Complete(_))
        };
        let first = list.iter().position(is_command).unwrap();
        let named = |entry: &PaletteEntry| match entry {
            PaletteEntry::Do(action) => {
                Filter::new(help.verb).rank(action.help().text, &[], &[]) == Some(0)
            }
            _ => false,
        };
        assert!(!list[first..].iter().any(named), "{}", help.verb);
    }
}

#[test]
fn a_command_that_is_not_complete_is_begun() {
    for help in COMMANDS.iter().filter(|help| !help.usage.is_empty()) {
        let mut palette =
            CommandPalette { open: true, text: help.verb.to_string(), ..CommandPalette::default() };
        let mut requests = Vec::new();
        palette.choose(&PaletteEntry::Complete(help), &mut requests);
        assert_eq!((palette.text.as_str(), requests.len()), (&*format!("{} ", help.verb), 0));
        assert!(palette.open && palette.completed);
        assert_eq!(begun(&palette.text), Some(help), "its arguments are shown");
    }
}

/// Checks the words of other programs for features that are missing here or have another name.
#[test]
fn features_with_another_name_or_missing_are_named() {
    let wanted = [
        ("boolean", SearchTarget::Do(Action::Mode(ToolMode::Subtract))),
        ("remesh", SearchTarget::Do(Action::Brush(BrushId::Smooth))),
        ("resample", SearchTarget::Do(Action::New)),
        ("subdivide", SearchTarget::Do(Action::New)),
        ("decimate", SearchTarget::Do(Action::Export)),
        ("layers", SearchTarget::Do(Action::Masks)),
        ("layer", SearchTarget::Do(Action::Masks)),
        ("wireframe", SearchTarget::Do(Action::ToggleBounds)),
        ("pivot", SearchTarget::Do(Action::ResetView)),
        ("matcap", SearchTarget::Option(Spot::Looks)),
        ("alpha", SearchTarget::Option(Spot::Stencil)),
        ("stencil", SearchTarget::Option(Spot::Stencil)),
        ("isolate", SearchTarget::Do(Action::Masks)),
        ("transform", SearchTarget::Do(Action::Marker)),
        ("gizmo", SearchTarget::Do(Action::Marker)),
        ("voxelize", SearchTarget::Do(Action::Open)),
        ("multires", SearchTarget::Do(Action::New)),
        ("dyntopo", SearchTarget::Do(Action::Brush(BrushId::Smooth))),
        ("clay strips", SearchTarget::Do(Action::Brush(BrushId::Clay))),
        ("lazy", SearchTarget::Option(Spot::Steady)),
        ("stabilizer", SearchTarget::Option(Spot::Steady)),
        ("steady", SearchTarget::Option(Spot::Steady)),
        ("material", SearchTarget::Option(Spot::Looks)),
        ("xray", SearchTarget::Do(Action::Draw(DrawKind::Plane))),
        ("measure", SearchTarget::Do(Action::Marker)),
        ("merge", SearchTarget::Do(Action::Copy)),
        ("extract", SearchTarget::Do(Action::Copy)),
        ("thickness", SearchTarget::Do(Action::PrintCheck)),
        ("enlarge grid", SearchTarget::Do(Action::New)),
        ("canvas", SearchTarget::Do(Action::New)),
        ("crop", SearchTarget::Do(Action::Marker)),
        ("scale", SearchTarget::Do(Action::Grow)),
        ("focus", SearchTarget::Do(Action::ResetView)),
        ("hdri", SearchTarget::Do(Action::FinalPicture)),
        ("ao", SearchTarget::Option(Spot::Occlusion)),
        ("solid view", SearchTarget::Option(Spot::RenderMode)),
    ];
    for (typed, target) in wanted {
        let found = chosen(typed);
        assert!(
            matches!(&found, Some(PaletteEntry::See(it)) if it.target == target),
            "{typed}: {found:?}"
        );
    }
    assert_eq!(chosen("export stl"), Some(PaletteEntry::Do(Action::Export)));
    assert_eq!(listed("free rotate")[0], PaletteEntry::Do(Action::TurnSculpture));
}
