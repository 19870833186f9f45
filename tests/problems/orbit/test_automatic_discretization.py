"""Orbits of which nobody says how they are to be discretised: one segment while that is enough, then cuts at
times of equal growth.
"""

from __future__ import annotations

import numpy as np
from peers.problems import hodgkin_huxley
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.continuation.reopening import reopened
from contwalk.problems.orbit.discretization import Discretization

AUTO = Discretization(scheme="auto")


def nerve(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 / 3.0 - x[1] + p.I
    dx[1] = p.eps * (x[0] + 0.7 - 0.8 * x[1])


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


def test_what_has_to_be_cut_is_cut_at_times_of_equal_growth():
    found, system = nerve_cycles(0.05, AUTO)
    assert found.outcome.reason == "shrunk", found.outcome
    folds = labelled(found, "LP")
    assert [fold.status for fold in folds] == ["located", "located"]
    # The equations are their own image under (v, w, I) -> (-v, 7 / 4 - w, 7 / 4 - I).
    low, high = (fold.parameters["I"] for fold in folds)
    assert abs(low + high - 1.75) <= sum(fold.error for fold in folds)
    collocated, _ = nerve_cycles(0.05, Discretization(scheme="collocation"))
    for a, b in zip(folds, labelled(collocated, "LP"), strict=True):
        assert abs(a.parameters["I"] - b.parameters["I"]) <= a.error + b.error
    lengths = np.isfinite(found.points["unknowns"]).sum(axis=1)
    row = int(np.argmax(lengths))
    problem, sample = reopened(system, found, row, AUTO)
    assert problem.mesh.segments > 1
    durations = np.diff(np.append(problem.mesh.cuts, 1.0))
    assert durations.max() > 2.0 * durations.min()
    np.testing.assert_array_equal(problem.fitting(sample.z).layout.begins, problem.mesh.cuts)


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
