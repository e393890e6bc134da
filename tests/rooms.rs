//! Holds the rooms of `src` and `core/src` to the table in ARCHITECTURE.md that says who may import whom.
//!
//! A room is a module of a crate's root. Its row names the rooms that it may import, all of them in rows
//! above it, so that imports go one way. Code under `#[cfg(test)]`, files named `tests.rs` or
//! `*_tests.rs`, and folders named `tests` may import any room. Reads sources as text: comments and
//! literals are skipped, paths that start with `crate::` or leave the room through `super::` count.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Entry of a row of `src` that stands for every room of `core/src`.
const ALL_OF_CORE: &str = "core";

/// Rooms in the order of their rows, with what each may import.
type Table = Vec<(String, BTreeSet<String>)>;

/// Reads the table whose head row is "| room of `crate` | may import |".
fn parse_table(text: &str, sources: &str) -> Table {
    let names = |cell: &str| -> Vec<String> {
        cell.split('`').skip(1).step_by(2).map(str::to_string).collect()
    };
    let head = format!("| room of `{sources}` | may import |");
    let rows = text.lines().skip_while(|line| line.trim() != head).skip(2);
    let rows = rows.take_while(|line| line.starts_with('|'));
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').collect();
        let [room, imports] = cells[..] else { panic!("not a row of two cells: {line}") };
        let room = names(room).pop().unwrap_or_else(|| panic!("a row without a room: {line}"));
        (room, names(imports).into_iter().collect())
    };
    rows.map(row).collect()
}

/// The faults of a table: rows without a room and rooms without a row, double rows, and imports of a
/// room that has no row above. `lower`: rooms of the crates below.
fn table_faults(table: &Table, rooms: &BTreeSet<String>, lower: &BTreeSet<String>) -> Vec<String> {
    let mut faults = Vec::new();
    let mut above: BTreeSet<&str> = lower.iter().map(String::as_str).collect();
    for (room, imports) in table {
        if !rooms.contains(room) {
            faults.push(format!("the table has a row for `{room}`, which does not exist"));
        }
        for import in imports.iter().filter(|import| !above.contains(import.as_str())) {
            faults.push(format!("the row of `{room}` names `{import}`, which has no row above it"));
        }
        if !above.insert(room) {
            faults.push(format!("the table has two rows for `{room}`"));
        }
    }
    let listed: BTreeSet<&str> = table.iter().map(|(room, _)| room.as_str()).collect();
    let missing = rooms.iter().filter(|room| !listed.contains(room.as_str()));
    faults.extend(missing.map(|room| format!("the table has no row for `{room}`")));
    faults
}

/// Blanks comments, strings and character literals; everything else keeps its place.
fn without_comments_and_literals(source: &str) -> String {
    let bytes = source.as_bytes();
    let mut clean = bytes.to_vec();
    let mut at = 0;
    while at < bytes.len() {
        let rest = &source[at..];
        let end = if rest.starts_with("//") {
            rest.find('\n').map_or(bytes.len(), |length| at + length)
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(bytes.len(), |length| at + length + 2)
        } else if let Some(hashes) = raw_string_hashes(source, at) {
            let close = format!("\"{}", "#".repeat(hashes));
            let open = at + hashes + 2;
            source[open..].find(&close).map_or(bytes.len(), |length| open + length + close.len())
        } else if bytes[at] == b'"' {
            let mut end = at + 1;
            while end < bytes.len() && bytes[end] != b'"' {
                end += if bytes[end] == b'\\' { 2 } else { 1 };
            }
            end + 1
        } else if let Some(length) = character_literal(rest) {
            at + length
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
            continue;
        };
        let end = end.min(bytes.len());
        clean[at..end].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
        at = end;
    }
    String::from_utf8(clean).expect("whole characters were blanked")
}

/// How many `#` open the raw string that starts here, if one does.
fn raw_string_hashes(source: &str, at: usize) -> Option<usize> {
    let before = source[..at].chars().next_back();
    if before.is_some_and(|before| before.is_alphanumeric() || before == '_') {
        return None;
    }
    let rest = source[at..].strip_prefix('r')?;
    let hashes = rest.len() - rest.trim_start_matches('#').len();
    rest[hashes..].starts_with('"').then_some(hashes)
}

/// The length of the character literal that starts here, if it is none of a lifetime.
fn character_literal(rest: &str) -> Option<usize> {
    let inner = rest.strip_prefix('\'')?;
    match inner.strip_prefix('\\') {
        // The escaped character itself may be a quote.
        Some(escaped) => escaped.get(1..)?.find('\'').map(|length| length + 4),
        None => {
            let length = inner.chars().next()?.len_utf8();
            inner[length..].starts_with('\'').then_some(length + 2)
        }
    }
}

/// Identifiers and single characters of clean source text, with their lines.
fn tokens(clean: &str) -> Vec<(usize, &str)> {
    let mut tokens = Vec::new();
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    for (line, text) in clean.lines().enumerate() {
        let mut rest = text.trim_start();
        while let Some(first) = rest.chars().next() {
            let length = match is_word(first) {
                true => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
                false => first.len_utf8(),
            };
            tokens.push((line + 1, &rest[..length]));
            rest = rest[length..].trim_start();
        }
    }
    tokens
}

/// An import of a room, by its line.
#[derive(Clone, PartialEq, Eq, Debug)]
struct Import {
    line: usize,
    room: String,
    is_test: bool,
}

/// The names that paths from the crate's root begin with. `depth`: how many modules deep the file is.
fn imports(source: &str, depth: usize) -> Vec<Import> {
    let clean = without_comments_and_literals(source);
    let tokens = tokens(&clean);
    let token = |i: usize| tokens.get(i).map_or("", |&(_, token)| token);
    let is_path = |i: usize| token(i) == ":" && token(i + 1) == ":";
    let mut found = Vec::new();
    // For each open brace, whether it belongs to a test and whether to a module.
    let mut scopes: Vec<(bool, bool)> = Vec::new();
    let mut test_item = false;
    let mut i = 0;
    while i < tokens.len() {
        let is_test = test_item || scopes.iter().any(|(is_test, _)| *is_test);
        match token(i) {
            "#" if token(i + 1) == "[" && token(i + 2) == "cfg" => {
                let end = (i..tokens.len()).find(|&end| token(end) == "]").unwrap_or(tokens.len());
                let words = &tokens[i..end];
                test_item |= words.iter().any(|&(_, word)| word == "test")
                    && words.iter().all(|&(_, word)| word != "not");
                i = end;
            }
            "{" => {
                let is_module = i >= 2 && token(i - 2) == "mod";
                scopes.push((test_item, is_module));
                test_item = false;
            }
            "}" => {
                scopes.pop();
            }
            ";" => test_item = false,
            "super" if token(i.wrapping_sub(1)) != ":" => {
                let mut supers = 1;
                while is_path(i + 1) && token(i + 3) == "super" {
                    (supers, i) = (supers + 1, i + 3);
                }
                let modules = depth + scopes.iter().filter(|(_, is_module)| *is_module).count();
                if supers >= modules && is_path(i + 1) {
                    found.extend(roots(&tokens, i + 3, is_test));
                }
            }
            "crate" if is_path(i + 1) => found.extend(roots(&tokens, i + 3, is_test)),
            _ => {}
        }
        i += 1;
    }
    found
}

/// The first name of the path at `at`, or of each path of the group there.
fn roots(tokens: &[(usize, &str)], at: usize, is_test: bool) -> Vec<Import> {
    let import = |&(line, room): &(usize, &str)| Import { line, room: room.to_string(), is_test };
    if tokens.get(at).is_none_or(|&(_, token)| token != "{") {
        return tokens.get(at).map(import).into_iter().collect();
    }
    let (mut found, mut depth, mut begins) = (Vec::new(), 0, true);
    for entry in &tokens[at..] {
        match entry.1 {
            "{" => depth += 1,
            "}" => depth -= 1,
            "," => begins |= depth == 1,
            _ if depth == 1 && std::mem::take(&mut begins) => found.push(import(entry)),
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    found
}

/// Returns the errors in the imports of one file.
fn import_faults(
    file: &Path,
    source: &str,
    (room, allowed): (&str, &BTreeSet<String>),
    known: &BTreeSet<String>,
) -> Vec<String> {
    let relative: Vec<String> =
        file.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    let name = relative.last().map_or("", String::as_str);
    let is_test_file = name == "tests.rs"
        || name.ends_with("_tests.rs")
        || relative.iter().any(|part| part == "tests");
    let depth = relative.len() - usize::from(name == "mod.rs");
    let fault = |Import { line, room: to, is_test }: Import| {
        let place = format!("{}:{line}", file.display());
        if !known.contains(&to) {
            return Some(format!("{place}: `{to}` is no room"));
        }
        let is_allowed = to == room || is_test || is_test_file || allowed.contains(&to);
        (!is_allowed).then(|| format!("{place}: `{room}` may not import `{to}`"))
    };
    imports(source, depth).into_iter().filter_map(fault).collect()
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a readable folder");
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.expect("a readable entry").path()) {
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            files.push(path);
        }
    }
    files
}

/// Checks the table of a crate and every file of it. Gives the rooms and the faults.
fn check(
    root: &Path,
    sources: &str,
    text: &str,
    lower: &BTreeSet<String>,
) -> (BTreeSet<String>, Vec<String>) {
    let folder = root.join(sources);
    let mut by_room: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for file in rust_files(&folder) {
        let inside = file.strip_prefix(&folder).expect("a file of the folder").to_path_buf();
        let first = inside.iter().next().expect("a name").to_string_lossy();
        let room = first.trim_end_matches(".rs").to_string();
        if !matches!(room.as_str(), "lib" | "main") {
            by_room.entry(room).or_default().push(inside);
        }
    }
    let rooms: BTreeSet<String> = by_room.keys().cloned().collect();
    let mut table = parse_table(text, sources);
    assert!(!table.is_empty(), "ARCHITECTURE.md has a table of the rooms of {sources}");
    for (_, imports) in &mut table {
        if imports.remove(ALL_OF_CORE) {
            imports.extend(lower.iter().cloned());
        }
    }
    let mut faults = table_faults(&table, &rooms, lower);
    let known: BTreeSet<String> = rooms.union(lower).cloned().collect();
    let nothing = BTreeSet::new();
    for (room, files) in &by_room {
        let row = table.iter().find(|(listed, _)| listed == room);
        let allowed = row.map_or(&nothing, |(_, imports)| imports);
        for file in files {
            let source = fs::read_to_string(folder.join(file)).expect("a readable source");
            let of_file = import_faults(file, &source, (room, allowed), &known);
            faults.extend(of_file.into_iter().map(|fault| format!("{sources}/{fault}")));
        }
    }
    (rooms, faults)
}

#[test]
fn rooms_import_only_what_the_table_allows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let (core, mut faults) = check(root, "core/src", &text, &BTreeSet::new());
    let (_, of_program) = check(root, "src", &text, &core);
    faults.extend(of_program);
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn imports_are_found_with_their_lines_and_comments_are_not() {
    let source = r##"
//! See `crate::nothing`.
use crate::gpu::Device;
use crate::{
    render::{Renderer, shading},
    view,
};
/* crate::comment */
fn f<'a>(x: &'a str) -> char {
    let text = "crate::text \" crate::more";
    let raw = r#"crate::raw "# ;
    crate::terminal::done(text);
    '"'
}
#[cfg(test)]
mod tests {
    use crate::scenes;
    use super::*;
    use super::super::sculpture::Grid;
}
use super::ui::Ui;
#[cfg(not(test))]
use crate::video;
"##;
    let found = imports(source, 1);
    let expected = [
        (3, "gpu", false),
        (5, "render", false),
        (6, "view", false),
        (12, "terminal", false),
        (17, "scenes", true),
        (19, "sculpture", true),
        (21, "ui", false),
        (23, "video", false),
    ];
    let expected: Vec<Import> = expected
        .map(|(line, room, is_test)| Import { line, room: room.to_string(), is_test })
        .into();
    assert_eq!(found, expected);
}

#[test]
fn faults_are_named() {
    let set = |names: &[&str]| names.iter().map(|name| name.to_string()).collect::<BTreeSet<_>>();
    let text = "\
| room of `src` | may import |
|---|---|
| `gpu` | `view` |
| `render` | `gpu`, `ui` |
| `ui` | `render` |
| `gone` | |
| `gpu` | |
";
    let table = parse_table(text, "src");
    assert_eq!(table[1], ("render".to_string(), set(&["gpu", "ui"])));
    let faults = table_faults(&table, &set(&["gpu", "render", "ui", "video"]), &set(&["view"]));
    assert_eq!(
        faults,
        [
            "the row of `render` names `ui`, which has no row above it",
            "the table has a row for `gone`, which does not exist",
            "the table has two rows for `gpu`",
            "the table has no row for `video`",
        ]
    );

    let known = set(&["gpu", "render", "ui", "view"]);
    let of = |file: &str, source: &str| {
        import_faults(Path::new(file), source, ("gpu", &set(&["view"])), &known)
    };
    assert_eq!(of("gpu/mod.rs", "use crate::view;\nuse crate::gpu::X;"), [""; 0]);
    assert_eq!(
        of("gpu/mod.rs", "\nuse crate::{view, ui::Ui};\nuse crate::config;"),
        ["gpu/mod.rs:2: `gpu` may not import `ui`", "gpu/mod.rs:3: `config` is no room"]
    );
    assert_eq!(of("gpu/device.rs", "use super::super::ui;").len(), 1);
    assert_eq!(of("gpu/device_tests.rs", "use crate::ui;"), [""; 0]);
}
