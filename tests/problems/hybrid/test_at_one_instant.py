"""Transitions that have one instant by a symmetry: clocks in phase, of which all is known in closed form."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import scipy.linalg

from contwalk.branch import Outcome
from contwalk.diagram.opening import Opening
from contwalk.errors import SystemDefinitionError
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.problems.orbit.itinerary import named_itinerary, stored_leg
from contwalk.system import Mode, Transition
from tests.hybrid_runs import diagram, machine, opened, solution

START = {"push": 0.3, "d": 0.2, "k": 0.5, "c": 0.0}


def clocks(count=2, names=None, **transition):
    """Clocks q'' = -q - d q' that springs of stiffness k couple, each with a kick as it passes 0 upwards.

    c: the speed of each carries the others along.
    """

    def field(t, x, p, dx):
        for i in range(count):
            pull = carried = 0.0
            for j in range(count):
                pull = pull + p.k * (x[2 * j] - x[2 * i])
                carried = carried + (0.0 if i == j else p.c * x[2 * j + 1])
            dx[2 * i] = x[2 * i + 1] + carried
            dx[2 * i + 1] = -x[2 * i] - p.d * x[2 * i + 1] + pull

    def kick(i):
        def reset(t, x, p, after):
            for j in range(2 * count):
                after[j] = x[j] + p.push if j == 2 * i + 1 else x[j]

        return reset

    def guard(i):
        return lambda t, x, p: x[2 * i]

    ticks = [Transition(f"tick{i}", "free", "free", guard(i), "rising", kick(i)) for i in range(count)]
    if names is not None:
        ticks = [dataclasses.replace(next(t for t in ticks if t.name == n), **transition) for n in names]
    states = [name for i in range(count) for name in (f"q{i}", f"v{i}")]
    return machine(states, START, {"free": field}, ticks)


def beaten(together=()):
    """A clock with two resets at one guard that do not commute: a push, and a product."""

    def field(t, x, p, dx):
        dx[0], dx[1] = x[1], -x[0] - p.d * x[1]

    def push(t, x, p, after):
        after[0], after[1] = x[0], x[1] + p.push

    def times(t, x, p, after):
        after[0], after[1] = x[0], p.f * x[1]

    return machine(
        ["q", "v"],
        {"push": 0.3, "d": 0.4, "f": 1.2},
        {"free": field},
        [
            Transition("push", "free", "free", lambda t, x, p: x[0], "rising", push, together=together),
            Transition("times", "free", "free", lambda t, x, p: 2.0 * x[0], "rising", times),
        ],
    )


def in_phase(count):
    return [0.1, 0.5] * count


def period(d):
    return 2.0 * math.pi / math.sqrt(1.0 - 0.25 * d * d)


def multipliers(values, count):
    """Of the common motion, and of a difference of two clocks, which is met count - 1 times."""
    d, push, lasts = values["d"], values["push"], period(values["d"])
    after = push / (1.0 - math.exp(-0.5 * d * lasts))
    jump = np.eye(2) + np.outer([push, -d * push], [1.0, 0.0]) / (after - push)
    apart = scipy.linalg.expm(np.array([[0.0, 1.0], [-1.0 - count * values["k"], -d]]) * lasts)
    return math.exp(-0.5 * d * lasts), np.linalg.eigvals(jump @ apart)


@pytest.mark.parametrize(("count", "names"), [(2, ("tick1", "tick0")), (3, None)])
@pytest.mark.parametrize("scheme", ["shooting", "collocation"])
def test_clocks_in_phase_are_kicked_once_each(count, names, scheme):
    if scheme == "collocation" and count == 3:
        pytest.skip("two tell of the scheme")
    problem, z = solution(clocks(count, names), "push", in_phase(count), until="settled", scheme=scheme)
    own, others = multipliers(START, count)
    speed = 0.3 / (1.0 - own)
    assert problem.duration(z) == pytest.approx(period(0.2), rel=1e-6)
    speeds = np.sort(problem.first_state(z)[1::2])[::-1]
    assert np.allclose(speeds, [speed] + [speed - 0.3] * (count - 1), rtol=1e-6)
    assert len(problem.itinerary) == count
    found = problem.multipliers(z, problem.linearize(z).jacobian).values
    expected = np.concatenate([[own], *[others] * (count - 1)])
    assert np.allclose(np.sort_complex(found.round(5)), np.sort_complex(expected.round(5)), atol=2e-5)
    assert problem.margins(z).admissible


def test_what_they_lose_by_is_located_and_told_without_a_side():
    branches = diagram(
        clocks(), "k", (0.55, 0.7), in_phase(2), {"k": 0.6}, until="settled", follow=["PD"], max_step=0.3
    )
    (branch,) = branches
    doubled = [point for point in branch.special_points if point.label == "PD"]
    assert len(doubled) == 2
    for point in doubled:
        _, others = multipliers(START | {"k": point.parameters["k"]}, 2)
        assert np.abs(others + 1.0).min() < 1e-6
        assert point.criticality is None
        assert "come apart" in point.note


def test_orders_that_differ_in_their_results_are_refused_with_both():
    outcome = opened(beaten(), "push", [0.1, 0.5], until="settled")
    assert isinstance(outcome, Outcome)
    for words in (
        "'push' and 'times'",
        "[push times] leads to",
        "[times push] leads to",
        "together=",
    ):
        assert words in outcome.message


@pytest.mark.parametrize("order", [("push", "times"), ("times", "push")])
def test_a_declared_order_acts(order):
    problem, z = solution(beaten(order), "push", [0.1, 0.5], until="settled")
    left, push, f = math.exp(-0.2 * period(0.4)), 0.3, 1.2
    first_pushed = f * push * left / (1.0 - f * left), push * left / (1.0 - f * left)
    assert problem.itinerary.signature(problem.system) == order
    before = problem.view(z)[1].end[1]
    assert before == pytest.approx(first_pushed[order[0] == "times"], rel=1e-6)
    found = problem.multipliers(z, problem.linearize(z).jacobian)
    assert found.values[0] == pytest.approx(f * left, rel=1e-6)
    assert found.errors[0] < 1e-3  # one guard: no motion has its events apart


def test_stability_is_not_told_where_it_has_two_sides():
    opening = opened(clocks(), "push", in_phase(2), {"c": 0.2}, until="settled")
    assert isinstance(opening, Opening)
    assert opening.state.sample.stable is None
    assert "which of both comes first" in opening.message


def test_an_itinerary_of_one_instant_is_stored_and_restored():
    problem, _ = solution(clocks(), "push", in_phase(2), {"c": 0.2}, until="settled")
    legs = [stored_leg(leg) for leg in problem.itinerary.legs]
    assert named_itinerary(problem.system, legs) == problem.itinerary
    assert [leg.together for leg in problem.itinerary.legs] == [True, False]


def test_what_turns_a_guard_back_at_its_instant_has_it_happen_again():
    """Two balls on a floor that meet just as the lower one lands: it is thrown back down, and lands twice."""

    def field(t, x, p, dx):
        dx[0], dx[1], dx[2], dx[3] = x[1], -1.0, x[3], -1.0

    def land(t, x, p, after):
        after[0], after[1], after[2], after[3] = x[0], -x[1], x[2], x[3]

    def meet(t, x, p, after):
        after[0], after[1], after[2], after[3] = x[0], x[3], x[2], x[1]

    system = machine(
        ["low", "v", "high", "w"],
        {"unused": 0.0},
        [Mode("fall", field)],
        [
            Transition("land", "fall", "fall", lambda t, x, p: x[0], reset=land),
            Transition("meet", "fall", "fall", lambda t, x, p: x[2] - x[0], reset=meet),
        ],
    )
    start = np.array([0.0, -1.0, 0.0, -3.0])
    moved = motion_segments(
        hybrid_machine(system, system.defaults()), 0.0, start, "fall", 1.0, Control(1e-9, np.ones(4))
    )
    names = [segment.transition for segment in moved if len(segment.times) == 1]
    assert names == ["land", "meet", "land", "meet"]


@pytest.mark.parametrize(
    ("together", "words"),
    [
        (("push",), "two transitions or more"),
        ("push", "two transitions or more"),
        (("push", "push"), "two transitions or more"),
        (("push", "tims"), "Did you mean 'times'"),
        (3, "two transitions or more"),
    ],
)
def test_orders_that_say_nothing_are_refused(together, words):
    with pytest.raises(SystemDefinitionError, match=words):
        beaten(together)


def test_orders_that_contradict_each_other_are_refused():
    system = clocks(3)
    turned = [
        dataclasses.replace(each, together=(f"tick{i}", f"tick{(i + 1) % 3}"))
        for i, each in enumerate(system.transitions)
    ]
    with pytest.raises(SystemDefinitionError, match="comes before itself"):
        dataclasses.replace(system, transitions=tuple(turned))
