//! Loads fonts of the system for letters that the program's fonts lack, such as those of file names in other scripts.
//!
//! Inspects what an interface has drawn. A thread looks for a font only when a letter is missing, so that the start
//! takes no longer. Must not know what the texts say.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashSet};
use std::path::PathBuf;
use std::thread::JoinHandle;
use std::time::Duration;

use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::epaint::{ClippedShape, Shape};
use egui::{Context, FontData, FontFamily};
use skrifa::{FontRef, MetadataProvider};

use crate::system_fonts::{self, Face};

/// Most system fonts that are added, and their most bytes in all.
const MOST_FONTS: usize = 8;
const MOST_BYTES: usize = 64 << 20;
/// Time between two looks at the result of a search.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// A font that has been read.
struct FontFile {
    name: String,
    bytes: Vec<u8>,
    index: u32,
}

/// The letters of an interface that have been checked, and the search for missing ones.
pub struct Glyphs {
    folders: Vec<PathBuf>,
    /// Keyed by letter and by whether it is drawn in the font of numbers.
    known: HashSet<(char, bool)>,
    /// Missing, and not yet looked for.
    missing: BTreeSet<char>,
    search: Option<JoinHandle<Vec<FontFile>>>,
    fonts: usize,
    bytes: usize,
}

impl Default for Glyphs {
    fn default() -> Glyphs {
        Glyphs::of(system_fonts::folders())
    }
}

impl Glyphs {
    /// Uses fonts from these folders.
    fn of(folders: Vec<PathBuf>) -> Glyphs {
        Glyphs {
            folders,
            known: HashSet::new(),
            missing: BTreeSet::new(),
            search: None,
            fonts: 0,
            bytes: 0,
        }
    }

    /// Checks what was drawn. Returns the time after which another pass is due, if one is.
    pub fn look(&mut self, context: &Context, shapes: &[ClippedShape]) -> Option<Duration> {
        shapes.iter().for_each(|clipped| self.hear(&clipped.shape));
        if let Some(search) = self.search.take_if(|search| search.is_finished()) {
            let found = search.join().unwrap_or_else(|_| {
                tracing::error!("the search for fonts has panicked");
                Vec::new()
            });
            let mut has_come = false;
            for font in found {
                has_come |= self.add(context, font);
            }
            if has_come {
                return Some(Duration::ZERO);
            }
        }
        let may_search = self.search.is_none() && self.fonts < MOST_FONTS;
        if may_search && !self.missing.is_empty() {
            let letters = std::mem::take(&mut self.missing);
            self.begin(letters);
        }
        self.search.as_ref().map(|_| LOOK_EVERY)
    }

    /// Records the letters of a text that are in no font of the program.
    fn hear(&mut self, shape: &Shape) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| self.hear(shape)),
            Shape::Text(text) if !text.galley.text().is_ascii() => {
                let job = &text.galley.job;
                for section in &job.sections {
                    let range = section.byte_range.start.0..section.byte_range.end.0;
                    let numbers = section.format.font_id.family == FontFamily::Monospace;
                    for letter in job.text.get(range).unwrap_or_default().chars() {
                        let is_new = !letter.is_ascii() && self.known.insert((letter, numbers));
                        if is_new && is_drawn(letter) && !is_own(letter, numbers) {
                            self.missing.insert(letter);
                        }
                    }
                }
            }
            _ => {}
        }
    }

    fn begin(&mut self, letters: BTreeSet<char>) {
        let (folders, room) = (self.folders.clone(), MOST_BYTES - self.bytes);
        let work = move || {
            let faces = system_fonts::find(&folders, &letters);
            let mut left = room;
            faces.into_iter().filter_map(|face| read(face, &mut left)).collect()
        };
        let thread = std::thread::Builder::new().name("fonts".to_string()).spawn(work);
        match thread {
            Ok(thread) => self.search = Some(thread),
            Err(error) => tracing::warn!("no thread to look for fonts: {error}"),
        }
    }

    /// Adds a font after all others. Returns false if there are enough.
    fn add(&mut self, context: &Context, font: FontFile) -> bool {
        if self.fonts >= MOST_FONTS || font.bytes.len() > MOST_BYTES - self.bytes {
            return false;
        }
        tracing::debug!("letters come from {}", font.name);
        (self.fonts, self.bytes) = (self.fonts + 1, self.bytes + font.bytes.len());
        let data =
            FontData { font: Cow::Owned(font.bytes), index: font.index, tweak: Default::default() };
        let families = [FontFamily::Proportional, FontFamily::Monospace];
        let last = |family| InsertFontFamily { family, priority: FontPriority::Lowest };
        let families = families.into_iter().map(last).collect();
        context.add_font(FontInsert::new(&font.name, data, families));
        true
    }
}

/// Returns the bytes of a font, if there is room for them and the whole font is valid.
fn read(face: Face, room: &mut usize) -> Option<FontFile> {
    let Face { path, index, letters } = face;
    let bytes = path.metadata().ok()?.len();
    if bytes > *room as u64 {
        tracing::debug!("{} is too large to take letters from", path.display());
        return None;
    }
    let bytes = std::fs::read(&path).ok()?;
    let charmap = FontRef::from_index(&bytes, index).ok()?.charmap();
    letters.iter().any(|letter| charmap.map(*letter).is_some()).then_some(())?;
    *room = room.saturating_sub(bytes.len());
    Some(FontFile { name: format!("{} {index}", path.display()), bytes, index })
}

/// Returns whether a letter is more than a space or a sign for text layout.
fn is_drawn(letter: char) -> bool {
    let is_joiner = matches!(letter, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}');
    let is_variation =
        matches!(letter, '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{e0100}'..='\u{e01ef}');
    let is_private = matches!(letter, '\u{e000}'..='\u{f8ff}' | '\u{f0000}'..);
    !(letter.is_whitespace() || letter.is_control() || is_joiner || is_variation || is_private)
}

/// Returns whether the program's own font has a letter: the general one, or the one for numbers.
fn is_own(letter: char, numbers: bool) -> bool {
    use epaint_default_fonts::{EMOJI_ICON, HACK_REGULAR, NOTO_EMOJI_REGULAR, UBUNTU_LIGHT};
    [UBUNTU_LIGHT, NOTO_EMOJI_REGULAR, EMOJI_ICON]
        .into_iter()
        .chain(numbers.then_some(HACK_REGULAR))
        .any(|font| has(font, letter))
}

fn has(font: &[u8], letter: char) -> bool {
    let glyph = FontRef::new(font).ok().and_then(|font| font.charmap().map(letter));
    glyph.is_some_and(|glyph| glyph.to_u32() > 0)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use egui::{FontDefinitions, FontId, RawInput};

    use super::*;

    /// Returns a font with an outline for one Chinese letter: the glyph of "A" of another font, with a new character
    /// map.
    fn font_with(letter: char) -> Vec<u8> {
        let source = epaint_default_fonts::UBUNTU_LIGHT;
        let glyph = FontRef::new(source).unwrap().charmap().map('A').unwrap().to_u32();
        let mut bytes = source.to_vec();
        // Format 12 with one group.
        let mut cmap: Vec<u8> = [0_u16, 1, 3, 10].iter().flat_map(|v| v.to_be_bytes()).collect();
        cmap.extend(12_u32.to_be_bytes());
        cmap.extend([12_u16, 0].iter().flat_map(|v| v.to_be_bytes()));
        let letter = u32::from(letter);
        cmap.extend([28, 0, 1, letter, letter, glyph].iter().flat_map(|v| v.to_be_bytes()));
        let tables = u16::from_be_bytes([bytes[4], bytes[5]]) as usize;
        let row = (0..tables).map(|i| 12 + 16 * i).find(|row| &bytes[*row..row + 4] == b"cmap");
        let row = row.unwrap();
        let end = bytes.len() as u32;
        bytes[row + 8..row + 12].copy_from_slice(&end.to_be_bytes());
        bytes[row + 12..row + 16].copy_from_slice(&(cmap.len() as u32).to_be_bytes());
        bytes.extend(cmap);
        bytes
    }

    fn pass(context: &Context, glyphs: &mut Glyphs, text: &str) -> Option<Duration> {
        let mut output = context.run_ui(RawInput::default(), |ui| drop(ui.label(text)));
        output.textures_delta.clear();
        glyphs.look(context, &output.shapes)
    }

    #[test]
    fn a_letter_that_is_missing_comes_from_a_font_of_the_system() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("Han.ttf"), font_with('中')).unwrap();
        std::fs::write(folder.path().join("Broken.ttf"), b"\0\x01\0\0\0\x02").unwrap();
        let mut glyphs = Glyphs::of(vec![folder.path().to_path_buf()]);
        let context = Context::default();
        // The texts of the interface need no font.
        assert_eq!(pass(&context, &mut glyphs, "⟲ Undo … ✖ 12 × 3 ⚠ ü ✔ − ° ℹ 🖊 💧"), None);
        assert!(glyphs.search.is_none() && glyphs.missing.is_empty(), "{:?}", glyphs.missing);

        let began = Instant::now();
        while glyphs.fonts == 0 {
            assert!(pass(&context, &mut glyphs, "中 head.vsc").is_some());
            assert!(began.elapsed() < Duration::from_secs(60), "no font is found");
            std::thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(pass(&context, &mut glyphs, "中 head.vsc"), None, "it rests");
        let id = FontId::proportional(13.0);
        assert!(context.fonts_mut(|fonts| fonts.has_glyph(&id, '中')));
        let names: Vec<String> = FontDefinitions::default().font_data.keys().cloned().collect();
        assert!(!names.iter().any(|name| name.contains("Han")), "only where it is needed");

        // A letter that no font has is looked for once.
        while pass(&context, &mut glyphs, "文").is_some() {
            assert!(began.elapsed() < Duration::from_secs(60));
            std::thread::sleep(Duration::from_millis(1));
        }
        for _ in 0..3 {
            assert_eq!(pass(&context, &mut glyphs, "文"), None);
        }
        assert_eq!((glyphs.fonts, glyphs.known.contains(&('文', false))), (1, true));
    }

    #[test]
    fn no_font_is_sought_for_letters_that_are_not_drawn() {
        for letter in ['\u{2009}', '\u{200d}', '\u{fe0f}', '\u{feff}', '\u{e123}', '\u{a0}'] {
            assert!(!is_drawn(letter), "{letter:?}");
        }
        assert!(is_drawn('中') && is_drawn('ع') && is_drawn('한'));
        assert!(is_own('ü', false) && is_own('✖', false) && !is_own('中', true));
        assert!(!is_own('თ', false) && is_own('თ', true), "a letter of the font of numbers alone");
    }

    #[test]
    fn the_letters_of_the_program_are_those_that_it_draws() {
        let context = Context::default();
        pass(&context, &mut Glyphs::of(Vec::new()), "A");
        // The text layout cannot tell the replacement letter of a font from a missing letter.
        let is_told = |letter: &char| {
            is_drawn(*letter) && !has(epaint_default_fonts::NOTO_EMOJI_REGULAR, *letter)
        };
        let letters = ('\u{a1}'..='\u{2fff}').filter(is_told);
        let id = FontId::proportional(13.0);
        let differ: Vec<char> = context.fonts_mut(|fonts| {
            letters
                .filter(|letter| fonts.has_glyph(&id, *letter) != is_own(*letter, false))
                .collect()
        });
        assert!(differ.is_empty(), "{differ:?}");
    }
}
