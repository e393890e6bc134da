//! The answers about the up axis of files that do not state it, by extension.
//!
//! Takes and gives remembered texts; shows nothing and reads no file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::sculpture::history::State;
use crate::sculpture::orientation::Up;

/// The answers about up axes.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Upright {
    /// The axis by extension, in lower case.
    by_ending: BTreeMap<String, Up>,
    /// The state of the sculpture for which the question was dismissed.
    pub dismissed: Option<State>,
    /// The file whose import has answered the question.
    pub answered: Option<PathBuf>,
}

impl Upright {
    /// Returns the up axis of the last file with such an extension, if it was answered.
    pub fn of(&self, path: &Path) -> Option<Up> {
        self.by_ending.get(&ending(path)?).copied()
    }

    pub fn remember(&mut self, path: &Path, up: Up) {
        if let Some(ending) = ending(path) {
            self.by_ending.insert(ending, up);
        }
    }

    /// Suppresses the question for this file, whose orientation the person has seen.
    pub fn answer(&mut self, path: &Path) {
        self.answered = Some(path.to_path_buf());
    }

    /// Returns the answers to remember: extensions and the text forms of axes.
    pub fn to_texts(&self) -> BTreeMap<String, String> {
        self.by_ending.iter().map(|(ending, up)| (ending.clone(), up.to_string())).collect()
    }

    /// Reads such texts. Skips an entry that names no axis.
    pub fn from_texts(texts: &BTreeMap<String, String>) -> Upright {
        let known =
            texts.iter().filter_map(|(ending, up)| Some((ending.clone(), up.parse().ok()?)));
        Upright { by_ending: known.take(64).collect(), ..Upright::default() }
    }
}

/// Returns the extension of a file name, in lower case.
pub fn ending(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

/// Returns the name of an axis for people.
pub fn label(up: Up) -> &'static str {
    match up {
        Up::X => "X up",
        Up::MinusX => "−X up",
        Up::Y => "Y up",
        Up::MinusY => "−Y up",
        Up::Z => "Z up",
        Up::MinusZ => "−Z up",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_kept_by_the_ending_of_the_name() {
        let mut upright = Upright::default();
        assert_eq!(upright.of(Path::new("a.pvm")), None);
        upright.remember(Path::new("/b/head.PVM"), Up::Z);
        upright.remember(Path::new("scan.raw"), Up::MinusZ);
        upright.remember(Path::new("scan.raw"), Up::Y);
        assert_eq!(upright.of(Path::new("other.pvm")), Some(Up::Z));
        assert_eq!(upright.of(Path::new("c.raw")), Some(Up::Y));
        for none in ["pvm", "c.vsc", ""] {
            assert_eq!(upright.of(Path::new(none)), None, "{none}");
        }
        let mut texts = upright.to_texts();
        assert_eq!(Upright::from_texts(&texts), upright);
        texts.insert("vol".to_string(), "sideways".to_string());
        assert_eq!(Upright::from_texts(&texts), upright);
    }
}
