"""A mass on a spring under dry friction f sign(x') and a force cos w t: where it rests between its ways.

Moving left its symmetric motion is x = f + V cos(w t + phi) - f cos t + V w sin(phi) sin t with
V = 1 / (1 - w^2) and V w sin(phi) = -f tan(pi / (2 w)) (J.P. Den Hartog, Trans. ASME 53 (1931) 107). Below
w = 1/2 it comes to rest within a way where its velocity touches zero; the instant of that goes to the way's
beginning, where both are one: at w = 1/2, f = 1/3 the velocity is (2/3) sin(t/2) (cos(t/2) - 1).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import diagram, machine

import contwalk as cw
from contwalk.system import Mode, Symmetry, System, Transition

pytestmark = pytest.mark.slow

X, V = range(2)


def _right(t, x, p, dx):
    dx[X], dx[V] = x[V], math.cos(p.w * t) - x[X] - p.f


def _left(t, x, p, dx):
    dx[X], dx[V] = x[V], math.cos(p.w * t) - x[X] + p.f


def _rest(t, x, p, dx):
    dx[X] = 0.0


def _rightwards(t, x, p):
    return x[V]


def _leftwards(t, x, p):
    return -x[V]


def _holds_left(t, x, p):
    return p.f + math.cos(p.w * t) - x[X]


def _holds_right(t, x, p):
    return p.f - math.cos(p.w * t) + x[X]


def _stop(t, x, p, x_plus):
    x_plus[X] = x[X]


def _go(t, x, p, x_plus):
    x_plus[X], x_plus[V] = x[X], 0.0


def _inversion(t, x, p, image):
    image[X], image[V] = -x[X], -x[V]


def friction() -> System:
    return machine(
        ["x", "v"],
        {"w": 0.49, "f": 0.3},
        [Mode("right", _right), Mode("left", _left), Mode("rest", _rest, states=("x",))],
        [
            Transition("stop_right", "right", "rest", _rightwards, reset=_stop),
            Transition("stop_left", "left", "rest", _leftwards, reset=_stop),
            Transition("go_right", "rest", "right", _holds_right, reset=_go, level=True),
            Transition("go_left", "rest", "left", _holds_left, reset=_go, level=True),
        ],
        symmetries=(
            Symmetry(
                "inversion",
                "spatial",
                _inversion,
                modes={"right": "left", "left": "right"},
                events={
                    "stop_right": "stop_left",
                    "stop_left": "stop_right",
                    "go_right": "go_left",
                    "go_left": "go_right",
                },
            ),
        ),
        period=lambda p: 2.0 * math.pi / p.w,
    )


def fastest_back(w: float, f: float) -> float:
    """The largest velocity within the way left, its ends left out."""
    size = 1.0 / (1.0 - w**2)
    sine = -f * math.tan(0.5 * math.pi / w) / (size * w)
    t = np.linspace(0.0, math.pi / w, 20001)[100:-100]
    moving = np.sin(w * t + math.asin(sine))
    return float(np.max(-size * w * moving + f * np.sin(t) + size * w * sine * np.cos(t)))


def test_the_curve_ends_where_the_touch_comes_to_the_way_s_beginning():
    """It went on to w = 0.896, with touches before the way begins, told as admissible, and a false GRLP."""
    system = friction()
    moving, *_ = diagram(
        system, "w", (0.45, 0.52), [0.0, 0.1], {"w": 0.49, "f": 0.3}, until="settled", events={"GR": "stop"}
    )
    curve = cw.continue_locus(system, moving, "GR1", {"w": (0.46, 0.9), "f": (0.02, 0.9)})
    assert curve.outcome.reason == "order_change"
    (point,) = [p for p in curve.special_points if p.label != "EP"]
    assert (point.label, point.status) == ("OC", "located")
    assert "'stop_left' is touched at the instant of 'go_left'" in point.note
    for name, truth in {"w": 0.5, "f": 1.0 / 3.0}.items():
        assert abs(point.parameters[name] - truth) <= point.errors[name] < 1e-8
    for w, f in zip(curve["w"], curve["f"], strict=True):
        # Solved for to 1e-7, and looked at every 3e-4, in which the velocity changes by its square.
        assert w > 0.49 or abs(fastest_back(w, f)) < 1e-6
