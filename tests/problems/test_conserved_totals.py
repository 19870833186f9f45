"""Equilibria of networks of reactions, whose totals are conserved: alone at a given total, or along it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from small_systems import labelled

import contwalk as cw
from contwalk.system import Conserved, Mode, Parameter, State, System

K1, K2, K3, TOTAL, POOL = 8.0, 1.0, 0.05, 1.5, 4.0


def network(declared: bool = True) -> System:
    """A <-> B, catalysed by B: a' = -b' = k4 b - k3 a - k1 a b^2 + k2 b^3."""

    def field(t, x, p, dx):
        gain = K1 * x[0] * x[1] ** 2 - K2 * x[1] ** 3 + K3 * x[0] - p.k4 * x[1]
        dx[0], dx[1] = -gain, gain

    quantities = (Conserved("total", lambda t, x, p: x[0] + x[1]),) if declared else ()
    return small("ab", {"k4": 0.5}, field, quantities)


def oscillating(declared: bool) -> System:
    """A Brusselator that is fed from a pool z to which x goes back: x + z is conserved."""

    def field(t, x, p, dx):
        gain = x[2] - (p.B + 1.0) * x[0] + x[0] ** 2 * x[1]
        dx[0], dx[2] = gain, -gain
        dx[1] = p.B * x[0] - x[0] ** 2 * x[1]

    quantities = (Conserved("pool", lambda t, x, p: x[0] + x[2]),) if declared else ()
    return small("xyz", {"B": 1.5}, field, quantities)


def small(states, parameters, field, conserved) -> System:
    return System(
        "small",
        states=tuple(State(name) for name in states),
        parameters=tuple(Parameter(name, value) for name, value in parameters.items()),
        modes=(Mode("all", field),),
        conserved=conserved,
    )


def folds(total: float = TOTAL) -> list[float]:
    """With a = total - b, k4 is a function of b: its largest and least value inside."""

    def slope(b):
        return K1 * (total - 2.0 * b) - 2.0 * K2 * b - K3 * total / b**2

    grid = np.linspace(1e-3, total, 2001)
    signs = np.flatnonzero(np.diff(np.sign(slope(grid))))
    places = [brentq(slope, grid[i], grid[i + 1], xtol=1e-15) for i in signs]
    return sorted(K1 * (total - b) * b - K2 * b**2 + K3 * (total - b) / b for b in places)


@pytest.mark.parametrize("declared", [True, False])
def test_folds_at_a_total_are_found_wherever_the_start_is_on_it(declared) -> None:
    system = network(declared)
    problem = cw.Equilibrium(system, system.defaults(), "k4")
    branch = cw.continue_branch(problem, [0.6, 0.9], (0.01, 8.0))  # no equilibrium
    assert branch.outcome.reason == "bound"
    points = labelled(branch, "LP")
    assert sorted(p.parameters["k4"] for p in points) == pytest.approx(folds(), rel=1e-13)  # roundings
    assert branch["a"] + branch["b"] == pytest.approx(TOTAL, rel=1e-13)
    assert sorted(p.unstable_after - p.unstable_before for p in points) == [-1, 1]
    assert len(points[0].spectrum) == 1  # without the total's own eigenvalue, which is zero
    assert ("Conserved, and not declared: a + b" in branch.outcome.message) != declared


def test_a_total_may_be_the_free_parameter() -> None:
    system = network()
    problem = cw.Equilibrium(system, system.defaults() | {"k4": folds(2.0)[0]}, "total")
    branch = cw.continue_branch(problem, [1.9, 0.02], (0.5, 4.0))
    found = [p.parameters["total"] for p in labelled(branch, "LP")]
    assert min(abs(value - 2.0) for value in found) < 1e-12  # roundings


def test_what_has_no_slope_at_an_equilibrium_is_not_held() -> None:
    def field(t, x, p, dx):
        dx[0], dx[1] = x[1], -p.g * np.sin(x[0])

    energy = Conserved("energy", lambda t, x, p: 0.5 * x[1] ** 2 - p.g * np.cos(x[0]))
    pendulum = small(["angle", "speed"], {"g": 1.0}, field, (energy,))
    branch = cw.continue_branch(cw.Equilibrium(pendulum, pendulum.defaults(), "g"), [0.1, 0.0], (0.5, 2.0))
    assert branch.outcome.reason == "bound"
    assert branch.info.settings["pins"] == []


@pytest.mark.parametrize("declared", [True, False])
def test_cycles_are_born_at_their_total(declared) -> None:
    """With z = 4 - x there is x = 2, y = B / 2, with the trace B - 6 and the determinant 8."""
    system = oscillating(declared)
    problem = cw.Equilibrium(system, system.defaults(), "B")
    branch = cw.continue_branch(problem, [2.0, 0.75, 2.0], (1.0, 8.0))
    (hopf,) = labelled(branch, "HB")
    assert hopf.parameters["B"] == pytest.approx(6.0, abs=1e-13)
    assert hopf.coefficients["omega"] == pytest.approx(np.sqrt(8.0), abs=1e-12)
    assert len(hopf.spectrum) == 2
    cycle = cw.switch_branch(problem, branch, "HB1", (1.0, 6.5))
    assert cycle.outcome.reason == "bound"
    assert set(cycle["unstable"]) == {0}
    assert cycle["x"] + cycle["z"] == pytest.approx(POOL, abs=1e-6)  # to the steps of the walk
    (end,) = labelled(cycle, "EP")
    assert len(end.spectrum) == 1  # neither the flow's own nor the pool's

    # Liouville: the divergence in the plane of the pool is 2 x y - (B + 2) - x^2.
    def along(t, u):
        x, y = u[:2]
        gain = POOL - (6.5 + 2.0) * x + x**2 * y
        return [gain, 6.5 * x - x**2 * y, 2.0 * x * y - (6.5 + 2.0) - x**2]

    motion = solve_ivp(
        along, (0.0, end.period), [end.state["x"], end.state["y"], 0.0], rtol=1e-11, atol=1e-12
    )
    assert motion.y[0, -1] == pytest.approx(end.state["x"], abs=1e-5)  # as the walk's steps
    assert end.spectrum[0].real == pytest.approx(np.exp(motion.y[2, -1]), rel=1e-4)
