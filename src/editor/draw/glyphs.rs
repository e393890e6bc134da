//! Letters as outlines: a line of text in one of the fonts that the interface embeds, as closed polygons.
//!
//! Lengths are in the unit of the capitals' height; x to the right, y up. Curves become lines.

use glam::Vec2;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};

use crate::tools::drawn::MAX_POINTS;

/// Most letters of a line.
pub const MOST_LETTERS: usize = 120;
/// Largest deviation of lines from a curve, as a share of the height.
const TOLERANCE: f32 = 0.004;
/// Extension of bold strokes on each side, as a share of the height.
const BOLD: f32 = 0.045;

/// A font for letters.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Font {
    /// [`Font::Light`] with strokes of twice the width.
    #[default]
    Bold,
    /// Ubuntu Light: narrow strokes.
    Light,
    /// Hack: letters of one width, with stronger strokes.
    Mono,
}

impl Font {
    pub const ALL: [Font; 3] = [Font::Bold, Font::Light, Font::Mono];

    /// Returns its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Font::Bold => "bold",
            Font::Light => "light",
            Font::Mono => "mono",
        }
    }

    const fn bytes(self) -> &'static [u8] {
        match self {
            Font::Bold | Font::Light => epaint_default_fonts::UBUNTU_LIGHT,
            Font::Mono => epaint_default_fonts::HACK_REGULAR,
        }
    }
}

/// A letter, or a separate part such as the dot of an i: its outline with those of its holes.
#[derive(Clone, PartialEq, Debug)]
pub struct Letter {
    pub outlines: Vec<Vec<Vec2>>,
    /// The character of the letter or part.
    pub sign: char,
    /// The middle of the character along the line.
    pub middle: f32,
}

/// Returns the letters of a line of text with capitals of `height`, centred on the origin. Spaces have no letter.
pub fn letters(text: &str, font: Font, height: f32) -> Result<Vec<Letter>, String> {
    let unreadable = || "The letters of this font cannot be read".to_string();
    let file = FontRef::new(font.bytes()).map_err(|_| unreadable())?;
    let metrics = file.metrics(Size::unscaled(), LocationRef::default());
    let capital = metrics.cap_height.filter(|capital| *capital > 0.0).ok_or_else(unreadable)?;
    // Characters that the font lacks are taken from the font of symbols.
    let signs = FontRef::new(epaint_default_fonts::NOTO_EMOJI_REGULAR).map_err(|_| unreadable())?;
    let mut letters = Vec::new();
    let mut x = 0.0;
    for sign in text.trim().chars().take(MOST_LETTERS) {
        let found =
            [&file, &signs].into_iter().find_map(|font| Some((font, font.charmap().map(sign)?)));
        let Some((from, glyph)) = found else {
            return Err(format!("The fonts have no “{sign}”: choose another letter"));
        };
        let size = match std::ptr::eq(from, &file) {
            true => f32::from(metrics.units_per_em) * height / capital,
            false => 1.2 * height,
        };
        let (mut outlines, mut advance) =
            glyph_outlines(from, glyph, size).ok_or_else(unreadable)?;
        if font == Font::Bold {
            outlines.iter_mut().for_each(|outline| *outline = widened(outline, BOLD * height));
            advance += 2.0 * BOLD * height;
        }
        let place = |p: Vec2| p + Vec2::new(x, -0.5 * height);
        let outlines: Vec<Vec<Vec2>> =
            outlines.into_iter().map(|outline| outline.into_iter().map(place).collect()).collect();
        letters.extend(parts(outlines, sign, x + 0.5 * advance));
        x += advance;
    }
    let middle = Vec2::new(0.5 * x, 0.0);
    letters.iter_mut().for_each(|letter| {
        letter.middle -= middle.x;
        letter.outlines.iter_mut().flatten().for_each(|p| *p -= middle);
    });
    Ok(letters)
}

/// Returns the outlines of a glyph and its advance, in a font of `size` units per em.
fn glyph_outlines(font: &FontRef, glyph: GlyphId, size: f32) -> Option<(Vec<Vec<Vec2>>, f32)> {
    let size_of = Size::new(size);
    let advance = font.glyph_metrics(size_of, LocationRef::default()).advance_width(glyph)?;
    let outline = font.outline_glyphs().get(glyph)?;
    let mut tolerance = TOLERANCE * size;
    loop {
        let mut pen = Pen { outlines: Vec::new(), tolerance };
        outline.draw(DrawSettings::unhinted(size_of, LocationRef::default()), &mut pen).ok()?;
        pen.outlines.iter_mut().for_each(|outline| {
            outline.dedup();
            if outline.len() > 1 && outline.first() == outline.last() {
                outline.pop();
            }
        });
        pen.outlines.retain(|outline| outline.len() > 2);
        if pen.outlines.iter().map(Vec::len).sum::<usize>() <= MAX_POINTS {
            return Some((pen.outlines, advance));
        }
        tolerance *= 2.0;
    }
}

/// Returns the parts of a letter: each solid outline with the holes in it. Overlapping accents would otherwise become
/// holes.
fn parts(outlines: Vec<Vec<Vec2>>, sign: char, middle: f32) -> Vec<Letter> {
    // Fonts turn the outlines of holes the other way.
    let (solid, holes): (Vec<_>, Vec<_>) =
        outlines.into_iter().partition(|outline| area(outline) < 0.0);
    let mut parts: Vec<Letter> =
        solid.into_iter().map(|outline| Letter { outlines: vec![outline], sign, middle }).collect();
    for hole in holes {
        let around = |part: &&mut Letter| contains(&part.outlines[0], hole[0]);
        if let Some(part) = parts.iter_mut().find(around) {
            part.outlines.push(hole);
        }
    }
    parts
}

/// Returns the area of an outline, positive if counter-clockwise.
fn area(outline: &[Vec2]) -> f32 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f32>() * 0.5
}

/// Returns whether an outline goes around a point.
fn contains(outline: &[Vec2], p: Vec2) -> bool {
    let next = outline.iter().cycle().skip(1);
    let crosses = |(a, b): &(&Vec2, &Vec2)| {
        (a.y > p.y) != (b.y > p.y) && a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) > p.x
    };
    outline.iter().zip(next).filter(crosses).count() % 2 == 1
}

/// Returns an outline whose letter is on its right, moved to its left.
fn widened(outline: &[Vec2], by: f32) -> Vec<Vec2> {
    let count = outline.len();
    let left = |i: usize| (outline[(i + 1) % count] - outline[i]).normalize_or_zero().perp();
    (0..count)
        .map(|i| {
            let (a, b) = (left((i + count - 1) % count), left(i));
            // Limits the spikes of sharp corners.
            let corner = (a + b) * by / (1.0 + a.dot(b)).max(0.25);
            outline[i] + corner.clamp_length_max(1.5 * by)
        })
        .collect()
}

/// Collects outlines as polygons.
struct Pen {
    outlines: Vec<Vec<Vec2>>,
    tolerance: f32,
}

impl Pen {
    fn last(&self) -> Vec2 {
        self.outlines.last().and_then(|outline| outline.last()).copied().unwrap_or(Vec2::ZERO)
    }

    fn push(&mut self, to: Vec2) {
        if let Some(outline) = self.outlines.last_mut() {
            outline.push(to);
        }
    }

    /// Adds a curve. `bend`: the deviation of its control points from a line.
    fn curve(&mut self, bend: f32, at: impl Fn(f32) -> Vec2) {
        let count = (bend / self.tolerance).sqrt().ceil().clamp(1.0, 24.0) as u32;
        (1..=count).for_each(|i| self.push(at(i as f32 / count as f32)));
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.outlines.push(vec![Vec2::new(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.push(Vec2::new(x, y));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let (a, b, c) = (self.last(), Vec2::new(cx, cy), Vec2::new(x, y));
        // A quarter of this is the distance between the curve and its chord.
        let bend = 0.25 * (a - b * 2.0 + c).length();
        self.curve(bend, |t| a.lerp(b, t).lerp(b.lerp(c, t), t));
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let (from, a, b, to) = (self.last(), Vec2::new(ax, ay), Vec2::new(bx, by), Vec2::new(x, y));
        let bend = (from - a * 2.0 + b).length().max((a - b * 2.0 + to).length());
        self.curve(bend, |t| {
            let (p, q, r) = (from.lerp(a, t), a.lerp(b, t), b.lerp(to, t));
            p.lerp(q, t).lerp(q.lerp(r, t), t)
        });
    }

    fn close(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the winding number of outlines around a point, and the crossings of a ray from it.
    fn around(outlines: &[Vec<Vec2>], p: Vec2) -> (i32, u32) {
        let (mut winding, mut crossings) = (0, 0);
        for outline in outlines {
            for (a, b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
                if (a.y > p.y) != (b.y > p.y) {
                    let x = a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y);
                    if x > p.x {
                        winding += if b.y > a.y { 1 } else { -1 };
                        crossings += 1;
                    }
                }
            }
        }
        (winding, crossings)
    }

    #[test]
    fn capitals_are_as_high_as_asked_and_the_line_is_in_the_middle() {
        for font in Font::ALL {
            let line = letters("  HI H ", font, 20.0).unwrap();
            assert_eq!(line.len(), 3, "spaces have no letter");
            let points: Vec<Vec2> =
                line.iter().flat_map(|l| &l.outlines).flatten().copied().collect();
            let low = points.iter().copied().reduce(Vec2::min).unwrap();
            let high = points.iter().copied().reduce(Vec2::max).unwrap();
            let more = if font == Font::Bold { 0.9 } else { 0.0 };
            let off = [low.y + 10.0 + more, high.y - 10.0 - more];
            assert!(off.iter().all(|off| off.abs() < 0.3), "{font:?} {low} {high}");
            assert!((low.x + high.x).abs() < 2.0, "{low} {high}");
        }
        assert_eq!(letters("   ", Font::Light, 20.0), Ok(Vec::new()));
        assert!(letters("a字", Font::Light, 20.0).unwrap_err().contains('字'));
    }

    #[test]
    fn bold_letters_cover_more_and_their_holes_less() {
        let inside = |font: Font| {
            let line = letters("o", font, 100.0).unwrap();
            let p = |i: u32| Vec2::new((i % 100) as f32 - 50.3, (i / 100) as f32 - 50.1);
            let count = (0..10_000).filter(|i| around(&line[0].outlines, p(*i)).1 % 2 == 1);
            count.count()
        };
        let (light, bold) = (inside(Font::Light), inside(Font::Bold));
        assert!(bold > light * 8 / 5 && bold < light * 3, "{light} {bold}");
    }

    /// Solids count crossings, fonts count turns: overlapping outlines of a letter would leave holes.
    #[test]
    fn no_letter_has_holes_where_its_strokes_meet() {
        let latin: Vec<char> = (' '..='~').chain('¡'..='ÿ').filter(|c| *c != '\u{ad}').collect();
        for font in Font::ALL {
            for sign in &latin {
                let Ok(line) = letters(&sign.to_string(), font, 100.0) else {
                    panic!("{font:?} has no {sign}")
                };
                for letter in line {
                    let count: usize = letter.outlines.iter().map(Vec::len).sum();
                    assert!(count < 300, "{sign}: {count}");
                    let wrong = (0..1600).filter(|i| {
                        let (x, y) = ((i % 40) as f32, (i / 40) as f32);
                        let p = Vec2::new(x * 5.0 - 99.7, y * 5.0 - 99.3);
                        let (winding, crossings) = around(&letter.outlines, p);
                        (winding != 0) != (crossings % 2 == 1)
                    });
                    // Widened strokes of *, Ç and ç cross themselves in a corner.
                    let most = usize::from(font == Font::Bold && "*Çç".contains(*sign));
                    assert!(wrong.count() <= most, "{font:?} {sign}");
                }
            }
        }
    }
}
