#!/usr/bin/env python3
"""Writes the problem files and meshes of this folder: thick shells whose results are known. Run it here."""

import json
import math
import pathlib

import stvk_beam

HERE = pathlib.Path(__file__).resolve().parent
E = 1e9  # Pa, where a result does not depend on it


def write(name, description, look_for, steps, body, constraints, loads, probes, stationarity=None, **time):
    document = {"format": 1, "name": name, "description": description, "look_for": look_for}
    document["time"] = {"integrator": "static", "steps": steps, **time}
    document["bodies"] = {"shell": {"model": "thick_shell", **body}}
    document["constraints"] = {k: {"type": "pin", "body": "shell", **v} for k, v in constraints.items()}
    document["loads"] = {k: {"body": "shell", **v} for k, v in loads.items()}
    document["solver"] = {"tolerance": {"stationarity": stationarity}} if stationarity else {}
    document["output"] = {"every": steps, "pictures": 1, "probes": probes}
    (HERE / f"{name}.json").write_text(json.dumps(document, indent=2) + "\n")


def probe(quantity, select, factor, value, source, surface="both", **tolerance):
    expected = {"value": value, **tolerance, "source": source}
    return {"quantity": quantity, "select": select, "surface": surface, "factor": factor, "expected": expected}


def resultant(quantity, select, factor, value, source, **tolerance):
    """A probe of what has no surface."""
    return {k: v for k, v in probe(quantity, select, factor, value, source, **tolerance).items() if k != "surface"}


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
MOMENT = {"simply_supported": 0.0478863, "clamped": 0.0229051}  # M/(q a^2) in the middle, nu = 0.3 (Taylor and Govindjee 2004)


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
                          "w D/(q a^4), Mindlin's theory with k = 5/6 and hard supports, series", relative=0.01),
               **({"moment": resultant("m11", CENTRE, 1 / load, MOMENT[edges], "M/(q a^2) in the middle, Kirchhoff's theory, series",
                                       relative=0.01)} if slenderness == 100 else {})},
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


def thick_elastica():
    """Where shear, stretch and the bending law of St. Venant and Kirchhoff count."""
    for slenderness in (10, 20):
        for alpha in (1, 2, 4, 10):
            t = 10 / slenderness
            young = 12 / t**3
            x, z = stvk_beam.tip_under_force(young, t, 10, alpha / 100)
            source = "beam with shear (k = 5/6), stretch and the bending law of St. Venant and Kirchhoff (docs/theory/prism_shell.md), over L"
            write(f"elastica_{alpha}_thick_{slenderness}",
                  f"A cantilever, L/t = {slenderness}, under a dead end load P with P L^2/EI = {alpha}; EI = 1, nu = 0.",
                  "Compare with the thin one: shear, stretch and the law's bending count here.", max(4, alpha),
                  {"mesh": STRIP, "thickness": t, "density": 1, "material": isotropic(young, 0)}, HELD,
                  {"end": {"type": "edge_load", "select": TIP, "force_per_length": [0, 0, alpha / 100]}},
                  {"x": probe("x", TIP, 0.1, x / 10, source, absolute=0.005),
                   "z": probe("z", TIP, 0.1, z / 10, source, absolute=0.005)}, 1e-8)


def neo_hookean_roll_up():
    t = 0.1
    young, moment = 12 / t**3, 2 * math.pi / 10
    source = "Euler's full circle, over L"
    write("roll_up_100_neo_hookean", "A cantilever, L/t = 100, rolled up to a full circle, of neo-Hookean material; EI = 1, nu = 0.",
          "Its bending is closer to Euler's than that of St. Venant and Kirchhoff (roll_up_100).", 20,
          {"mesh": STRIP, "thickness": t, "density": 1, "material": isotropic(young, 0, "neo_hookean")}, HELD,
          {"moment": {"type": "end_moment", "select": TIP, "moment_per_length": [0, -moment, 0]}},
          {"x": probe("x", TIP, 0.1, 0.0, source, absolute=0.005), "z": probe("z", TIP, 0.1, 0.0, source, absolute=0.005)}, 1e-7)


# --- natural frequencies ----------------------------------------------------------------------------------------------


def frequencies():
    """Square plates of side 1 and strips: f = factor/(2 pi a^2) sqrt(D/(rho t))."""
    t, density = 0.01, 1000
    stiffness = E * t**3 / (12 * (1 - 0.3**2))
    unit = math.sqrt(stiffness / (density * t)) / (2 * math.pi)
    edges = {"edge_x": {"select": {"edges": ["x0", "x1"]}, "axes": "yz"}, "edge_y": {"select": {"edges": ["y0", "y1"]}, "axes": "xz"}}
    around = {"edges": {"select": {"boundary": True}, "axes": "xyz"}}
    side = {"edges": {"select": {"edges": ["x0"]}, "axes": "xyz"}}
    for name, words, supports, first, factors in (
            ("simply_supported", "simply supported", edges, 1, (19.7392088, 49.3480220, 49.3480220, 78.9568352)),
            ("clamped", "clamped", around, 1, (35.9851911, 73.3938455, 73.3938455, 108.2165017)),
            ("cantilever_plate", "clamped along one edge", side, 1, (3.4710134, 8.5063308, 21.2841777, 27.1987553)),
            ("free_plate", "free; the first six modes are rigid", {}, 7, (13.4681974, 19.5961374, 24.2702009))):
        probes = {f"f{first + k}": frequency(first + k, 1 / unit, factor, "omega a^2 sqrt(rho t/D), Kirchhoff's theory, Ritz's series")
                  for k, factor in enumerate(factors)}
        write(f"frequencies_{name}", f"The lowest natural frequencies of a square plate, {words}; a/t = 100, consistent mass.",
              "The shapes are in modes/.", 1,
              {"mesh": {"grid": {"size": [1, 1], "cells": [48, 48]}}, "thickness": t, "density": density, "mass": "consistent",
               "material": isotropic(E, 0.3)}, supports, {}, probes, frequencies=first + len(factors) - 1)
    for slenderness, factors in ((100, {1: 3.51578379, 2: 22.02437983, 3: 61.62978159}),
                                 (10, {1: 3.49314111, 2: 21.09162421, 4: 55.99840084})):  # its mode 3 stretches
        t = 10 / slenderness
        unit = math.sqrt(1 / (density * t)) / (2 * math.pi * 100)
        probes = {f"f{mode}": frequency(mode, 1 / unit, factor, "omega L^2 sqrt(rho A/EI), Timoshenko's beam, k = 5/6")
                  for mode, factor in factors.items()}
        write(f"frequencies_cantilever_{slenderness}", f"The lowest natural frequencies of a cantilever, L/t = {slenderness}; EI = 1, nu = 0, consistent mass.",
              "The strip moves in its plane only. The shapes are in modes/.", 1,
              {"mesh": STRIP, "thickness": t, "density": density, "mass": "consistent", "material": isotropic(12 / t**3, 0)}, HELD, {},
              probes, frequencies=max(factors))


    prestressed_frequencies(density)


def prestressed_frequencies(density):
    """A strip on hinges under a force N along it: omega_n^2 = (n pi/L)^4 EI/(rho A) (1 + N L^2/(n^2 pi^2 EI))."""
    t = 0.1
    unit = math.sqrt(1 / (density * t)) / (2 * math.pi * 100)
    layer = {"thickness": t, "density": density, "material": isotropic(12 / t**3, 0), "prisms": 2}
    hinges = {"hinge": {"select": {"edges": ["x0"]}, "axes": "xz", "surface": "mid"},
              "roller": {"select": {"edges": ["x1"]}, "axes": "z", "surface": "mid"}, "plane": HELD["plane"]}
    for name, share, words in (("stretched", 2.0, "stretched by twice"), ("compressed", -0.5, "compressed by half of")):
        factors = {n: (n * math.pi) ** 2 * math.sqrt(1 + share / n**2) for n in (1, 2)}
        write(f"frequencies_{name}", f"The lowest natural frequencies of a strip on hinges, L/t = 100, {words} its buckling load; EI = 1, nu = 0, consistent mass.",
              "Compare the two: stress changes frequencies.", 1, {"mesh": STRIP, "layers": [layer], "mass": "consistent"}, hinges,
              {"pull": {"type": "edge_load", "select": TIP, "force_per_length": [share * math.pi**2 / 100, 0, 0]}},
              {f"f{n}": frequency(n, 1 / unit, factor, "omega L^2 sqrt(rho A/EI), Euler and Bernoulli's beam under a force along it")
               for n, factor in factors.items()}, frequencies=2)


def frequency(mode, factor, value, source):
    return {"quantity": "frequency", "mode": mode, "factor": factor, "expected": {"value": value, "relative": 0.01, "source": source}}


# --- snap-through -----------------------------------------------------------------------------------------------------

SPAN, RISE, ARCH_T = 10, 0.11, 0.1  # a low arch z = RISE sin(pi x/SPAN), EI = 1 per width


def arch_mesh(cells=40):
    obj("arch.obj", f"A low arch, {cells} x 2 cells", *grid(cells, 2, lambda x, y: (SPAN * x, 0.5 * y, RISE * math.sin(math.pi * x))))


def arch_problem(name, description, look_for, steps, constraints, loads, probes, stationarity):
    cells = 40
    ends = {"vertices": column(cells, 2, 0)["vertices"] + column(cells, 2, cells)["vertices"]}
    layer = {"thickness": ARCH_T, "density": 1, "material": isotropic(12 / ARCH_T**3, 0), "prisms": 2}
    supports = {"hinges": {"select": ends, "axes": "xz", "surface": "mid"}, "plane": {"select": {"all": True}, "axes": "y"}}
    write(name, description, look_for, steps, {"mesh": {"file": "arch.obj"}, "layers": [layer]}, {**supports, **constraints}, loads, probes,
          stationarity, halvings=8)


def sine_load(a):
    """The amplitude of the sinusoidal load that holds the arch at the amplitude a (shallow arches, one mode: exact)."""
    area = 12 / ARCH_T**2
    return (math.pi / SPAN) ** 4 * ((RISE - a) + area / 4 * (RISE**2 - a**2) * a)


def point_load(height):
    """The load per width in the middle that holds the middle at this height, by the series of shallow arches: with
    nu = N L^2/(pi^2 EI) and p = 2 P L^3/(EI pi^4), a_n = (n^4 e_n - p s_n)/(n^4 + nu n^2) and 4 nu I/A = sum n^2 a_n^2 - e^2."""
    odd = range(1, 200, 2)

    def state(nu):
        p = (RISE / (1 + nu) - height) / sum(1 / (n**4 + nu * n**2) for n in odd)
        a = [((RISE if n == 1 else 0) - p * (1 if n % 4 == 1 else -1) / n**4) / (1 + nu / n**2) for n in odd]
        return p, sum((n * x) ** 2 for n, x in zip(odd, a)) - RISE**2 - nu * ARCH_T**2 / 3
    low, high = -3.99, -0.01  # below -4 it would buckle to the side
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if state(middle)[1] > 0 else (low, middle)
    return state(low)[0] * math.pi**4 / (2 * SPAN**3)


def snap_through():
    arch_mesh()
    middle = column(40, 2, 20)
    limit = sine_load(math.sqrt((RISE**2 - ARCH_T**2 / 3) / 3))
    low, high = -4 * RISE, -RISE / 2
    for _ in range(100):
        a = (low + high) / 2
        low, high = (a, high) if sine_load(a) > 1.3 * limit else (low, a)
    source = "shallow arch, one mode"
    arch_problem("snap_through", "A low hinged arch under a sinusoidal load that grows to 1.3 of its limit load.",
                 "Each load step is a minimisation: behind the limit point it ends in the state on the other side.", 13, {},
                 {"load": {"type": "surface_load", "force_per_area": [0, 0, -1.3 * limit], "half_waves": [[1 / SPAN, 0, 0]]}},
                 {"z": probe("z", middle, 1, low, source, surface="mid", relative=0.01)}, 1e-7)
    arch_problem("snap_through_displacement", "The same arch, its middle moved down to the level of its hinges.",
                 "Displacement control: the force in probes.csv rises to its limit and falls again.", 22,
                 {"push": {"select": middle, "axes": "z", "surface": "mid",
                           "motion": {"keyframes": [{"time": 0}, {"time": 1, "translation": [0, 0, -RISE]}]}}}, {},
                 {"force": probe("force_z", middle, -2, point_load(0), "force per width, shallow arch, series", relative=0.01)}, 1e-7)


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
    thick_elastica()
    neo_hookean_roll_up()
    frequencies()
    snap_through()
    slit_annular()
