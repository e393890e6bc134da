#!/usr/bin/env bash
# The program with a gamepad, without either at hand: a virtual machine with a kernel of its own,
# in it a virtual Xbox pad with rumble, an X server and the program as it was built here.
#
#   tests/hardware/pad.sh [PROGRAM]      default: target/debug/virtual-sculpture
#
# VS_SHARED             folder with hardware/ (build-vm.sh, run-in-vm.sh, virtual-gamepad.py);
#                       default: ../shared
# VS_HARDWARE_VM        folder of a machine that build-vm.sh has made; no network is needed then.
#                       Default: target/hardware-vm, made there once if the packages for it are here
# VS_REQUIRE_HARDWARE=1 fails where it would otherwise say SKIPPED
#
# Log, journal, what the pad felt and pictures are left in target/test-output/hardware.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
program=$(realpath -m "${1:-$root/target/debug/virtual-sculpture}")
kit=$(realpath -m "${VS_SHARED:-$root/../shared}")/hardware
vm=${VS_HARDWARE_VM:-$root/target/hardware-vm}
out=$root/target/test-output/hardware

skip() {
    if [ "${VS_REQUIRE_HARDWARE:-}" = 1 ]; then
        echo "VS_REQUIRE_HARDWARE=1, but $*" >&2
        exit 1
    fi
    echo "SKIPPED: $*"
    exit 0
}

[ "$(uname -s)-$(uname -m)" = Linux-x86_64 ] || skip "the virtual machine is for Linux on x86-64"
[ -f "$kit/run-in-vm.sh" ] || skip "there is no $kit"
command -v qemu-system-x86_64 >/dev/null || skip "qemu-system-x86 is not installed"
if [ ! -f "$vm/vmlinuz" ] || [ ! -f "$vm/initrd.gz" ]; then
    [ -z "${VS_HARDWARE_VM:-}" ] || skip "there is no machine in VS_HARDWARE_VM=$vm"
    for tool in debootstrap cpio mke2fs; do
        command -v "$tool" >/dev/null || skip "no machine in $vm, and $tool to make one is not installed"
    done
    [ "$(id -u)" = 0 ] || skip "no machine in $vm, and only root can make one"
    bash "$kit/build-vm.sh" "$vm" || skip "no machine in $vm, and making one failed"
fi
[ -x "$program" ] || { echo "no program at $program: build it first" >&2; exit 1; }

share=$(mktemp -d)
trap 'rm -rf "$share"' EXIT
cp "$program" "$share/virtual-sculpture"
cp "$kit/virtual-gamepad.py" "$here/pad-guest.sh" "$here/pad-felt.py" "$share"
# Libraries that winit loads by name and the machine lacks.
mkdir "$share/lib"
for library in libXcursor.so.1 libXfixes.so.3 libXrender.so.1 libxkbcommon.so.0 \
    libxkbcommon-x11.so.0 libxcb-xkb.so.1; do
    path=$(/sbin/ldconfig -p | awk -v name="$library" '$1 == name && /x86-64/ && !n++ { print $NF }')
    [ -n "$path" ] || skip "$library is not installed"
    cp -L "$path" "$share/lib/"
done

code=0
BENCH=$vm VIVID='' LIMIT=${LIMIT:-400} bash "$kit/run-in-vm.sh" "$share" bash pad-guest.sh || code=$?
mkdir -p "$out"
cp -r "$share"/out/. "$out" 2>/dev/null || true
if [ "$code" != 0 ]; then
    echo "FAILED ($code); what the program said:" >&2
    tail -40 "$out/program.log" >&2 || true
    exit 1
fi
echo "passed; see $out"
