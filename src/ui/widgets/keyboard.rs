//! Owns an on-screen keyboard for people in a headset: its keys, their positions, and their effects.
//!
//! Takes the position of the field that wants text and the pointer; gives egui's keyboard events. It is no widget, so a
//! press on it takes the focus from no field. Must not know what the pointer is.

use egui::{Align2, Context, Event, FontId, Id, Key, LayerId, Modifiers, Order, Pos2, Rect};
use egui::{CornerRadius, Stroke, StrokeKind, Vec2, vec2};

/// Share of the board that the keyboard takes.
const SHARE: Vec2 = Vec2::new(0.86, 0.42);
/// Distance from the board's edge, and between keys, as shares of a key's height.
const MARGIN: f32 = 0.2;
const GAP: f32 = 0.1;
/// Width of a row, in keys.
const ROW_WIDTH: f32 = 12.0;
/// Seconds until a held key repeats, and between repetitions.
const REPEAT_AFTER_S: f64 = 0.5;
const REPEAT_EVERY_S: f64 = 0.08;

/// The character or function of a key.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Cap {
    /// Writes the first character, or with shift the second.
    Char(char, char),
    Space,
    Backspace,
    Enter,
    Left,
    Right,
    /// Shifts the next character; pressed again, all of them.
    Shift,
    /// Leaves the field.
    Close,
}

/// A key and its width in letter keys.
type KeyRow = &'static [(Cap, f32)];

const fn letter(small: char) -> (Cap, f32) {
    (Cap::Char(small, small.to_ascii_uppercase()), 1.0)
}

const fn sign(plain: char, shifted: char) -> (Cap, f32) {
    (Cap::Char(plain, shifted), 1.0)
}

static ROWS: [KeyRow; 5] = [
    &[
        sign('1', '!'),
        sign('2', '@'),
        sign('3', '#'),
        sign('4', '$'),
        sign('5', '%'),
        sign('6', '&'),
        sign('7', '*'),
        sign('8', '('),
        sign('9', ')'),
        sign('0', '='),
        (Cap::Backspace, 2.0),
    ],
    &[
        letter('q'),
        letter('w'),
        letter('e'),
        letter('r'),
        letter('t'),
        letter('y'),
        letter('u'),
        letter('i'),
        letter('o'),
        letter('p'),
        sign('-', '+'),
        sign('_', '~'),
    ],
    &[
        letter('a'),
        letter('s'),
        letter('d'),
        letter('f'),
        letter('g'),
        letter('h'),
        letter('j'),
        letter('k'),
        letter('l'),
        sign(':', ';'),
        (Cap::Enter, 2.0),
    ],
    &[
        (Cap::Shift, 2.0),
        letter('z'),
        letter('x'),
        letter('c'),
        letter('v'),
        letter('b'),
        letter('n'),
        letter('m'),
        sign('.', '?'),
        sign(',', '\''),
        sign('/', '\\'),
    ],
    &[(Cap::Close, 2.0), (Cap::Left, 1.0), (Cap::Space, 8.0), (Cap::Right, 1.0)],
];

/// The state of shift.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
enum Shift {
    #[default]
    Off,
    Once,
    Locked,
}

/// A keyboard that shows while a field wants text.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Keyboard {
    /// None while no field wants text.
    place: Option<Rect>,
    shift: Shift,
    pointed: Option<Cap>,
    /// The key that is down, and when it repeats, once that is known.
    held: Option<(Cap, Option<f64>)>,
}

impl Keyboard {
    /// Shows the keyboard for a field of `board`, clear of it where there is room, or hides it. Returns true if that
    /// changes the picture.
    pub fn follow(&mut self, field: Option<Rect>, board: Rect) -> bool {
        let place = field.map(|field| place(field, board));
        let changed = self.place != place;
        match place {
            None => *self = Keyboard::default(),
            Some(_) => self.place = place,
        }
        changed
    }

    /// Returns whether a point lies on the keyboard, including between keys.
    pub fn covers(&self, at: Pos2) -> bool {
        self.place.is_some_and(|place| place.contains(at))
    }

    /// Sets the pointer's position. Returns true if that changes the picture.
    pub fn point(&mut self, at: Option<Pos2>) -> bool {
        let pointed = at.and_then(|at| self.key_at(at));
        let before = std::mem::replace(&mut self.pointed, pointed);
        before != pointed
    }

    /// Presses the key under the pointer: adds its events. Leaves a field through `context`.
    pub fn press(&mut self, context: &Context, events: &mut Vec<Event>) {
        let Some(cap) = self.pointed else { return };
        self.held = Some((cap, None));
        self.write(cap, context, events);
    }

    pub fn release(&mut self) {
        self.held = None;
    }

    /// Repeats a held key when it is time.
    pub fn hold(&mut self, now_s: f64, context: &Context, events: &mut Vec<Event>) {
        let Some((cap, again_s)) = self.held else { return };
        if !matches!(cap, Cap::Backspace | Cap::Left | Cap::Right) {
            return;
        }
        match again_s {
            None => self.held = Some((cap, Some(now_s + REPEAT_AFTER_S))),
            Some(again_s) if now_s >= again_s => {
                self.held = Some((cap, Some(now_s + REPEAT_EVERY_S)));
                self.write(cap, context, events);
            }
            Some(_) => {}
        }
    }

    /// Returns when [`Keyboard::hold`] must be called.
    pub fn due_s(&self) -> Option<f64> {
        self.held.and_then(|(_, again_s)| again_s)
    }

    fn write(&mut self, cap: Cap, context: &Context, events: &mut Vec<Event>) {
        match cap {
            Cap::Char(plain, shifted) => {
                let char = if self.shift == Shift::Off { plain } else { shifted };
                events.push(Event::Text(char.to_string()));
                if self.shift == Shift::Once {
                    self.shift = Shift::Off;
                }
            }
            Cap::Space => events.push(Event::Text(" ".to_string())),
            Cap::Backspace => tap(Key::Backspace, events),
            Cap::Enter => tap(Key::Enter, events),
            Cap::Left => tap(Key::ArrowLeft, events),
            Cap::Right => tap(Key::ArrowRight, events),
            Cap::Shift => {
                self.shift = match self.shift {
                    Shift::Off => Shift::Once,
                    Shift::Once => Shift::Locked,
                    Shift::Locked => Shift::Off,
                }
            }
            // Escape would close the window of the field.
            Cap::Close => context.memory_mut(|memory| {
                if let Some(field) = memory.focused() {
                    memory.surrender_focus(field);
                }
            }),
        }
    }

    fn key_at(&self, at: Pos2) -> Option<Cap> {
        let (cap, _) = keys(self.place?).find(|(_, rect)| rect.contains(at))?;
        Some(cap)
    }

    /// Returns the area of a key while the keyboard is visible.
    pub fn key(&self, cap: Cap) -> Option<Rect> {
        let (_, rect) = keys(self.place?).find(|(other, _)| *other == cap)?;
        Some(rect)
    }

    /// Draws the keyboard over everything except the pointer.
    pub fn paint(&self, context: &Context) {
        let Some(place) = self.place else { return };
        let painter = context.layer_painter(LayerId::new(Order::Tooltip, Id::new("keyboard")));
        let style = context.global_style();
        let visuals = &style.visuals;
        let row = place.height() / ROWS.len() as f32;
        painter.rect(
            place,
            CornerRadius::same(8),
            visuals.window_fill,
            visuals.window_stroke,
            StrokeKind::Inside,
        );
        for (cap, rect) in keys(place) {
            let down = self.held.is_some_and(|(held, _)| held == cap);
            let look = if down {
                &visuals.widgets.active
            } else if self.pointed == Some(cap) {
                &visuals.widgets.hovered
            } else {
                &visuals.widgets.inactive
            };
            let lit = cap == Cap::Shift && self.shift != Shift::Off;
            let (fill, text) = match lit {
                true => (visuals.selection.bg_fill, visuals.selection.stroke.color),
                false => (look.weak_bg_fill, look.text_color()),
            };
            painter.rect(rect, look.corner_radius, fill, edge(look.bg_stroke), StrokeKind::Inside);
            let label = self.label(cap);
            let share = if label.chars().count() > 1 { 0.3 } else { 0.42 };
            let font = FontId::proportional(row * share);
            painter.text(rect.center(), Align2::CENTER_CENTER, label, font, text);
        }
    }

    fn label(&self, cap: Cap) -> String {
        match cap {
            Cap::Char(plain, shifted) => {
                let char = if self.shift == Shift::Off { plain } else { shifted };
                return char.to_string();
            }
            Cap::Space => "Space",
            Cap::Backspace => "Backspace",
            Cap::Enter => "Enter",
            Cap::Left => "◀",
            Cap::Right => "▶",
            Cap::Shift if self.shift == Shift::Locked => "Caps",
            Cap::Shift => "Shift",
            Cap::Close => "Close",
        }
        .to_string()
    }
}

/// Returns an edge that is visible on every fill.
fn edge(stroke: Stroke) -> Stroke {
    Stroke { width: stroke.width.max(1.0), ..stroke }
}

/// Adds a press and a release of an egui key.
fn tap(key: Key, events: &mut Vec<Event>) {
    events.extend([true, false].map(|pressed| Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    }));
}

/// Returns the keyboard's area: the lower part of the board, or the upper one if the field is below.
pub fn place(field: Rect, board: Rect) -> Rect {
    let size = board.size() * SHARE;
    let margin = MARGIN * size.y / ROWS.len() as f32;
    let left = board.center().x - size.x * 0.5;
    let at = |top: f32| Rect::from_min_size(Pos2::new(left, top), size);
    let (low, high) = (at(board.bottom() - margin - size.y), at(board.top() + margin));
    // A message about the text of a field is often right below the field.
    let near = field.expand(margin);
    if low.intersects(near) && !high.intersects(near) { high } else { low }
}

/// Returns the keys of a keyboard at `place`, each with its area.
pub fn keys(place: Rect) -> impl Iterator<Item = (Cap, Rect)> {
    let gap = GAP * place.height() / ROWS.len() as f32;
    let inner = place.shrink(gap);
    let unit = vec2(inner.width() / ROW_WIDTH, inner.height() / ROWS.len() as f32);
    ROWS.iter().enumerate().flat_map(move |(row, caps)| {
        let top = inner.top() + row as f32 * unit.y;
        caps.iter().scan(inner.left(), move |left, &(cap, width)| {
            let rect = Rect::from_min_size(Pos2::new(*left, top), vec2(width * unit.x, unit.y));
            *left = rect.right();
            Some((cap, rect.shrink(gap * 0.5)))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOARD: Rect = Rect { min: Pos2::ZERO, max: Pos2::new(1000.0, 640.0) };

    fn field(y: f32) -> Rect {
        Rect::from_min_size(Pos2::new(300.0, y), vec2(200.0, 22.0))
    }

    #[test]
    fn every_row_is_full_and_no_key_is_there_twice() {
        let mut seen = Vec::new();
        for row in &ROWS {
            assert_eq!(row.iter().map(|(_, width)| width).sum::<f32>(), ROW_WIDTH, "{row:?}");
            seen.extend(row.iter().map(|(cap, _)| *cap));
        }
        let mut chars: Vec<char> = seen
            .iter()
            .flat_map(|cap| match *cap {
                Cap::Char(plain, shifted) => vec![plain, shifted],
                _ => Vec::new(),
            })
            .collect();
        let count = chars.len();
        chars.sort_unstable();
        chars.dedup();
        assert_eq!(chars.len(), count);
        let all = ('a'..='z').chain('A'..='Z').chain('0'..='9').chain(".-_/".chars());
        assert_eq!(all.filter(|char| !chars.contains(char)).collect::<String>(), "");
    }

    #[test]
    fn keys_lie_apart_on_the_keyboard_and_are_large_enough_for_a_ray() {
        let place = place(field(100.0), BOARD);
        let rects: Vec<Rect> = keys(place).map(|(_, rect)| rect).collect();
        for (i, a) in rects.iter().enumerate() {
            assert!(place.contains_rect(*a));
            // The board is half a metre wide: 2 cm.
            assert!(a.width() > 40.0 && a.height() > 40.0, "{a:?}");
            assert!(rects[i + 1..].iter().all(|b| !a.intersects(*b)), "{a:?}");
        }
    }

    #[test]
    fn it_lies_where_the_field_is_not() {
        for (y, below) in [(20.0, true), (300.0, true), (480.0, false), (610.0, false)] {
            let place = place(field(y), BOARD);
            assert!(BOARD.contains_rect(place) && !place.intersects(field(y)), "{y}: {place:?}");
            assert_eq!(place.center().y > BOARD.center().y, below, "{y}");
        }
        // A field as large as the board has to be covered.
        assert!(BOARD.contains_rect(place(BOARD, BOARD)));
    }

    #[test]
    fn it_is_there_while_a_field_wants_text_and_forgets_the_shift_after() {
        let (context, mut events) = (Context::default(), Vec::new());
        let mut keyboard = Keyboard::default();
        assert!(!keyboard.covers(Pos2::new(500.0, 600.0)));
        assert!(keyboard.follow(Some(field(100.0)), BOARD));
        assert!(!keyboard.follow(Some(field(120.0)), BOARD), "it stays");
        assert!(keyboard.covers(Pos2::new(500.0, 600.0)));
        keyboard.point(keyboard.key(Cap::Shift).map(|rect| rect.center()));
        keyboard.press(&context, &mut events);
        assert_eq!((keyboard.shift, events.len()), (Shift::Once, 0));
        assert!(keyboard.follow(None, BOARD));
        assert_eq!(keyboard, Keyboard::default());
    }

    #[test]
    fn only_keys_that_move_or_delete_write_again() {
        let context = Context::default();
        let mut keyboard = Keyboard::default();
        keyboard.follow(Some(field(100.0)), BOARD);
        for (cap, more) in [(Cap::Backspace, 2), (Cap::Char('a', 'A'), 0), (Cap::Enter, 0)] {
            let mut events = Vec::new();
            keyboard.point(keyboard.key(cap).map(|rect| rect.center()));
            keyboard.press(&context, &mut events);
            let first = events.len();
            for now_s in [0.0, 0.4, 0.55, 0.6, 0.64] {
                keyboard.hold(now_s, &context, &mut events);
            }
            assert_eq!(events.len(), first + more * 2, "{cap:?}");
            keyboard.release();
            assert_eq!(keyboard.due_s(), None);
        }
    }
}
