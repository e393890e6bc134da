#!/usr/bin/env bash
# Checks that program and tests compile for Windows, with Debian's Rust: its source package allows to build the
# standard library for any target. Prints SKIPPED where that is not available (an error if VS_REQUIRE_MINGW is set).
# Takes some six minutes the first time; the target folder is kept in the cache folder, so later runs take seconds.
# Arguments go to `cargo check`.
set -euo pipefail
cd "$(dirname "$0")"
target=x86_64-pc-windows-gnu
packages=(rustc-web cargo-web rust-web-src gcc-mingw-w64-x86-64-win32)

skip() {
    echo "SKIPPED: the check for Windows: $*" >&2
    [ -z "${VS_REQUIRE_MINGW:-}" ]
    exit
}

command -v apt-get >/dev/null || skip "it needs Debian's packages ${packages[*]}"
missing=()
for package in "${packages[@]}"; do
    dpkg -s "$package" >/dev/null 2>&1 || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
    as_root=()
    if [ "$(id -u)" != 0 ]; then
        sudo -n true 2>/dev/null || skip "as root, run: apt-get install ${missing[*]}"
        as_root=(sudo)
    fi
    apt-cache show "${missing[@]}" >/dev/null 2>&1 || "${as_root[@]}" apt-get update -q || true
    apt-cache show "${missing[@]}" >/dev/null 2>&1 || skip "this system has no ${missing[*]}"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -q --no-install-recommends "${missing[@]}"
fi

# Debian's toolchain, whatever else is installed. A stable compiler builds the standard library only with
# RUSTC_BOOTSTRAP.
export RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1
export CARGO_TARGET_DIR="${XDG_CACHE_HOME:-$HOME/.cache}/virtual-sculpture/check-windows"
# The API layers of the tests are for Linux only.
exec /usr/bin/cargo check -Zbuild-std=std,test,panic_abort --target "$target" --locked \
    --workspace --exclude openxr-blend-layer \
    --exclude vulkan-fault-layer --lib --bins --tests --examples "$@"
