#!/usr/bin/env bash
# Installs the system packages for building and running Virtual Sculpture that are missing. Rust itself must be there.
# Usage: setup.sh [run|test]   (test adds the validation layers and virtual displays: X11, Wayland)
# Installs on Debian and its derivatives; on other systems it prints what to install.
set -euo pipefail

purpose=${1:-run}
missing=()

have_library() { PATH=$PATH:/sbin:/usr/sbin ldconfig -p 2>/dev/null | grep -F "$1" >/dev/null; }
have_driver() {
    local dir
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] && return 0
    for dir in /usr/share/vulkan/icd.d /usr/local/share/vulkan/icd.d /etc/vulkan/icd.d; do
        compgen -G "$dir/*.json" >/dev/null && return 0
    done
    return 1
}
have_layer() { compgen -G "/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json" >/dev/null; }

command -v cc >/dev/null || missing+=(gcc libc6-dev)
command -v pkg-config >/dev/null || missing+=(pkg-config)
pkg-config --exists libudev 2>/dev/null || missing+=(libudev-dev)
have_library libvulkan.so.1 || missing+=(libvulkan1)
have_driver || missing+=(mesa-vulkan-drivers)
have_library libxkbcommon-x11.so.0 || missing+=(libxkbcommon-x11-0)
for library in libXcursor.so.1:libxcursor1 libXi.so.6:libxi6 libXrandr.so.2:libxrandr2 libX11-xcb.so.1:libx11-xcb1; do
    have_library "${library%%:*}" || missing+=("${library##*:}")
done
if [ "$purpose" = test ]; then
    have_layer || missing+=(vulkan-validationlayers)
    command -v Xvfb >/dev/null || missing+=(xvfb)
    command -v weston >/dev/null || missing+=(weston)
fi

if ! command -v cargo >/dev/null && [ -x "$HOME/.cargo/bin/cargo" ]; then
    PATH="$HOME/.cargo/bin:$PATH"
fi
if ! command -v cargo >/dev/null; then
    echo "setup: cargo was not found; install Rust 1.95 or later from https://rustup.rs" >&2
    exit 1
fi
# Fails under rustup if the version in rust-toolchain.toml is neither installed nor can be downloaded.
if ! cargo --version >/dev/null; then
    echo "setup: cargo does not run; with rustup: rustup toolchain install" >&2
    exit 1
fi

if [ ${#missing[@]} -gt 0 ]; then
    if ! command -v apt-get >/dev/null; then
        cat >&2 <<MESSAGE
setup: this system has no apt-get. Please install the equivalents of: ${missing[*]}
  Fedora:     gcc pkgconf systemd-devel vulkan-loader mesa-vulkan-drivers libxkbcommon-x11 libXcursor libXi libXrandr libX11-xcb vulkan-validation-layers xorg-x11-server-Xvfb weston
  Arch:       gcc pkgconf systemd-libs vulkan-icd-loader vulkan-swrast libxkbcommon-x11 libxcursor libxi libxrandr libx11 vulkan-validation-layers xorg-server-xvfb weston
  openSUSE:   gcc pkg-config libudev-devel libvulkan1 libvulkan_lvp libxkbcommon-x11-0 libXcursor1 libXi6 libXrandr2 libX11-xcb1 vulkan-validationlayers xorg-x11-server-Xvfb weston
MESSAGE
        exit 1
    fi
    as_root=()
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null || { echo "setup: as root, run: apt-get install ${missing[*]}" >&2; exit 1; }
        as_root=(sudo)
    fi
    echo "setup: installing ${missing[*]}"
    "${as_root[@]}" apt-get update -q
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
fi
