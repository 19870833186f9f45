"""A relaxation oscillator with an impact: eps x' = x - x^3 / 3 + y, y' = -x; it is thrown back where x falls
through -w.

For w < 1 the orbits are canards: the motion goes along the middle branch, which repels with the rate
(1 - x^2) / eps, down to -w. The multiplier follows from Liouville's formula: the exponential of the
divergence along the orbit, and the speeds across both sections.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hybrid_runs import branch_of, diagram, machine

from contwalk.diagram.reopening import reopened
from contwalk.system import System, Transition

EPS = 0.01
NODES, SHARES = np.polynomial.legendre.leggauss(8)


def oscillator() -> System:
    def field(t, x, p, dx):
        dx[0] = (x[1] - x[0] ** 3 / 3.0 + x[0]) / EPS
        dx[1] = p.a - x[0]

    def thrown(t, x, p, after):
        after[0] = -0.5 * x[0]
        after[1] = x[1] + 0.3

    hit = Transition("hit", "free", "free", lambda t, x, p: x[0] + p.w, reset=thrown)
    return machine(["x", "y"], {"a": 0.0, "w": 1.5}, {"free": field}, [hit])


def speed(x: float, y: float) -> float:
    return (y - x**3 / 3.0 + x) / EPS


def exponent(branch, row: int) -> float:
    """Logarithm of the multiplier's modulus, by quadrature along the orbit."""
    problem, sample = reopened(oscillator(), branch, row)
    (view,) = problem.view(sample.z)
    steps = view.piece.steps
    total = 0.0
    for low, high in pairwise(steps.tolist()):
        x = view.at(0.5 * (low + high) + 0.5 * (high - low) * NODES)[:, 0]
        total += 0.5 * (high - low) * float(SHARES @ (1.0 - x**2)) * view.duration / EPS
    return total + float(np.log(speed(*view.x)) - np.log(-speed(*view.end)))


@pytest.fixture(scope="module")
def canards():
    return branch_of(oscillator(), "w", (0.5, 1.99), [1.5, 0.0], mode="free", until="settled")


def test_canards_are_followed_to_the_end_of_the_range(canards):
    assert canards.outcome.reason == "bound", canards.outcome.message
    assert [point.label for point in canards.special_points] == ["EP", "PD", "EP"]


def test_their_multipliers_follow_liouvilles_formula(canards):
    """From 1e-5 to 1e25."""
    moduli = np.abs(canards.points["spectrum"][:, 0])
    assert moduli.max() > 1e24
    for row in range(0, len(moduli), 8):
        assert np.log(moduli[row]) == pytest.approx(exponent(canards, row), rel=1e-4, abs=1e-4)
        assert canards.points["spectrum"][row, 0].real < 0.0


@pytest.mark.long
def test_doubled_orbits_leave_where_canards_begin():
    found = diagram(
        oscillator(), "w", (0.5, 1.99), [1.5, 0.0], mode="free", until="settled", follow=("PD",)
    )  # fmt: skip
    assert [branch.outcome.status for branch in found] == ["complete"] * len(found)
    assert len(found) >= 2
    doubled = found[1]
    assert max(doubled["period"]) > 1.9 * min(found[0]["period"])
    assert min(doubled["w"]) == 0.5


@pytest.mark.long
def test_a_passage_beside_the_equilibrium_does_not_creep():
    """Its deviations decay before they grow: only those that begin on the way show how much.

    The equilibrium, an unstable focus at x = a, is no limit: beyond a = 0.998740 the orbits are canards along
    the middle branch, and their period is bounded.
    """
    branch = branch_of(oscillator(), "a", (-1.5, 0.99874), [1.5, 0.0], mode="free", until="settled")
    assert branch.outcome.reason == "bound", branch.outcome.message
    late = branch.points[branch["a"] > 0.99]
    assert len(late) < 80
    assert np.all(np.abs(late["spectrum"][:, 0]) < 1e-5)
