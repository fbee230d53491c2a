#!/usr/bin/env python3
"""Lets a clamped shell vibrate freely for 2 s and prints how its energy changes, as in docs/guide/validation.md.

usage: energy_drift.py TAUT     TAUT: the program"""

import json
import pathlib
import subprocess
import sys
import tempfile

PROBLEM = {
    "format": 1,
    "bodies": {"shell": {"model": "thick_shell", "mesh": {"grid": {"size": [1, 0.2], "cells": [20, 4]}},
                         "thickness": 0.01, "density": 1000, "mass": "consistent", "initial_velocity": [0, 0, 0.5],
                         "material": {"law": "stvk", "young_modulus": 1e9, "poisson_ratio": 0.3}}},
    "constraints": {"clamp": {"type": "pin", "body": "shell", "select": {"edges": ["x0"]}}},
    "output": {"format": "none", "pictures": 0},
}
INTEGRATORS = (("generalised_alpha", 1.0), ("generalised_alpha", 0.8), ("bdf2", 0.8), ("implicit_euler", 0.8))


def energies(taut, integrator, radius, step):
    """The sum of kinetic and elastic energy after every step, J."""
    time = {"integrator": integrator, "spectral_radius": radius, "step": step, "steps": round(2 / step)}
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "problem.json"
        file.write_text(json.dumps({**PROBLEM, "time": time}))
        out = pathlib.Path(folder) / "out"
        subprocess.run([taut, "solve", file, "--out", out, "--threads", "1", "--quiet"], check=True)
        return [sum(json.loads(line)["energies"].values()) for line in (out / "steps.jsonl").open()]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print("| integrator | step | smallest | largest | last |")
    print("|---|---|---|---|---|")
    for name, radius in INTEGRATORS:
        for step in (0.01, 0.005, 0.0025, 0.00125):
            e = energies(sys.argv[1], name, radius, step)
            label = name + (f", spectral radius {radius:g}" if name == "generalised_alpha" else "")
            print(f"| {label} | {step:g} | {min(e) / e[0]:.3f} | {max(e) / e[0]:.3f} | {e[-1] / e[0]:.3f} |", flush=True)
