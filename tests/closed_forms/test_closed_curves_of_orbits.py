"""A closed curve in two parameters is walked once round, also where both parameters turn on every step of it.

The extended Lorenz-84 model of L. van Veen, International Journal of Bifurcation and Chaos 13 (2003) 2121: a
curve of period doublings, 6e-3 by 2e-3 in size, with a 1:2 resonance at its left and at its right.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

import contwalk as cw

RUN = """
contwalk: 1
system:
  equations: |
    F = 3; alpha = 0.25; beta = 1; G = 0.25; delta = 1.04; gamma = 0.987; T = -0.0244
    x' = -y**2 - z**2 - alpha*x + alpha*F - gamma*u**2
    y' = x*y - beta*x*z - y + G
    z' = beta*x*y + x*z - z
    u' = -delta*u + gamma*u*x + T
start: {state: {x: 2.9787, y: -0.038683, z: 0.058233, u: -0.021053}}
continue: {parameter: F, range: [0.5, 4.0]}
diagram: {depth: 2, follow: [HB]}
loci: {with: T, range: [-0.2, 0.2], of: [PD], follow: none}
"""


@pytest.mark.slow
def test_a_curve_of_doublings_is_walked_once_round(tmp_path) -> None:
    path = tmp_path / "lorenz84.yaml"
    path.write_text(RUN, encoding="utf-8")
    result = cw.run(cw.read_run_file(path, output=tmp_path / "lorenz84.h5"), figures=False)
    curves = [branch for branch in result.branches if len(branch.info.free) == 2]
    assert [branch.outcome.reason for branch in curves] == ["closed"]
    points = [p for p in curves[0].special_points if p.label != "EP"]
    assert sorted(p.label for p in points) == ["GPD", "GPD", "R2", "R2"]
    places = [np.array([p.parameters["F"], p.parameters["T"]]) for p in points]
    assert min(np.abs(a - b).max() for a, b in combinations(places, 2)) > 1e-4
