"""Errors of multipliers that are stored say something, at branch points and births too."""

from __future__ import annotations

import numpy as np
from hybrid_runs import branch_of, diagram, machine
from small_systems import labelled

import contwalk as cw
from contwalk.system import System, Transition

# Far coarser than the walk's steps.
ACCURACY = 1e-6


def growing() -> System:
    """x' = (lam - 1) x - x^3, and a clock: at x = 0 a pitchfork of the map from tick to tick."""

    def field(t, x, p, dx):
        dx[0] = (p.lam - 1.0) * x[0] - x[0] ** 3
        dx[1] = 1.0 + 0.0 * x[1]

    def tick(t, x, p, x_plus):
        x_plus[0] = x[0]
        x_plus[1] = 0.0 * x[1]

    return machine(
        ["x", "clock"],
        {"lam": 0.5},
        {"on": field},
        [Transition("tick", "on", "on", lambda t, x, p: 1.0 - x[1], reset=tick)],
    )


def test_multipliers_at_a_branch_point_are_told_as_well_as_beside_it() -> None:
    """Equations are singular there: what errors do to the solution has no bound, and was told as theirs."""
    parent, child = diagram(growing(), "lam", (0.5, 1.5), [0.0, 0.0], until="settled", follow=["BP"], depth=1)
    (point,) = [q for q in parent.special_points if q.label == "BP"]
    for row in (parent.points[point.index], child.points[np.argmin(np.abs(child["s"]))]):
        assert row["spectrum_error"] < ACCURACY
        assert abs(row["spectrum"][0] - 1.0) <= row["spectrum_error"] + 1e-9  # lam itself is known to this
        assert np.isnan(row["error"])
    for branch in (parent, child):
        assert np.all(branch["spectrum_error"] < 1e-3 * np.maximum(1.0, branch["max_abs"]))


def test_the_end_at_a_grazing_has_the_margins_of_the_grazing():
    """On the walk's own steps the guard misses zero by their error, to either side: an end could be told as
    not admissible, beside a GR at the same place that is.
    """
    system = cw.load_system("impact_oscillator")
    branch = branch_of(system, "force", (0.3, 1.2), [0.0, 0.0], until="settled", accuracy=ACCURACY)
    (grazing,) = labelled(branch, "GR")
    end = max(labelled(branch, "EP"), key=lambda point: point.s)
    assert end.kind == "grazing"
    assert (end.parameters, end.admissible, end.margin) == (
        grazing.parameters,
        grazing.admissible,
        grazing.margin,
    )
