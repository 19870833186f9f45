"""The neural mass's cycles to their homoclinic orbit: folds and doublings come in pairs, and none is lost.

Beyond a growth of 1e40 both points of a pair are one to all digits, and multipliers of 1e80 change their
sign within the error of the steps.
"""

from __future__ import annotations

import numpy as np
import pytest
from peers.form import Study
from peers.running import run_study

RUN = {
    "start": {"state": {"E": 0.238616, "x": 0.982747, "u": 0.367876}},
    "continue": {"parameter": "E0", "range": [-2.5, -0.9]},
    "diagram": {"depth": 1},
}
# AUTO-07p at periods of 1e4 and more.
LIMIT = -1.7640317708


@pytest.mark.slow
@pytest.mark.long
def test_each_fold_has_its_doubling_down_to_where_they_are_one(tmp_path):
    branches = run_study("neural_mass", Study("to its loop", RUN, values=()), tmp_path).branches
    branch = next(b for b in branches if b.info.origin == "b1/HB2")
    assert branch.outcome.reason == "homoclinic"
    points = [p for p in branch.special_points if p.label in ("LP", "PD", "NS", "BP")]
    assert all(p.status == "located" for p in points)
    folds, doublings = (
        np.array([p.parameters["E0"] for p in points if p.label == label]) for label in ("LP", "PD")
    )
    assert all(abs(p.unstable_after - p.unstable_before) == 1 for p in points)
    # The first two folds, far from the loop, have none.
    assert len(folds) == len(doublings) + 2 >= 13
    assert len(points) == len(folds) + len(doublings)
    apart = np.abs(folds[2:] - doublings)
    assert np.all(np.diff(np.log10(np.maximum(apart, 1e-11))) <= 0.5)
    # Near a saddle-focus distances to the loop fall by one factor, of alternating sign.
    ratios = (folds[3:-1] - LIMIT) / (folds[2:-2] - LIMIT)
    assert ratios[3:] == pytest.approx(np.full(len(ratios) - 3, ratios[-1]), rel=0.1)
