"""Ten scenes by `taut lean`: the tables and the chart of lean.md.

    python3 docs/guide/lean_table.py build/release/taut DIR

solves ten scenes as they are written, searches the leanest model of each at 5 % and at 1 %, keeps everything in DIR
(what is there is read, not repeated), prints the table and writes docs/images/lean_errors.svg. Some minutes.
"""

import json
import math
import resource
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
IMAGES = ROOT / "docs/images"
TOLERANCES = "5%", "1%"
# Name in the table: problem, quantity, settings.
SCENES = json.loads((ROOT / "tests/study/lean_scenes.json").read_text())


def settings(scene):
    return [word for setting in scene["set"] for word in ("--set", setting)]


def timed(words, folder, result):
    """Runs a command unless its result is there. CPU seconds, of all its processes: other work on the machine counts little."""
    if not (folder / result).exists():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(words, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        (folder.parent / (folder.name + "_seconds")).write_text(str(seconds))
    return float((folder.parent / (folder.name + "_seconds")).read_text())


def solve(taut, scene, folder):
    """The run of the scene as it is written."""
    return timed([taut, "solve", scene["problem"], "--out", folder, "--format", "none", "--threads", "1", "--quiet",
                  *settings(scene)], folder, "summary.json")


def search(taut, scene, tolerance, known, folder):
    return timed([taut, "lean", scene["problem"], "--quantity", scene["quantity"], "--tolerance", tolerance, "--known", known,
                  "--out", folder, "--quiet", *settings(scene)], folder, "lean.json")


def percent(value, scale):
    return "-" if value is None else f"{100 * value / scale:.2g}"


def row(name, scene, tolerance, study, seconds, full_seconds):
    lean = next(rung for rung in study["rungs"] if rung["name"] == study["lean"])
    scale = study["magnitude"]
    return [f"{name}, {scene['quantity']}", tolerance.replace("%", " %"), lean["what"], percent(lean["estimated_error"], scale),
            percent(lean["verified_error"], scale), percent(lean["true_error"], scale), f"{lean['seconds']:.2g}",
            f"{seconds:.2g}", f"{full_seconds:.2g}", "yes" if seconds < full_seconds else "**no**", study["end"]]


def points(study):
    """Estimated and true error of every model of a search that has both."""
    scale = study["magnitude"]
    return [(rung["estimated_error"] / scale, rung["true_error"] / scale, rung["name"] == study["lean"])
            for rung in study["rungs"] if rung["estimated_error"] and rung["true_error"] and rung["status"] == "solved"]


def residual_rows(taut, name, study, folder):
    """What residuals told in a search, and what a run of the same model takes; both by the clock, a minute apart."""
    (folder / "finer").mkdir(exist_ok=True)
    rows = []
    for trial in study["residual_estimates"]:
        run = "-"
        if trial["trusted"]:
            problem = str(folder / "problems" / (trial["name"] + ".json"))
            finer = folder / "finer" / trial["name"]
            solve(taut, {"problem": problem, "set": []}, finer)
            run = f"{json.loads((finer / 'summary.json').read_text())['seconds']['total']:.2g}"
        rows.append([name, trial["what"], percent(trial["change"], study["magnitude"]), f"{trial['seconds']:.2g}", run,
                     trial["why"] or "trusted"])
    return rows


def print_residuals(rows):
    print("| scene | finer model | changes the answer by, % | s | its run, s | |")
    print("|---|---|---|---|---|---|")
    for cells in rows:
        print("| " + " | ".join(cells) + " |")


def print_safety(all_points):
    """How often estimates held, by safety factor: what lean_safety was chosen by."""
    found = [point for point in all_points if point[2]]
    print("| safety factor | estimates that hold, all models | models found |")
    print("|---|---|---|")
    for factor in (1, 1.2, 1.5, 2, 3, 10):
        held = [sum(true <= factor * estimated for estimated, true, _ in points) for points in (all_points, found)]
        print(f"| {factor} | {held[0]} of {len(all_points)} | {held[1]} of {len(found)} |")


def chart(all_points):
    """Estimated against true error, both logarithmic; on the line they are equal, models found are filled."""
    low, high, size, margin = -5, 1, 420, 50
    place = lambda value: (min(max(math.log10(value), low), high) - low) / (high - low) * size
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size + 70} {size + 70}" font-family="sans-serif" font-size="12">',
             '<rect width="100%" height="100%" fill="white"/>',
             f'<rect x="{margin}" y="10" width="{size}" height="{size}" fill="none" stroke="#888"/>',
             f'<line x1="{margin}" y1="{size + 10}" x2="{margin + size}" y2="10" stroke="#888" stroke-dasharray="4"/>']
    for power in range(low, high + 1):
        at = (power - low) / (high - low) * size
        lines += [f'<text x="{margin + at}" y="{size + 26}" text-anchor="middle">1e{power}</text>',
                  f'<text x="{margin - 6}" y="{size + 14 - at}" text-anchor="end">1e{power}</text>']
    for estimated, true, lean in all_points:
        lines.append(f'<circle cx="{margin + place(estimated):.1f}" cy="{size + 10 - place(true):.1f}" r="4" '
                     f'stroke="#1f5fa8" fill="{"#1f5fa8" if lean else "none"}"/>')
    lines += [f'<text x="{margin + size / 2}" y="{size + 50}" text-anchor="middle">estimated error, relative</text>',
              f'<text x="14" y="{size / 2 + 10}" text-anchor="middle" transform="rotate(-90 14 {size / 2 + 10})">true error, relative</text>', "</svg>"]
    IMAGES.mkdir(exist_ok=True)
    (IMAGES / "lean_errors.svg").write_text("\n".join(lines) + "\n")


def main():
    taut, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    rows, residuals, all_points = [], [], []
    for name, scene in SCENES.items():
        known = folder / name / "full"
        known.parent.mkdir(parents=True, exist_ok=True)
        full_seconds = solve(taut, scene, known)
        for tolerance in TOLERANCES:
            found = folder / name / tolerance.rstrip("%")
            seconds = search(taut, scene, tolerance, known, found)
            study = json.loads((found / "lean.json").read_text())
            rows.append(row(name, scene, tolerance, study, seconds, full_seconds))
            if tolerance == TOLERANCES[-1]:  # whose search is the longer one
                residuals += residual_rows(taut, name, study, found)
            all_points += points(study)
            print(" | ".join(rows[-1]), file=sys.stderr, flush=True)
    print("| scene, quantity | T | model found | estimated, % | verified, % | true, % | s | search, s | full, s | cheaper | end |")
    print("|" + "---|" * 11)
    for cells in rows:
        print("| " + " | ".join(cells) + " |")
    print()
    print_residuals(residuals)
    chart(all_points)
    print()
    print_safety(all_points)


if __name__ == "__main__":
    main()
