# Sourced by pad.sh, camera.sh and pen.sh: finds the virtual machine, or prints SKIPPED, and runs a script in it
# with the program as built here.
#
# VS_SHARED             folder with hardware/ (build-vm.sh, run-in-vm.sh, virtual-gamepad.py);
#                       default: ../shared
# VS_HARDWARE_VM        folder of a machine built by build-vm.sh; then no network is needed.
#                       Default: target/hardware-vm, built there once if the packages for it are available
# VS_REQUIRE_HARDWARE=1 fails where it would otherwise print SKIPPED
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
kit=$(realpath -m "${VS_SHARED:-$root/../shared}")/hardware
vm=${VS_HARDWARE_VM:-$root/target/hardware-vm}

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
    packages=$(sed -n 's/^PKGS=.*:-"\(.*\)"}$/\1/p' "$kit/build-vm.sh")
    # For pen.sh: Xvfb has no drivers.
    export PKGS="$packages xserver-xorg-core xserver-xorg-input-libinput xserver-xorg-video-dummy xinput"
    bash "$kit/build-vm.sh" "$vm" || skip "no machine in $vm, and making one failed"
fi

share=$(mktemp -d)
trap 'rm -rf "$share"' EXIT

# Copies PROGRAM into the machine, as NAME.
carry() {
    [ -x "$1" ] || { echo "no program at $1: build it first" >&2; exit 1; }
    cp "$1" "$share/$2"
}

# Runs SCRIPT, which writes its results to out/, and copies them to target/test-output/FOLDER.
run_in_machine() {
    local script=$1 out=$root/target/test-output/$2 code=0 library path
    # Libraries that winit loads by name and the machine lacks.
    mkdir "$share/lib"
    for library in libXcursor.so.1 libXfixes.so.3 libXrender.so.1 libxkbcommon.so.0 \
        libxkbcommon-x11.so.0 libxcb-xkb.so.1; do
        path=$(/sbin/ldconfig -p | awk -v name="$library" '$1 == name && /x86-64/ && !n++ { print $NF }')
        [ -n "$path" ] || skip "$library is not installed"
        cp -L "$path" "$share/lib/"
    done
    cp "$here/guest.sh" "$here/$script" "$share"
    BENCH=$vm LIMIT=${LIMIT:-400} bash "$kit/run-in-vm.sh" "$share" bash "$script" || code=$?
    [ "$code" != 77 ] || skip "the machine in $vm lacks programs; remove it, and it is made anew"
    mkdir -p "$out"
    cp -r "$share"/out/. "$out" 2>/dev/null || true
    if [ "$code" != 0 ]; then
        echo "FAILED ($code); output of the program:" >&2
        tail -40 "$out/program.log" >&2 || true
        exit 1
    fi
    echo "passed; see $out"
}
