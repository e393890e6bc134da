//! Numbers as people write them: in number fields, a decimal comma counts as a point, and thousands may be grouped.
//!
//! Takes the events of a pass before any widget sees them, and the text of a field when it is left. Text fields are
//! marked ([`words`]) and keep their commas. Must not know what a number means.

use std::ops::Range;

use egui::output::OutputEvent;
use egui::text_edit::TextEditState;
use egui::{Context, Event, Id, ImeEvent, Key, Modifiers, Response, WidgetType};

/// In egui's memory: the field is for text.
#[derive(Clone, Copy)]
struct Words;

/// Marks a text field, in which a comma stays a comma.
pub fn words(field: &Response) {
    field.ctx.data_mut(|data| data.insert_temp(field.id, Words));
}

/// The text in the focused field, in egui's memory.
#[derive(Clone)]
struct Written {
    field: Id,
    text: String,
}

/// The text typed into a number field, and the text that the field shows for it, in egui's memory.
#[derive(Clone, PartialEq, Debug)]
struct Typed {
    field: Id,
    /// As typed, with all signs.
    raw: String,
    /// In normal form, if it can be read.
    shown: String,
    /// The selected part of `shown`, in characters; empty where the cursor is.
    selected: Range<usize>,
}

/// How typed text changes a field.
#[derive(PartialEq, Debug)]
enum Edit {
    /// Replaces the selection.
    Insert(String),
    /// Replaces all text.
    Replace(String),
}

/// Rewrites text typed into a number field in normal form. Called before widgets are shown.
pub fn hear(ctx: &Context) {
    let field = ctx.memory(|memory| memory.focused()).filter(|_| ctx.text_edit_focused());
    let Some(field) = field.filter(|field| ctx.data(|d| d.get_temp::<Words>(*field)).is_none())
    else {
        return;
    };
    let mut typed = typed(ctx, field);
    let mut is_typed = false;
    ctx.input_mut(|input| {
        for event in std::mem::take(&mut input.events) {
            match event {
                Event::Text(text) => input.events.extend(typed.hear(&text, Event::Text)),
                Event::Paste(text) => input.events.extend(typed.hear(&text, Event::Paste)),
                Event::Ime(ImeEvent::Commit(text)) => {
                    let commit = |text| Event::Ime(ImeEvent::Commit(text));
                    input.events.extend(typed.hear(&text, commit));
                }
                other => {
                    if let Event::Key { key, pressed: true, modifiers, .. } = &other {
                        typed.press(*key, *modifiers);
                    }
                    input.events.push(other);
                    continue;
                }
            }
            is_typed = true;
        }
    });
    if is_typed {
        ctx.data_mut(|data| data.insert_temp(Id::NULL, typed));
    }
}

/// Records the text of the focused field. Called after widgets are shown. Returns a message if a field was left with an
/// invalid number.
pub fn see(ctx: &Context) -> Option<String> {
    let text = |event: &OutputEvent| match event {
        OutputEvent::ValueChanged(info)
        | OutputEvent::FocusGained(info)
        | OutputEvent::TextSelectionChanged(info)
            if info.typ == WidgetType::TextEdit =>
        {
            info.current_text_value.clone()
        }
        _ => None,
    };
    let text = ctx.output(|output| output.events.iter().filter_map(text).next_back());
    let focused = ctx.memory(|memory| memory.focused());
    let typed = ctx.data(|data| data.get_temp::<Typed>(Id::NULL));
    // A field may be left in the very pass of the typing.
    let field = focused.or(typed.as_ref().map(|typed| typed.field));
    if let Some((text, field)) = text.zip(field) {
        ctx.data_mut(|data| data.insert_temp(Id::NULL, Written { field, text }));
    }
    let written = ctx.data(|data| data.get_temp::<Written>(Id::NULL));
    if written.as_ref().is_some_and(|written| focused != Some(written.field)) {
        // The field may have other contents when it gets the focus again.
        ctx.data_mut(|data| data.remove::<Written>(Id::NULL));
    }
    let left = typed.filter(|typed| focused != Some(typed.field))?;
    ctx.data_mut(|data| data.remove::<Typed>(Id::NULL));
    let written = written.filter(|written| written.field == left.field);
    let shown = written.map_or(left.shown, |written| written.text);
    let is_given_up = ctx.input(|input| input.key_pressed(Key::Escape));
    let is_number = shown.trim().is_empty() || plain(&shown).is_some();
    (!is_given_up && !is_number).then(|| {
        format!(
            "\"{shown}\" is not a number: the field keeps its last valid value. Use a comma or a point as the \
             decimal sign; group thousands with the other sign, or not at all"
        )
    })
}

/// Returns the text of the field before the events of this pass.
fn typed(ctx: &Context, field: Id) -> Typed {
    let written = ctx.data(|data| data.get_temp::<Written>(Id::NULL));
    let shown = written.filter(|written| written.field == field).map(|written| written.text);
    let shown = shown.unwrap_or_default();
    let selected = TextEditState::load(ctx, field).and_then(|state| state.cursor.char_range());
    let [from, to] = selected.map_or([0; 2], |range| range.sorted_cursors().map(|c| c.index.0));
    let before = ctx.data(|data| data.get_temp::<Typed>(Id::NULL));
    let raw = before.filter(|typed| typed.field == field && typed.shown == shown);
    let raw = raw.map_or_else(|| shown.clone(), |typed| typed.raw);
    Typed { field, raw, shown, selected: from..to }
}

fn select_all() -> Event {
    Event::Key {
        key: Key::A,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::COMMAND,
    }
}

impl Typed {
    /// Handles typed text. Returns the events that write it into the field.
    fn hear(&mut self, text: &str, event: impl Fn(String) -> Event) -> Vec<Event> {
        match self.write(text) {
            Edit::Insert(text) => vec![event(text)],
            // An input method must end its composition.
            Edit::Replace(text) => vec![event(String::new()), select_all(), Event::Text(text)],
        }
    }

    /// Handles typed text.
    fn write(&mut self, text: &str) -> Edit {
        let length = self.shown.chars().count();
        let Range { start, end } = self.selected;
        let text = text.replace(['\r', '\n'], "");
        let inserted = |text: &str| {
            let before = self.shown.chars().take(start);
            before.chain(text.chars()).chain(self.shown.chars().skip(end)).collect::<String>()
        };
        self.raw = match start == length {
            true => format!("{}{text}", self.raw),
            false => inserted(&text),
        };
        let shown = plain(&self.raw).unwrap_or_else(|| self.raw.clone());
        let texts = [text.clone(), text.replace(',', ".")];
        let inserted_text = texts.into_iter().find(|text| inserted(text) == shown);
        let cursor = match &inserted_text {
            Some(text) => start + text.chars().count(),
            None => shown.chars().count(),
        };
        self.selected = cursor..cursor;
        self.shown = shown;
        inserted_text.map_or_else(|| Edit::Replace(self.shown.clone()), Edit::Insert)
    }

    /// Handles a key that changes the selection or the text between two typing events of a pass.
    fn press(&mut self, key: Key, modifiers: Modifiers) {
        let length = self.shown.chars().count();
        match key {
            Key::A if modifiers.command => self.selected = 0..length,
            Key::End => self.selected = length..length,
            Key::Home => self.selected = 0..0,
            Key::Backspace => {
                let Range { start, end } = self.selected;
                let from = if start == end { start.saturating_sub(1) } else { start };
                let kept = self.shown.chars().take(from).chain(self.shown.chars().skip(end));
                self.shown = kept.collect();
                self.raw = self.shown.clone();
                self.selected = from..from;
            }
            _ => {}
        }
    }
}

/// Returns a number with a decimal point and without grouping; `None` if it is invalid or ambiguous. Keeps the unit
/// that fields show after their numbers.
///
/// A single sign is decimal. Of a comma and a point, the last one is decimal and the other one groups thousands. A sign
/// that occurs several times groups thousands, too. A group has three digits.
fn plain(text: &str) -> Option<String> {
    let number = text.trim_end_matches(|c: char| c.is_whitespace() || "%°".contains(c));
    let unit = &text[number.len()..];
    let number = number.replace('\u{2212}', "-").replace(char::is_whitespace, "");
    let is_sign = |c: char| c == ',' || c == '.';
    let last = number.rfind(is_sign).unwrap_or(number.len());
    let (whole, rest) = number.split_at(last);
    let (sign, digits) = rest.split_at(rest.len().min(1));
    let read = match (whole.contains(is_sign), whole.contains(sign) && !sign.is_empty()) {
        (false, _) => format!("{whole}{}{digits}", sign.replace(',', ".")),
        (true, false) => format!("{}.{digits}", joined(whole)?),
        (true, true) => joined(&number)?,
    };
    let is_finite = read.parse::<f64>().is_ok_and(f64::is_finite);
    is_finite.then(|| format!("{read}{unit}"))
}

/// Returns a whole number without its grouping signs, which must be equal.
fn joined(number: &str) -> Option<String> {
    let digits = number.trim_start_matches(['-', '+']);
    let sign = digits.chars().find(|c| !c.is_ascii_digit())?;
    let mut groups = digits.split(sign);
    let is_whole = |group: &str| group.chars().all(|c| c.is_ascii_digit());
    let begins =
        groups.next().is_some_and(|first| is_whole(first) && (1..=3).contains(&first.len()));
    let goes_on = groups.all(|group| is_whole(group) && group.len() == 3);
    (begins && goes_on).then(|| number.replace(sign, ""))
}

#[cfg(test)]
mod tests {
    use super::{Edit, Id, Key, Modifiers, Typed, plain};

    #[test]
    fn a_number_is_read_in_the_only_way_or_not_at_all() {
        for (typed, read) in [
            ("12,5", Some("12.5")),
            ("-0.25", Some("-0.25")),
            ("\u{2212}0,25", Some("-0.25")),
            (",5", Some(".5")),
            ("1.234,5", Some("1234.5")),
            ("1,234.5", Some("1234.5")),
            ("-12.345.678,9", Some("-12345678.9")),
            ("1,234,567", Some("1234567")),
            ("1.234.567", Some("1234567")),
            ("1 234,5", Some("1234.5")),
            ("1.234,", Some("1234.")),
            ("1,234", Some("1.234")),
            ("12", Some("12")),
            ("50,5 %", Some("50.5 %")),
            ("-7,5°", Some("-7.5°")),
            ("2.5e3", Some("2.5e3")),
            ("", None),
            ("-", None),
            (",", None),
            ("12,5 mm", None),
            ("1.2,5", None),
            ("1.23,5", None),
            ("1234.567,5", None),
            (".234,5", None),
            ("1,234,5", None),
            ("1.2.3", None),
            ("1,234.567,8", None),
            ("1.234,5.6", None),
            ("1..5", None),
            ("inf", None),
            ("1e999", None),
        ] {
            assert_eq!(plain(typed).as_deref(), read, "{typed}");
        }
    }

    fn empty() -> Typed {
        Typed { field: Id::NULL, raw: String::new(), shown: String::new(), selected: 0..0 }
    }

    /// Returns the field's text after each typed character.
    fn shown(text: &str) -> Vec<String> {
        let mut typed = empty();
        let mut field = String::new();
        let step = |c: char| {
            match typed.write(&c.to_string()) {
                Edit::Insert(text) => field.push_str(&text),
                Edit::Replace(text) => field = text,
            }
            assert_eq!(field, typed.shown);
            field.clone()
        };
        text.chars().map(step).collect()
    }

    #[test]
    fn signs_are_read_as_they_are_typed() {
        assert_eq!(shown("12,5"), ["1", "12", "12.", "12.5"]);
        assert_eq!(shown("1.234,5")[4..], ["1.234", "1234.", "1234.5"]);
        assert_eq!(shown("1,234.5")[4..], ["1.234", "1234.", "1234.5"]);
        assert_eq!(shown("1.234.567,8")[8..], ["1234567", "1234567.", "1234567.8"]);
        assert_eq!(shown("1.5,3")[3..], ["1.5,", "1.5,3"]);
        assert_eq!(shown("1.234,5.")[7..], ["1.234,5."], "nothing is cut");
    }

    #[test]
    fn typing_replaces_a_selection_and_backspace_removes_a_digit() {
        let mut typed = empty();
        typed.write("1.234,5");
        assert_eq!(typed.shown, "1234.5");
        typed.press(Key::Backspace, Modifiers::NONE);
        assert_eq!(typed.write("75"), Edit::Insert("75".to_string()));
        assert_eq!(typed.shown, "1234.75");
        typed.press(Key::Home, Modifiers::NONE);
        assert_eq!(typed.write("-"), Edit::Insert("-".to_string()));
        assert_eq!(typed.shown, "-1234.75");
        typed.press(Key::A, Modifiers::COMMAND);
        assert_eq!(typed.write("2,5"), Edit::Insert("2.5".to_string()));
        assert_eq!(typed.shown, "2.5");
    }
}
