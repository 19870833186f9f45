"""Points of two runs of one study matched, whatever either of them has missed."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Branch, BranchInfo, Outcome, SpecialPoint, named
from contwalk.workflow.pairing import paired


def branch(name, points, parent=None, origin="start", c=1.0):
    """A branch with points (label, s, value)."""
    info = BranchInfo(
        name, "equilibrium", ("x",), (), ("m",), {"m": 0.0, "c": c}, 1, 1, parent=parent, origin=origin
    )
    rows = np.zeros(len(points), dtype=info.point_dtype())
    rows["s"] = [s for _, s, _ in points]
    rows["special"] = [label != "EP" for label, _, _ in points]
    special = [SpecialPoint(label, s, unknowns=(0.0, value)) for label, s, value in points]
    return Branch(info, rows, named(special, rows), Outcome("complete", "bound", ""))


def test_equal_runs():
    run = [branch("b1", [("HB", 1.0, 2.0), ("EP", 2.0, 3.0)]), branch("b2", [("PD", 0.5, 1.5)], ("b1", 1.0))]
    found = paired(run, run)
    assert found.values == {"b1/HB1": 2.0, "b2/PD1": 1.5}
    assert found.extra == []


def test_descent_counts_and_not_names():
    first = [
        branch("b1", [("HB", 1.0, 2.0), ("HB", 3.0, 4.0)]),
        branch("b2", [("PD", 0.5, 1.5)], ("b1", 1.0)),
        branch("b3", [("PD", 0.5, 3.5)], ("b1", 3.0)),
    ]
    # the second run has missed the first Hopf point, and so its b2 is the other one's b3
    second = [branch("b1", [("HB", 3.1, 4.01)]), branch("b2", [("PD", 0.4, 3.49)], ("b1", 3.1))]
    found = paired(first, second)
    assert found.values == {"b1/HB1": None, "b1/HB2": 4.01, "b2/PD1": None, "b3/PD1": 3.49}
    assert found.extra == []


def test_the_nearest_pairs_are_taken_first():
    first = [branch("b1", [("LP", 1.0, 2.0), ("LP", 3.0, 4.0)])]
    second = [branch("b1", [("LP", 3.1, 4.01)])]
    assert paired(first, second).values == {"b1/LP1": None, "b1/LP2": 4.01}


def test_what_only_the_second_run_has():
    first = [branch("b1", [("LP", 1.0, 2.0)])]
    second = [
        branch("b1", [("LP", 1.0, 2.0), ("BP", 1.5, 2.5)]),
        branch("b2", [("LP", 0.1, 2.6)], ("b1", 1.5)),
    ]
    assert paired(first, second).extra == ["b1/BP1", "b2/LP1"]


def test_branches_of_a_sweep_are_told_apart_by_their_parameters():
    first = [branch("b1", [("LP", 1.0, 2.0)], c=1.0), branch("b2", [("LP", 1.0, 7.0)], c=2.0)]
    second = [branch("b1", [("LP", 1.0, 7.1)], c=2.0)]
    assert paired(first, second).values == {"b1/LP1": None, "b2/LP1": 7.1}
