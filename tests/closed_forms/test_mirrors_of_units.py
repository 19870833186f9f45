"""A symmetry that exchanges states of sizes 1 and 1e6: image rows are right to rounding. Closed form.

With v = y / 1e6: u' = p u - u^3 - (v - u) / 2, v' = p v - v^3 - (u - v) / 2. On u = v = p^1/2 the symmetry
breaks at p = 1/2; beyond, u v = 1/2 and u^2 + v^2 = p + 1/2.
"""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw

PLUGIN = """\
from contwalk.system import Mode, Parameter, Start, State, System, Symmetry

def field(t, x, p, dx):
    u, v = x[0], x[1] / 1e6
    dx[0] = p.p * u - u**3 - 0.5 * (v - u)
    dx[1] = 1e6 * (p.p * v - v**3 - 0.5 * (u - v))

def swap(t, x, p, image):
    image[0], image[1] = x[1] / 1e6, x[0] * 1e6

SYSTEM = System("units", states=(State("x"), State("y")), parameters=(Parameter("p", 1.0),),
    modes=(Mode("m", field),), symmetries=(Symmetry("swap", "spatial", map=swap),),
    starts=(Start("alike", lambda p: [[p.p**0.5, 1e6 * p.p**0.5]]),))
"""


def test_images_across_units_are_right_to_rounding(tmp_path):
    (tmp_path / "units.py").write_text(PLUGIN)
    (tmp_path / "run.yaml").write_text(
        "contwalk: 1\nsystem: ./units.py\nstart: {equilibrium: alike}\n"
        "continue: {parameter: p, range: [0.2, 3.0]}\ndiagram: {follow: all, depth: 2}\n"
    )
    result = cw.run(cw.read_run_file(tmp_path / "run.yaml", output=tmp_path / "run.h5"), figures=False)
    alike, broken = result.branches
    (point,) = [p for p in alike.special_points if p.label == "BP"]
    assert point.kind == "symmetry-breaking"
    assert point.parameters["p"] == pytest.approx(0.5, abs=1e-14)
    u, v, p = broken["x"], broken["y"] / 1e6, broken["p"]
    assert np.sum(u > v) > 50
    assert np.sum(u < v) > 50
    # A few roundings of terms of size ten.
    assert np.max(np.abs(u * v - 0.5)) < 2e-14
    assert np.max(np.abs(u**2 + v**2 - p - 0.5)) < 1e-13
    assert [p.label for p in broken.special_points] == ["EP", "EP"]
    later = p > 0.5 + 1e-6
    assert np.all(broken.points["unstable"][later] == broken.points["unstable"][-1])
