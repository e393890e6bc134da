#!/usr/bin/env bash
# Sets up, builds and runs Virtual Sculpture. Arguments go to the program. Without arguments it opens the window, or
# renders the demo scene to files if there is no display.
set -euo pipefail
cd "$(dirname "$0")"
PATH="$PATH:$HOME/.cargo/bin"
./setup.sh run
cargo build --release --locked
[ $# -gt 0 ] || set -- --or-demo
exec target/release/virtual-sculpture "$@"
