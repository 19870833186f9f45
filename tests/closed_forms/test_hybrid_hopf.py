"""Cycles that are born at a Hopf point of a machine with events: circles of radius sqrt(lam).

They grow until they touch what happens at x = A, at lam = A^2. Where the field only switches there, they
go on.
"""

from __future__ import annotations

import numpy as np
import pytest
from hybrid_runs import ACCURACY, assert_met, machine
from scipy.integrate import solve_ivp
from small_systems import labelled

import contwalk as cw
from contwalk.branch import Branch
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.problems.orbit.discretization import Discretization
from contwalk.studies.opening import opened
from contwalk.system import System, Transition

A, STIFFNESS = 0.5, 5.0
RANGE = (-0.1, 1.0)


def free(t, x, p, dx):
    growth = p.lam - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]


def pressed(t, x, p, dx):
    free(t, x, p, dx)
    dx[0] -= STIFFNESS * (x[0] - A)


def gap(t, x, p):
    return A - x[0]


def beyond_a_stop(role: str) -> System:
    """Two modes, on either side of x = A."""
    return machine(
        ["x", "y"],
        {"lam": -0.05},
        {"free": free, "pressed": pressed},
        [
            Transition("comes", "free", "pressed", gap, role=role),
            Transition("goes", "pressed", "free", gap, "rising", role=role),
        ],
    )


def walked(system: System, events: dict[str, str]) -> list[Branch]:
    """Equilibria, and all that leaves them."""
    settings = Settings(range=RANGE, events={"GR": "stop", "OC": "stop", "AZ": "ignore"} | events)
    steps = Discretization(accuracy=ACCURACY)
    opening = opened(system, system.defaults(), "lam", np.zeros(2), settings, discretization=steps)
    made = Diagram(
        [Start(system, "lam", system.defaults(), opening, "the start")], Plan(settings, frozenset({"HB"}), 3)
    )
    for _ in made.events():
        pass
    return made.branches


def test_the_cycle_is_followed_to_the_event_that_it_touches() -> None:
    rest, cycle = walked(beyond_a_stop("hard"), {})
    (hopf,) = labelled(rest, "HB")
    assert hopf.parameters["lam"] == pytest.approx(0.0, abs=1e-15)
    (point,) = labelled(cycle, "GR")
    assert_met(point, "lam", A**2)
    assert point.kind == "interior"
    assert cycle.outcome.reason == "grazing"
    (end,) = [q for q in labelled(cycle, "EP") if q.kind == "grazing"]
    assert end.error == point.error
    assert cycle["lam"].max() == point.parameters["lam"]
    assert np.all(cycle["admissible"])
    # Rows are known to the walk's steps, which are made for the cycle as it will be.
    assert cycle["max:x"] == pytest.approx(np.sqrt(cycle["lam"]), abs=1e-6)
    assert cycle["period"] == pytest.approx(2.0 * np.pi, rel=1e-8)


def test_beyond_it_are_the_orbits_that_meet_the_event() -> None:
    """Where the field is continuous both branches are one, but for the name of its events."""
    _, cycle, other = walked(beyond_a_stop("hard"), {"GR": "switch", "OC": "switch"})
    assert cycle.outcome.reason == "grazing"
    assert other.info.signature == ("comes", "goes")
    assert other["lam"].min() == pytest.approx(A**2, abs=1e-9)
    (touching,) = labelled(other, "GR", "OC")
    assert touching.trivial_error is None  # an event without a rate: its map has no derivative
    assert np.nanmax(other["trivial_error"]) < 1e-6
    check(other)


def test_the_cycle_goes_on_through_a_switch_of_the_field() -> None:
    _, cycle = walked(beyond_a_stop("soft"), {})
    assert cycle.outcome.reason == "bound"
    assert not labelled(cycle, "GR", "OC", "LP", "BP", "PD", "NS")
    assert np.all(cycle["admissible"])
    check(cycle)


def check(branch: Branch) -> None:
    """The last orbit comes back, by SciPy, after its period."""

    def field(t, x):
        dx = np.empty(2)
        (free if x[0] < A else pressed)(t, x, PARAMETERS, dx)
        return dx

    class PARAMETERS:
        lam = float(branch["lam"][-1])

    start, period = np.array([branch["x"][-1], branch["y"][-1]]), float(branch["period"][-1])
    end = solve_ivp(field, (0.0, period), start, rtol=1e-11, atol=1e-12, max_step=0.01).y[:, -1]
    assert branch["lam"][-1] == RANGE[1]
    assert branch["max:x"][-1] > A
    assert end == pytest.approx(start, abs=1e-7)


def test_an_equilibrium_beyond_a_switch_of_the_field_is_not_admissible() -> None:
    """Equilibria are those of the first mode, wherever they come to lie."""

    def moves(t, x, p, dx):
        dx[0] = p.lam - x[0]

    def slower(t, x, p, dx):
        dx[0] = p.lam - 2.0 * x[0] + A

    system = machine(
        ["x"],
        {"lam": 0.0},
        {"free": moves, "pressed": slower},
        [
            Transition("comes", "free", "pressed", gap, role="soft"),
            Transition("goes", "pressed", "free", gap, "rising", role="soft"),
        ],
    )
    branch = cw.continue_branch(cw.Equilibrium(system, {"lam": 0.0}, "lam"), [0.0], (-1.0, 1.0))
    assert np.array_equal(branch["admissible"], branch["lam"] <= A)


def between(t, x, p, dx):
    growth = p.lam * (1.0 - p.lam) - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]


def between_and_pressed(t, x, p, dx):
    between(t, x, p, dx)
    dx[0] -= STIFFNESS * (x[0] - 0.4)


@pytest.mark.parametrize(("role", "pieces"), [("soft", 1), ("hard", 3)])
def test_a_family_that_leads_from_one_hopf_point_to_another_is_walked_once(role: str, pieces: int) -> None:
    """Circles of the radius sqrt(lam (1 - lam)) are at most 0.5: the largest ones pass x = 0.4.

    Hard transitions divide the family where it touches them.
    """
    machine_between = machine(
        ["x", "y"],
        {"lam": 0.5},
        {"free": between, "pressed": between_and_pressed},
        [
            Transition("comes", "free", "pressed", lambda t, x, p: 0.4 - x[0], role=role),
            Transition("goes", "pressed", "free", lambda t, x, p: 0.4 - x[0], "rising", role=role),
        ],
    )
    settings = Settings(range=(-0.2, 1.2), events={"GR": "switch", "OC": "switch", "AZ": "ignore"})
    values, steps = machine_between.defaults() | {"lam": -0.1}, Discretization(accuracy=ACCURACY)
    opening = opened(machine_between, values, "lam", np.zeros(2), settings, discretization=steps)
    plan = Plan(settings, frozenset(["HB"]), 4, (1.0, -1.0))
    found = Diagram([Start(machine_between, "lam", values, opening, "start")], plan)
    for _ in found.events():
        pass
    rest, *family = found.branches
    assert [point.parameters["lam"] for point in labelled(rest, "HB")] == pytest.approx([0.0, 1.0])
    assert len(family) == pieces
