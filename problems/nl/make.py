"""Writes the models of this folder as AMPL's .nl text files [Gay 2005, "Writing .nl files"]:  python3 make.py

Each model is a few lines at the end. Expressions are nested tuples of an operator and operands, numbers are constants,
x(0), x(1), ... variables; linear parts are dictionaries from a variable to its coefficient.
"""

import pathlib

OPCODES = {"+": 0, "-": 1, "*": 2, "/": 3, "^": 5, "neg": 16, "log": 43, "exp": 44, "sin": 41, "cos": 46}
INF = float("inf")


def x(i):
    return ("v", i)


def lines_of(e):
    if not isinstance(e, tuple):
        return [f"n{e!r}"]
    if e[0] == "v":
        return [f"v{e[1]}"]
    return [f"o{OPCODES[e[0]]}"] + [line for operand in e[1:] for line in lines_of(operand)]


def used(e):
    if not isinstance(e, tuple):
        return set()
    return {e[1]} if e[0] == "v" else set().union(*(used(operand) for operand in e[1:]))


def bound(low, high):
    if low == high:
        return f"4 {low!r}"
    if low == -INF and high == INF:
        return "3"
    if low == -INF:
        return f"1 {high!r}"
    if high == INF:
        return f"2 {low!r}"
    return f"0 {low!r} {high!r}"


def write(name, bounds, start, objective=None, rows=(), maximise=False):
    """objective is (nonlinear, linear), a row (nonlinear, linear, low, high); nonlinear rows come first. nonlinear None
    stands for nothing."""
    n, m = len(bounds), len(rows)
    nonlinear_rows = [row for row in rows if row[0] is not None]
    assert list(rows[: len(nonlinear_rows)]) == nonlinear_rows, "nonlinear rows come first"
    columns = [sorted(used(row[0]) | set(row[1])) for row in rows]
    gradient = sorted(used(objective[0]) | set(objective[1])) if objective else []
    curved = 1 if objective and objective[0] is not None else 0
    ranges = sum(1 for row in rows if -INF < row[2] < row[3] < INF)
    equations = sum(1 for row in rows if row[2] == row[3])
    in_rows = n if nonlinear_rows else 0  # every variable may count as nonlinear
    in_objective = n if curved else 0
    text = [
        f"g3 1 1 0\t# problem {name}",
        f" {n} {m} {1 if objective else 0} {ranges} {equations} 0",
        f" {len(nonlinear_rows)} {curved}",
        " 0 0",
        f" {in_rows} {in_objective} {min(in_rows, in_objective)}",
        " 0 0 0 1",
        " 0 0 0 0 0",
        f" {sum(map(len, columns))} {len(gradient)}",
        " 0 0",
        " 0 0 0 0 0",
    ]
    for i, row in enumerate(rows):
        text += [f"C{i}"] + lines_of(0 if row[0] is None else row[0])
    if objective:
        text += [f"O0 {1 if maximise else 0}"] + lines_of(0 if objective[0] is None else objective[0])
    text += [f"x{n}"] + [f"{i} {value!r}" for i, value in enumerate(start)]
    if rows:
        text += ["r"] + [bound(row[2], row[3]) for row in rows]
    text += ["b"] + [bound(*pair) for pair in bounds]
    if n > 1 or rows:
        counts = [sum(1 for column in columns if i in column) for i in range(n)]
        text += [f"k{n - 1}"] + [str(sum(counts[: i + 1])) for i in range(n - 1)]
    for i, column in enumerate(columns):
        if column:
            text += [f"J{i} {len(column)}"] + [f"{j} {rows[i][1].get(j, 0)!r}" for j in column]
    if gradient:
        text += [f"G0 {len(gradient)}"] + [f"{j} {objective[1].get(j, 0)!r}" for j in gradient]
    (pathlib.Path(__file__).parent / f"{name}.nl").write_text("\n".join(text) + "\n")


def square(e):
    return ("^", e, 2)


FREE = (-INF, INF)

# min x0^2 + x1^2 with x0 + x1 >= 2 and x0 + x1 <= 1: no point at all. The closest compromise has x0 + x1 = 1.5.
write("infeasible_rows", [FREE, FREE], [0, 0], (("+", square(x(0)), square(x(1))), {}),
      [(None, {0: 1, 1: 1}, 2, INF), (None, {0: 1, 1: 1}, -INF, 1)])
# min x0 with x0^2 + x1^2 <= 1 and x0 >= 3: no point.
write("infeasible_disc", [(3, INF), FREE], [4, 1], (None, {0: 1}),
      [(("+", square(x(0)), square(x(1))), {}, -INF, 1)])
# min x0 - x1 with x0 + x1 = 1: falls without end.
write("unbounded_line", [FREE, FREE], [0, 0], (None, {0: 1, 1: -1}), [(None, {0: 1, 1: 1}, 1, 1)])
# max x0 + x1^2, nothing else.
write("unbounded_free", [FREE, FREE], [1, 1], (square(x(1)), {0: 1}), maximise=True)
# min x0 with x0^3 - x1 >= 0 and x1 >= 0: the solution (0, 0) has no multipliers, as no constraint qualification holds.
write("no_qualification", [FREE, (0, INF)], [1, 0.5], (None, {0: 1}), [(("^", x(0), 3), {1: -1}, 0, INF)])
# min (x0-1)^2 + (x1-2)^2 with x0 + x1 = 1 twice and its double: f = 2, the multipliers' sum is determined only.
write("redundant_rows", [FREE, FREE], [0, 0],
      (("+", square(("-", x(0), 1)), square(("-", x(1), 2))), {}),
      [(None, {0: 1, 1: 1}, 1, 1), (None, {0: 1, 1: 1}, 1, 1), (None, {0: 2, 1: 2}, 2, 2)])
# Rosenbrock's function times 1e8, with x0 in units of 1e-4: f = 0 at (1e-4, 1).
big = ("*", 1e4, x(0))
write("scaled_up", [FREE, FREE], [-1.2e-4, 1],
      (("*", 1e8, ("+", ("*", 100, square(("-", x(1), square(big)))), square(("-", 1, big)))), {}))
# The same function times 1e-8 in the disc of radius 1: what is small is no solution yet. f = 4.5674808719e-10.
write("scaled_down", [FREE, FREE], [-1.2, 1],
      (("*", 1e-8, ("+", ("*", 100, square(("-", x(1), square(x(0))))), square(("-", 1, x(0))))), {}),
      [(("+", square(x(0)), square(x(1))), {}, -INF, 1)])
# min (x0-3)^2 + x1^2 + (x2+1)^2 with x1 = 2 fixed by its bounds, x0 <= 1: f = 8.
write("fixed_variables", [(-INF, 1), (2, 2), FREE], [0, 0, 0],
      (("+", square(("-", x(0), 3)), ("+", square(x(1)), square(("+", x(2), 1)))), {}))
# No objective: any point of x0 x1 = 1, x0 + x1 = 2.5 will do, (2, 1/2) or (1/2, 2).
write("no_objective", [(0, 10), (0, 10)], [3, 1], None,
      [(("*", x(0), x(1)), {}, 1, 1), (None, {0: 1, 1: 1}, 2.5, 2.5)])
# max x0 + 2 x1 with 1 <= x0 - x1 <= 2 and 0 <= x0 + x1 <= 4 and -1 <= x <= 5: f = 5.5 at (2.5, 1.5).
write("range_rows", [(-1, 5), (-1, 5)], [0, 0], (None, {0: 1, 1: 2}),
      [(None, {0: 1, 1: -1}, 1, 2), (None, {0: 1, 1: 1}, 0, 4)], maximise=True)
# min x0^2 + x1^2 with x0 x1 >= 1 from (-3, 0.1), which violates it: f = 2.
write("infeasible_start", [FREE, FREE], [-3, 0.1], (("+", square(x(0)), square(x(1))), {}),
      [(("*", x(0), x(1)), {}, 1, INF)])
