#!/usr/bin/env bash
# The program with a gamepad, without either at hand: a virtual machine with a kernel of its own,
# in it a virtual Xbox pad with rumble, an X server and the program as it was built here.
#
#   tests/hardware/pad.sh [PROGRAM]      default: target/debug/virtual-sculpture
#
# machine.sh says what the environment may hold. Log, journal, what the pad felt and pictures are
# left in target/test-output/hardware.
set -euo pipefail
. "$(dirname "$0")/machine.sh"
carry "$(realpath -m "${1:-$root/target/debug/virtual-sculpture}")" virtual-sculpture
cp "$kit/virtual-gamepad.py" "$here/pad-felt.py" "$share"
export VIVID=''
run_in_machine pad-guest.sh hardware
