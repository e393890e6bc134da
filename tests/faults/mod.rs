//! Puts the layer of this folder between Vulkan's loader and the driver of a program under test.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The layer for one program, and the file that says what fails.
pub struct Faults {
    file: PathBuf,
}

impl Faults {
    /// Lets `command` load the layer. `folder`: of this program alone; it becomes its XDG_DATA_HOME, where
    /// loaders of all versions look for layers, whatever VK_LAYER_PATH says.
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

    /// Says what fails from now on, a line for each call (see the layer); nothing with an empty text.
    pub fn set(&self, text: &str) {
        // Whole at every moment.
        let next = self.file.with_extension("next");
        std::fs::write(&next, text).unwrap();
        std::fs::rename(next, &self.file).unwrap();
    }
}
