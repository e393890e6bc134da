//! Autosave: writes the file of a sculpture with unsaved changes at intervals, if the person wants that.
//!
//! Takes the time as a value. The file is written as by a manual save, on a thread, but never within a stroke or beside
//! other long work, and without questions. A file that another program has changed or holds stays as it is, which is
//! reported once.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::command::Command;
use crate::format;
use crate::format::options::ExportOptions;
use crate::session::Session;

/// Delay before another attempt where a save is impossible at the moment.
const SOON: Duration = Duration::from_secs(1);

/// The time of the next save.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Due {
    /// There is nothing to save.
    Never,
    /// Ask again after this time.
    After(Duration),
    /// Save now with this command. If it fails, the next attempt comes after the interval.
    Now(Command),
}

/// The state between two calls.
#[derive(Default)]
pub(super) struct Autosave {
    /// Start of the unsaved changes, or time of the last attempt.
    since: Option<Instant>,
    /// The file that is not autosaved until the person has saved it.
    left_alone: Option<PathBuf>,
    /// The running save is an autosave.
    under_way: bool,
}

impl Autosave {
    /// Returns whether the save that has just ended was an autosave.
    pub fn take_under_way(&mut self) -> bool {
        std::mem::take(&mut self.under_way)
    }

    /// Stops autosaving the file at `path`, which was not written for a lasting reason.
    pub fn leave_alone(&mut self, path: &Path) {
        self.left_alone = Some(path.to_path_buf());
    }

    /// Starts anew after the person has saved or opened a file.
    pub fn begin_anew(&mut self) {
        self.left_alone = None;
    }

    /// Notes that the due save has begun.
    pub fn set_under_way(&mut self) {
        self.under_way = true;
    }

    /// Returns when to save the sculpture's file: once it has had unsaved changes for `every` (`None`: never).
    /// `is_free`: there is no stroke, other work or question.
    pub fn due(
        &mut self,
        session: &Session,
        every: Option<Duration>,
        now: Instant,
        is_free: bool,
    ) -> Due {
        let path = session.path().filter(|path| format::is_sculpture(path));
        let path = path.map(Path::to_path_buf).filter(|_| session.modified());
        let path =
            path.filter(|path| !session.is_read_only() && self.left_alone.as_ref() != Some(path));
        let (Some(every), Some(path)) = (every, path) else {
            self.since = None;
            return Due::Never;
        };
        let since = *self.since.get_or_insert(now);
        let left = every.saturating_sub(now.saturating_duration_since(since));
        if !left.is_zero() {
            return Due::After(left);
        }
        if !is_free {
            return Due::After(SOON);
        }
        self.since = Some(now);
        Due::Now(Command::Save { path, export: ExportOptions::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::editor::{Editor, Outcome};
    use crate::session::FileAccess;

    const EVERY: Option<Duration> = Some(Duration::from_secs(60));

    /// Returns the editor of a new sculpture with edges of 16 voxels.
    fn editor() -> Editor {
        let mut config = Config::default();
        config.new.dims = [16; 3];
        Editor::new(Session::new(&config.new_sculpture(), config.limits()).unwrap())
    }

    fn run(editor: &mut Editor, line: &str) {
        editor.run(line.parse().unwrap());
        editor.finish_job();
    }

    /// Returns the editor of a sculpture in the file at `path`, with unsaved changes.
    fn changed(path: &Path) -> Editor {
        let mut editor = editor();
        run(&mut editor, &format!("save {path:?}"));
        run(&mut editor, "subtract cuboid at=8,8,8 half=2");
        assert!(editor.session().modified());
        editor.take_outcomes();
        editor
    }

    #[test]
    fn unsaved_changes_are_saved_when_they_are_old_enough() {
        let folder = tempfile::tempdir().unwrap();
        let mut editor = changed(&folder.path().join("owl.vsc"));
        let began = Instant::now();
        let at = |s: u64| began + Duration::from_secs(s);
        assert_eq!(editor.autosave(EVERY, at(0), true), EVERY);
        assert_eq!(editor.autosave(EVERY, at(59), true), Some(Duration::from_secs(1)));
        assert!(!editor.is_busy());
        // First a question is open, then a stroke is in hand.
        assert_eq!(editor.autosave(EVERY, at(60), false), Some(SOON));
        editor.execute(&"begin".parse().unwrap());
        assert_eq!(editor.autosave(EVERY, at(61), true), Some(SOON));
        assert!(!editor.is_busy());
        editor.execute(&"end".parse().unwrap());
        editor.autosave(EVERY, at(62), true);
        assert!(editor.is_busy());
        editor.finish_job();
        assert!(!editor.session().modified());
        assert_eq!(editor.autosave(EVERY, at(600), true), None);
        // The interval begins with the next change.
        run(&mut editor, "subtract cuboid at=4,8,8 half=1");
        assert_eq!(editor.autosave(EVERY, at(1000), true), EVERY);
    }

    #[test]
    fn nothing_is_saved_where_it_is_not_wanted_or_has_no_name() {
        let folder = tempfile::tempdir().unwrap();
        let late = Instant::now() + Duration::from_secs(6000);
        let mut unnamed = editor();
        run(&mut unnamed, "subtract cuboid at=8,8,8 half=2");
        let mut off = changed(&folder.path().join("off.vsc"));
        let mut reader = changed(&folder.path().join("reader.vsc"));
        reader.session_mut().set_file_access(FileAccess::ReadOnly);
        for (editor, every) in [(&mut unnamed, EVERY), (&mut off, None), (&mut reader, EVERY)] {
            assert_eq!(editor.autosave(every, Instant::now(), true), None);
            assert_eq!(editor.autosave(every, late, true), None);
            assert!(!editor.is_busy() && editor.session().modified());
        }
    }

    #[test]
    fn a_file_that_is_changed_or_held_by_another_is_left_alone_which_is_said_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("owl.vsc");
        for is_held in [false, true] {
            std::fs::remove_file(&path).ok();
            let mut editor = changed(&path);
            let mut other =
                Session::open(&path, &Default::default(), *editor.document().limits(), &());
            let other = other.as_mut().unwrap();
            if is_held {
                other.set_file_access(FileAccess::Locked);
            } else {
                other.execute(&"clear".parse().unwrap(), &()).unwrap();
                other.execute(&format!("save {path:?}").parse().unwrap(), &()).unwrap();
            }
            let bytes = std::fs::read(&path).unwrap();
            let began = Instant::now();
            let mut told = 0;
            for minutes in 0..5 {
                editor.autosave(EVERY, began + Duration::from_secs(60 * minutes), true);
                editor.finish_job();
                for outcome in editor.take_outcomes() {
                    assert!(matches!(outcome, Outcome::Notice(_)), "{outcome:?}");
                    told += 1;
                }
            }
            assert_eq!(told, 1, "held: {is_held}");
            assert_eq!(std::fs::read(&path).unwrap(), bytes);
            assert!(editor.session().modified());
        }
    }
}
