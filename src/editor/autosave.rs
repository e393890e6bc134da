//! Autosave: the file of a sculpture with unsaved changes is written at intervals, if the person wants that.
//!
//! Takes the time as a value. The file is written as by a person's own save, on a thread, but never within a stroke or
//! beside other long work, and no question is asked: a file that another program has changed or holds is left as it is,
//! which is said once.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::command::Command;
use crate::format;
use crate::format::options::ExportOptions;
use crate::session::Session;

/// How soon it is tried again where it cannot be done at the moment.
const SOON: Duration = Duration::from_secs(1);

/// When a file is to be saved.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Due {
    /// There is nothing to save.
    Never,
    /// It is to be asked again after as long.
    After(Duration),
    /// Now, by this command. If it fails, it is tried again after as long as it was waited for.
    Now(Command),
}

/// The state that is kept from one look to the next.
#[derive(Default)]
pub(super) struct Autosave {
    /// When the unsaved changes began, or when saving was last tried.
    since: Option<Instant>,
    /// The file that is left alone until the person has saved it.
    left_alone: Option<PathBuf>,
    /// The save under way was not asked for by the person.
    under_way: bool,
}

impl Autosave {
    /// Returns whether the save that has just ended was one of these.
    pub fn take_under_way(&mut self) -> bool {
        std::mem::take(&mut self.under_way)
    }

    /// The file at `path` was not written, for a reason that stays: it is left alone from now on.
    pub fn leave_alone(&mut self, path: &Path) {
        self.left_alone = Some(path.to_path_buf());
    }

    /// The person has saved or opened a file.
    pub fn begin_anew(&mut self) {
        self.left_alone = None;
    }

    /// The save that was due has begun.
    pub fn set_under_way(&mut self) {
        self.under_way = true;
    }

    /// Returns when the sculpture's file is to be saved: once it has had unsaved changes for `every`. `every` none: never.
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

    /// Returns the editor of a new sculpture of 16 voxels' edge.
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
        // A question is open; then a stroke is in hand.
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
        // The time begins with the next change.
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
