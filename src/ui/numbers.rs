//! Numbers as people write them: in fields for numbers a decimal comma counts like a point.
//!
//! Takes the events of a pass before any widget hears them. Fields for words say that they are such ([`words`]) and keep
//! their commas. Must not know what a number means.

use egui::{Context, Event, ImeEvent, Response};

/// In egui's memory: the field is for words.
#[derive(Clone, Copy)]
struct Words;

/// Says that a field is for words, in which a comma is one.
pub fn words(field: &Response) {
    field.ctx.data_mut(|data| data.insert_temp(field.id, Words));
}

/// Writes what is typed into a field for a number as numbers are read. To be called before widgets are shown.
pub fn hear(ctx: &Context) {
    let field = ctx.memory(|memory| memory.focused()).filter(|_| ctx.text_edit_focused());
    let Some(field) = field else { return };
    if ctx.data(|data| data.get_temp::<Words>(field)).is_some() {
        return;
    }
    ctx.input_mut(|input| {
        for event in &mut input.events {
            if let Event::Text(text) | Event::Paste(text) | Event::Ime(ImeEvent::Commit(text)) =
                event
            {
                *text = decimal(text);
            }
        }
    });
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
