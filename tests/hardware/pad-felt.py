"""Reads what virtual-gamepad.py has written on stdin and checks it: rumble came, of both motors,
never above the limit given as the first argument, anew after the pad was put back, and each time
it ended in stillness."""
import re
import sys

limit = float(sys.argv[1]) * 65535
# A change of the rumble: seconds, strength of both motors. A new device begins a new list.
devices = []
for line in sys.stdin:
    print(line, end="")
    if " device " in line:
        devices.append([])
    found = re.match(r" *([\d.]+) FF upload .* strong=(\d+) weak=(\d+) length=(\d+)", line)
    if found and devices:
        seconds, strong, weak, length = float(found[1]), *map(int, found.groups()[1:])
        devices[-1].append((seconds, strong, weak))
        # Created without a length, it gets one before it is played.
        assert length <= 200 and (length or not strong), f"an effect of {length} ms goes on"
assert len(devices) == 2, f"{len(devices)} devices"
for number, felt in enumerate(devices, 1):
    strongest = max((strong for _, strong, _ in felt), default=0)
    weakest = max((weak for _, _, weak in felt), default=0)
    print(f"device {number}: {len(felt)} changes, at most strong {strongest}, weak {weakest}")
    assert strongest > 0 and weakest > 0, "no rumble"
    assert strongest <= limit and weakest <= limit, f"over the limit of {limit:.0f}"
assert devices[-1][-1][1:] == (0, 0), "it goes on at the end"
