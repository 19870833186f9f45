"""The impact oscillator in two parameters: its grazing curve, resonant grazings, doublings and folds.

x'' + x'/10 + x = A cos(w t) with a stop at x = 1 and the restitution 4/5. Linear impacts have closed
forms, computed with 40 digits; near the resonance w2 = sqrt(1 - 1/400), where the free motion between two
impacts comes back to itself, curves of folds and of doublings leave the grazing curve tangentially
(Simpson & Ghosh, arXiv 2602.22797).
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from contwalk_systems.impact_oscillator import SYSTEM
from hybrid_runs import diagram
from one_impact import forced, parameters, stiffness

import contwalk as cw
from contwalk.branch import Branch

RESONANT = {"omega": 0.99874921777190894579, "force": 0.099906206013440426313}
# A - A_GR = K (w - w2)^2, of doublings below the resonance and of folds above it.
TANGENCY, OF_FOLDS = 4473.4851, -18.681858070718
LONG = {"max_step": 0.3, "max_share": 0.1}


def touching(omega: np.ndarray) -> np.ndarray:
    """The force at which the motion without impacts touches the stop."""
    return np.asarray(np.hypot(1.0 - omega**2, 0.1 * omega))


@cache
def branches(omega: float) -> list[Branch]:
    """The motion without impacts up to its grazing, and the one with an impact from there on."""
    p = parameters(omega, 0.05, 0.8)
    p.force = 0.7 * stiffness(p)
    return diagram(
        SYSTEM, "force", (0.5 * stiffness(p), 0.5), forced(p, 0.0), vars(p), events={"GR": "switch"}
    )


def followed(
    branch: Branch, point: str, omega: tuple[float, float], accuracy: float = 1e-9, **settings
) -> Branch:
    ranges = {"omega": omega, "force": (0.01, 2.0)}
    fine = cw.Discretization(accuracy=accuracy)
    return cw.continue_locus(SYSTEM, branch, point, ranges, discretization=fine, **LONG, **settings)


def assert_resonant(curve: Branch, label: str) -> None:
    (point,) = [p for p in curve.special_points if p.label == label]
    assert (point.kind, point.status) == ("resonant", "located")
    for name, truth in RESONANT.items():
        assert abs(point.parameters[name] - truth) <= point.errors[name] < 1e-9


def assert_tangency(curve: Branch) -> None:
    """How the curves of folds and doublings leave the grazing curve at the first resonance."""
    points = [p for p in curve.special_points if p.label in ("GRLP", "GRPD")]
    near = [p for p in points if abs(p.parameters["omega"] - RESONANT["omega"]) < 1e-9]
    assert near
    for point in near:
        found, truth = point.coefficients, TANGENCY if point.label == "GRPD" else OF_FOLDS
        assert found["tangency_force"] == pytest.approx(truth, rel=1e-8)
        slope = (2.0 * point.parameters["omega"] ** 3 - 1.99 * point.parameters["omega"]) / touching(
            point.parameters["omega"]
        )
        assert found["tangency_omega"] == pytest.approx(-truth / slope**3, rel=1e-8)
        assert found["tangency_omega_error"] < 1e-8 * abs(found["tangency_omega"])


@pytest.mark.long
def test_the_grazing_curve_to_the_last_digits() -> None:
    curve = followed(branches(0.98)[0], "GR1", (0.5, 1.5), accuracy=1e-13)
    assert np.max(np.abs(curve["force"] - touching(curve["omega"]))) < 1e-12
    assert curve.info.settings["limit"]["kind"] == "interior"
    # At two thirds of the first resonance the free motion comes back as well.
    assert sorted(p.label for p in curve.special_points) == ["EP", "EP", "GRLP", "GRLP", "GRPD", "GRPD"]
    for point in curve.special_points:
        if point.label != "EP":
            assert (point.kind, point.status) == ("resonant", "located")
            nearest = RESONANT["omega"] * np.array([1.0, 2.0 / 3.0])
            off = np.min(np.abs(nearest - point.parameters["omega"]))
            assert off <= point.errors["omega"] + 1e-15 < 1e-11
    assert_tangency(curve)


def test_doublings_up_to_the_resonance() -> None:
    curve = followed(branches(0.98)[1], "PD1", (0.95, 1.02), accuracy=1e-11)
    assert_resonant(curve, "GRPD")
    assert_tangency(curve)
    assert [p.label for p in curve.special_points] == ["EP", "GPD", "GRPD", "EP"]
    first, last = curve.special_points[0], curve.special_points[-1]
    assert first.parameters["omega"] == 0.95
    assert first.parameters["force"] == pytest.approx(0.535598788700668797, rel=1e-9)
    assert (curve.outcome.reason, last.kind) == ("grazing", "grazing")
    assert "events.GR=ignore" in curve.outcome.message
    assert "switch" not in curve.outcome.message
    beside = curve["omega"] - RESONANT["omega"]
    near = (beside < -1e-4) & (beside > -3e-3)
    bend = (curve["force"] - touching(curve["omega"]))[near] / beside[near] ** 2
    # The next term is of the size of beside / 1e-3.
    assert np.polyval(np.polyfit(beside[near], bend, 3), 0.0) == pytest.approx(TANGENCY, rel=0.05)


@pytest.mark.long
def test_a_curve_that_ignores_grazings_goes_on_and_tells_so() -> None:
    curve = followed(branches(0.98)[1], "PD1", (0.98, 1.005), events={"GR": "ignore"})
    assert_resonant(curve, "GRPD")
    beyond = curve["omega"] > RESONANT["omega"] + 1e-6
    assert beyond.any()
    assert not curve.points["admissible"][beyond].any()


@pytest.mark.long
def test_folds_down_to_the_resonance() -> None:
    curve = followed(branches(1.01)[1], "LP1", (0.98, 1.1))
    assert_resonant(curve, "GRLP")
    assert_tangency(curve)


@pytest.mark.long
def test_the_resonance_on_the_grazing_curve_of_the_motion_with_an_impact() -> None:
    values = vars(parameters(0.98, 0.05, 0.8, force=0.3))
    branch = diagram(SYSTEM, "force", (0.05, 0.32), [0.0, 0.0], values, until="settled")[0]
    name = next(p.name for p in branch.special_points if p.label == "GR" and p.kind == "terminal")
    curve = followed(branch, name, (0.96, 1.03))
    np.testing.assert_allclose(curve["force"], touching(curve["omega"]), rtol=1e-6)
    for label in ("GRPD", "GRLP"):
        assert_resonant(curve, label)
