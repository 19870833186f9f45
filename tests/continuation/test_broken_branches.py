"""One branch or point that cannot be computed ends nothing else."""

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.errors import NotFinite
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.studies.opening import opened


def beside_growth(t, x, p, dx):
    """A cycle of radius sqrt(mu), and a state that grows by exp(2 pi k) in a round."""
    growth = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]
    dx[2] = p.k * x[2] + x[0] ** 2


def diagram(k):
    system = small_system(beside_growth, "xyz", {"mu": -0.5, "k": k})
    settings, parameters = Settings(range=(-0.5, 0.5), max_points=60), {"mu": -0.5, "k": k}
    start = Start(system, "mu", parameters, opened(system, parameters, "mu", np.zeros(3), settings), "start")
    found = Diagram([start], Plan(settings, frozenset({"HB"}), 1))
    for _ in found.events():
        pass
    return found.branches


def test_multipliers_of_twenty_decades_are_cut_into_segments():
    """exp(2 pi k) = 7e21, in one piece beyond all floats."""
    _, cycle = diagram(8.0)
    assert cycle.outcome.reason in ("max_points", "bound")
    assert not [p for p in cycle.special_points if p.status == "unlocated"]
    assert cycle["mu"].max() > 0.05
    last = cycle.points[-1]
    assert np.hypot(*last["state"][:2]) == pytest.approx(np.sqrt(last["free"][0]), rel=1e-5)  # steps of 1e-6
    # The largest one's own accuracy: each of many factors is wrong by some roundings and local errors.
    assert abs(last["spectrum"][0]) == pytest.approx(np.exp(2.0 * np.pi * 8.0), rel=1e-3)


def test_a_branch_that_cannot_be_begun_is_a_failed_branch():
    """exp(2 pi 300) is beyond what the most segments hold."""
    equilibria, cycle = diagram(300.0)
    assert equilibria.outcome.status != "failed"
    assert labelled(equilibria, "HB")
    assert (cycle.outcome.status, cycle.outcome.reason) == ("failed", "not_finite")
    assert "HB1 cannot be begun" in cycle.outcome.message
    assert cycle.info.problem == "periodic_orbit"
    assert len(cycle) == 0


def folding(t, x, p, dx):
    """Radius r with mu = (r^2 - 1)^2: the cycles turn at mu = 0."""
    square = x[0] ** 2 + x[1] ** 2
    growth = p.mu - (square - 1.0) ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]


def test_a_point_that_cannot_be_refined_is_unlocated(monkeypatch):
    def failing(self, z, weights, tolerance=None):
        raise NotFinite("The field is not finite on finer steps.", "Start elsewhere.")

    system = small_problem(folding, "xy", {"mu": 0.25}, "mu").system
    orbits = PeriodicOrbit(system, system.defaults(), "mu")
    start = [np.sqrt(1.5), 0.0]
    whole = cw.continue_branch(orbits, start, (-1.0, 0.5), period=2.0 * np.pi)
    (fold,) = labelled(whole, "LP")
    assert fold.status == "located"
    monkeypatch.setattr(PeriodicOrbit, "refined", failing)
    branch = cw.continue_branch(orbits, start, (-1.0, 0.5), period=2.0 * np.pi)
    assert {p.kind for p in labelled(branch, "EP")} == {p.kind for p in labelled(whole, "EP")}
    assert [p.status for p in labelled(branch, "LP", "BP")] == ["unlocated"]
    assert labelled(branch, "LP")
    assert branch["mu"].max() == whole["mu"].max()
