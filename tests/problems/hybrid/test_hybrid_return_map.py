"""The map once round a hybrid orbit: its derivatives along curves, and the multipliers, against other ways
to get them.
"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from contwalk_systems.impact_oscillator import SYSTEM as OSCILLATOR
from hybrid_machines import CASES, orbit, simulated
from hybrid_runs import solution

from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.piece import Piece

# A polynomial of this degree through points along a curve; its length is in units of the orbit's variation,
# and shorter where maps bend more. eps / h^j and the next power limit what derivatives are known to.
DEGREE, NODES, SPAN, SPANS = 8, 9, 0.02, {"walker": 0.008, "soft": 0.01}
KNOWN = (1e-9, 1e-7, 1e-5)
# Multipliers are known to a hundred times the accuracy of an orbit.
ACCURACY = 1e-11


@cache
def quiet() -> tuple[HybridOrbit, np.ndarray]:
    """A forced orbit that meets no event."""
    return solution(OSCILLATOR, "omega", [0.0, 0.0], {"force": 0.3}, until="settled")


ORBITS = {name: lambda name=name: orbit(name) for name in CASES} | {"no events": quiet}


def image(problem: HybridOrbit, z: np.ndarray, first: int, start: np.ndarray, lam: float) -> np.ndarray:
    """State (and time) after one round on the problem's own steps, each event found by Newton's method.

    `start` holds the displacements of the states of leg `first`, and of its time where that counts.
    """
    z = z.copy()
    z[-1] += lam
    x, scalars = problem.layout.inputs(first, z)
    width = len(x)
    x = x + start[:width]
    timed = problem.timed(first)
    begin = (float(scalars[1]) if problem.forced else 0.0) + (float(start[width]) if timed else 0.0)
    whole = problem.subharmonic * float(_period(problem, z)) if problem.forced else 0.0
    spent = 0.0
    for k in range(problem.layout.legs):
        i = (first + k) % problem.layout.legs
        piece, lasting = problem.pieces[i], float(z[problem.layout.durations][i])
        own = problem.layout.inputs(i, z)[1].copy()
        if problem.forced:
            own[1] = begin
        if problem.itinerary.legs[i].transition is not None:
            for _ in range(20):
                own[0] = lasting
                end, moved = piece.differentiated(PLAIN, x, own)
                width = len(piece.passage.following)
                step = end[width] / moved[width, len(x)]
                lasting -= step
                if abs(step) < 1e-15 * abs(lasting):
                    break
        else:
            lasting = whole - spent
        own[0] = lasting
        x = piece.end(PLAIN, x, own)[: len(piece.passage.following)]
        begin += lasting
        spent += lasting
    if not timed:
        return x
    return np.append(x, begin - whole)


def _period(problem: HybridOrbit, z: np.ndarray) -> float:
    assert problem.system.period is not None
    return float(problem.system.period(SimpleNamespace(**problem.values_of(z))))


@pytest.mark.parametrize("name", ORBITS)
@pytest.mark.parametrize("lam", [0.0, 1.0])
def test_derivatives_along_a_curve(name, lam):
    """Orders 1 to 3 of the image of xi = s x1 + s^2 x2 / 2, parameter moved by s lam, against polynomials."""
    problem, z = ORBITS[name]()
    map_ = problem.return_map(z)
    r = map_.basis.shape[1]
    x1, x2 = 0.3 * np.cos(1.0 + np.arange(r)), 0.2 * np.sin(2.0 + np.arange(r))
    lam *= 0.1 * max(abs(z[-1]), 0.1)
    span = SPANS.get(name, SPAN)
    s = span * np.linspace(-1.0, 1.0, NODES)
    ends = np.array(
        [image(problem, z, map_.first, map_.basis @ (t * x1 + 0.5 * t * t * x2), t * lam) for t in s]
    )
    places = (ends - ends[NODES // 2]) @ map_.coordinates.T
    fitted = np.polynomial.polynomial.polyfit(s / span, places, DEGREE)
    found = map_.curve(x1, x2, lam, 3)
    for order, (exact, rel) in enumerate(zip(found, KNOWN, strict=True), start=1):
        expected = fitted[order] * float(np.prod(np.arange(1, order + 1))) / span**order
        size = max(1.0, float(np.abs(expected).max()))
        np.testing.assert_allclose(exact, expected, rtol=0, atol=rel * size)


@pytest.mark.parametrize("name", ORBITS)
def test_matrix_is_the_first_derivative(name):
    problem, z = ORBITS[name]()
    map_ = problem.return_map(z)
    r = map_.basis.shape[1]
    columns = [map_.curve(direction, None, 0.0, 1)[0] for direction in np.eye(r)]
    np.testing.assert_allclose(
        map_.a, np.column_stack(columns), rtol=0, atol=1e-12 * max(1.0, np.abs(map_.a).max())
    )


def differenced(name: str) -> tuple[np.ndarray, np.ndarray, int]:
    """Derivative of scipy's map from the smallest leg's start to itself, and stored multipliers.

    Central differences of sixth order with 1e-2 of the variation: truncation and rounding are some 1e-11.
    """
    problem, z = orbit(name, ACCURACY)
    first = problem.smallest
    timed = problem.timed(first)
    x, _ = problem.layout.inputs(first, z)
    t = float(problem.starting_times(z)[first]) if problem.forced else 0.0
    durations = z[problem.layout.durations]
    p, size = SimpleNamespace(**problem.values_of(z)), problem.extended(first)

    def at(start: np.ndarray) -> np.ndarray:
        end, time = simulated(
            problem, p, first, start[: len(x)], t + (start[-1] if timed else 0.0), durations
        )
        return np.append(end, time - t) if timed else end

    base, columns = np.append(x, 0.0) if timed else x, []
    for j in range(len(base)):
        h = np.zeros(len(base))
        h[j] = 1e-2 * size[j] * (0.1 if timed and j == len(x) else 1.0)
        values = [at(base + k * h) for k in (-3, -2, -1, 1, 2, 3)]
        weights = (-1.0, 9.0, -45.0, 45.0, -9.0, 1.0)
        columns.append(sum(w * v for w, v in zip(weights, values, strict=True)) / (60.0 * h[j]))
    matrix = np.column_stack(columns)
    found = problem.multipliers(z, problem.linearize(z).jacobian)
    return matrix / size[:, None] * size, found.values, len(base)


@pytest.mark.parametrize("name", CASES)
def test_multipliers_are_those_of_the_simulated_map(name):
    """The flow's own direction has the eigenvalue zero: a later start meets the event all the same."""
    matrix, values, n = differenced(name)
    expected = np.poly(matrix)
    found = np.poly(np.append(values, np.zeros(n - len(values))))
    size = max(1.0, float(np.abs(matrix).max()))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * size)


@pytest.mark.parametrize("name", CASES)
def test_number_of_multipliers(name):
    """States of the smallest mode, less the flow's own direction unless time counts."""
    problem, z = orbit(name)
    least = min(len(problem.system.states_of(leg.mode)) for leg in problem.itinerary.legs)
    expected = least - (0 if problem.system.period else 1)
    assert problem.spectrum_size == expected
    assert len(problem.multipliers(z, problem.linearize(z).jacobian).values) == expected


@pytest.mark.parametrize("name", ORBITS)
def test_curves_with_one_first_derivative_share_their_second_one(name, monkeypatch):
    """A second curve along the same line integrates each segment once, for its third derivative."""
    problem, z = ORBITS[name]()
    map_ = problem.return_map(z)
    r = map_.basis.shape[1]
    x1, x2 = np.cos(np.arange(r)), np.sin(np.arange(r))
    map_.curve(x1, None, 0.0, 2)
    asked: list[str] = []
    whole = Piece.end
    monkeypatch.setattr(
        Piece, "end", lambda own, lift, *given: asked.append(lift) or whole(own, lift, *given)
    )
    map_.curve(x1, x2)
    assert asked.count("jet") == len(problem.segments)
