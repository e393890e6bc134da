#!/bin/bash
# Runs in the virtual machine of camera.sh: first the example, which prints every frame and every change
# of the camera's state, then the program, whose pictures are compared. Results are written to out/.
set -u
# In memory: two processes may see a file shared with the host differently.
share=$PWD out=/tmp/out
mkdir -p $out/frames
trap 'cp -r $out "$share"' EXIT
export LC_ALL=C DISPLAY=:9 LD_LIBRARY_PATH=$PWD/lib HOME=/tmp RUST_LOG=virtual_sculpture=debug NO_COLOR=1
frames=$out/frames.log log=$out/program.log
driver=/sys/bus/platform/drivers/vivid camera=vivid.0
source='v4l2:/dev/video0?size=320x180'
cat >$out/config.toml <<TOML
[new]
dims = [8, 8, 8]
[render]
mode = "ray"
[window]
size = [640, 400]
guide = false
[video]
on = true
source = "$source"
TOML

. guest.sh
unplug() { echo $camera >$driver/unbind; }
plug() { echo $camera >$driver/bind; }

# The example.
./camera >$out/cameras.txt || die "cameras are not listed"
cat $out/cameras.txt
grep -q "^v4l2:/dev/video0  vivid" $out/cameras.txt || die "the camera is not listed"
grep -q "YUYV 320 x 180" $out/cameras.txt || die "its modes are not listed"
./virtual-sculpture doctor | grep -q "^cameras: v4l2:/dev/video0 vivid" || die "the doctor knows no camera"
./camera "$source" 100000 $out/frames >$frames 2>&1 &
program=$!
await 30 "frames" said 5 ': frame ' $frames
unplug
await 30 "notice of a camera that went" said 1 '^lost: ' $frames
sleep 2
before=$(count ': frame ' $frames)
sleep 2
[ "$(count ': frame ' $frames)" = "$before" ] || die "frames without a camera"
plug
await 30 "frames of a camera that came back" said $((before + 5)) ': frame ' $frames
said 2 '^live ' $frames || die "no notice of a camera that came back"
kill $program
cp "$(ls -t $out/frames/*.png | sed -n 2p)" $out/frame.png
rm -r $out/frames

# The program.
# The part of the picture in which the video shows a running clock.
clock=140x40+75+72
# Pixels of the clock that differ between two pictures.
differ() { compare -metric AE -extract $clock "$out/$1.png" "$out/$2.png" null: 2>&1; }
# The video moves within some seconds.
moves() {
    picture $1
    for _ in $(seq 20); do
        sleep 0.5
        picture $2
        [ "$(differ $1 $2 | cut -d' ' -f1)" != 0 ] && return
    done
    return 1
}
Xvfb :9 -screen 0 640x400x24 >/dev/null 2>&1 &
for _ in $(seq 50); do [ -e /tmp/.X11-unix/X9 ] && break; sleep 0.2; done
./virtual-sculpture --config $out/config.toml 2>$log &
program=$!
touch $log
await 120 "first picture" said 1 'picture shown' $log
await 60 "video behind the sculpture" moves 1-video 2-video-later
unplug
sleep 4
picture 3-unplugged
sleep 3
picture 4-unplugged-later
[ "$(differ 3-unplugged 4-unplugged-later | cut -d' ' -f1)" = 0 ] || die "the last picture does not stay"
say "ok: the last picture stays"
convert $out/4-unplugged-later.png -crop $clock -format '%[fx:standard_deviation>0.02]' info: |
    grep -q 1 || die "it is no picture"
plug
await 60 "video of a camera that came back" moves 5-plugged 6-plugged-later
kill -0 $program || die "the program has ended"
kill $program
wait $program 2>/dev/null
grep -E ' (WARN|ERROR) virtual_sculpture' $log
say "done"
