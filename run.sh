#!/usr/bin/env bash
# Sets up, builds and runs Virtual Sculpture. Arguments go to the program. Without any it opens the
# window where there is a display, and otherwise renders the demo scene to files.
set -euo pipefail
cd "$(dirname "$0")"
PATH="$PATH:$HOME/.cargo/bin"
./setup.sh run
cargo build --release --locked
exec target/release/virtual-sculpture "$@"
