"""Motions that lose nothing, along one parameter and along two: pairs of eigenvalues and of multipliers.

Planar motions about L1 of the Earth and the Moon lose their plane to halo and to axial ones (E. J. Doedel et
al., Int. J. Bifurcation Chaos 17 (2007) 2625) where z'' = -(1 - mu) z / r^3 - mu z / s^3 has a double
multiplier one.

Folds of x'' = a + b x - x^3 in closed form; those of Hénon-Heiles by scaling: with k x for x its energy at a
bifurcation is proportional to 1 / k^2. The first pitchfork of its straight motion is at 0.969309 of the
energy of escape, 1 / 6 (M. Brack, Found. Phys. 31 (2001) 209, table 1, orbit R5).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint

HEAD = """\
import math
from contwalk.system import Conserved, Mode, Parameter, State, System
"""
CUSP = """\
def field(t, x, p, dx):
    dx[0], dx[1] = x[1], p.a + p.b * x[0] - x[0] ** 3
SYSTEM = System("cusp", states=(State("x"), State("v")), modes=(Mode("m", field),),
    parameters=(Parameter("a", 0.0), Parameter("b", 1.0)))
"""
# H = v^2 / 2 + a q v + q^3 / 3 - m q: with v = -a q folds are where q = a^2 / 2, m = -a^4 / 4.
MIXED = """\
def field(t, x, p, dx):
    dx[0], dx[1] = x[1] + p.a * x[0], -p.a * x[1] - x[0] ** 2 + p.m
SYSTEM = System("mixed", states=(State("q"), State("v")), modes=(Mode("m", field),),
    parameters=(Parameter("a", 0.37), Parameter("m", 1.0)))
"""
PREY = """\
def field(t, x, p, dx):
    dx[0], dx[1] = x[0] * (p.alpha - 1.3 * x[1]), x[1] * (0.9 * x[0] - 1.1)
SYSTEM = System("prey", states=(State("x"), State("y")), modes=(Mode("m", field),),
    parameters=(Parameter("alpha", 0.7),))
"""
FORCED = """\
def field(t, x, p, dx):
    dx[0], dx[1] = x[1], -x[0] - x[0] ** 3 - p.c * x[1] + p.F * math.cos(p.W * t)
SYSTEM = System("forced", states=(State("x"), State("v")), period=lambda p: 2.0 * math.pi / p.W,
    parameters=(Parameter("F", 0.3), Parameter("W", {W}), Parameter("c", 0.0)), modes=(Mode("m", field),))
"""
HENON_HEILES = """\
def field(t, x, p, dx):
    dx[0], dx[1] = x[2], x[3]
    dx[2], dx[3] = -x[0] - 2.0 * p.k * x[0] * x[1], -x[1] - p.k * (x[0] ** 2 - x[1] ** 2)
def energy(t, x, p):
    half = 0.5 * (x[0] ** 2 + x[1] ** 2 + x[2] ** 2 + x[3] ** 2)
    return half + p.k * (x[0] ** 2 * x[1] - x[1] ** 3 / 3.0)
SYSTEM = System("henon_heiles", states=tuple(State(name) for name in "xyuv"), modes=(Mode("m", field),),
    parameters=(Parameter("k", 1.0),), conserved=(Conserved("energy", energy),))
"""


def study(folder: Path, plugin: str, text: str) -> list[Branch]:
    """The branches of a run file."""
    (folder / "small.py").write_text(HEAD + plugin)
    (folder / "run.yaml").write_text(f"contwalk: 1\nsystem: ./small.py\ndiagram: {{follow: none}}\n{text}")
    study = cw.read_run_file(folder / "run.yaml", output=folder / f"run{len(list(folder.glob('*.h5')))}.h5")
    return list(cw.run(study, figures=False).branches)


def kinds(branch: Branch) -> list[str]:
    return [point.label for point in branch.special_points]


@pytest.fixture(scope="module")
def fold(tmp_path_factory: pytest.TempPathFactory) -> list[Branch]:
    """A fold of equilibria at which the only pair of eigenvalues meets at zero, and its curve."""
    text = """\
start: {state: {x: -1.3, v: 0.0}}
continue: {parameter: a, range: [-1, 1]}
loci: {with: b, range: [-1, 2], of: all}
"""
    return study(tmp_path_factory.mktemp("cusp"), CUSP, text)


def test_the_only_pair_is_unstable_between_the_folds(fold: list[Branch]) -> None:
    """A saddle has one unstable direction; what oscillates about a centre has none."""
    first = fold[0]
    assert kinds(first) == ["EP", "LP", "LP", "EP"]
    counts = [(point.unstable_before, point.unstable_after) for point in first.special_points]
    assert counts == [(0, 0), (0, 1), (1, 0), (0, 0)]


def test_the_curve_of_such_folds_goes_on_to_the_ends_of_the_range(fold: list[Branch]) -> None:
    """27 a^2 = 4 b^3, with a cusp at zero; all along F_u is nilpotent."""
    (curve,) = fold[1:]
    assert curve.outcome.reason == "bound"
    assert kinds(curve) == ["EP", "CP", "EP"]
    np.testing.assert_allclose(27.0 * curve["a"] ** 2, 4.0 * curve["b"] ** 3, atol=1e-13)


@pytest.mark.long
def test_a_second_eigenvalue_that_is_zero_all_along_is_no_double_zero(tmp_path: Path) -> None:
    """Its sign is rounding: there were thirteen Bogdanov-Takens points, and curves that began at them."""
    text = """\
start: {state: {q: 1.0, v: -0.37}}
continue: {parameter: m, range: [-1, 2]}
loci: {with: a, range: [-2, 2], of: all, follow: all}
"""
    _, *curves = study(tmp_path, MIXED, text)
    assert [kinds(curve) for curve in curves] == [["EP", "EP"]]
    np.testing.assert_allclose(4.0 * curves[0]["m"], -(curves[0]["a"] ** 4), atol=1e-12)


def test_the_end_of_a_range_of_centres_is_no_hopf_point(tmp_path: Path) -> None:
    """Both eigenvalues of Lotka and Volterra's equilibrium are on the axis for all growths of the prey."""
    text = """\
start: {state: {x: 1.2222222222222222, y: 0.5384615384615384}}
continue: {parameter: alpha, range: [0.1, 2.0]}
"""
    (branch,) = study(tmp_path, PREY, text)
    assert kinds(branch) == ["EP", "EP"]


def test_moduli_of_a_pair_on_the_unit_circle_tell_no_tori(tmp_path: Path) -> None:
    """A forced oscillator without damping: from far above its resonance to the fold, and back on the circle.

    Below the fold both multipliers are real, product one.
    """
    text = """\
start: {simulate: {state: {x: -0.04, v: 0.0}, until: 0}}
continue: {parameter: W, range: [1.2, 3.0]}
"""
    (branch,) = study(tmp_path, FORCED.format(W=3.0), text)
    labels = [label for label in kinds(branch) if label != "EP"]
    assert labels == ["LP"]
    for point in branch.special_points:
        assert point.status == "located"
    found = [np.prod(point.spectrum) for point in branch.special_points]
    np.testing.assert_allclose(np.real(found), 1.0, atol=1e-8)  # accuracy


@pytest.mark.long
def test_tori_of_a_damping_that_passes_zero_are_told(tmp_path: Path) -> None:
    """There volumes are kept at one value of the parameter only: both multipliers leave the circle there."""
    text = """\
start: {simulate: {state: {x: -0.04, v: 0.0}, until: 0}}
continue: {parameter: c, range: [-0.1, 0.1]}
"""
    (branch,) = study(tmp_path, FORCED.format(W=3.0), text)
    assert "NS" in kinds(branch)
    torus = next(point for point in branch.special_points if point.label == "NS")
    assert abs(torus.parameters["c"]) < 1e-12
    assert {torus.unstable_before, torus.unstable_after} == {0, 2}


@pytest.mark.long
def test_pitchforks_of_conserved_motions_are_followed_as_a_curve(tmp_path: Path) -> None:
    """Both multipliers of the pair are one all along: no further one passes the circle there, and derivatives
    of the condition are exact, so that steps are as long as elsewhere.
    """
    begun = """\
start: {simulate: {state: {x: 0.0, y: 0.0, u: 0.0, v: 0.565}, until: 0}}
continue: {parameter: energy, range: [0.159, 0.163]}
"""
    (first,) = study(tmp_path, HENON_HEILES, begun)
    (point,) = [point for point in first.special_points if point.label == "BP"]
    value = point.parameters["energy"]
    assert abs(6.0 * value - 0.969309) < 5e-7  # as printed
    text = """\
start: {from: run0.h5, point: b1/BP1}
continue: {parameters: [energy, k], range: {energy: [0.1, 0.3], k: [0.8, 1.25]}}
"""
    (curve,) = study(tmp_path, HENON_HEILES, text)
    assert kinds(curve) == ["EP", "EP"]
    assert len(curve) < 90  # by differences they were twice as many
    for end in curve.special_points:
        energy, k = end.parameters["energy"], end.parameters["k"]
        assert abs(energy * k**2 - value) < 1e-9


THREE_BODIES = """\
def to_both(x, p):
    beside = x[1] ** 2 + x[2] ** 2
    return math.sqrt((x[0] + p.mu) ** 2 + beside), math.sqrt((x[0] - 1.0 + p.mu) ** 2 + beside)
def field(t, x, p, dx):
    far, near = to_both(x, p)
    heavy, light = (1.0 - p.mu) / far**3, p.mu / near**3
    dx[0], dx[1], dx[2] = x[3], x[4], x[5]
    dx[3] = 2.0 * x[4] + x[0] - heavy * (x[0] + p.mu) - light * (x[0] - 1.0 + p.mu)
    dx[4] = -2.0 * x[3] + x[1] - (heavy + light) * x[1]
    dx[5] = -(heavy + light) * x[2]
def jacobi(t, x, p):
    far, near = to_both(x, p)
    speed = x[3] ** 2 + x[4] ** 2 + x[5] ** 2
    return x[0] ** 2 + x[1] ** 2 + 2.0 * (1.0 - p.mu) / far + 2.0 * p.mu / near - speed
SYSTEM = System("three_bodies", states=tuple(State(name) for name in "xyzuvw"), modes=(Mode("m", field),),
    parameters=(Parameter("mu", 0.012150585609624),), conserved=(Conserved("C", jacobi),))
"""


@pytest.mark.slow
def test_planar_motions_about_a_libration_point_lose_their_plane(tmp_path: Path) -> None:
    """From a state on an unstable orbit, left by a factor of 2600 a round: it is looked for at once.

    Beside that multiplier the pair that meets at one is known badly: what passes is told by the branch point.
    """
    text = """\
start:
  simulate: {state: {x: 0.83, y: 0.0, z: 0.0, u: 0.0, v: 0.06110587737580827, w: 0.0}, until: 0}
continue: {parameter: C, range: [3.0, 3.188]}
"""
    (branch,) = study(tmp_path, THREE_BODIES, text)
    assert branch.outcome.reason == "bound"
    told = [
        (point.label, point.status, point.unstable_before, point.unstable_after)
        for point in branch.special_points
    ]
    assert told[1:-1] == [("BP", "located", 1, 2), ("BP", "located", 2, 1)]
    for point in branch.special_points[1:-1]:
        assert abs(_trace_out_of_plane(point) - 2.0) < 1e-6  # of the period's and state's errors, times 2600


def _trace_out_of_plane(point: SpecialPoint) -> float:
    """The trace of the map of deviations in z over the period of a planar motion, by SciPy."""
    mu = 0.012150585609624

    def field(t: float, y: np.ndarray) -> list[float]:
        (x, y_, u, v), deviations = y[:4], y[4:].reshape(2, 2)
        heavy = (1.0 - mu) / np.hypot(x + mu, y_) ** 3
        light = mu / np.hypot(x - 1.0 + mu, y_) ** 3
        planar = [u, v, 2.0 * v + x - heavy * (x + mu) - light * (x - 1.0 + mu), -2.0 * u + y_]
        planar[3] -= (heavy + light) * y_
        return [*planar, *deviations[1], *(-(heavy + light) * deviations[0])]

    planar = [point.state[name] for name in "xyuv"]
    start = [*planar, 1.0, 0.0, 0.0, 1.0]
    end = solve_ivp(field, (0.0, point.period), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return float(end[4] + end[7])
