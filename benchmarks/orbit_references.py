"""Makes orbit_references.json: states and monodromy matrices after one period, in 34-digit arithmetic.

    python benchmarks/orbit_references.py

Extrapolation of the modified midpoint rule (Gragg, Bulirsch, Stoer; Hairer, Norsett, Wanner, Solving
Ordinary Differential Equations I, section II.9), order 24, equal steps, in mpmath numbers, of the field
together with its variational equations. It shares no integrator and no arithmetic with anything that is
measured. Each orbit is computed with two numbers of steps; they must agree to 1e-20. Takes some minutes.
"""

from __future__ import annotations

import json
from collections.abc import Callable

import mpmath
from orbits import PARAMETER, REFERENCES, STATE, TIME, Orbit, orbits

from contwalk.fields.derivative import jacobian
from contwalk.fields.kernel import Kernel

COLUMNS = 12
STEPS = {"Lorenz": (120, 180), "coupled van der Pol": (200, 300), "autobalancer": (240, 360)}
Vector = list[mpmath.mpf]


def main() -> None:
    """Compute, compare, write."""
    mpmath.mp.dps = 34
    found = {}
    for orbit in orbits():
        coarse, fine = (_flow(orbit, steps) for steps in STEPS[orbit.name])
        difference = max(abs(a - b) for a, b in zip(coarse, fine, strict=True))
        print(f"{orbit.name}: the two computations differ by {mpmath.nstr(difference, 2)}", flush=True)
        if difference > 1e-20:
            raise SystemExit("too far apart: more steps are needed")
        digits = [mpmath.nstr(value, 22) for value in fine]
        n = len(orbit.start)
        found[orbit.name] = {"state": digits[:n], "monodromy": digits[n:]}
    REFERENCES.write_text(json.dumps(found, indent=1) + "\n")


def _flow(orbit: Orbit, steps: int) -> Vector:
    """State, then the monodromy matrix row by row."""
    n = len(orbit.start)
    rates = _variational(orbit)
    y = [mpmath.mpf(float(value)) for value in orbit.start]
    y += [mpmath.mpf(int(i == j)) for i in range(n) for j in range(n)]
    length = mpmath.mpf(orbit.period) / steps
    for _ in range(steps):
        y = _extrapolated(rates, y, length)
    return y


def _variational(orbit: Orbit) -> Callable[[Vector], Vector]:
    """Rates of the state and of the matrix of its derivatives."""
    n = len(orbit.start)
    graph = orbit.program.graph
    states = [graph.input(STATE, i) for i in range(n)]
    places: list[tuple[int, int]] = []

    def change(outputs: tuple[int, ...]) -> list[int]:
        rows = jacobian(graph, outputs, states)
        places[:] = [(i, j) for i, row in enumerate(rows) for j in row]
        return [*outputs, *(entry for row in rows for entry in row.values())]

    kernel = Kernel(orbit.program.transformed(change), [TIME, STATE, PARAMETER])
    parameters = [mpmath.mpf(value) for value in orbit.parameters]

    def rates(y: Vector) -> Vector:
        values = kernel.exactly([mpmath.mpf(0)], y[:n], parameters)
        change = [mpmath.mpf(0)] * (n * n)
        for (i, j), entry in zip(places, values[n:], strict=True):
            for k in range(n):
                change[n * i + k] += entry * y[n + n * j + k]
        return [*values[:n], *change]

    return rates


def _extrapolated(rates: Callable[[Vector], Vector], y: Vector, length: mpmath.mpf) -> Vector:
    """One step: the midpoint rule with 2, 4, 6, ... parts, extrapolated in the square of their length."""
    first = rates(y)
    table: list[Vector] = []
    for row in range(COLUMNS):
        parts = 2 * (row + 1)
        table.append(_midpoint(rates, y, first, length / parts, parts))
        for k in range(row - 1, -1, -1):
            ratio = (mpmath.mpf(row + 1) / (k + 1)) ** 2 - 1
            table[k] = [b + (b - a) / ratio for a, b in zip(table[k], table[k + 1], strict=True)]
    return table[0]


def _midpoint(
    rates: Callable[[Vector], Vector], y: Vector, first: Vector, h: mpmath.mpf, parts: int
) -> Vector:
    before, now = y, [a + h * b for a, b in zip(y, first, strict=True)]
    for _ in range(parts - 1):
        before, now = now, [a + 2 * h * b for a, b in zip(before, rates(now), strict=True)]
    return now


if __name__ == "__main__":
    main()
