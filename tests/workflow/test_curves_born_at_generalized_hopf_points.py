"""The curve of folds of cycles that is born at a generalized Hopf point, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from loci_of_orbits import studied

from contwalk.problems.locus import births

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
# A wall that cycles of r = 1/2 touch, as those that fold at nu = 1/2 do.
WALL = (
    PLUGIN.replace(
        "SYSTEM =",
        """
def clearance(t, x, p):
    return 0.5 - x[0]


def rebound(t, x, p, after):
    after[0], after[1], after[2] = -x[0], x[1], x[2]


SYSTEM =""",
    )
    .replace(
        "    modes=",
        """    transitions=(Transition("impact", "only", "only", clearance, reset=rebound),),
    modes=""",
    )
    .replace("import ", "import Transition, ")
)
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


@pytest.mark.long
def test_cycles_of_a_machine_with_events_fold_beside_its_generalized_hopf_point_too(tmp_path) -> None:
    _, (_, hopf, folds, touching), _ = studied(tmp_path, "bautin", WALL, RUN)
    facts = folds.info.settings
    assert (facts["of"], facts["of_problem"]) == ("LP", "hybrid_orbit")
    assert folds.info.parent[0] == hopf.name
    assert np.max(np.abs(folds["mu"] + folds["nu"] ** 2 / 4.0)) < 1e-6
    (point,) = (each for each in folds.special_points if each.label == "GRLP")
    nu, mu = point.unknowns[-2:]
    assert abs(nu - 0.5) <= point.errors["nu"] + 1e-15
    assert abs(mu + 0.0625) <= point.errors["mu"] + 1e-15
    # Cycles of r = 1/2 are those of mu = 1/16 - nu / 4.
    assert touching.info.settings["of"] == "GR"
    assert np.max(np.abs(touching["mu"] - 0.0625 + touching["nu"] / 4.0)) < 1e-6


def test_a_curve_that_is_not_found_is_told(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(births, "_fold", lambda *_: None)
    _, (*_, lost), _ = studied(tmp_path, "bautin", PLUGIN, RUN)
    assert (lost.outcome.status, lost.outcome.reason) == ("failed", "no_convergence")
    assert "fold of the cycles" in lost.outcome.message
