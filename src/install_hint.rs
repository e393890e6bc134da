//! Advice on installing missing software on this operating system: ends of error messages.

/// For a missing Vulkan loader.
pub const VULKAN_LOADER: &str = if cfg!(windows) {
    "install the current driver of the graphics card, from its maker's site"
} else if cfg!(target_os = "macos") {
    "install the Vulkan SDK, which brings MoltenVK"
} else {
    "install it (Debian, Ubuntu: libvulkan1; Fedora: vulkan-loader) and a driver \
     (mesa-vulkan-drivers)"
};

/// For a Vulkan loader that is too old.
pub const NEWER_VULKAN_LOADER: &str = if cfg!(target_os = "linux") {
    "update libvulkan1 (Fedora: vulkan-loader)"
} else {
    "install the current driver of the graphics card"
};

/// For a loader without a device.
pub const VULKAN_DRIVER: &str = if cfg!(target_os = "linux") {
    "install a driver (Debian, Ubuntu: mesa-vulkan-drivers, which also brings the software renderer \
     lavapipe)"
} else {
    VULKAN_LOADER
};

/// For a requested validation layer that is not installed.
pub const VALIDATION_LAYER: &str = if cfg!(target_os = "linux") {
    "install it (Debian, Ubuntu: vulkan-validationlayers)"
} else {
    "install the Vulkan SDK"
};

/// For a missing OpenXR loader.
pub const OPENXR_LOADER: &str = if cfg!(windows) {
    "put openxr_loader.dll beside the program (it comes with the OpenXR SDK)"
} else {
    "install it (Debian, Ubuntu: libopenxr-loader1; Fedora: openxr-libs)"
};
