"""Simulations as starts: one that comes to rest starts the branch of equilibria."""

import numpy as np
import pytest
from small_systems import labelled, small_system

from contwalk.branch import Outcome
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.flow.hybrid.motions import MotionSegment, hybrid_machine
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.initial.coming_to_rest import check_moves
from contwalk.problems.initial.recurrence import AtRest
from contwalk.studies.opening_orbits import opened_orbit
from contwalk.system import Mode, Parameter, State, System, Transition


def brusselator(t, x, p, dx):
    dx[0] = p.A - (p.B + 1.0) * x[0] + x[0] ** 2 * x[1]
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1]


def node_at_zero(t, x, p, dx):
    dx[0] = (p.B - 2.0) * x[0] - x[0] ** 3 + p.A * x[1]
    dx[1] = -x[1]


CASES = [(brusselator, [1.3, 1.2], "HB", 2.0), (node_at_zero, [0.7, -0.4], "BP", 2.0)]


@pytest.mark.drawn(2)
@pytest.mark.parametrize(("field", "start", "label", "expected"), CASES)
@pytest.mark.parametrize("until", ["settled", 30.0])
def test_a_simulation_that_comes_to_rest_starts_the_equilibria(field, start, label, expected, until):
    values = {"A": 1.0, "B": 1.5}
    system = small_system(field, "xy", values)
    settings = Settings(range=(1.0, 3.0))
    opening = opened_orbit(system, values, "B", np.array(start), settings, None, until=until)
    assert not isinstance(opening, Outcome), opening.message
    assert isinstance(opening.problem, Equilibrium)
    made = Diagram([Start(system, "B", values, opening, "start")], Plan(settings, frozenset(), 0))
    list(made.events())
    (branch,) = made.branches
    assert branch.info.problem == "equilibrium"
    assert "came to rest at an equilibrium" in branch.outcome.message
    assert (branch["B"].min(), branch["B"].max()) == (1.0, 3.0)
    (point,) = labelled(branch, label)
    assert point.parameters["B"] == pytest.approx(expected, rel=1e-13)


def above(t, x, p):
    return 1.0 - x[0]


def back(t, x, p, out):
    out[0] = -0.5
    out[1] = 0.5 * x[1]


def node(t, x, p, dx):
    dx[0] = p.B - x[0] - x[0] ** 3
    dx[1] = x[0] - 20.0 * x[1]


def machine(*modes, leads="flow"):
    transition = Transition("fires", "flow", leads, above, reset=back, direction="both")
    return System("machine", (State("x"), State("y")), (Parameter("B", 0.5),), modes, (transition,))


@pytest.mark.parametrize("start", [[0.0, 0.0], [-3.0, 2.0], [1.0, 0.0]], ids=["near", "far", "fires"])
def test_a_machine_with_events_that_comes_to_rest_starts_the_equilibria(start):
    # x + x^3 = B; the start on the guard is right before the transition.
    system, values = machine(Mode("flow", node)), {"B": 0.5}
    event = "fires" if start[0] == 1.0 else None
    settings = Settings(range=(0.1, 1.0))
    opening = opened_orbit(system, values, "B", np.array(start), settings, until="settled", event=event)
    assert not isinstance(opening, Outcome), opening.message
    assert isinstance(opening.problem, Equilibrium)
    assert "came to rest at an equilibrium" in opening.message
    x, y, _ = opening.state.sample.z
    # The root of the cubic, by Newton's method to rounding.
    assert x + x**3 == pytest.approx(0.5, rel=1e-14)
    assert y == pytest.approx(x / 20.0, rel=1e-14)


def test_rest_in_another_mode_than_the_first_starts_its_equilibria():
    def rises(t, x, p, dx):
        dx[0] = p.B
        dx[1] = -x[1]

    system, values = machine(Mode("flow", rises), Mode("other", node), leads="other"), {"B": 0.5}
    settings = Settings(range=(0.1, 1.0))
    opening = opened_orbit(system, values, "B", np.zeros(2), settings, until="settled")
    assert not isinstance(opening, Outcome), opening.message
    assert opening.problem.branch_facts()["settings"]["mode"] == "other"
    x, y, _ = opening.state.sample.z
    # The other field's x + x^3 = B, by Newton's method to rounding; the first field has no equilibrium.
    assert x + x**3 == pytest.approx(0.5, rel=1e-14)
    assert y == pytest.approx(x / 20.0, rel=1e-14)


def test_rest_in_a_mode_that_lacks_a_state_says_what_to_do():
    def rises(t, x, p, dx):
        dx[0] = p.B
        dx[1] = -x[1]

    def decays(t, x, p, dx):
        dx[0] = p.B - x[0]

    modes = Mode("flow", rises), Mode("other", decays, states=("x",))
    outcome = opened_orbit(
        machine(*modes, leads="other"),
        {"B": 0.5},
        "B",
        np.zeros(2),
        Settings(range=(0.1, 1.0)),
        until="settled",
    )
    assert isinstance(outcome, Outcome)
    assert "comes to rest in mode 'other'" in outcome.message
    assert "in which all states exist" in outcome.message
    assert "nearer to an equilibrium" not in outcome.message


def test_a_motion_that_creeps_past_a_saddle_has_not_come_to_rest():
    def saddle(t, x, p, dx):
        dx[0] = (p.B - 1.0) * x[0]
        dx[1] = -20.0 * x[1]

    system, creeps = machine(Mode("flow", saddle)), np.array([[1e-12, 1e-13], [3e-12, 0.0], [9e-12, 0.0]])
    arc, reached = MotionSegment("flow", np.array([0.0, 1.1, 2.2]), creeps), np.ones(2)
    check_moves(system, hybrid_machine(system, {"B": 2.0}).mode("flow"), arc, reached)
    with pytest.raises(AtRest):  # the same at a node
        check_moves(system, hybrid_machine(system, {"B": 0.0}).mode("flow"), arc, reached)
