//! Finds fonts of the operating system by letters that the program's own fonts lack: names of files in Chinese,
//! Japanese, Korean and many other scripts.
//!
//! Takes folders and letters, gives the bytes of whole font files. Reads only the character map of each file, until all
//! letters are found. Must not know who draws them.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use skrifa::raw::tables::cmap::Cmap;
use skrifa::raw::{FontData, FontRead};

/// Limits of the search, so that no folder, however large, takes long.
const MOST_FILES: usize = 8192;
const DEEPEST: usize = 8;
const LONGEST: Duration = Duration::from_secs(10);
/// Most valid faces of a collection, tables of a face, and bytes of a character map.
const MOST_FACES: u32 = 64;
const MOST_TABLES: u16 = 128;
const MOST_CMAP_BYTES: u32 = 8 << 20;

/// A face of a font file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Face {
    pub path: PathBuf,
    /// Its index in a collection.
    pub index: u32,
    /// The wanted letters that the font has.
    pub letters: BTreeSet<char>,
}

/// Returns the folders of the system's fonts, the person's own first.
pub fn folders() -> Vec<PathBuf> {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let within = |name: &str, parts: &[&str]| {
        set(name)
            .map(|folder| parts.iter().fold(PathBuf::from(folder), |path, part| path.join(part)))
    };
    let found: Vec<Option<PathBuf>> = if cfg!(windows) {
        vec![
            within("LOCALAPPDATA", &["Microsoft", "Windows", "Fonts"]),
            within("WINDIR", &["Fonts"]),
        ]
    } else if cfg!(target_os = "macos") {
        let own = within("HOME", &["Library", "Fonts"]);
        vec![own, Some("/Library/Fonts".into()), Some("/System/Library/Fonts".into())]
    } else {
        let own = within("XDG_DATA_HOME", &["fonts"]);
        let mut all = vec![
            own.or_else(|| within("HOME", &[".local", "share", "fonts"])),
            within("HOME", &[".fonts"]),
        ];
        let shared = set("XDG_DATA_DIRS").unwrap_or("/usr/local/share:/usr/share".into());
        all.extend(std::env::split_paths(&shared).map(|folder| Some(folder.join("fonts"))));
        // The place where a sandbox shows those of the system.
        all.push(Some("/run/host/fonts".into()));
        all
    };
    found.into_iter().flatten().collect()
}

/// Returns faces that have the letters, greedily from the likeliest files. Skips letters that no font has.
pub fn find(folders: &[PathBuf], letters: &BTreeSet<char>) -> Vec<Face> {
    let began = Instant::now();
    let mut files = Vec::new();
    for folder in folders {
        gather(folder, DEEPEST, &mut files);
    }
    files.sort_by_cached_key(|path| (unlikeliness(path), path.clone()));
    files.dedup();
    let mut missing = letters.clone();
    let mut found = Vec::new();
    for path in files {
        if missing.is_empty() || began.elapsed() > LONGEST {
            break;
        }
        match best_face(&path, &missing) {
            Ok(Some(face)) => {
                missing.retain(|letter| !face.letters.contains(letter));
                found.push(face);
            }
            Ok(None) => {}
            Err(error) => tracing::debug!("no font: {}: {error}", path.display()),
        }
    }
    found
}

/// Adds the font files below a folder.
fn gather(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        if files.len() >= MOST_FILES {
            return;
        }
        let path = entry.path();
        let is_font = path.extension().and_then(OsStr::to_str).is_some_and(|ending| {
            ["ttf", "otf", "ttc", "otc"].iter().any(|own| own.eq_ignore_ascii_case(ending))
        });
        match path.metadata() {
            Ok(found) if found.is_dir() && depth > 0 => gather(&path, depth - 1, files),
            Ok(found) if found.is_file() && is_font => files.push(path),
            _ => {}
        }
    }
}

/// Ranks files: upright fonts of normal weight without serifs first, and fonts that draw every letter as a box last.
fn unlikeliness(path: &Path) -> usize {
    const WORDS: [(&str, usize); 14] = [
        ("lastresort", 100),
        ("emoji", 20),
        ("bold", 4),
        ("italic", 4),
        ("oblique", 4),
        ("black", 4),
        ("thin", 4),
        ("light", 2),
        ("medium", 1),
        ("condensed", 2),
        ("serif", 2),
        ("mono", 2),
        ("unifont", 8),
        ("symbol", 8),
    ];
    let name = path.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    let name = name.replace("sansserif", "sans").replace("sans-serif", "sans");
    WORDS.iter().filter(|(word, _)| name.contains(word)).map(|(_, weight)| weight).sum()
}

/// Returns the face of a file that has most of the letters; `None` if it has none of them.
fn best_face(path: &Path, letters: &BTreeSet<char>) -> Result<Option<Face>> {
    let mut file = File::open(path)?;
    let mut best: Option<Face> = None;
    for (index, start) in face_starts(&mut file)?.into_iter().enumerate() {
        let own = letters_of(&mut file, start, letters)?;
        if own.len() > best.as_ref().map_or(0, |face| face.letters.len()) {
            best = Some(Face { path: path.to_path_buf(), index: index as u32, letters: own });
        }
    }
    Ok(best)
}

/// Returns the offsets of the faces of a file.
fn face_starts(file: &mut File) -> Result<Vec<u32>> {
    let head: [u8; 12] = read_at(file, 0)?;
    match &head[..4] {
        b"ttcf" => {
            let count = u32::from_be_bytes([head[8], head[9], head[10], head[11]]);
            let starts = (0..count.min(MOST_FACES)).map(|i| read_u32(file, 12 + 4 * i));
            starts.collect()
        }
        [0, 1, 0, 0] | b"OTTO" | b"true" => Ok(vec![0]),
        _ => Err(Error::new(ErrorKind::InvalidData, "it begins as no font does")),
    }
}

/// Returns the letters that the face at `start` can draw.
fn letters_of(file: &mut File, start: u32, letters: &BTreeSet<char>) -> Result<BTreeSet<char>> {
    let head: [u8; 6] = read_at(file, start)?;
    let tables = u16::from_be_bytes([head[4], head[5]]).min(MOST_TABLES);
    let (mut cmap, mut has_outlines) = (None, false);
    for table in 0..u32::from(tables) {
        let row: [u8; 16] = read_at(file, start.saturating_add(12 + 16 * table))?;
        let word = |at: usize| u32::from_be_bytes([row[at], row[at + 1], row[at + 2], row[at + 3]]);
        match &row[..4] {
            b"cmap" => cmap = Some((word(8), word(12))),
            // Bitmap glyphs alone cannot be drawn.
            b"glyf" | b"CFF " | b"CFF2" => has_outlines = true,
            _ => {}
        }
    }
    let Some((at, bytes)) = cmap.filter(|(_, bytes)| has_outlines && *bytes <= MOST_CMAP_BYTES)
    else {
        return Ok(BTreeSet::new());
    };
    let mut table = Vec::new();
    file.seek(SeekFrom::Start(at.into()))?;
    file.take(bytes.into()).read_to_end(&mut table)?;
    let Ok(cmap) = Cmap::read(FontData::new(&table)) else { return Ok(BTreeSet::new()) };
    let has = |letter: &&char| cmap.map_codepoint(**letter).is_some_and(|glyph| glyph.to_u32() > 0);
    Ok(letters.iter().filter(has).copied().collect())
}

fn read_at<const N: usize>(file: &mut File, at: u32) -> Result<[u8; N]> {
    let mut bytes = [0; N];
    file.seek(SeekFrom::Start(at.into()))?;
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

fn read_u32(file: &mut File, at: u32) -> Result<u32> {
    read_at(file, at).map(u32::from_be_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn letters(text: &str) -> BTreeSet<char> {
        text.chars().collect()
    }

    /// Returns a collection of two faces, each a whole font.
    fn collection(fonts: [&[u8]; 2]) -> Vec<u8> {
        let mut bytes = b"ttcf\0\x01\0\0\0\0\0\x02".to_vec();
        let starts = [20, 20 + fonts[0].len() as u32];
        starts.iter().for_each(|start| bytes.extend(start.to_be_bytes()));
        for (font, start) in fonts.iter().zip(starts) {
            let mut font = font.to_vec();
            let tables = u16::from_be_bytes([font[4], font[5]]) as usize;
            for table in 0..tables {
                // Offsets of tables are relative to the beginning of the file.
                let at = 12 + 16 * table + 8;
                let own = u32::from_be_bytes(font[at..at + 4].try_into().unwrap());
                font[at..at + 4].copy_from_slice(&(own + start).to_be_bytes());
            }
            bytes.extend(font);
        }
        bytes
    }

    #[test]
    fn letters_are_found_in_files_of_all_kinds_and_what_is_no_font_is_passed_by() {
        use epaint_default_fonts::{HACK_REGULAR, NOTO_EMOJI_REGULAR, UBUNTU_LIGHT};
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("truetype/a/b");
        std::fs::create_dir_all(&deep).unwrap();
        for (name, bytes) in [
            ("NoFont.ttf", &b"no font at all"[..]),
            ("Cut.ttf", &HACK_REGULAR[..300]),
            ("Empty.otf", b""),
            ("Readme.txt", HACK_REGULAR),
            ("Ubuntu-Light.ttf", UBUNTU_LIGHT),
            ("a/b/Hack-Regular.TTF", HACK_REGULAR),
        ] {
            std::fs::write(folder.path().join("truetype").join(name), bytes).unwrap();
        }
        let folders = [folder.path().to_path_buf(), folder.path().join("none")];
        // Box drawing is in Hack, euro and fi in both.
        let found = find(&folders, &letters("├€"));
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].path.ends_with("a/b/Hack-Regular.TTF"));
        assert_eq!((found[0].index, &found[0].letters), (0, &letters("├€")));
        assert_eq!(find(&folders, &letters("中文")), []);
        assert_eq!(find(&folders, &letters("")), []);

        let both = collection([UBUNTU_LIGHT, NOTO_EMOJI_REGULAR]);
        std::fs::write(folder.path().join("Both.ttc"), both).unwrap();
        let found = find(&folders, &letters("🐙"));
        assert_eq!((found.len(), found[0].index), (1, 1), "{found:?}");
        let bytes = std::fs::read(&found[0].path).unwrap();
        let face = skrifa::FontRef::from_index(&bytes, found[0].index).unwrap();
        use skrifa::MetadataProvider;
        assert!(face.charmap().map('🐙').is_some());
    }

    #[test]
    fn upright_fonts_of_usual_weight_come_first() {
        let mut names = [
            "LastResort.otf",
            "NotoSansCJK-Bold.ttc",
            "NotoSerifCJK-Regular.ttc",
            "NotoColorEmoji.ttf",
            "NotoSansCJK-Regular.ttc",
        ];
        names.sort_by_key(|name| unlikeliness(Path::new(name)));
        assert_eq!(names[0], "NotoSansCJK-Regular.ttc");
        assert_eq!(names[1], "NotoSerifCJK-Regular.ttc");
        assert_eq!(names[4], "LastResort.otf");
        assert!(!folders().is_empty());
    }
}
