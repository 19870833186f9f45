"""Curves that pass special points of curves of orbits, followed from them and known again from both."""

from __future__ import annotations

import numpy as np
import pytest
from loci_of_orbits import HENON, map_plugin, studied

from contwalk.branch import Branch
from contwalk.system import System
from contwalk.verification.finding import AGREES
from contwalk.verification.points import checked_point

# A unit cycle in a Moebius band that doubles at lam = 1 - sigma^2 / 5, and touches what is watched on a line.
TOUCHING = """
from contwalk.system import Mode, Parameter, State, System, Transition


def field(t, x, p, dx):
    s = x[0] ** 2 + x[1] ** 2
    r = s**0.5
    cos, sin = x[0] / r, x[1] / r
    first = 0.5 * ((1.0 + cos) * x[2] + sin * x[3])
    second = 0.5 * (sin * x[2] + (1.0 - cos) * x[3])
    dx[0] = (1.0 - s) * x[0] - 2.0 * x[1]
    dx[1] = 2.0 * x[0] + (1.0 - s) * x[1]
    a = p.lam - 1.0 + 0.2 * p.sigma**2 - first * first - second * second
    dx[2] = a * first - 0.5 * (x[2] - first) - x[3]
    dx[3] = a * second - 0.5 * (x[3] - second) + x[2]


def touch(t, x, p):
    return x[0] - 1.0 - 0.3 * (p.sigma + 0.5) - 0.1 * (p.lam - 0.95)


SYSTEM = System(
    "touching",
    states=(State("x"), State("y"), State("z", scale=1.0), State("w", scale=1.0)),
    parameters=(Parameter("lam", 0.7), Parameter("sigma", -0.2)),
    modes=(Mode("only", field),),
    transitions=(Transition("touch", "only", "only", touch, "rising", role="watched"),),
)
"""
RUN = """
system: ./touching.py
start: {simulate: {state: {x: 1.0, y: 0.0, z: 0.0, w: 0.0}, until: settled}}
continue: {parameter: lam, range: [0.6, 1.2]}
diagram: none
accuracy: 1e-8
events: {GR: ignore}
engine: {max_step: 0.4, max_share: 0.1}
loci: {with: sigma, range: [-1.0, 0.2], of: [PD], follow: all}
output: touching.h5
"""


@pytest.fixture(scope="module")
def touching(tmp_path_factory) -> tuple[System, list[Branch], list[str]]:
    return studied(tmp_path_factory.mktemp("touching"), "touching", TOUCHING, RUN)


@pytest.mark.long
def test_a_grazing_curve_is_followed_from_a_curve_of_doublings(touching) -> None:
    _, (_, doublings, grazings), notes = touching
    assert (doublings.info.settings["of"], grazings.info.settings["of"]) == ("PD", "GR")
    line = 0.3 * (grazings["sigma"] + 0.5) + 0.1 * (grazings["lam"] - 0.95)
    assert np.max(np.abs(line)) < 1e-6
    for curve in (doublings, grazings):
        (point,) = [p for p in curve.special_points if p.label == "GRPD"]
        assert (point.kind, point.status) == ("interior", "located")
        for name, truth in (("lam", 0.95), ("sigma", -0.5)):
            assert abs(point.parameters[name] - truth) <= point.errors[name] < 1e-8
    assert any("b3/GRPD1 lies on branch b2" in text for text in notes)


def test_points_of_curves_of_orbits_are_found_again(touching) -> None:
    system, (_, *curves), _ = touching
    for curve in curves:
        (point,) = [p for p in curve.special_points if p.label == "GRPD"]
        found = checked_point(system, curve, point)
        assert found.verdict == AGREES, found


MAP = """
system: ./henon.py
start: {simulate: {state: {x: 0.14, y: 0.14}, until: settled}}
continue: {parameter: alpha, range: [-1.5, 0.4]}
diagram: none
accuracy: 1e-8
engine: {max_step: 0.4, max_share: 0.2}
loci: {with: beta, range: [0.8, 1.2], of: [LP], follow: [R1]}
output: henon.h5
"""


@pytest.mark.long
def test_tori_are_followed_from_a_resonance_on_folds(tmp_path) -> None:
    """R1 at (-1, 1), tori where beta is one, R4 at alpha = 0."""
    _, (_, folds, tori), notes = studied(
        tmp_path, "henon", map_plugin("henon", HENON, {"alpha": 0.3, "beta": 0.9}), MAP
    )
    assert (folds.info.settings["of"], tori.info.settings["of"]) == ("LP", "NS")
    assert {p.label for p in tori.special_points} == {"R1", "R4", "EP"}
    assert np.max(np.abs(tori["beta"] - 1.0)) < 1e-6
    for curve in (folds, tori):
        (point,) = [p for p in curve.special_points if p.label == "R1"]
        assert abs(point.parameters["alpha"] + 1.0) <= point.errors["alpha"] < 1e-8
    assert any("R11 lies on branch b2" in text for text in notes)


QUINTIC = """
from contwalk.system import Mode, Parameter, State, System, Transition


def still(t, x, p, dx):
    dx[0] = 0.0 * x[0]


def clock(t, x, p):
    return (t % 1.0) - 0.5


def kick(t, x, p, x_plus):
    x_plus[0] = -(1.0 + p.mu) * x[0] + p.nu * x[0] ** 3 + x[0] ** 5


SYSTEM = System(
    "quintic",
    states=(State("x", scale=1.0),),
    parameters=(Parameter("mu", -0.1), Parameter("nu", 0.1)),
    modes=(Mode("still", still),),
    transitions=(Transition("kick", "still", "still", clock, "rising", reset=kick),),
    period=lambda p: 1.0,
)
"""
FIFTH = """
system: ./quintic.py
start: {simulate: {state: {x: 0.0}, until: settled}}
continue: {parameter: mu, range: [-0.3, 0.1]}
diagram: none
accuracy: 1e-8
engine: {max_step: 0.4, max_share: 0.2}
loci: {with: nu, range: [-0.4, 0.2], of: [PD], follow: [GPD]}
output: quintic.h5
"""


def test_folds_of_doubled_orbits_are_followed_from_a_generalized_doubling(tmp_path) -> None:
    """x and -x are exchanged where mu = nu x^2 + x^4, which folds where mu = -nu^2 / 4 for negative nu."""
    _, (_, doublings, folds), _ = studied(tmp_path, "quintic", QUINTIC, FIFTH)
    assert (doublings.info.settings["of"], folds.info.settings["of"]) == ("PD", "LP")
    assert {p.label for p in doublings.special_points} == {"GPD", "EP"}
    assert np.max(np.abs(folds["mu"] + 0.25 * folds["nu"] ** 2)) < 1e-6
    assert folds["nu"].min() == -0.4
    assert -0.02 < folds["nu"].max() < 0.0
