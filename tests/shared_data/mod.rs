//! Finds the shared test data: real volumes that do not belong to the project. They lie in the
//! folder that VS_SHARED names, or in `../shared`. Where they are missing a test announces that it
//! is skipped, unless VS_REQUIRE_SHARED is set.

use std::path::{Path, PathBuf};

/// The path of a shared file or folder, or none (announced) where there is no shared data.
pub fn shared_file(name: &str) -> Option<PathBuf> {
    let root = std::env::var_os("VS_SHARED").map(PathBuf::from).unwrap_or_else(beside_the_project);
    let path = root.join(name);
    if path.exists() {
        return Some(path);
    }
    assert!(
        std::env::var_os("VS_REQUIRE_SHARED").is_none(),
        "{} is missing, and VS_REQUIRE_SHARED demands it",
        path.display()
    );
    println!("SKIPPED: {} is not here", path.display());
    None
}

/// The folder `shared` beside the project, whose crates may lie in folders of it.
fn beside_the_project() -> PathBuf {
    let crate_root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let project = crate_root.ancestors().find(|folder| folder.join("Cargo.lock").exists());
    project.unwrap_or(crate_root).join("../shared")
}
