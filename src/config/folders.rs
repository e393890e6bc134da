//! Owns the places where a person's files of this program lie on each system. Knows no file's form.

use std::path::PathBuf;

use directories::ProjectDirs;

fn project() -> Option<ProjectDirs> {
    ProjectDirs::from("", "", "virtual-sculpture")
}

/// Where a person's own settings are kept: on Linux as the XDG base directory specification says.
pub fn personal_folder() -> Option<PathBuf> {
    project().map(|project| project.config_dir().to_path_buf())
}

/// Where the program keeps what is no setting, such as rescued work: the folder for state, or on
/// systems without one that for data of this machine; the temporary folder where nobody has a home.
pub fn state_folder() -> PathBuf {
    let of = |project: ProjectDirs| {
        project.state_dir().unwrap_or(project.data_local_dir()).to_path_buf()
    };
    project().map_or_else(std::env::temp_dir, of)
}

/// Where the program keeps what it can make again.
pub fn cache_folder() -> Option<PathBuf> {
    project().map(|project| project.cache_dir().to_path_buf())
}

/// The file of a person's own settings.
pub fn personal_file() -> Option<PathBuf> {
    personal_folder().map(|folder| folder.join("config.toml"))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn linux_keeps_to_the_folders_of_xdg() {
        // What this process was started with is what it must use: tests share one environment.
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
