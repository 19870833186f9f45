"""What cannot be computed at one point or branch ends that one, and nothing else."""

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

import contwalk as cw
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.errors import NotFinite, PluginError, StartError, UnsupportedOperation
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.equilibrium.points.hopf import Hopf
from contwalk.studies.opening import opened


def two_points(t, x, p, dx):
    """A pitchfork at mu = 0 and a Hopf point at mu = 1 / 2, on x = 0."""
    dx[0] = p.mu * x[0] - x[0] ** 3
    growth = p.mu - 0.5 - x[1] ** 2 - x[2] ** 2
    dx[1] = growth * x[1] - 2.0 * x[2]
    dx[2] = 2.0 * x[1] + growth * x[2]


def walked(follow=frozenset({"BP"})):
    system = small_system(two_points, "xyz", {"mu": -0.5})
    settings = Settings(range=(-1.0, 1.0))
    opening = opened(system, {"mu": -0.5}, "mu", np.zeros(3), settings)
    made = Diagram([Start(system, "mu", {"mu": -0.5}, opening, "start")], Plan(settings, follow, 1))
    list(made.events())
    return made.branches


REASONS = [
    (NotFinite("A motion is not finite.", "Start elsewhere."), "not_finite"),
    (np.linalg.LinAlgError("Singular matrix"), "no_convergence"),
    (StartError("There is none.", "Start elsewhere."), "no_convergence"),
    (PluginError("The field raised an exception.", "Mend the plugin."), "plugin_error"),
    (UnsupportedOperation("The field has no derivative.", "Mend the plugin."), "plugin_error"),
]
ERRORS = [error for error, _ in REASONS[:2]]


def fails(monkeypatch, name, error):
    """What Hopf points do under a name raises an error."""

    def broken(self, *given):
        raise error

    monkeypatch.setattr(Hopf, name, broken)


@pytest.mark.parametrize("error", ERRORS)
def test_a_point_that_cannot_be_located_is_unlocated(monkeypatch, error):
    fails(monkeypatch, "locate", error)
    first, daughter = walked()
    assert [(p.label, p.status) for p in labelled(first, "BP")] == [("BP", "located")]
    hopf = labelled(first, "HB")
    assert [p.status for p in hopf] == ["unlocated"] * max(len(hopf), 1)
    assert (first["mu"].min(), first["mu"].max()) == (-1.0, 1.0)
    assert first.outcome.reason == daughter.outcome.reason == "bound"


@pytest.mark.parametrize("error", ERRORS)
def test_a_point_without_a_normal_form_is_located(monkeypatch, error):
    fails(monkeypatch, "describe", error)
    first, _ = walked()
    (hopf,) = labelled(first, "HB")
    assert (hopf.status, hopf.kind, hopf.criticality) == ("located", None, None)
    assert hopf.parameters["mu"] == pytest.approx(0.5, rel=1e-14)
    assert (hopf.unstable_before, hopf.unstable_after) == (1, 3)
    assert "normal form cannot be computed" in hopf.note
    assert first.outcome.reason == "bound"


@pytest.mark.parametrize(("error", "reason"), REASONS)
def test_a_branch_that_cannot_be_begun_is_one_that_failed(monkeypatch, error, reason):
    fails(monkeypatch, "seeds", error)
    first, *rest = walked(frozenset({"BP", "HB"}))
    assert first.outcome.reason == "bound"
    failed = [b for b in rest if b.outcome.status == "failed"]
    assert [b.outcome.reason for b in failed] == [reason]
    assert len(failed[0]) == 0
    assert failed[0].info.problem == "periodic_orbit"
    assert [b.outcome.reason for b in rest if b not in failed] == ["bound"]  # of the pitchfork


@pytest.mark.parametrize(("error", "reason"), REASONS)
def test_a_walk_that_breaks_off_keeps_what_it_has(monkeypatch, error, reason):
    class Breaking:
        """Equations that are made for a place, and cannot be beyond 0.25."""

        def __init__(self, problem):
            self.problem = problem

        def adapted(self, sample):
            if sample.parameter > 0.25:
                raise error
            return self.problem, sample

        def at_stored(self, z, weights):
            return self.problem

    monkeypatch.setattr(Equilibrium, "anchored", property(Breaking))
    problem = small_problem(two_points, "xyz", {"mu": -0.5}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0, 0.0], (-1.0, 1.0))
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", reason)
    assert sorted(p.kind for p in labelled(branch, "EP")) == ["bound", reason]
    assert branch["mu"].min() == -1.0
    assert len(labelled(branch, "BP")) == 1


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_constant_that_is_no_number_on_one_side_of_a_condition(value):
    def field(t, x, p, dx):
        dx[0] = np.where(x[0] < 0.5, p.mu - x[0], value)

    problem = small_problem(field, "x", {"mu": 0.0}, "mu")
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0))
    assert (branch.outcome.status, branch.outcome.reason) == ("failed", "not_finite")
    assert branch["mu"].min() == -1.0
    assert 0.4 < branch["mu"].max() < 0.5
