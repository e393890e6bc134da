//! The palette: a field and a list of every action, of features with other names elsewhere, and of every script
//! command. Typed words filter the list; a typed command can be run.
//!
//! A single word is matched to names of actions first: commands come after all matching actions.

use egui::text::{CCursor, CCursorRange};
use egui::{Align2, Button, Id, Key, Modal, Modifiers, RichText, ScrollArea, TextEdit, Ui};
use egui::{WidgetInfo, WidgetType, vec2};

use glam::IVec3;

use crate::command::{COMMANDS, Command, CommandHelp};
use crate::input::action::TriggerKind;
use crate::input::{Action, Bindings};
use crate::ui::dialogs::elsewhere::{ELSEWHERE, Elsewhere, SearchTarget};
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::filter::Filter;
use crate::ui::widgets::spot::Spot;
use crate::ui::widgets::{numbers, theme};

const WIDTH: f32 = 560.0;
const HEIGHT: f32 = 380.0;
/// Distance from the top of the window, in points.
const TOP: f32 = 60.0;

/// Added to the ranks of commands for a single word: they follow everything that begins with the word or has it as a
/// name.
const AFTER_WORDS: u32 = 5;

/// The typed text, and the chosen entry.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct CommandPalette {
    pub open: bool,
    text: String,
    chosen: usize,
    /// The cursor must go to the end of the text, which was changed outside the field.
    completed: bool,
}

impl CommandPalette {
    /// Opens it, empty.
    pub fn open(&mut self) {
        *self = CommandPalette { open: true, ..CommandPalette::default() };
    }
}

/// A line of the list.
#[derive(Clone, PartialEq, Debug)]
enum PaletteEntry {
    /// The typed text is this command.
    Run(Box<Command>),
    Do(Action),
    /// A feature with another name here, or missing here.
    See(&'static Elsewhere),
    /// A command whose arguments still have to be typed.
    Complete(&'static CommandHelp),
}

impl PaletteEntry {
    /// Returns whether it can be chosen here: drags and the wheel need a hand on the mouse.
    fn can_be_chosen(&self) -> bool {
        !matches!(self, PaletteEntry::Do(action) if action.help().kind != TriggerKind::Tap)
    }
}

/// Returns the entries for `typed`, and its error as a command.
fn entries(typed: &str, bindings: Option<&Bindings>) -> (Vec<PaletteEntry>, Option<String>) {
    let typed = typed.trim();
    let verb = typed.split_whitespace().next().unwrap_or_default();
    let is_command = COMMANDS.iter().any(|command| command.verb == verb);
    // A single verb may be a search word, so it is no error that it is incomplete.
    let alone = typed == verb;
    let (mut run, mut error) = (None, None);
    if is_command {
        match typed.parse::<Command>() {
            Ok(command) => run = Some(PaletteEntry::Run(Box::new(command))),
            Err(_) if alone => {}
            Err(reason) => error = Some(reason.to_string()),
        }
    }
    let filter = Filter::new(typed);
    // With nothing typed, everything is listed in order, actions of the mouse last.
    const LAST: u32 = u32::MAX;
    let mut ranked = Vec::new();
    // An empty search leads to none of these.
    let elsewhere = ELSEWHERE.iter().filter(|_| !filter.is_empty());
    ranked.extend(elsewhere.filter_map(|it| Some((it.rank(&filter)?, PaletteEntry::See(it)))));
    for &action in Action::ALL {
        let help = action.help();
        let triggers: Vec<String> =
            bindings.into_iter().flat_map(|b| b.triggers(action)).map(|t| t.to_string()).collect();
        let keys: Vec<&str> = triggers.iter().map(String::as_str).collect();
        if let Some(rank) = filter.rank(help.text, &[help.name, help.synonyms], &keys) {
            let entry = PaletteEntry::Do(action);
            let last = filter.is_empty() && !entry.can_be_chosen();
            ranked.push((if last { LAST } else { rank }, entry));
        }
    }
    for command in COMMANDS.iter() {
        // Among equals the action comes first, since it needs no arguments. A text of a verb and arguments is that
        // command.
        let rank = filter.rank(command.verb, &[&command.usage, &command.tooltip], &[]);
        let rank = if command.verb == verb && !alone { Some(0) } else { rank };
        let after = if alone { AFTER_WORDS } else { 1 };
        let after = if filter.is_empty() { 0 } else { after };
        ranked.extend(rank.map(|rank| (rank + after, PaletteEntry::Complete(command))));
    }
    ranked.sort_by_key(|(rank, _)| *rank);
    if let Some(run) = run {
        let at = ranked.iter().take_while(|(rank, _)| alone && *rank < AFTER_WORDS).count();
        ranked.insert(at, (0, run));
    }
    (ranked.into_iter().map(|(_, entry)| entry).collect(), error)
}

/// Returns the command whose verb is typed, followed by a space only.
fn begun(typed: &str) -> Option<&'static CommandHelp> {
    let verb = typed.strip_suffix(' ')?;
    COMMANDS.iter().find(|command| command.verb == verb && !command.usage.is_empty())
}

fn triggers_of(action: Action, bindings: Option<&Bindings>) -> String {
    let triggers = bindings.into_iter().flat_map(|b| b.triggers(action));
    triggers.map(|trigger| trigger.to_string()).collect::<Vec<_>>().join(", ")
}

impl Dialog for CommandPalette {
    fn is_open(&self) -> bool {
        self.open
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        if !self.open {
            return;
        }
        let bindings = shared.context.bindings();
        let room = root.ctx().content_rect();
        let area =
            Modal::default_area(Id::new("palette")).anchor(Align2::CENTER_TOP, vec2(0.0, TOP));
        let response = Modal::new(Id::new("palette")).area(area).show(root.ctx(), |ui| {
            ui.set_width(WIDTH.min(room.width() - 60.0));
            let keys = Keys::take(ui);
            field(ui, self);
            let (list, error) = entries(&self.text, bindings);
            if let Some(error) = error {
                ui.colored_label(theme::error_colour(ui.visuals()), error);
            } else if let Some(command) = begun(&self.text) {
                ui.weak(format!("{} {}", command.verb, command.usage));
            }
            let moved = self.go(&list, keys.by);
            let mut chosen = keys.enter.then(|| list.get(self.chosen)).flatten();
            let height = (room.height() - TOP - 130.0).min(HEIGHT);
            ScrollArea::vertical().max_height(height).auto_shrink([false, true]).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 1.0;
                for (i, entry) in list.iter().enumerate() {
                    let response = row(ui, entry, i == self.chosen, bindings);
                    if moved && i == self.chosen {
                        response.scroll_to_me(None);
                    }
                    if response.clicked() {
                        chosen = Some(entry);
                    }
                }
                if list.is_empty() {
                    ui.weak("No matches.");
                }
            });
            if let Some(entry) = chosen.filter(|entry| entry.can_be_chosen()) {
                let entry = in_grid(entry, shared.context.document.origin());
                shared.led_to = self.choose(&entry, shared.requests);
            }
        });
        if response.should_close() {
            self.open = false;
        }
    }
}

/// Keys that go to the list, not to the field.
struct Keys {
    /// Entries to move down.
    by: isize,
    enter: bool,
}

impl Keys {
    fn take(ui: &Ui) -> Keys {
        ui.input_mut(|input| {
            let mut pressed = |key| input.count_and_consume_key(Modifiers::NONE, key) as isize;
            Keys {
                by: pressed(Key::ArrowDown) - pressed(Key::ArrowUp)
                    + 8 * (pressed(Key::PageDown) - pressed(Key::PageUp)),
                enter: pressed(Key::Enter) > 0,
            }
        })
    }
}

impl CommandPalette {
    /// Moves the choice by so many selectable entries. Returns true if it has changed.
    fn go(&mut self, list: &[PaletteEntry], by: isize) -> bool {
        let can: Vec<usize> = (0..list.len()).filter(|i| list[*i].can_be_chosen()).collect();
        let before = self.chosen;
        let now = can.iter().position(|i| *i >= before).unwrap_or(can.len().saturating_sub(1));
        let next = now.saturating_add_signed(by).min(can.len().saturating_sub(1));
        self.chosen = can.get(next).copied().unwrap_or(0);
        self.chosen != before
    }

    /// Requests the chosen entry. Returns the option to show, if it leads to one.
    fn choose(&mut self, entry: &PaletteEntry, requests: &mut Vec<UiRequest>) -> Option<Spot> {
        let mut led_to = None;
        match entry {
            PaletteEntry::Run(command) => requests.push(UiRequest::Run((**command).clone())),
            PaletteEntry::Do(action) => requests.push(UiRequest::Do(*action)),
            PaletteEntry::See(Elsewhere { target: SearchTarget::Do(action), .. }) => {
                requests.push(UiRequest::Do(*action));
            }
            PaletteEntry::See(Elsewhere { target: SearchTarget::Option(spot), .. }) => {
                requests.extend(spot.needs().map(UiRequest::Do));
                led_to = Some(*spot);
            }
            PaletteEntry::Complete(command) => {
                // Keeps arguments already typed after the verb.
                let typed = self.text.split_whitespace().collect::<Vec<_>>();
                if typed.first() != Some(&command.verb) || typed.len() == 1 {
                    self.text = format!("{} ", command.verb);
                    self.completed = true;
                    self.chosen = 0;
                }
                return None;
            }
        }
        self.open = false;
        led_to
    }
}

/// Returns the entry with a typed command in grid coordinates, as all requests have them.
fn in_grid(entry: &PaletteEntry, origin: IVec3) -> PaletteEntry {
    match entry {
        PaletteEntry::Run(command) => {
            PaletteEntry::Run(Box::new(command.translated(-origin).into_owned()))
        }
        other => other.clone(),
    }
}

fn field(ui: &mut Ui, palette: &mut CommandPalette) {
    let mut output = TextEdit::singleline(&mut palette.text)
        .hint_text("Search actions, or type a script command")
        .desired_width(f32::INFINITY)
        .show(ui);
    let response = &output.response.response;
    numbers::words(response);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::TextEdit, true, "Command"));
    // Requesting focus again would interrupt an input method in every frame.
    if !response.has_focus() {
        response.request_focus();
    }
    if response.changed() {
        palette.chosen = 0;
    }
    if std::mem::take(&mut palette.completed) {
        let end = CCursor::new(palette.text.chars().count());
        output.state.cursor.set_char_range(Some(CCursorRange::one(end)));
        output.state.store(ui.ctx(), response.id);
    }
}

fn row(
    ui: &mut Ui,
    entry: &PaletteEntry,
    chosen: bool,
    bindings: Option<&Bindings>,
) -> egui::Response {
    let (text, right, tip) = match entry {
        PaletteEntry::Run(command) => (
            RichText::new(format!("Run {command}")).strong(),
            "Enter".to_string(),
            "Run the command as typed".to_string(),
        ),
        PaletteEntry::Do(action) => {
            let (help, triggers) = (action.help(), triggers_of(*action, bindings));
            let how = match help.kind {
                TriggerKind::Tap => "",
                TriggerKind::Hold => " (hold)",
                TriggerKind::Drag => " (drag)",
                TriggerKind::Wheel => " (turn)",
            };
            let tip = match help.kind {
                TriggerKind::Tap => help.text.to_string(),
                _ => format!(
                    "{}: use the mouse or hold the key; it cannot be started from here",
                    help.text
                ),
            };
            (RichText::new(help.text), format!("{triggers}{how}"), tip)
        }
        PaletteEntry::See(it) => {
            let (right, what) = match it.target {
                SearchTarget::Do(action) => (triggers_of(action, bindings), action.help().text),
                SearchTarget::Option(_) => {
                    ("option".to_string(), "Opens the panel and shows the option")
                }
            };
            (RichText::new(it.text), right, format!("{}\n{what}", it.text))
        }
        PaletteEntry::Complete(command) => (
            RichText::new(format!("{} {}", command.verb, command.usage)).monospace(),
            "script command".to_string(),
            format!("{}\n{} {}", command.tooltip, command.verb, command.usage),
        ),
    };
    let size = vec2(ui.available_width(), 0.0);
    let button = Button::selectable(chosen, text)
        .frame_when_inactive(chosen)
        .right_text(RichText::new(right).weak())
        .min_size(size)
        .truncate();
    ui.add_enabled(entry.can_be_chosen(), button).on_hover_text(&tip).on_disabled_hover_text(tip)
}

#[cfg(test)]
#[path = "palette_tests.rs"]
mod tests;
