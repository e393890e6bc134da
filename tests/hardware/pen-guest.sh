#!/bin/bash
# Runs in the virtual machine of pen.sh: starts X, the tablet and the program, draws with the pen, and checks the effects.
# Results are written to out/. Ends with 77 where the machine has no X server for tablets.
set -u
command -v Xorg >/dev/null || exit 77
# In memory: two processes may see a file shared with the host differently.
share=$PWD out=/tmp/out
mkdir -p $out
trap 'cp -r $out "$share"' EXIT
export LC_ALL=C DISPLAY=:9 HOME=/tmp RUST_LOG=virtual_sculpture=debug NO_COLOR=1
journal=$out/journal.sculpt log=$out/program.log
cat >$out/config.toml <<'TOML'
[new]
dims = [32, 32, 32]
[render]
mode = "ray"
refine = false
[window]
size = [640, 480]
guide = false
TOML
mkdir -p /tmp/.config/virtual-sculpture
cat >/tmp/.config/virtual-sculpture/bindings.toml <<'TOML'
extends = "direct"
[bindings]
devourer = ["d", "pen-lower"]
undo = ["ctrl+z", "pen-upper"]
turn-sculpture = ["right"]
pan-sculpture = ["middle"]
TOML
cat >/tmp/xorg.conf <<'CONF'
Section "Device"
    Identifier "device"
    Driver "dummy"
    VideoRam 16000
EndSection
Section "Monitor"
    Identifier "monitor"
    HorizSync 5.0-1000.0
    VertRefresh 5.0-200.0
    Modeline "640x480" 23.86 640 656 720 800 480 481 484 497
EndSection
Section "Screen"
    Identifier "screen"
    Device "device"
    Monitor "monitor"
    DefaultDepth 24
    SubSection "Display"
        Depth 24
        Modes "640x480"
        Virtual 640 480
    EndSubSection
EndSection
CONF

. guest.sh
# Longest wait for what the program does, in seconds: it draws a picture in seconds.
PATIENCE=180
pen() { printf '%s\n' "$@" >&7; }
# Pixels in the middle, where the sculpture is, that differ between two pictures.
differ() { compare -metric AE -extract 240x200+200+140 "$out/$1.png" "$out/$2.png" null: 2>&1 | cut -d' ' -f1; }

Xorg :9 -config /tmp/xorg.conf -logfile $out/Xorg.log -noreset -nolisten tcp -novtswitch -sharevts vt7 >$out/Xorg.out 2>&1 &
program=$!
is_there() { [ -e /tmp/.X11-unix/X9 ]; }
await 60 "X server" is_there
mkfifo /tmp/pen
python3 virtual-tablet.py </tmp/pen >$out/tablet.log 2>&1 &
exec 7>/tmp/pen
has() { xinput list --name-only | grep -q "$1"; }
await 60 "tablet in X" has 'Virtual Tablet'
# X makes a device of each end of the pen when it first comes near.
pen 'hover 0.1 0.9' 'sleep 1' 'away' 'eraser' 'hover 0.1 0.9' 'sleep 1' 'away' 'pen'
await 30 "pen in X" has 'Virtual Tablet Pen'
await 30 "eraser in X" has 'Virtual Tablet Eraser'
xinput list --long >$out/devices.txt

export LD_LIBRARY_PATH=$PWD/lib
./virtual-sculpture doctor >$out/doctor.txt
grep -q 'Virtual Tablet Pen.*(X11)' $out/doctor.txt || die "the doctor knows no pen: $(grep -i tablet $out/doctor.txt)"
./virtual-sculpture --config $out/config.toml --record $journal 2>$log &
program=$!
touch $log
await $PATIENCE "first picture" said 1 'picture shown'
await $PATIENCE "pens in the program" said 1 'pens: \["Virtual Tablet Pen'
await $PATIENCE "rest without the pen" rests
picture 1-begin

# The pen hovers, and the tool is shown under it.
pen 'hover 0.42 0.5'
await $PATIENCE "rest under the pen" rests
picture 2-hover
[ "$(differ 1-begin 2-hover)" -gt 100 ] || die "the tool is not shown under the pen"
say "ok: the tool is shown under the pen"

# A stroke with this pressure from left to right, each point with a picture of its own.
stroke() {
    local before=$(count '^end') x
    pen "hover 0.42 0.5"
    await $PATIENCE "rest before the stroke" rests
    pen "touch $1"
    for x in 0.44 0.46 0.48 0.50 0.52; do
        await $PATIENCE "rest at $x" rests
        pen "move $x 0.5"
    done
    await $PATIENCE "rest at the end" rests
    pen 'lift'
    await $PATIENCE "stroke with pressure $1" wrote $((before + 1)) '^end'
    await $PATIENCE "rest after the stroke" rests
    cp $journal $out/after-$2.sculpt
    picture $2
}
# A click of a button of the barrel that undoes the last stroke.
undo() {
    local before=$(count '^undo')
    pen 'upper'
    await $PATIENCE "undo by the pen" wrote $((before + 1)) '^undo'
    await $PATIENCE "rest after the undo" rests
}
pen 'lower'
await $PATIENCE "rest with the devourer" rests
stroke 0.5 half
undo
stroke 1.0 full
# A full block takes nothing more: the eraser goes over the furrow.
pen 'away' 'eraser'
stroke 1.0 eraser
pen 'away' 'pen'

# Voxels that a recording leaves.
voxels() {
    ./virtual-sculpture run - <$out/after-$1.sculpt 2>>$out/replay.log |
        python3 -c 'import json, sys; print([json.loads(line) for line in sys.stdin][-1]["voxels"])'
}
begin=$((32 * 32 * 32)) after_full=$(voxels full)
full=$((begin - after_full)) half=$((begin - $(voxels half))) eraser=$(($(voxels eraser) - after_full))
say "voxels that full pressure cuts: $full; half: $half; voxels that the eraser adds: $eraser"
[ "$half" -gt 0 ] || die "half the pressure does nothing"
[ $((4 * half)) -lt $((3 * full)) ] || die "the furrow of half the pressure is as deep"
[ "$eraser" -gt 0 ] || die "the eraser does not put back"

kill -0 $program || die "the program has ended"
pen 'quit'
exec 7>&-
await $PATIENCE "tablet that went" said 1 'pens: \[\]'
kill $program
wait $program 2>/dev/null
grep -E ' (WARN|ERROR) virtual_sculpture' $log && die "the program complained"
say "done"
