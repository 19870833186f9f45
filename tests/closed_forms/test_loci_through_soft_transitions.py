"""Curves in two parameters of orbits that pass soft transitions: an oscillator that meets a second spring.

Declared as soft or as hard, the transitions leave the same orbits with the same special points. Along soft
ones the motion may touch the second spring or not, and more or less often, with the curve going on.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache, partial
from itertools import count
from typing import Any

import numpy as np
import pytest
from hybrid_runs import diagram, machine
from loci_of_orbits import FINE, labels, largest

import contwalk as cw
from contwalk.branch import Branch
from contwalk.diagram.reopening import reopened
from contwalk.problems.locus.condensed import OfMultipliers, turned
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.points.fold import fold_system
from contwalk.system import System, Transition

STIFFNESS, GAP = 8.0, 0.5
STATE, FORCE = [0.0, 0.0], 0.5
RANGES = {"omega": (1.2, 1.6), "force": (0.3, 0.8)}
CUTS = (0.4, 0.55)


def spring(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(p.omega * t) - 0.1 * x[1] - x[0]


def two_springs(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.force * math.cos(p.omega * t) - 0.1 * x[1] - x[0] - STIFFNESS * (x[0] - GAP)


def system(role: str) -> System:
    return machine(
        ["q", "v"],
        {"omega": 1.3, "force": FORCE},
        {"free": spring, "contact": two_springs},
        [
            Transition("touch", "free", "contact", lambda t, x, p: GAP - x[0], role=role),
            Transition("leave", "contact", "free", lambda t, x, p: x[0] - GAP, role=role),
        ],
        period=lambda p: 2.0 * math.pi / p.omega,
    )


@cache
def branch(role: str, force: float = FORCE) -> Branch:
    """Orbits along the frequency: two folds of the resonance that the second spring bends."""
    found = diagram(
        system(role),
        "omega",
        RANGES["omega"],
        STATE,
        {"force": force, "omega": 1.3},
        until="settled",
        events={"GR": "ignore"},
        max_step=0.3,
    )
    return found[0]


@cache
def folds(role: str) -> Branch:
    return cw.continue_locus(
        system(role), branch(role), "LP1", RANGES, events={"GR": "ignore"}, marks={"force": CUTS}, **FINE
    )


@pytest.mark.slow
def test_the_curve_of_folds_is_the_one_of_hard_transitions() -> None:
    soft, hard = folds("soft"), folds("hard")
    assert labels(soft) == labels(hard) == ["CPC", *["UZ"] * 4]
    one, other = soft.special("CPC1"), hard.special("CPC1")
    for name in RANGES:
        error = one.errors[name] + other.errors[name]
        assert abs(one.parameters[name] - other.parameters[name]) <= error < 1e-9
    assert abs(one.coefficients["c"]) == pytest.approx(abs(other.coefficients["c"]), rel=1e-4)
    assert largest(soft["omega"]) > one.parameters["omega"] - 1e-12  # it has both of its branches


@pytest.mark.long
@pytest.mark.parametrize("force", CUTS)
def test_branches_along_one_parameter_fold_on_it(force) -> None:
    """Marked points of the curve are solved for on their own, and told with their errors."""
    points = [p for p in branch("soft", force).special_points if p.label == "LP"]
    at = pytest.approx(force, rel=1e-9)
    marked = [p for p in folds("soft").special_points if p.label == "UZ" and p.parameters["force"] == at]
    both = (sorted(each, key=lambda p: p.parameters["omega"]) for each in (points, marked))
    assert len(points) == len(marked) == 2
    for one, other in zip(*both, strict=True):
        error = one.error + other.errors["omega"]
        assert abs(one.parameters["omega"] - other.parameters["omega"]) <= error < 1e-8


@pytest.mark.slow
def test_the_critical_vector_of_a_fold_is_one_of_the_unknowns_that_are_left() -> None:
    """The branch's tangent there; the explicit orbit that it is found on has more unknowns."""
    orbit, sample = reopened(system("soft"), branch("soft"), "LP1")
    fold = next(kind for kind in orbit.point_types if kind.label == "LP")
    for found in (rough := fold.locate(orbit, sample, 0), rough.settled()):
        critical, tangent = found.critical / sample.weights[:-1], sample.tangent[:-1] / sample.weights[:-1]
        cosine = abs(critical @ tangent) / np.linalg.norm(critical) / np.linalg.norm(tangent)
        assert cosine == pytest.approx(1.0, abs=1e-6)  # of the square of how far the point moves


@pytest.mark.long
def test_a_condition_keeps_its_sign_where_other_soft_transitions_are_met() -> None:
    """Singular vectors leave the sign of a bordered inverse open: a curve turned at its first step across a
    soft transition, if it came out as the other one."""
    along = branch("soft")
    orbit, sample = reopened(system("soft"), along, 0)
    legs = [len(orbit.explicit(along.unknowns(k))[0].itinerary.legs) for k in range(len(along))]
    begun = next(k for k in range(1, len(along)) if legs[k] != legs[0])
    orbit, sample = reopened(system("soft"), along, begun - 1)
    near = At(sample.z, sample.weights, 1.0)
    for turns in (False, True):
        made = count()
        folds_there = OfMultipliers(orbit, near, np.zeros(0), partial(conditions_of_folds, made, turns))
        one, other = (folds_there.evaluate(orbit, z)[1][-1] for z in (sample.z, along.unknowns(begun)))
        assert next(made) == 2  # a condition of each
        assert (one * sample.weights) @ (other * sample.weights) > 0.0


def conditions_of_folds(
    made: Iterator[int], turns: bool, orbit: Any, near: At, further: np.ndarray
) -> Augmented:
    """The condition of a fold; if it `turns`, with the other sign from the second one that is made on."""
    found = fold_system(orbit, near)
    return turned(found) if next(made) and turns else found


@cache
def damped_by(role: str) -> System:
    """The two springs with a damping that may be varied."""

    def field(stiffness: float):
        def motion(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = 0.5 * math.cos(p.omega * t) - p.damping * x[1] - x[0] - stiffness * (x[0] - GAP)

        return motion

    return machine(
        ["q", "v"],
        {"omega": 1.3, "damping": 0.1},
        {"free": field(0.0), "contact": field(STIFFNESS)},
        system(role).transitions,
        period=lambda p: 2.0 * math.pi / p.omega,
    )


@pytest.mark.slow
@pytest.mark.parametrize("role", ["soft", "hard"])
def test_a_second_multiplier_is_one_where_nothing_is_damped(role) -> None:
    """The multipliers of a turn have the product exp(-damping T): on a curve of folds both are one at 0.

    The condition of a pair was asked of orbits whose soft transitions are condensed: an internal error.
    """
    given = damped_by(role)
    along = diagram(
        given,
        "omega",
        RANGES["omega"],
        STATE,
        {"omega": 1.3, "damping": 0.1},
        until="settled",
        events={"GR": "ignore"},
        max_step=0.3,
    )[0]
    lower = min((p for p in along.special_points if p.label == "LP"), key=lambda p: p.parameters["omega"])
    ranges = {"omega": RANGES["omega"], "damping": (-0.02, 0.12)}
    curve = cw.continue_locus(given, along, lower.name, ranges, events={"GR": "ignore"}, **FINE)
    (found,) = [point for point in curve.special_points if point.label == "R1"]
    assert found.status == "located"
    assert abs(found.parameters["damping"]) <= found.errors["damping"] < 1e-9
    assert found.spectrum == pytest.approx([1.0, 1.0], abs=1e-4)  # a double one, to the root of rounding


def bounce(t, x, p, x_plus):
    x_plus[0], x_plus[1] = x[0], -0.8 * x[1]


@cache
def to_the_stop(omega: float) -> Branch:
    """Orbits along the force, up to where the motion against the second spring just reaches a stop."""
    values = {"force": 0.1, "omega": omega}
    found = diagram(stopped(), "force", (0.05, 1.5), STATE, values, until="settled", events={"GR": "stop"})
    return found[0]


@cache
def stopped() -> System:
    soft = system("soft")
    stop = Transition("stop", "contact", "contact", lambda t, x, p: 0.8 - x[0], reset=bounce)
    return replace(soft, transitions=(*soft.transitions, stop))


@pytest.mark.long
def test_a_grazing_is_followed_though_its_leg_is_divided_by_soft_transitions() -> None:
    """The curve from the grazing at one frequency has that of another one, found along the force alone."""
    ranges, marks = {"omega": (0.95, 1.25), "force": (0.05, 1.5)}, {"omega": [1.0]}
    curve = cw.continue_locus(stopped(), to_the_stop(1.2), "GR1", ranges, marks=marks, **FINE)
    (marked,) = [p for p in curve.special_points if p.label == "UZ"]
    alone = to_the_stop(1.0).special("GR1")
    error = marked.errors["force"] + alone.error
    assert abs(marked.parameters["force"] - alone.parameters["force"]) <= error < 1e-8
    assert curve.outcome.reason == "bound"


@cache
def damped_upwards(downwards: float) -> System:
    """An oscillator below a stop, whose damper is another one while it falls: it reaches the stop, if it
    just does, where the damper switches, and only while it rises."""

    def damped(c: float):
        def field(t, x, p, dx):
            dx[0] = x[1]
            dx[1] = p.force * math.cos(p.omega * t) - c * x[1] - x[0]

        return field

    return machine(
        ["q", "v"],
        {"omega": 1.3, "force": FORCE},
        {"up": damped(0.3), "down": damped(downwards)},
        [
            Transition("falls", "up", "down", lambda t, x, p: x[1], role="soft"),
            Transition("rises", "down", "up", lambda t, x, p: -x[1], role="soft"),
            Transition("stop", "up", "down", lambda t, x, p: 1.0 - x[0], reset=bounce),
        ],
        period=lambda p: 2.0 * math.pi / p.omega,
    )


def up_to_the_stop(downwards: float, omega: float) -> Branch:
    given = {"force": 0.1, "omega": omega}
    found = diagram(
        damped_upwards(downwards), "force", (0.05, 1.5), STATE, given, until="settled", events={"GR": "stop"}
    )
    return found[0]


@pytest.mark.long
@pytest.mark.parametrize("downwards", [0.3, 0.9])
def test_a_grazing_at_the_instant_of_a_soft_transition_is_followed(downwards) -> None:
    """The instant lay in either of two pieces by rounding, and in the latter nothing touches the stop: the
    curve ended where it began."""
    curve = cw.continue_locus(
        damped_upwards(downwards),
        up_to_the_stop(downwards, 1.2),
        "GR1",
        {"omega": (1.0, 1.3), "force": (0.05, 1.5)},
        marks={"omega": [1.1]},
        **FINE,
    )
    assert curve.outcome.reason == "bound"
    (marked,) = [p for p in curve.special_points if p.label == "UZ"]
    alone = up_to_the_stop(downwards, 1.1).special("GR1")
    error = marked.errors["force"] + alone.error
    assert abs(marked.parameters["force"] - alone.parameters["force"]) <= error < 1e-8
    if downwards == 0.3:  # one damper: the amplitude is one
        exact = [math.hypot(1.0 - w**2, 0.3 * w) for w in curve["omega"]]
        assert curve["force"] == pytest.approx(exact, rel=1e-6)  # errors of steps of the walk
