//! Finds the shared test data, which is not part of the project: real volumes, and a script that unpacks an
//! OpenXR runtime. It is in the folder VS_SHARED, or in `../shared` beside the project. Knows no test.

use std::path::{Path, PathBuf};

/// The path of a shared file or folder; where it is missing, the running test is skipped, or fails with
/// VS_REQUIRE_SHARED.
pub fn shared_file(name: &str) -> PathBuf {
    let root = std::env::var_os("VS_SHARED").map_or_else(beside_the_project, PathBuf::from);
    let path = root.join(name);
    if !path.exists() {
        crate::lacks("VS_REQUIRE_SHARED", &format!("{} does not exist", path.display()));
    }
    path
}

/// The folder `shared` beside the project, whose root holds the lock file.
fn beside_the_project() -> PathBuf {
    let this_crate = Path::new(env!("CARGO_MANIFEST_DIR"));
    let project = this_crate.ancestors().find(|folder| folder.join("Cargo.lock").exists());
    project.unwrap_or(this_crate).join("../shared")
}
