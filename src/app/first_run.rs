//! Records that the program has been started before, so that the guide opens only once.

use std::path::Path;

use crate::folders::state_folder;

/// Returns whether this is the first start. Later calls return false.
pub fn is_first_run() -> bool {
    is_first_in(&state_folder())
}

fn is_first_in(folder: &Path) -> bool {
    let mark = folder.join("guide-shown");
    if mark.exists() {
        return false;
    }
    if let Err(error) = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&mark, "")) {
        // Then the guide opens again, which does no harm.
        tracing::warn!("cannot write {}: {error}", mark.display());
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_first_run_is_the_first() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("state");
        assert!(is_first_in(&folder) && !is_first_in(&folder));
        // Where nothing can be written, every run is the first.
        assert!(is_first_in(Path::new("/dev/null/state")));
    }
}
