//! The folders and files in which the program keeps settings, state and caches on each system. Knows
//! nothing of their contents.

use std::path::PathBuf;

use directories::ProjectDirs;

fn project() -> Option<ProjectDirs> {
    ProjectDirs::from("", "", "virtual-sculpture")
}

/// Returns the folder of the user's settings; on Linux as in the XDG base directory specification.
pub fn personal_folder() -> Option<PathBuf> {
    project().map(|project| project.config_dir().to_path_buf())
}

/// Returns the folder for state other than settings, such as recovered work. On systems without such a folder it is the
/// one for local data, and without a home folder the temporary one.
pub fn state_folder() -> PathBuf {
    let of = |project: ProjectDirs| {
        project.state_dir().unwrap_or(project.data_local_dir()).to_path_buf()
    };
    project().map_or_else(std::env::temp_dir, of)
}

/// Returns the folder of the journals of sessions, and of undo steps that do not fit into memory.
pub fn journal_folder() -> PathBuf {
    state_folder().join("journals")
}

/// Returns the folder of the undo histories of saved files.
pub fn saved_history_folder() -> PathBuf {
    state_folder().join("histories")
}

/// Returns the folder for reproducible files; `None` without a home folder.
pub fn cache_folder() -> Option<PathBuf> {
    project().map(|project| project.cache_dir().to_path_buf())
}

/// Returns the user's settings file.
pub fn personal_file() -> Option<PathBuf> {
    personal_folder().map(|folder| folder.join("config.toml"))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn linux_uses_the_xdg_folders() {
        // The environment is left unchanged: tests share one process.
        let home = std::env::var_os("HOME").map(PathBuf::from).expect("a home");
        let base = |name: &str, usual: &str| {
            let named = std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
            named.unwrap_or_else(|| home.join(usual)).join("virtual-sculpture")
        };
        assert_eq!(personal_folder(), Some(base("XDG_CONFIG_HOME", ".config")));
        assert_eq!(state_folder(), base("XDG_STATE_HOME", ".local/state"));
        assert_eq!(cache_folder(), Some(base("XDG_CACHE_HOME", ".cache")));
    }
}
