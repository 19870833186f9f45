"""The curve of folds of cycles that is born at a generalized Hopf point, in closed form."""

from __future__ import annotations

import numpy as np
from loci_of_orbits import studied

# r' = r (mu + nu r^2 - r^4), phi' = 2 + 3 r^2 / 10: GH at (0, 0), folds at mu = -nu^2 / 4 for positive nu.
PLUGIN = """
from contwalk.system import Mode, Parameter, State, System


def field(t, x, p, dx):
    s = x[0] ** 2 + x[1] ** 2
    g, w = p.mu + p.nu * s - s * s, 2.0 + 0.3 * s
    dx[0] = g * x[0] - w * x[1]
    dx[1] = w * x[0] + g * x[1]
    dx[2] = x[0] ** 2 - x[2]


SYSTEM = System(
    "bautin",
    states=(State("x"), State("y"), State("z")),
    parameters=(Parameter("mu", -0.5), Parameter("nu", -0.5)),
    modes=(Mode("only", field),),
)
"""
RUN = """
system: ./bautin.py
start: {state: {x: 0.0, y: 0.0, z: 0.0}}
continue: {parameter: mu, range: [-0.5, 0.5]}
diagram: none
accuracy: 1e-8
engine: {max_step: 0.4, max_share: 0.1}
loci: {with: nu, range: [-0.8, 0.8], of: [HB], follow: all}
output: bautin.h5
"""


def test_folds_of_cycles_are_followed_from_a_generalized_hopf_point(tmp_path) -> None:
    _, (_, hopf, folds), _ = studied(tmp_path, "bautin", PLUGIN, RUN)
    facts = folds.info.settings
    assert (facts["of"], facts["of_problem"]) == ("LP", "periodic_orbit")
    assert folds.info.parent[0] == hopf.name
    assert folds.outcome.reason == "bound"
    assert np.max(np.abs(folds["mu"] + folds["nu"] ** 2 / 4.0)) < 1e-6
    assert 0.0 < folds["nu"].min() < 0.05
    assert folds["nu"].max() == 0.8
