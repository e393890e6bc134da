//! Tests that texts for people are true and readable: files that documents name are there, all modules of the core are
//! listed, and no text of the interface has a line break inside.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap()
}

/// The words between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Every page, from the root.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![PathBuf::from("core/README.md")];
    for folder in ["", "docs", "docs/internals"] {
        let entries = fs::read_dir(root().join(folder)).unwrap();
        let names = entries.map(|entry| Path::new(folder).join(entry.unwrap().file_name()));
        pages.extend(names.filter(|name| name.extension().is_some_and(|ending| ending == "md")));
    }
    pages
}

#[test]
fn files_that_the_documents_for_programmers_name_are_there() {
    const ENDINGS: [&str; 5] = [".rs", ".toml", ".sh", ".wgsl", ".md"];
    const ROOTS: [&str; 4] = ["", "src", "core/src", "tracking/src"];
    let internals = pages().into_iter().filter(|page| page.starts_with("docs/internals"));
    let others = ["ARCHITECTURE.md", "CONTRIBUTING.md", "core/README.md"].map(PathBuf::from);
    for document in internals.chain(others) {
        let text = fs::read_to_string(root().join(&document)).unwrap();
        let paths = quoted(&text).filter(|it| {
            ENDINGS.iter().any(|ending| it.ends_with(ending))
                && !it.contains(|c: char| c.is_whitespace() || "*<>".contains(c))
                // Stands for a name that is chosen.
                && !it.contains("NAME")
        });
        let missing: Vec<&str> = paths
            .filter(|path| {
                let inside = document.parent().unwrap().join(path);
                let is_there = |from: &&str| root().join(from).join(path).exists();
                !ROOTS.iter().any(is_there) && !root().join(inside).exists()
            })
            // Beside the settings of a person, in the shared folder, and any file of tests.
            .filter(|path| {
                !["settings.toml", "config.toml", "bindings.toml", "tests.rs"].contains(path)
            })
            .collect();
        assert!(missing.is_empty(), "{document:?} names files that are not there: {missing:?}");
    }
}

/// The anchor of a heading, as forges make them.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase().replace(' ', "-");
    kept.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect()
}

#[test]
fn links_lead_to_files_and_headings_that_are_there() {
    let mut links = 0;
    for page in pages() {
        let text = fs::read_to_string(root().join(&page)).unwrap();
        for rest in text.split("](").skip(1) {
            let link = rest.split(')').next().unwrap();
            if link.starts_with("http") {
                continue;
            }
            links += 1;
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let to = match file {
                "" => page.clone(),
                file => page.parent().unwrap().join(file),
            };
            assert!(root().join(&to).exists(), "{page:?} links to {link}");
            if !heading.is_empty() {
                let text = fs::read_to_string(root().join(&to)).unwrap();
                let mut headings = text.lines().filter_map(|line| line.strip_prefix('#'));
                let is_it = |line: &str| anchor(line.trim_start_matches('#').trim()) == heading;
                assert!(headings.any(is_it), "{page:?} links to {link}");
            }
        }
    }
    assert!(links > 50, "{links}");
}

#[test]
fn the_readme_of_the_core_lists_all_its_modules() {
    let (code, readme) = (read("core/src/lib.rs"), read("core/README.md"));
    let modules = code
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ").and_then(|rest| rest.strip_suffix(';')));
    let rows: String = readme.lines().filter(|line| line.starts_with("| `")).collect();
    let missing: Vec<&str> =
        modules.filter(|module| !quoted(&rows).any(|it| it == *module)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// The lines at which a string of code goes on without a backslash at the end, so that the line break is in the text.
fn broken_strings(code: &str) -> Vec<usize> {
    let (mut broken, mut line) = (Vec::new(), 1);
    let mut chars = code.chars().peekable();
    let (mut in_string, mut raw, mut hashes) = (false, false, false);
    let mut before = ' ';
    while let Some(c) = chars.next() {
        match c {
            '\n' => {
                if in_string && !raw {
                    broken.push(line);
                }
                line += 1;
            }
            '\\' if in_string && !raw => {
                // An escaped line break is none.
                line += usize::from(chars.next() == Some('\n'));
            }
            '"' if in_string => in_string = hashes && chars.peek() != Some(&'#'),
            '"' => {
                // A string that begins with an escaped line break is a block of lines, such as the head of a file.
                let is_block = chars.clone().take(2).eq(['\\', '\n']);
                hashes = before == '#';
                (in_string, raw) = (true, is_block || hashes || before == 'r');
            }
            '\'' if !in_string => {
                // A character, such as the quote itself, or a lifetime.
                let mut ahead = chars.clone();
                match (ahead.next(), ahead.next()) {
                    (Some('\\'), _) => {
                        chars.next();
                        chars.next();
                    }
                    (Some(_), Some('\'')) => {
                        chars.next();
                        chars.next();
                    }
                    _ => {}
                }
            }
            '/' if !in_string && chars.peek() == Some(&'/') => {
                while chars.next_if(|c| *c != '\n').is_some() {}
            }
            _ => {}
        }
        before = c;
    }
    broken
}

fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => sources(&path, files),
            false => files.push(path),
        }
    }
}

#[test]
fn no_text_of_the_interface_has_a_line_break_inside() {
    assert_eq!(
        broken_strings("let a = \"one \\\n two\"; // \"\nlet b = '\"';\nr#\"x\ny\"#"),
        [0; 0]
    );
    assert_eq!(broken_strings("tip(\"one \n two\")"), [1]);
    let mut files = Vec::new();
    for room in ["app", "controls", "editor", "input", "ui", "viewpoint"] {
        sources(&root().join("src").join(room), &mut files);
    }
    files.retain(|path| !path.to_string_lossy().ends_with("_tests.rs"));
    let broken: Vec<String> = files
        .iter()
        .flat_map(|path| {
            let code = fs::read_to_string(path).unwrap();
            let code = code.split("#[cfg(test)]\nmod tests").next().unwrap().to_string();
            let name = path.strip_prefix(root()).unwrap().display().to_string();
            broken_strings(&code).into_iter().map(move |line| format!("{name}:{line}"))
        })
        .collect();
    assert!(broken.is_empty(), "{broken:?}");
}
