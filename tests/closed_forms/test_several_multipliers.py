"""Cycles of which several multipliers pass 1 or -1 together: located, and what symmetries keep leaves there.

On a circle of radius 1, gone round in 2 pi, the transversal states u_i of u_i' = (K - 0.3) u_i - u_i^3 have
the multiplier exp(2 pi (K - 0.3)), all of them.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Symmetry


def ends_of(branch):
    """The ends of a branch."""
    return [p for p in labelled(branch, "EP") if p.kind == "bound"]


def circle_with(count, units, order):
    """The circle, and so many transversal states, in units of their own and some order."""

    def field(t, x, p, dx):
        a, b, *u = (x[k] / units[i] for i, k in enumerate(order))
        growth = 1.0 - a * a - b * b
        rates = [growth * a - b, a + growth * b, *((p.K - 0.3) * v * (1.0 + 0.5 * a) - v**3 for v in u)]
        for i, k in enumerate(order):
            dx[k] = units[i] * rates[i]

    start = np.zeros(count + 2)
    start[order[0]] = units[0]
    return field, start


def brusselators(t, x, p, dx):
    """Three of them, each coupled to both others: in phase they go round in 3.9828510."""
    for i in range(3):
        a, b = x[2 * i], x[2 * i + 1]
        a1, b1, a2, b2 = (x[(2 * i + k) % 6] for k in (2, 3, 4, 5))
        dx[2 * i] = 2.0 - 6.5 * a + a**2 * b + 0.1 * p.K * (a1 + a2 - 2.0 * a)
        dx[2 * i + 1] = 5.5 * a - a**2 * b + p.K * (b1 + b2 - 2.0 * b)


def walked(field, state, begin, reach, period, follow=("BP", "PD"), **declared):
    system = small_system(field, [f"x{i}" for i in range(len(state))], {"K": begin}, **declared)
    steps, settings = cw.Discretization(accuracy=1e-8), Settings(range=reach, max_points=300)
    values = {"K": begin}
    opening = opened_orbit(system, values, "K", state, settings, discretization=steps, **period)
    plan = Plan(settings, frozenset(follow), 1)
    made = Diagram([Start(system, "K", values, opening, "start")], plan)
    assert list(made.events())
    return made.branches


@pytest.mark.parametrize(
    ("count", "units", "order"),
    [
        (2, (1.0, 1.0, 1.0, 1.0), (0, 1, 2, 3)),
        (2, (1e3, 1e3, 1e-4, 1e-4), (3, 0, 2, 1)),
        (2, (1.0, 5.0, 20.0, 0.1), (1, 3, 0, 2)),
        (3, (1.0, 1.0, 1.0, 1.0, 1.0), (2, 0, 3, 1, 4)),
        (4, (1.0, 2.0, 1.0, 1e2, 1e-2, 3.0), (0, 1, 2, 3, 4, 5)),
    ],
)
def test_several_multipliers_at_one_are_located(count, units, order) -> None:
    field, start = circle_with(count, units, order)
    branch, *others = walked(field, start, 0.1, (0.1, 0.6), {"period": 2.0 * np.pi})
    (point,) = labelled(branch, "BP", "LP", "PD")
    assert point.status == "located"
    assert abs(point.parameters["K"] - 0.3) <= max(point.error, 1e-12)
    assert point.coefficients["multiplicity"] == count
    assert f"{count} multipliers are 1 together" in point.note
    assert (point.unstable_before, point.unstable_after) == (0, count)
    assert branch.outcome.reason == "bound"
    # An exchange of equal states keeps what has all of them alike; nothing is known to keep other directions.
    assert len(others) == (units[2:].count(units[2]) == count)
    for other in others if units[2] == 1.0 else ():  # how far it goes in smaller units no orbit tells
        assert other.outcome.reason == "bound"
        ends = np.array([[p.state[f"x{order[i]}"] for i in range(2, count + 2)] for p in ends_of(other)])
        assert np.abs(ends).min() > 0.3 * units[2]
        assert np.abs(ends) == pytest.approx(np.abs(ends[:, :1]) * np.ones(count), rel=1e-9)


@pytest.mark.slow
def test_three_brusselators_in_phase() -> None:
    """Multipliers of the variational equation of deviations, by SciPy's DOP853 at 1e-12, each twice."""
    state = np.tile([1.0, 2.0], 3)
    (branch,) = walked(brusselators, state, 0.01, (0.01, 0.5), {"until": "settled"}, follow=())
    assert branch.outcome.reason == "bound"
    found = labelled(branch, "PD", "BP", "LP", "TR")
    assert [p.label for p in found] == ["PD", "PD", "PD", "PD", "BP"]
    assert {p.status for p in found} == {"located"}
    assert all("together" in p.note and p.coefficients["multiplicity"] == 2 for p in found)
    known = [0.0569431284751] * 2 + [0.3529828390254] * 2 + [0.3851215259002]
    assert [p.parameters["K"] for p in found] == pytest.approx(known, abs=1e-10)  # an accuracy of 1e-8
    # Doublings are told one by one, and counted one after the other.
    assert [p.unstable_after for p in found] == [1, 2, 1, 0, 2]


def turned(t, x, p, image):
    for i in range(6):
        image[i] = x[(i + 2) % 6]


def exchanged(t, x, p, image):
    for i in range(6):
        image[i] = x[(i + 2) % 4 if i < 4 else i]


def closes(branch, end):
    """How far SciPy's motion is from its start after half the period, and after all of it."""
    state = np.array([end.state[f"x{i}"] for i in range(6)])

    def rates(t, x):
        dx = np.zeros(6)
        brusselators(t, x, SimpleNamespace(K=end.parameters["K"]), dx)
        return dx

    times = [0.5 * end.period_full, end.period_full]
    motion = solve_ivp(rates, (0.0, times[1]), state, "DOP853", times, rtol=1e-12, atol=1e-12)
    return np.abs(motion.y.T - state).max(axis=1)


@pytest.mark.slow
def test_doubled_orbits_of_three_brusselators() -> None:
    """Of two multipliers at -1 one orbit leaves with two cells alike, and one that an exchange closes up."""
    state, given = np.tile([1.0, 2.0], 3), (0.04, (0.04, 0.1), {"until": "settled"})
    branch, alike = walked(brusselators, state, *given)
    assert "x2 -> x4 -> x2, x3 -> x5 -> x3" in labelled(branch, "PD")[0].note
    symmetries = tuple(Symmetry(f.__name__, "spatial", f) for f in (turned, exchanged))
    _, *declared = walked(brusselators, state, *given, symmetries=symmetries)
    assert len(declared) == 2
    for each in (alike, *declared):
        (end,) = ends_of(each)
        assert each.outcome.reason == "bound"
        half, whole = closes(each, end)
        assert whole < 1e-6 < 1e-2 < half
    # One is stable, as simulations from random starts come to it at K = 0.07.
    assert sorted(ends_of(each)[0].unstable_after for each in declared) == [0, 1]


@pytest.mark.slow
def test_cycles_that_leave_three_brusselators() -> None:
    """Of two multipliers at 1 a branch leaves, to both sides, with two cells alike."""
    state = np.tile([1.0, 2.0], 3)
    branch, other = walked(brusselators, state, 0.37, (0.37, 0.387), {"until": "settled"})
    assert [p.label for p in labelled(branch, "BP", "PD")] == ["BP"]
    assert [p.parameters["K"] for p in ends_of(other)] == [0.37, 0.387]
    for end in ends_of(other):
        assert closes(other, end)[1] < 1e-6
        values = np.array([end.state[f"x{i}"] for i in range(6)]).reshape(3, 2)
        apart = [np.abs(values[i] - values[j]).max() for i, j in ((0, 1), (0, 2), (1, 2))]
        assert min(apart) < 1e-9 < 1e-2 < max(apart)
