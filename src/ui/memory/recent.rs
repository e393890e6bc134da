//! Owns the list of files opened or saved last. Each is kept as the command that opens it, with the choices made for
//! it.

use std::path::Path;

use crate::command::Command;
use crate::format::options::ImportOptions;
use crate::sculpture::orientation::Up;

/// Number of files kept.
const MOST: usize = 10;

/// Files, the latest first.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Recent {
    list: Vec<Command>,
}

impl Recent {
    /// Records a file that a command has opened or saved; ignores other commands.
    pub fn note(&mut self, command: &Command) {
        let (path, known) = match command {
            Command::Open { path, import } => (path, Some(*import)),
            Command::Save { path, .. } => (path, None),
            _ => return,
        };
        // The next start may have another working directory.
        let Ok(path) = std::path::absolute(path) else { return };
        let before = self.position(&path).map(|at| self.list.remove(at));
        let import = known.unwrap_or(match before {
            Some(Command::Open { import, .. }) => import,
            _ => ImportOptions::default(),
        });
        self.list.insert(0, Command::Open { path, import });
        self.list.truncate(MOST);
    }

    /// Records the file open at the start, unless more is known about it.
    pub fn note_open(&mut self, path: &Path, upright: Option<Up>) {
        let Ok(path) = std::path::absolute(path) else { return };
        match self.position(&path) {
            Some(at) => self.list[..=at].rotate_right(1),
            None => {
                let import = ImportOptions { upright, ..ImportOptions::default() };
                self.note(&Command::Open { path, import });
            }
        }
    }

    /// Records the up axis of a file.
    pub fn set_upright(&mut self, path: &Path, up: Up) {
        let Ok(path) = std::path::absolute(path) else { return };
        if let Some(at) = self.position(&path)
            && let Command::Open { import, .. } = &mut self.list[at]
        {
            import.upright = Some(up);
        }
    }

    pub fn forget(&mut self, path: &Path) {
        self.list.retain(|command| path_of(command) != Some(path));
    }

    fn position(&self, path: &Path) -> Option<usize> {
        self.list.iter().position(|command| path_of(command) == Some(path))
    }

    /// Returns the commands that open them, the latest first.
    pub fn commands(&self) -> &[Command] {
        &self.list
    }

    /// Returns the paths, the latest first.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.list.iter().filter_map(path_of)
    }

    /// Returns the lines that open them.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.list.iter().map(Command::to_string)
    }

    /// Reads such lines; skips others.
    pub fn from_lines<'a>(lines: impl Iterator<Item = &'a str>) -> Recent {
        let mut recent = Recent::default();
        for line in lines {
            match line.parse() {
                Ok(command @ Command::Open { .. }) if recent.list.len() < MOST => {
                    recent.list.push(command);
                }
                _ => tracing::warn!("no recent file: {line}"),
            }
        }
        recent
    }
}

/// Returns the file that a command opens.
pub fn path_of(command: &Command) -> Option<&Path> {
    match command {
        Command::Open { path, .. } => Some(path),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(path: &str) -> Command {
        Command::Open { path: path.into(), import: ImportOptions::default() }
    }

    #[test]
    fn the_latest_come_first_once_and_no_more_than_ten() {
        let mut recent = Recent::default();
        for i in 0..14 {
            recent.note(&open(&format!("/a/{i}.vsc")));
        }
        recent.note(&open("/a/9.vsc"));
        let names: Vec<_> = recent.paths().map(|path| path.display().to_string()).collect();
        assert_eq!(names.len(), MOST);
        assert_eq!(names[..3], ["/a/9.vsc", "/a/13.vsc", "/a/12.vsc"]);
        recent.note_open(Path::new("/a/12.vsc"), None);
        assert_eq!(recent.paths().next(), Some(Path::new("/a/12.vsc")));
        recent.note(&"undo".parse().unwrap());
        recent.forget(Path::new("/a/9.vsc"));
        assert_eq!(recent.paths().count(), MOST - 1);
    }

    #[test]
    fn choices_about_a_file_are_kept_in_its_line() {
        let mut recent = Recent::default();
        let raw: Command = "open e\"/a/x \\\" y.raw\" threshold=7 raw=4x4x4:u8".parse().unwrap();
        recent.note(&raw);
        recent.note(&"save e\"/a/x \\\" y.raw\"".parse().unwrap());
        let lines: Vec<String> = recent.lines().collect();
        assert_eq!(lines, [raw.to_string()]);
        // Opened at a start with other arguments: the earlier choice stays.
        recent.note_open(Path::new("/a/x \" y.raw"), Some(Up::X));
        assert_eq!(recent.lines().collect::<Vec<_>>(), lines);
        let again = Recent::from_lines(lines.iter().map(String::as_str));
        assert_eq!(again, recent);
        recent.set_upright(Path::new("/a/x \" y.raw"), Up::MinusZ);
        recent.set_upright(Path::new("/a/other.raw"), Up::MinusZ);
        let line = recent.lines().next().unwrap();
        assert!(line.contains(" upright=-z ") && line.contains(" raw="), "{line}");
        let damaged = ["", "clear", "open", "open \"/a\"", "save \"/b\"", "open \"\\xff\""];
        assert_eq!(Recent::from_lines(damaged.into_iter()).paths().count(), 2);
    }
}
