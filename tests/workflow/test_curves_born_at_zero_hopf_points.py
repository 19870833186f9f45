"""The curve of tori that is born at a zero-Hopf point, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from loci_of_orbits import studied

from contwalk.problems.locus import births

# z' = b + z^2 - r^2, r' = r (c + 0.75 z + z^2/2), gone round with 2 a second: folds at b = 0, Hopf points at
# b = -z^2. Cycles with z = 0 have a torus: c = 0, b = r^2.
PLUGIN = """
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    r = x[1] ** 2 + x[2] ** 2
    g = p.c + 0.75 * x[0] + 0.5 * x[0] ** 2
    dx[0] = p.b + x[0] ** 2 - r
    dx[1] = g * x[1] - 2.0 * x[2]
    dx[2] = 2.0 * x[1] + g * x[2]


SYSTEM = System(
    "zero_hopf",
    states=tuple(State(name, scale=1.0) for name in "zxy"),
    parameters=(Parameter("b", -0.3), Parameter("c", 0.2)),
    modes=(Mode("only", field),),
)
"""
RUN = """
system: ./zero_hopf.py
start: {state: {z: -0.5, x: 0.0, y: 0.0}}
continue: {parameter: b, range: [-0.4, 0.4]}
diagram: none
accuracy: 1e-8
engine: {max_step: 0.4, max_share: 0.1}
loci: {with: c, range: [-0.3, 0.3], of: [KIND], follow: [ZH]}
output: zero_hopf.h5
"""


@pytest.mark.drawn(1)
@pytest.mark.parametrize("kind", ["LP", "HB"])
def test_tori_are_followed_from_a_zero_hopf_point_of_either_curve(tmp_path, kind) -> None:
    _, (_, *curves), _ = studied(tmp_path, "zero_hopf", PLUGIN, RUN.replace("KIND", kind))
    assert sorted(curve.info.settings["of"] for curve in curves) == ["HB", "LP", "NS"]
    (tori,) = (curve for curve in curves if curve.info.settings["of"] == "NS")
    assert np.max(np.abs(tori["c"])) < 1e-6
    assert tori["b"].max() == 0.4
    assert 0.0 < tori["b"].min() < 0.05


@pytest.mark.long
@pytest.mark.parametrize("kind", ["LP", "HB"])
def test_tori_that_are_not_found_are_told(tmp_path, monkeypatch, kind) -> None:
    monkeypatch.setattr(births, "tori_of_cycles", lambda *_: ())
    _, (_, *curves), _ = studied(tmp_path, "zero_hopf", PLUGIN, RUN.replace("KIND", kind))
    failed = [curve.outcome for curve in curves if curve.outcome.status == "failed"]
    assert failed
    assert {outcome.reason for outcome in failed} == {"no_convergence"}
    assert all("No torus of the cycles of frequency 2 " in outcome.message for outcome in failed)
    followed = [curve.info.settings["of"] for curve in curves if curve.outcome.status != "failed"]
    assert sorted(followed) == ["HB", "LP"]
