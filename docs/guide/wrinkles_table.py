"""What wrinkles cost and buy: the table and the pictures of wrinkles.md.

    python3 docs/guide/wrinkles_table.py build/release/taut DIR

solves `quilt` at ratios 1 to 16, and with a shell as fine as the cover of ratio 8, keeps the runs in DIR (those that are
there are read, not repeated), prints the table and writes docs/images/wrinkles_*.svg. Some minutes.
"""

import json
import math
import os
import resource
import subprocess
import sys
from pathlib import Path

COARSE = 8  # cells of the shell, along and across
STEPS = 15
# Cells of the shell, refinements, and the foundation's stiffness, which is E/t of the layer under the cover, or 0.
RUNS = {
    "1": (8, 0, 0), "2": (8, 1, 0), "4": (8, 2, 0), "8": (8, 3, 0), "16": (8, 4, 0),
    "8_foundation": (8, 3, 2.5e5), "full": (64, 0, 0),
}
DRAWN = "2", "8", "8_foundation", "full"
ROOT = Path(__file__).resolve().parent.parent.parent
IMAGES = ROOT / "docs/images"


def solve(taut, folder, cells, levels, foundation):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    more = ["--set", f'bodies.quilt.cover.foundation={{"stiffness": {foundation}}}'] if foundation else []
    subprocess.run([taut, "solve", ROOT / "problems/catalogue/quilt.json", "--out", folder, "--format", "obj", "--threads", "1", "--quiet",
                    "--set", f"bodies.quilt.mesh.grid.cells=[{cells},{cells}]",
                    "--set", f"bodies.quilt.cover.mesh.refine={levels}", "--set", f"time.steps={STEPS}",
                    "--set", "output.pictures=0", *more])
    (folder / "user_seconds").write_text(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before))


def vertices(frame, count):
    """The last `count` vertices of an OBJ file, which are the cover's."""
    lines = [line.split()[1:4] for line in frame.read_text().splitlines() if line.startswith("v ")]
    return [tuple(map(float, line)) for line in lines[-count:]]


def cover(folder, cells):
    """The cover after STEPS steps: for each of x, y and z a matrix of places on the grid at rest."""
    rest, end = (vertices(folder / f"frames/quilt_{step:05}.obj", (cells + 1) ** 2) for step in (0, STEPS))
    at = {(round(r[0] * cells), round(r[1] * cells)): p for r, p in zip(rest, end)}
    places = range(cells + 1)
    return [[[at[i, j][axis] for j in places] for i in places] for axis in range(3)]


def product(a, b):
    columns = list(zip(*b))
    return [[sum(map(lambda p, q: p * q, row, column)) for column in columns] for row in a]


def transposed(a):
    return [list(column) for column in zip(*a)]


def solved(a, b):
    """a^-1 b, by elimination; a is positive definite."""
    a = [list(row) + list(right) for row, right in zip(a, b)]
    for k, pivot in enumerate(a):
        pivot[:] = [value / pivot[k] for value in pivot]
        for row in a[:k] + a[k + 1 :]:
            row[:] = [value - row[k] * other for value, other in zip(row, pivot)]
    return [row[len(a) :] for row in a]


def smooth(grid):
    """The best approximation by bilinear functions on the coarse grid: what a coarse mesh can see."""
    cells = len(grid[0]) - 1
    hats = [[max(0.0, 1 - abs(i * COARSE / cells - k)) for k in range(COARSE + 1)] for i in range(cells + 1)]
    fit = solved(product(transposed(hats), hats), transposed(hats))
    return [product(product(hats, product(product(fit, g), transposed(fit))), transposed(hats)) for g in grid]


def minus(a, b):
    return [[[p - q for p, q in zip(*rows)] for rows in zip(*pair)] for pair in zip(a, b)]


def size(grid):
    """Root mean square of the vectors."""
    return math.sqrt(sum(v * v for g in grid for row in g for v in row) / sum(map(len, grid[0])))


def wrinkles(grid):
    """Root mean square of what a coarse mesh cannot see, m, and its mean wavelength, 2 pi |w| / |grad w|, m."""
    w, cells = minus(grid, smooth(grid)), len(grid[0]) - 1
    along = [[[cells * (q - p) for p, q in zip(row, row[1:])] for row in g] for g in w]
    across = [[[cells * (q - p) for p, q in zip(*rows)] for rows in zip(g, g[1:])] for g in w]
    return size(w), 2 * math.pi * size(w) / math.hypot(size(along), size(across))


def thinned(grid, cells):
    step = (len(grid[0]) - 1) // cells
    return [[row[::step] for row in g[::step]] for g in grid]


def distance(a, b):
    """Root mean square over the places that both grids have, m."""
    common = min(len(a[0]), len(b[0])) - 1
    return size(minus(thinned(a, common), thinned(b, common)))


def picture(name, grid):
    """The cover from above and in front, shaded by the slope of its wrinkles."""
    cells = min(64, len(grid[0]) - 1)
    w, (px, py, pz) = (thinned(g, cells) for g in (minus(grid, smooth(grid)), grid))
    w, places = w[2], range(cells + 1)
    x = [[round(280 * (px[i][j] + 0.35 * py[i][j])) + 5 for j in places] for i in places]
    y = [[round(280 * (0.5 - 0.5 * py[i][j] - pz[i][j])) + 5 for j in places] for i in places]
    quads = {}
    for j in reversed(range(cells)):
        for i in range(cells):
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            rise = (w[i + 1][j] - w[i][j] + w[i + 1][j + 1] - w[i][j + 1]) * cells / 2
            grey = 16 * min(15, max(3, int(10 + 20 * rise)))
            turn = zip(corners, corners[1:])
            path = " ".join(f"{x[k][l] - x[m][n]} {y[k][l] - y[m][n]}" for (m, n), (k, l) in turn)
            quads.setdefault(j, []).append((grey, f"M{x[i][j]} {y[i][j]}l{path}z"))
    body = []
    for row in quads.values():
        for grey in sorted({g for g, _ in row}):
            path = "".join(d for g, d in row if g == grey)
            colour = f"#{grey:02x}{grey:02x}{min(255, grey + 16):02x}"
            body.append(f'<path fill="{colour}" stroke="{colour}" stroke-width=".6" d="{path}"/>')
    width, height = (max(map(max, v)) + 5 for v in (x, y))
    (IMAGES / f"wrinkles_{name}.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">' + "".join(body) + "</svg>\n")


def main():
    taut, folder = os.path.abspath(sys.argv[1]), Path(sys.argv[2])
    covers = {}
    for name, (cells, levels, foundation) in RUNS.items():
        run = folder / name
        if not (run / "steps.jsonl").exists():
            solve(taut, run, cells, levels, foundation)
        covers[name] = cover(run, cells << levels)
    print("| ratio | unknowns | steps solved | Newton systems | user s | RMS distance, mm | seen by the shell, mm "
          "| wrinkles, mm | wavelength, mm |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, (cells, levels, _) in RUNS.items():
        grid = covers[name]
        lines = (folder / name / "steps.jsonl").read_text().splitlines()[:STEPS]
        steps = [json.loads(line) for line in lines]
        solved_steps = sum(step["status"] == "solved" for step in steps)
        systems = sum(step["counts"]["linear_solves"] for step in steps)
        unknowns = 3 * (3 * (cells + 1) ** 2 + ((cells << levels) + 1) ** 2)
        seconds = float((folder / name / "user_seconds").read_text())
        height, length = (f"{1e3 * v:.3g}" for v in wrinkles(grid)) if name != "1" else ("", "")
        pairs = (grid, covers["full"]), (smooth(grid), smooth(covers["full"]))
        apart = ["" if name == "full" else f"{1e3 * distance(*pair):.2f}" for pair in pairs]
        print(f"| {name} | {unknowns} | {solved_steps} | {systems} "
              f"| {seconds:.1f} | {apart[0]} | {apart[1]} | {height} | {length} |")
        if name in DRAWN:
            picture(name, grid)


if __name__ == "__main__":
    main()
