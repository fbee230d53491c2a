#!/usr/bin/env python3
"""Prints gallery.md, and draws its pictures.

    python3 docs/guide/gallery.py              prints the page; fails where a scene or a chart has no picture
    python3 docs/guide/gallery.py draw         solves and draws what has no picture (./dev docs)
    python3 docs/guide/gallery.py draw all     everything anew, some minutes (./dev docs --gallery)

What is said of a scene are its own `description` and `look_for`. Runs are kept in build/gallery.
"""

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
IMAGES = ROOT / "docs/images/gallery"
RUNS = ROOT / "build/gallery"
MOST_BYTES = 150_000  # of an SVG; what is larger becomes a PNG
PNG_WIDTH = 700

GROUPS = {
    "Cloth": "hanging_cloth tight_limits stretched_strip trampoline twisted_sheet curtain flag",
    "Contact": "sheet_on_sphere table_cloth",
    "Where methods fail": "coincident_stretches infeasible_pins",
    "Wrinkles": "compressed_sheet sheared_panel stretched_sheet quilt pillow yoga_mat",
    "Modes": "modal_cantilever modal_bar",
}

# Title, command, its charts, what to look at. The last word of a command is its folder.
CHARTS = [
    ("Error against cost",
     "taut chart hanging_cloth --set bodies.cloth.mesh.grid.cells=[16,16] --set time.steps=15 "
     "--vary tolerance=1e-2,1e-3,1e-4,1e-5,1e-6 --solvers augmented_lagrangian,multiplier_loop,null_space "
     "--max-seconds 60 --out out/tolerance",
     ["work_precision_linear_solves_hanging_cloth", "history_violation_hanging_cloth"],
     "A point is a run at one tolerance; the dashed line is the Pareto front, which nothing beats in both. "
     "Below, the last step iterate by iterate. [More](chart.md)."),
    ("Error against the mesh",
     "taut chart stretched_strip --vary mesh=0.25,0.5,1,2 --solvers augmented_lagrangian --history 0 --out out/mesh",
     ["error_stretched_strip"],
     "The error against the closed form, as the cells become smaller."),
    ("Many problems",
     "taut chart hanging_cloth tight_limits trampoline twisted_sheet curtain flag coincident_stretches --set time.steps=10 "
     "--vary tolerance=1e-4,1e-6 --solvers augmented_lagrangian,multiplier_loop,fixed_penalty --reference null_space "
     "--accuracy 1e-4 --max-seconds 60 --out out/many",
     ["performance_profile", "data_profile"],
     "The share of problems that a solver does correctly within so many times the seconds of the fastest, and within "
     "so many linear solves a step: higher is better. [More](chart.md#many-problems)."),
    ("Where which method fails",
     "taut stress --entry random,no_interior,time_step_long --out out/stress",
     ["random", "no_interior", "time_step_long"],
     "From left to right a problem becomes harder, and a row is a method. [The whole atlas](stress.md)."),
]


def scenes():
    """Names in the order of GROUPS, each with its file; every scene of the catalogue is in one group."""
    files = {path.stem: path for path in (ROOT / "problems/catalogue").glob("*.json")}
    grouped = " ".join(GROUPS.values()).split()
    if sorted(grouped) != sorted(files):
        sys.exit(f"gallery.py: in GROUPS or in problems/catalogue, not in both: {sorted({*grouped} ^ {*files})}")
    return {name: json.loads(files[name].read_text()) for name in grouped}


def frames(name):
    """The pictures of a scene, in the order of its steps."""
    return sorted(path for path in IMAGES.glob(f"{name}_*") if re.fullmatch(rf"{name}_\d{{5}}\.(svg|png)", path.name))


def chart_images(command, charts):
    return [IMAGES / f"{Path(command).name}_{chart}.svg" for chart in charts]


def run(command):
    """Runs a command of taut into build/gallery and returns the folder that it wrote."""
    words = shlex.split(command)
    folder = RUNS / Path(words[-1]).name
    shutil.rmtree(folder, ignore_errors=True)
    print(command, flush=True)
    done = subprocess.run([ROOT / "build/release/taut", *words[1:-1], folder, "--quiet"], cwd=ROOT, check=False)
    if done.returncode not in (0, 3):  # 3: not solved, which some scenes are meant to be
        sys.exit(f"gallery.py: {command}: exit code {done.returncode}")
    return folder


def slim(svg):
    """The same picture in two thirds of the bytes: tenths of a pixel, and one colour for inside and edge."""
    def triangle(match):
        path = re.sub(r"-?\d+\.\d+", lambda number: f"{float(number[0]):.1f}".removesuffix(".0"), match[1])
        return f'<path color="{match[2]}" d="{path.replace(" -", "-")}"/>'
    svg = re.sub(r'<path d="([^"]*)" fill="(#\w{6})" stroke="\2"/>', triangle, svg)
    return svg.replace("</defs>", "</defs>\n<style>path[color]{fill:currentColor;stroke:currentColor}</style>", 1)


def draw_scene(name):
    if not shutil.which("rsvg-convert"):
        sys.exit("gallery.py: drawing needs rsvg-convert, which is not installed (Debian's package librsvg2-bin)")
    pictures = sorted(run(f"taut solve {name} --out out/{name}").glob("pictures/*.svg"))
    for old in frames(name):
        old.unlink()
    for picture in (pictures[0], pictures[-1]):
        image = IMAGES / picture.name
        text = slim(picture.read_text())
        if len(text) <= MOST_BYTES:
            image.write_text(text)
        else:
            subprocess.run(["rsvg-convert", "--width", str(PNG_WIDTH), "--output", image.with_suffix(".png"), picture], check=True)


def draw(everything):
    IMAGES.mkdir(exist_ok=True)
    for name in scenes():
        if everything or not frames(name):
            draw_scene(name)
    for _, command, charts, _ in CHARTS:
        images = chart_images(command, charts)
        if everything or not all(image.exists() for image in images):
            folder = run(command)
            for chart, image in zip(charts, images):
                shutil.copyfile(folder / f"{chart}.svg", image)


def link(text, image):
    if not image.exists():
        sys.exit(f"gallery.py: {image.relative_to(ROOT)} is missing: run ./dev docs")
    return f"![{text}](../images/gallery/{image.name})"


def print_scene(name, scene):
    images = frames(name) or [IMAGES / f"{name}_00001.svg"]  # the missing one
    steps = [int(image.stem[-5:]) for image in images]
    print(f"\n### {name}\n\n{scene['description']}\n\n```console\ntaut solve {name} --out out/{name}\n```\n")
    print(" ".join(f"| step {step} of {scene['time']['steps']}" for step in steps), "|")
    print("|---" * len(steps) + "|")
    print(" ".join(f"| {link(f'{name}, step {step}', image)}" for step, image in zip(steps, images)), "|")
    print(f"\n{scene['look_for']}")


def print_page():
    catalogue = scenes()
    print("# Gallery\n\n<!-- Written by gallery.py: edit that, or the scenes. -->\n")
    print("What comes out of every [scene of the catalogue](scenes.md), of charts and of the atlas of failure. Above each picture is the command that\n"
          "makes it; `--report DIR` gives a page with the mesh to turn and play ([reports](report.md)).\n")
    print("```console\n./dev docs --gallery\n```\n")
    print("draws all of it anew, some minutes; `./dev docs` draws only what is missing, such as a new scene, and checks the rest.")
    for group, names in GROUPS.items():
        print(f"\n## {group}")
        for name in names.split():
            print_scene(name, catalogue[name])
    print("\n## Charts")
    for title, command, charts, look_at in CHARTS:
        print(f"\n### {title}\n\n{look_at}\n\n```console\n{command}\n```")
        for chart, image in zip(charts, chart_images(command, charts)):
            print(f"\n{link(chart.replace('_', ' '), image)}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["draw"]:
        draw(everything="all" in sys.argv)
    else:
        print_page()
