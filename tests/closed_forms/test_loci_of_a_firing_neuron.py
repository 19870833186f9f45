"""A neuron that integrates a current I + A sin w t and fires at one: the tongue of its locking in (I, A).

v' = I + A sin(w t) - v, v = 0 after firing, w = 2 pi. Without a threshold the voltage comes to
I + R sin(w t - d), R = A / sqrt(1 + w^2), tan d = w. Once a period, at the instant s, it fires where
(I + R sin(w s - d)) (1 - 1/e) = 1: folds are the straight lines I = I0 -+ R, which meet at A = 0, where any s
does, I0 = 1 / (1 - 1/e). Where it fires with neither v' nor v'', I + A sin(w s) = 1 at the sine's extreme, an
earlier touch of the threshold has come to the spike: A (w^2 / (1 + w^2)) = 1 - I0, I = 1 - A.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hybrid_runs import diagram, machine

import contwalk as cw
from contwalk.branch import Branch
from contwalk.system import System, Transition

W = 2.0 * math.pi
TIP, REACH = 1.0 / (1.0 - math.exp(-1.0)), 1.0 / math.hypot(1.0, W)
pytestmark = pytest.mark.slow

# Points of curves are solved for on the steps of a branch, of a hundred times the accuracy of 1e-9.
WALKED = 1e-7


def _field(t, x, p, dx):
    dx[0] = p.I + p.A * math.sin(2.0 * math.pi * t) - x[0]


def _below(t, x, p):
    return 1.0 - x[0]


def _fire(t, x, p, x_plus):
    x_plus[0] = 0.0


@cache
def neuron() -> System:
    return machine(
        ["v"],
        {"I": TIP, "A": 0.3},
        {"charging": _field},
        [Transition("spike", "charging", "charging", _below, reset=_fire)],
        period=lambda p: 1.0,
    )


@cache
def locked(amplitude: float) -> Branch:
    """The neuron that fires once a period, over the current."""
    return diagram(neuron(), "I", (1.3, 2.0), [0.0], {"I": TIP, "A": amplitude}, until="settled")[0]


def followed(which: str, swings: tuple[float, float], amplitude: float = 0.3) -> Branch:
    """The curve of a special point of the locked neuron over the amplitude."""
    ranges = {"I": (0.5, 3.0), "A": swings}
    return cw.continue_locus(neuron(), locked(amplitude), which, ranges)


def test_folds_come_to_the_tip_where_their_range_ends_there():
    """They crept on before it to `step_too_small`, or with 101 false BP to `max_points`, and a false CPC."""
    curve = followed("LP2", (0.0, 0.4))
    assert (curve.outcome.status, curve.outcome.reason) == ("complete", "bound")
    assert [p.label for p in curve.special_points] == ["EP", "EP"]
    np.testing.assert_allclose(np.abs(curve["I"] - TIP), curve["A"] * REACH, rtol=0.0, atol=WALKED)
    assert curve["A"].min() == 0.0


def test_folds_go_on_through_the_tip():
    """The point at which all phases are folds is where curves cross; no cusp is there (c was 1e52)."""
    curve = followed("LP1", (-0.4, 0.4))
    assert (curve.outcome.status, curve.outcome.reason) == ("complete", "bound")
    (crossing,) = [p for p in curve.special_points if p.label != "EP"]
    assert (crossing.label, crossing.status) == ("BP", "located")
    assert abs(crossing.parameters["A"]) <= crossing.errors["A"] + 1e-12
    assert abs(crossing.parameters["I"] - TIP) <= crossing.errors["I"] + 1e-12
    side = np.sign(curve["I"][-1] - curve["I"][0]) * np.sign(curve["A"][-1] - curve["A"][0])
    np.testing.assert_allclose(curve["I"] - TIP, side * curve["A"] * REACH, rtol=0.0, atol=WALKED)


def test_a_touch_that_comes_to_the_spike_ends_its_curve_there():
    """It went to and fro there for 456 steps, to `step_too_small`, with a GRD that was not located."""
    curve = followed("GR2", (-0.9, -0.5), amplitude=-0.8)
    assert (curve.outcome.status, curve.outcome.reason) == ("stopped", "grazing")
    (point,) = [p for p in curve.special_points if p.label != "EP"]
    assert (point.label, point.kind, point.status) == ("GRGR", "resonant", "located")
    assert "'spike' happens where it is touched" in point.note
    swing = (1.0 - TIP) * (1.0 + W**2) / W**2
    for name, truth in {"A": swing, "I": 1.0 - swing}.items():
        assert abs(point.parameters[name] - truth) <= point.errors[name] < 1e-8
