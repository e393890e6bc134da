#!/usr/bin/env bash
# The program with a camera that is unplugged and plugged in again, without camera hardware: a virtual
# machine with a kernel of its own, a virtual camera with a moving test picture, an X server, the program
# and the example `camera` as built here.
#
#   tests/hardware/camera.sh [PROGRAM [EXAMPLE]]
#       default: target/debug/virtual-sculpture, target/debug/examples/camera
#
# machine.sh lists the environment variables. Logs and pictures are written to target/test-output/camera.
set -euo pipefail
. "$(dirname "$0")/machine.sh"
carry "$(realpath -m "${1:-$root/target/debug/virtual-sculpture}")" virtual-sculpture
carry "$(realpath -m "${2:-$root/target/debug/examples/camera}")" camera
export INPUT=''
run_in_machine camera-guest.sh camera
