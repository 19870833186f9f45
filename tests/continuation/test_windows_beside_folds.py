"""A pair of eigenvalues that passes twice beside a fold, within the step that passes the fold.

At both ends of the step it is stable, and the fold explains how the count changes between them.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_both_hopf_points_beside_a_fold_are_found(side):
    """q = y^2; the pair's real part is positive between y = 0.02 and 0.03, beyond the fold or before it."""

    def field(t, x, p, dx):
        y = side * x[0]
        grows = (y - 0.02) * (0.03 - y) - x[1] ** 2 - x[2] ** 2
        dx[0] = p.q - x[0] ** 2
        dx[1] = grows * x[1] - x[2]
        dx[2] = x[1] + grows * x[2]

    problem = small_problem(field, "yuv", {"q": 0.25}, "q")
    branch = cw.continue_branch(problem, [0.5, 0.0, 0.0], (-1.0, 0.3), max_step=0.5)
    found = labelled(branch, "LP", "HB")
    places = [(p.label, p.parameters["q"]) for p in sorted(found, key=lambda p: p.parameters["q"])]
    assert [label for label, _ in places] == ["LP", "HB", "HB"]
    assert [q for _, q in places] == pytest.approx([0.0, 0.02**2, 0.03**2], abs=1e-12)


def test_a_pair_that_passes_twice_beside_a_branch_point_is_found():
    """Two Hopf points 2e-7 apart, at half of that from a branch point, within one step."""

    def field(t, x, p, dx):
        q = p.q - 0.31
        dip = 10.0 * (1e-14 - q * q) / (1.0 + 10.0 * q * q) - x[1] ** 2 - x[2] ** 2
        dx[0] = (q - 2e-7) * x[0] - x[0] ** 3
        dx[1] = dip * x[1] - x[2]
        dx[2] = x[1] + dip * x[2]

    problem = small_problem(field, "yuv", {"q": 0.0}, "q")
    branch = cw.continue_branch(problem, np.zeros(3), (0.0, 1.0))
    found = {p.label: 0 for p in labelled(branch, "BP", "HB")}
    for point in labelled(branch, "BP", "HB"):
        found[point.label] += point.status == "located"
    assert found == {"BP": 1, "HB": 2}


def odd(t, x, p, dx, lam):
    """A drawn odd field of four states: halves of a branch before its pitchfork and after it are alike."""
    y0, y1, y2, y3 = x[0] / 100.0, x[1] / 0.001, x[2] / 0.01, x[3] / 0.001
    q = lam / 1000.0
    dx[0] = 1e4 * (-1.291 * y0 - 2.599 * y1 + 0.1621 * y2 + 1.169 * y3 + 0.4317 * math.sin(1.097 * y0))
    dx[0] += 1e4 * (-0.6671 * math.sin(2.249 * y1) - 0.9057 * q * y0)
    dx[1] = 1e-5 * (1.452 * y0 - 1.451 * y2 - 0.2394 * y3 - 1.443 * y3 / (1.0 + y3**2))
    dx[1] += 1e-5 * (0.7616 * y2 / (1.0 + y2**2) - 1.079 * y3 * y3 * y2 - 0.8887 * y3 * math.cos(y0))
    dx[1] += 1e-5 * 1.022 * q * y1
    dx[2] = 1e-3 * (-0.4005 * y1 - 2.267 * y2 + 0.4283 * y3 - 0.3073 * y0 * y0 * y1)
    dx[2] += 1e-3 * (1.353 * math.tanh(0.5542 * y1) + 0.07565 * y2 * y1 * y2)
    dx[2] += 1e-3 * (0.9442 * math.sin(1.004 * y1) + 0.9323 * q * y2)
    dx[3] = 1e-4 * (-0.1137 * y0 - 0.8293 * y1 + 0.6603 * y2 + 1.055 * y1**3 + 0.5266 * q * y3)


@pytest.mark.parametrize(("slope", "offset"), [(1.0, 0.0), (-0.0447418349720588, 0.04371215929179461)])
def test_what_is_on_one_half_of_an_odd_branch_is_on_the_other(slope, offset):
    """Whatever the parameter is measured in: it is steps alone that bring a fold and a window together."""
    problem = small_problem(
        lambda t, x, p, dx: odd(t, x, p, dx, offset + slope * p.mu),
        ["x0", "x1", "x2", "x3"],
        {"mu": (-18.88243427637363 - offset) / slope},
        "mu",
    )
    start = [-268.7433813507426, -1.6585410351126422e-05, -0.005263932843163159, -0.0028427437163503705]
    ends = sorted((end - offset) / slope for end in (-1093.6287883014688, 1019.2217473667587))
    branch = cw.continue_branch(problem, start, tuple(ends), max_points=1000)
    found = [(p.label, offset + slope * p.parameters["mu"]) for p in labelled(branch, "LP", "HB")]
    places = {
        "HB": (-1079.1113828412563, -1078.7819891953293),
        "LP": (-1078.3211747854464, -1078.2889039442155),
    }
    for label, both in places.items():
        assert sorted(at for name, at in found if name == label) == pytest.approx(
            [both[0], both[0], both[1], both[1]], abs=1e-9
        )
