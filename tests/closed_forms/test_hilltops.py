"""A hilltop: l = x^2 - c y^2, 0 = (3 x + y^2) y. The branch y = 0 turns right where y leaves it.

Both eigenvalues are zero at (0, 0, 0), and both branches that cross there keep the parameter.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from plugin_runs import run_text, write_plugin

C = 0.3
FIELD = """
dx[0] = p.l - x[0] ** 2 + p.c * x[1] ** 2
dx[1] = -3.0 * x[0] * x[1] - x[1] ** 3
"""


def test_a_branch_goes_on_through_a_fold_that_is_a_branch_point(tmp_path: Path) -> None:
    write_plugin(tmp_path, FIELD, "xy", l=1.0, c=C)
    result = run_text(
        tmp_path,
        "start: {state: {x: 1.0, y: 0.0}}\ncontinue: {parameter: l, range: [-1.0, 1.5]}\n",
    )
    first, second = result.branches
    (hilltop,) = [p for p in first.special_points if p.label != "EP"]
    assert (hilltop.label, {hilltop.unstable_before, hilltop.unstable_after}) == ("BP", {0, 2})
    assert abs(hilltop.parameters["l"]) <= hilltop.error < 1e-30  # refined in 40 digits
    assert hilltop.note is not None
    assert "a fold" in hilltop.note
    assert first["l"][[0, -1]] == pytest.approx([1.5, 1.5])
    assert first.outcome.reason == "bound"
    # y^2 = -3 x on the other branch: l = x^2 + 3 c x turns at x = -3 c / 2, on both of its sides.
    folds = [p for p in second.special_points if p.label == "LP"]
    assert len(folds) == 2
    for fold in folds:
        assert abs(fold.parameters["l"] + 2.25 * C**2) <= fold.error + 1e-16  # the truth is a double
        assert fold.kind is None
