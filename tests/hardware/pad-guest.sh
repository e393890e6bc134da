#!/bin/bash
# Runs in the virtual machine of pad.sh: starts X, the program and the pad, plays input, and checks the
# effects. Results are written to out/.
set -u
# In memory: two processes may see a file shared with the host differently.
share=$PWD out=/tmp/out
mkdir -p $out
trap 'cp -r $out "$share"' EXIT
export LC_ALL=C DISPLAY=:9 LD_LIBRARY_PATH=$PWD/lib HOME=/tmp RUST_LOG=virtual_sculpture=debug NO_COLOR=1
journal=$out/journal.sculpt log=$out/program.log felt=$out/felt.txt
cat >$out/config.toml <<'TOML'
[new]
dims = [32, 32, 32]
[render]
mode = "ray"
[window]
size = [640, 480]
guide = false
[gamepad]
rumble_limit = 0.5
rumble_voxels = 30
TOML

. guest.sh
pad() { printf '%s\n' "$@" >&7; }

Xvfb :9 -screen 0 640x480x24 >/dev/null 2>&1 &
for _ in $(seq 50); do [ -e /tmp/.X11-unix/X9 ] && break; sleep 0.2; done
program=$$
./virtual-sculpture --config $out/config.toml --record $journal 2>$log &
program=$!
touch $log
await 120 "first picture" said 1 'picture shown'
await 60 "rest without a pad" rests

mkfifo /tmp/pad
python3 virtual-gamepad.py </tmp/pad >$felt 2>&1 &
exec 7>/tmp/pad
await 30 "pad with rumble" said 1 'gamepad: .*rumble=true'
await 60 "rest with a pad" rests
picture 1-pad-connected

# The tool cuts along its path, and the pad rumbles.
pad 'press a' 'axis lx 0.8' 'sleep 2.5' 'axis lx 0' 'release a' 'wait-ff rumble 1'
await 60 "a stroke of several bites" wrote 3 '^subtract ellipsoid'
await 60 "end of the stroke" wrote 1 '^end'
[ "$(count '^begin')" = 1 ] || die "more than one stroke"
await 60 "rest after the stroke" rests
picture 2-after-the-stroke

pad 'axis dx -1' 'sleep 0.2' 'axis dx 0'
await 30 "undo by the cross" wrote 1 '^undo'

# The sculpture moves and rotates.
places=$(count '^place')
pad 'tap b 0.2'
await 30 "sculpture mode" said 1 'Sculpture mode'
pad 'axis rx 1' 'axis ly -0.6' 'sleep 1.5' 'axis rx 0' 'axis ly 0'
await 60 "moved and turned sculpture" wrote $((places + 3)) '^place'
await 60 "rest after moving" rests
picture 3-grid-moved

# The stick moves the pointer; a click on the sculpture uses the tool.
pad 'tap b 0.2'
await 30 "pointer mode" said 1 'Pointer mode'
strokes=$(count '^begin')
pad 'axis ly 0.5' 'sleep 0.3' 'axis ly 0' 'sleep 1' 'tap y 0.3'
await 60 "stroke by a click" wrote $((strokes + 1)) '^begin'
await 30 "rest after the click" rests
picture 4-clicked

# Unplugged in the middle of a stroke, and plugged in again.
pad 'tap b 0.2'
await 30 "tool mode" said 1 'Tool mode'
ends=$(count '^end')
pad 'press a' 'sleep 1' 'replug'
await 60 "end of the stroke of the pad that went" wrote $((ends + 1)) '^end'
await 30 "pad that went" said 1 'gamepad disconnected'
await 30 "pad that came back" said 2 'gamepad: .*rumble=true'
await 60 "rest after it came back" rests
bites=$(count '^subtract')
pad 'sleep 1' 'axis ly -1' 'press a' 'sleep 2' 'release a' 'axis ly 0'
await 60 "stroke of the pad that came back" wrote $((bites + 2)) '^subtract'
await 60 "rest at last" rests
picture 5-came-back

kill -0 $program || die "the program has ended"
pad 'quit'
exec 7>&-
await 30 "pad that went for good" said 2 'gamepad disconnected'
kill $program
wait $program 2>/dev/null
grep -E ' (WARN|ERROR) virtual_sculpture' $log && die "the program complained"
python3 pad-felt.py 0.5 <$felt || die "the pad felt something else"
say "done"
