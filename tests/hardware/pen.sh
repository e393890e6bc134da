#!/usr/bin/env bash
# The program with a graphics tablet, without tablet hardware: a virtual machine with a kernel of its own, a virtual
# tablet whose pen has pressure, tilt, an eraser and two buttons, an X server with its driver for tablets (libinput) and
# the program as built here.
#
#   tests/hardware/pen.sh [PROGRAM]      default: target/debug/virtual-sculpture
#
# machine.sh lists the environment variables. Logs, recordings and pictures are written to target/test-output/pen.
set -euo pipefail
. "$(dirname "$0")/machine.sh"
carry "$(realpath -m "${1:-$root/target/debug/virtual-sculpture}")" virtual-sculpture
cp "$here/virtual-tablet.py" "$share"
export VIVID='' LIMIT=${LIMIT:-900}
run_in_machine pen-guest.sh pen
