#!/usr/bin/env python3
"""Solves and checks the problems of this folder and prints the table of docs/guide/validation.md.

usage: table.py TAUT [NAME...]     TAUT: the program; NAME: problems, all of them where absent"""

import json
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def mesh(problem):
    body = problem["bodies"]["shell"]
    text = "x".join(map(str, body["mesh"]["grid"]["cells"])) if "grid" in body["mesh"] else body["mesh"]["file"]
    prisms = sum(layer.get("prisms", 1) for layer in body.get("layers", [{}]))
    return text + (f", {prisms} prisms" if prisms > 1 else "")


def solve(taut, name):
    problem = json.loads((HERE / f"{name}.json").read_text())
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([taut, "solve", HERE / f"{name}.json", "--out", folder, "--threads", "1", "--quiet"], check=False)
        code = subprocess.run([taut, "check", folder], stdout=subprocess.DEVNULL, check=False).returncode
        summary = json.loads((pathlib.Path(folder) / "summary.json").read_text())
    rows = []
    for probe, said in summary["probes"].items():
        value, reference = said["value"], said["expected"]["value"]
        relative = "relative" in said["expected"]
        error = f"{100 * (value / reference - 1):+.2f} %" if relative else f"{value - reference:+.4f} L"
        cells = [f"`{name}`", mesh(problem), f"{probe} = {value:.6g}", f"{reference:.6g}", error, summary["status"],
                 str(summary["counts"]["linear_solves"]), f"{summary['seconds']['total']:.1f}", str(code)]
        rows.append("| " + " | ".join(cells) + " |")
    return rows


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    names = sys.argv[2:] or sorted(file.stem for file in HERE.glob("*.json"))
    print("| problem | mesh | ours | reference | error | status | Newton systems | s | check |")
    print("|---|---|---|---|---|---|---|---|---|")
    for each in names:
        for line in solve(sys.argv[1], each):
            print(line, flush=True)
