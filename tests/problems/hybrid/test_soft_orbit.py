"""Machines with soft and with hard transitions: branches go on where soft ones join and leave.

A forced oscillator hits a wall on one side and reaches a second spring on the other, at a distance that it
only comes to where the force is large. What the spring does sets in continuously: a soft transition. The
same machine with `max` in its field has one mode.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hybrid_runs import ACCURACY, diagram, machine, solution

from contwalk.branch import Branch, SpecialPoint
from contwalk.problems.hybrid.forward_solution import solved_forward
from contwalk.problems.hybrid.grouping import Grouping
from contwalk.problems.hybrid.rotated import rotated
from contwalk.problems.hybrid.soft_orbit import SoftOrbit, softened_seed
from contwalk.problems.orbit import equations, monodromy
from contwalk.problems.problem import Seed
from contwalk.system import System, Transition

ZETA, OMEGA, WALL, GAP, STIFFNESS, RESTITUTION = 0.05, 1.2, 0.2, 1.2, 6.0, 0.7
PERIOD = 2.0 * math.pi / OMEGA
RANGE, START = (0.6, 1.6), [0.0, 0.5]
MARKS = (0.8, 1.2, 1.5)


def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(OMEGA * t) - 2.0 * ZETA * x[1] - x[0]


def held(t, x, p, dx):
    free(t, x, p, dx)
    dx[1] = dx[1] - STIFFNESS * (x[0] + GAP)


def bent(t, x, p, dx):
    free(t, x, p, dx)
    dx[1] = dx[1] + STIFFNESS * max(-x[0] - GAP, 0.0)


def wall(t, x, p):
    return WALL - x[0]


def bounce(t, x, p, after):
    after[0], after[1] = x[0], -RESTITUTION * x[1]


def reaches(t, x, p):
    return x[0] + GAP


def lets_go(t, x, p):
    return -x[0] - GAP


def system() -> System:
    return machine(
        ["q", "v"],
        {"force": 1.0},
        {"free": free, "spring": held},
        [
            Transition("hit", "free", "free", wall, reset=bounce),
            Transition("reach", "free", "spring", reaches, role="soft"),
            Transition("let_go", "spring", "free", lets_go, role="soft"),
        ],
        period=lambda p: PERIOD,
    )


def whole() -> System:
    return machine(
        ["q", "v"],
        {"force": 1.0},
        {"all": bent},
        [Transition("hit", "all", "all", wall, reset=bounce)],
        period=lambda p: PERIOD,
    )


@cache
def branch(soft: bool) -> Branch:
    found = diagram(
        system() if soft else whole(),
        "force",
        RANGE,
        START,
        until="settled",
        events={"GR": "stop", "OC": "stop"},
        marks={"force": MARKS},
    )
    return found[0]


def marked(found: Branch) -> list[SpecialPoint]:
    return [point for point in found.special_points if point.label == "UZ"]


def test_the_branch_goes_on_where_the_spring_is_reached():
    found = branch(True)
    assert found.info.signature == ("hit",)
    assert found.outcome.reason == "bound"
    assert {point.label for point in found.special_points} == {p.label for p in branch(False).special_points}
    assert sorted({len(found.unknowns(k)) for k in range(len(found.points))}) == [5]
    # On one side the spring is reached, on the other not.
    problem, z = solution(system(), "force", START, {"force": RANGE[0]}, until="settled")
    assert isinstance(problem, SoftOrbit)
    assert len(problem.explicit(z)[0].itinerary) == 1
    problem, z = solution(system(), "force", START, {"force": RANGE[1]}, until="settled")
    assert len(problem.explicit(z)[0].itinerary) == 3


def test_orbits_and_multipliers_are_those_of_the_bent_field():
    ours, others = marked(branch(True)), marked(branch(False))
    assert len(ours) == len(others) == len(MARKS)
    for one, other in zip(ours, others, strict=True):
        # The bend costs the smooth integrator some digits.
        np.testing.assert_allclose(np.poly(one.spectrum), np.poly(other.spectrum), rtol=0, atol=1e-5)
        for name in ("q", "v"):
            assert one.state[name] == pytest.approx(other.state[name], abs=1e-5)


def test_determinant():
    """Springs take nothing: e^2 exp(-2 zeta T), on both sides of where the spring is first reached."""
    products = np.prod(branch(True).points["spectrum"], axis=1)
    expected = RESTITUTION**2 * math.exp(-2.0 * ZETA * PERIOD)
    np.testing.assert_allclose(products, expected, rtol=0, atol=1e3 * ACCURACY)


def test_what_is_eliminated_leaves_exact_derivatives():
    """The Jacobian of what is left against differences of the residual, on the same steps."""
    problem, z = solution(system(), "force", START, {"force": 1.5}, until="settled")
    jacobian = problem.jacobian(z)
    for k in range(len(z)):
        h = 1e-5 * max(abs(z[k]), 1.0)
        up, down = z.copy(), z.copy()
        up[k] += h
        down[k] -= h
        difference = (problem.linearize(up).residual - problem.linearize(down).residual) / (2.0 * h)
        np.testing.assert_allclose(jacobian[:, k], difference, rtol=0, atol=1e-6)


def test_unknowns_are_split_and_joined_again():
    problem, z = solution(system(), "force", START, {"force": 1.5}, until="settled")
    assert isinstance(problem, SoftOrbit)
    explicit, unknowns = problem.explicit(z)
    grouping = Grouping(explicit.itinerary, explicit.layout)
    own, soft = grouping.split(unknowns)
    np.testing.assert_allclose(own, z, rtol=1e-14)
    np.testing.assert_array_equal(grouping.joined(own, soft), unknowns)
    rows = np.sort(np.concatenate([grouping.hard_rows, grouping.soft_rows]))
    np.testing.assert_array_equal(rows, np.arange(explicit.size))
    direction = np.cos(np.arange(len(own))), np.sin(np.arange(len(soft)))
    by_own, by_soft = grouping.columns(explicit.jacobian(unknowns))
    np.testing.assert_allclose(
        explicit.jacobian(unknowns) @ grouping.joined(*direction),
        by_own @ direction[0] + by_soft @ direction[1],
        rtol=1e-12,
        atol=1e-12,
    )


def test_what_is_eliminated_is_solved_for_in_the_order_of_the_motion():
    """Instants and states at the spring from guesses that are a thousandth off, without derivatives."""
    problem, z = solution(system(), "force", START, {"force": 1.5}, until="settled")
    assert isinstance(problem, SoftOrbit)
    explicit, unknowns = problem.explicit(z)
    grouping = Grouping(explicit.itinerary, explicit.layout)
    own, soft = grouping.split(unknowns)
    begun = grouping.joined(own, soft + 1e-3 * np.cos(np.arange(len(soft))))
    found = solved_forward(explicit, grouping, z, begun)
    # Levels of the equations are a part of the tolerance of the steps; these are solved to rounding.
    there = grouping.joined(z, found)
    residual = explicit.residual(there)[grouping.soft_rows]
    assert np.all(np.abs(residual) <= explicit.linearize(there).levels[0][grouping.soft_rows])
    np.testing.assert_allclose(found, soft, rtol=0, atol=1e-2 * problem.mesh.tolerance)


def test_a_piece_that_does_not_come_to_its_guard_is_left_as_it_is():
    problem, z = solution(system(), "force", START, {"force": 1.5}, until="settled")
    assert isinstance(problem, SoftOrbit)
    explicit, unknowns = problem.explicit(z)
    grouping = Grouping(explicit.itinerary, explicit.layout)
    away = z.copy()
    away[problem.layout.states[0]] = 0.0  # at rest, with no force worth the name, it never gets there
    away[-1] = 1e-3
    np.testing.assert_array_equal(
        solved_forward(explicit, grouping, away, unknowns), grouping.split(unknowns)[1]
    )


def test_a_regular_step_takes_few_passes_with_derivatives(monkeypatch):
    """One where the solution is, and one on the steps that are made for it."""
    passes, points = [], []
    with_derivatives = equations.with_derivatives

    def counted(orbit, z):
        passes.append(len(points))
        return with_derivatives(orbit, z)

    monkeypatch.setattr(equations, "with_derivatives", counted)
    found = diagram(
        system(), "force", (1.4, 1.6), START, {"force": 1.45}, until="settled", direction="up", max_step=0.05
    )[0]
    points += found.points.tolist()
    assert len(points) >= 6
    # The start takes some of its own, and so do ends; three a step were twice as many.
    assert len(passes) <= 2 * len(points) + 12


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("other", [1.0, -1.0])
def test_a_seed_that_begins_with_another_event_keeps_its_way(way, other):
    """Its null direction is computed anew: of that, the sign of the parameter's component is the seed's."""
    problem, z = solution(system(), "force", START, {"force": 1.5}, until="settled")
    assert isinstance(problem, SoftOrbit)
    explicit, unknowns = rotated(*problem.explicit(z), 1)
    assert explicit.itinerary.legs[-1].soft
    tangent = np.zeros(len(unknowns))
    tangent[-2:] = other, way
    found = softened_seed(Seed("GR", unknowns, tangent, np.abs, explicit))
    assert isinstance(found.problem, SoftOrbit)
    assert np.sign(found.tangent[-1]) == way
    jacobian = found.problem.jacobian(found.z)
    # A null vector, to the rounding of sums whose terms these are.
    assert np.abs(jacobian @ found.tangent) == pytest.approx(
        0.0, abs=1e-10 * float(np.max(np.abs(jacobian) @ np.abs(found.tangent)))
    )


def test_doubt_of_multipliers_is_carried_once_round():
    """Two foci with a switching line between them: where the flow's own multiplier is all wrong, each may
    be off by what the closure lets grow, and that is no less than the multiplier itself.
    """
    fields = {
        "right": lambda t, x, p, dx: _turning(x, p, dx, 0.3),
        "left": lambda t, x, p, dx: _turning(x, p, dx, -0.5),
    }
    line = [
        Transition("enters", "right", "left", lambda t, x, p: x[0], role="soft"),
        Transition("leaves", "left", "right", lambda t, x, p: x[0], "rising", role="soft"),
    ]
    two = machine(["x", "y"], {"mu": 0.5}, fields, line)
    problem, z = solution(two, "mu", [1.0, 0.0], until="settled")
    there = problem._at(z)
    jacobian = there.explicit.jacobian(there.unknowns)
    assert len(monodromy.chain(there.explicit, jacobian)) > 1
    found = there.explicit.multipliers(there.unknowns, jacobian)
    doubted = monodromy.doubted(there.explicit, found, 1.0, jacobian)
    assert doubted.accuracy >= abs(found.values[0])
    assert monodromy.doubted(there.explicit, found, 1e-9, jacobian) is found


def _turning(x, p, dx, growth):
    dx[0], dx[1] = growth * x[0] + x[1], p.mu - x[0]
