#!/usr/bin/env python3
"""Writes the problem files and meshes of this folder: thick shells whose results are known. Run it here."""

import json
import math
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
E = 1e9  # Pa, where a result does not depend on it


def write(name, description, look_for, steps, body, constraints, loads, probes, stationarity=None):
    document = {"format": 1, "name": name, "description": description, "look_for": look_for}
    document["time"] = {"integrator": "static", "steps": steps}
    document["bodies"] = {"shell": {"model": "thick_shell", **body}}
    document["constraints"] = {k: {"type": "pin", "body": "shell", **v} for k, v in constraints.items()}
    document["loads"] = {k: {"body": "shell", **v} for k, v in loads.items()}
    document["solver"] = {"tolerance": {"stationarity": stationarity}} if stationarity else {}
    document["output"] = {"every": steps, "pictures": 1, "probes": probes}
    (HERE / f"{name}.json").write_text(json.dumps(document, indent=2) + "\n")


def probe(quantity, select, factor, value, source, surface="both", **tolerance):
    expected = {"value": value, **tolerance, "source": source}
    return {"quantity": quantity, "select": select, "surface": surface, "factor": factor, "expected": expected}


def isotropic(young, poisson, law="stvk"):
    return {"law": law, "young_modulus": young, "poisson_ratio": poisson}


# --- plates: a quarter of a square of side 1 -------------------------------------------------------------------------

SYMMETRY = {"symmetry_x": {"select": {"edges": ["x1"]}, "axes": "x"},
            "symmetry_y": {"select": {"edges": ["y1"]}, "axes": "y"}}
SIMPLE = {"edge_x": {"select": {"edges": ["x0"]}, "axes": "yz"}, "edge_y": {"select": {"edges": ["y0"]}, "axes": "xz"}}
CLAMPED = {"edges": {"select": {"edges": ["x0", "y0"]}, "axes": "xyz"}}
CENTRE = {"corners": ["x1y1"]}
QUARTER = {"grid": {"size": [0.5, 0.5], "cells": [32, 32]}}
# w D/(q a^4) by the series of Mindlin's theory, k = 5/6, nu = 0.3: Navier's, and Ritz's for clamped edges.
UNIFORM = {("simply_supported", 10): 0.004272842263, ("simply_supported", 100): 0.004064457560,
           ("simply_supported", 1000): 0.004062373717, ("clamped", 10): 0.001504625612,
           ("clamped", 100): 0.001267856681, ("clamped", 1000): 0.001265344503}
POINT = {"simply_supported": 0.01160083977, "clamped": 0.005612}  # w D/(P a^2) by Kirchhoff's theory


def lift(slenderness):
    """Deflection over thickness, small enough for the linear result within 3e-4 and large enough for round-off."""
    return 0.02 if slenderness >= 100 else 0.001




def plates():
    for (edges, slenderness), value in UNIFORM.items():
        t = 1 / slenderness
        stiffness = E * t**3 / (12 * (1 - 0.3**2))
        body = {"mesh": QUARTER, "thickness": t, "density": 1000, "material": isotropic(E, 0.3)}
        supports = {**SYMMETRY, **(SIMPLE if edges == "simply_supported" else CLAMPED)}
        words = edges.replace("_", " ")
        note = f"The deflection is {lift(slenderness)} of the thickness, so that the linear theory holds within 3e-4."
        load = lift(slenderness) * t * stiffness / value
        write(f"plate_{edges}_{slenderness}", f"A square plate, {words}, a/t = {slenderness}, uniform load; a quarter.",
              note, 1, body, supports, {"load": {"type": "surface_load", "force_per_area": [0, 0, load]}},
              {"w": probe("displacement_z", CENTRE, stiffness / load, value,
                          "w D/(q a^4), Mindlin's theory with k = 5/6 and hard supports, series", relative=0.01)},
              STATIONARITY.get(slenderness))
        if slenderness == 10:
            continue
        load = lift(slenderness) * t * stiffness / POINT[edges]
        write(f"plate_{edges}_{slenderness}_point",
              f"A square plate, {words}, a/t = {slenderness}, point load at the centre; a quarter.", note, 1, body,
              supports, {"load": {"type": "point_load", "select": CENTRE, "force": [0, 0, load / 4]}},
              {"w": probe("displacement_z", CENTRE, stiffness / load, POINT[edges],
                          "w D/(P a^2), Kirchhoff's theory, series", relative=0.01)}, STATIONARITY.get(slenderness))


def more_plates():
    """Simply supported under a uniform load: what the plain element makes of a thin one, a nearly incompressible one, and
    a very thick one in four layers."""
    supports = {**SYMMETRY, **SIMPLE}
    for name, nu, shell, what in (("plain", 0.3, {"element": "plain"}, "plain elements, which lock: a known miss"),
                                  ("nu_49", 0.49, {}, "nu = 0.49")):
        t, kirchhoff = 1e-3, 0.00406235266
        stiffness = E * t**3 / (12 * (1 - nu**2))
        load = lift(1000) * t * stiffness / kirchhoff
        write(f"plate_simply_supported_1000_{name}", f"A square plate, simply supported, a/t = 1000, {what}; a quarter.",
              "Compare with plate_simply_supported_1000.", 1,
              {"mesh": QUARTER, "thickness": t, "density": 1000, "material": isotropic(E, nu), "shell": shell}, supports,
              {"load": {"type": "surface_load", "force_per_area": [0, 0, load]}},
              {"w": probe("displacement_z", CENTRE, stiffness / load, kirchhoff, "w D/(q a^4), Kirchhoff's theory, Navier's series",
                          relative=0.01)}, 1e-4)  # the round-off of stiffer thicknesses
    h, exact = 0.2, 0.004803471581
    stiffness = E * h**3 / (12 * (1 - 0.3**2))
    load = lift(5) * h * stiffness / exact
    layer = {"thickness": h, "density": 1000, "material": isotropic(E, 0.3), "prisms": 4}
    write("plate_simply_supported_5_layers", "A square plate, simply supported, a/h = 5, four prisms through the thickness, load on the top; a quarter.",
          "The deflection is a thousandth of the thickness, for a linear result.", 1, {"mesh": QUARTER, "layers": [layer]}, supports,
          {"load": {"type": "surface_load", "force_per_area": [0, 0, load], "surface": "top"}},
          {"w": probe("displacement_z", CENTRE, stiffness / load, exact, "w D/(q a^4) in the middle, three-dimensional elasticity, exact",
                      surface="mid", relative=0.01)})


STATIONARITY = {1000: 3e-5}  # thin plates have small forces and the same round-off


def pagano():
    for slenderness, value in ((4, 2.0059105305), (10, 0.7530300429), (100, 0.4347219718)):
        for prisms in (1, 3):
            h = 1 / slenderness
            across = 1e7
            plies = [{"E_L": 25 * across, "E_T": across, "G_LT": 0.5 * across, "G_TT": 0.2 * across, "nu_LT": 0.25,
                      "nu_TT": 0.25, "fibre_degrees": degrees} for degrees in (0, 90, 0)]
            layers = [{"thickness": h / 3, "density": 1500, "material": ply, "prisms": prisms} for ply in plies]
            load = lift(slenderness) * h * 100 * across * h**3 / value
            write(f"pagano_{slenderness}_{prisms}",
                  f"Pagano's 0/90/0 plate, a/h = {slenderness}, {prisms} prism(s) a ply, sinusoidal load on the top; a quarter.",
                  "Known misses: one prism a ply cannot follow the shear through the thickness of thick plates (a/h = 4 and 10).",
                  1, {"mesh": QUARTER, "layers": layers}, {**SYMMETRY, **SIMPLE},
                  {"load": {"type": "surface_load", "force_per_area": [0, 0, load], "surface": "top",
                            "half_waves": [[1, 0, 0], [0, 1, 0]]}},
                  {"w": probe("displacement_z", CENTRE, 100 * across * h**3 / load, value,
                              "100 E_T h^3 w/(q a^4) in the middle, three-dimensional elasticity (Pagano 1970), exact",
                              surface="mid", relative=0.01)})


# --- meshes -----------------------------------------------------------------------------------------------------------


def obj(name, comment, points, faces):
    lines = [f"# {comment}; written by make.py"]
    lines += ["v " + " ".join(f"{x:.12g}" for x in p) for p in points]
    lines += ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    (HERE / name).write_text("\n".join(lines) + "\n")


def grid(cells_x, cells_y, place, union_jack=False):
    """Vertices and faces of the unit square's grid with alternating diagonals, mapped by `place`."""
    stride = cells_x + 1
    points = [place(i / cells_x, j / cells_y) for j in range(cells_y + 1) for i in range(cells_x + 1)]
    if union_jack:
        points += [place((i + 0.5) / cells_x, (j + 0.5) / cells_y) for j in range(cells_y) for i in range(cells_x)]
    faces = []
    for j in range(cells_y):
        for i in range(cells_x):
            a = j * stride + i
            b, c, d = a + 1, a + 1 + stride, a + stride
            if union_jack:
                m = stride * (cells_y + 1) + j * cells_x + i
                faces += [(a, b, m), (b, c, m), (c, d, m), (d, a, m)]
            else:
                faces += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    return points, faces


def column(cells_x, cells_y, i):
    return {"vertices": [j * (cells_x + 1) + i for j in range(cells_y + 1)]}


def row(cells_x, j):
    return {"vertices": [j * (cells_x + 1) + i for i in range(cells_x + 1)]}


# --- Scordelis-Lo, Cook ----------------------------------------------------------------------------------------------


def scordelis_lo(cells=40):
    def place(radius):
        def at(x, y):
            angle = math.radians(40) * y
            return (25 * x, radius * math.sin(angle), radius * math.cos(angle))
        return at
    for name, radius in (("bottom", 24.875), ("top", 25.125)):
        obj(f"scordelis_lo_{name}.obj", f"A quarter of the roof's {name}, {cells} x {cells} cells", *grid(cells, cells, place(radius)))
    corner = (cells + 1) ** 2 - 1
    write("scordelis_lo", "Scordelis and Lo's roof under its weight on diaphragms; a quarter.",
          "Two surfaces are given: normals of the facets would lean at the plane of symmetry. The load is 1/1000 of the usual one, for a linear result.", 1,
          {"mesh": {"file": "scordelis_lo_bottom.obj"}, "top": {"file": "scordelis_lo_top.obj"}, "density": 36,
           "material": isotropic(4.32e8, 0)},
          {"diaphragm": {"select": column(cells, cells, 0), "axes": "yz"},
           "symmetry_x": {"select": column(cells, cells, cells), "axes": "x"},
           "symmetry_y": {"select": row(cells, 0), "axes": "y"}},
          {"weight": {"type": "surface_load", "force_per_area": [0, 0, -0.09]}},
          {"w": probe("displacement_z", {"vertices": [corner]}, -1000, 0.30147497,
                      "three-dimensional elasticity, Fourier-Ritz (a shell with k = 5/6: 0.301463, without shear: 0.300601)",
                      relative=0.01)})


def cook(cells=40):
    obj("cook.obj", f"Cook's membrane, {cells} x {cells} cells",
        *grid(cells, cells, lambda x, y: (48 * x, 44 * x + y * (44 - 28 * x), 0)))
    load = 1e-4
    write("cook", "Cook's membrane, nu = 1/3, in plane stress.", "The load is 1e-4, for a linear result.", 1,
          {"mesh": {"file": "cook.obj"}, "thickness": 1, "density": 1, "material": isotropic(1, 1 / 3)},
          {"plane": {"select": {"all": True}, "axes": "z", "surface": "bottom"},
           "clamped": {"select": column(cells, cells, 0), "axes": "xy"}},
          {"shear": {"type": "edge_load", "select": column(cells, cells, cells), "force_per_length": [0, load / 16, 0]}},
          {"v": probe("displacement_y", {"nearest": [[48, 52, 0]]}, 1 / load, 23.9677, "plane stress, hp finite elements",
                      relative=0.01)})


# --- large deflection -------------------------------------------------------------------------------------------------

STRIP = {"grid": {"size": [10, 1], "cells": [40, 1]}}
HELD = {"clamped": {"select": {"edges": ["x0"]}, "axes": "xyz"}, "plane": {"select": {"all": True}, "axes": "y"}}
TIP = {"edges": ["x1"]}


def stvk_arc(moment, young, t):
    """Stretch and curvature of a strip of St. Venant-Kirchhoff material under a moment: the minimum over a, theta' and
    delta of w - moment theta', w = Y/8 [c^2 t + (4 a^2 + 2 c) K^2 t^3/12 + K^4 t^5/80] + Y t (delta^2 - 1)^2/8 with
    c = a^2 - 1 and K = delta theta' (docs/theory/prism_shell.md)."""
    a, turn, delta = 1.0, 12 * moment / (young * t**3), 1.0
    for _ in range(200):
        k = delta * turn
        a = math.sqrt(1 - 3 * k * k * t * t / 12)  # dw/da = 0: c t + 3 K^2 t^3/12 = 0
        c = a * a - 1
        slope = young / 8 * ((8 * a * a + 4 * c) * k * t**3 / 12 + 4 * k**3 * t**5 / 80)  # dw/dK
        delta = math.sqrt(1 - 2 * slope * turn / (young * t * delta))
        turn *= moment / (slope * delta)
    return a, turn


def roll_up():
    for slenderness, part, words in ((10, 0.5, "half"), (20, 0.75, "three quarters"), (100, 1, "all"), (1000, 1, "all")):
        t = 10 / slenderness
        young = 12 / t**3
        moment = 2 * math.pi / 10 * part
        a, turn = stvk_arc(moment, young, t)
        tip = (a / turn * math.sin(10 * turn) / 10, a / turn * (1 - math.cos(10 * turn)) / 10)
        source = "arc of a beam with the bending law of St. Venant and Kirchhoff (docs/theory/prism_shell.md), over L"
        write(f"roll_up_{slenderness}", f"A cantilever, L/t = {slenderness}, rolled up by {words} of the moment that makes a full circle of a thin one; EI = 1, nu = 0.",
              "The strip is kept from moving sideways, where it would buckle.", round(20 * part),
              {"mesh": STRIP, "thickness": t, "density": 1, "material": isotropic(young, 0)}, HELD,
              {"moment": {"type": "end_moment", "select": TIP, "moment_per_length": [0, -moment, 0]}},
              {"x": probe("x", TIP, 0.1, tip[0], source, absolute=0.005), "z": probe("z", TIP, 0.1, tip[1], source, absolute=0.005)},
              1e-7)  # below 4e-8 is round-off


def elastica():
    for alpha, shortening, deflection in ((1, 0.056433236, 0.301720774), (2, 0.160641721, 0.493457480),
                                          (4, 0.328941242, 0.669964181), (10, 0.554995598, 0.810609025)):
        t = 0.1
        source = "elliptic integrals (Bisshopp and Drucker 1945), over L"
        write(f"elastica_{alpha}", f"A cantilever, L/t = 100, under a dead end load P with P L^2/EI = {alpha}; EI = 1, nu = 0.",
              "The tip's place; with L/t = 100 shear and stretch count for less than 4e-4 of the length.", max(4, alpha),
              {"mesh": STRIP, "thickness": t, "density": 1, "material": isotropic(12 / t**3, 0)}, HELD,
              {"end": {"type": "edge_load", "select": TIP, "force_per_length": [0, 0, alpha / 100]}},
              {"x": probe("x", TIP, 0.1, 1 - shortening, source, absolute=0.005),
               "z": probe("z", TIP, 0.1, deflection, source, absolute=0.005)}, 1e-8)


def slit_annular(radial=16, around=128):
    def place(x, y):
        angle, radius = -2 * math.pi * x, 6 + 4 * y
        return (radius * math.cos(angle), radius * math.sin(angle), 0)
    obj("slit_annular.obj", f"A ring with a slit, {radial} x {around} cells", *grid(around, radial, place, union_jack=True))
    source = "Sze, Liu and Lo 2004, curve of quadrilaterals on 10 x 80 cells"
    write("slit_annular", "A ring of inner radius 6, outer radius 10 and thickness 0.03, cut open; one edge of the slit is clamped, the other lifted.",
          "The lifted edge twists through more than its radius.", 10,
          {"mesh": {"file": "slit_annular.obj"}, "thickness": 0.03, "density": 1, "material": isotropic(21e6, 0)},
          {"clamped": {"select": column(around, radial, around), "axes": "xyz"}},
          {"lift": {"type": "edge_load", "select": column(around, radial, 0), "force_per_length": [0, 0, 0.8]}},
          {"inner": probe("displacement_z", {"vertices": [0]}, 1, 13.891, source, relative=0.01),
           "outer": probe("displacement_z", {"vertices": [radial * (around + 1)]}, 1, 17.528, source, relative=0.01)}, 1e-7)


if __name__ == "__main__":
    plates()
    more_plates()
    pagano()
    scordelis_lo()
    cook()
    roll_up()
    elastica()
    slit_annular()
