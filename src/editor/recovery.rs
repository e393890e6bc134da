//! Secures a sculpture when the program cannot go on: in its journal, or else in a file of its own.

use std::path::{Path, PathBuf};

use crate::command::Command;
use crate::format::options::ExportOptions;
use crate::session::{Session, SessionError};

/// The place of the sculpture.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum SecuredPlace {
    /// In this journal, with undo and redo.
    Journal(PathBuf),
    /// In this file.
    File(PathBuf),
}

/// Makes sure that no work is lost: it is in the journal, or if that is incomplete, is saved in `folder`.
pub fn secure(session: &mut Session, folder: &Path) -> Result<SecuredPlace, SessionError> {
    match session.journal_path() {
        Some(path) if session.secure_in_journal() => Ok(SecuredPlace::Journal(path)),
        _ => save(session, folder).map(SecuredPlace::File),
    }
}

/// Saves the sculpture in `folder` under an unused name. Returns the path.
pub fn save(session: &mut Session, folder: &Path) -> Result<PathBuf, SessionError> {
    if let Err(error) = std::fs::create_dir_all(folder) {
        // Saving will fail with the same reason and name the path.
        tracing::warn!("cannot make {}: {error}", folder.display());
    }
    let name = session.path().and_then(|p| p.file_stem()).map(|n| n.to_string_lossy().into_owned());
    let name = name.unwrap_or_else(|| "sculpture".to_string());
    let candidate = |n: u32| match n {
        1 => folder.join(format!("{name}-recovered.vsc")),
        n => folder.join(format!("{name}-recovered-{n}.vsc")),
    };
    let path = (1..10_000).map(candidate).find(|p| !p.exists()).unwrap_or_else(|| candidate(1));
    session
        .execute(&Command::Save { path: path.clone(), export: ExportOptions::default() }, &())?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;

    #[test]
    fn a_stroke_in_hand_is_saved_too_and_no_file_is_overwritten() {
        let mut config = Config::default();
        config.new.dims = [16, 12, 8];
        let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        for line in [
            "begin",
            "subtract cuboid at=8,6,4 half=2",
            "recolour cuboid at=2,2,2 half=2 colour=#ff0000",
        ] {
            session.execute(&line.parse().unwrap(), &()).unwrap();
        }
        let folder = tempfile::tempdir().unwrap();
        let first = save(&mut session, folder.path()).unwrap();
        assert_eq!(first.file_name().unwrap(), "sculpture-recovered.vsc");
        let again = Session::open(&first, &Default::default(), config.limits(), &()).unwrap();
        assert_eq!(again.document().grid(), session.document().grid());
        let second = save(&mut session, folder.path()).unwrap();
        assert_ne!(first, second);
        assert!(first.exists() && second.exists());
    }
}
