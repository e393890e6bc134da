//! Numbers as people write them: in fields for numbers a decimal comma counts like a point.
//!
//! Takes the events of a pass before any widget hears them. Fields for words say that they are such ([`words`]) and keep
//! their commas. Must not know what a number means.

use egui::output::OutputEvent;
use egui::text_edit::TextEditState;
use egui::{Context, Event, Id, ImeEvent, Response, WidgetType};

/// In egui's memory: the field is for words.
#[derive(Clone, Copy)]
struct Words;

/// Says that a field is for words, in which a comma is one.
pub fn words(field: &Response) {
    field.ctx.data_mut(|data| data.insert_temp(field.id, Words));
}

/// Writes what is typed into a field for a number as numbers are read. To be called before widgets are shown. Returns
/// what is to be said where a second decimal sign was typed, which is left out.
pub fn hear(ctx: &Context) -> Option<String> {
    let field = ctx.memory(|memory| memory.focused()).filter(|_| ctx.text_edit_focused())?;
    if ctx.data(|data| data.get_temp::<Words>(field)).is_some() {
        return None;
    }
    let mut kept = kept(ctx, field);
    let mut complaint = None;
    ctx.input_mut(|input| {
        for event in &mut input.events {
            if let Event::Text(text) | Event::Paste(text) | Event::Ime(ImeEvent::Commit(text)) =
                event
            {
                *text = decimal(text);
                if kept.contains('.') && text.contains('.') {
                    complaint = Some(format!(
                        "{kept} has a decimal sign already: a second one was left out. Write thousands without signs"
                    ));
                    text.retain(|c| c != '.');
                }
                kept.push_str(text);
            }
        }
    });
    complaint
}

/// The text in the field that has the focus, in egui's memory.
#[derive(Clone)]
struct Written {
    field: Id,
    text: String,
}

/// Notes what is written in the field that has the focus. To be called after widgets are shown.
pub fn see(ctx: &Context) {
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
    let field = ctx.memory(|memory| memory.focused());
    if let Some((text, field)) = text.zip(field) {
        ctx.data_mut(|data| data.insert_temp(Id::NULL, Written { field, text }));
    }
}

/// The text that stays in a field for a number when something is typed: all that is not selected there.
fn kept(ctx: &Context, field: Id) -> String {
    let written = ctx.data(|data| data.get_temp::<Written>(Id::NULL));
    let text = written.filter(|written| written.field == field).map(|written| written.text);
    let selected = TextEditState::load(ctx, field).and_then(|state| state.cursor.char_range());
    let [from, to] = selected.map_or([0; 2], |range| range.sorted_cursors().map(|c| c.index.0));
    let text = text.unwrap_or_default();
    text.chars().zip(0..).filter(|(_, i)| !(from..to).contains(i)).map(|(c, _)| c).collect()
}

/// The number with a decimal point and nothing between its thousands. Of a comma and a point, the last one is decimal;
/// what stands several times is between thousands.
fn decimal(text: &str) -> String {
    let last = text.rfind([',', '.']);
    let sign = last.and_then(|at| text[at..].chars().next());
    let is_decimal = sign.is_some_and(|sign| text.matches(sign).count() == 1);
    text.char_indices()
        .filter_map(|(at, c)| match c {
            ',' | '.' if Some(at) == last && is_decimal => Some('.'),
            ',' | '.' => None,
            other => Some(other),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::decimal;

    #[test]
    fn both_signs_are_decimal_and_thousands_are_joined() {
        for (typed, read) in [
            (",", "."),
            (".", "."),
            ("12,5", "12.5"),
            ("-0.25", "-0.25"),
            ("1.234,5", "1234.5"),
            ("1,234.5", "1234.5"),
            ("1,234,567", "1234567"),
            ("12", "12"),
            ("12,5 mm", "12.5 mm"),
        ] {
            assert_eq!(decimal(typed), read, "{typed}");
        }
    }
}
