"""A machine whose transitions are all watched has limits too: orbits that touch them are grazing."""

import numpy as np
import pytest

import contwalk as cw
from contwalk.system import Mode, Observable, Parameter, State, System, Transition


def ring(t, x, p, dx):
    square = x[0] ** 2 + x[1] ** 2
    dx[0] = p.mu * x[0] - x[1] - x[0] * square
    dx[1] = x[0] + p.mu * x[1] - x[1] * square


WATCHED = System(
    name="ring",
    states=(State("x"), State("y")),
    parameters=(Parameter("mu", -0.2), Parameter("wall", 0.5)),
    modes=(Mode("only", ring),),
    transitions=(Transition("room", "only", "only", guard=lambda t, x, p: p.wall - x[0], role="watched"),),
    observables=(Observable("width", lambda t, x, p: x[:, 0].max()),),
)


def test_a_cycle_that_touches_what_is_watched_grazes():
    """The cycle has the radius sqrt(mu)."""
    problem = cw.Equilibrium(WATCHED, WATCHED.defaults(), free="mu")
    rest = cw.continue_branch(problem, [0.0, 0.0], range=(-0.2, 0.5))
    cycle = cw.switch_branch(problem, rest, "HB1", range=(-0.2, 0.5))
    assert cycle.info.problem == "hybrid_orbit"
    (touching,) = [point for point in cycle.special_points if point.label == "GR"]
    assert touching.kind == "interior"
    assert abs(touching.parameters["mu"] - 0.25) <= touching.error <= 1e-8
    assert cycle.outcome.reason == "grazing"  # as `events: {GR: stop}`, the default
    # One that follows the margin is told with every other row.
    inside = cycle["mu"] > 0.05
    assert cycle["room"][inside] == pytest.approx(0.5 - np.sqrt(cycle["mu"][inside]), abs=1e-6)


def test_an_equilibrium_past_what_is_watched_is_not_admissible():
    from contwalk.problems.passed_over import passed_over

    for place, past in {0.4: False, 0.6: True}.items():
        assert passed_over(WATCHED, np.zeros(1), np.array([[place, 0.0]]), WATCHED.defaults()) is past
