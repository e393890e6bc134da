#!/usr/bin/env bash
# Sets up and runs the tests. Arguments go to `cargo test`.
# The Vulkan tests run on any driver, with the validation layers; the window tests run on a virtual display. Pictures
# that the tests make are written to target/test-output.
set -euo pipefail
cd "$(dirname "$0")"
PATH="$PATH:$HOME/.cargo/bin"
./setup.sh test
export VS_REQUIRE_VALIDATION=1 VS_REQUIRE_WINDOW=1
cargo test --workspace --locked --no-fail-fast "$@"
