#!/usr/bin/env python3
"""A graphics tablet with a pen, made with uinput, that does what standard input says.

A line is a command; places are shares of the tablet, 0 to 1, and pressure is a share of what it can feel:

    hover X Y         the pen comes near, or moves without touching
    touch P           the tip touches with pressure P
    move X Y [P]      the pen moves, and presses as before or with P
    lift              the tip touches no more
    away              the pen leaves
    pen | eraser      the end that comes near next
    tilt DEG_X DEG_Y  how it leans
    lower | upper     a click of a button of the barrel
    sleep S
    quit
"""

import sys
import time

from evdev import AbsInfo, UInput, ecodes as e

SIDE_X, SIDE_Y, PRESSURE = 20000, 15000, 2047
# Units in a millimetre, and in a radian.
PER_MM, PER_RAD = 100, 57
MOST_TILT_DEG = 60


def axis(low, high, resolution):
    return AbsInfo(value=0, min=low, max=high, fuzz=0, flat=0, resolution=resolution)


class Tablet:
    def __init__(self):
        tilt = axis(-MOST_TILT_DEG, MOST_TILT_DEG, PER_RAD)
        keys = [e.BTN_TOOL_PEN, e.BTN_TOOL_RUBBER, e.BTN_TOUCH, e.BTN_STYLUS, e.BTN_STYLUS2]
        axes = [
            (e.ABS_X, axis(0, SIDE_X, PER_MM)),
            (e.ABS_Y, axis(0, SIDE_Y, PER_MM)),
            (e.ABS_PRESSURE, axis(0, PRESSURE, 0)),
            (e.ABS_TILT_X, tilt),
            (e.ABS_TILT_Y, tilt),
        ]
        self.device = UInput(
            {e.EV_KEY: keys, e.EV_ABS: axes}, name="Virtual Tablet", vendor=0x1209, product=0x0001
        )
        self.end, self.is_near = e.BTN_TOOL_PEN, False

    def place(self, x, y):
        self.device.write(e.EV_ABS, e.ABS_X, round(float(x) * SIDE_X))
        self.device.write(e.EV_ABS, e.ABS_Y, round(float(y) * SIDE_Y))

    def press(self, pressure):
        self.device.write(e.EV_ABS, e.ABS_PRESSURE, round(float(pressure) * PRESSURE))

    def do(self, word, *values):
        device = self.device
        if word in ("pen", "eraser"):
            self.end = e.BTN_TOOL_PEN if word == "pen" else e.BTN_TOOL_RUBBER
        elif word == "hover":
            self.place(*values)
            if not self.is_near:
                device.write(e.EV_KEY, self.end, 1)
                self.is_near = True
        elif word == "touch":
            self.press(values[0])
            device.write(e.EV_KEY, e.BTN_TOUCH, 1)
        elif word == "move":
            self.place(*values[:2])
            for pressure in values[2:]:
                self.press(pressure)
        elif word == "lift":
            self.press(0)
            device.write(e.EV_KEY, e.BTN_TOUCH, 0)
        elif word == "away":
            device.write(e.EV_KEY, self.end, 0)
            self.is_near = False
        elif word == "tilt":
            device.write(e.EV_ABS, e.ABS_TILT_X, int(values[0]))
            device.write(e.EV_ABS, e.ABS_TILT_Y, int(values[1]))
        elif word in ("lower", "upper"):
            button = e.BTN_STYLUS if word == "lower" else e.BTN_STYLUS2
            device.write(e.EV_KEY, button, 1)
            device.syn()
            time.sleep(0.2)
            device.write(e.EV_KEY, button, 0)
        elif word == "sleep":
            time.sleep(float(values[0]))
        else:
            raise ValueError(f"unknown command: {word}")
        device.syn()


def main():
    tablet = Tablet()
    print("ready", flush=True)
    for line in sys.stdin:
        words = line.split()
        if words == ["quit"]:
            break
        tablet.do(*words)
        print(line.strip(), flush=True)
    tablet.device.close()


main()
