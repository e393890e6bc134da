#!/usr/bin/env bash
# The program with a gamepad, without gamepad hardware: a virtual machine with a kernel of its own, a
# virtual Xbox pad with rumble, an X server and the program as built here.
#
#   tests/hardware/pad.sh [PROGRAM]      default: target/debug/virtual-sculpture
#
# machine.sh lists the environment variables. Log, journal, rumble and pictures are written to
# target/test-output/hardware.
set -euo pipefail
. "$(dirname "$0")/machine.sh"
carry "$(realpath -m "${1:-$root/target/debug/virtual-sculpture}")" virtual-sculpture
cp "$kit/virtual-gamepad.py" "$here/pad-felt.py" "$share"
export VIVID=''
run_in_machine pad-guest.sh hardware
