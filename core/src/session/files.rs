//! The file of each sculpture of a session, and the state in which it was last written or read, so that undo past `new`
//! and `open` leads back to the right file.
//!
//! Keyed by the document's states. Reads and writes no file.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::format::Texts;
use crate::persist::SculptureFile;
use crate::sculpture::history::State;
use crate::sculpture::orientation::Up;

/// The file of one sculpture.
#[derive(Debug, Default)]
struct File {
    path: Option<PathBuf>,
    /// Texts of the file, which are saved with it.
    texts: Texts,
    /// Number of the state that the file holds. A newly made sculpture has nothing to lose either.
    saved: Option<u64>,
    /// The number of the state in which it was read, and the axis assumed to point up, if the file does not state it.
    assumed_up: Option<(u64, Up)>,
}

/// The files of all sculptures that undo and redo can lead to.
#[derive(Debug, Default)]
pub(super) struct SculptureFiles {
    of_sculpture: HashMap<u64, File>,
}

impl SculptureFiles {
    /// Restores the files of a session that continues.
    pub fn restored(files: Vec<SculptureFile>) -> SculptureFiles {
        let of_sculpture = files.into_iter().map(|file| {
            let SculptureFile { sculpture, path, texts, saved, assumed_up } = file;
            (sculpture, File { path, texts, saved, assumed_up })
        });
        SculptureFiles { of_sculpture: of_sculpture.collect() }
    }

    /// Returns all files, with paths that hold from any folder.
    pub fn all(&self) -> Vec<SculptureFile> {
        let absolute = |path: &PathBuf| std::path::absolute(path).unwrap_or_else(|_| path.clone());
        let mut files: Vec<SculptureFile> = self
            .of_sculpture
            .iter()
            .map(|(&sculpture, File { path, texts, saved, assumed_up })| SculptureFile {
                sculpture,
                path: path.as_ref().map(absolute),
                texts: texts.clone(),
                saved: *saved,
                assumed_up: *assumed_up,
            })
            .collect();
        files.sort_by_key(|file| file.sculpture);
        files
    }

    /// Adds a sculpture that steps of an earlier session lead to.
    pub fn add(&mut self, sculpture: SculptureFile) {
        self.of_sculpture.extend(SculptureFiles::restored(vec![sculpture]).of_sculpture);
    }

    /// Notes that the sculpture of `state` was newly made, without a file.
    pub fn made(&mut self, state: State) {
        let file = File { saved: Some(state.number), ..File::default() };
        self.of_sculpture.insert(state.sculpture, file);
    }

    /// Notes that the sculpture of `state` was read from `path`, with `texts`.
    pub fn opened(&mut self, state: State, path: PathBuf, texts: Texts, assumed_up: Option<Up>) {
        let assumed_up = assumed_up.map(|up| (state.number, up));
        let file = File { path: Some(path), texts, saved: Some(state.number), assumed_up };
        self.of_sculpture.insert(state.sculpture, file);
    }

    /// Notes that the sculpture of `state` was written to a file. Any other sculpture loses this file.
    pub fn saved(&mut self, state: State, path: PathBuf) {
        for (sculpture, file) in &mut self.of_sculpture {
            let is_same = |own: &PathBuf| is_same_file(own, &path);
            if *sculpture != state.sculpture && file.path.as_ref().is_some_and(is_same) {
                file.path = None;
                file.saved = None;
            }
        }
        let file = self.of_sculpture.entry(state.sculpture).or_default();
        file.path = Some(path);
        file.saved = Some(state.number);
    }

    /// Notes that the sculpture of `state` has no file any more.
    pub fn forget(&mut self, state: State) {
        if let Some(file) = self.of_sculpture.get_mut(&state.sculpture) {
            file.path = None;
            file.saved = None;
        }
    }

    /// Drops the sculptures that belong to no state any more.
    pub(crate) fn keep_only(&mut self, states: impl Iterator<Item = State>) {
        let reachable: std::collections::HashSet<u64> = states.map(|s| s.sculpture).collect();
        self.of_sculpture.retain(|sculpture, _| reachable.contains(sculpture));
    }

    /// Returns the file of the sculpture of `state`.
    pub fn path(&self, state: State) -> Option<&Path> {
        self.of_sculpture.get(&state.sculpture)?.path.as_deref()
    }

    /// Returns the axis that was assumed to point up, in the state in which the file was read.
    pub fn assumed_up(&self, state: State) -> Option<Up> {
        let (number, up) = self.of_sculpture.get(&state.sculpture)?.assumed_up?;
        (number == state.number).then_some(up)
    }

    /// Returns the texts of the file of `state`.
    pub fn texts(&self, state: State) -> Texts {
        self.of_sculpture.get(&state.sculpture).map(|f| f.texts.clone()).unwrap_or_default()
    }

    /// Returns whether the file holds the sculpture in `state`.
    pub fn is_saved(&self, state: State) -> bool {
        self.of_sculpture.get(&state.sculpture).and_then(|f| f.saved) == Some(state.number)
    }
}

/// Returns whether two paths resolve to the same file.
fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
