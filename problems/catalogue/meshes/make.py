#!/usr/bin/env python3
"""Writes pillow.obj: two grids of 0.4 m x 0.4 m, sewn along their edges, 1 cm apart in the middle;
and bar.msh: a bar of 0.4 m x 6 cm x 6 cm in cubes of six tetrahedra each."""

from itertools import permutations, product
from pathlib import Path

cells, size, height = 8, 0.4, 0.01
bar_cells, bar_size = (20, 4, 4), (0.4, 0.06, 0.06)


def write_pillow():
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


def write_bar():
    nodes = [n[::-1] for n in product(*(range(count + 1) for count in bar_cells[::-1]))]  # the first axis runs fastest
    number = {node: k + 1 for k, node in enumerate(nodes)}
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes))]
    for k, (i, j, l) in enumerate(nodes):
        place = (i / bar_cells[0], j / bar_cells[1] - 0.5, l / bar_cells[2] - 0.5)
        lines.append(f"{k + 1} " + " ".join(f"{size * x:.9g}" for size, x in zip(bar_size, place)))
    cubes = product(*(range(count) for count in bar_cells))
    tetrahedra = []
    for cube in cubes:
        for order in permutations(range(3)):  # from corner to corner along the axes
            at, corners = list(cube), [number[cube]]
            for axis in order:
                at[axis] += 1
                corners.append(number[tuple(at)])
            if order in ((0, 2, 1), (2, 1, 0), (1, 0, 2)):
                corners[2:] = corners[:1:-1]
            tetrahedra.append(corners)
    lines += ["$EndNodes", "$Elements", str(len(tetrahedra))]
    lines += [f"{k + 1} 4 2 0 1 " + " ".join(map(str, corners)) for k, corners in enumerate(tetrahedra)]
    Path(__file__).with_name("bar.msh").write_text("\n".join(lines + ["$EndElements"]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write_pillow()
    write_bar()
