"""False words of earlier versions, as these stored them on spring-legged walking, and what is said of them.

The files in `stored/` hold the last rows of two curves of one study, by a version that told a resonance
where the trivial multiplier is wrong, and the end of a curve of branch points that goes on: by a return map
of its own, integrated by SciPy, it is at alpha = 70.31953, k = 13600 and at 70.24896, 13500. The curve that
closed after 14 points within rounding is made by hand.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from stored_branches import FOLDER, read

from contwalk.plugin_check.at_load import load_system
from contwalk.system import System
from contwalk.verification.ends import checked_end
from contwalk.verification.finding import DISAGREES
from contwalk.verification.points import checked_point


@pytest.fixture(scope="module")
def walker() -> System:
    """Bipedal walking on springs: Geyer, Seyfarth and Blickhan (2006), Proc. R. Soc. B 273, 2861."""
    return load_system(str(FOLDER / "spring_legged_walker.py"))


def test_a_resonance_where_the_trivial_multiplier_is_wrong(walker):
    branch = read("false_resonance.json")
    (point,) = branch.special_points
    assert (point.label, point.status) == ("R3", "located")
    assert point.error < 1e-8
    assert checked_point(walker, branch, point).verdict == DISAGREES


def test_a_curve_of_branch_points_that_goes_on(walker):
    branch = read("not_persisting.json")
    (end,) = branch.special_points
    found = checked_end(walker, branch, end, {})
    assert found.verdict == DISAGREES
    assert "the branches that cross still do beyond it, at alpha = 70.36620" in found.reason


def test_a_curve_that_is_closed_within_rounding(walker):
    branch = read("not_persisting.json")
    points = np.repeat(branch.points[:1], 14)
    points["free"] += np.spacing(points["free"]) * np.cos(np.arange(14.0))[:, None].round()
    points["s"] = 1e-12 * np.arange(14.0)
    end = replace(branch.special_points[0], kind="closed", note=None, index=13, s=points["s"][-1])
    found = checked_end(walker, replace(branch, points=points), end, {})
    assert (found.verdict, found.reason) == (DISAGREES, "all its rows are one point to their errors")
