"""Three orbits by which integrators are measured: equations, starting points, times, and where they end.

A starting point is exact as it stands: the orbit closes to 1e-14 from there, and the reference values are
those of the very doubles given here. `orbit_references.json` holds them; `orbit_references.py` made it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import contwalk as cw
from contwalk.fields.trace import Program, trace
from contwalk.flow.compiled.field import Field
from contwalk.flow.compiled.traced import field_of, field_program

REFERENCES = Path(__file__).with_name("orbit_references.json")
TIME, STATE, PARAMETER = "t", "x", "p"


@dataclass(frozen=True)
class Orbit:
    """A vector field, a point on one of its periodic orbits, and the orbit's period."""

    name: str
    about: str
    program: Program
    field: Field
    parameters: tuple[float, ...]
    start: np.ndarray
    period: float

    @cached_property
    def reference(self) -> tuple[np.ndarray, np.ndarray]:
        """State and monodromy matrix after one period, right to the last digit of a double."""
        stored = json.loads(REFERENCES.read_text())[self.name]
        n = len(self.start)
        return np.array(stored["state"], float), np.array(stored["monodromy"], float).reshape(n, n)

    def error(self, state: np.ndarray, monodromy: np.ndarray) -> float:
        """Largest error of the state or the matrix, each relative to the largest entry of its own."""
        pairs = zip((state, monodromy), self.reference, strict=True)
        return max(float(np.max(np.abs(a - b)) / np.max(np.abs(b))) for a, b in pairs)


def orbits() -> list[Orbit]:
    """The three, from few states to eight."""
    lorenz = _traced(
        "Lorenz",
        "3 states, one loop round each wing; the unstable multiplier is 4.7",
        _lorenz,
        (10.0, 28.0, 8.0 / 3.0),
        [-13.763610682134182, -19.578751942451795, 26.99999999999994],
        1.5586522107161747,
    )
    van_der_pol = _traced(
        "coupled van der Pol",
        "8 states, a ring of four oscillators",
        _van_der_pol,
        (0.5, 1.0, 1.1, 0.9, 1.05),
        [
            *(-0.0018841232856371879, 2.1780053510353548, -0.039464513308171155, 2.2496520216063187),
            *(0.13349799063867968, 2.1407801454391917, 0.06086223456969938, 2.2629143340319726),
        ],
        6.673002482604011,
    )
    return [lorenz, van_der_pol, _autobalancer()]


def _lorenz(x: Sequence[Any], p: Sequence[Any]) -> list[Any]:
    return [p[0] * (x[1] - x[0]), x[0] * (p[1] - x[2]) - x[1], x[0] * x[1] - p[2] * x[2]]


def _van_der_pol(x: Sequence[Any], p: Sequence[Any]) -> list[Any]:
    """Oscillators of unequal strength p[1:], each pulled towards its two neighbours with stiffness p[0]."""
    rates = []
    for j in range(4):
        q, v = x[2 * j], x[2 * j + 1]
        left, right = x[2 * ((j - 1) % 4)], x[2 * ((j + 1) % 4)]
        rates += [v, p[1 + j] * (1.0 - q * q) * v - q + p[0] * (left + right - 2.0 * q)]
    return rates


def _traced(
    name: str,
    about: str,
    rates: Callable[[Sequence[Any], Sequence[Any]], list[Any]],
    parameters: tuple[float, ...],
    start: list[float],
    period: float,
) -> Orbit:
    n, m = len(start), len(parameters)
    program = trace(
        lambda tracer: rates(
            [tracer.symbol(STATE, i) for i in range(n)], [tracer.symbol(PARAMETER, i) for i in range(m)]
        )
    )
    field = Field(program, [(STATE, i) for i in range(n)], {PARAMETER: m})
    return Orbit(name, about, program, field, parameters, np.array(start), period)


def _autobalancer() -> Orbit:
    system = cw.load_system("autobalancer", {"masses": 2})
    values = {**system.presets["heavy"], "delta": 0.0045}
    start = [
        *(-0.0035643681395639017, 0.0010004133087968077, 2.405126934419228, -1.934401662073269),
        *(0.0017265998127460743, 0.0026717536149820156, 0.3118540074020811, -0.07910265844732856),
    ]
    return Orbit(
        "autobalancer",
        "8 states, the limit cycle of the heavy correction masses at delta = 0.0045",
        field_program(system),
        field_of(system),
        tuple(values[name] for name in system.parameter_names),
        np.array(start),
        13.24715841403226,
    )
