#!/usr/bin/env python3
"""Drives Virtual Sculpture through a pipe: builds a spiral stair and saves it.

    python3 examples/drive.py virtual-sculpture stair.vsc

`virtual-sculpture run -` reads a command from each line of standard input and answers each with a line of
JSON: whether it was done ("ok"), why not ("error"), the size in voxels ("dims") and how many of them exist
("voxels"). `virtual-sculpture commands` lists the commands.
"""

import json
import math
import subprocess
import sys


class Sculpture:
    """A running program; as a context manager it ends with the block."""

    def __init__(self, program="virtual-sculpture", *arguments):
        self.process = subprocess.Popen(
            [program, "run", "-", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            encoding="utf-8",
        )

    def do(self, command):
        """Executes a command and returns the answer; raises ValueError if it was refused."""
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError("the program has ended; it says why above")
        answer = json.loads(line)
        if not answer["ok"]:
            raise ValueError(f"{command}: {answer['error']}")
        return answer

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait()


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, file = sys.argv[1:]
    with Sculpture(program) as sculpture:
        sculpture.do("new dims=96,128,96 colour=24 base=#d0c8b8 fill=empty")
        # One stroke, so that one undo takes the whole stair back.
        sculpture.do('begin "stair"')
        sculpture.do("add cuboid at=48,60,48 half=6,60,6 colour=#8a5a3c")
        for step in range(30):
            angle = math.radians(24 * step)
            x, z = 48 + 24 * math.cos(angle), 48 - 24 * math.sin(angle)
            turn = math.degrees(angle)
            sculpture.do(f"add cuboid at={x:.3f},{4 * step + 2},{z:.3f} half=20,2,7 turn=0,{turn:.1f},0")
        answer = sculpture.do("end")
        width, height, depth = answer["dims"]
        print(f"{answer['voxels']} of {width * height * depth} voxels")
        quoted = file.replace("\\", "\\\\").replace('"', '\\"')
        sculpture.do(f'save e"{quoted}"')


if __name__ == "__main__":
    main()
