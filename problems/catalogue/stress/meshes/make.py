#!/usr/bin/env python3
"""Writes the starting states of the atlas of failure: sheets of 4 x 4 cells that lie flat, 1 m x 1 m, in their texture
coordinates (the rest shape) and elsewhere in their vertices."""

import math
import random
from pathlib import Path

CELLS = 4
FLAT = [(i / CELLS, j / CELLS) for j in range(CELLS + 1) for i in range(CELLS + 1)]


def write(name, place):
    lines = ["# Written by make.py"]
    lines += ["v {:.17g} {:.17g} {:.17g}".format(*place(k, x, y)) for k, (x, y) in enumerate(FLAT)]
    lines += [f"vt {x:g} {y:g}" for x, y in FLAT]
    for j in range(CELLS):
        for i in range(CELLS):
            a = j * (CELLS + 1) + i + 1
            b, c, d = a + 1, a + CELLS + 1, a + CELLS + 2
            pair = [(a, b, d), (a, d, c)] if (i + j) % 2 == 0 else [(a, b, c), (b, d, c)]
            lines += ["f " + " ".join(f"{v}/{v}" for v in triangle) for triangle in pair]
    Path(__file__).with_name(name + ".obj").write_text("\n".join(lines) + "\n")


def moved(amplitude):
    noise = random.Random(1)
    offsets = [[noise.uniform(-amplitude, amplitude) for _ in range(3)] for _ in FLAT]
    pins = {len(FLAT) - 1, len(FLAT) - 1 - CELLS}
    return lambda k, x, y: (x, y, 0) if k in pins else (x + offsets[k][0], y + offsets[k][1], offsets[k][2])


def folded(degrees):
    """The half y < 0.5 turned about y = 0.5."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if degrees == 180:
        c, s = -1, 0
    return lambda k, x, y: (x, 0.5 + c * (y - 0.5), s * (y - 0.5)) if y < 0.5 else (x, y, 0)


def squashed(factor):
    """The upper edge, where the pins are, stays."""
    return lambda k, x, y: (x, 1 + factor * (y - 1), 0)


def inverted(cells):
    """The middle vertex pushed along x in the plane, beyond its neighbour from 1 on."""
    return lambda k, x, y: (x + cells / CELLS if k == len(FLAT) // 2 else x, y, 0)


for amplitude in ("0.01", "0.1", "0.3", "1", "10"):
    write("random_" + amplitude, moved(float(amplitude)))
for degrees in (90, 150, 175, 179, 180):
    write(f"folded_{degrees}", folded(degrees))
for factor in ("0.1", "1e-3", "1e-6", "1e-12", "0"):
    write("squashed_" + factor, squashed(float(factor)))
for cells in ("0.5", "0.9", "1", "1.1", "2"):
    write("inverted_" + cells, inverted(float(cells)))
write("not_a_number", lambda k, x, y: (x, y, math.nan if k == 0 else 0))
