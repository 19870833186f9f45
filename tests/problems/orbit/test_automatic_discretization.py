"""Orbits of which nobody says how they are to be discretised: segments of equal duration while these are
enough, then cuts at times of equal growth.
"""

from __future__ import annotations

import numpy as np
import pytest
from peers.problems import hodgkin_huxley
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.diagram.reopening import reopened
from contwalk.problems.orbit.cutting import cuts_for
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.step_blocks import steps_of
from contwalk.workflow.growing_cuts import growing_cuts

AUTO = Discretization(scheme="auto")


def nerve(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 / 3.0 - x[1] + p.I
    dx[1] = p.eps * (x[0] + 0.7 - 0.8 * x[1])


def relaxing(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.mu * (1.0 - x[0] ** 2) * x[1] - x[0]


def cycles(field, names, values, free, start, ends, discretization, **given):
    system = small_problem(field, names, values, free).system
    problem = cw.Equilibrium(system, system.defaults(), free, discretization=discretization)
    equilibria = cw.continue_branch(problem, start, ends)
    return cw.switch_branch(problem, equilibria, "HB1", ends, **given), system


def nerve_cycles(eps, discretization, **given):
    values = {"I": 0.0, "eps": eps}
    return cycles(nerve, "vw", values, "I", [-1.2, -0.6], (0.0, 2.0), discretization, **given)


def test_what_is_one_segment_is_as_by_shooting():
    """To the last bit, as long as no orbit is cut."""
    short = {"max_points": 12}
    shot, _ = nerve_cycles(0.2, Discretization(scheme="shooting"), **short)
    found, _ = nerve_cycles(0.2, AUTO, **short)
    for name in ("unknowns", "weights", "tangent", "spectrum"):
        a, b = shot.points[name], found.points[name]
        size = min(a.shape[1], b.shape[1])
        np.testing.assert_array_equal(a[:, :size], b[:, :size])


def lengths(branch):
    """How many unknowns each row has."""
    return np.isfinite(branch.points["unknowns"]).sum(axis=1)


@pytest.mark.long
def test_segments_of_equal_duration_are_as_by_shooting():
    """To the last bit, through an explosion in which they are halved, where shooting is enough."""
    shot, _ = nerve_cycles(0.08, Discretization(scheme="shooting"), max_points=90)
    found, _ = nerve_cycles(0.08, AUTO, max_points=90)
    assert len(set(lengths(shot))) > 1
    assert len(shot) == len(found)
    for name in ("unknowns", "weights", "tangent", "spectrum"):
        a, b = shot.points[name], found.points[name]
        size = min(a.shape[1], b.shape[1])
        np.testing.assert_array_equal(a[:, :size], b[:, :size])


@pytest.mark.long
def test_what_segments_of_equal_duration_do_not_take_is_cut_where_deviations_grow():
    """By default; the row tells the times of the cuts, and the run that they were chosen."""
    found, system = nerve_cycles(0.01, Discretization(), max_points=180)
    assert found.outcome.reason == "max_points"
    row = int(np.argmax(lengths(found)))
    problem, sample = reopened(system, found, row, AUTO)
    assert problem.uneven
    durations = np.diff(np.append(problem.mesh.cuts, 1.0))
    assert durations.max() > 2.0 * durations.min()
    np.testing.assert_array_equal(problem.fitting(sample.z).layout.begins, problem.mesh.cuts)
    assert "orbits are cut where deviations grow" in growing_cuts(found)
    first, _ = reopened(system, found, 0, AUTO)
    np.testing.assert_array_equal(first.fitting(sample.z).layout.begins, problem.mesh.cuts)
    np.testing.assert_array_equal(problem.fitting(found.unknowns(0)).layout.begins, first.mesh.cuts)


@pytest.mark.long
def test_both_explosions_of_a_nerve_are_passed_by_default():
    """Between them one segment is enough, and would not show how deviations grow in the second one."""
    found, _ = nerve_cycles(0.05, Discretization())
    assert found.outcome.reason == "shrunk", found.outcome
    assert [fold.status for fold in labelled(found, "LP")] == ["located", "located"]


@pytest.mark.long
def test_an_orbit_that_begins_within_its_last_step_has_its_cuts_in_the_closure():
    """It was stored as one segment there, in the middle of an explosion, and the branch ended."""
    found, system = nerve_cycles(0.05, Discretization(scheme="grown"))
    row = int(np.argmax(lengths(found)))
    problem, sample = reopened(system, found, row, Discretization(scheme="grown"))
    last = float(steps_of(problem, sample.z).begins[-1])
    cuts = cuts_for(problem, sample.z, 40, 0.5 * (1.0 + last))
    assert len(cuts) > 1
    assert np.all(np.diff(np.append(cuts, 1.0)) > 0.0)


def test_what_was_stored_by_auto_before_is_read_as_it_was():
    found, system = nerve_cycles(0.05, Discretization(scheme="grown"))
    folds = labelled(found, "LP")
    assert found.info.settings["scheme"] == "auto"
    assert [fold.status for fold in folds] == ["located", "located"]
    # The equations are their own image under (v, w, I) -> (-v, 7 / 4 - w, 7 / 4 - I).
    low, high = (fold.parameters["I"] for fold in folds)
    assert abs(low + high - 1.75) <= sum(fold.error for fold in folds)
    problem, _ = reopened(system, found, int(np.argmax(lengths(found))), Discretization())
    assert problem.uneven
    assert problem.discretization.scheme == "grown"


@pytest.mark.long
def test_a_stiff_relaxation_oscillation_is_not_cut_in_its_jumps():
    """What grows there is forgotten before a segment ends; cuts would have to move with the jumps."""
    system = small_problem(relaxing, "xy", {"mu": 1e4}, "mu").system
    problem = cw.PeriodicOrbit(system, system.defaults(), "mu", discretization=AUTO)
    branch = cw.continue_branch(problem, [2.0, 0.0], range=(1e4, 1.0005e4), until="settled")
    assert branch.outcome.reason == "bound", branch.outcome
    assert growing_cuts(branch) == ""


def test_a_number_of_segments_that_is_given_is_kept():
    found, _ = nerve_cycles(0.2, Discretization(scheme="auto", segments=3), max_points=5)
    assert np.all(np.isfinite(found.points["unknowns"]).sum(axis=1) == 3 * 2 + 1)


def test_cycles_of_a_nerve_from_hopf_to_hopf_by_themselves():
    """Hodgkin and Huxley's: deviations grow by 1e9 a round in spikes, and by nothing between them."""
    (study,) = hodgkin_huxley.PEER.studies
    system = hodgkin_huxley.SYSTEM
    problem = cw.Equilibrium(system, system.defaults(), "I", discretization=AUTO)
    equilibria = cw.continue_branch(problem, [0.0, 0.053, 0.596, 0.318], (0.0, 200.0))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (0.0, 200.0))
    assert cycle.outcome.reason == "shrunk", cycle.outcome
    known = [value for value in study.values if value.of == "orbit"]
    found = [point for point in cycle.special_points if point.label != "EP"]
    assert [point.label for point in found] == [value.label for value in known]
    for point, value in zip(found, known, strict=True):
        assert abs(point.parameters["I"] - value.value) <= point.error + value.doubt
        assert point.error <= 1e-8 * value.value
