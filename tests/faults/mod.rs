//! Inserts the layer of this folder between Vulkan's loader and the driver of a program under test.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The layer for one program, and the file that controls it.
pub struct Faults {
    file: PathBuf,
}

impl Faults {
    /// Makes `command` load the layer. `folder`: used by this program only; it becomes its XDG_DATA_HOME, where
    /// loaders of all versions look for layers, independently of VK_LAYER_PATH.
    pub fn new(folder: &Path, command: &mut Command) -> Faults {
        let tests = trials::executable();
        let library = tests.with_file_name("libvulkan_fault_layer.so");
        assert!(library.exists(), "{}", library.display());
        let manifest = serde_json::json!({
            "file_format_version": "1.1.2",
            "layer": {
                "name": "VK_LAYER_TEST_faults",
                "type": "GLOBAL",
                "library_path": library,
                "api_version": "1.3.0",
                "implementation_version": "1",
                "description": "A driver that fails",
                "enable_environment": { "VS_FAULTS_ENABLED": "1" },
                "disable_environment": { "VS_FAULTS_DISABLED": "1" },
            },
        });
        let layers = folder.join("vulkan").join("implicit_layer.d");
        std::fs::create_dir_all(&layers).unwrap();
        std::fs::write(layers.join("faults.json"), manifest.to_string()).unwrap();
        let file = folder.join("faults.txt");
        command.env("XDG_DATA_HOME", folder).env("VS_FAULTS_ENABLED", "1").env("VS_FAULTS", &file);
        Faults { file }
    }

    /// Sets the faults from now on, a line for each call (see the layer); none with an empty text.
    pub fn set(&self, text: &str) {
        // Renamed, so that the layer never reads half a file.
        let next = self.file.with_extension("next");
        std::fs::write(&next, text).unwrap();
        std::fs::rename(next, &self.file).unwrap();
    }
}
