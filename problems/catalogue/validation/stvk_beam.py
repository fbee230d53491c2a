"""The cantilever of docs/theory/prism_shell.md, "The beam of St. Venant and Kirchhoff", integrated by shooting; width 1."""

import math


def stresses(young, t, section):
    """Derivatives of the section's energy by (a, b, theta', delta); shear correction 5/6."""
    a, b, turn, delta = section
    k, i2, i4, c = delta * turn, t**3 / 12, t**5 / 80, a * a + b * b - 1
    by_c = 2 * c * t + 2 * k * k * i2
    by_k = 2 * (4 * a * a + 2 * c) * k * i2 + 4 * k**3 * i4
    e, shear = young / 8, 5 / 12 * young * t
    return [e * (by_c * 2 * a + 8 * a * k * k * i2), e * by_c * 2 * b + shear * b * delta**2, e * by_k * delta,
            e * by_k * turn + shear * b * b * delta + young * t / 2 * (delta**2 - 1) * delta]


def solve4(matrix, right):
    """Gauss's elimination with pivots."""
    rows = [row[:] + [r] for row, r in zip(matrix, right)]
    for i in range(4):
        best = max(range(i, 4), key=lambda j: abs(rows[j][i]))
        rows[i], rows[best] = rows[best], rows[i]
        for j in range(i + 1, 4):
            factor = rows[j][i] / rows[i][i]
            rows[j] = [x - factor * y for x, y in zip(rows[j], rows[i])]
    out = [0.0] * 4
    for i in reversed(range(4)):
        out[i] = (rows[i][4] - sum(rows[i][j] * out[j] for j in range(i + 1, 4))) / rows[i][i]
    return out


def section_under(young, t, loads, guess):
    """The section with these forces along a and b and this moment, by Newton's method with differences."""
    section = list(guess)
    for _ in range(30):
        rest = [x - y for x, y in zip(stresses(young, t, section), [*loads, 0])]
        slope = [[0.0] * 4 for _ in range(4)]
        for j in range(4):
            high, low = section[:], section[:]
            high[j] += 1e-6
            low[j] -= 1e-6
            for i, (p, m) in enumerate(zip(stresses(young, t, high), stresses(young, t, low))):
                slope[i][j] = (p - m) / 2e-6
        change = solve4(slope, rest)
        section = [x - y for x, y in zip(section, change)]
        if max(map(abs, change)) < 1e-13:
            break
    return section


def shoot(young, t, length, moment, force, steps=200):
    """(x, z, angle, moment) at the tip from the moment at the clamp, by Runge and Kutta's method."""
    section = [1.0, 0.0, 0.0, 1.0]

    def rate(state):
        nonlocal section
        cosine, sine = math.cos(state[2]), math.sin(state[2])
        section = section_under(young, t, [force * sine, force * cosine, state[3]], section)
        x = section[0] * cosine - section[1] * sine
        return [x, section[0] * sine + section[1] * cosine, section[2], -x * force]
    state, h = [0.0, 0.0, 0.0, moment], length / steps
    for _ in range(steps):
        k1 = rate(state)
        k2 = rate([s + h / 2 * k for s, k in zip(state, k1)])
        k3 = rate([s + h / 2 * k for s, k in zip(state, k2)])
        k4 = rate([s + h * k for s, k in zip(state, k3)])
        state = [s + h / 6 * (p + 2 * q + 2 * r + u) for s, p, q, r, u in zip(state, k1, k2, k3, k4)]
    return state


def tip_under_force(young, t, length, force):
    """(x, z) of the tip under an upward dead force."""
    low, high = 0.0, force * length  # of the moment at the clamp
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if shoot(young, t, length, middle, force)[3] < 0 else (low, middle)
    return shoot(young, t, length, high, force)[:2]
