#!/usr/bin/env python3
"""Writes pillow.obj: two grids of 0.4 m x 0.4 m, sewn along their edges, 1 cm apart in the middle."""

from pathlib import Path

cells, size, height = 8, 0.4, 0.01


def main():
    number, lines = {}, []

    def vertex(i, j, side):
        seam = i in (0, cells) or j in (0, cells)
        key = (i, j, 0 if seam else side)
        if key not in number:
            number[key] = len(number) + 1
            bulge = 16 * i * (cells - i) * j * (cells - j) / cells**4
            lines.append(f"v {size * i / cells:.9g} {size * j / cells:.9g} {key[2] * height / 2 * bulge**0.5:.9g}")
        return number[key]

    faces = []
    for side in (1, -1):
        for i in range(cells):
            for j in range(cells):
                a, b, c, d = (vertex(*at, side) for at in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
                corner = (i, j) in ((cells - 1, 0), (0, cells - 1))
                middle = ((a, b, d), (b, c, d)) if (i + j) % 2 == 1 or corner else ((a, b, c), (a, c, d))
                faces += [f if side > 0 else f[::-1] for f in middle]
    lines += ["f %d %d %d" % f for f in faces]
    Path(__file__).with_name("pillow.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
