//! The guide for the first minutes: the learning task of the 2005 evaluation, step by step. A step is ticked off when
//! the sculpture and its history show it done.
//!
//! Only reads the document. The actions of a step that the guide does for the person go out as commands.

use egui::{Align, Frame, Layout, Margin, Panel, RichText, TextStyle, TextWrapMode, Ui};
use egui::{WidgetText, Window, pos2};
use glam::IVec3;

use crate::command::{Area, Command, SelectOp};
use crate::document::Document;
use crate::input::Action;
use crate::sculpture::region::VoxelBox;
use crate::tools::brush::BrushId;
use crate::tools::solid::Solid;
use crate::ui::context::UiContext;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

const WIDTH: f32 = 300.0;
const DONE: &str = "You know the tools now. Build a house, a tree, a lake and a hill!";
const REOPENED: &str = "First steps can be reopened from the menu";

/// The person's progress.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Guide {
    pub open: bool,
    /// Steps stay done, whatever is undone later.
    done: [bool; STEPS.len()],
    /// Length of the history when the present step began, so that earlier attempts do not count.
    since: Option<u64>,
}

/// A step of the guide.
struct GuideStep {
    title: &'static str,
    /// The task; `{}` stands for the shortcuts of `actions`, in order.
    text: &'static str,
    /// The same task for hands with controllers, in a headset.
    by_hand: &'static str,
    actions: &'static [Action],
    /// Checks the sculpture, and the history since the step began.
    is_done: fn(&Document, u64) -> bool,
    /// The box for the marker, for people who would rather type.
    marker: Option<fn(&Document) -> VoxelBox>,
    /// The commands of the step, for people who would rather watch.
    commands: Option<fn(&Document) -> Vec<Command>>,
}

const STEPS: [GuideStep; 7] = [
    GuideStep {
        title: "Clear half of the grid",
        text: "Choose the marker ({}). It is a box: drag it over the stone from corner to corner, \
               pull its faces with Ctrl and the left button, or type its numbers on the right. Put \
               it around the upper half, then delete the voxels in it ({}).",
        by_hand: "Choose the marker. It is a box: it moves with your hand while you pull the \
                  trigger, and its numbers are in the options. Put it around the upper half, then \
                  press Delete in the options.",
        actions: &[Action::Marker, Action::ClearMarker],
        is_done: |document, _| {
            let grid = document.grid();
            let all = document.contents().frame.home.as_u64vec3().element_product();
            (1..=all * 7 / 10).contains(&grid.opaque_count())
        },
        marker: Some(upper_half),
        commands: Some(|document| {
            vec![Command::Mark(upper_half(document)), Command::Clear { area: Area::Marker }]
        }),
    },
    GuideStep {
        title: "Limit the tools to it",
        text: "Limit all tools to the marker ({}). From now on the ground below is safe.",
        by_hand: "Tick Limit tools to selection in the options of the marker. From now on the \
                  ground below is safe.",
        actions: &[Action::ToggleLimit],
        is_done: |document, _| document.selection().limit().is_some(),
        marker: None,
        commands: Some(|document| {
            let mark = Command::Mark(upper_half(document));
            vec![mark, Command::Select(SelectOp::Add), Command::Limit(true)]
        }),
    },
    GuideStep {
        title: "Add a cuboid",
        text: "Choose the cuboid ({}) and Add ({}), enlarge it ({}), tick Rest on the surface on \
               the right, and click on the ground with the left button.",
        by_hand: "Choose the cuboid and Add. Enlarge it with the stick, hold it on the ground and \
                  pull the trigger.",
        actions: &[
            Action::Solid(Solid::Cuboid),
            Action::Mode(crate::input::ToolMode::Add),
            Action::Grow,
        ],
        is_done: |document, since| has_step(document, since, &["add cuboid"]),
        marker: None,
        commands: None,
    },
    GuideStep {
        title: "Roughen it",
        text: "Carve into it with the devourer ({}), then fill the corners with growth ({}): drag \
               both over the cuboid until it looks like rock.",
        by_hand: "Carve into it with the devourer, then fill the corners with growth: pull the \
                  trigger and sweep both over the cuboid until it looks like rock.",
        actions: &[Action::Brush(BrushId::Devour), Action::Brush(BrushId::Grow)],
        is_done: |document, since| has_step(document, since, &["devourer", "growth"]),
        marker: None,
        commands: None,
    },
    GuideStep {
        title: "Smooth it",
        text: "Wear down the edges with erosion ({}). The left button with Shift smooths, whatever \
               the current tool.",
        by_hand: "Wear down the edges with erosion: pull the trigger and sweep it along them. \
                  Smooth evens out what remains.",
        actions: &[Action::Brush(BrushId::Erode)],
        is_done: |document, since| has_step(document, since, &["erosion"]),
        marker: None,
        commands: None,
    },
    GuideStep {
        title: "Paint it",
        text: "Choose the brush ({}) and a colour on the right, and paint. Alt and the left button \
               pick a colour from the surface.",
        by_hand: "Choose the brush and a colour, point at the cuboid and pull the trigger. Pick in \
                  the options, or the A or X button, picks a colour from the surface.",
        actions: &[Action::Brush(BrushId::Paint)],
        is_done: |document, since| has_step(document, since, &["paintbrush"]),
        marker: None,
        commands: None,
    },
    GuideStep {
        title: "Recolour the ground",
        text: "Lift the limit ({}), choose the marker, put it around the ground and recolour the \
               voxels in it ({}).",
        by_hand: "Untick Limit tools to selection, choose the marker, put it around the ground and \
                  press Recolour in the options.",
        actions: &[Action::ToggleLimit, Action::DyeMarker],
        is_done: |document, since| has_step(document, since, &["dye marker"]),
        marker: Some(lower_half),
        commands: None,
    },
];

/// Returns the upper half of the box with which the sculpture began, in grid coordinates.
fn upper_half(document: &Document) -> VoxelBox {
    let home = document.contents().frame.home.as_ivec3();
    let upper = VoxelBox { min: IVec3::new(0, home.y / 2, 0), max: home };
    upper.shifted(-document.origin())
}

fn lower_half(document: &Document) -> VoxelBox {
    let home = document.contents().frame.home.as_ivec3();
    let lower = VoxelBox { min: IVec3::ZERO, max: IVec3::new(home.x, home.y / 2, home.z) };
    lower.shifted(-document.origin())
}

/// Returns whether the history has a step with each of these labels since it had the length `since`.
fn has_step(document: &Document, since: u64, labels: &[&str]) -> bool {
    let history = document.history();
    let skipped = since.saturating_sub(history.dropped()) as usize;
    labels.iter().all(|label| history.undo_labels().skip(skipped).any(|done| done == *label))
}

/// Counts the steps that have not been undone, including forgotten ones.
fn length(document: &Document) -> u64 {
    let history = document.history();
    history.dropped() + history.undo_count() as u64
}

impl Guide {
    /// Ticks off the present step if it is done. Later steps wait for their turn.
    fn follow(&mut self, document: &Document) {
        while let Some(at) = self.step() {
            let now = length(document);
            let since = self.since.map_or(now, |since| since.min(now));
            self.since = Some(since);
            if !(STEPS[at].is_done)(document, since) {
                return;
            }
            self.finish(at);
        }
    }

    /// Continues with the next step.
    fn finish(&mut self, at: usize) {
        self.done[at] = true;
        self.since = None;
    }

    fn start_again(&mut self) {
        *self = Guide { open: self.open, ..Guide::default() };
    }

    /// Returns the present step; `None` when all are done.
    fn step(&self) -> Option<usize> {
        self.done.iter().position(|done| !done)
    }
}

/// Shows the guide in a strip below the picture, where it covers no part of the sculpture.
pub fn strip(root: &mut Ui, guide: &mut Guide, context: &UiContext, requests: &mut Vec<UiRequest>) {
    if !guide.open {
        return;
    }
    guide.follow(context.document);
    let frame = Frame::side_top_panel(root.style()).inner_margin(Margin::symmetric(10, 6));
    Panel::bottom("first steps").frame(frame).resizable(false).show(root, |ui| {
        let step = guide.step();
        ui.horizontal(|ui| {
            ui.strong("First steps");
            overview(ui, guide);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let close = ui.button("✖").on_hover_text(REOPENED);
                guide.open &= !close.clicked();
                again(ui, guide);
                if let Some(at) = step {
                    navigation_buttons(ui, guide, context, requests, at);
                }
            });
        });
        ui.scope(|ui| {
            // The picture keeps its size in all steps.
            let all = (0..STEPS.len()).map(|at| height(ui, &wording(context, at)));
            ui.set_min_height(all.fold(0.0, f32::max));
            match step {
                Some(at) => say(ui, context, at),
                None => drop(ui.label(DONE)),
            }
        });
    });
}

/// Shows the guide as a window.
impl Dialog for Guide {
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
        if !self.open {
            return;
        }
        self.follow(context.document);
        let mut open = true;
        Window::new("First steps")
            .open(&mut open)
            .resizable(false)
            .default_width(WIDTH)
            .default_pos(pos2(theme::TOOLBOX_WIDTH + 24.0, 44.0))
            .show(root.ctx(), |ui| {
                ui.set_width(WIDTH);
                overview(ui, self);
                match self.step() {
                    Some(at) => {
                        say(ui, context, at);
                        ui.horizontal(|ui| {
                            navigation_buttons(ui, self, context, requests, at);
                            again(ui, self);
                        });
                    }
                    None => {
                        ui.label(DONE);
                        ui.horizontal(|ui| {
                            again(ui, self);
                            let close = ui.button("Close").on_hover_text(REOPENED);
                            self.open &= !close.clicked();
                        });
                    }
                }
            });
        self.open &= open;
    }
}

/// Shows a row with the number of each step, small enough to leave room for the sculpture.
fn overview(ui: &mut Ui, guide: &Guide) {
    let at = guide.step();
    ui.horizontal(|ui| {
        for (i, step) in STEPS.iter().enumerate() {
            let mut text = RichText::new(match guide.done[i] {
                true => "✔".to_string(),
                false => (i + 1).to_string(),
            });
            text = if at == Some(i) { text.strong().underline() } else { text.weak() };
            ui.label(text).on_hover_text(step.title);
            ui.add_space(8.0);
        }
    });
}

fn again(ui: &mut Ui, guide: &mut Guide) {
    if ui.button("Start again").on_hover_text("Go back to the first step").clicked() {
        guide.start_again();
    }
}

/// Returns the instructions of a step, one text per paragraph.
fn wording(context: &UiContext, at: usize) -> Vec<RichText> {
    let step = &STEPS[at];
    let text = if context.in_headset { step.by_hand.to_string() } else { with_keys(step, context) };
    let mut texts =
        vec![RichText::new(format!("{}. {}", at + 1, step.title)).strong(), RichText::new(text)];
    if let Some(marker) = step.marker {
        let marker = marker(context.document).shifted(context.document.origin());
        let (from, size) = (marker.min, marker.size());
        let numbers = format!(
            "In numbers: from {}, {}, {}; size {}, {}, {}.",
            from.x, from.y, from.z, size.x, size.y, size.z
        );
        texts.push(RichText::new(numbers).weak());
    }
    texts
}

/// Shows the instructions of the present step.
fn say(ui: &mut Ui, context: &UiContext, at: usize) {
    wording(context, at).into_iter().for_each(|text| drop(ui.label(text)));
}

/// Returns the height of these paragraphs in points, stacked.
fn height(ui: &Ui, texts: &[RichText]) -> f32 {
    let width = ui.available_width();
    let lines = texts.iter().map(|text| {
        let text = WidgetText::from(text.clone());
        text.into_galley(ui, Some(TextWrapMode::Wrap), width, TextStyle::Body).size().y
    });
    lines.sum::<f32>() + ui.spacing().item_spacing.y * (texts.len().max(1) - 1) as f32
}

/// Shows buttons that go on without the task.
fn navigation_buttons(
    ui: &mut Ui,
    guide: &mut Guide,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
    at: usize,
) {
    if let Some(commands) = STEPS[at].commands
        && ui.button("Do it for me").clicked()
    {
        requests.extend(commands(context.document).into_iter().map(UiRequest::Run));
    }
    if ui.button("Skip").on_hover_text("Continue with the next step").clicked() {
        guide.finish(at);
    }
}

/// Returns the text of a step with the keys of the present table.
fn with_keys(step: &GuideStep, context: &UiContext) -> String {
    let mut text = String::new();
    let mut actions = step.actions.iter();
    for (i, part) in step.text.split("{}").enumerate() {
        if i > 0 {
            let keys = actions.next().and_then(|action| {
                context.bindings().and_then(|bindings| bindings.shortcut(*action))
            });
            text.push_str(keys.as_deref().unwrap_or("no key"));
        }
        text.push_str(part);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::NewSculpture;
    use crate::document::Limits;
    use crate::sculpture::{ColourDepth, Rgb};

    #[test]
    fn every_step_names_as_many_actions_as_its_text_has_gaps() {
        for step in &STEPS {
            assert_eq!(step.text.matches("{}").count(), step.actions.len(), "{}", step.title);
        }
    }

    #[test]
    fn in_a_headset_there_is_no_word_of_mouse_and_keys() {
        for step in &STEPS {
            let words = step.by_hand.to_lowercase();
            let words: Vec<&str> = words.split(|c: char| !c.is_alphanumeric()).collect();
            for word in ["mouse", "ctrl", "shift", "alt", "key", "keys", "left", "drag", "click"] {
                assert!(!words.contains(&word), "{}: {word}", step.title);
            }
            assert!(!step.by_hand.contains("{}"), "{}", step.title);
        }
    }

    #[test]
    fn the_learning_task_ticks_off_every_step_in_turn() {
        let new = NewSculpture {
            dims: glam::UVec3::splat(32),
            voxel_size: glam::Vec3::ONE,
            colour_depth: ColourDepth::Bits24,
            base: Rgb::STONE,
            solid: true,
            room_vx: 0,
            grows: false,
        };
        let mut document = Document::new(&new, Limits::default()).unwrap();
        let mut guide = Guide::default();
        guide.follow(&document);
        assert_eq!(guide.step(), Some(0));
        for (at, step) in STEPS[..2].iter().enumerate() {
            for command in step.commands.unwrap()(&document) {
                document.apply(&command).unwrap();
            }
            guide.follow(&document);
            assert_eq!(guide.step(), Some(at + 1));
        }
        let ray = "eye=16,90,16 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=4";
        for (line, step) in [
            ("add cuboid at=16,20,16 half=6,4,6 colour=#ff0000".to_string(), 3),
            (format!("spray devourer {ray}"), 3),
            (format!("spray growth {ray} threshold=8 colour=#ff0000"), 4),
            (format!("spray erosion {ray} threshold=20"), 5),
            (format!("spray paintbrush {ray} colour=#00ff00"), 6),
            ("limit off".to_string(), 6),
            ("dye marker colour=#00ff00".to_string(), 7),
        ] {
            document.apply(&line.parse().unwrap()).unwrap();
            guide.follow(&document);
            assert_eq!(guide.step().unwrap_or(STEPS.len()), step, "{line}");
        }
        document.apply(&Command::Undo { steps: None }).unwrap();
        guide.follow(&document);
        assert_eq!(guide.step(), None, "what was done stays done");

        document.apply(&Command::Redo { steps: None }).unwrap();
        guide.start_again();
        document.apply(&"limit on".parse().unwrap()).unwrap();
        guide.follow(&document);
        assert_eq!(guide.step(), Some(2), "the cuboid of the first time does not count");
        document.apply(&Command::Undo { steps: Some(3) }).unwrap();
        guide.follow(&document);
        let cuboid = "add cuboid at=10,20,16 half=4,4,4 colour=#ff0000";
        document.apply(&cuboid.parse().unwrap()).unwrap();
        guide.follow(&document);
        assert_eq!(guide.step(), Some(3), "one made after something was undone does");
    }
}
