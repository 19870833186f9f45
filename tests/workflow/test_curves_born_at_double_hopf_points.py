"""The curves of tori that are born at a double Hopf point, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from loci_of_orbits import studied

# r' = r (mu - r^2 - 0.6 s^2), s' = s (nu - 0.5 r^2 - s^2), gone round with 2 and 3.3 a second: HH at (0, 0).
# The cycle r^2 = mu has a torus at nu = mu / 2, the cycle s^2 = nu at mu = 3 nu / 5.
PLUGIN = """
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    r, s = x[0] ** 2 + x[1] ** 2, x[2] ** 2 + x[3] ** 2
    g, h = p.mu - r - 0.6 * s, p.nu - 0.5 * r - s
    dx[0] = g * x[0] - 2.0 * x[1]
    dx[1] = 2.0 * x[0] + g * x[1]
    dx[2] = h * x[2] - 3.3 * x[3]
    dx[3] = 3.3 * x[2] + h * x[3]


SYSTEM = System(
    "two_pairs",
    states=tuple(State(name, scale=1.0) for name in "xyuv"),
    parameters=(Parameter("mu", -0.3), Parameter("nu", -0.2)),
    modes=(Mode("only", field),),
)
"""
RUN = """
system: ./two_pairs.py
start: {state: {x: 0.0, y: 0.0, u: 0.0, v: 0.0}}
continue: {parameter: mu, range: [-0.5, 0.5]}
diagram: none
accuracy: 1e-8
engine: {max_step: 0.4, max_share: 0.1}
loci: {with: nu, range: [-0.4, 0.4], of: [HB], follow: all}
output: two_pairs.h5
"""


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.5, pytest.param(0.01, marks=pytest.mark.long)])
def test_tori_of_both_cycles_are_followed_from_a_double_hopf_point(tmp_path, share) -> None:
    """Where r changes the growth of s little, the cycle with a torus is larger, as in Lorenz-84."""
    _, (_, *curves), _ = studied(tmp_path, "two_pairs", PLUGIN.replace("0.5 * r", f"{share} * r"), RUN)
    assert sorted(curve.info.settings["of"] for curve in curves) == ["HB", "HB", "NS", "NS"]
    tori = [curve for curve in curves if curve.info.settings["of"] == "NS"]
    slopes = sorted(float(np.median(curve["nu"] / curve["mu"])) for curve in tori)
    # Multipliers are known to 1e-6 on the steps of the walk, whatever is made of them.
    np.testing.assert_allclose(slopes, [share, 1.0 / 0.6], atol=1e-6)
    for curve in tori:
        off = min(np.max(np.abs(curve["nu"] - k * curve["mu"])) for k in (share, 1.0 / 0.6))
        assert off < 1e-6
        assert curve.outcome.reason == "bound"
        assert 0.0 < curve["mu"].min() < 0.15


@pytest.mark.long
@pytest.mark.parametrize(("weak", "told"), [("1e-6", True), ("0.0", False)])
def test_tori_that_are_not_found_are_told(tmp_path, weak, told) -> None:
    """r changes the growth of s so little that no place beside the point has that torus; or not at all."""
    plugin = PLUGIN.replace("0.5 * r", f"{weak} * r")
    _, (_, *curves), _ = studied(tmp_path, "two_pairs", plugin, RUN)
    failed = [curve for curve in curves if curve.outcome.status == "failed"]
    followed = [curve.info.settings["of"] for curve in curves if curve not in failed]
    assert sorted(followed) == ["HB", "HB", "NS"]
    # Both curves of Hopf points pass the point, and each tells it.
    assert [curve.outcome.reason for curve in failed] == (2 * ["no_convergence"] if told else [])
    assert all("No torus of the cycles of frequency 2 " in curve.outcome.message for curve in failed)
